// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <spheretree/result.hpp>
#include <spheretree/sphere_tree.hpp>

namespace spheretree {

/// What a caller is willing to read from a `.sph` text.
struct SphLoadLimits {
  /// Levels wanted from the top, root included; at least 1.
  std::size_t levels = std::numeric_limits<std::size_t>::max();
};

/// A tree with what its file says about it.
struct SphFile {
  SphereTree tree;
  std::uint32_t branch = 0;  ///< the branching factor of the header, at least tree.maxChildren()
  /// The `# key: value` lines after the rows, in file order. Foreign trailing text is not kept.
  std::vector<std::pair<std::string, std::string>> metadata;
  std::vector<std::string> warnings;  ///< one sentence each; the tree is usable nevertheless
};

/// Reads any `.sph` dialect of docs/file-format.md from memory.
///
/// Fails with UnreadableInput and a sentence naming line and reason, or with InvalidArgument for zero levels.
/// Allocates at most 16 bytes per byte of text and a few hundred more, whatever the text claims. With
/// limits.levels = K below the levels of the file, only the rows of the first K levels are looked at, so
/// `text` may end there, and metadata stays empty. O(bytes read). Any number of threads.
Result<SphFile> parseSph(std::string_view text, SphLoadLimits limits = {});

/// Writes the strict dialect: five numbers a row, `%.9g`, unused slots `0 0 0 -1 0`, then the metadata as
/// `# key: value` lines. parseSph of the result gives the same tree, bit for bit, with one exception: a ball
/// of radius 0 centred at the origin would read as an unused slot and is written with the smallest normal
/// radius.
///
/// Fails with InvalidArgument when a node has more than `branch` children, when the full table would need
/// more than kMaxSphRows rows, or when metadata could not be read back: a line break or NUL in a key or
/// value, a key that is empty, holds a colon, or begins or ends with a blank. O(rows).
Result<std::string> formatSph(const SphereTree& tree, std::uint32_t branch,
                              const std::vector<std::pair<std::string, std::string>>& metadata = {});

/// A `.sph` table is complete: branch^depth slots on each level. This many rows is where writing one stops.
inline constexpr std::uint64_t kMaxSphRows = 100'000'000;

}  // namespace spheretree
