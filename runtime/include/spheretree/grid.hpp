// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <spheretree/broad_phase.hpp>

namespace spheretree {

/// Voxels along each axis. Zero on any axis: chosen from the boxes in every call.
struct GridResolution {
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  std::uint32_t z = 0;
};

/// The room of the paper.
inline constexpr GridResolution kPaperGrid{10, 4, 10};

namespace detail {

/// Boxes filed by voxel: what Grid and GridSweep have in common. Rebuilt in every call.
class VoxelFile {
 public:
  explicit VoxelFile(GridResolution resolution) noexcept : given_(resolution) {}

  /// Files boxes by all voxels they touch; within a voxel in the order of `order`.
  void file(std::span<const Aabb> boxes, std::span<const std::uint32_t> order);

  [[nodiscard]] std::size_t voxelCount() const noexcept { return begins_.empty() ? 0 : begins_.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> voxel(std::size_t index) const noexcept {
    return std::span(bodies_).subspan(begins_[index], begins_[index + 1] - begins_[index]);
  }

  /// Of the voxels that two overlapping boxes share, the one that delivers the pair.
  [[nodiscard]] std::size_t owner(std::uint32_t a, std::uint32_t b) const noexcept;

 private:
  struct Range {
    std::array<std::uint16_t, 3> first;
    std::array<std::uint16_t, 3> last;
  };

  void chooseVoxels(std::size_t present, const Aabb& bounds,
                    const std::array<double, 3>& meanExtent) noexcept;
  std::size_t findRanges(std::span<const Aabb> boxes, const Aabb& bounds);
  [[nodiscard]] std::size_t indexOf(std::size_t x, std::size_t y, std::size_t z) const noexcept;
  template <class Visit>
  void forEachVoxel(const Range& range, Visit visit) const;

  GridResolution given_;
  std::array<std::uint32_t, 3> voxels_{1, 1, 1};
  std::vector<Range> ranges_;  // per body
  std::vector<std::uint32_t> begins_;
  std::vector<std::uint32_t> bodies_;
};

}  // namespace detail

/// A regular grid over the bounds of all boxes; boxes are tested against those they share a voxel with.
///
/// O(n + pairs) for boxes of similar size that fill their bounds evenly; a few far or large boxes spoil it.
class Grid final : public BroadPhase {
 public:
  explicit Grid(GridResolution resolution = {}) noexcept : voxels_(resolution) {}

  Result<Done> findPairs(std::span<const Aabb> boxes, std::vector<BodyPair>& pairs) override;

 private:
  detail::VoxelFile voxels_;
  std::vector<std::uint32_t> order_;
  std::vector<BodyPair> scratch_;
};

}  // namespace spheretree
