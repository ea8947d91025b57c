// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/corner_index.hpp"

#include <utility>

#include "medial/place_index.hpp"

namespace spheretree::builders {

CornerIndex::CornerIndex(std::span<const Piece> pieces) {
  std::size_t count = 0;
  for (const Piece& piece : pieces) count += piece.points.size();
  corners_.reserve(count);
  start_.reserve(pieces.size() + 1);
  // Neighbours share most of their points.
  medial::PlaceIndex number(count / 3);
  for (const Piece& piece : pieces) {
    for (const Eigen::Vector3d& p : piece.points) corners_.push_back(number(p));
    start_.push_back(static_cast<std::uint32_t>(corners_.size()));
  }
  places_ = std::move(number).takePlaces();
}

}  // namespace spheretree::builders
