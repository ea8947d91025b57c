// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <spheretree/aabb.hpp>
#include <spheretree/result.hpp>
#include <spheretree/sph.hpp>
#include <spheretree/sphere_tree.hpp>

namespace spheretree {

/// Most levels, root included, of a tree that queries accept.
inline constexpr std::size_t kMaxQueryLevels = 16;

/// Balls that are tested in one step: as many as one AVX register has floats.
inline constexpr std::uint32_t kBlockLanes = 8;

/// Eight balls side by side, coordinate by coordinate. Lanes without a ball hold zeros.
struct alignas(32) BallBlock {
  std::array<float, kBlockLanes> x{};
  std::array<float, kBlockLanes> y{};
  std::array<float, kBlockLanes> z{};
  std::array<float, kBlockLanes> radius{};
};

/// A sphere tree laid out for queries: the children of a node stand in one block of eight (in several blocks
/// when they are more than eight), blocks breadth-first. Immutable; any number of threads may query it.
///
/// 585 balls of four levels take less than 10,000 bytes. A node without children above the last level stands
/// for itself on all levels below.
class QueryTree {
 public:
  /// The blocks that hold the children of a node.
  struct Family {
    std::uint32_t block = 0;   ///< the first of them
    std::uint8_t lanes = 0;    ///< bit i set: lane i of the first block is a child
    std::uint8_t further = 0;  ///< how many more blocks follow
  };

  /// Lays a tree out. O(n).
  ///
  /// `standOff[k]` is how far level k may stick out of the solid at most, in mesh units: the certified upper
  /// bound `overhang-worst` of reports. Without it (empty) twice the largest radius of the level is taken,
  /// which is right whenever every ball of the level holds at least one point of the solid.
  ///
  /// Fails with InvalidArgument when `standOff` is neither empty nor one finite number >= 0 per level, when
  /// the tree has more than kMaxQueryLevels levels, a node more than 2048 children, or all nodes need more
  /// than 2^24 blocks.
  static Result<QueryTree> create(const SphereTree& tree, std::span<const float> standOff = {});

  [[nodiscard]] std::size_t levelCount() const noexcept { return levelCount_; }
  [[nodiscard]] const Sphere& root() const noexcept { return root_; }

  /// Upper bound on how far the balls of a level stick out of the solid, together with the balls above that
  /// have no children; mesh units. Levels below the last are the last. A finer level may stick out farther.
  [[nodiscard]] float standOff(std::size_t level) const noexcept {
    return standOff_[level < levelCount_ ? level : levelCount_ - 1];
  }

  /// Largest distance of a point of any ball from the origin of the tree's own frame.
  [[nodiscard]] float extent() const noexcept { return extent_; }
  /// A box that holds the surface: every level covers it, so the boxes of all levels cut each other down.
  [[nodiscard]] const Aabb& bounds() const noexcept { return bounds_; }

  [[nodiscard]] std::span<const BallBlock> blocks() const noexcept { return blocks_; }
  /// The children of the root, or the root itself when it has none.
  [[nodiscard]] Family rootFamily() const noexcept { return familyOf(rootLink_); }
  /// The children of a ball, or the ball itself when it has none.
  [[nodiscard]] Family family(std::uint32_t block, std::uint32_t lane) const noexcept {
    if (block < innerBlocks_) return familyOf(links_[block * kBlockLanes + lane]);
    return {block, static_cast<std::uint8_t>(1U << lane), 0};
  }
  /// Which lanes of a block hold balls.
  [[nodiscard]] std::uint8_t lanes(std::uint32_t block) const noexcept { return lanes_[block]; }
  [[nodiscard]] Sphere ball(std::uint32_t block, std::uint32_t lane) const noexcept {
    const BallBlock& b = blocks_[block];
    return {{b.x[lane], b.y[lane], b.z[lane]}, b.radius[lane]};
  }

  /// What the tree occupies, this object included.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  QueryTree() = default;

  // A link is the first block of a family, shifted, and its lanes. Only whole blocks have followers: a link
  // to one lane of a block that is full therefore never reads as a longer family.
  static constexpr std::uint32_t kLaneBits = 8;
  static constexpr std::uint32_t kAllLanes = (1U << kLaneBits) - 1;

  [[nodiscard]] Family familyOf(std::uint32_t link) const noexcept {
    const std::uint32_t block = link >> kLaneBits;
    const std::uint32_t lanes = link & kAllLanes;
    const std::uint8_t further = lanes == kAllLanes ? further_[block] : std::uint8_t{0};
    return {block, static_cast<std::uint8_t>(lanes), further};
  }

  friend class QueryTreeBuilder;

  std::vector<BallBlock> blocks_;
  std::vector<std::uint32_t> links_;   // of the lanes of the first innerBlocks_ blocks
  std::vector<std::uint8_t> lanes_;    // per block
  std::vector<std::uint8_t> further_;  // per block: blocks of the same family behind it
  std::array<float, kMaxQueryLevels> standOff_{};
  Sphere root_;
  Aabb bounds_;
  float extent_ = 0;
  std::uint32_t rootLink_ = 0;
  std::uint32_t innerBlocks_ = 0;
  std::uint32_t levelCount_ = 0;
};

/// The certified stand-off of each level that was loaded, in mesh units, from the metadata that `spheretree`
/// writes (`mesh-diagonal`, `level-K`, `wrap-stand-off`), enlarged by what six printed digits may have lost.
/// Empty when the file does not say, as files of other tools and files read by SphLoadLimits do not.
[[nodiscard]] std::vector<float> standOffsOf(const SphFile& file);

}  // namespace spheretree
