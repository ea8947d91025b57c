// SPDX-License-Identifier: MIT
//
// Compacting and sweeping for Sweep, once per instruction set. All paths find the same candidates.

#include "sweep_kernels.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "box_check.hpp"
#include "simd_paths.hpp"

#if SPHERETREE_X86
#include <immintrin.h>
#endif

namespace spheretree::detail {

namespace {

constexpr float kHighestCoordinate = static_cast<float>(kMaxCoordinate);

// ------------------------------------------------------------------------------------------- compacting

std::uint16_t compactCoordinate(float value, float origin, float scale) noexcept {
  const float position = (value - origin) * scale;
  return static_cast<std::uint16_t>(static_cast<int>(std::max(std::min(position, kHighestCoordinate), 0.0F)));
}

/// One box after the other, from `begin` on, until `end` or a malformed one.
std::size_t compactOneByOne(std::span<const Aabb> boxes, std::size_t begin, std::size_t end,
                            const SweepLayout& layout, std::uint16_t* coordinates,
                            std::uint32_t* homes) noexcept {
  for (std::size_t i = begin; i < end; ++i) {
    const Aabb& box = boxes[i];
    std::uint16_t* const c = coordinates + kCoordinatesPerBox * i;
    homes[i] = layout.strips * layout.cells;
    if (!isWellFormed(box)) {
      if (box != kAbsentBox) return i;
      std::fill_n(c, kCoordinatesPerBox, std::uint16_t{0});
      continue;
    }
    const auto& [x, y, z] = layout.origin;
    const auto& [xScale, yScale, zScale] = layout.scale;
    c[0] = compactCoordinate(box.min.x, x, xScale);
    c[1] = compactCoordinate(box.min.y, y, yScale);
    c[2] = compactCoordinate(box.min.z, z, zScale);
    c[3] = compactCoordinate(box.max.x, x, xScale);
    c[4] = compactCoordinate(box.max.y, y, yScale);
    c[5] = compactCoordinate(box.max.z, z, zScale);
    homes[i] =
        partOf(c[layout.stripAxis], layout.strips) * layout.cells + partOf(c[layout.sweepAxis], layout.cells);
  }
  return kNoFault;
}

// --------------------------------------------------------------------------------------------- sweeping

std::uint32_t numberOf(std::uint64_t low, std::uint64_t high) noexcept {
  return static_cast<std::uint32_t>((low >> kNumberLane) | ((high >> kNumberLane) << kCoordinateBits));
}

std::uint32_t coordinateOf(std::uint64_t half, unsigned lane) noexcept {
  return static_cast<std::uint32_t>(half >> lane) & kMaxCoordinate;
}

/// True when the compact boxes overlap by more than touching on every axis: then the true boxes do overlap.
constexpr bool overlapClearly(std::uint64_t lowA, std::uint64_t highA, std::uint64_t lowB,
                              std::uint64_t highB) noexcept {
  constexpr std::uint64_t kOneStep = 0x0000'0001'0001'0001U;
  return (((lowA + highB + kOneStep) | (highA + lowB + kOneStep)) & kSpareBits) == 0;
}

/// Delivers the bodies of two records whose compact boxes overlap if the true ones do.
inline void report(StripScan& scan, std::uint32_t i, std::uint32_t j) {
  const std::uint32_t own = numberOf(scan.low[i], scan.high[i]);
  const std::uint32_t other = numberOf(scan.low[j], scan.high[j]);
  if (overlapClearly(scan.low[i], scan.high[i], scan.low[j], scan.high[j]) ||
      overlap(scan.boxes[own], scan.boxes[other])) {
    const std::uint32_t swapped =
        (own ^ other) & (0U - static_cast<std::uint32_t>(other < own));  // no branch
    scan.pairs->push_back({own ^ swapped, other ^ swapped});
  }
}

constexpr std::uint32_t kGroup = 4;  // steps whose hits share a word

/// Candidates that passed, not yet delivered.
struct HitList {
  struct Entry {
    std::uint64_t mask;  // a bit for every lane of every step
    std::uint32_t first;
    std::uint32_t other;         // from lane to lane it grows by one
    std::uint32_t end;           // candidates from here on do not count
    std::uint8_t firstPerLane;   // by how much `first` grows from lane to lane
    std::uint8_t firstPerStep;   // from step to step
    std::uint16_t otherPerStep;  // the same of `other`
  };
  static constexpr std::uint32_t kCapacity = 256;

  /// Keeps the entry if there is anything in it. True when the list is full.
  bool add(const Entry& entry) noexcept {
    entries[count] = entry;
    count += static_cast<std::uint32_t>(entry.mask != 0);
    return count == kCapacity;
  }

  std::uint32_t count = 0;
  Entry entries[kCapacity];
};

/// Records set aside. May hold some behind the end of the strip.
struct RecordList {
  static constexpr std::uint32_t kBatch = 256;

  [[nodiscard]] bool full() const noexcept { return count >= kBatch; }

