// SPDX-License-Identifier: MIT
//
// The inner loops of the queries: eight balls, moved into another frame, against eight balls or a box.
//
// The key of a pair is (r + s)^2 - d^2. Its sign says whether the balls overlap: a difference of two finite
// floats is rounded, but never across zero. As integers, keys of overlapping pairs are ordered like the
// floats; their last six bits make room for the number of the pair, so one maximum finds the deepest overlap
// and where it is. A ball of radius r that is d away from a box has the key r^2 - d^2.

#include "pair_walk.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "relative_pose.hpp"
#include "simd_paths.hpp"

#if SPHERETREE_X86
#include <immintrin.h>
#endif

namespace spheretree::detail {

namespace {

constexpr std::uint32_t kAllLanes = (1U << kBlockLanes) - 1;
constexpr std::int32_t kPairBits = 63;  // of a key, taken by the number of its pair

constexpr std::int32_t kLaneBits = 7;  // of a key, taken by the number of its ball

/// The outcome of eight against a box.
struct BoxHits {
  std::uint32_t lanes = 0;   // that touch
  std::int32_t deepest = 0;  // the largest key, 7 minus the number of its lane in the last bits
};

/// The outcome of eight against eight.
struct Overlaps {
  std::uint64_t pairs = 0;   // bit 8 j + i: lane i of A overlaps lane j of B
  std::int32_t deepest = 0;  // the largest key, 63 minus the number of its pair in the last bits
};

/// All pairs of the given lanes.
std::uint64_t pairsOf(std::uint32_t lanesA, std::uint32_t lanesB) noexcept {
  std::uint64_t pairs = 0;
  for (std::uint32_t j = 0; j < kBlockLanes; ++j) {
    if ((lanesB >> j & 1U) != 0) pairs |= std::uint64_t{lanesA} << (j * kBlockLanes);
  }
  return pairs;
}

/// The pair to look into first: the deepest, unless it lies in an unused lane.
inline std::uint8_t nextOf(std::uint64_t pending, std::int32_t deepest) noexcept {
  const auto bit = static_cast<std::uint32_t>(kPairBits - (deepest & kPairBits));
  const bool usable = (pending >> bit & 1U) != 0;
  return static_cast<std::uint8_t>(usable ? bit : static_cast<std::uint32_t>(std::countr_zero(pending)));
}

namespace scalar {

#define SPHERETREE_PATH
#include "pair_walk.inl"

inline void place(const BallPlacement& how, const BallBlock& from, BallBlock& to) {
  const auto& m = how.pose.matrix;
  for (std::uint32_t i = 0; i < kBlockLanes; ++i) {
    const float x = from.x[i];
    const float y = from.y[i];
    const float z = from.z[i];
    to.x[i] = how.pose.turned ? m[0] * x + m[1] * y + m[2] * z + how.pose.shift.x : x + how.pose.shift.x;
    to.y[i] = how.pose.turned ? m[3] * x + m[4] * y + m[5] * z + how.pose.shift.y : y + how.pose.shift.y;
    to.z[i] = how.pose.turned ? m[6] * x + m[7] * y + m[8] * z + how.pose.shift.z : z + how.pose.shift.z;
    to.radius[i] = how.pose.scale * from.radius[i] + how.margin;
  }
}

inline Overlaps testBlocks(const BallPlacement& how, const BallBlock& blockA, const BallBlock& b,
                           BallBlock& a) {
  place(how, blockA, a);
  Overlaps overlaps{0, std::numeric_limits<std::int32_t>::min()};
  for (std::uint32_t j = 0; j < kBlockLanes; ++j) {
    std::uint32_t row = 0;
    for (std::uint32_t i = 0; i < kBlockLanes; ++i) {
      const float dx = a.x[i] - b.x[j];
      const float dy = a.y[i] - b.y[j];
      const float dz = a.z[i] - b.z[j];
      const float reach = a.radius[i] + b.radius[j];
      const float key = reach * reach - (dx * dx + dy * dy + dz * dz);
      const auto bits = std::bit_cast<std::int32_t>(key);
      const auto number = kPairBits - static_cast<std::int32_t>(j * kBlockLanes + i);
      row |= (bits >= 0 ? 1U : 0U) << i;
      overlaps.deepest = std::max(overlaps.deepest, (bits & ~kPairBits) | number);
    }
    overlaps.pairs |= std::uint64_t{row} << (j * kBlockLanes);
  }
  return overlaps;
}

inline BoxHits testBlock(const BoxWalk& walk, const BallBlock& block) {
  BallBlock a;
  place(walk.placement, block, a);
  BoxHits hits{0, std::numeric_limits<std::int32_t>::min()};
  for (std::uint32_t i = 0; i < kBlockLanes; ++i) {
    const float dx = std::max(std::abs(a.x[i]) - walk.half.x, 0.0F);
    const float dy = std::max(std::abs(a.y[i]) - walk.half.y, 0.0F);
    const float dz = std::max(std::abs(a.z[i]) - walk.half.z, 0.0F);
    const float squared = dx * dx + dy * dy + dz * dz;
    const float reach = a.radius[i] * a.radius[i];
    hits.lanes |= (squared > reach ? 0U : 1U) << i;
    const auto bits = std::bit_cast<std::int32_t>(reach - squared);
    hits.deepest = std::max(hits.deepest, (bits & ~kLaneBits) | (kLaneBits - static_cast<std::int32_t>(i)));
  }
  return hits;
}

#undef SPHERETREE_PATH

}  // namespace scalar

#if SPHERETREE_X86

namespace sse2 {

#define SPHERETREE_PATH
#include "pair_walk.inl"

/// Half a block.
struct Balls {
  __m128 x, y, z, radius;
};

/// row . (x, y, z) + shift
inline __m128 turn(const float* row, const Balls& p, float shift) {
  const __m128 xy = _mm_add_ps(_mm_mul_ps(_mm_set1_ps(row[0]), p.x), _mm_mul_ps(_mm_set1_ps(row[1]), p.y));
  return _mm_add_ps(_mm_add_ps(xy, _mm_mul_ps(_mm_set1_ps(row[2]), p.z)), _mm_set1_ps(shift));
}

inline Balls placed(const BallPlacement& how, const BallBlock& from, std::uint32_t first) {
  Balls p{_mm_load_ps(&from.x[first]), _mm_load_ps(&from.y[first]), _mm_load_ps(&from.z[first]),
          _mm_load_ps(&from.radius[first])};
  if (how.pose.turned) {
    p = {turn(&how.pose.matrix[0], p, how.pose.shift.x), turn(&how.pose.matrix[3], p, how.pose.shift.y),
         turn(&how.pose.matrix[6], p, how.pose.shift.z), p.radius};
  } else {
    p = {_mm_add_ps(p.x, _mm_set1_ps(how.pose.shift.x)), _mm_add_ps(p.y, _mm_set1_ps(how.pose.shift.y)),
         _mm_add_ps(p.z, _mm_set1_ps(how.pose.shift.z)), p.radius};
  }
  p.radius = _mm_add_ps(_mm_mul_ps(_mm_set1_ps(how.pose.scale), p.radius), _mm_set1_ps(how.margin));
  return p;
}

inline Balls place(const BallPlacement& how, const BallBlock& from, BallBlock& to, std::uint32_t first) {
  const Balls p = placed(how, from, first);
  _mm_store_ps(&to.x[first], p.x);
  _mm_store_ps(&to.y[first], p.y);
  _mm_store_ps(&to.z[first], p.z);
  _mm_store_ps(&to.radius[first], p.radius);
  return p;
}

inline __m128 keysOf(const Balls& a, const BallBlock& b, std::uint32_t lane) {
  const __m128 dx = _mm_sub_ps(a.x, _mm_set1_ps(b.x[lane]));
  const __m128 dy = _mm_sub_ps(a.y, _mm_set1_ps(b.y[lane]));
  const __m128 dz = _mm_sub_ps(a.z, _mm_set1_ps(b.z[lane]));
  const __m128 reach = _mm_add_ps(a.radius, _mm_set1_ps(b.radius[lane]));
  const __m128 sum = _mm_add_ps(_mm_add_ps(_mm_mul_ps(dx, dx), _mm_mul_ps(dy, dy)), _mm_mul_ps(dz, dz));
  return _mm_sub_ps(_mm_mul_ps(reach, reach), sum);
}

inline __m128i larger(__m128i a, __m128i b) {
  const __m128i take = _mm_cmpgt_epi32(a, b);
  return _mm_or_si128(_mm_and_si128(take, a), _mm_andnot_si128(take, b));
}

inline __m128i numbered(__m128 keys, std::uint32_t firstPair) {
  const __m128i number = _mm_sub_epi32(_mm_setr_epi32(kPairBits, kPairBits - 1, kPairBits - 2, kPairBits - 3),
                                       _mm_set1_epi32(static_cast<std::int32_t>(firstPair)));
  return _mm_or_si128(_mm_and_si128(_mm_castps_si128(keys), _mm_set1_epi32(~kPairBits)), number);
}

inline std::int32_t largest(__m128i values) {
  values = larger(values, _mm_shuffle_epi32(values, _MM_SHUFFLE(1, 0, 3, 2)));
  return _mm_cvtsi128_si32(larger(values, _mm_shuffle_epi32(values, _MM_SHUFFLE(2, 3, 0, 1))));
}

inline Overlaps testBlocks(const BallPlacement& how, const BallBlock& blockA, const BallBlock& blockB,
                           BallBlock& placed) {
  const Balls low = place(how, blockA, placed, 0);
  const Balls high = place(how, blockA, placed, 4);
  std::uint64_t apart = 0;
  __m128i deepest = _mm_set1_epi32(std::numeric_limits<std::int32_t>::min());
  for (std::uint32_t lane = 0; lane < kBlockLanes; ++lane) {
    const __m128 keysLow = keysOf(low, blockB, lane);
    const __m128 keysHigh = keysOf(high, blockB, lane);
    const auto row = static_cast<std::uint32_t>(_mm_movemask_ps(keysLow) | _mm_movemask_ps(keysHigh) << 4);
    apart |= std::uint64_t{row} << (lane * kBlockLanes);
    deepest = larger(
        deepest, larger(numbered(keysLow, lane * kBlockLanes), numbered(keysHigh, lane * kBlockLanes + 4)));
  }
  return {~apart, largest(deepest)};
}

/// How far outside a slab.
inline __m128 outside(__m128 place, float half) {
  const __m128 size = _mm_andnot_ps(_mm_set1_ps(-0.0F), place);
  return _mm_max_ps(_mm_sub_ps(size, _mm_set1_ps(half)), _mm_setzero_ps());
}

inline BoxHits testBlock(const BoxWalk& walk, const BallBlock& block) {
  std::uint32_t apart = 0;
  __m128i deepest = _mm_set1_epi32(std::numeric_limits<std::int32_t>::min());
  for (std::uint32_t first = 0; first < kBlockLanes; first += 4) {
    const Balls a = placed(walk.placement, block, first);
    const __m128 dx = outside(a.x, walk.half.x);
    const __m128 dy = outside(a.y, walk.half.y);
    const __m128 dz = outside(a.z, walk.half.z);
    const __m128 squared = _mm_add_ps(_mm_add_ps(_mm_mul_ps(dx, dx), _mm_mul_ps(dy, dy)), _mm_mul_ps(dz, dz));
    const __m128 reach = _mm_mul_ps(a.radius, a.radius);
    apart |= static_cast<std::uint32_t>(_mm_movemask_ps(_mm_cmpgt_ps(squared, reach))) << first;
    const __m128i number =
        _mm_sub_epi32(_mm_setr_epi32(7, 6, 5, 4), _mm_set1_epi32(static_cast<std::int32_t>(first)));
    const __m128i keys = _mm_castps_si128(_mm_sub_ps(reach, squared));
    deepest = larger(deepest, _mm_or_si128(_mm_and_si128(keys, _mm_set1_epi32(~kLaneBits)), number));
  }
  return {apart ^ kAllLanes, largest(deepest)};
}

#undef SPHERETREE_PATH

}  // namespace sse2

namespace avx2 {

#define SPHERETREE_PATH __attribute__((target("avx2,bmi")))
#include "pair_walk.inl"

struct Balls {
  __m256 x, y, z, radius;
};

/// row . (x, y, z) + shift
SPHERETREE_PATH inline __m256 turn(const float* row, const Balls& p, float shift) {
  const __m256 xy =
      _mm256_add_ps(_mm256_mul_ps(_mm256_set1_ps(row[0]), p.x), _mm256_mul_ps(_mm256_set1_ps(row[1]), p.y));
  return _mm256_add_ps(_mm256_add_ps(xy, _mm256_mul_ps(_mm256_set1_ps(row[2]), p.z)), _mm256_set1_ps(shift));
}

SPHERETREE_PATH inline Balls placed(const BallPlacement& how, const BallBlock& from) {
  Balls p{_mm256_load_ps(from.x.data()), _mm256_load_ps(from.y.data()), _mm256_load_ps(from.z.data()),
          _mm256_load_ps(from.radius.data())};
  if (how.pose.turned) {
    p = {turn(&how.pose.matrix[0], p, how.pose.shift.x), turn(&how.pose.matrix[3], p, how.pose.shift.y),
         turn(&how.pose.matrix[6], p, how.pose.shift.z), p.radius};
  } else {
    p = {_mm256_add_ps(p.x, _mm256_set1_ps(how.pose.shift.x)),
         _mm256_add_ps(p.y, _mm256_set1_ps(how.pose.shift.y)),
         _mm256_add_ps(p.z, _mm256_set1_ps(how.pose.shift.z)), p.radius};
  }
  p.radius =
      _mm256_add_ps(_mm256_mul_ps(_mm256_set1_ps(how.pose.scale), p.radius), _mm256_set1_ps(how.margin));
  return p;
}

SPHERETREE_PATH inline Balls place(const BallPlacement& how, const BallBlock& from, BallBlock& to) {
  const Balls p = placed(how, from);
  _mm256_store_ps(to.x.data(), p.x);
  _mm256_store_ps(to.y.data(), p.y);
  _mm256_store_ps(to.z.data(), p.z);
  _mm256_store_ps(to.radius.data(), p.radius);
  return p;
}

SPHERETREE_PATH inline __m256 keysOf(const Balls& a, const BallBlock& b, std::uint32_t lane) {
  const __m256 dx = _mm256_sub_ps(a.x, _mm256_set1_ps(b.x[lane]));
  const __m256 dy = _mm256_sub_ps(a.y, _mm256_set1_ps(b.y[lane]));
  const __m256 dz = _mm256_sub_ps(a.z, _mm256_set1_ps(b.z[lane]));
  const __m256 reach = _mm256_add_ps(a.radius, _mm256_set1_ps(b.radius[lane]));
  const __m256 xy = _mm256_add_ps(_mm256_mul_ps(dx, dx), _mm256_mul_ps(dy, dy));
  const __m256 sum = _mm256_add_ps(xy, _mm256_mul_ps(dz, dz));
  return _mm256_sub_ps(_mm256_mul_ps(reach, reach), sum);
}

SPHERETREE_PATH inline __m256i numbered(__m256 keys, std::uint32_t lane) {
  const __m256i number = _mm256_sub_epi32(_mm256_setr_epi32(63, 62, 61, 60, 59, 58, 57, 56),
                                          _mm256_set1_epi32(static_cast<std::int32_t>(lane * kBlockLanes)));
  const __m256i cut = _mm256_and_si256(_mm256_castps_si256(keys), _mm256_set1_epi32(~kPairBits));
  return _mm256_or_si256(cut, number);
}

SPHERETREE_PATH inline std::int32_t largest(__m256i values) {
  __m128i half = _mm_max_epi32(_mm256_castsi256_si128(values), _mm256_extracti128_si256(values, 1));
  half = _mm_max_epi32(half, _mm_shuffle_epi32(half, _MM_SHUFFLE(1, 0, 3, 2)));
  return _mm_cvtsi128_si32(_mm_max_epi32(half, _mm_shuffle_epi32(half, _MM_SHUFFLE(2, 3, 0, 1))));
}

SPHERETREE_PATH inline Overlaps testBlocks(const BallPlacement& how, const BallBlock& blockA,
                                           const BallBlock& blockB, BallBlock& placed) {
  const Balls a = place(how, blockA, placed);
  std::uint64_t apart = 0;
  __m256i deepest = _mm256_set1_epi32(std::numeric_limits<std::int32_t>::min());
#pragma GCC unroll 8
  for (std::uint32_t lane = 0; lane < kBlockLanes; ++lane) {
    const __m256 keys = keysOf(a, blockB, lane);
    const auto row = static_cast<std::uint32_t>(_mm256_movemask_ps(keys));
    apart |= std::uint64_t{row} << (lane * kBlockLanes);
    deepest = _mm256_max_epi32(deepest, numbered(keys, lane));
  }
  return {~apart, largest(deepest)};
}

/// How far outside a slab.
SPHERETREE_PATH inline __m256 outside(__m256 place, float half) {
  const __m256 size = _mm256_andnot_ps(_mm256_set1_ps(-0.0F), place);
  return _mm256_max_ps(_mm256_sub_ps(size, _mm256_set1_ps(half)), _mm256_setzero_ps());
}

SPHERETREE_PATH inline BoxHits testBlock(const BoxWalk& walk, const BallBlock& block) {
  const Balls a = placed(walk.placement, block);
  const __m256 dx = outside(a.x, walk.half.x);
  const __m256 dy = outside(a.y, walk.half.y);
  const __m256 dz = outside(a.z, walk.half.z);
  const __m256 xy = _mm256_add_ps(_mm256_mul_ps(dx, dx), _mm256_mul_ps(dy, dy));
  const __m256 squared = _mm256_add_ps(xy, _mm256_mul_ps(dz, dz));
  const __m256 reach = _mm256_mul_ps(a.radius, a.radius);
  const auto apart =
      static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_cmp_ps(squared, reach, _CMP_GT_OQ)));
  const __m256i cut =
      _mm256_and_si256(_mm256_castps_si256(_mm256_sub_ps(reach, squared)), _mm256_set1_epi32(~kLaneBits));
  return {apart ^ kAllLanes, largest(_mm256_or_si256(cut, _mm256_setr_epi32(7, 6, 5, 4, 3, 2, 1, 0)))};
}

#undef SPHERETREE_PATH

}  // namespace avx2

#endif

}  // namespace

WalkPaths walkPaths(SimdLevel level) noexcept {
#if SPHERETREE_X86
  if (level >= SimdLevel::Avx2) return {avx2::advance, avx2::touchBox};
  if (level >= SimdLevel::Sse2) return {sse2::advance, sse2::touchBox};
#endif
  static_cast<void>(level);
  return {scalar::advance, scalar::touchBox};
}

}  // namespace spheretree::detail
