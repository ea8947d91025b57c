// SPDX-License-Identifier: MIT
//
// Sphere tree against sphere tree, after P. M. Hubbard, "Approximating polyhedra with spheres for
// time-critical collision detection", ACM Transactions on Graphics 15(3), 1996: an answer at any time, with
// its error.

#include <spheretree/pair_query.hpp>

#include <algorithm>
#include <bit>
#include <cassert>
#include <chrono>
#include <cmath>
#include <limits>

#include "pair_walk.hpp"
#include "relative_pose.hpp"

namespace spheretree {

namespace {

constexpr float kRoundUp = 1 + 0x1p-21F;
/// Between two looks at the clock, which cost about as much as a step.
constexpr std::uint64_t kTestsPerLook = 8 * detail::kTestsPerStep;

Sphere laneOf(const BallBlock& block, std::uint32_t lane) noexcept {
  return {{block.x[lane], block.y[lane], block.z[lane]}, block.radius[lane]};
}

std::uint64_t saturatedSum(std::uint64_t a, std::uint64_t b) noexcept {
  return a + std::min(b, QueryLimits::kUnlimited - a);
}

using Clock = std::chrono::steady_clock;

float microsecondsSince(Clock::time_point start) noexcept {
  return std::chrono::duration<float, std::micro>(Clock::now() - start).count();
}

/// The walk with a clock beside it.
void walkTimed(detail::PairWalk& walk, const detail::WalkLimits& limits, float microseconds) noexcept {
  const detail::WalkFunction advance = detail::walkPaths(activeSimd()).pair;
  if (!(microseconds < std::numeric_limits<float>::infinity())) {
    advance(walk, limits);
    return;
  }
  const Clock::time_point start = Clock::now();
  for (;;) {
    const std::uint64_t stop = std::min(limits.tests, saturatedSum(walk.tests, kTestsPerLook));
    const detail::WalkEnd end = advance(walk, {limits.level, stop});
    if (end != detail::WalkEnd::OutOfBudget || walk.tests >= limits.tests) return;
    if (microsecondsSince(start) >= microseconds) return;
  }
}

}  // namespace

void PairQuery::restart(const Pose& a, const Pose& b) noexcept {
  assert(walk_.treeA != nullptr && walk_.treeB != nullptr);
  assert(a.scale > 0 && b.scale > 0);
  const detail::RelativePose pose = detail::relativePose(a, b);
  const Sphere& rootA = walk_.treeA->root();
  const Sphere& rootB = walk_.treeB->root();
  const float margin = detail::marginOf(pose, walk_.treeA->extent(), walk_.treeB->extent());
  const Sphere placed = detail::place(pose, rootA, margin);
  const Vec3 d = rootB.center - placed.center;
  const float reach = rootB.radius + placed.radius;
  const bool usable = margin < std::numeric_limits<float>::infinity();
  const bool apart = usable && dot(d, d) > reach * reach;
  detail::setPlacement(walk_.placement, pose, margin);
  walk_.rootA = placed;
  walk_.fresh = usable && !apart;
  walk_.depth = -1;
  walk_.reached = 0;
  walk_.tests = 1;
  poseB_ = b;
  scaleA_ = a.scale;
  handedOut_ = -1;
  answer_ = apart ? Answer::Disjoint : usable ? Answer::Undecided : Answer::Overlapping;
}

std::uint32_t PairQuery::decidingLevel(const QueryLimits& limits) const noexcept {
  const std::size_t last = std::max(walk_.treeA->levelCount(), walk_.treeB->levelCount()) - 1;
  return std::min(limits.deepestLevel, static_cast<std::uint32_t>(last));
}

Answer PairQuery::advance(const QueryLimits& limits) noexcept {
  if (answerAt(limits.deepestLevel) == Answer::Undecided) walkOn(limits);
  return answer_ = answerAt(limits.deepestLevel);
}

Answer PairQuery::answerAt(std::uint32_t level) const noexcept {
  if (complete()) return answer_;
  return walk_.reached >= decidingLevel({.deepestLevel = level}) ? Answer::Overlapping : Answer::Undecided;
}

void PairQuery::walkOn(const QueryLimits& limits) noexcept {
  const std::uint64_t stop = saturatedSum(walk_.tests, limits.sphereTests);
  walkTimed(walk_, {decidingLevel(limits), stop}, limits.microseconds);
  if (complete()) answer_ = handedOut_ < 0 ? Answer::Disjoint : Answer::Overlapping;
}

float PairQuery::slackBound() const noexcept {
  if (answer_ == Answer::Disjoint) return 0;
  // Above a pair that overlaps, pairs of all levels do: the best of them counts. Never one level of A and
  // another of B: those need not have met.
  float standOff = std::numeric_limits<float>::infinity();
  for (std::uint32_t level = 0; level <= walk_.reached; ++level) {
    standOff = std::min(standOff,
                        scaleA_ * walk_.treeA->standOff(level) + poseB_.scale * walk_.treeB->standOff(level));
  }
  return (standOff + 2 * walk_.placement.margin * poseB_.scale) * kRoundUp;
}

BallContact PairQuery::contactOf(const Sphere& a, const Sphere& b, std::uint32_t level) const noexcept {
  const float radiusA = std::max(0.0F, a.radius - walk_.placement.margin);
  const Vec3 apart = b.center - a.center;
  const float distance = length(apart);
  const Vec3 normal = distance > 0 ? (1 / distance) * apart : Vec3{1, 0, 0};
  const float depth = std::max(0.0F, radiusA + b.radius - distance);
  const Vec3 point = a.center + (radiusA - depth / 2) * normal;
  return {transform(poseB_, point),
          rotate(poseB_.rotation, normal),
          poseB_.scale * depth,
          level,
          transform(poseB_, Sphere{a.center, radiusA}),
          transform(poseB_, b)};
}

BallContact PairQuery::rootContact() const noexcept {
  return contactOf(walk_.rootA, walk_.treeB->root(), 0);
}

BallContact PairQuery::pairContact(const detail::PairFrame& frame, std::uint32_t pair,
                                   std::uint32_t level) const noexcept {
  return contactOf(laneOf(frame.a, pair % kBlockLanes), walk_.treeB->ball(frame.blockB, pair / kBlockLanes),
                   level);
}

BallContact PairQuery::topContact() const noexcept {
  return pairContact(top(), top().next, static_cast<std::uint32_t>(walk_.depth) + 1);
}

BallContact PairQuery::contact() const noexcept {
  assert(answer_ != Answer::Disjoint);
  if (walk_.depth >= 0 && top().pending != 0) return topContact();
  if (handedOut_ >= 0) return last_;
  if (walk_.depth <= 0) return rootContact();
  const detail::PairFrame& above = walk_.frames[static_cast<std::size_t>(walk_.depth - 1)];
  return pairContact(above, above.entered, static_cast<std::uint32_t>(walk_.depth));
}

void PairQuery::dropTop() noexcept {
  detail::PairFrame& frame = walk_.frames[static_cast<std::size_t>(walk_.depth)];
  frame.pending &= ~(std::uint64_t{1} << frame.next);
  frame.next = static_cast<std::uint8_t>(std::countr_zero(frame.pending));
}

std::size_t PairQuery::nextContacts(std::span<BallContact> out, const QueryLimits& limits) noexcept {
  const std::uint32_t level = decidingLevel(limits);
  const std::uint64_t stop = saturatedSum(walk_.tests, limits.sphereTests);
  const bool timed = limits.microseconds < std::numeric_limits<float>::infinity();
  const Clock::time_point start = timed ? Clock::now() : Clock::time_point{};
  std::size_t count = 0;
  while (count < out.size() && !complete()) {
    QueryLimits left = limits;
    left.sphereTests = stop - std::min(stop, walk_.tests);
    if (timed) left.microseconds = limits.microseconds - microsecondsSince(start);
    if (count > 0 && (left.sphereTests == 0 || left.microseconds <= 0)) break;
    if (level == 0) {
      last_ = rootContact();
      walk_.fresh = false;
    } else {
      walkOn(left);
      const bool held =
          walk_.depth >= 0 && top().pending != 0 && static_cast<std::uint32_t>(walk_.depth) + 1 >= level;
      if (!held) break;
      last_ = topContact();
      dropTop();
    }
    handedOut_ = std::max(handedOut_, static_cast<std::int32_t>(last_.level));
    answer_ = Answer::Overlapping;
    out[count++] = last_;
  }
  return count;
}

std::size_t PairQuery::pendingContacts(std::span<BallContact> out) const noexcept {
  std::size_t count = 0;
  const auto add = [&](const BallContact& contact) {
    if (count < out.size()) out[count] = contact;
    ++count;
  };
  for (std::int32_t depth = walk_.depth; depth >= 0; --depth) {
    const detail::PairFrame& frame = walk_.frames[static_cast<std::size_t>(depth)];
    const auto level = static_cast<std::uint32_t>(depth);
    for (std::uint64_t left = frame.pending; left != 0; left &= left - 1)
      add(pairContact(frame, static_cast<std::uint32_t>(std::countr_zero(left)), level + 1));
    if (frame.furtherA == 0 && frame.furtherB == 0) continue;
    // Blocks not tested yet: the parents stand for them.
    if (depth == 0) {
      add(rootContact());
    } else {
      const detail::PairFrame& above = walk_.frames[static_cast<std::size_t>(depth - 1)];
      add(pairContact(above, above.entered, level));
    }
  }
  if (walk_.fresh) add(rootContact());
  return count;
}

}  // namespace spheretree