  std::uint32_t count = 0;
  std::uint32_t records[kBatch + kMostLanes];
};

/// What is asked about the far ends of neighbouring records, one by one: for paths that cannot do better.
template <std::uint32_t Lanes>
class EndsOneByOne {
 public:
  EndsOneByOne(const StripScan& scan, std::uint32_t top) noexcept
      : sweepLane_(scan.sweepLane), stripLane_(scan.stripLane), top_(top) {}

  void take(const std::uint64_t* low, const std::uint64_t* high) noexcept {
    high_ = high;
    furthest_ = 0;
    for (std::uint32_t lane = 0; lane < Lanes; ++lane) {
      const std::uint32_t end = kMaxCoordinate - coordinateOf(high[lane], sweepLane_);
      furthest_ = std::max(furthest_, end);
      longest_ = std::max(longest_, end - std::min(end, coordinateOf(low[lane], sweepLane_)));
    }
  }
  [[nodiscard]] std::uint32_t furthest() const noexcept { return furthest_; }
  [[nodiscard]] std::uint32_t longest() const noexcept { return longest_; }
  void addCrossings(std::uint32_t first, RecordList& list) const noexcept {
    for (std::uint32_t lane = 0; lane < Lanes; ++lane) {
      list.records[list.count] = first + lane;
      list.count += static_cast<std::uint32_t>(kMaxCoordinate - coordinateOf(high_[lane], stripLane_) > top_);
    }
  }

 private:
  unsigned sweepLane_;
  unsigned stripLane_;
  std::uint32_t top_;  // last coordinate of the strip
  const std::uint64_t* high_ = nullptr;
  std::uint32_t furthest_ = 0;
  std::uint32_t longest_ = 0;
};

// ----------------------------------------------------------------------------------------------- scalar

namespace scalar {

#define SPHERETREE_PATH

constexpr std::uint32_t kLanes = 1;

struct Rows {
  std::uint64_t low;
  std::uint64_t high;
};

inline Rows sameRows(std::uint64_t low, std::uint64_t high) noexcept {
  return {low, high};
}

inline Rows rowsAt(const std::uint64_t* low, const std::uint64_t* high) noexcept {
  return {*low, *high};
}

template <std::uint32_t Stride>
inline std::uint32_t groupHits(const Rows& rows, const std::uint64_t* low,
                               const std::uint64_t* high) noexcept {
  std::uint32_t hits = 0;
  for (std::uint32_t step = 0; step < kGroup; ++step) {
    const std::uint64_t apart =
        ((rows.low + high[Stride * step]) | (rows.high + low[Stride * step])) & kSpareBits;
    hits |= static_cast<std::uint32_t>(apart == 0) << step;
  }
  return hits;
}

constexpr std::uint32_t laneOf(std::uint32_t) noexcept {
  return 0;
}

constexpr std::uint32_t stepOf(std::uint32_t bit) noexcept {
  return bit;
}

using Ends = EndsOneByOne<kLanes>;

#include "sweep_scan.inl"
// Needs the above.
#include "sweep_distances.inl"
// And all of them.
#include "sweep_strip.inl"

std::size_t compactBoxes(std::span<const Aabb> boxes, const SweepLayout& layout, std::uint16_t* coordinates,
                         std::uint32_t* homes) {
  return compactOneByOne(boxes, 0, boxes.size(), layout, coordinates, homes);
}

#undef SPHERETREE_PATH

}  // namespace scalar

#if SPHERETREE_X86

/// Boxes are read as plain floats, axis k mod 3 in lane k; a group of boxes fills whole registers.
template <std::size_t Count>
struct LanePattern {
  explicit LanePattern(const SweepLayout& layout) noexcept {
    for (std::size_t k = 0; k < Count; ++k) {
      origin[k] = layout.origin[k % 3];
      scale[k] = layout.scale[k % 3];
      isMin[k] = k % kCoordinatesPerBox < 3 ? 0xffffffffU : 0U;
    }
  }

