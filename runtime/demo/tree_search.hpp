// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <spheretree/result.hpp>

#include "tree_library.hpp"

namespace crowded_room {

/// Where trees are looked for when the user names no folder, in this order: build/run under the current
/// folder, the same beside the build that the program lies in, share/spheretree/trees of the installation
/// that it lies in.
[[nodiscard]] std::vector<std::filesystem::path> treeFolders();

/// Trees, and what to tell the user about them.
struct FoundTrees {
  TreeLibrary library;
  std::string remark;  ///< one sentence, or empty
};

/// The trees of `folder`; when it is empty, those of the first of treeFolders() that has any; when there are
/// none, the built-in box, with a remark how to make others. Fails as TreeLibrary::load().
spheretree::Result<FoundTrees> findTrees(const std::filesystem::path& folder);

}  // namespace crowded_room
