// SPDX-License-Identifier: GPL-3.0-or-later
//
// C. Portaneri, M. Rouxel-Labbe, M. Hemmer, D. Cohen-Steiner, P. Alliez, "Alpha Wrapping with an Offset" (ACM
// TOG 41(4), 2022), as CGAL has it, and a bound on how far the wrap ends up from what it wraps.
//
// The bound is branch and bound over pieces of the wrap's triangles. The distance to one convex input
// triangle is a convex function, so over a piece it is largest at a corner: the largest corner distance to
// any one input triangle bounds the piece. The distance to the whole input at the corners bounds the answer
// from below.

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <vector>

#include "io/cgal_bridge.hpp"
#include "io/mesh_closing.hpp"

namespace spheretree::io {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

// Openings narrower than a fiftieth of the diagonal are closed over. That is what a ball of the third level
// of a tree sticks out; a sheet across the whole box becomes 10,000 triangles. Both grow with the square of
// this.
constexpr double kAlphasPerDiagonal = 50;
// The ratio its authors recommend: small enough not to show next to the openings that alpha closes.
constexpr double kOffsetsPerAlpha = 30;
// The bound on the stand-off is within this part of the truth, or what this many pieces give.
constexpr double kStandOffGap = 0.05;
constexpr std::size_t kStandOffPieces = 400'000;

Point toPoint(const Eigen::Vector3d& p) {
  return {p.x(), p.y(), p.z()};
}

/// A part of the wrap; the input triangle nearest to each corner and how far it is.
struct Piece {
  struct Corner {
    Point point;
    Triangles::const_iterator nearest;
    double distance = 0;
  };
  std::array<Corner, 3> corners;
  double bound = 0;

  bool operator<(const Piece& other) const { return bound < other.bound; }
};

class StandOff {
 public:
  explicit StandOff(const Triangles& input) : tree_(input.begin(), input.end()) {
    tree_.accelerate_distance_queries();
  }

  double bound(const medial::TriangleMesh& wrap) {
    std::priority_queue<Piece> pieces;
    for (const auto& t : wrap.triangles) {
      pieces.push(pieceOf({corner(toPoint(wrap.vertices[t[0]])), corner(toPoint(wrap.vertices[t[1]])),
                           corner(toPoint(wrap.vertices[t[2]]))}));
    }
    const std::size_t most = pieces.size() + kStandOffPieces;
    for (std::size_t made = pieces.size(); made < most; made += 4) {
      const Piece worst = pieces.top();
      if (worst.bound <= lower_ * (1 + kStandOffGap)) break;
      pieces.pop();
      const std::array<Piece::Corner, 3>& c = worst.corners;
      const std::array<Piece::Corner, 3> middle = {corner(CGAL::midpoint(c[0].point, c[1].point)),
                                                   corner(CGAL::midpoint(c[1].point, c[2].point)),
                                                   corner(CGAL::midpoint(c[2].point, c[0].point))};
      pieces.push(pieceOf(middle));
      pieces.push(pieceOf({c[0], middle[0], middle[2]}));
      pieces.push(pieceOf({middle[0], c[1], middle[1]}));
      pieces.push(pieceOf({middle[2], middle[1], c[2]}));
    }
    return pieces.top().bound;
  }

 private:
  Piece::Corner corner(const Point& point) {
    const auto [nearestPoint, triangle] = tree_.closest_point_and_primitive(point);
    const double distance = std::sqrt(CGAL::squared_distance(point, nearestPoint));
    lower_ = std::max(lower_, distance);
    return {point, triangle, distance};
  }

  static Piece pieceOf(const std::array<Piece::Corner, 3>& corners) {
    Piece piece{corners, 0};
    // Also: a corner's own distance and the way to the farthest point of the piece.
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
      const Piece::Corner& from = corners[k];
      double reach = 0;
      double toTriangle = 0;
      for (const Piece::Corner& to : corners) {
        reach = std::max(reach, CGAL::squared_distance(from.point, to.point));
        toTriangle = std::max(toTriangle, CGAL::squared_distance(to.point, *from.nearest));
      }
      best = std::min({best, from.distance + std::sqrt(reach), std::sqrt(toTriangle)});
    }
    piece.bound = best;
    return piece;
  }

  Tree tree_;
  double lower_ = 0;
};

}  // namespace

WrappedMesh wrapMesh(const medial::TriangleMesh& mesh) {
  std::vector<Point> points;
  for (const Eigen::Vector3d& p : mesh.vertices) points.push_back(toPoint(p));
  std::vector<std::array<std::size_t, 3>> faces;
  Triangles triangles;
  for (const auto& t : mesh.triangles) {
    const Kernel::Triangle_3 triangle(points[t[0]], points[t[1]], points[t[2]]);
    if (triangle.is_degenerate()) continue;
    faces.push_back({t[0], t[1], t[2]});
    triangles.push_back(triangle);
  }
  WrappedMesh wrapped;
  wrapped.alpha = medial::diagonalOf(mesh) / kAlphasPerDiagonal;
  wrapped.offset = wrapped.alpha / kOffsetsPerAlpha;
  Mesh wrap;
  CGAL::alpha_wrap_3(points, faces, wrapped.alpha, wrapped.offset, wrap);
  wrapped.mesh = fromSurfaceMesh(wrap);
  if (!wrapped.mesh.triangles.empty()) wrapped.standOff = StandOff(triangles).bound(wrapped.mesh);
  return wrapped;
}

}  // namespace spheretree::io