  float origin[Count];
  float scale[Count];
  std::uint32_t isMin[Count];
};

/// How many boxes may be read in groups of `width` when the check of extents looks three floats ahead.
constexpr std::size_t groupedBoxes(std::size_t count, std::size_t width) noexcept {
  return count == 0 ? 0 : (count - 1) / width * width;
}

// Extents, max - min, of well-formed boxes are from 0 to the largest float; as unsigned integers these are
// smaller than negative numbers, infinity and NaN. An extent that overflows goes the slow way, too.
constexpr std::uint32_t kLargestExtent = std::bit_cast<std::uint32_t>(std::numeric_limits<float>::max());

// ------------------------------------------------------------------------------------------------- SSE2

namespace sse2 {

#define SPHERETREE_PATH

constexpr std::uint32_t kLanes = 4;  // two registers: one narrowing serves both

struct Rows {
  __m128i low[2];
  __m128i high[2];
};

inline Rows sameRows(std::uint64_t low, std::uint64_t high) noexcept {
  const __m128i lows = _mm_set1_epi64x(static_cast<long long>(low));
  const __m128i highs = _mm_set1_epi64x(static_cast<long long>(high));
  return {{lows, lows}, {highs, highs}};
}

inline Rows rowsAt(const std::uint64_t* low, const std::uint64_t* high) noexcept {
  const auto* const lows = reinterpret_cast<const __m128i*>(low);
  const auto* const highs = reinterpret_cast<const __m128i*>(high);
  return {{_mm_loadu_si128(lows), _mm_loadu_si128(lows + 1)},
          {_mm_loadu_si128(highs), _mm_loadu_si128(highs + 1)}};
}

/// Bit 4 * lane + step.
template <std::uint32_t Stride>
inline std::uint32_t groupHits(const Rows& rows, const std::uint64_t* low,
                               const std::uint64_t* high) noexcept {
  std::uint32_t hits = 0;
#pragma GCC unroll 8
  for (std::uint32_t step = 0; step < kGroup; ++step) {
    const auto* const lows = reinterpret_cast<const __m128i*>(low + Stride * step);
    const auto* const highs = reinterpret_cast<const __m128i*>(high + Stride * step);
    const __m128i apart0 = _mm_or_si128(_mm_add_epi16(rows.high[0], _mm_loadu_si128(lows)),
                                        _mm_add_epi16(rows.low[0], _mm_loadu_si128(highs)));
    const __m128i apart1 = _mm_or_si128(_mm_add_epi16(rows.high[1], _mm_loadu_si128(lows + 1)),
                                        _mm_add_epi16(rows.low[1], _mm_loadu_si128(highs + 1)));
    // Narrowing with saturation keeps the sign, which is the spare bit: four bits per record, three that
    // count.
    auto bits = static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_packs_epi16(apart0, apart1)));
    bits |= bits >> 1U | bits >> 2U;
    constexpr std::uint32_t kLowestOfFour = 0x1111;
    hits |= (~bits & kLowestOfFour) << step;
  }
  return hits;
}

constexpr std::uint32_t laneOf(std::uint32_t bit) noexcept {
  return bit / kGroup;
}

constexpr std::uint32_t stepOf(std::uint32_t bit) noexcept {
  return bit % kGroup;
}

using Ends = EndsOneByOne<kLanes>;

#include "sweep_scan.inl"
// Needs the above.
#include "sweep_distances.inl"
// And all of them.
#include "sweep_strip.inl"

/// The cells of boxes begin .. end - 1, from their coordinates.
void findHomes(const SweepLayout& layout, const std::uint16_t* coordinates, std::size_t begin,
               std::size_t end, std::uint32_t* homes) noexcept {
  for (std::size_t i = begin; i < end; ++i) {
    const std::uint16_t* const c = coordinates + kCoordinatesPerBox * i;
    homes[i] =
        partOf(c[layout.stripAxis], layout.strips) * layout.cells + partOf(c[layout.sweepAxis], layout.cells);
  }
}

std::size_t compactBoxes(std::span<const Aabb> boxes, const SweepLayout& layout, std::uint16_t* coordinates,
                         std::uint32_t* homes) {
  constexpr std::size_t kBoxes = 4;  // 24 floats: six registers, three of results
  const LanePattern<12> lanes(layout);
  const __m128 highest = _mm_set1_ps(kHighestCoordinate);
  const __m128 largest = _mm_set1_ps(std::numeric_limits<float>::max());
  __m128 origin[3];
  __m128 scale[3];
  __m128 isMin[3];
#pragma GCC unroll 8
  for (std::size_t k = 0; k < 3; ++k) {
    origin[k] = _mm_loadu_ps(lanes.origin + 4 * k);
    scale[k] = _mm_loadu_ps(lanes.scale + 4 * k);
    isMin[k] = _mm_castsi128_ps(_mm_loadu_si128(reinterpret_cast<const __m128i*>(lanes.isMin + 4 * k)));
  }
  const std::size_t grouped = groupedBoxes(boxes.size(), kBoxes);
  for (std::size_t i = 0; i < grouped; i += kBoxes) {
    const float* const in = &boxes[i].min.x;
    __m128i steps[6];
    __m128 bad = _mm_setzero_ps();
#pragma GCC unroll 8
    for (std::size_t k = 0; k < 6; ++k) {
      const __m128 value = _mm_loadu_ps(in + 4 * k);
      const __m128 extent = _mm_sub_ps(_mm_loadu_ps(in + 4 * k + 3), value);
      const __m128 fault = _mm_or_ps(_mm_cmpnge_ps(extent, _mm_setzero_ps()), _mm_cmpnle_ps(extent, largest));
      bad = _mm_or_ps(bad, _mm_and_ps(fault, isMin[k % 3]));
      const __m128 position = _mm_mul_ps(_mm_sub_ps(value, origin[k % 3]), scale[k % 3]);
      steps[k] = _mm_cvttps_epi32(_mm_max_ps(_mm_min_ps(position, highest), _mm_setzero_ps()));
    }
    if (_mm_movemask_ps(bad) != 0) {
      const std::size_t fault = compactOneByOne(boxes, i, i + kBoxes, layout, coordinates, homes);
      if (fault != kNoFault) return fault;
      continue;
    }
#pragma GCC unroll 8
    for (std::size_t k = 0; k < 3; ++k) {
      _mm_storeu_si128(reinterpret_cast<__m128i*>(coordinates + kCoordinatesPerBox * i + 8 * k),
                       _mm_packs_epi32(steps[2 * k], steps[2 * k + 1]));
    }
    findHomes(layout, coordinates, i, i + kBoxes, homes);
  }
  return compactOneByOne(boxes, grouped, boxes.size(), layout, coordinates, homes);
}

#undef SPHERETREE_PATH

}  // namespace sse2

