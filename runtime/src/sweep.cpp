// SPDX-License-Identifier: MIT
//
// A Sweep & Prune whose update is a counting sort.
//
//   1. Boxes become six 15-bit coordinates each, by a monotone map: compact boxes overlap whenever true ones
//   do.
//   2. The space is cut into strips along one axis and every strip into cells along another. A box has one
//   record,
//      filed under the strip and the cell where it begins: count, sum, place. This is nearly a sort, in three
//      linear passes, however the boxes moved; within a cell the order is any.
//   3. Along a strip, each record is tested against those that follow until the cell where it ends: their
//   place
//      is known from the counts, so no sentinel and no comparison of keys is needed. Eight neighbouring
//      records are tested at once, each against the one d places on, for growing d.
//   4. A record that reaches into strips above its own is tested against the part of them that may touch it.
//   5. Compact boxes that overlap by more than touching overlap truly; only the few others are looked at.
//   6. Pairs are brought into order by counting, too.
//
// Axes, strips and cells come from a sample of the boxes (sweep_fit.cpp) and are kept until they no longer
// serve. They decide how long a call takes, never what it finds.
//
// D. Terdiman's sweep-and-prune notes (2007, 2017) describe the single-axis sweep this grew from.

#include <spheretree/sweep.hpp>

#include <algorithm>
#include <bit>
#include <cstring>
#include <numeric>

#include <spheretree/simd.hpp>

#include "box_check.hpp"
#include "pair_sort.hpp"
#include "sweep_kernels.hpp"

namespace spheretree {

namespace {

using namespace detail;

// A layout no longer serves when ...
constexpr double kCountRatio = 1.5;     // the number of boxes changed by this factor
constexpr double kCostRatio = 1.3;      // a call takes this many more tests per box than after fitting
constexpr double kCostSlack = 4;        // and by more than these
constexpr std::uint32_t kCrowd = 64;    // a cell holds this many more than four times the fullest one before
constexpr double kWaste = 40;           // tests per record that no found pair explains: try now and then
constexpr std::size_t kRetryAfter = 8;  // calls

// Boxes become records in about the order the records will have, so that writing them runs through memory.
// Any order is right; one that is this many calls old still saves nearly as much as a new one.
constexpr std::size_t kRenewOrderAfter = 16;

/// Three neighbouring coordinates as lanes. Reads a fourth one.
std::uint64_t lanesAt(const std::uint16_t* coordinates) noexcept {
  std::uint64_t lanes = 0;
  if constexpr (std::endian::native == std::endian::little) {
    std::memcpy(&lanes, coordinates, sizeof lanes);
  } else {
    for (unsigned k = 0; k < 3; ++k) lanes |= std::uint64_t{coordinates[k]} << (kLaneBits * k);
  }
  return lanes & kCoordinateLanes;
}

/// Makes room for `count` entries; once there, it is never given back.
template <class T>
void provide(std::vector<T>& list, std::size_t count) {
  if (list.size() < count) list.resize(count);
}

}  // namespace

bool Sweep::fitServes(std::size_t count) const noexcept {
  const auto now = static_cast<double>(count);
  const auto then = static_cast<double>(fittedCount_);
  if (now > kCountRatio * then || then > kCountRatio * now) return false;
  if (wasteful_ && callsSinceFit_ >= kRetryAfter) return false;
  return cost_ <= kCostRatio * fittedCost_ + kCostSlack;
}

/// Steps 1 and 2: fills the lists of records and their cells. Returns the first malformed box, or kNoFault.
std::size_t Sweep::sortRecords(std::span<const Aabb> boxes) {
  const std::size_t count = boxes.size();
  provide(coordinates_, kCoordinatesPerBox * count + kCoordinatePadding);
  provide(homes_, count);
  const std::size_t fault =
      sweepKernels(activeSimd()).compactBoxes(boxes, layout_, coordinates_.data(), homes_.data());
  if (fault != kNoFault) return fault;
  countBoxes(count);
  sumCounts();
  if (order_.size() != count) {
    order_.resize(count);
    std::iota(order_.begin(), order_.end(), 0U);
    callsSinceOrder_ = kRenewOrderAfter - 1;
  }
  provide(low_, count + kRecordPadding);
  provide(high_, count + kRecordPadding);
  placeRecords(count);
  return kNoFault;
}

/// bounds_[cell + 1] becomes the number of boxes of a cell; absent boxes have one behind the others.
void Sweep::countBoxes(std::size_t count) {
  bounds_.reserve(count / kBoxesPerCell + 3);  // for every layout of so many boxes
  bounds_.assign(std::size_t{layout_.strips} * layout_.cells + 2, 0);
  std::uint32_t* const counts = bounds_.data() + 1;
  const std::uint32_t* const homes = homes_.data();
  for (std::size_t i = 0; i < count; ++i) ++counts[homes[i]];
}

/// Turns the counts into the places where the cells begin: bounds_[0] and bounds_[1] are 0 now.
void Sweep::sumCounts() noexcept {
  std::uint32_t sum = 0;
  std::uint32_t largest = 0;
  for (auto cell = bounds_.begin() + 1; cell + 1 != bounds_.end(); ++cell) {
    const std::uint32_t count = *cell;
    *cell = sum;
    sum += count;
    largest = std::max(largest, count);
  }
  bounds_.back() = sum;  // where the absent ones go
  largestCell_ = largest;
}

/// Moves the records to their places; bounds_[cell + 1] grows from the begin of the cell to its end, which is
/// where the next one begins.
void Sweep::placeRecords(std::size_t count) noexcept {
  std::uint32_t* const next = bounds_.data() + 1;
  const std::uint32_t* const homes = homes_.data();
  const std::uint32_t* const order = order_.data();
  std::uint64_t* const lows = low_.data();
  std::uint64_t* const highs = high_.data();
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = order[k];
    const std::uint16_t* const coordinates = coordinates_.data() + kCoordinatesPerBox * i;
    const std::uint32_t place = next[homes[i]]++;
    lows[place] = lanesAt(coordinates) | (i & kMaxCoordinate) << kNumberLane;
    highs[place] = (kCoordinateLanes - lanesAt(coordinates + 3)) | (i >> kCoordinateBits) << kNumberLane;
  }
}

