// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/cli/program.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace spheretree::tests {
namespace {

namespace fs = std::filesystem;

fs::path freshFolder() {
  std::string name = (fs::temp_directory_path() / "spheretree-cli-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a folder for the test");
  return name;
}

std::string contentOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Corners of the unit box around the origin.
constexpr std::array<std::array<int, 3>, 8> kCorners{
    {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}}};

}  // namespace

ProgramTest::ProgramTest() : folder_(freshFolder()), capture_(freshFolder()) {}

ProgramTest::~ProgramTest() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
  fs::remove_all(capture_, ignored);
}

pid_t ProgramTest::start(const std::string& program, const std::vector<std::string>& arguments,
                         const std::string& where, const std::string& output) {
  std::vector<std::string> words{program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  const std::string out = output.empty() ? (capture_ / "out").string() : output;
  const std::string err = (capture_ / "err").string();
  const std::string place = (folder_ / where).string();
  constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_t actions{};
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), kFlags, 0600);
  ::posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), kFlags, 0600);
  ::posix_spawn_file_actions_addchdir_np(&actions, place.c_str());
  // A test that runs in the background inherits signals that are ignored; the program would respect that.
  posix_spawnattr_t attributes{};
  ::posix_spawnattr_init(&attributes);
  sigset_t defaults;
  ::sigemptyset(&defaults);
  ::sigaddset(&defaults, SIGINT);
  ::sigaddset(&defaults, SIGTERM);
  ::posix_spawnattr_setsigdefault(&attributes, &defaults);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  pid_t process = 0;
  const int code = ::posix_spawn(&process, program.c_str(), &actions, &attributes, argv.data(), environ);
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&actions);
  if (code != 0) throw std::runtime_error("cannot start " + program);
  return process;
}

Finished ProgramTest::finish(pid_t process, std::optional<std::chrono::milliseconds> limit) {
  constexpr std::chrono::milliseconds kNap(5);  // how much later than at the limit it may be killed
  const auto start = std::chrono::steady_clock::now();
  int status = 0;
  struct rusage usage {};
  Finished finished;
  while (true) {
    const pid_t ended = ::wait4(process, &status, limit && !finished.outOfTime ? WNOHANG : 0, &usage);
    if (ended == process || (ended < 0 && errno != EINTR)) break;
    if (ended < 0) continue;
    if (std::chrono::steady_clock::now() - start > *limit) {
      finished.outOfTime = true;
      ::kill(process, SIGKILL);
    } else {
      std::this_thread::sleep_for(kNap);
    }
  }
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  finished.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  finished.cpuSeconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  finished.peakMegabytes = 1.024e-3 * static_cast<double>(usage.ru_maxrss);  // the system counts in KiB
  finished.out = contentOf(capture_ / "out");
  finished.err = contentOf(capture_ / "err");
  return finished;
}

Finished ProgramTest::run(const std::vector<std::string>& arguments, const std::string& where) {
  return finish(start(programPath(), arguments, where));
}

void ProgramTest::write(const std::string& name, const std::string& text) const {
  std::ofstream file(folder_ / name, std::ios::binary);
  file << text;
}

std::string ProgramTest::read(const std::string& name) const {
  return contentOf(folder_ / name);
}

bool ProgramTest::exists(const std::string& name) const {
  return fs::exists(folder_ / name);
}

std::vector<std::string> ProgramTest::names() const {
  std::vector<std::string> all;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_))
    all.push_back(entry.path().filename().string());
  std::sort(all.begin(), all.end());
  return all;
}

std::string programPath() {
  const char* const other = std::getenv("SPHERETREE_TESTED_PROGRAM");
  return other != nullptr ? other : SPHERETREE_PROGRAM;
}

std::string boxObj(double x, double y, double z) {
  std::ostringstream text;
  for (const auto& [cx, cy, cz] : kCorners)
    text << "v " << x + 0.5 * cx << " " << y + 0.5 * cy << " " << z + 0.5 * cz << "\n";
  text << "f 1 4 3 2\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nf 5 6 7 8\n";
  return text.str();
}

std::string openBoxObj() {
  const std::string box = boxObj();
  return box.substr(0, box.rfind("f "));
}

std::string classicBoxTree() {
  // The circumscribed balls of the box and of its octants, rounded up to four decimals.
  std::ostringstream text;
  text << "2 8\n0.0000 0.0000 0.0000 0.8661 1.0000\n";
  for (const auto& [cx, cy, cz] : kCorners)
    text << 0.25 * cx << "00 " << 0.25 * cy << "00 " << 0.25 * cz << "00 0.4331 1.0000\n";
  text << "\n\nOptions : \n\tbranch\t\t: 8\n\tdepth\t\t: 1\n\teval\t\t: TRUE\n\n\nEvaluation :\n"
          "\tLevel 0\n\t\tNum\t: 1\n\t\tWorst\t: 366.100\n\tLevel 1\n\t\tNum\t: 8\n\t\tWorst\t: 183.100\n";
  return text.str();
}

}  // namespace spheretree::tests