// ------------------------------------------------------------------------------------------------- AVX2

namespace avx2 {

#define SPHERETREE_PATH __attribute__((target("avx2,bmi,bmi2")))

constexpr std::uint32_t kLanes = 8;  // two registers

struct Rows {
  __m256i low[2];
  __m256i high[2];
};

SPHERETREE_PATH inline Rows sameRows(std::uint64_t low, std::uint64_t high) noexcept {
  const __m256i lows = _mm256_set1_epi64x(static_cast<long long>(low));
  const __m256i highs = _mm256_set1_epi64x(static_cast<long long>(high));
  return {{lows, lows}, {highs, highs}};
}

SPHERETREE_PATH inline Rows rowsAt(const std::uint64_t* low, const std::uint64_t* high) noexcept {
  const auto* const lows = reinterpret_cast<const __m256i*>(low);
  const auto* const highs = reinterpret_cast<const __m256i*>(high);
  return {{_mm256_loadu_si256(lows), _mm256_loadu_si256(lows + 1)},
          {_mm256_loadu_si256(highs), _mm256_loadu_si256(highs + 1)}};
}

/// Four bits: the records of one register that overlap.
SPHERETREE_PATH inline std::uint32_t hitsAt(__m256i low, __m256i high, const __m256i* lows,
                                            const __m256i* highs) noexcept {
  const __m256i spare = _mm256_set1_epi64x(static_cast<long long>(kSpareBits));
  const __m256i apart = _mm256_or_si256(_mm256_add_epi16(high, _mm256_loadu_si256(lows)),
                                        _mm256_add_epi16(low, _mm256_loadu_si256(highs)));
  const __m256i hit = _mm256_cmpeq_epi64(_mm256_and_si256(apart, spare), _mm256_setzero_si256());
  return static_cast<std::uint32_t>(_mm256_movemask_pd(_mm256_castsi256_pd(hit)));
}

/// Bit 8 * step + lane.
template <std::uint32_t Stride>
SPHERETREE_PATH inline std::uint32_t groupHits(const Rows& rows, const std::uint64_t* low,
                                               const std::uint64_t* high) noexcept {
  std::uint32_t hits = 0;
#pragma GCC unroll 8
  for (std::uint32_t step = 0; step < kGroup; ++step) {
    const auto* const lows = reinterpret_cast<const __m256i*>(low + Stride * step);
    const auto* const highs = reinterpret_cast<const __m256i*>(high + Stride * step);
    hits |= hitsAt(rows.low[0], rows.high[0], lows, highs) << (kLanes * step);
    hits |= hitsAt(rows.low[1], rows.high[1], lows + 1, highs + 1) << (kLanes * step + 4);
  }
  return hits;
}

constexpr std::uint32_t laneOf(std::uint32_t bit) noexcept {
  return bit % kLanes;
}

constexpr std::uint32_t stepOf(std::uint32_t bit) noexcept {
  return bit / kLanes;
}

class Ends {
 public:
  SPHERETREE_PATH Ends(const StripScan& scan, std::uint32_t top) noexcept
      : sweepLane_(_mm_cvtsi32_si128(static_cast<int>(scan.sweepLane))),
        stripLane_(_mm_cvtsi32_si128(static_cast<int>(scan.stripLane))),
        top_(_mm256_set1_epi64x(top)),
        longest_(_mm256_setzero_si256()) {}

  SPHERETREE_PATH void take(const std::uint64_t* low, const std::uint64_t* high) noexcept {
    const __m256i most = _mm256_set1_epi64x(static_cast<long long>(kCoordinateLanes));
#pragma GCC unroll 8
    for (int k = 0; k < 2; ++k) {
      const __m256i lows = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(low) + k);
      const __m256i highs = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(high) + k);
      ends_[k] = _mm256_andnot_si256(highs, most);
      longest_ = _mm256_max_epi16(longest_, _mm256_sub_epi16(ends_[k], _mm256_and_si256(lows, most)));
    }
  }
  [[nodiscard]] SPHERETREE_PATH std::uint32_t furthest() const noexcept {
    return largest(_mm256_max_epi16(ends_[0], ends_[1]));
  }
  [[nodiscard]] SPHERETREE_PATH std::uint32_t longest() const noexcept {
    return largest(longest_);
  }
  SPHERETREE_PATH void addCrossings(std::uint32_t first, RecordList& list) const noexcept {
    const __m256i lane = _mm256_set1_epi64x(kMaxCoordinate);
    std::uint32_t crossing = 0;
#pragma GCC unroll 8
    for (int k = 0; k < 2; ++k) {
      const __m256i across = _mm256_and_si256(_mm256_srl_epi64(ends_[k], stripLane_), lane);
      const int mask = _mm256_movemask_pd(_mm256_castsi256_pd(_mm256_cmpgt_epi64(across, top_)));
      crossing |= static_cast<std::uint32_t>(mask) << (4 * k);
    }
    for (std::uint32_t k = 0; k < kLanes; ++k) {
      list.records[list.count] = first + k;
      list.count += crossing >> k & 1U;
    }
  }

 private:
  /// Along the sweep axis.
  [[nodiscard]] SPHERETREE_PATH std::uint32_t largest(__m256i lanes) const noexcept {
    __m128i most = _mm_max_epi16(_mm256_castsi256_si128(lanes), _mm256_extracti128_si256(lanes, 1));
    most = _mm_srl_epi64(_mm_max_epi16(most, _mm_unpackhi_epi64(most, most)), sweepLane_);
    return static_cast<std::uint32_t>(_mm_cvtsi128_si32(most)) & kMaxCoordinate;
  }

  __m128i sweepLane_;
  __m128i stripLane_;
  __m256i top_;  // last coordinate of the strip
  __m256i longest_;
  __m256i ends_[2];
};

