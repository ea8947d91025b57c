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

constexpr std::uint32_t kRow = 8;   // records that one record is tested against at once
constexpr std::uint32_t kRows = 4;  // rows of a step through many records
constexpr std::uint32_t kStep = kRow * kRows;

/// Candidates that passed, not yet delivered.
struct HitList {
  /// Bit 8 row + column of the mask: record first + row * firstStride against other + row * otherStride +
  /// column.
  struct Entry {
    std::uint64_t mask;
    std::uint32_t first;
    std::uint32_t other;
    std::uint32_t end;  // candidates from here on do not count
    std::uint16_t firstStride;
    std::uint16_t otherStride;
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

/// Records that one row is not enough for, or that reach out of their strip. May hold some behind the end of
/// the strip.
struct RecordList {
  static constexpr std::uint32_t kBatch = 256;

  [[nodiscard]] bool full() const noexcept { return count >= kBatch; }

  std::uint32_t count = 0;
  std::uint32_t records[kBatch + kRow];
};

/// What is asked about the far ends of eight neighbouring records, one by one: for paths that cannot do
/// better.
class EndsOneByOne {
 public:
  EndsOneByOne(const StripScan& scan, std::uint32_t top) noexcept
      : sweepLane_(scan.sweepLane), stripLane_(scan.stripLane), cells_(scan.cells), top_(top) {}

  void take(const std::uint64_t* low, const std::uint64_t* high) noexcept {
    for (std::uint32_t k = 0; k < kRow; ++k) {
      ends_[k] = kMaxCoordinate - coordinateOf(high[k], sweepLane_);
      across_[k] = kMaxCoordinate - coordinateOf(high[k], stripLane_);
      longest_ = std::max(longest_, ends_[k] - std::min(ends_[k], coordinateOf(low[k], sweepLane_)));
    }
  }
  [[nodiscard]] std::uint32_t longest() const noexcept { return longest_; }
  [[nodiscard]] std::uint32_t reaching(const std::uint64_t* behind) const noexcept {
    std::uint32_t reaching = 0;
    for (std::uint32_t k = 0; k < kRow; ++k) {
      const bool reaches = partOf(ends_[k], cells_) >= partOf(coordinateOf(behind[k], sweepLane_), cells_);
      reaching |= static_cast<std::uint32_t>(reaches) << k;
    }
    return reaching;
  }
  [[nodiscard]] std::uint32_t crossing() const noexcept {
    std::uint32_t crossing = 0;
    for (std::uint32_t k = 0; k < kRow; ++k) crossing |= static_cast<std::uint32_t>(across_[k] > top_) << k;
    return crossing;
  }
  static void add(std::uint32_t which, std::uint32_t first, RecordList& list) noexcept {
    for (std::uint32_t k = 0; k < kRow; ++k) {
      list.records[list.count] = first + k;
      list.count += which >> k & 1U;
    }
  }

