// SPDX-License-Identifier: MIT
//
// An immutable hierarchy of balls in breadth-first order.
//
// One rule makes a list breadth-first: the root comes first, every parent precedes its children, and parents
// never decrease along the list. Siblings are then neighbours, in the order of their parents, and depths
// never decrease either, so each level is one contiguous run.

#include <spheretree/sphere_tree.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

namespace spheretree {

namespace {

Error invalidEntry(std::size_t index, const char* reason) {
  return {ErrorCode::InvalidArgument, "entry " + std::to_string(index) + ": " + reason};
}

bool isFinite(const Sphere& ball) noexcept {
  return std::isfinite(ball.center.x) && std::isfinite(ball.center.y) && std::isfinite(ball.center.z) &&
         std::isfinite(ball.radius);
}

/// What is wrong with one entry, or nullptr.
const char* flawOf(std::span<const SphereTree::Entry> entries, std::size_t index) noexcept {
  const SphereTree::Entry& entry = entries[index];
  if (!isFinite(entry.ball)) return "the centre or the radius is not a finite number";
  if (entry.ball.radius < 0) return "the radius is negative";
  if (index == 0) return entry.parent == kNoParent ? nullptr : "the first entry must be the root";
  if (entry.parent == kNoParent) return "only the first entry may be a root";
  if (entry.parent >= index) return "a parent must come before its children";
  if (index > 1 && entry.parent < entries[index - 1].parent) {
    return "siblings must stand side by side, in the order of their parents";
  }
  return nullptr;
}

}  // namespace

Result<SphereTree> SphereTree::create(std::span<const Entry> entries) {
  if (entries.empty()) return Error{ErrorCode::InvalidArgument, "a sphere tree needs at least a root"};
  if (entries.size() >= kNoParent) {
    return Error{ErrorCode::InvalidArgument,
                 std::to_string(entries.size()) + " spheres are more than a tree can index"};
  }
  SphereTree tree;
  tree.nodes_.reserve(entries.size());
  tree.levelStart_.push_back(0);
  std::uint32_t levelBegin = 0;  // of the level that is being filled
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (const char* flaw = flawOf(entries, i)) return invalidEntry(i, flaw);
    const auto index = static_cast<std::uint32_t>(i);
    Node node{entries[i].ball, entries[i].parent, 0, 0};
    node.ball.radius += 0.0F;  // minus zero becomes zero: a sign bit marks unused slots in files
    if (i > 0) {
      if (node.parent >= levelBegin) {
        levelBegin = index;
        tree.levelStart_.push_back(index);
      }
      Node& parent = tree.nodes_[node.parent];
      if (parent.childCount++ == 0) parent.firstChild = index;
      tree.maxChildren_ = std::max(tree.maxChildren_, parent.childCount);
    }
    tree.nodes_.push_back(node);
  }
  tree.levelStart_.push_back(static_cast<std::uint32_t>(entries.size()));
  return tree;
}

std::span<const Node> SphereTree::level(std::size_t depth) const noexcept {
  assert(depth < levelCount());
  return nodes().subspan(levelStart_[depth], levelStart_[depth + 1] - levelStart_[depth]);
}

std::span<const Node> SphereTree::children(const Node& node) const noexcept {
  if (node.childCount == 0) return {};
  return nodes().subspan(node.firstChild, node.childCount);
}

}  // namespace spheretree
