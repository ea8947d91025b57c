// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace spheretree::medial {

/// Numbers places by their first appearance; places are the same when their coordinates are equal.
///
/// A table of open addresses: the order of the numbers depends on nothing but the order of the calls.
class PlaceIndex {
 public:
  /// Room for about so many places; more are taken, too.
  explicit PlaceIndex(std::size_t expected) { resize(std::bit_ceil(2 * expected + 2)); }

  /// The number of the place; a new place gets the next one.
  std::uint32_t operator()(const Eigen::Vector3d& p) {
    if (2 * (places_.size() + 1) > slots_.size()) resize(2 * slots_.size());
    std::uint32_t& slot = slots_[slotOf(p)];
    if (slot == 0) {
      places_.push_back(p);
      slot = static_cast<std::uint32_t>(places_.size());
    }
    return slot - 1;
  }

  /// All places, by their numbers.
  [[nodiscard]] std::vector<Eigen::Vector3d> takePlaces() && noexcept { return std::move(places_); }

 private:
  static std::uint64_t hashOf(const Eigen::Vector3d& p) noexcept {
    constexpr std::uint64_t kOdd = 0x9e3779b97f4a7c15U;
    std::uint64_t hash = 0;
    // Adding zero makes the two zeros one.
    for (const double x : {p.x() + 0.0, p.y() + 0.0, p.z() + 0.0}) {
      const auto bits = std::bit_cast<std::uint64_t>(x);
      hash = (hash ^ (bits >> 32U) ^ bits) * kOdd;
    }
    return hash ^ (hash >> 29U);
  }

  /// Where the place is, or where it belongs.
  [[nodiscard]] std::size_t slotOf(const Eigen::Vector3d& p) const noexcept {
    std::size_t at = hashOf(p) & (slots_.size() - 1);
    while (slots_[at] != 0 && places_[slots_[at] - 1] != p) at = (at + 1) & (slots_.size() - 1);
    return at;
  }

  void resize(std::size_t size) {
    slots_.assign(size, 0);
    for (std::uint32_t i = 0; i < places_.size(); ++i) slots_[slotOf(places_[i])] = i + 1;
  }

  std::vector<Eigen::Vector3d> places_;
  std::vector<std::uint32_t> slots_;  // number + 1; 0: free. A power of two, at most half full
};

}  // namespace spheretree::medial