 private:
  unsigned sweepLane_;
  unsigned stripLane_;
  std::uint32_t cells_;
  std::uint32_t top_;  // last coordinate of the strip
  std::uint32_t ends_[kRow] = {};
  std::uint32_t across_[kRow] = {};
  std::uint32_t longest_ = 0;
};

// ----------------------------------------------------------------------------------------------- scalar

namespace scalar {

#define SPHERETREE_PATH

/// Bit k: the record overlaps the k-th from `low` and `high` on.
inline std::uint32_t rowHits(std::uint64_t ownLow, std::uint64_t ownHigh, const std::uint64_t* low,
                             const std::uint64_t* high) noexcept {
  std::uint32_t hits = 0;
  for (std::uint32_t k = 0; k < kRow; ++k) {
    const std::uint64_t apart = ((ownLow + high[k]) | (ownHigh + low[k])) & kSpareBits;
    hits |= static_cast<std::uint32_t>(apart == 0) << k;
  }
  return hits;
}

inline std::uint64_t windowHits(const std::uint64_t* low, const std::uint64_t* high) noexcept {
  std::uint64_t hits = 0;
  for (std::uint32_t k = 0; k < kRow; ++k)
    hits |= std::uint64_t{rowHits(low[k], high[k], low + k + 1, high + k + 1)} << (kRow * k);
  return hits;
}

inline std::uint32_t stepHits(std::uint64_t ownLow, std::uint64_t ownHigh, const std::uint64_t* low,
                              const std::uint64_t* high) noexcept {
  std::uint32_t hits = 0;
  for (std::uint32_t k = 0; k < kRows; ++k)
    hits |= rowHits(ownLow, ownHigh, low + kRow * k, high + kRow * k) << (kRow * k);
  return hits;
}

using Ends = EndsOneByOne;

#include "sweep_scan.inl"

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

/// Two bits per record of a row, 11 where it overlaps.
inline std::uint64_t rowHits(__m128i ownLow, __m128i ownHigh, const std::uint64_t* low,
                             const std::uint64_t* high) noexcept {
  const __m128i spare = _mm_set1_epi64x(static_cast<long long>(kSpareBits));
  __m128i clear[4];  // words of 32 bits without a carry
  for (int k = 0; k < 4; ++k) {
    const __m128i lows = _mm_loadu_si128(reinterpret_cast<const __m128i*>(low) + k);
    const __m128i highs = _mm_loadu_si128(reinterpret_cast<const __m128i*>(high) + k);
    const __m128i apart = _mm_or_si128(_mm_add_epi16(ownHigh, lows), _mm_add_epi16(ownLow, highs));
    clear[k] = _mm_cmpeq_epi32(_mm_and_si128(apart, spare), _mm_setzero_si128());
  }
  const __m128i bytes =
      _mm_packs_epi16(_mm_packs_epi32(clear[0], clear[1]), _mm_packs_epi32(clear[2], clear[3]));
  return static_cast<std::uint64_t>(_mm_movemask_epi8(bytes));
}

/// One bit of each two, where both are set.
constexpr std::uint64_t bothOfTwo(std::uint64_t bits) noexcept {
  bits &= bits >> 1U & 0x5555'5555'5555'5555U;
  bits = (bits | bits >> 1U) & 0x3333'3333'3333'3333U;
  bits = (bits | bits >> 2U) & 0x0f0f'0f0f'0f0f'0f0fU;
  bits = (bits | bits >> 4U) & 0x00ff'00ff'00ff'00ffU;
  bits = (bits | bits >> 8U) & 0x0000'ffff'0000'ffffU;
  return (bits | bits >> 16U) & 0x0000'0000'ffff'ffffU;
}

inline __m128i repeated(std::uint64_t half) noexcept {
  return _mm_set1_epi64x(static_cast<long long>(half));
}

inline std::uint64_t windowHits(const std::uint64_t* low, const std::uint64_t* high) noexcept {
  std::uint64_t hits[2] = {};
  for (std::uint32_t k = 0; k < kRow; ++k) {
    hits[k / kRows] |= rowHits(repeated(low[k]), repeated(high[k]), low + k + 1, high + k + 1)
                       << (2 * kRow * (k % kRows));
  }
  return bothOfTwo(hits[0]) | bothOfTwo(hits[1]) << kStep;
}

inline std::uint32_t stepHits(std::uint64_t ownLow, std::uint64_t ownHigh, const std::uint64_t* low,
                              const std::uint64_t* high) noexcept {
  std::uint64_t hits = 0;
  for (std::uint32_t k = 0; k < kRows; ++k)
    hits |= rowHits(repeated(ownLow), repeated(ownHigh), low + kRow * k, high + kRow * k) << (2 * kRow * k);
  return static_cast<std::uint32_t>(bothOfTwo(hits));
}

using Ends = EndsOneByOne;

#include "sweep_scan.inl"

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

SPHERETREE_PATH inline __m256i repeated(std::uint64_t half) noexcept {
  return _mm256_set1_epi64x(static_cast<long long>(half));
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

SPHERETREE_PATH inline std::uint32_t rowHits(__m256i ownLow, __m256i ownHigh, const std::uint64_t* low,
                                             const std::uint64_t* high) noexcept {
  const auto* const lows = reinterpret_cast<const __m256i*>(low);
  const auto* const highs = reinterpret_cast<const __m256i*>(high);
  return hitsAt(ownLow, ownHigh, lows, highs) | hitsAt(ownLow, ownHigh, lows + 1, highs + 1) << 4;
}

SPHERETREE_PATH inline std::uint64_t windowHits(const std::uint64_t* low,
                                                const std::uint64_t* high) noexcept {
  std::uint64_t hits = 0;
  for (std::uint32_t k = 0; k < kRow; ++k) {
    const std::uint32_t row = rowHits(repeated(low[k]), repeated(high[k]), low + k + 1, high + k + 1);
    hits |= std::uint64_t{row} << (kRow * k);
  }
  return hits;
}

SPHERETREE_PATH inline std::uint32_t stepHits(std::uint64_t ownLow, std::uint64_t ownHigh,
                                              const std::uint64_t* low, const std::uint64_t* high) noexcept {
  std::uint32_t hits = 0;
  for (std::uint32_t k = 0; k < kRows; ++k)
    hits |= rowHits(repeated(ownLow), repeated(ownHigh), low + kRow * k, high + kRow * k) << (kRow * k);
  return hits;
}

class Ends {
 public:
  SPHERETREE_PATH Ends(const StripScan& scan, std::uint32_t top) noexcept
      : sweepLane_(_mm_cvtsi32_si128(static_cast<int>(scan.sweepLane))),
        acrossLane_(repeated(std::uint64_t{kMaxCoordinate} << scan.stripLane)),
        top_(repeated(std::uint64_t{top} << scan.stripLane)),
        cells_(repeated(std::uint64_t{2 * scan.cells} << scan.sweepLane)),
        longest_(_mm256_setzero_si256()) {}

  SPHERETREE_PATH void take(const std::uint64_t* low, const std::uint64_t* high) noexcept {
    const __m256i most = repeated(kCoordinateLanes);
    for (int k = 0; k < 2; ++k) {
      const __m256i lows = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(low) + k);
      const __m256i highs = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(high) + k);
      ends_[k] = _mm256_andnot_si256(highs, most);
      longest_ = _mm256_max_epi16(longest_, _mm256_sub_epi16(ends_[k], _mm256_and_si256(lows, most)));
    }
  }
  [[nodiscard]] SPHERETREE_PATH std::uint32_t longest() const noexcept {
    __m128i most = _mm_max_epi16(_mm256_castsi256_si128(longest_), _mm256_extracti128_si256(longest_, 1));
    most = _mm_srl_epi64(_mm_max_epi16(most, _mm_unpackhi_epi64(most, most)), sweepLane_);
    return static_cast<std::uint32_t>(_mm_cvtsi128_si32(most)) & kMaxCoordinate;
  }
  [[nodiscard]] SPHERETREE_PATH std::uint32_t reaching(const std::uint64_t* behind) const noexcept {
    std::uint32_t before = 0;
    for (int k = 0; k < 2; ++k) {
      // The number of cells stands in the lane of the sweep axis only, so nothing else comes out.
      const __m256i begins = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(behind) + k);
      const __m256i from = _mm256_mulhi_epu16(_mm256_and_si256(begins, repeated(kCoordinateLanes)), cells_);
      before |= bitsOf(_mm256_cmpgt_epi64(from, _mm256_mulhi_epu16(ends_[k], cells_))) << (4 * k);
    }
    return before ^ ((1U << kRow) - 1);
  }
  [[nodiscard]] SPHERETREE_PATH std::uint32_t crossing() const noexcept {
    std::uint32_t crossing = 0;
    for (int k = 0; k < 2; ++k)
      crossing |= bitsOf(_mm256_cmpgt_epi64(_mm256_and_si256(ends_[k], acrossLane_), top_)) << (4 * k);
    return crossing;
  }
  static void add(std::uint32_t which, std::uint32_t first, RecordList& list) noexcept {
    for (std::uint32_t k = 0; k < kRow; ++k) {
      list.records[list.count] = first + k;
      list.count += which >> k & 1U;
    }
  }

