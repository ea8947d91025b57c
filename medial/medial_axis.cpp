// SPDX-License-Identifier: GPL-3.0-or-later
//
// P. Hubbard, "Approximating polyhedra with spheres for time-critical collision detection", ACM TOG 15(3),
// 1996, section 4: the Voronoi vertices of surface samples that lie inside the solid approximate its medial
// axis. Delaunay with exact predicates (CGAL); centres are then judged by the exact distance to the surface,
// never by the tetrahedron alone, because near-degenerate tetrahedra are the normal case.
#include "medial/medial_axis.hpp"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "medial/parallel.hpp"
#include "medial/surface_samples.hpp"

namespace spheretree::medial {
namespace {

using Eigen::Vector3d;

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<std::uint32_t, Kernel>;
using CellBase =
    CGAL::Triangulation_cell_base_with_info_3<std::uint32_t, Kernel, CGAL::Triangulation_cell_base_3<Kernel>>;
using Structure = CGAL::Triangulation_data_structure_3<VertexBase, CellBase>;
using Delaunay = CGAL::Delaunay_triangulation_3<Kernel, Structure>;

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
// A circumcentre whose four distances disagree by more than this fraction comes from a sliver: not a centre.
constexpr double kCircumsphere = 1e-6;
// Centres closer than this fraction of the diagonal are one Voronoi vertex split by cospherical samples.
constexpr double kSameCenter = 1e-9;

/// Moves the mesh into the unit cube around the origin and back.
struct Normalised {
  explicit Normalised(const Surface& surface)
      : origin(surface.bounds().center()), scale(surface.bounds().sizes().maxCoeff()) {}
  [[nodiscard]] Kernel::Point_3 forward(const Vector3d& p) const {
    const Vector3d q = (p - origin) / scale;
    return {q.x(), q.y(), q.z()};
  }
  [[nodiscard]] Vector3d backward(const Vector3d& p) const { return origin + scale * p; }
  Vector3d origin;
  double scale;
};

Vector3d positionOf(const Delaunay::Vertex_handle& vertex) {
  return {vertex->point().x(), vertex->point().y(), vertex->point().z()};
}

/// Centre and radius of the sphere through the corners of a tetrahedron; nothing for a sliver.
std::optional<Ball> circumscribedBall(const Delaunay::Cell_handle& cell) {
  const Vector3d a = positionOf(cell->vertex(0));
  const Vector3d u = positionOf(cell->vertex(1)) - a;
  const Vector3d v = positionOf(cell->vertex(2)) - a;
  const Vector3d w = positionOf(cell->vertex(3)) - a;
  const double determinant = 2 * u.dot(v.cross(w));
  if (determinant == 0) return std::nullopt;
  const Vector3d toCenter =
      (u.squaredNorm() * v.cross(w) + v.squaredNorm() * w.cross(u) + w.squaredNorm() * u.cross(v)) /
      determinant;
  double nearest = toCenter.norm();
  double farthest = nearest;
  for (const Vector3d& edge : {u, v, w}) {
    const double distance = (edge - toCenter).norm();
    nearest = std::min(nearest, distance);
    farthest = std::max(farthest, distance);
  }
  if (!(farthest - nearest <= kCircumsphere * farthest)) return std::nullopt;
  return Ball{a + toCenter, nearest};
}

/// Every finite tetrahedron's candidate ball; radius 0 where there is none.
struct Candidates {
  std::vector<Delaunay::Cell_handle> cells;
  std::vector<MedialBall> balls;
};

std::array<std::uint32_t, 4> sampleKey(const Delaunay::Cell_handle& cell) {
  std::array<std::uint32_t, 4> key{};
  for (int k = 0; k < 4; ++k) key[static_cast<std::size_t>(k)] = cell->vertex(k)->info();
  std::sort(key.begin(), key.end());
  return key;
}

Candidates interiorBalls(const Surface& surface, const Delaunay& delaunay, const Normalised& frame,
                         const Context& context) {
  Candidates result;
  result.cells.reserve(delaunay.number_of_finite_cells());
  for (const auto cell : delaunay.finite_cell_handles()) result.cells.push_back(cell);
  // The triangulation's own order hangs on rounding; which samples a tetrahedron joins does not.
  std::sort(result.cells.begin(), result.cells.end(),
            [](const auto& a, const auto& b) { return sampleKey(a) < sampleKey(b); });
  for (std::uint32_t i = 0; i < result.cells.size(); ++i) result.cells[i]->info() = i;
  result.balls.resize(result.cells.size());
  constexpr std::size_t kBlock = 256;
  const std::size_t blocks = (result.cells.size() + kBlock - 1) / kBlock;
  parallelFor(blocks, context, [&](std::size_t block) {
    const std::size_t end = std::min(result.cells.size(), (block + 1) * kBlock);
    for (std::size_t i = block * kBlock; i < end; ++i) {
      const std::optional<Ball> ball = circumscribedBall(result.cells[i]);
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
std::vector<std::uint32_t> mergeCospherical(const Candidates& candidates, double tolerance) {
  std::vector<std::uint32_t> leader(candidates.cells.size());
  for (std::uint32_t i = 0; i < leader.size(); ++i) leader[i] = i;
  const auto find = [&](std::uint32_t i) {
    while (leader[i] != i) i = leader[i] = leader[leader[i]];
    return i;
  };
  for (std::uint32_t i = 0; i < leader.size(); ++i) {
    if (!(candidates.balls[i].depth > 0)) continue;
    for (int k = 0; k < 4; ++k) {
      const std::uint32_t j = candidates.cells[i]->neighbor(k)->info();
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
  const Normalised frame(surface);
  std::vector<std::pair<Kernel::Point_3, std::uint32_t>> points;
  points.reserve(samples.size());
  for (std::uint32_t i = 0; i < samples.size(); ++i) points.emplace_back(frame.forward(samples[i].point), i);
  Delaunay delaunay(points.begin(), points.end());
  context.checkCancelled();

  MedialAxis axis;
  std::vector<bool> served(samples.size(), false);
  if (delaunay.dimension() == 3) {
    for (const auto cell : delaunay.all_cell_handles()) cell->info() = kNone;
    const Candidates candidates = interiorBalls(surface, delaunay, frame, context);
    const std::vector<std::uint32_t> leader = mergeCospherical(candidates, kSameCenter * surface.diagonal());
    std::vector<std::uint32_t> number(candidates.balls.size(), kNone);
    for (std::uint32_t i = 0; i < number.size(); ++i) {
      if (!(candidates.balls[i].depth > 0)) continue;
      if (leader[i] == i) {
        number[i] = static_cast<std::uint32_t>(axis.balls.size());
        axis.balls.push_back(candidates.balls[i]);
      } else {
        number[i] = number[leader[i]];
      }
      for (int k = 0; k < 4; ++k) {
        served[candidates.cells[i]->vertex(k)->info()] = true;
        const std::uint32_t j = candidates.cells[i]->neighbor(k)->info();
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
