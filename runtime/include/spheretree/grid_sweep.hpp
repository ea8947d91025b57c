// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <spheretree/broad_phase.hpp>
#include <spheretree/grid.hpp>

namespace spheretree {

/// A regular grid whose voxels each run Sweep & Prune along x, over boxes kept in order from call to call.
///
/// Better than Grid where voxels are crowded.
class GridSweep final : public BroadPhase {
 public:
  explicit GridSweep(GridResolution resolution = {}) noexcept : voxels_(resolution) {}

  Result<Done> findPairs(std::span<const Aabb> boxes, std::vector<BodyPair>& pairs) override;

 private:
  void sortBodies(std::span<const Aabb> boxes);

  detail::VoxelFile voxels_;
  std::vector<std::uint32_t> order_;  // bodies by the begin of their box along x, as of the last call
  std::vector<BodyPair> scratch_;
};

}  // namespace spheretree
