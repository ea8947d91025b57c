// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "builders/pieces.hpp"

namespace spheretree::builders {

/// The points of many pieces, each place once: pieces side by side share most of their points, and what is
/// asked about a ball's points needs to be asked about each place only once.
class CornerIndex {
 public:
  CornerIndex() = default;
  explicit CornerIndex(std::span<const Piece> pieces);

  /// Numbers of the places of a piece's points, in their order.
  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t piece) const {
    return std::span(corners_).subspan(start_[piece], start_[piece + 1] - start_[piece]);
  }
  [[nodiscard]] const Eigen::Vector3d& place(std::uint32_t corner) const { return places_[corner]; }
  [[nodiscard]] std::size_t size() const noexcept { return places_.size(); }

 private:
  std::vector<Eigen::Vector3d> places_;  // as they first appear
  std::vector<std::uint32_t> start_{0};  // of each piece in corners_
  std::vector<std::uint32_t> corners_;
};

}  // namespace spheretree::builders
