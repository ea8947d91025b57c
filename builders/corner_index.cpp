// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/corner_index.hpp"

#include <array>
#include <bit>
#include <unordered_map>

namespace spheretree::builders {
namespace {

using Place = std::array<std::uint64_t, 3>;  // the bits, so that equal means identical

struct PlaceHash {
  std::size_t operator()(const Place& place) const noexcept {
    constexpr std::uint64_t kOdd = 0x9e3779b97f4a7c15U;
    std::uint64_t hash = 0;
    for (const std::uint64_t bits : place) hash = (hash ^ (bits >> 32U) ^ bits) * kOdd;
    return hash ^ (hash >> 29U);
  }
};

Place placeOf(const Eigen::Vector3d& p) {
  return {std::bit_cast<std::uint64_t>(p.x()), std::bit_cast<std::uint64_t>(p.y()),
          std::bit_cast<std::uint64_t>(p.z())};
}

}  // namespace

CornerIndex::CornerIndex(std::span<const Piece> pieces) {
  std::size_t count = 0;
  for (const Piece& piece : pieces) count += piece.points.size();
  corners_.reserve(count);
  start_.reserve(pieces.size() + 1);
  std::unordered_map<Place, std::uint32_t, PlaceHash> numbers;
  numbers.reserve(count / 2);
  for (const Piece& piece : pieces) {
    for (const Eigen::Vector3d& p : piece.points) {
      const auto [at, isNew] = numbers.try_emplace(placeOf(p), static_cast<std::uint32_t>(places_.size()));
      if (isNew) places_.push_back(p);
      corners_.push_back(at->second);
    }
    start_.push_back(static_cast<std::uint32_t>(corners_.size()));
  }
}

}  // namespace spheretree::builders
