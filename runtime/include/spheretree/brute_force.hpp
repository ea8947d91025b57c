// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include <spheretree/broad_phase.hpp>

namespace spheretree {

/// Tests every box against every other. O(n^2), no memory of its own: for a handful of bodies, and the judge
/// of all other engines.
class BruteForce final : public BroadPhase {
 public:
  BruteForce() = default;

  Result<Done> findPairs(std::span<const Aabb> boxes, std::vector<BodyPair>& pairs) override;
};

}  // namespace spheretree