#include "sweep_scan.inl"
// Needs the above.
#include "sweep_distances.inl"
// And all of them.
#include "sweep_strip.inl"

/// Finds the cells of eight boxes whose coordinates fill three registers.
class HomeFinder {
 public:
  SPHERETREE_PATH explicit HomeFinder(const SweepLayout& layout) noexcept
      : fromFirst_(places(layout, 0)),
        fromSecond_(places(layout, 1)),
        // The upper half of the product with twice the parts: partOf() in one multiplication.
        parts_(bothHalves(2 * layout.cells, 2 * layout.strips)),
        weights_(bothHalves(1, layout.cells)) {}

  SPHERETREE_PATH __m256i operator()(const __m256i* coordinates) const noexcept {
    // A box has three pairs of coordinates, the minima in the first two. The first ones of eight boxes stand
    // at eight different places of their registers, so blending brings them together, in another order.
    const __m256i first = _mm256_blend_epi32(_mm256_blend_epi32(coordinates[0], coordinates[1], 0b10010010),
                                             coordinates[2], 0b00100100);
    const __m256i second = _mm256_blend_epi32(_mm256_blend_epi32(coordinates[0], coordinates[1], 0b00100100),
                                              coordinates[2], 0b01001001);
    const __m256i firsts = _mm256_permutevar8x32_epi32(first, _mm256_setr_epi32(0, 3, 6, 1, 4, 7, 2, 5));
    const __m256i seconds = _mm256_permutevar8x32_epi32(second, _mm256_setr_epi32(1, 4, 7, 2, 5, 0, 3, 6));
    const __m256i both =
        _mm256_or_si256(_mm256_shuffle_epi8(firsts, fromFirst_), _mm256_shuffle_epi8(seconds, fromSecond_));
    return _mm256_madd_epi16(_mm256_mulhi_epu16(both, parts_), weights_);
  }

 private:
  SPHERETREE_PATH static __m256i bothHalves(std::uint32_t lower, std::uint32_t upper) noexcept {
    return _mm256_set1_epi32(static_cast<int>(lower | upper << kLaneBits));
  }
  /// Bytes that bring the coordinates along the two axes into the halves of a double word, from pair `pair`.
  SPHERETREE_PATH static __m256i places(const SweepLayout& layout, unsigned pair) noexcept {
    constexpr std::uint32_t kNothing = 0x8080;
    const auto half = [pair](unsigned axis) {
      return axis / 2 != pair ? kNothing : axis % 2 == 0 ? 0x0100U : 0x0302U;
    };
    const __m256i ofBox =
        _mm256_setr_epi32(0, 0x04040404, 0x08080808, 0x0c0c0c0c, 0, 0x04040404, 0x08080808, 0x0c0c0c0c);
    return _mm256_or_si256(bothHalves(half(layout.sweepAxis), half(layout.stripAxis)), ofBox);
  }

  __m256i fromFirst_;
  __m256i fromSecond_;
  __m256i parts_;
  __m256i weights_;
};

