// SPDX-License-Identifier: GPL-3.0-or-later
#include "medial/candidate_balls.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "medial/surface_samples.hpp"

namespace spheretree::medial {
namespace {

using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Balls without a tetrahedron are neighbours of so many others.
constexpr std::size_t kLinks = 3;
// Middles of cells nearer to the surface than this fraction of the diagonal are on it.
constexpr double kOnSurface = 1e-9;
constexpr std::size_t kCancelStep = 64;

double standOffOf(const CellSet& cells, std::size_t cell, const MedialBall& ball) {
  return std::sqrt(cells.farthestSquared(cell, ball.ball.center)) - ball.depth;
}

/// Balls that grew from their depths by the same stand-off, coordinate by coordinate for a fast scan.
class GrownBalls {
 public:
  GrownBalls(std::span<const MedialBall> balls, double standOff) : standOff_(standOff) {
    for (const MedialBall& ball : balls) add(ball);
  }

  void add(const MedialBall& ball) {
    for (std::size_t k = 0; k < 3; ++k) center_[k].push_back(ball.ball.center[static_cast<Eigen::Index>(k)]);
    const double reach = ball.depth + standOff_;
    reachSquared_.push_back(reach * reach);
  }

  [[nodiscard]] bool holds(std::size_t ball, const CellSet& cells, std::size_t cell) const {
    const Vector3d center{center_[0][ball], center_[1][ball], center_[2][ball]};
    return cells.farthestSquared(cell, center) <= reachSquared_[ball];
  }

  /// The first ball that holds a cell, or size().
  [[nodiscard]] std::size_t find(const CellSet& cells, std::size_t cell) const {
    const Vector3d& corner = cells.points()[cells.corners(cell).front()];
    for (std::size_t i = 0; i < size(); ++i) {
      const double x = center_[0][i] - corner.x();
      const double y = center_[1][i] - corner.y();
      const double z = center_[2][i] - corner.z();
      if (x * x + y * y + z * z <= reachSquared_[i] && holds(i, cells, cell)) return i;
    }
    return size();
  }

  [[nodiscard]] std::size_t size() const noexcept { return reachSquared_.size(); }

 private:
  double standOff_;
  std::array<std::vector<double>, 3> center_;
  std::vector<double> reachSquared_;
};

/// The better of the largest ball that touches the surface near the middle of the cell and the one around the
/// middle. Cells may be bent pieces of the surface or parts of the solid: then the middle is not on the
/// surface.
std::optional<MedialBall> ballAt(const Surface& surface, const CellSet& cells, std::size_t cell) {
  const Vector3d middle = middleOf(cells, cell);
  const ClosestPoint nearest = surface.closestPoint(middle);
  std::optional<MedialBall> best;
  if (const Ball tangent = tangentBall(surface, {nearest.point, nearest.triangle}); tangent.radius > 0) {
    best = MedialBall{tangent, tangent.radius};
  }
  if (nearest.distance > kOnSurface * surface.diagonal() && surface.inside(middle)) {
    const MedialBall around{{middle, nearest.distance}, nearest.distance};
    if (!best || standOffOf(cells, cell, around) < standOffOf(cells, cell, *best)) best = around;
  }
  return best;
}

double leastStandOff(const CellSet& cells, std::size_t cell, std::span<const MedialBall> balls) {
  double least = kInfinity;
  for (const MedialBall& ball : balls) least = std::min(least, standOffOf(cells, cell, ball));
  return least;
}

}  // namespace

Vector3d middleOf(const CellSet& cells, std::size_t cell) {
  Vector3d sum = Vector3d::Zero();
  for (const std::uint32_t corner : cells.corners(cell)) sum += cells.points()[corner];
  return sum / static_cast<double>(cells.corners(cell).size());
}

std::optional<std::vector<std::uint32_t>> thinOut(std::span<const MedialBall> balls, double tolerance,
                                                  double step, std::size_t most) {
  std::vector<std::pair<std::int64_t, std::uint32_t>> order;
  order.reserve(balls.size());
  for (std::uint32_t i = 0; i < balls.size(); ++i)
    order.emplace_back(-std::llround(balls[i].depth / step), i);
  std::sort(order.begin(), order.end());
  std::vector<std::uint32_t> standIn(balls.size());
  std::vector<std::uint32_t> kept;
  for (const auto& [depth, i] : order) {
    const MedialBall& ball = balls[i];
    // Every point x: |x - kept| - depth(kept) <= |x - ball| + |ball - kept| - depth(kept).
    const auto found = std::find_if(kept.begin(), kept.end(), [&](std::uint32_t k) {
      const double limit = balls[k].depth - ball.depth + tolerance;
      return limit >= 0 && (balls[k].ball.center - ball.ball.center).squaredNorm() <= limit * limit;
    });
    standIn[i] = found == kept.end() ? i : *found;
    if (found != kept.end()) continue;
    if (kept.size() == most) return std::nullopt;
    kept.push_back(i);
  }
  return standIn;
}

std::optional<std::vector<MedialBall>> gapBalls(const Surface& surface, const CellSet& cells,
                                                std::span<const MedialBall> balls, double standOff,
                                                std::size_t most, const Context& context) {
  GrownBalls grown(balls, standOff);
  std::vector<MedialBall> added;
  std::size_t last = grown.size();  // cells next to each other often lie in the same ball
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    if (cell % kCancelStep == 0) context.checkCancelled();
    if (last < grown.size() && grown.holds(last, cells, cell)) continue;
    last = grown.find(cells, cell);
    if (last < grown.size()) continue;
    const std::optional<MedialBall> own = ballAt(surface, cells, cell);
    if (!own) continue;
    const double needed = standOffOf(cells, cell, *own);
    if (needed >= leastStandOff(cells, cell, balls) || needed >= leastStandOff(cells, cell, added)) continue;
    if (added.size() == most) return std::nullopt;
    added.push_back(*own);
    grown.add(*own);
  }
  return added;
}

std::vector<std::array<std::uint32_t, 2>> linkNearest(std::span<const MedialBall> balls, std::size_t first,
                                                      double step) {
  std::vector<std::array<std::uint32_t, 2>> links;
  std::vector<std::pair<std::int64_t, std::uint32_t>> near;
  for (auto i = static_cast<std::uint32_t>(first); i < balls.size(); ++i) {
    near.clear();
    for (std::uint32_t j = 0; j < balls.size(); ++j) {
      if (j == i) continue;
      const double steps = (balls[i].ball.center - balls[j].ball.center).norm() / step;
      near.emplace_back(static_cast<std::int64_t>(steps), j);
    }
    const std::size_t count = std::min(kLinks, near.size());
    std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
    for (std::size_t k = 0; k < count; ++k) {
      links.push_back({std::min(i, near[k].second), std::max(i, near[k].second)});
    }
  }
  return links;
}

}  // namespace spheretree::medial
