// SPDX-License-Identifier: GPL-3.0-or-later
//
// Two locks, which the kernel drops with the process: a shard shares the folder with the other shards, a run
// of everything shares it with nobody; and each has its own journal to itself.

#include "io/batch_journal.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <sstream>
#include <system_error>
#include <thread>
#include <utility>

#include <nlohmann/json.hpp>

#include "io/files.hpp"

namespace spheretree::io {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// A killed run's last child may live on for a moment.
constexpr std::chrono::seconds kLockPatience{2};
constexpr std::chrono::milliseconds kLockPause{20};
constexpr mode_t kNewFileMode = 0666;  // less the umask, as for any program

Error unwritable(const fs::path& path, const std::string& why) {
  return {ErrorCode::UnwritableOutput, path.string() + ": " + why};
}

/// False only when somebody else has it: file systems without locks (some network disks) are used without.
bool lock(int descriptor, int how) {
  const auto until = std::chrono::steady_clock::now() + kLockPatience;
  while (::flock(descriptor, how | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return true;
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(kLockPause);
  }
  return true;
}

/// Whether the name still leads to the file that is open: another run may have removed it meanwhile.
bool isStill(int descriptor, const fs::path& path) {
  struct stat opened {};
  struct stat named {};
  return ::fstat(descriptor, &opened) == 0 && ::stat(path.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

BuildCosts costsOf(const std::string& text) {
  BuildCosts costs;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const Json json = Json::parse(line, nullptr, false);
    if (!json.is_object()) continue;
    costs[json.value("output", "")] = {json.value("seconds", 0.0),
                                       json.value("peak_memory_bytes", std::uint64_t{0}),
                                       json.value("threads", 0U)};
  }
  return costs;
}

}  // namespace

Result<BatchJournal> BatchJournal::open(const fs::path& folder, const std::optional<Shard>& shard) {
  std::string name = ".spheretree-batch";
  if (shard) name += "-" + std::to_string(shard->index) + "-of-" + std::to_string(shard->count);
  const fs::path path = folder / name;
  const int place = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (place < 0) return unwritable(folder, std::generic_category().message(errno));
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, kNewFileMode);
  if (file < 0) {
    const Error error = unwritable(folder, std::generic_category().message(errno));
    ::close(place);
    return error;
  }
  BatchJournal journal(path, place, file);
  if (!lock(place, shard ? LOCK_SH : LOCK_EX) || !lock(file, LOCK_EX) || !isStill(file, path))
    return unwritable(folder, "another batch is writing there");
  const Result<std::string> text = readFile(path);
  if (text) journal.costs_ = costsOf(*text);
  // A torn last line must not swallow the next one.
  if (text && !text->empty() && text->back() != '\n' && ::write(file, "\n", 1) != 1)
    return unwritable(path, std::generic_category().message(errno));
  return journal;
}

BatchJournal::BatchJournal(fs::path path, int folder, int file) noexcept
    : path_(std::move(path)), folder_(folder), file_(file) {}

BatchJournal::BatchJournal(BatchJournal&& other) noexcept
    : path_(std::move(other.path_)),
      folder_(std::exchange(other.folder_, -1)),
      file_(std::exchange(other.file_, -1)),
      costs_(std::move(other.costs_)) {}

BatchJournal::~BatchJournal() {
  for (const int descriptor : {file_, folder_}) {
    if (descriptor >= 0) ::close(descriptor);
  }
}

void BatchJournal::add(const std::string& output, const BuildCost& cost) {
  costs_[output] = cost;
  const Json json = {{"output", output},
                     {"seconds", cost.seconds},
                     {"peak_memory_bytes", cost.peakMemoryBytes},
                     {"threads", cost.threads}};
  const std::string line = json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  static_cast<void>(::write(file_, line.data(), line.size()) == 0);
}

void BatchJournal::remove() noexcept {
  ::unlink(path_.c_str());
}

}  // namespace spheretree::io
