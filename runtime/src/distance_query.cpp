// SPDX-License-Identifier: MIT
//
// Distance between sphere trees by branch and bound, after S. Quinlan, "Efficient distance computation
// between non-convex objects", ICRA 1994.
//
// Every point of a surface lies in a chain of balls from the root down. Two such points are therefore at
// least as far apart as the balls of any pair along their two chains, and the largest gap on the way down is
// a lower bound for all of them. No point of a ball is farther from its solid than the stand-off of its
// level, so any pair of balls gives an upper bound.

#include <spheretree/distance_query.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>

#include "pair_walk.hpp"
#include "relative_pose.hpp"

namespace spheretree {

namespace {

using Clock = std::chrono::steady_clock;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kRoundDown = 1 - 0x1p-21F;
constexpr float kRoundUp = 1 + 0x1p-21F;

class Search {
 public:
  Search(const QueryTree& a, const QueryTree& b, const detail::RelativePose& pose, const QueryLimits& limits)
      : a_(a),
        b_(b),
        pose_(pose),
        limits_(limits),
        lastLevel_(std::min(limits.deepestLevel,
                            static_cast<std::uint32_t>(std::max(a.levelCount(), b.levelCount()) - 1))),
        margin_(detail::marginOf(pose, a.extent(), b.extent())) {}

  /// In the units of B.
  DistanceBounds run() noexcept;

 private:
  using Gaps = std::array<float, kBlockLanes * kBlockLanes>;

  [[nodiscard]] bool spent() noexcept;
  [[nodiscard]] float gapOf(const Sphere& placedA, const Sphere& b) const noexcept;
  void see(float gap, std::uint32_t level) noexcept;
  void visit(QueryTree::Family a, QueryTree::Family b, std::uint32_t level, float inherited) noexcept;
  void visitBlocks(std::uint32_t blockA, std::uint32_t lanesA, std::uint32_t blockB, std::uint32_t lanesB,
                   std::uint32_t level, float inherited) noexcept;

  const QueryTree& a_;
  const QueryTree& b_;
  const detail::RelativePose& pose_;
  const QueryLimits& limits_;
  std::uint32_t lastLevel_;
  float margin_;
  std::uint64_t tests_ = 1;
  float nearest_ = kInfinity;  // smallest lower bound of a pair on the last level
  float skipped_ = kInfinity;  // smallest lower bound of a pair that the budget left out
  float upper_ = kInfinity;
  Clock::time_point start_ = limits_.microseconds < kInfinity ? Clock::now() : Clock::time_point{};
};

bool Search::spent() noexcept {
  if (tests_ - 1 >= limits_.sphereTests) return true;
  if (!(limits_.microseconds < kInfinity)) return false;
  return std::chrono::duration<float, std::micro>(Clock::now() - start_).count() >= limits_.microseconds;
}

/// A lower bound: the margin is more than rounding takes away.
float Search::gapOf(const Sphere& placedA, const Sphere& b) const noexcept {
  return length(b.center - placedA.center) * kRoundDown - (placedA.radius + b.radius);
}

void Search::see(float gap, std::uint32_t level) noexcept {
  const float standOff = pose_.scale * a_.standOff(level) + b_.standOff(level);
  upper_ = std::min(upper_, std::max(0.0F, gap + 3 * margin_) * kRoundUp + standOff * kRoundUp);
}

DistanceBounds Search::run() noexcept {
  if (!(margin_ < kInfinity)) return {0, kInfinity, false, 0};
  const float gap = gapOf(detail::place(pose_, a_.root(), margin_), b_.root());
  see(gap, 0);
  if (lastLevel_ == 0) {
    nearest_ = gap;
  } else {
    visit(a_.rootFamily(), b_.rootFamily(), 1, gap);
  }
  const float lower = std::max(0.0F, std::min(nearest_, skipped_));
  return {lower, std::max(lower, upper_), !(skipped_ < nearest_), tests_};
}

void Search::visit(QueryTree::Family a, QueryTree::Family b, std::uint32_t level, float inherited) noexcept {
  for (std::uint32_t i = 0; i <= a.further; ++i) {
    const std::uint32_t lanesA = i == 0 ? a.lanes : a_.lanes(a.block + i);
    for (std::uint32_t j = 0; j <= b.further; ++j) {
      if (spent()) {
        skipped_ = std::min(skipped_, inherited);
        return;
      }
      visitBlocks(a.block + i, lanesA, b.block + j, j == 0 ? b.lanes : b_.lanes(b.block + j), level,
                  inherited);
    }
  }
}

void Search::visitBlocks(std::uint32_t blockA, std::uint32_t lanesA, std::uint32_t blockB,
                         std::uint32_t lanesB, std::uint32_t level, float inherited) noexcept {
  Gaps gaps;
  gaps.fill(kInfinity);
  tests_ += detail::kTestsPerStep;
  for (std::uint32_t i = 0; i < kBlockLanes; ++i) {
    if ((lanesA >> i & 1U) == 0) continue;
    const Sphere placed = detail::place(pose_, a_.ball(blockA, i), margin_);
    for (std::uint32_t j = 0; j < kBlockLanes; ++j) {
      if ((lanesB >> j & 1U) == 0) continue;
      const float gap = gapOf(placed, b_.ball(blockB, j));
      see(gap, level);
      gaps[j * kBlockLanes + i] = std::max(inherited, gap);
    }
  }
  if (level == lastLevel_) {
    nearest_ = std::min(nearest_, *std::min_element(gaps.begin(), gaps.end()));
    return;
  }
  for (;;) {
    const auto first = std::min_element(gaps.begin(), gaps.end());
    if (!(*first < nearest_) || nearest_ <= 0) return;
    const auto pair = static_cast<std::uint32_t>(first - gaps.begin());
    const float gap = *first;
    *first = kInfinity;
    visit(a_.family(blockA, pair % kBlockLanes), b_.family(blockB, pair / kBlockLanes), level + 1, gap);
  }
}

}  // namespace

DistanceBounds distanceBetween(const QueryTree& a, const Pose& poseA, const QueryTree& b, const Pose& poseB,
                               const QueryLimits& limits) noexcept {
  const detail::RelativePose pose = detail::relativePose(poseA, poseB);
  DistanceBounds bounds = Search(a, b, pose, limits).run();
  bounds.lower *= poseB.scale * kRoundDown;
  bounds.upper *= poseB.scale * kRoundUp;
  return bounds;
}

}  // namespace spheretree
