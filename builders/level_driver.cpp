// SPDX-License-Identifier: GPL-3.0-or-later
//
// Top-down construction as in P. Hubbard 1996 and G. Bradshaw, C. O'Sullivan 2004, with cells instead of
// sample points: a region is a set of convex pieces of the surface (and of the solid), each of which is
// wholly inside one child. Cover of every level, and of every chain from the root, then holds by
// construction.
#include "builders/level_driver.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "builders/overhang.hpp"
#include "medial/cell_set.hpp"
#include "medial/min_ball.hpp"
#include "medial/morton.hpp"
#include "medial/parallel.hpp"
#include "medial/random.hpp"
#include "medial/solid_cells.hpp"

namespace spheretree::builders {
namespace {

using Eigen::AlignedBox3d;
using medial::Ball;
using medial::CellSet;
using medial::Surface;
using medial::SurfaceCell;

// Cells are this much shorter than the balls that are expected to cover them: a whole cell across the seam of
// two balls then costs a few per cent of a radius (docs/error-metrics.md).
constexpr double kSurfaceCellSize = 0.2;
constexpr double kSolidCellSize = 0.35;

/// What one node has to cover.
struct Region {
  std::vector<SurfaceCell> surface;
  std::vector<AlignedBox3d> cubes;  // Cover::Solid only; the solid inside them
};

struct WorkNode {
  Ball ball;
  std::uint32_t parent = 0;
  Region region;
};

struct NodeResult {
  std::vector<WorkNode> children;
  bool refined = false;
};

void refineSurface(const SurfaceCell& cell, double size, std::vector<SurfaceCell>& out) {
  if (medial::longestEdge(cell) <= size) {
    out.push_back(cell);
    return;
  }
  const auto [first, second] = medial::bisect(cell);
  refineSurface(first, size, out);
  refineSurface(second, size, out);
}

void refineSolid(const Surface& surface, const AlignedBox3d& cube, double size,
                 std::vector<medial::SolidCell>& out) {
  std::vector<Eigen::Vector3d> points = medial::solidPoints(surface, cube, surface.trianglesNear(cube));
  if (points.empty()) return;
  if (cube.sizes().maxCoeff() <= size) {
    out.push_back({cube, std::move(points)});
    return;
  }
  for (const AlignedBox3d& octant : medial::octants(cube)) refineSolid(surface, octant, size, out);
}

/// A radius that the children of a node can be expected to have: they share its surface.
double expectedRadius(const Ball& ball, std::uint32_t branch) {
  return ball.radius / std::sqrt(static_cast<double>(branch));
}

/// Hands every cell to the ball that needs to stick out least for it, drops balls that get none and shrinks
/// the others to what they got.
std::vector<WorkNode> shareOut(const Surface& surface, const std::vector<SurfaceCell>& cells,
                               const std::vector<medial::SolidCell>& solid, const CellSet& set,
                               const std::vector<Ball>& balls) {
  std::vector<double> depth(balls.size());
  for (std::size_t b = 0; b < balls.size(); ++b) depth[b] = surface.depth(balls[b].center);
  std::vector<WorkNode> nodes(balls.size());
  std::vector<double> needed(balls.size(), -1);
  for (std::size_t cell = 0; cell < set.size(); ++cell) {
    std::size_t best = balls.size();
    double bestStandOff = std::numeric_limits<double>::infinity();
    double bestReach = 0;
    for (std::size_t b = 0; b < balls.size(); ++b) {
      const double reach = std::sqrt(set.farthestSquared(cell, balls[b].center));
      const double standOff = reach - depth[b];
      if (standOff < bestStandOff) {
        bestStandOff = standOff;
        bestReach = reach;
        best = b;
      }
    }
    needed[best] = std::max(needed[best], bestReach);
    if (cell < cells.size()) {
      nodes[best].region.surface.push_back(cells[cell]);
    } else {
      nodes[best].region.cubes.push_back(solid[cell - cells.size()].cube);
    }
  }
  std::vector<WorkNode> used;
  for (std::size_t b = 0; b < balls.size(); ++b) {
    if (needed[b] < 0) continue;
    nodes[b].ball = {balls[b].center, needed[b]};
    used.push_back(std::move(nodes[b]));
  }
  return used;
}

double worstOverhang(const Surface& surface, const std::vector<WorkNode>& nodes) {
  double worst = -std::numeric_limits<double>::infinity();
  for (const WorkNode& node : nodes) worst = std::max(worst, quickOverhang(surface, node.ball));
  return worst;
}

NodeResult expand(const Surface& surface, const BuildSettings& settings, const Reducer& reducer,
                  WorkNode node, std::uint64_t seed, const medial::Context& context) {
  const double overhang = quickOverhang(surface, node.ball);
  if (overhang > settings.maxError * surface.diagonal()) {
    const double radius = expectedRadius(node.ball, settings.branch);
    std::vector<SurfaceCell> cells;
    for (const SurfaceCell& cell : node.region.surface) refineSurface(cell, kSurfaceCellSize * radius, cells);
    std::vector<medial::SolidCell> solid;
    for (const AlignedBox3d& cube : node.region.cubes) {
      refineSolid(surface, cube, kSolidCellSize * radius, solid);
    }
    const CellSet set(cells, solid);
    const std::vector<Ball> balls = reducer.reduce({surface, set, settings.branch, seed, context});
    std::vector<WorkNode> children = shareOut(surface, cells, solid, set, balls);
    if (worstOverhang(surface, children) < overhang) return {std::move(children), true};
  }
  // Good enough, or nothing better was found: the ball stands for itself on the next level.
  NodeResult same;
  same.children.push_back(std::move(node));
  return same;
}

WorkNode makeRoot(const Surface& surface, Cover cover) {
  const medial::TriangleMesh& mesh = surface.mesh();
  // Along a space-filling curve, and so for ever: cells next to each other in a list are near in space.
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector3d middle = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3;
    order.emplace_back(medial::mortonCode(middle, surface.bounds()), t);
  }
  std::sort(order.begin(), order.end());
  WorkNode root;
  std::vector<Eigen::Vector3d> points;
  for (const auto& [code, t] : order) {
    root.region.surface.push_back({mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)});
    points.insert(points.end(), root.region.surface.back().begin(), root.region.surface.back().end());
  }
  if (cover == Cover::Solid) root.region.cubes.push_back(medial::solidRootCube(surface));
  root.ball = medial::minBall(points);
  return root;
}

}  // namespace

