// SPDX-License-Identifier: GPL-3.0-or-later
//
// P. Hubbard, "Approximating polyhedra with spheres for time-critical collision detection", ACM TOG 15(3),
// 1996, section 4: the Voronoi vertices of surface samples that lie inside the solid approximate its medial
// axis. Delaunay with exact predicates (CGAL); centres are then judged by the exact distance to the surface,
// never by the tetrahedron alone, because near-degenerate tetrahedra are the normal case.
#include "medial/medial_axis.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "medial/delaunay.hpp"
#include "medial/parallel.hpp"
#include "medial/surface_samples.hpp"

namespace spheretree::medial {
namespace {

using Eigen::Vector3d;

constexpr std::uint32_t kNone = Delaunay::kNone;

/// Every finite tetrahedron's candidate ball; radius 0 where there is none.
struct Candidates {
  std::vector<std::uint32_t> cells;    // tetrahedra in the order of their samples
  std::vector<std::uint32_t> placeOf;  // its inverse
  std::vector<MedialBall> balls;

  [[nodiscard]] std::uint32_t neighbour(const Delaunay& delaunay, std::uint32_t i, std::size_t corner) const {
    const std::uint32_t cell = delaunay.neighbour(cells[i], corner);
    return cell == kNone ? kNone : placeOf[cell];
  }
};

std::array<std::uint32_t, 4> sampleKey(const Delaunay& delaunay, std::uint32_t cell) {
  std::array<std::uint32_t, 4> key = delaunay.corners(cell);
  std::sort(key.begin(), key.end());
  return key;
}

Candidates interiorBalls(const Surface& surface, const Delaunay& delaunay,
                         const std::vector<Vector3d>& points, const UnitFrame& frame,
                         const Context& context) {
  Candidates result;
  result.cells.resize(delaunay.size());
  for (std::uint32_t i = 0; i < result.cells.size(); ++i) result.cells[i] = i;
  // The triangulation's own order hangs on rounding; which samples a tetrahedron joins does not.
  std::sort(result.cells.begin(), result.cells.end(), [&](std::uint32_t a, std::uint32_t b) {
    return sampleKey(delaunay, a) < sampleKey(delaunay, b);
  });
  result.placeOf.resize(result.cells.size());
  for (std::uint32_t i = 0; i < result.cells.size(); ++i) result.placeOf[result.cells[i]] = i;
  result.balls.resize(result.cells.size());
  constexpr std::size_t kBlock = 256;
  const std::size_t blocks = (result.cells.size() + kBlock - 1) / kBlock;
  parallelFor(blocks, context, [&](std::size_t block) {
    const std::size_t end = std::min(result.cells.size(), (block + 1) * kBlock);
    for (std::size_t i = block * kBlock; i < end; ++i) {
      const Delaunay::Corners& c = delaunay.corners(result.cells[i]);
      const std::optional<Ball> ball =
          circumscribedBall({points[c[0]], points[c[1]], points[c[2]], points[c[3]]});
      if (!ball) continue;
      const Vector3d center = frame.backward(ball->center);
      const double nearest = frame.scale * ball->radius;
      if (!surface.bounds().contains(center) || !surface.inside(center)) continue;
      const double depth = surface.closestPoint(center).distance;
      // The samples are on the surface, so the surface cannot be farther than the nearest of them.
      if (!(depth > 0) || depth > nearest * (1 + kCircumsphere)) continue;
      result.balls[i] = {{center, nearest}, depth};
    }
  });
  return result;
}

/// Which ball each tetrahedron ends up with: its own, or an earlier neighbour's at the same centre.
std::vector<std::uint32_t> mergeCospherical(const Delaunay& delaunay, const Candidates& candidates,
                                            double tolerance) {
  std::vector<std::uint32_t> leader(candidates.cells.size());
  for (std::uint32_t i = 0; i < leader.size(); ++i) leader[i] = i;
  const auto find = [&](std::uint32_t i) {
    while (leader[i] != i) i = leader[i] = leader[leader[i]];
    return i;
  };
  for (std::uint32_t i = 0; i < leader.size(); ++i) {
    if (!(candidates.balls[i].depth > 0)) continue;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t j = candidates.neighbour(delaunay, i, k);
      if (j == kNone || !(candidates.balls[j].depth > 0)) continue;
      if ((candidates.balls[i].ball.center - candidates.balls[j].ball.center).norm() > tolerance) continue;
      const std::uint32_t a = find(i);
      const std::uint32_t b = find(j);
      leader[std::max(a, b)] = std::min(a, b);
    }
  }
  for (std::uint32_t i = 0; i < leader.size(); ++i) leader[i] = find(i);
  return leader;
}

}  // namespace

MedialAxis staticMedialAxis(const Surface& surface, const MedialAxisSettings& settings,
                            const Context& context) {
  const std::vector<SurfaceSample> samples = sampleSurface(surface, settings.samples);
  const UnitFrame frame(surface);
  std::vector<Vector3d> points;
  points.reserve(samples.size());
  for (const SurfaceSample& sample : samples) points.push_back(frame.forward(sample.point));
  const Delaunay delaunay(points);
  context.checkCancelled();

  MedialAxis axis;
  std::vector<bool> served(samples.size(), false);
  if (delaunay.size() > 0) {
    const Candidates candidates = interiorBalls(surface, delaunay, points, frame, context);
    const std::vector<std::uint32_t> leader =
        mergeCospherical(delaunay, candidates, kSameCenter * surface.diagonal());
    std::vector<std::uint32_t> number(candidates.balls.size(), kNone);
    for (std::uint32_t i = 0; i < number.size(); ++i) {
      if (!(candidates.balls[i].depth > 0)) continue;
      if (leader[i] == i) {
        number[i] = static_cast<std::uint32_t>(axis.balls.size());
        axis.balls.push_back(candidates.balls[i]);
      } else {
        number[i] = number[leader[i]];
      }
      for (std::size_t k = 0; k < 4; ++k) {
        served[delaunay.corners(candidates.cells[i])[k]] = true;
        const std::uint32_t j = candidates.neighbour(delaunay, i, k);
        if (j == kNone || j >= i || number[j] == kNone || number[j] == number[i]) continue;
        axis.neighbours.push_back({std::min(number[i], number[j]), std::max(number[i], number[j])});
      }
    }
  }
  // Where the solid is thinner than the samples are dense, no Voronoi vertex falls inside it: such samples
  // get the largest ball that touches the surface there.
  std::vector<std::uint32_t> thin;
  for (std::uint32_t i = 0; i < samples.size(); ++i) {
    if (!served[i]) thin.push_back(i);
  }
  std::vector<Ball> tangent(thin.size());
  parallelFor(thin.size(), context,
              [&](std::size_t i) { tangent[i] = tangentBall(surface, samples[thin[i]]); });
  for (std::size_t i = 0; i < thin.size(); ++i) {
    if (!(tangent[i].radius > 0)) continue;
    axis.balls.push_back({tangent[i], tangent[i].radius});
  }
  std::sort(axis.neighbours.begin(), axis.neighbours.end());
  axis.neighbours.erase(std::unique(axis.neighbours.begin(), axis.neighbours.end()), axis.neighbours.end());
  return axis;
}

}  // namespace spheretree::medial
