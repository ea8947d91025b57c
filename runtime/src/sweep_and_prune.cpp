// SPDX-License-Identifier: MIT
//
// J. D. Cohen, M. C. Lin, D. Manocha, M. K. Ponamgi, "I-COLLIDE", 1995: sorted interval lists with coherence.
//
// Two boxes overlap when their intervals do on all three axes, and intervals overlap when each begins before
// the other ends. So a pair that is new must have had, on some axis, one box's begin move before the other's
// end; insertion sort performs every such exchange exactly once, with the begin as the element that moves. At
// that moment the boxes, which are known for the whole call, are tested in full. No exchange has to be looked
// at to end a pair: the pairs of the last call are tested again, which costs less than looking them up.

#include <spheretree/sweep_and_prune.hpp>

#include <algorithm>
#include <bit>
#include <iterator>
#include <limits>

#include "box_check.hpp"
#include "pair_sort.hpp"

namespace spheretree {

namespace {

using End = std::uint64_t;

constexpr unsigned kValueShift = 32;
constexpr End kIsEnd = End{1} << 31U;  // and not the begin of an interval
constexpr End kBody = kIsEnd - 1;

// A call that exchanges more than this per box sorts anew: about what sorting costs.
constexpr std::size_t kExchangesPerBox = 400;
constexpr std::size_t kLeastExchanges = 4096;

/// Keeps the order of floats; both zeros are one. Infinity passes.
std::uint32_t sortable(float value) noexcept {
  const auto bits = std::bit_cast<std::uint32_t>(value + 0.0F);
  return (bits & 0x80000000U) != 0 ? ~bits : bits | 0x80000000U;
}

std::uint32_t bodyOf(End end) noexcept {
  return static_cast<std::uint32_t>(end & kBody);
}

float coordinate(const Vec3& v, std::size_t axis) noexcept {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

/// The same end where the box is now. An absent box ends before all others and begins behind them: to the
/// lists it overlaps nobody, not even another absent one, so whoever it meets when it comes back is met by an
/// exchange.
template <std::size_t Axis>
End moved(End end, const Aabb* boxes) noexcept {
  const Aabb& box = boxes[bodyOf(end)];
  const float value = coordinate((end & kIsEnd) == 0 ? box.min : box.max, Axis);
  return End{sortable(value)} << kValueShift | (end & (kIsEnd | kBody));
}

template <std::size_t Axis>
void moveAll(std::vector<End>& ends, std::span<const Aabb> boxes) {
  for (auto end = ends.begin() + 1; end != ends.end(); ++end) *end = moved<Axis>(*end, boxes.data());
  std::sort(ends.begin(), ends.end());
}

/// Where the boxes overlap the fewest others, if evenly spread.
std::size_t loosestAxis(std::span<const Aabb> boxes) noexcept {
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double low = std::numeric_limits<double>::max();
    double high = -low;
    double extents = 0;
    for (const Aabb& box : boxes) {
      if (detail::isAbsent(box)) continue;
      const auto begin = static_cast<double>(coordinate(box.min, axis));
      const auto end = static_cast<double>(coordinate(box.max, axis));
      low = std::min(low, begin);
      high = std::max(high, end);
      extents += end - begin;
    }
    const double share = high > low ? extents / (high - low) : least;
    if (share < least) {
      least = share;
      best = axis;
    }
  }
  return best;
}

BodyPair ordered(std::uint32_t a, std::uint32_t b) noexcept {
  return {std::min(a, b), std::max(a, b)};
}

}  // namespace

Result<Done> SweepAndPrune::findPairs(std::span<const Aabb> boxes, std::vector<BodyPair>& pairs) {
  pairs.clear();
  if (boxes.size() > detail::kMaxBodies) return detail::tooManyBoxes();
  if (const std::size_t fault = detail::firstFault(boxes); fault != detail::kNoFault)
    return detail::faultAt(fault);
  resize(boxes.size());
  if (update(boxes)) {
    mergePairs(boxes);
  } else {
    restart(boxes);
  }
  pairs.assign(pairs_.begin(), pairs_.end());
  return Done{};
}

/// Drops the ends of bodies that are gone and adds those of new ones behind all others.
void SweepAndPrune::resize(std::size_t count) {
  constexpr End kLast = End{0xffffffffU} << kValueShift;
  for (std::vector<End>& ends : ends_) {
    if (ends.empty()) ends.push_back(0);  // the sentinel: less than every end
    if (count < count_) {
      ends.erase(std::remove_if(ends.begin() + 1, ends.end(), [&](End end) { return bodyOf(end) >= count; }),
                 ends.end());
    }
    for (std::size_t body = count_; body < count; ++body) {
      ends.push_back(kLast | body);
      ends.push_back(kLast | kIsEnd | body);
    }
  }
  count_ = count;
}

/// False when the lists are better sorted anew.
bool SweepAndPrune::update(std::span<const Aabb> boxes) {
  begun_.clear();
  std::size_t budget = kExchangesPerBox * boxes.size() + kLeastExchanges;
  return updateAxis<0>(boxes, budget) && updateAxis<1>(boxes, budget) && updateAxis<2>(boxes, budget);
}

/// Tests a box whose begin has moved before others' `passed` ends.
template <std::size_t Axis>
void SweepAndPrune::addBegun(End begin, std::span<const End> passed, std::span<const Aabb> boxes) {
  constexpr std::size_t kOther = Axis == 0 ? 2 : 0;  // an axis along which few overlap
  const Aabb& box = boxes[bodyOf(begin)];
  const float low = coordinate(box.min, kOther);
  const float high = coordinate(box.max, kOther);
  for (const End end : passed) {
    const Aabb& other = boxes[bodyOf(end)];
    // One branch that is hardly ever taken instead of one that is taken every other time.
    const bool maybe = static_cast<bool>(static_cast<int>((end & kIsEnd) != 0) &
                                         static_cast<int>(coordinate(other.min, kOther) <= high) &
                                         static_cast<int>(coordinate(other.max, kOther) >= low));
    if (maybe && overlap(box, other) && bodyOf(end) != bodyOf(begin)) {
      begun_.push_back(ordered(bodyOf(begin), bodyOf(end)));
    }
  }
}

/// Insertion sort of one list after all its ends have moved.
template <std::size_t Axis>
bool SweepAndPrune::updateAxis(std::span<const Aabb> boxes, std::size_t& budget) {
  End* const ends = ends_[Axis].data();
  const std::size_t size = ends_[Axis].size();
  for (std::size_t i = 1; i < size; ++i) {
    const End end = moved<Axis>(ends[i], boxes.data());
    std::size_t j = i;
    for (; ends[j - 1] > end; --j) ends[j] = ends[j - 1];
    ends[j] = end;
    if ((end & kIsEnd) == 0 && j != i) addBegun<Axis>(end, {ends + j + 1, i - j}, boxes);
    if (i - j > budget) return false;
    budget -= i - j;
  }
  return true;
}

/// Sorts all lists and finds all pairs along the axis where the boxes overlap least.
void SweepAndPrune::restart(std::span<const Aabb> boxes) {
  moveAll<0>(ends_[0], boxes);
  moveAll<1>(ends_[1], boxes);
  moveAll<2>(ends_[2], boxes);
  pairs_.clear();
  const std::size_t axis = loosestAxis(boxes);
  const std::vector<End>& ends = ends_[axis];
  for (std::size_t i = 1; i < ends.size(); ++i) {
    if ((ends[i] & kIsEnd) != 0) continue;
    const std::uint32_t body = bodyOf(ends[i]);
    if (detail::isAbsent(boxes[body])) continue;
    for (std::size_t j = i + 1; bodyOf(ends[j]) != body; ++j) {
      if ((ends[j] & kIsEnd) == 0 && overlap(boxes[body], boxes[bodyOf(ends[j])])) {
        pairs_.push_back(ordered(body, bodyOf(ends[j])));
      }
    }
  }
  detail::sortPairs(pairs_, scratch_, boxes.size());
}

/// pairs_ becomes those that still overlap and those that have begun.
void SweepAndPrune::mergePairs(std::span<const Aabb> boxes) {
  std::erase_if(pairs_, [&](const BodyPair& pair) {
    return pair.b >= boxes.size() || !overlap(boxes[pair.a], boxes[pair.b]);
  });
  detail::sortPairs(begun_, scratch_, boxes.size());
  begun_.erase(std::unique(begun_.begin(), begun_.end()), begun_.end());  // begun on two axes at once
  scratch_.clear();
  std::set_union(pairs_.begin(), pairs_.end(), begun_.begin(), begun_.end(), std::back_inserter(scratch_));
  pairs_.swap(scratch_);
}

}  // namespace spheretree
