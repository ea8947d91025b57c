// SPDX-License-Identifier: MIT
#include "tree_search.hpp"

#include <system_error>
#include <utility>

namespace crowded_room {

using spheretree::Result;

namespace {

namespace fs = std::filesystem;

/// The folder of the running program; empty where the system does not tell.
fs::path programFolder() {
  std::error_code ignored;
  return fs::read_symlink("/proc/self/exe", ignored).parent_path();
}

}  // namespace

std::vector<fs::path> treeFolders() {
  std::vector<fs::path> folders{fs::path("build") / "run"};
  const fs::path home = programFolder();
  if (!home.empty()) {
    folders.push_back((home / "../../../run").lexically_normal());  // from build/release/runtime/demo
    folders.push_back((home / "../share/spheretree/trees").lexically_normal());
  }
  return folders;
}

Result<FoundTrees> findTrees(const fs::path& folder) {
  const std::vector<fs::path> folders = folder.empty() ? treeFolders() : std::vector{folder};
  Result<TreeLibrary> library = TreeLibrary::loadFirst(folders);
  if (library) return FoundTrees{std::move(*library), {}};
  const bool none = library.error().message == howToMakeTrees(folders.front());
  if (!folder.empty() || !none) return library.error();
  return FoundTrees{TreeLibrary::builtIn(),
                    "no sphere trees in ./build/run, so there are boxes only; `./bootstrap run` makes the bunny's, "
                    "--trees DIR names another folder"};
}

}  // namespace crowded_room
