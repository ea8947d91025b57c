// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <spheretree/broad_phase.hpp>

namespace spheretree {

namespace detail {

/// How Sweep divides the space. Chosen from a sample of the boxes, kept while it serves.
struct SweepLayout {
  std::array<float, 3> origin{};
  std::array<float, 3> scale{};  // from world units to steps of the compact copy
  unsigned sweepAxis = 0;
  unsigned stripAxis = 2;
  std::uint32_t strips = 1;
  std::uint32_t cells = 1;  // per strip, along the sweep axis
};

}  // namespace detail

/// The best broad phase for every scene that is not known to be special: strips across one axis, each swept
/// along another, over a compact sorted copy of the boxes that is rebuilt by counting in every call.
///
/// O(n + pairs) for boxes of similar size that spread along one or two axes. When they overlap on all axes
/// but one, or many large ones lie among small ones, it tests more of them, eight per step, and still answers
/// exactly. Takes the instruction set that activeSimd() names. 38 bytes per box, and 8 per pair.
class Sweep final : public BroadPhase {
 public:
  Sweep() = default;

  Result<Done> findPairs(std::span<const Aabb> boxes, std::vector<BodyPair>& pairs) override;

 private:
  void fit(std::span<const Aabb> boxes) noexcept;
  [[nodiscard]] bool fitServes(std::size_t count) const noexcept;
  std::size_t sortRecords(std::span<const Aabb> boxes);
  void countBoxes(std::size_t count);
  void sumCounts() noexcept;
  void placeRecords(std::size_t count) noexcept;
  void renewOrder(std::size_t count) noexcept;
  void scan(std::span<const Aabb> boxes, std::vector<BodyPair>& pairs);

  detail::SweepLayout layout_;
  std::size_t fittedCount_ = 0;      // boxes when the layout was chosen, 0 before the first call
  std::size_t callsSinceFit_ = 0;    // 0 in the call that chose it
  std::uint32_t largestCell_ = 0;    // records in the fullest cell, in the last call
  std::uint32_t fittedLargest_ = 0;  // the same when the layout was chosen
  double cost_ = 0;                  // tests per box in the last call
  double fittedCost_ = 0;            // the same when the layout was chosen
  std::size_t callsSinceOrder_ = 0;
  bool wasteful_ = false;  // the last call took many more tests than its pairs explain

  std::vector<std::uint16_t> coordinates_;  // six per box: min, max
  std::vector<std::uint32_t> homes_;        // per box: the cell of its record
  std::vector<std::uint32_t> order_;    // in which boxes become records: as the records of an earlier call
  std::vector<std::uint32_t> bounds_;   // where the cells begin, strip by strip
  std::vector<std::uint32_t> longest_;  // per strip, along it
  std::vector<std::uint64_t> low_;      // sorted records: min and half of the body's number
  std::vector<std::uint64_t> high_;     // sorted records: flipped max and the other half
  std::vector<BodyPair> scratch_;
};

}  // namespace spheretree
