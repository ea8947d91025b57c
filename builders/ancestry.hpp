// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "builders/fit_ball.hpp"
#include "builders/pieces.hpp"
#include "builders/settings.hpp"

namespace spheretree::builders {

/// A ball of a finished level.
struct LevelNode {
  Fit fit;
  std::uint32_t parent = 0;  ///< number within the level above
  std::string_view maker{};  ///< the reducer that proposed it
};

/// Who may answer for a piece below the levels so far. Where the worst ball of a level is what counts, the
/// others of it may grow as far for nothing, and so a piece is often free to choose among several parents.
class Ancestry {
 public:
  /// `levels` from the root down.
  Ancestry(std::span<const std::vector<LevelNode>> levels, Objective objective);

  /// The balls of the last level, ascending, that hold the piece when grown as far as they may, and whose
  /// ancestors do as well.
  [[nodiscard]] std::vector<std::uint32_t> holders(const Piece& piece) const;

 private:
  struct Ball {
    Eigen::Vector3d center;
    double squaredRadius;  // grown
    std::vector<std::uint32_t> children;
  };
  std::vector<std::vector<Ball>> levels_;
};

}  // namespace spheretree::builders