BallTree buildByLevels(const Surface& surface, const BuildSettings& settings, std::string_view reducerName,
                       const Reducer& reducer, const medial::Context& context) {
  BallTree tree;
  std::vector<WorkNode> level;
  level.push_back(makeRoot(surface, settings.cover));
  std::uint64_t nodesSoFar = 0;
  for (std::uint32_t depth = 0;; ++depth) {
    tree.levels.emplace_back();
    for (const WorkNode& node : level) tree.levels.back().push_back({node.ball, node.parent});
    if (depth == 0) tree.winners.emplace_back();
    if (depth + 1 >= settings.levels) break;

    std::vector<NodeResult> results(level.size());
    std::atomic<std::size_t> finished{0};
    medial::parallelFor(level.size(), context, [&](std::size_t i) {
      const std::uint64_t seed = medial::Random(settings.seed, nodesSoFar + i).next();
      results[i] = expand(surface, settings, reducer, std::move(level[i]), seed, context);
      const double done = static_cast<double>(++finished) / static_cast<double>(level.size());
      context.report("build", (depth + done) / (settings.levels - 1));
    });
    nodesSoFar += level.size();

    std::vector<WorkNode> next;
    std::size_t refined = 0;
    for (std::uint32_t i = 0; i < results.size(); ++i) {
      refined += results[i].refined ? 1U : 0U;
      for (WorkNode& child : results[i].children) {
        child.parent = i;
        next.push_back(std::move(child));
      }
    }
    if (refined == 0) break;
    tree.winners.push_back({{std::string(reducerName), refined}});
    level = std::move(next);
  }
  return tree;
}

}  // namespace spheretree::builders