SPHERETREE_PATH std::size_t compactBoxes(std::span<const Aabb> boxes, const SweepLayout& layout,
                                         std::uint16_t* coordinates, std::uint32_t* homes) {
  constexpr std::size_t kBoxes = 8;  // 48 floats: six registers, three of results
  const LanePattern<24> lanes(layout);
  const HomeFinder homesOf(layout);
  const __m256 highest = _mm256_set1_ps(kHighestCoordinate);
  __m256 origin[3];
  __m256 scale[3];
  __m256i isMin[3];
#pragma GCC unroll 8
  for (std::size_t k = 0; k < 3; ++k) {
    origin[k] = _mm256_loadu_ps(lanes.origin + 8 * k);
    scale[k] = _mm256_loadu_ps(lanes.scale + 8 * k);
    isMin[k] = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(lanes.isMin + 8 * k));
  }
  const __m256i largest = _mm256_set1_epi32(static_cast<int>(kLargestExtent));
  const std::size_t grouped = groupedBoxes(boxes.size(), kBoxes);
  for (std::size_t i = 0; i < grouped; i += kBoxes) {
    const float* const in = &boxes[i].min.x;
    __m256i steps[6];
    __m256i extents = _mm256_setzero_si256();
#pragma GCC unroll 8
    for (std::size_t k = 0; k < 6; ++k) {
      const __m256 value = _mm256_loadu_ps(in + 8 * k);
      const __m256i extent = _mm256_castps_si256(_mm256_sub_ps(_mm256_loadu_ps(in + 8 * k + 3), value));
      extents = _mm256_max_epu32(extents, _mm256_and_si256(extent, isMin[k % 3]));
      const __m256 position = _mm256_mul_ps(_mm256_sub_ps(value, origin[k % 3]), scale[k % 3]);
      steps[k] = _mm256_cvttps_epi32(_mm256_min_ps(position, highest));  // negative ones are packed to 0
    }
    const __m256i good = _mm256_cmpeq_epi32(_mm256_max_epu32(extents, largest), largest);
    if (_mm256_movemask_epi8(good) != -1) {
      const std::size_t fault = compactOneByOne(boxes, i, i + kBoxes, layout, coordinates, homes);
      if (fault != kNoFault) return fault;
      continue;
    }
    constexpr int kInOrder = 0b11011000;  // packing interleaves the two halves of its arguments
    __m256i packed[3];
#pragma GCC unroll 8
    for (std::size_t k = 0; k < 3; ++k) {
      packed[k] = _mm256_permute4x64_epi64(_mm256_packus_epi32(steps[2 * k], steps[2 * k + 1]), kInOrder);
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(coordinates + kCoordinatesPerBox * i + 16 * k),
                          packed[k]);
    }
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(homes + i), homesOf(packed));
  }
  return compactOneByOne(boxes, grouped, boxes.size(), layout, coordinates, homes);
}

#undef SPHERETREE_PATH

}  // namespace avx2

// ---------------------------------------------------------------------------------------------- AVX-512

// The intrinsics of g++ 12 start from a register they leave undefined on purpose, and warn about it.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

namespace avx512 {

#define SPHERETREE_PATH __attribute__((target("avx2,bmi,bmi2,popcnt,avx512f,avx512bw,avx512vl,avx512dq")))

constexpr std::uint32_t kLanes = 8;

struct Rows {
  __m512i low;
  __m512i high;
};

SPHERETREE_PATH inline Rows sameRows(std::uint64_t low, std::uint64_t high) noexcept {
  return {_mm512_set1_epi64(static_cast<long long>(low)), _mm512_set1_epi64(static_cast<long long>(high))};
}

SPHERETREE_PATH inline __mmask8 hitsAt(const Rows& rows, const std::uint64_t* low,
                                       const std::uint64_t* high) noexcept {
  const __m512i apart = _mm512_or_si512(_mm512_add_epi16(rows.high, _mm512_loadu_si512(low)),
                                        _mm512_add_epi16(rows.low, _mm512_loadu_si512(high)));
  return _mm512_testn_epi64_mask(apart, _mm512_set1_epi64(static_cast<long long>(kSpareBits)));
}

/// Bit 8 * step + lane.
template <std::uint32_t Stride>
SPHERETREE_PATH inline std::uint32_t groupHits(const Rows& rows, const std::uint64_t* low,
                                               const std::uint64_t* high) noexcept {
  const __mmask16 first = _mm512_kunpackb(hitsAt(rows, low + Stride, high + Stride), hitsAt(rows, low, high));
  const __mmask16 second = _mm512_kunpackb(hitsAt(rows, low + 3 * Stride, high + 3 * Stride),
                                           hitsAt(rows, low + 2 * Stride, high + 2 * Stride));
  return _cvtmask32_u32(_mm512_kunpackw(second, first));
}

constexpr std::uint32_t laneOf(std::uint32_t bit) noexcept {
  return bit % kLanes;
}

constexpr std::uint32_t stepOf(std::uint32_t bit) noexcept {
  return bit / kLanes;
}

/// Eight records, each against the eight that follow it: bit 8 * record + lane.
SPHERETREE_PATH inline std::uint64_t windowHits(const std::uint64_t* low,
                                                const std::uint64_t* high) noexcept {
  __mmask8 rows[kLanes];
#pragma GCC unroll 8
  for (std::uint32_t k = 0; k < kLanes; ++k)
    rows[k] = hitsAt(sameRows(low[k], high[k]), low + k + 1, high + k + 1);
  const __mmask32 lower =
      _mm512_kunpackw(_mm512_kunpackb(rows[3], rows[2]), _mm512_kunpackb(rows[1], rows[0]));
  const __mmask32 upper =
      _mm512_kunpackw(_mm512_kunpackb(rows[7], rows[6]), _mm512_kunpackb(rows[5], rows[4]));
  return _cvtmask64_u64(_mm512_kunpackd(upper, lower));
}

class Ends {
 public:
  SPHERETREE_PATH Ends(const StripScan& scan, std::uint32_t top) noexcept
      : sweepLane_(_mm_cvtsi32_si128(static_cast<int>(scan.sweepLane))),
        across_(repeated(std::uint64_t{kMaxCoordinate} << scan.stripLane)),
        top_(repeated(std::uint64_t{top} << scan.stripLane)),
        cells_(repeated(std::uint64_t{2 * scan.cells} << scan.sweepLane)),
        longest_(_mm512_setzero_si512()),
        ends_(_mm512_setzero_si512()) {}

