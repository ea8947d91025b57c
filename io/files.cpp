// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whole files in, whole files out. Writing follows the usual recipe: a temporary file in the same folder,
// created exclusively, written, fsync()ed, renamed, and the folder fsync()ed, so that a crash leaves the old
// or the new file. Refusing to replace is left to the kernel (RENAME_NOREPLACE, else link()), which knows no
// race. Devices and pipes cannot be renamed over and hold nothing to lose: they are written straight.

#include "io/files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <optional>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

#include "io/hash_text.hpp"

namespace spheretree::io {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kReadChunk = std::size_t{1} << 20;
// A file name holds 255 bytes; this much of it is repeated in the temporary name, the rest is for the suffix.
constexpr std::size_t kNameInTemporary = 200;
constexpr std::string_view kTemporaryMark = ".tmp-";
// Leftovers of a killed process with the same number are skipped, this many of them.
constexpr int kTemporaryAttempts = 100;
constexpr mode_t kNewFileMode = 0666;  // less the umask, as for any program

std::string reason(int code) {
  return std::generic_category().message(code);
}

Error unreadable(const fs::path& path, const std::string& why) {
  return {ErrorCode::UnreadableInput, path.string() + ": " + why};
}

Error unwritable(const fs::path& path, const std::string& why) {
  return {ErrorCode::UnwritableOutput, path.string() + ": " + why};
}

Error alreadyThere(const fs::path& path) {
  return unwritable(path, "exists already");
}

/// Owns a file descriptor.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  [[nodiscard]] bool valid() const { return number_ >= 0; }
  [[nodiscard]] int number() const { return number_; }
  /// 0 or the error number: a full network disk may only speak up here.
  int close() { return ::close(std::exchange(number_, -1)) == 0 ? 0 : errno; }

 private:
  int number_;
};

/// 0 or an error number.
int writeAll(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

/// Where bytes for `path` end up: what a symbolic link leads to, otherwise the path itself.
fs::path throughLinks(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_symlink(path, ignored)) return path;
  const fs::path target = fs::weakly_canonical(path, ignored);
  return target.empty() ? path : target;
}

std::optional<struct stat> statusOf(const fs::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return std::nullopt;
  return status;
}

bool isStream(const struct stat& status) {
  return S_ISCHR(status.st_mode) || S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode);
}

Result<Done> writeStream(const fs::path& path, std::string_view bytes) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY));
  if (!file.valid()) return unwritable(path, reason(errno));
  if (const int code = writeAll(file.number(), bytes)) return unwritable(path, reason(code));
  if (const int code = file.close()) return unwritable(path, reason(code));
  return Done{};
}

/// What the names of all temporary files for `target` begin with; a process number and a count follow.
std::string temporaryStem(const fs::path& target) {
  return "." + target.filename().string().substr(0, kNameInTemporary) + std::string(kTemporaryMark);
}

/// A file that goes away unless it was moved to its place.
class TemporaryFile {
 public:
  static Result<TemporaryFile> create(const fs::path& target) {
    fs::path folder = target.parent_path();
    if (folder.empty()) folder = ".";
    const std::string stem = temporaryStem(target) + std::to_string(::getpid());
    for (int attempt = 0; attempt < kTemporaryAttempts; ++attempt) {
      fs::path path = folder / (stem + "-" + std::to_string(attempt));
      Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kNewFileMode));
      if (file.valid()) return TemporaryFile(std::move(path), std::move(file));
      if (errno != EEXIST) return unwritable(target, "cannot write in its folder: " + reason(errno));
    }
    return unwritable(target, "its folder is full of abandoned temporary files");
  }

  TemporaryFile(TemporaryFile&& other) noexcept
      : path_(std::exchange(other.path_, {})), file_(std::move(other.file_)) {}
  TemporaryFile& operator=(TemporaryFile&&) = delete;
  ~TemporaryFile() {
    if (!path_.empty()) ::unlink(path_.c_str());
  }

  /// 0 or an error number.
  int fill(std::string_view bytes, mode_t mode) {
    if (mode != 0 && ::fchmod(file_.number(), mode) != 0) return errno;
    if (const int code = writeAll(file_.number(), bytes)) return code;
    if (::fsync(file_.number()) != 0) return errno;
    return file_.close();
  }

  /// 0 or an error number; EEXIST when `target` is there and may not be replaced.
  int moveTo(const fs::path& target, Overwrite overwrite) {
    if (overwrite == Overwrite::Replace) {
      if (::rename(path_.c_str(), target.c_str()) != 0) return errno;
      path_.clear();
      return 0;
    }
    if (::renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, target.c_str(), RENAME_NOREPLACE) == 0) {
      path_.clear();
      return 0;
    }
    if (errno != EINVAL && errno != ENOSYS) return errno;
    return ::link(path_.c_str(), target.c_str()) == 0 ? 0 : errno;  // file systems that know no such flag
  }

 private:
  TemporaryFile(fs::path path, Descriptor file) : path_(std::move(path)), file_(std::move(file)) {}

  fs::path path_;
  Descriptor file_;
};

