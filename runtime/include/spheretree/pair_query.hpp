// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include <spheretree/pose.hpp>
#include <spheretree/query_tree.hpp>
#include <spheretree/sphere.hpp>

namespace spheretree {

/// What a pair query knows.
enum class Answer : std::uint8_t {
  Disjoint,     ///< proved: no point of one surface lies on the other
  Overlapping,  ///< balls of the deepest level asked for overlap: the solids are at most slackBound() apart
  Undecided     ///< the budget ended first; slackBound() holds all the same
};

/// How far one call may go.
struct QueryLimits {
  static constexpr std::uint64_t kUnlimited = std::numeric_limits<std::uint64_t>::max();

  /// Pairs of balls to test in this call. A step tests one ball against the children of a node, up to eight
  /// at once, and counts as eight; a call that finds work makes at least one step.
  std::uint64_t sphereTests = kUnlimited;
  /// Wall-clock time of this call. Looked at every few hundred nanoseconds; where a query stops is then not
  /// repeatable, what it says is right.
  float microseconds = std::numeric_limits<float>::infinity();
  /// The level whose balls decide; the root is 0. Trees that end above it are compared by their last level.
  std::uint32_t deepestLevel = static_cast<std::uint32_t>(kMaxQueryLevels);
};

/// One overlapping pair of balls, in world coordinates.
struct BallContact {
  Vec3 point;               ///< halfway through the overlap, on the line between the centres
  Vec3 normal;              ///< unit, from the first body towards the second; the x axis for equal centres
  float depth = 0;          ///< how deep the balls are in each other, never negative
  std::uint32_t level = 0;  ///< of both balls
  Sphere ballA;             ///< in world coordinates
  Sphere ballB;
};

namespace detail {

/// The children of a node of A, in the frame of B, against the children of a node of B.
struct PairFrame {
  BallBlock a;                // radii enlarged by the margin
  std::uint64_t pending = 0;  // bit 8 j + i: lane i of A overlaps lane j of B, not looked into yet
  std::uint32_t blockA = 0;
  std::uint32_t blockB = 0;
  std::uint8_t lanesA = 0;
  std::uint8_t lanesB = 0;
  std::uint8_t furtherA = 0;  // blocks of the families that are still to come
  std::uint8_t furtherB = 0;
  QueryTree::Family familyB;  // where B begins again for the next block of A
  std::uint8_t next = 0;      // the pending bit to look into next
  std::uint8_t entered = 0;   // the bit that the frame below belongs to
};

/// How A stands in the frame of B.
struct RelativePose {
  std::array<float, 9> matrix{};  // row by row, scale included; only when turned
  Vec3 shift;
  float scale = 1;
  bool turned = false;
};

/// How balls of A are brought into the frame of B.
struct BallPlacement {
  RelativePose pose;
  float margin = 0;  // added to radii: more than all rounding of a test
};

/// The state of a depth-first walk over pairs of nodes; frame k holds nodes of level k + 1.
struct PairWalk {
  const QueryTree* treeA = nullptr;
  const QueryTree* treeB = nullptr;
  BallPlacement placement;
  Sphere rootA;               // placed
  bool fresh = false;         // the children of the roots are still to be looked at
  std::int32_t depth = -1;    // of the frame in work; -1 when none is left
  std::uint32_t reached = 0;  // deepest level on which balls were seen to overlap
  std::uint64_t tests = 0;    // since restart
  std::array<PairFrame, kMaxQueryLevels - 1> frames;
};

}  // namespace detail

/// Whether two sphere trees under rigid poses with uniform scale overlap: interruptible, resumable, never
/// wrong.
///
/// * `Disjoint` is proved: no point of one surface lies on the other, if the trees' chains are certified. The
///   tests are enlarged by more than all rounding.
/// * slackBound() holds after any number of steps: unless the answer is `Disjoint`, the solids are at most
/// that
///   far apart. It only shrinks with more work; at the end it is the sum of the two levels' stand-offs (see
///   QueryTree::standOff for what they rest on) and twice the rounding margin.
/// * Stopping and resuming changes nothing: the same steps are made in the same order.
///
/// The walk goes down both trees in step, depth first, the deepest overlap among children before the others,
/// and stops at the first overlap on the deepest level. Contacts are the overlapping pairs of that level;
/// nextContacts() goes on from there to find them all. Takes no memory from the heap. About 3 KB; refers to
/// the trees, which must outlive it. One thread at a time.
class PairQuery {
 public:
  PairQuery() noexcept = default;
  PairQuery(const QueryTree& a, const QueryTree& b) noexcept { setTrees(a, b); }

