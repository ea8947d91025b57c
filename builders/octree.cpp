// SPDX-License-Identifier: GPL-3.0-or-later
//
// The Spherical Octree, the baseline: a cube around the object, split in halves along each axis again and
// again; a cell that meets the surface (or, for solid cover, the solid) is kept and circumscribed with a
// ball. Other branching factors than 8 split into the nx x ny x nz <= branch parts with the shortest
// diagonal. The root is the smallest ball around the object. G. Bradshaw, C. O'Sullivan 2004, section 2.
#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "builders/level_driver.hpp"
#include "builders/overhang.hpp"
#include "medial/min_ball.hpp"
#include "medial/parallel.hpp"

namespace spheretree::builders {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using medial::Surface;

using Polygon = std::vector<Vector3d>;

struct OctreeNode {
  medial::Ball ball;
  std::uint32_t parent = 0;
  std::string_view maker{};
  AlignedBox3d cell;
  std::vector<Polygon> surface;  // the part of the surface in the cell; empty: the cell is inside the solid
};

medial::Ball circumscribed(const AlignedBox3d& cell) {
  return {cell.center(), (cell.max() - cell.center()).norm()};
}

/// The part of a convex polygon with x <= cut (low side) or x >= cut. Empty when less than a polygon is left.
Polygon clip(const Polygon& polygon, int axis, double cut, bool low) {
  Polygon out;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector3d& a = polygon[i];
    const Vector3d& b = polygon[(i + 1) % polygon.size()];
    const bool aIn = low ? a[axis] <= cut : a[axis] >= cut;
    const bool bIn = low ? b[axis] <= cut : b[axis] >= cut;
    if (aIn) out.push_back(a);
    if (aIn == bIn || a[axis] == cut || b[axis] == cut) continue;
    Vector3d p = a + (cut - a[axis]) / (b[axis] - a[axis]) * (b - a);
    p[axis] = cut;
    out.push_back(p);
  }
  if (out.size() < 3) out.clear();
  return out;
}

/// Splits polygons at planes into parts + 1 slabs; a polygon that lies in a plane goes below it.
std::vector<std::vector<Polygon>> slice(const std::vector<Polygon>& polygons, int axis,
                                        const std::vector<double>& cuts) {
  std::vector<std::vector<Polygon>> slabs(cuts.size() + 1);
  for (const Polygon& polygon : polygons) {
    Polygon rest = polygon;
    for (std::size_t i = 0; i < cuts.size() && !rest.empty(); ++i) {
      bool above = false;
      bool below = false;
      for (const Vector3d& p : rest) {
        above = above || p[axis] > cuts[i];
        below = below || p[axis] < cuts[i];
      }
      if (!above) {
        slabs[i].push_back(std::move(rest));
        rest.clear();
      } else if (below) {
        if (Polygon part = clip(rest, axis, cuts[i], true); !part.empty())
          slabs[i].push_back(std::move(part));
        rest = clip(rest, axis, cuts[i], false);
      }
    }
    if (!rest.empty()) slabs.back().push_back(std::move(rest));
  }
  return slabs;
}

using Split = std::array<std::uint32_t, 3>;

/// The split into at most `branch` equal parts whose parts have the shortest diagonal.
Split bestSplit(const Vector3d& sizes, std::uint32_t branch) {
  Split best{1, 1, 1};
  double bestDiagonal = std::numeric_limits<double>::infinity();
  for (std::uint32_t nx = 1; nx <= branch; ++nx) {
    for (std::uint32_t ny = 1; nx * ny <= branch; ++ny) {
      // The most parts along z that fit: fewer are never better.
      const std::uint32_t nz = branch / (nx * ny);
      const Vector3d part(sizes.x() / nx, sizes.y() / ny, sizes.z() / nz);
      if (part.squaredNorm() < bestDiagonal) {
        bestDiagonal = part.squaredNorm();
        best = {nx, ny, nz};
      }
    }
  }
  return best;
}

