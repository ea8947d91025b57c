// SPDX-License-Identifier: MIT
#pragma once

#include <compare>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <spheretree/aabb.hpp>
#include <spheretree/result.hpp>

namespace spheretree {

/// Two bodies by their numbers. Pairs that a broad phase delivers have a < b.
struct BodyPair {
  std::uint32_t a = 0;
  std::uint32_t b = 0;

  friend constexpr auto operator<=>(const BodyPair&, const BodyPair&) = default;
};

/// The box of a body that is not there: it touches nothing, and every broad phase takes it. A body is removed
/// by giving it this box (its number stays free for a later one), or by a shorter list of boxes.
inline constexpr Aabb kAbsentBox{
    {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
     std::numeric_limits<float>::infinity()},
    {-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
     -std::numeric_limits<float>::infinity()}};

/// Finds the pairs of boxes that share a point.
///
/// Bodies are numbered by their place in the list of boxes, and every call passes all of them. Between calls
/// any number of boxes may move, grow, shrink, come or go: what an engine remembers of earlier calls changes
/// how long it takes, never what it answers. All engines give the same answer for the same boxes.
///
/// One object serves one thread at a time. Its buffers grow with the scene and are kept: once a scene has
/// reached its size, a call takes nothing from the heap.
class BroadPhase {
 public:
  virtual ~BroadPhase() = default;
  BroadPhase(const BroadPhase&) = delete;
  BroadPhase& operator=(const BroadPhase&) = delete;

  /// Replaces `pairs` by all pairs of overlapping boxes (closed: touching counts), each once with a < b, in
  /// ascending order. Boxes are finite with min <= max on every axis, or kAbsentBox. Any other box is refused
  /// with InvalidArgument, which names it; `pairs` is then empty and the engine as useful as before. At most
  /// 2^30 boxes.
  virtual Result<Done> findPairs(std::span<const Aabb> boxes, std::vector<BodyPair>& pairs) = 0;

 protected:
  BroadPhase() = default;
};

}  // namespace spheretree
