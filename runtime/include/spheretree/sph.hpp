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
  std::size_t levels = std::numeric_limits<std::size_t>::max();  ///< deepest prefix wanted, root included
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
/// Fails with UnreadableInput and a sentence naming line and reason. Allocates at most a small multiple of
/// text.size(). With limits.levels = K only the rows of the first K levels are parsed and no metadata is
/// looked for beyond them. O(bytes read).
Result<SphFile> parseSph(std::string_view text, SphLoadLimits limits = {});

/// Writes the strict dialect: five numbers a row, `%.9g`, unused slots `0 0 0 -1 0`, then the metadata as
/// `# key: value` lines. parseSph of the result gives the same tree, bit for bit.
///
/// Fails with InvalidArgument when a node has more than `branch` children, when the full table would need
/// more than kMaxSphRows rows, or when a metadata key or value holds a line break.
Result<std::string> formatSph(const SphereTree& tree, std::uint32_t branch,
                              const std::vector<std::pair<std::string, std::string>>& metadata = {});

/// A `.sph` table is complete: branch^depth slots on each level. This many rows is where writing one stops.
inline constexpr std::uint64_t kMaxSphRows = 100'000'000;

}  // namespace spheretree