std::vector<double> boundaries(double low, double high, std::uint32_t parts) {
  std::vector<double> at;
  for (std::uint32_t i = 0; i <= parts; ++i) {
    const double t = static_cast<double>(i) / parts;
    at.push_back(i == parts ? high : low + t * (high - low));
  }
  return at;
}

std::vector<OctreeNode> splitNode(const Surface& surface, const BuildSettings& settings,
                                  const OctreeNode& node) {
  const Split split = bestSplit(node.cell.sizes(), settings.branch);
  std::array<std::vector<double>, 3> at;
  std::array<std::vector<double>, 3> inner;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<int>(axis);
    at[axis] = boundaries(node.cell.min()[a], node.cell.max()[a], split[axis]);
    inner[axis].assign(at[axis].begin() + 1, at[axis].end() - 1);
  }
  std::vector<OctreeNode> children;
  auto slabs = slice(node.surface, 2, inner[2]);
  for (std::size_t z = 0; z < slabs.size(); ++z) {
    auto rows = slice(slabs[z], 1, inner[1]);
    for (std::size_t y = 0; y < rows.size(); ++y) {
      auto cells = slice(rows[y], 0, inner[0]);
      for (std::size_t x = 0; x < cells.size(); ++x) {
        const AlignedBox3d cell(Vector3d(at[0][x], at[1][y], at[2][z]),
                                Vector3d(at[0][x + 1], at[1][y + 1], at[2][z + 1]));
        const bool kept =
            !cells[x].empty() || (settings.cover == Cover::Solid && surface.inside(cell.center()));
        if (kept) children.push_back({circumscribed(cell), 0, "octree", cell, std::move(cells[x])});
      }
    }
  }
  return children;
}

OctreeNode makeRoot(const Surface& surface) {
  OctreeNode root;
  const medial::TriangleMesh& mesh = surface.mesh();
  std::vector<Vector3d> points;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    root.surface.push_back({mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)});
    points.insert(points.end(), root.surface.back().begin(), root.surface.back().end());
  }
  const Vector3d half = Vector3d::Constant(surface.bounds().sizes().maxCoeff() / 2);
  root.cell = AlignedBox3d(surface.bounds().center() - half, surface.bounds().center() + half);
  root.cell.extend(surface.bounds());  // rounding must not leave a vertex outside
  root.ball = medial::minBall(points);
  return root;
}

}  // namespace

BallTree buildOctree(const Surface& surface, const BuildSettings& settings, const medial::Context& context) {
  BallTree tree;
  std::vector<OctreeNode> level;
  level.push_back(makeRoot(surface));
  for (std::uint32_t depth = 0;; ++depth) {
    tree.levels.emplace_back();
    for (const OctreeNode& node : level) tree.levels.back().push_back({node.ball, node.parent, node.maker});
    if (depth == 0) tree.winners.emplace_back();
    if (depth + 1 >= settings.levels) break;

    std::vector<std::vector<OctreeNode>> children(level.size());
    std::vector<char> refined(level.size(), 0);
    medial::parallelFor(level.size(), context, [&](std::size_t i) {
      if (quickOverhang(surface, level[i].ball) > settings.maxError * surface.diagonal()) {
        children[i] = splitNode(surface, settings, level[i]);
        refined[i] = 1;
      } else {
        children[i].push_back(std::move(level[i]));
      }
    });
    context.report("build", (depth + 1.0) / (settings.levels - 1));

    std::vector<OctreeNode> next;
    for (std::uint32_t i = 0; i < children.size(); ++i) {
      for (OctreeNode& child : children[i]) {
        child.parent = i;
        if (refined[i] == 0) child.maker = "";
        next.push_back(std::move(child));
      }
    }
    const auto count = static_cast<std::size_t>(std::count(refined.begin(), refined.end(), 1));
    if (count == 0) break;
    tree.winners.push_back({{"octree", count}});
    level = std::move(next);
  }
  return tree;
}

}  // namespace spheretree::builders