  SPHERETREE_PATH void take(const std::uint64_t* low, const std::uint64_t* high) noexcept {
    const __m512i most = repeated(kCoordinateLanes);
    const __m512i begins = _mm512_and_si512(_mm512_loadu_si512(low), most);
    ends_ = _mm512_andnot_si512(_mm512_loadu_si512(high), most);
    longest_ = _mm512_max_epi16(longest_, _mm512_sub_epi16(ends_, begins));
  }
  [[nodiscard]] SPHERETREE_PATH std::uint32_t longest() const noexcept {
    const __m256i half =
        _mm256_max_epi16(_mm512_castsi512_si256(longest_), _mm512_extracti64x4_epi64(longest_, 1));
    __m128i most = _mm_max_epi16(_mm256_castsi256_si128(half), _mm256_extracti128_si256(half, 1));
    most = _mm_srl_epi64(_mm_max_epi16(most, _mm_unpackhi_epi64(most, most)), sweepLane_);
    return static_cast<std::uint32_t>(_mm_cvtsi128_si32(most)) & kMaxCoordinate;
  }
  /// Those that end in the cell, or behind it, where the records from `low` on begin, one by one.
  [[nodiscard]] SPHERETREE_PATH __mmask8 reaching(const std::uint64_t* low) const noexcept {
    // The number of cells stands in the lane of the sweep axis only, so nothing else comes out.
    const __m512i begins = _mm512_and_si512(_mm512_loadu_si512(low), repeated(kCoordinateLanes));
    return _mm512_cmpge_epu64_mask(_mm512_mulhi_epu16(ends_, cells_), _mm512_mulhi_epu16(begins, cells_));
  }
  SPHERETREE_PATH void addCrossings(std::uint32_t first, RecordList& list) const noexcept {
    add(_mm512_cmpgt_epu64_mask(_mm512_and_si512(ends_, across_), top_), first, list);
  }
  SPHERETREE_PATH static void add(__mmask8 which, std::uint32_t first, RecordList& list) noexcept {
    const __m256i records = _mm256_add_epi32(_mm256_set1_epi32(static_cast<int>(first)),
                                             _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(list.records + list.count),
                        _mm256_maskz_compress_epi32(which, records));
    list.count += static_cast<std::uint32_t>(_mm_popcnt_u32(which));
  }

 private:
  SPHERETREE_PATH static __m512i repeated(std::uint64_t half) noexcept {
    return _mm512_set1_epi64(static_cast<long long>(half));
  }

  __m128i sweepLane_;
  __m512i across_;
  __m512i top_;    // last coordinate of the strip
  __m512i cells_;  // twice their number: the upper half of the product is partOf()
  __m512i longest_;
  __m512i ends_;
};

#include "sweep_scan.inl"

/// Every record meets the eight behind it, without a branch; those that reach farther are set aside, too.
class Neighbours {
 public:
  SPHERETREE_PATH void meet(StripScan& scan, HitList& hits, const Ends& ends, const std::uint32_t* bounds,
                            std::uint32_t first) noexcept {
    const std::uint32_t end = bounds[scan.cells];
    const std::uint64_t* const low = scan.low + first;
    const std::uint64_t mask = windowHits(low, scan.high + first);
    if (hits.add({mask, first, first + 1, end, 0, 1, 1})) flush(scan, hits);
    scan.tests += kLanes * kLanes;
    // Of the last records of a strip, those behind the eight belong to another one.
    const std::uint32_t inside = std::min(kLanes, end - std::min(end, first + kLanes + 1));
    const auto counted = static_cast<__mmask8>((1U << inside) - 1);
    Ends::add(static_cast<__mmask8>(ends.reaching(low + kLanes + 1) & counted), first, far_);
    if (far_.full()) finish(scan, hits, bounds);
  }

  SPHERETREE_PATH void finish(StripScan& scan, HitList& hits, const std::uint32_t* bounds) noexcept {
    for (std::uint32_t k = 0; k < far_.count; ++k) {
      const std::uint32_t i = far_.records[k];
      const std::uint32_t last = kMaxCoordinate - coordinateOf(scan.high[i], scan.sweepLane);
      testRange(scan, hits, i, i + kLanes + 1, bounds[partOf(last, scan.cells) + 1]);
    }
    far_.count = 0;
  }