 private:
  SPHERETREE_PATH static std::uint32_t bitsOf(__m256i mask) noexcept {
    return static_cast<std::uint32_t>(_mm256_movemask_pd(_mm256_castsi256_pd(mask)));
  }

  __m128i sweepLane_;
  __m256i acrossLane_;
  __m256i top_;    // last coordinate of the strip
  __m256i cells_;  // twice their number: the upper half of the product is partOf()
  __m256i longest_;
  __m256i ends_[2];
};

#include "sweep_scan.inl"

SPHERETREE_PATH std::size_t compactBoxes(std::span<const Aabb> boxes, const SweepLayout& layout,
                                         std::uint16_t* coordinates, std::uint32_t* homes) {
  constexpr std::size_t kBoxes = 8;  // 48 floats: six registers, three of results
  const LanePattern<24> lanes(layout);
  const __m256 highest = _mm256_set1_ps(kHighestCoordinate);
  __m256 origin[3];
  __m256 scale[3];
  __m256i isMin[3];
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
    for (std::size_t k = 0; k < 3; ++k) {
      const __m256i packed = _mm256_packus_epi32(steps[2 * k], steps[2 * k + 1]);
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(coordinates + kCoordinatesPerBox * i + 16 * k),
                          _mm256_permute4x64_epi64(packed, kInOrder));
    }
    sse2::findHomes(layout, coordinates, i, i + kBoxes, homes);
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

SPHERETREE_PATH inline __m512i repeated(std::uint64_t half) noexcept {
  return _mm512_set1_epi64(static_cast<long long>(half));
}

SPHERETREE_PATH inline __mmask8 rowHits(__m512i ownLow, __m512i ownHigh, const std::uint64_t* low,
                                        const std::uint64_t* high) noexcept {
  const __m512i apart = _mm512_or_si512(_mm512_add_epi16(ownHigh, _mm512_loadu_si512(low)),
                                        _mm512_add_epi16(ownLow, _mm512_loadu_si512(high)));
  return _mm512_testn_epi64_mask(apart, repeated(kSpareBits));
}

SPHERETREE_PATH inline std::uint64_t windowHits(const std::uint64_t* low,
                                                const std::uint64_t* high) noexcept {
  __mmask8 rows[kRow];
  for (std::uint32_t k = 0; k < kRow; ++k)
    rows[k] = rowHits(repeated(low[k]), repeated(high[k]), low + k + 1, high + k + 1);
  const __mmask32 lower =
      _mm512_kunpackw(_mm512_kunpackb(rows[3], rows[2]), _mm512_kunpackb(rows[1], rows[0]));
  const __mmask32 upper =
      _mm512_kunpackw(_mm512_kunpackb(rows[7], rows[6]), _mm512_kunpackb(rows[5], rows[4]));
  return _cvtmask64_u64(_mm512_kunpackd(upper, lower));
}

SPHERETREE_PATH inline std::uint32_t stepHits(std::uint64_t ownLow, std::uint64_t ownHigh,
                                              const std::uint64_t* low, const std::uint64_t* high) noexcept {
  __mmask8 rows[kRows];
  for (std::uint32_t k = 0; k < kRows; ++k)
    rows[k] = rowHits(repeated(ownLow), repeated(ownHigh), low + kRow * k, high + kRow * k);
  return _cvtmask32_u32(
      _mm512_kunpackw(_mm512_kunpackb(rows[3], rows[2]), _mm512_kunpackb(rows[1], rows[0])));
}

class Ends {
 public:
  SPHERETREE_PATH Ends(const StripScan& scan, std::uint32_t top) noexcept
      : sweepLane_(_mm_cvtsi32_si128(static_cast<int>(scan.sweepLane))),
        acrossLane_(repeated(std::uint64_t{kMaxCoordinate} << scan.stripLane)),
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
  [[nodiscard]] SPHERETREE_PATH std::uint32_t reaching(const std::uint64_t* behind) const noexcept {
    // The number of cells stands in the lane of the sweep axis only, so nothing else comes out.
    const __m512i begins = _mm512_and_si512(_mm512_loadu_si512(behind), repeated(kCoordinateLanes));
    return _mm512_cmpge_epu64_mask(_mm512_mulhi_epu16(ends_, cells_), _mm512_mulhi_epu16(begins, cells_));
  }
  [[nodiscard]] SPHERETREE_PATH std::uint32_t crossing() const noexcept {
    return _mm512_cmpgt_epu64_mask(_mm512_and_si512(ends_, acrossLane_), top_);
  }
  SPHERETREE_PATH static void add(std::uint32_t which, std::uint32_t first, RecordList& list) noexcept {
    const __m256i records = _mm256_add_epi32(_mm256_set1_epi32(static_cast<int>(first)),
                                             _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(list.records + list.count),
                        _mm256_maskz_compress_epi32(static_cast<__mmask8>(which), records));
    list.count += static_cast<std::uint32_t>(_mm_popcnt_u32(which));
  }

 private:
  __m128i sweepLane_;
  __m512i acrossLane_;
  __m512i top_;    // last coordinate of the strip
  __m512i cells_;  // twice their number: the upper half of the product is partOf()
  __m512i longest_;
  __m512i ends_;
};

#include "sweep_scan.inl"

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
