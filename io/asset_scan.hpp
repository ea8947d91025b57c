// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include <spheretree/result.hpp>

namespace spheretree::io {

/// What can be known of a mesh file without parsing it.
struct AssetScan {
  std::string contentHash;  ///< XXH3-128 of the file and of the buffers that a .gltf names
  std::uint64_t bytes = 0;  ///< of the file
  std::uint64_t triangleGuess =
      0;  ///< right within a factor of a few: from a header, from lines, or from bytes
};

/// Reads the file once, piece by piece, in constant memory. Errors: UnreadableInput.
Result<AssetScan> scanAsset(const std::filesystem::path& path);

}  // namespace spheretree::io