 private:
  RecordList far_;
};

#include "sweep_strip.inl"

/// Finds the cells of sixteen boxes whose coordinates fill three registers.
class HomeFinder {
 public:
  SPHERETREE_PATH explicit HomeFinder(const SweepLayout& layout) noexcept {
    alignas(64) std::uint16_t places[2 * kBoxes];
    alignas(64) std::uint16_t parts[2 * kBoxes];
    alignas(64) std::uint16_t weights[2 * kBoxes];
    std::uint32_t third = 0;
    for (std::uint32_t k = 0; k < kBoxes; ++k) {
      const std::uint32_t first = static_cast<std::uint32_t>(kCoordinatesPerBox) * k;
      places[2 * k] = static_cast<std::uint16_t>(first + layout.sweepAxis);
      places[2 * k + 1] = static_cast<std::uint16_t>(first + layout.stripAxis);
      // The upper half of the product with twice the parts: partOf() in one multiplication.
      parts[2 * k] = static_cast<std::uint16_t>(2 * layout.cells);
      parts[2 * k + 1] = static_cast<std::uint16_t>(2 * layout.strips);
      weights[2 * k] = 1;
      weights[2 * k + 1] = static_cast<std::uint16_t>(layout.cells);
    }
    for (std::uint32_t k = 0; k < 2 * kBoxes; ++k) third |= static_cast<std::uint32_t>(places[k] >= 64) << k;
    places_ = _mm512_load_si512(places);
    parts_ = _mm512_load_si512(parts);
    weights_ = _mm512_load_si512(weights);
    third_ = third;
  }

  SPHERETREE_PATH __m512i operator()(const __m512i* coordinates) const noexcept {
    __m512i pairs = _mm512_permutex2var_epi16(coordinates[0], places_, coordinates[1]);
    pairs = _mm512_mask_permutexvar_epi16(pairs, third_, places_, coordinates[2]);
    return _mm512_madd_epi16(_mm512_mulhi_epu16(pairs, parts_), weights_);
  }

  static constexpr std::uint32_t kBoxes = 16;

 private:
  __m512i places_;  // of a box's coordinates along the two axes; the lower bits count
  __m512i parts_;
  __m512i weights_;
  __mmask32 third_;  // those in the third register
};

SPHERETREE_PATH std::size_t compactBoxes(std::span<const Aabb> boxes, const SweepLayout& layout,
                                         std::uint16_t* coordinates, std::uint32_t* homes) {
  constexpr std::size_t kBoxes = HomeFinder::kBoxes;  // 96 floats: six registers, three of results
  const LanePattern<48> lanes(layout);
  const HomeFinder homesOf(layout);
  const __m512 highest = _mm512_set1_ps(kHighestCoordinate);
  const __m512i inOrder = _mm512_setr_epi64(0, 2, 4, 6, 1, 3, 5, 7);  // packing interleaves quarters
  __m512 origin[3];
  __m512 scale[3];
  __m512i isMin[3];
#pragma GCC unroll 8
  for (std::size_t k = 0; k < 3; ++k) {
    origin[k] = _mm512_loadu_ps(lanes.origin + 16 * k);
    scale[k] = _mm512_loadu_ps(lanes.scale + 16 * k);
    isMin[k] = _mm512_loadu_si512(lanes.isMin + 16 * k);
  }
  const std::size_t grouped = groupedBoxes(boxes.size(), kBoxes);
  for (std::size_t i = 0; i < grouped; i += kBoxes) {
    const float* const in = &boxes[i].min.x;
    __m512i steps[6];
    __m512i extents = _mm512_setzero_si512();
#pragma GCC unroll 8
    for (std::size_t k = 0; k < 6; ++k) {
      const __m512 value = _mm512_loadu_ps(in + 16 * k);
      const __m512i extent = _mm512_castps_si512(_mm512_sub_ps(_mm512_loadu_ps(in + 16 * k + 3), value));
      extents = _mm512_max_epu32(extents, _mm512_and_si512(extent, isMin[k % 3]));
      const __m512 position = _mm512_mul_ps(_mm512_sub_ps(value, origin[k % 3]), scale[k % 3]);
      steps[k] = _mm512_cvttps_epi32(_mm512_min_ps(position, highest));  // negative ones are packed to 0
    }
    if (_mm512_cmpgt_epu32_mask(extents, _mm512_set1_epi32(static_cast<int>(kLargestExtent))) != 0) {
      const std::size_t fault = compactOneByOne(boxes, i, i + kBoxes, layout, coordinates, homes);
      if (fault != kNoFault) return fault;
      continue;
    }
    __m512i packed[3];
#pragma GCC unroll 8
    for (std::size_t k = 0; k < 3; ++k) {
      packed[k] = _mm512_permutexvar_epi64(inOrder, _mm512_packus_epi32(steps[2 * k], steps[2 * k + 1]));
      _mm512_storeu_si512(coordinates + kCoordinatesPerBox * i + 32 * k, packed[k]);
    }
    _mm512_storeu_si512(homes + i, homesOf(packed));
  }
  return compactOneByOne(boxes, grouped, boxes.size(), layout, coordinates, homes);
}

#undef SPHERETREE_PATH

}  // namespace avx512

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif

#endif  // SPHERETREE_X86

}  // namespace

SweepKernels sweepKernels(SimdLevel level) noexcept {
#if SPHERETREE_X86
  if (level >= SimdLevel::Avx512) return {avx512::compactBoxes, avx512::scanStrip};
  if (level >= SimdLevel::Avx2) return {avx2::compactBoxes, avx2::scanStrip};
  if (level >= SimdLevel::Sse2) return {sse2::compactBoxes, sse2::scanStrip};
#endif
  static_cast<void>(level);
  return {scalar::compactBoxes, scalar::scanStrip};
}

}  // namespace spheretree::detail
