// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/ancestry.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace spheretree::builders {

Ancestry::Ancestry(std::span<const std::vector<LevelNode>> levels, Objective objective) {
  for (std::size_t l = 0; l < levels.size(); ++l) {
    double cap = -std::numeric_limits<double>::infinity();
    for (const LevelNode& ball : levels[l]) {
      if (objective == Objective::Worst && l > 0) cap = std::max({cap, 0.0, ball.fit.standOff()});
    }
    std::vector<Ball>& balls = levels_.emplace_back();
    for (std::uint32_t n = 0; n < levels[l].size(); ++n) {
      const LevelNode& ball = levels[l][n];
      const double radius = std::max(ball.fit.reach, ball.fit.center.depth + cap);
      balls.push_back({ball.fit.center.at, radius * radius, {}});
      if (l > 0) levels_[l - 1][ball.parent].children.push_back(n);
    }
  }
}

std::vector<std::uint32_t> Ancestry::holders(const Piece& piece) const {
  std::vector<std::uint32_t> now{0};
  for (std::size_t l = 1; l < levels_.size(); ++l) {
    std::vector<std::uint32_t> next;
    for (const std::uint32_t n : now) {
      for (const std::uint32_t child : levels_[l - 1][n].children) {
        const Ball& ball = levels_[l][child];
        const bool holds = std::all_of(piece.points.begin(), piece.points.end(), [&](const auto& p) {
          return (p - ball.center).squaredNorm() <= ball.squaredRadius;
        });
        if (holds) next.push_back(child);
      }
    }
    now = std::move(next);
  }
  return now;
}

}  // namespace spheretree::builders
