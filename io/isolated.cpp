// SPDX-License-Identifier: GPL-3.0-or-later
//
// fork(2) and a pipe: the child has the input in memory already, and whatever becomes of its stack and its
// heap ends with it. The first byte that it sends says whether bytes or an error follow; a child that dies
// early is known by its exit status.
#include "io/isolated.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <string_view>
#include <system_error>
#include <utility>

namespace spheretree::io {
namespace {

constexpr char kBytes = 'b';
constexpr char kError = 'e';  // followed by the error code

bool sendAll(int pipe, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(pipe, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

/// What the child has to say. What does not fit into memory is no fault of the input.
Result<std::string> resultOf(const std::function<Result<std::string>()>& work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::Internal, "not enough memory"};
  } catch (const std::exception& failure) {
    return Error{ErrorCode::UnreadableInput, failure.what()};
  }
}

[[noreturn]] void child(int pipe, const std::function<Result<std::string>()>& work,
                        std::chrono::seconds limit) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGINT, SIGTERM, SIGXCPU}) ::signal(signal, SIG_DFL);
  // No message of a library that gives up, no core dump of a crash that was reckoned with.
  if (const int nowhere = ::open("/dev/null", O_WRONLY); nowhere >= 0) ::dup2(nowhere, STDERR_FILENO);
  const struct rlimit noCore { 0, 0 };
  ::setrlimit(RLIMIT_CORE, &noCore);
  const auto seconds = static_cast<rlim_t>(limit.count());
  const struct rlimit time { seconds, seconds + 1 };
  ::setrlimit(RLIMIT_CPU, &time);

  const Result<std::string> result = resultOf(work);
  bool sent = false;
  if (result) {
    sent = sendAll(pipe, {&kBytes, 1}) && sendAll(pipe, *result);
  } else {
    const std::array<char, 2> head{kError, static_cast<char>(result.error().code)};
    sent = sendAll(pipe, {head.data(), head.size()}) && sendAll(pipe, result.error().message);
  }
  ::_exit(sent ? EXIT_SUCCESS : EXIT_FAILURE);
}

/// Everything until the other end is closed.
std::string receiveAll(int pipe) {
  constexpr std::size_t kChunk = std::size_t{1} << 16U;  // what a pipe holds
  std::string bytes;
  while (true) {
    const std::size_t before = bytes.size();
    bytes.resize(before + kChunk);
    const ssize_t got = ::read(pipe, bytes.data() + before, kChunk);
    bytes.resize(before + static_cast<std::size_t>(got > 0 ? got : 0));
    if (got == 0 || (got < 0 && errno != EINTR)) return bytes;
  }
}

Error impossible(int code) {
  return {ErrorCode::Internal, "no process for reading it: " + std::generic_category().message(code)};
}

Error brokenDown(int status) {
  if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL))
    return {ErrorCode::UnreadableInput, "the reader of this format did not come to an end with it"};
  return {ErrorCode::UnreadableInput, "the reader of this format broke down on it: the file is damaged"};
}

/// The child of a fork, its end of the pipe closed; waits for it in any case.
class Child {
 public:
  Child(pid_t process, int pipe) : process_(process), pipe_(pipe) {}
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() { finish(); }

  [[nodiscard]] int pipe() const { return pipe_; }

  int finish() {
    if (process_ < 0) return status_;
    ::close(pipe_);  // a child that still writes gets SIGPIPE
    while (::waitpid(process_, &status_, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
    return status_;
  }

 private:
  pid_t process_;
  int pipe_;
  int status_ = -1;
};

}  // namespace

Result<std::string> runIsolated(const std::function<Result<std::string>()>& work,
                                std::chrono::seconds limit) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return impossible(errno);
  const pid_t process = ::fork();
  if (process == 0) {
    ::close(ends[0]);
    child(ends[1], work, limit);
  }
  const int code = errno;
  ::close(ends[1]);
  if (process < 0) {
    ::close(ends[0]);
    return impossible(code);
  }
  Child reader(process, ends[0]);
  std::string bytes = receiveAll(reader.pipe());
  const int status = reader.finish();
  if (!WIFEXITED(status) || WEXITSTATUS(status) != EXIT_SUCCESS || bytes.empty()) return brokenDown(status);
  if (bytes.front() == kError && bytes.size() > 1)
    return Error{static_cast<ErrorCode>(bytes[1]), bytes.substr(2)};
  bytes.erase(0, 1);
  return bytes;
}

}  // namespace spheretree::io
