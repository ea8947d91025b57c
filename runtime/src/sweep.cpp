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
// Axes, strips and cells come from a sample of the boxes and are kept until they no longer serve. They decide
// how long a call takes, never what it finds.
//
// D. Terdiman's sweep-and-prune notes (2007, 2017) describe the single-axis sweep this grew from.

#include <spheretree/sweep.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>

#include <spheretree/simd.hpp>

#include "box_check.hpp"
#include "pair_sort.hpp"
#include "sweep_kernels.hpp"

namespace spheretree {

namespace {

using namespace detail;

constexpr std::size_t kMaxSample = 128;  // boxes looked at to choose a layout: some 10 us
constexpr double kTrimmed = 0.02;  // share of the sample ignored at either end: a few far boxes must not
                                   // stretch the cells
constexpr double kMargin = 0.06;   // room added to what the sample spans, as a share of it

// More strips mean fewer tests along them, and more boxes that reach into a second strip, each of which costs
// as much as about 30 tests. The optimum is flat; measured.
constexpr double kTestsPerCrossing = 30;
constexpr double kMostCrossings = 0.5;  // per box, expected
constexpr std::uint32_t kMaxStrips = 1024;
constexpr std::size_t kLeastBoxesPerStrip = 24;
constexpr std::size_t kBoxesPerCell = 2;  // finer cells cost more to sum than they save tests

// A layout no longer serves when ...
constexpr double kCountRatio = 1.5;     // the number of boxes changed by this factor
constexpr double kCostRatio = 1.3;      // a call takes this many more tests per box than after fitting
constexpr double kCostSlack = 4;        // and by more than these
constexpr std::uint32_t kCrowd = 64;    // a cell holds this many more than four times the fullest one before
constexpr double kWaste = 40;           // tests per record that no found pair explains: try now and then
constexpr std::size_t kRetryAfter = 8;  // calls

// Points overlap nothing, and boxes that all overlap, everything; some number keeps quotients finite.
constexpr double kLeastShare = 1e-9;
constexpr double kMostShare = 1e9;

// Boxes become records in about the order the records will have, so that writing them runs through memory.
// Any order is right; one that is this many calls old still saves nearly as much as a new one.
constexpr std::size_t kRenewOrderAfter = 16;

/// What a sample of boxes says about one axis, in world units.
struct AxisUse {
  double low = 0;
  double high = 0;
  double share = 1;  // of the others that a box overlaps along this axis, expected, when evenly spread

  AxisUse() = default;
  AxisUse(std::span<float> mins, std::span<float> maxs) noexcept;
};

AxisUse::AxisUse(std::span<float> mins, std::span<float> maxs) noexcept {
  double extent = 0;
  for (std::size_t i = 0; i < mins.size(); ++i)
    extent += static_cast<double>(maxs[i]) - static_cast<double>(mins[i]);
  extent /= static_cast<double>(mins.size());
  const auto trimmed = static_cast<std::ptrdiff_t>(kTrimmed * static_cast<double>(mins.size()));
  std::nth_element(mins.begin(), mins.begin() + trimmed, mins.end());
  std::nth_element(maxs.begin(), maxs.end() - 1 - trimmed, maxs.end());
  low = static_cast<double>(*(mins.begin() + trimmed));
  high = std::max(static_cast<double>(*(maxs.end() - 1 - trimmed)), low);
  const double span = high - low;
  share = span > extent ? std::max(extent / (span - extent), kLeastShare) : kMostShare;
  low -= kMargin * span;
  high += kMargin * span;
}

/// From world units to compact steps; finite and positive for every pair of finite limits.
float stepsPerUnit(const AxisUse& axis) noexcept {
  constexpr double kLeastSpan = 1e-30;  // keeps the quotient a finite float
  const double span = std::max({axis.high - axis.low, kLeastSpan, 1e-6 * std::abs(axis.low)});
  return static_cast<float>(kMaxCoordinate / span);
}

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

void Sweep::fit(std::span<const Aabb> boxes) noexcept {
  std::array<std::array<float, kMaxSample>, 3> mins;
  std::array<std::array<float, kMaxSample>, 3> maxs;
  std::size_t sampled = 0;
  const std::size_t stride = std::max<std::size_t>(1, (boxes.size() + kMaxSample - 1) / kMaxSample);
  for (std::size_t i = 0; i < boxes.size(); i += stride) {
    const Aabb& box = boxes[i];
    if (!isWellFormed(box)) continue;
    mins[0][sampled] = box.min.x;
    mins[1][sampled] = box.min.y;
    mins[2][sampled] = box.min.z;
    maxs[0][sampled] = box.max.x;
    maxs[1][sampled] = box.max.y;
    maxs[2][sampled] = box.max.z;
    ++sampled;
  }
  fittedCount_ = boxes.size();
  callsSinceFit_ = 0;
  layout_ = {};
  if (sampled == 0) return;

  std::array<AxisUse, 3> axes;
  for (std::size_t k = 0; k < 3; ++k) {
    axes[k] = AxisUse(std::span(mins[k]).first(sampled), std::span(maxs[k]).first(sampled));
    layout_.origin[k] = static_cast<float>(axes[k].low);
    layout_.scale[k] = stepsPerUnit(axes[k]);
  }
  std::array<unsigned, 3> byUse{0, 1, 2};
  std::sort(byUse.begin(), byUse.end(),
            [&](unsigned a, unsigned b) { return axes[a].share < axes[b].share; });
  layout_.sweepAxis = byUse[0];
  layout_.stripAxis = byUse[1];

  const auto count = static_cast<double>(boxes.size());
  const double along = count * std::min(axes[byUse[0]].share, 1.0);  // boxes met per box without strips
  const double across = axes[byUse[1]].share;
  const double strips = std::min({std::sqrt(along / (kTestsPerCrossing * across)), kMostCrossings / across,
                                  count / static_cast<double>(kLeastBoxesPerStrip)});
  layout_.strips = static_cast<std::uint32_t>(std::clamp(strips, 1.0, static_cast<double>(kMaxStrips)));
  layout_.cells = std::clamp(static_cast<std::uint32_t>(boxes.size() / kBoxesPerCell) / layout_.strips, 1U,
                             kMaxCoordinate);
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