  /// Looks at other trees; restart() must follow.
  void setTrees(const QueryTree& a, const QueryTree& b) noexcept {
    walk_.treeA = &a;
    walk_.treeB = &b;
  }

  /// Begins anew at the given poses and compares the roots: one test. Poses must be finite, their rotations
  /// not zero (a length other than one is divided out), their scales positive.
  void restart(const Pose& a, const Pose& b) noexcept;

  /// Goes on until the answer is known or the limits are reached. After `Overlapping`, a call with a deeper
  /// level looks into the overlap that was found; with the same level it repeats the answer.
  Answer advance(const QueryLimits& limits = {}) noexcept;

  /// What the last call said.
  [[nodiscard]] Answer answer() const noexcept { return answer_; }

  /// What is known of a level without further work. What was found to overlap on a level stays `Overlapping`
  /// there until the walk is complete and has ruled everything out.
  [[nodiscard]] Answer answerAt(std::uint32_t level) const noexcept;

  /// Unless the answer is `Disjoint`: an upper bound on the distance between the solids, in world units.
  /// 0 when disjoint: nothing is left open.
  [[nodiscard]] float slackBound() const noexcept;

  /// The deepest level on which balls were seen to overlap; meaningless when the answer is `Disjoint`.
  [[nodiscard]] std::uint32_t reachedLevel() const noexcept { return walk_.reached; }

  /// Pairs of balls tested since restart; a step counts as 64.
  [[nodiscard]] std::uint64_t sphereTests() const noexcept { return walk_.tests; }

  /// The overlapping pair that will be looked into next, or was found last. Not after `Disjoint`.
  [[nodiscard]] BallContact contact() const noexcept;

  /// Moves on through the overlapping pairs of level `limits.deepestLevel`, each found once, and writes as
  /// many as `out` holds. Returns how many; fewer than `out` holds when complete() or the limits were
  /// reached. Use one deepest level from restart on; the answer stays `Overlapping` once a pair was handed
  /// out.
  std::size_t nextContacts(std::span<BallContact> out, const QueryLimits& limits = {}) noexcept;

  /// True when no overlapping pair is left that was not handed out.
  [[nodiscard]] bool complete() const noexcept { return !walk_.fresh && walk_.depth < 0; }

  /// The overlapping pairs still to be looked into, each on its own level: what an interrupted query holds
  /// possible. Every overlap not handed out yet lies below one of these. Writes as many as `out` holds,
  /// deepest first, and returns how many there are; at most 65 per level.
  std::size_t pendingContacts(std::span<BallContact> out) const noexcept;

 private:
  [[nodiscard]] std::uint32_t decidingLevel(const QueryLimits& limits) const noexcept;
  [[nodiscard]] const detail::PairFrame& top() const noexcept {
    return walk_.frames[static_cast<std::size_t>(walk_.depth)];
  }
  [[nodiscard]] BallContact rootContact() const noexcept;
  [[nodiscard]] BallContact topContact() const noexcept;
  [[nodiscard]] BallContact pairContact(const detail::PairFrame& frame, std::uint32_t pair,
                                        std::uint32_t level) const noexcept;
  void dropTop() noexcept;
  void walkOn(const QueryLimits& limits) noexcept;
  [[nodiscard]] BallContact contactOf(const Sphere& a, const Sphere& b, std::uint32_t level) const noexcept;

  detail::PairWalk walk_;
  Pose poseB_;
  float scaleA_ = 1;
  Answer answer_ = Answer::Undecided;
  std::int32_t handedOut_ = -1;  // deepest level of the pairs that nextContacts() gave away
  BallContact last_;             // of those
};

}  // namespace spheretree
