// SPDX-License-Identifier: GPL-3.0-or-later
#include "fuzz_target.hpp"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace spheretree::fuzz {

namespace {

/// A folder of this process alone, emptied and removed at its end.
class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "spheretree-fuzz-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) failOn("no temporary folder can be made");
    path_ = pattern;
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace

void failOn(const std::string& flaw) {
  if (flaw.empty()) return;
  std::fprintf(stderr, "flaw: %s\n", flaw.c_str());
  std::abort();
}

std::string asFile(std::string_view bytes, std::string_view extension) {
  static const Folder folder;
  const std::string path = (folder.path() / ("input" + std::string(extension))).string();
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) failOn("the temporary file cannot be written");
  return path;
}

}  // namespace spheretree::fuzz
