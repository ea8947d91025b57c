// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <spheretree/broad_phase.hpp>

namespace spheretree {

/// Sweep & Prune with three sorted lists of interval ends, kept from call to call and brought up to date by
/// insertion sort. The set of pairs is kept, too: an exchange of two ends can only add a pair, and pairs that
/// ended are found by testing the few there are.
///
/// O(n + exchanges + pairs): the less moves, the faster. When more moved than sorting anew costs (a jump, a
/// new scene), it starts afresh. About 50 bytes per box.
class SweepAndPrune final : public BroadPhase {
 public:
  SweepAndPrune() = default;

  Result<Done> findPairs(std::span<const Aabb> boxes, std::vector<BodyPair>& pairs) override;

 private:
  /// An end of an interval as one number that sorts: value, then begins before ends, then the body.
  using End = std::uint64_t;

  void resize(std::size_t count);
  bool update(std::span<const Aabb> boxes);
  template <std::size_t Axis>
  bool updateAxis(std::span<const Aabb> boxes, std::size_t& budget);
  template <std::size_t Axis>
  void addBegun(End begin, std::span<const End> passed, std::span<const Aabb> boxes);
  void restart(std::span<const Aabb> boxes);
  void mergePairs(std::span<const Aabb> boxes);

  std::size_t count_ = 0;
  std::array<std::vector<End>, 3> ends_;  // sorted as of the last call, behind one sentinel
  std::vector<BodyPair> pairs_;           // of the last call
  std::vector<BodyPair> begun_;           // pairs that an exchange of ends may have added
  std::vector<BodyPair> scratch_;
};

}  // namespace spheretree
