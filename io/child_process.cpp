// SPDX-License-Identifier: GPL-3.0-or-later
//
// fork() without exec(): the child runs a function of the same program on the same settings, so there is no
// command line to assemble and none to disagree about. What it returns goes through a file without a name
// (memfd_create), which the caller reads when the child is gone: half a message cannot arrive. A pipe whose
// writing end only the child holds says when that is. The kernel ends the child with the caller
// (PR_SET_PDEATHSIG), also when that is killed.

#include "io/child_process.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <initializer_list>
#include <limits>
#include <new>
#include <system_error>
#include <utility>

namespace spheretree::io {
namespace {

// Exit codes of the child, known to finish() only, and not those with which libraries end a process.
constexpr int kFinished = 90;
constexpr int kThrew = 91;
constexpr int kNoRoom = 92;  // the result could not be handed over

constexpr off_t kComplaintRead = 4096;          // of the end of standard error: a line is wanted
constexpr std::size_t kComplaintWidth = 300;    // of that line: it becomes part of a sentence
constexpr std::size_t kEmergencyBytes = 65536;  // to report "out of memory" with, after running out

// Descriptors of the child.
constexpr int kResult = 3;
constexpr int kAlive = 4;

/// What the child keeps of the caller's descriptors.
struct Ends {
  int result = -1;
  int complaint = -1;
  int alive = -1;
};

// Sanitizers map terabytes that they never touch: no bound on allocations can be kept then.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kBoundable = false;
#elif defined(__has_feature)
constexpr bool kBoundable = !__has_feature(address_sanitizer) && !__has_feature(thread_sanitizer);
#else
constexpr bool kBoundable = true;
#endif

Error noProcess(const char* what) {
  return {ErrorCode::Internal,
          std::string("cannot start a process: ") + what + ": " + std::generic_category().message(errno)};
}

bool writeAll(int descriptor, const char* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t written = ::write(descriptor, bytes, count);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes += written;
    count -= static_cast<std::size_t>(written);
  }
  return true;
}

/// The bytes from `from` to the end.
std::string bytesOf(int descriptor, off_t from) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || status.st_size <= from) return {};
  std::string bytes(static_cast<std::size_t>(status.st_size - from), '\0');
  std::size_t have = 0;
  while (have < bytes.size()) {
    const ssize_t got =
        ::pread(descriptor, bytes.data() + have, bytes.size() - have, from + static_cast<off_t>(have));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    have += static_cast<std::size_t>(got);
  }
  bytes.resize(have);
  return bytes;
}

std::string lastLine(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) return {};
  std::string text =
      bytesOf(descriptor, status.st_size > kComplaintRead ? status.st_size - kComplaintRead : 0);
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  const std::size_t begin = text.rfind('\n');
  if (begin != std::string::npos) text.erase(0, begin + 1);
  if (text.size() > kComplaintWidth) text.resize(kComplaintWidth);
  return text;
}

/// Nothing of the caller's reaches the child (its locks above all, which would outlive it), nothing of the
/// child's reaches the terminal. The result goes to kResult from now on.
void settleChild(pid_t parent, const Ends& ends, std::uint64_t memoryBytes) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(kThrew);  // it died before that
  // Whoever presses Ctrl-C reaches the whole group; it is the caller who decides then.
  for (const int signal : {SIGINT, SIGTERM}) ::signal(signal, SIG_IGN);
  const int nothing = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(nothing, STDOUT_FILENO);
  ::dup2(ends.complaint, STDERR_FILENO);
  const int alive = ::fcntl(ends.alive, F_DUPFD, kAlive + 1);  // out of the way of the next line
  ::dup2(ends.result, kResult);
  ::dup2(alive, kAlive);
  ::close_range(kAlive + 1, std::numeric_limits<unsigned>::max(), 0);
  const rlimit noCore{0, 0};
  ::setrlimit(RLIMIT_CORE, &noCore);  // no surprise files
  if (kBoundable && memoryBytes > 0) {
    const rlimit most{memoryBytes, memoryBytes};
    ::setrlimit(RLIMIT_DATA, &most);
  }
}

[[noreturn]] void runChild(const std::function<std::string()>& work) {
  void* reserve = std::malloc(kEmergencyBytes);
  if (reserve != nullptr) std::memset(reserve, 1, kEmergencyBytes);
  std::string bytes;
  int code = kFinished;
  try {
    bytes = work();
  } catch (const std::bad_alloc&) {
    std::free(reserve);
    bytes = "out of memory";
    code = kThrew;
  } catch (const std::exception& failure) {
    bytes = failure.what();
    code = kThrew;
  }
  if (!writeAll(kResult, bytes.data(), bytes.size())) code = kNoRoom;
  ::_exit(code);  // buffers and exit handlers are the caller's
}

void closeAll(std::initializer_list<int> descriptors) {
  for (const int descriptor : descriptors) {
    if (descriptor >= 0) ::close(descriptor);
  }
}

}  // namespace

Result<ChildProcess> ChildProcess::start(const std::function<std::string()>& work,
                                         std::uint64_t memoryBytes) {
  std::array<int, 2> alive{-1, -1};
  const int result = ::memfd_create("result", MFD_CLOEXEC);
  const int complaint = ::memfd_create("complaint", MFD_CLOEXEC);
  const bool ready = result >= 0 && complaint >= 0 && ::pipe2(alive.data(), O_CLOEXEC) == 0;
  const pid_t parent = ::getpid();
  const pid_t process = ready ? ::fork() : -1;
  if (process < 0) {
    const Error error = noProcess(ready ? "fork" : "no descriptors");
    closeAll({result, complaint, alive[0], alive[1]});
    return error;
  }
  if (process == 0) {
    settleChild(parent, {result, complaint, alive[1]}, memoryBytes);
    runChild(work);
  }
  ::close(alive[1]);
  return ChildProcess(process, alive[0], result, complaint);
}

ChildProcess::ChildProcess(pid_t process, int watch, int result, int complaint) noexcept
    : process_(process), watch_(watch), result_(result), complaint_(complaint) {}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : process_(std::exchange(other.process_, 0)),
      watch_(std::exchange(other.watch_, -1)),
      result_(std::exchange(other.result_, -1)),
      complaint_(std::exchange(other.complaint_, -1)) {}

ChildProcess& ChildProcess::operator=(ChildProcess&& other) noexcept {
  std::swap(process_, other.process_);
  std::swap(watch_, other.watch_);
  std::swap(result_, other.result_);
  std::swap(complaint_, other.complaint_);
  return *this;
}

ChildProcess::~ChildProcess() {
  if (process_ > 0) {
    kill();
    while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  closeAll({watch_, result_, complaint_});
}

void ChildProcess::kill() const noexcept {
  if (process_ > 0) ::kill(process_, SIGKILL);
}

ChildEnd ChildProcess::finish() {
  int status = 0;
  rusage usage{};
  while (::wait4(process_, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  process_ = 0;
  ChildEnd end;
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  end.finished = code == kFinished;
  end.threw = code == kThrew;
  end.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (end.finished || end.threw) end.bytes = bytesOf(result_, 0);
  end.complaint = lastLine(complaint_);
  constexpr std::uint64_t kKibibyte = 1024;  // Linux counts in those
  end.peakMemoryBytes = static_cast<std::uint64_t>(usage.ru_maxrss) * kKibibyte;
  return end;
}

std::string signalName(int signal) {
  const char* const words = ::strsignal(signal);
  return "signal " + std::to_string(signal) + (words == nullptr ? "" : " (" + std::string(words) + ")");
}

}  // namespace spheretree::io