/// Takes over the order of the records now and then.
void Sweep::renewOrder(std::size_t count) noexcept {
  for (std::size_t k = 0; k < count; ++k) {
    order_[k] =
        static_cast<std::uint32_t>((low_[k] >> kNumberLane) | ((high_[k] >> kNumberLane) << kCoordinateBits));
  }
}

/// Steps 3 to 5, and what they cost.
void Sweep::scan(std::span<const Aabb> boxes, std::vector<BodyPair>& pairs) {
  const ScanStrip scanStrip = sweepKernels(activeSimd()).scanStrip;
  provide(longest_, std::min<std::size_t>(kMaxStrips, boxes.size() / kLeastBoxesPerStrip + 1));
  StripScan state;
  state.low = low_.data();
  state.high = high_.data();
  state.bounds = bounds_.data();
  state.sweepLane = kLaneBits * layout_.sweepAxis;
  state.stripLane = kLaneBits * layout_.stripAxis;
  state.strips = layout_.strips;
  state.cells = layout_.cells;
  state.longest = longest_.data();
  state.boxes = boxes.data();
  state.pairs = &pairs;
  for (std::uint32_t strip = layout_.strips; strip-- > 0;) scanStrip(state, strip);
  const auto tests = static_cast<double>(state.tests);
  cost_ = tests / static_cast<double>(std::max<std::size_t>(1, boxes.size()));
  wasteful_ = tests > kWaste * static_cast<double>(boxes.size()) + static_cast<double>(pairs.size());
}

Result<Done> Sweep::findPairs(std::span<const Aabb> boxes, std::vector<BodyPair>& pairs) {
  pairs.clear();
  if (boxes.size() > kMaxBodies) return tooManyBoxes();
  ++callsSinceFit_;
  if (!fitServes(boxes.size())) fit(boxes);
  std::size_t fault = sortRecords(boxes);
  if (fault != kNoFault) return faultAt(fault);
  if (callsSinceFit_ != 0 && largestCell_ > 4 * fittedLargest_ + kCrowd) {
    fit(boxes);
    fault = sortRecords(boxes);
  }
  scan(boxes, pairs);
  if (callsSinceFit_ == 0) {
    fittedLargest_ = largestCell_;
    fittedCost_ = cost_;
  }
  if (++callsSinceOrder_ >= kRenewOrderAfter) {
    renewOrder(boxes.size());
    callsSinceOrder_ = 0;
  }
  sortPairs(pairs, scratch_, boxes.size());
  return Done{};
}

}  // namespace spheretree