/// Makes the new name itself survive a crash. Some file systems cannot; the bytes are safe either way.
void syncFolderOf(const fs::path& path) {
  const fs::path folder = path.parent_path();
  const Descriptor descriptor(
      ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (descriptor.valid()) ::fsync(descriptor.number());
}

/// What keeps a file from being put at `target`, before anything is written.
std::optional<Error> obstacle(const fs::path& path, const fs::path& target, Overwrite overwrite) {
  if (path.filename().empty() || path.filename() == "." || path.filename() == "..")
    return unwritable(path, "is not the name of a file");
  const std::optional<struct stat> status = statusOf(target);
  if (status && S_ISDIR(status->st_mode)) return unwritable(path, "is a directory");
  if (status && overwrite == Overwrite::Refuse) return alreadyThere(path);
  fs::path folder = target.parent_path();
  if (folder.empty()) folder = ".";
  const std::optional<struct stat> folderStatus = statusOf(folder);
  if (!folderStatus) return unwritable(path, "folder " + folder.string() + ": " + reason(errno));
  if (!S_ISDIR(folderStatus->st_mode)) return unwritable(path, folder.string() + " is not a folder");
  return std::nullopt;
}

}  // namespace

Result<std::string> readFile(const fs::path& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY));
  if (!file.valid()) return unreadable(path, reason(errno));
  struct stat status {};
  if (::fstat(file.number(), &status) != 0) return unreadable(path, reason(errno));
  if (S_ISDIR(status.st_mode)) return unreadable(path, "is a directory");
  try {
    std::string bytes;
    if (S_ISREG(status.st_mode)) bytes.reserve(static_cast<std::size_t>(status.st_size) + 1);
    while (true) {
      const std::size_t before = bytes.size();
      bytes.resize(before + std::max(std::size_t{1}, std::min(kReadChunk, bytes.capacity() - before)));
      const ssize_t got = ::read(file.number(), bytes.data() + before, bytes.size() - before);
      bytes.resize(before + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) return unreadable(path, reason(errno));
      if (got == 0) return bytes;
      if (bytes.size() == bytes.capacity()) bytes.reserve(bytes.size() + kReadChunk);
    }
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::Internal, path.string() + ": not enough memory for the whole file"};
  }
}

Result<Done> writeFileAtomically(const fs::path& path, std::string_view bytes, Overwrite overwrite) {
  const fs::path target = throughLinks(path);
  const std::optional<struct stat> old = statusOf(target);
  if (old && isStream(*old)) return writeStream(path, bytes);
  if (const std::optional<Error> error = obstacle(path, target, overwrite)) return *error;

  Result<TemporaryFile> temporary = TemporaryFile::create(target);
  if (!temporary) return temporary.error();
  const mode_t mode = old ? old->st_mode & mode_t{07777} : mode_t{0};
  if (const int code = temporary->fill(bytes, mode)) return unwritable(path, reason(code));
  if (const int code = temporary->moveTo(target, overwrite))
    return code == EEXIST ? alreadyThere(path) : unwritable(path, reason(code));
  syncFolderOf(target);
  return Done{};
}

Result<Done> checkWritable(const fs::path& path, Overwrite overwrite) {
  const fs::path target = throughLinks(path);
  const std::optional<struct stat> old = statusOf(target);
  if (old && isStream(*old)) {
    if (::access(target.c_str(), W_OK) != 0) return unwritable(path, reason(errno));
    return Done{};
  }
  if (const std::optional<Error> error = obstacle(path, target, overwrite)) return *error;
  // Permissions, read-only mounts, quotas: making the temporary file is the only question with a sure answer.
  const Result<TemporaryFile> temporary = TemporaryFile::create(target);
  if (!temporary) return temporary.error();
  return Done{};
}

std::size_t removeLeftovers(std::span<const fs::path> targets) {
  std::set<fs::path> folders;
  std::set<fs::path> stems;
  for (const fs::path& target : targets) {
    folders.insert(target.parent_path());
    stems.insert(target.parent_path() / temporaryStem(target));
  }
  std::vector<fs::path> leftovers;
  for (const fs::path& folder : folders) {
    std::error_code failure;
    for (fs::directory_iterator it(folder.empty() ? "." : folder, failure), end; !failure && it != end;
         it.increment(failure)) {
      const std::string name = it->path().filename().string();
      const std::size_t mark = name.rfind(kTemporaryMark);
      if (name.front() != '.' || mark == std::string::npos) continue;
      if (stems.count(folder / name.substr(0, mark + kTemporaryMark.size())) > 0)
        leftovers.push_back(it->path());
    }
  }
  std::size_t removed = 0;
  for (const fs::path& leftover : leftovers) removed += ::unlink(leftover.c_str()) == 0 ? 1U : 0U;
  return removed;
}

std::string lowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return text;
}

std::string endingOf(const fs::path& path) {
  return lowerCase(path.extension().string());
}

std::string contentHash(std::string_view bytes) {
  return hashText(XXH3_128bits(bytes.data(), bytes.size()));
}

std::string hashText(const XXH128_hash_t& hash) {
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, hash);
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string hex;
  for (const unsigned char byte : canonical.digest) {
    hex += kDigits[byte >> 4U];
    hex += kDigits[byte & 15U];
  }
  return hex;
}

}  // namespace spheretree::io
