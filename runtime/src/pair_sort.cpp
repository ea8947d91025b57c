// SPDX-License-Identifier: MIT
//
// Radix sort of pairs, least significant digit first: the digits of b, then those of a.
//
// A pair needs 2 log2(bodies) bits, so three or four passes do. Digits are as wide as pays for the number of
// pairs: clearing and summing a table must not cost more than moving the pairs.

#include "pair_sort.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

namespace spheretree::detail {

namespace {

constexpr std::size_t kInsertionSortUpTo = 24;  // below this the tables cost more than the comparisons
constexpr unsigned kNarrowDigit = 8;
constexpr unsigned kWideDigit = 11;  // its table still fits the first-level cache
constexpr std::size_t kWideFrom = 4096;

void insertionSort(std::vector<BodyPair>& pairs) noexcept {
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    const BodyPair moving = pairs[i];
    std::size_t j = i;
    for (; j > 0 && moving < pairs[j - 1]; --j) pairs[j] = pairs[j - 1];
    pairs[j] = moving;
  }
}

/// One stable pass by `bits` bits of one member.
void sortByDigit(const std::vector<BodyPair>& from, std::vector<BodyPair>& to,
                 std::uint32_t BodyPair::*member, unsigned shift, unsigned bits) noexcept {
  std::array<std::uint32_t, std::size_t{1} << kWideDigit> next;
  const std::uint32_t mask = (1U << bits) - 1;
  std::fill_n(next.begin(), mask + 1, 0U);
  for (const BodyPair& pair : from) ++next[(pair.*member >> shift) & mask];
  std::uint32_t sum = 0;
  for (std::uint32_t digit = 0; digit <= mask; ++digit) {
    const std::uint32_t count = next[digit];
    next[digit] = sum;
    sum += count;
  }
  for (const BodyPair& pair : from) to[next[(pair.*member >> shift) & mask]++] = pair;
}

}  // namespace

void sortPairs(std::vector<BodyPair>& pairs, std::vector<BodyPair>& scratch, std::size_t bodyCount) {
  if (pairs.size() <= kInsertionSortUpTo) return insertionSort(pairs);
  if (scratch.capacity() < pairs.size()) scratch.reserve(pairs.capacity());
  scratch.resize(pairs.size());
  const auto width = static_cast<unsigned>(std::bit_width(bodyCount - 1));
  const unsigned widest = pairs.size() < kWideFrom ? kNarrowDigit : kWideDigit;
  const unsigned passes = (width + widest - 1) / widest;
  const unsigned bits = (width + passes - 1) / passes;
  for (std::uint32_t BodyPair::*member : {&BodyPair::b, &BodyPair::a}) {
    for (unsigned pass = 0; pass < passes; ++pass) {
      sortByDigit(pairs, scratch, member, pass * bits, bits);
      pairs.swap(scratch);
    }
  }
}

}  // namespace spheretree::detail
