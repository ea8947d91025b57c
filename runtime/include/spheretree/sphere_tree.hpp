// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <spheretree/result.hpp>
#include <spheretree/sphere.hpp>

namespace spheretree {

/// The parent of the root.
inline constexpr std::uint32_t kNoParent = 0xffffffffU;

/// One ball of a tree. Nodes are stored breadth-first, so the children of a node are a contiguous run.
struct Node {
  Sphere ball;
  std::uint32_t parent = kNoParent;  ///< index of the parent node; kNoParent for the root
  std::uint32_t firstChild = 0;      ///< index of the first child; meaningless when childCount is 0
  std::uint32_t childCount = 0;
};

/// An immutable hierarchy of balls, breadth-first, each level one contiguous run of nodes.
///
/// Level 0 is the root alone. Const members may be called from any number of threads.
class SphereTree {
 public:
  /// A ball and its place in the hierarchy, as builders and readers hand them over.
  struct Entry {
    Sphere ball;
    std::uint32_t parent = kNoParent;  ///< index into the same list
  };

  /// Makes a tree from balls listed breadth-first: parents before children, siblings side by side, in the
  /// order of their parents. Fails with InvalidArgument, naming the entry, on an empty list, a non-finite
  /// number, a negative radius or a broken order. O(n).
  static Result<SphereTree> create(std::span<const Entry> entries);

  [[nodiscard]] std::size_t levelCount() const noexcept { return levelStart_.size() - 1; }
  [[nodiscard]] std::span<const Node> nodes() const noexcept { return nodes_; }
  [[nodiscard]] const Node& root() const noexcept { return nodes_.front(); }

  /// The nodes at `depth` (0 is the root). `depth` must be below levelCount().
  [[nodiscard]] std::span<const Node> level(std::size_t depth) const noexcept;

  /// The children of a node of this tree, possibly none.
  [[nodiscard]] std::span<const Node> children(const Node& node) const noexcept;

  /// The largest number of children of any node.
  [[nodiscard]] std::uint32_t maxChildren() const noexcept { return maxChildren_; }

 private:
  SphereTree() = default;

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> levelStart_;  // levelCount + 1 entries
  std::uint32_t maxChildren_ = 0;
};

}  // namespace spheretree
