// SPDX-License-Identifier: GPL-3.0-or-later
//
// Closed meshes of solids with known answers. Everything is built from four recipes: subdivide an icosahedron
// and push the vertices out to the ball; close rings of vertices into strips; fan a ring to a point; extrude
// a grid of unit squares. Each recipe shares its vertices, so the meshes are closed by construction.
#include "models/shapes.hpp"

#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "models/assemble.hpp"

namespace spheretree::models {
namespace {

using Eigen::Vector3d;
using Index = std::uint32_t;

constexpr double kTurn = 2 * std::numbers::pi;

constexpr Index kFewestSegments = 3;

constexpr double kGearTip = 1.0;
constexpr double kGearRoot = 0.8;
constexpr double kGearBore = 0.3;
constexpr double kGearThickness = 0.4;

constexpr double kKnotMajor = 2.0;
constexpr double kKnotMinor = 1.0;
constexpr double kKnotTube = 0.35;  // the strands are 1.2 apart or more: the tube never meets itself

/// The icosahedron whose edges are halved by the coordinate axes, vertices at distance 1.
TriangleMesh makeIcosahedron() {
  const double longLeg = std::sqrt((5 + std::sqrt(5.0)) / 10);
  const double shortLeg = std::sqrt((5 - std::sqrt(5.0)) / 10);
  TriangleMesh mesh;
  for (int axis = 0; axis < 3;
       ++axis) {  // vertex 4 axis + 2 i + j: shortLeg signed by i, longLeg signed by j
    for (const double s : {shortLeg, -shortLeg}) {
      for (const double l : {longLeg, -longLeg}) {
        Vector3d vertex = Vector3d::Zero();
        vertex[(axis + 1) % 3] = s;
        vertex[(axis + 2) % 3] = l;
        mesh.vertices.push_back(vertex.normalized());
      }
    }
  }
  for (Index axis = 0; axis < 3; ++axis) {  // two faces at each of the six edges that an axis halves
    const Index here = 4 * axis;
    const Index next = 4 * ((axis + 1) % 3);
    for (Index side = 0; side < 2; ++side) {
      for (Index across = 0; across < 2; ++across) {
        mesh.triangles.push_back({here + side, here + 2 + side, next + 2 * side + across});
      }
    }
  }
  for (Index octant = 0; octant < 8; ++octant) {  // and one face in each octant
    const Index x = octant & 1U;
    const Index y = (octant >> 1U) & 1U;
    const Index z = (octant >> 2U) & 1U;
    mesh.triangles.push_back({2 * y + z, 4 + 2 * z + x, 8 + 2 * x + y});
  }
  for (TriangleMesh::Triangle& t : mesh.triangles) {  // convex around the origin: outwards is away from it
    const Vector3d normal =
        (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
    if (normal.dot(mesh.vertices[t[0]]) < 0) std::swap(t[1], t[2]);
  }
  return mesh;
}

/// Four triangles for each, the new vertices at the edge midpoints pushed out to distance 1.
TriangleMesh subdividedOnBall(TriangleMesh mesh) {
  std::map<std::pair<Index, Index>, Index> midpoints;
  const auto midpoint = [&](Index a, Index b) {
    const auto [place, isNew] =
        midpoints.try_emplace(std::minmax(a, b), static_cast<Index>(mesh.vertices.size()));
    if (isNew) {
      const Vector3d sum = mesh.vertices[a] + mesh.vertices[b];
      mesh.vertices.push_back(sum.normalized());
    }
    return place->second;
  };
  std::vector<TriangleMesh::Triangle> triangles;
  triangles.reserve(4 * mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Index ab = midpoint(a, b);
    const Index bc = midpoint(b, c);
    const Index ca = midpoint(c, a);
    triangles.push_back({a, ab, ca});
    triangles.push_back({b, bc, ab});
    triangles.push_back({c, ca, bc});
    triangles.push_back({ab, bc, ca});
  }
  mesh.triangles = std::move(triangles);
  return mesh;
}

/// Consecutive vertices first, first + 1, ... that form a closed polygon.
struct Ring {
  Index first = 0;
  Index size = 0;

  [[nodiscard]] Index operator[](Index i) const { return first + i % size; }
};

Ring addCircle(TriangleMesh& mesh, double radius, double z, Index segments) {
  const Ring ring{static_cast<Index>(mesh.vertices.size()), segments};
  for (Index i = 0; i < segments; ++i) {
    const double angle = kTurn * i / segments;
    mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  return ring;
}

/// The strip between two rings of equal size; seen from outside, `upper` lies to the left of `lower`.
void addStrip(TriangleMesh& mesh, Ring lower, Ring upper) {
  assert(lower.size == upper.size);
  for (Index i = 0; i < lower.size; ++i) {
    mesh.triangles.push_back({lower[i], lower[i + 1], upper[i + 1]});
    mesh.triangles.push_back({lower[i], upper[i + 1], upper[i]});
  }
}

enum class Facing { AlongRing, AgainstRing };

/// The cone from a ring to a new vertex; facing the side from which the ring runs counter-clockwise, or not.
void addFan(TriangleMesh& mesh, Ring ring, const Vector3d& apex, Facing facing) {
  const auto top = static_cast<Index>(mesh.vertices.size());
  mesh.vertices.push_back(apex);
  for (Index i = 0; i < ring.size; ++i) {
    if (facing == Facing::AlongRing) {
      mesh.triangles.push_back({ring[i], ring[i + 1], top});
    } else {
      mesh.triangles.push_back({ring[i + 1], ring[i], top});
    }
  }
}

/// One layer of unit cubes seen from above: rows from high y to low y, `#` where there is a cube.
using Plan = std::vector<std::string_view>;

/// Extrudes plans between z = 0 and z = 1; the lower left corner of the plan is the origin.
class PlanExtruder {
 public:
  explicit PlanExtruder(const Plan& plan)
      : plan_(plan), width_(static_cast<int>(plan.front().size())), height_(static_cast<int>(plan.size())) {
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        if (solid(x, y)) addCube(x, y);
      }
    }
  }

  [[nodiscard]] TriangleMesh take() && { return std::move(mesh_); }

 private:
  [[nodiscard]] bool solid(int x, int y) const {
    if (x < 0 || y < 0 || x >= width_ || y >= height_) return false;
    return plan_[static_cast<std::size_t>(height_ - 1 - y)][static_cast<std::size_t>(x)] == '#';
  }

  Index vertex(int x, int y, int z) {
    const auto [place, isNew] =
        indices_.try_emplace(std::array{x, y, z}, static_cast<Index>(mesh_.vertices.size()));
    if (isNew) mesh_.vertices.emplace_back(x, y, z);
    return place->second;
  }

  void addQuad(Index a, Index b, Index c, Index d) {
    mesh_.triangles.push_back({a, b, c});
    mesh_.triangles.push_back({a, c, d});
  }

  /// A wall over the plan's edge from p to q, the solid on its left.
  void addWall(std::array<int, 2> p, std::array<int, 2> q) {
    addQuad(vertex(p[0], p[1], 0), vertex(q[0], q[1], 0), vertex(q[0], q[1], 1), vertex(p[0], p[1], 1));
  }

  void addCube(int x, int y) {
    addQuad(vertex(x, y, 1), vertex(x + 1, y, 1), vertex(x + 1, y + 1, 1), vertex(x, y + 1, 1));
    addQuad(vertex(x, y, 0), vertex(x, y + 1, 0), vertex(x + 1, y + 1, 0), vertex(x + 1, y, 0));
    if (!solid(x, y - 1)) addWall({x, y}, {x + 1, y});
    if (!solid(x + 1, y)) addWall({x + 1, y}, {x + 1, y + 1});
    if (!solid(x, y + 1)) addWall({x + 1, y + 1}, {x, y + 1});
    if (!solid(x - 1, y)) addWall({x, y + 1}, {x, y});
  }

  const Plan& plan_;
  int width_;
  int height_;
  TriangleMesh mesh_;
  std::map<std::array<int, 3>, Index> indices_;
};

/// A point of the trefoil on its torus and the two directions across it. The torus' own normal is at right
/// angles to every curve on the torus, so this frame is exact and closes after one turn.
struct KnotFrame {
  Vector3d point;
  Vector3d normal;
  Vector3d binormal;
};

KnotFrame knotFrame(double t) {
  const double around = 2 * t;
  const double across = 3 * t;
  const Vector3d outward(std::cos(around), std::sin(around), 0);
  const Vector3d sideways(-std::sin(around), std::cos(around), 0);
  const Vector3d up = Vector3d::UnitZ();
  const double reach = kKnotMajor + kKnotMinor * std::cos(across);
  const Vector3d normal = std::cos(across) * outward + std::sin(across) * up;
  const Vector3d tangent =
      2 * reach * sideways + 3 * kKnotMinor * (std::cos(across) * up - std::sin(across) * outward);
  return {reach * outward + kKnotMinor * std::sin(across) * up, normal, tangent.normalized().cross(normal)};
}

}  // namespace

TriangleMesh makeBall(double radius, std::uint32_t subdivisions) {
  TriangleMesh mesh = makeIcosahedron();
  for (Index i = 0; i < subdivisions; ++i) mesh = subdividedOnBall(std::move(mesh));
  for (Vector3d& vertex : mesh.vertices) vertex *= radius;
  return mesh;
}

TriangleMesh makeBox(const Vector3d& size) {
  const Plan cube{"#"};
  TriangleMesh mesh = PlanExtruder(cube).take();
  for (Vector3d& vertex : mesh.vertices) vertex = (vertex.array() - 0.5).matrix().cwiseProduct(size);
  return mesh;
}

TriangleMesh makeCylinder(double radius, double height, std::uint32_t segments) {
  assert(segments >= kFewestSegments);
  TriangleMesh mesh;
  const Ring bottom = addCircle(mesh, radius, -height / 2, segments);
  const Ring top = addCircle(mesh, radius, height / 2, segments);
  addStrip(mesh, bottom, top);
  addFan(mesh, top, {0, 0, height / 2}, Facing::AlongRing);
  addFan(mesh, bottom, {0, 0, -height / 2}, Facing::AgainstRing);
  return mesh;
}

TriangleMesh makeCone(double radius, double height, std::uint32_t segments) {
  assert(segments >= kFewestSegments);
  TriangleMesh mesh;
  const Ring base = addCircle(mesh, radius, 0, segments);
  addFan(mesh, base, {0, 0, height}, Facing::AlongRing);
  addFan(mesh, base, Vector3d::Zero(), Facing::AgainstRing);
  return mesh;
}

TriangleMesh makeTorus(double majorRadius, double minorRadius, std::uint32_t segments, std::uint32_t sides) {
  assert(segments >= kFewestSegments && sides >= kFewestSegments);
  TriangleMesh mesh;
  std::vector<Ring> rings;
  for (Index i = 0; i < sides; ++i) {
    const double angle = kTurn * i / sides;
    rings.push_back(addCircle(mesh, majorRadius + minorRadius * std::cos(angle),
                              minorRadius * std::sin(angle), segments));
  }
  for (Index i = 0; i < sides; ++i) addStrip(mesh, rings[i], rings[(i + 1) % sides]);
  return mesh;
}

TriangleMesh makeSlab() {
  return makeBox({1, 1, 0.001});
}

TriangleMesh makeNeedle() {
  return makeBox({1, 0.001, 0.001});
}

TriangleMesh makeLBlock() {
  const Plan plan{"#.",  //
                  "##"};
  return PlanExtruder(plan).take();
}

TriangleMesh makeUBlock() {
  const Plan plan{"#.#",  //
                  "###"};
  return PlanExtruder(plan).take();
}

TriangleMesh makeHollowBall(double outer, double inner, std::uint32_t subdivisions) {
  assert(0 < inner && inner < outer);
  return joined(makeBall(outer, subdivisions), reversed(makeBall(inner, subdivisions)));
}

TriangleMesh makeTangentBalls(double radius, std::uint32_t subdivisions) {
  assert(subdivisions > 0);  // an icosahedron has no vertex on the axis
  TriangleMesh mesh = joined(moved(makeBall(radius, subdivisions), {-radius, 0, 0}),
                             moved(makeBall(radius, subdivisions), {radius, 0, 0}));
  std::vector<Index> atOrigin;
  for (Index i = 0; i < mesh.vertices.size(); ++i) {
    if (mesh.vertices[i].isZero(0)) atOrigin.push_back(i);
  }
  assert(atOrigin.size() == 2);
  mesh.vertices.erase(mesh.vertices.begin() + atOrigin[1]);
  for (TriangleMesh::Triangle& triangle : mesh.triangles) {
    for (Index& corner : triangle) {
      if (corner == atOrigin[1]) {
        corner = atOrigin[0];
      } else if (corner > atOrigin[1]) {
        --corner;
      }
    }
  }
  return mesh;
}

TriangleMesh makeComb(std::uint32_t teeth) {
  assert(teeth > 0);
  std::string teethRow = "#";
  for (Index i = 1; i < teeth; ++i) teethRow += ".#";
  const std::string bar(teethRow.size(), '#');
  const Plan plan{teethRow, teethRow, teethRow, bar};
  return PlanExtruder(plan).take();
}

TriangleMesh makeGear(std::uint32_t teeth) {
  assert(teeth >= kFewestSegments);
  const Index segments = 4 * teeth;  // per tooth: two at the root, two at the tip
  const auto addOutline = [&](TriangleMesh& mesh, double z) {
    const Ring ring = addCircle(mesh, 1, z, segments);
    for (Index i = 0; i < segments; ++i) mesh.vertices[ring[i]].head<2>() *= i % 4 < 2 ? kGearRoot : kGearTip;
    return ring;
  };
  TriangleMesh mesh;
  const Ring outerLow = addOutline(mesh, -kGearThickness / 2);
  const Ring outerHigh = addOutline(mesh, kGearThickness / 2);
  const Ring innerHigh = addCircle(mesh, kGearBore, kGearThickness / 2, segments);
  const Ring innerLow = addCircle(mesh, kGearBore, -kGearThickness / 2, segments);
  addStrip(mesh, outerLow, outerHigh);
  addStrip(mesh, outerHigh, innerHigh);
  addStrip(mesh, innerHigh, innerLow);
  addStrip(mesh, innerLow, outerLow);
  return mesh;
}

TriangleMesh makeKnot(std::uint32_t segments, std::uint32_t sides) {
  assert(segments >= kFewestSegments && sides >= kFewestSegments);
  TriangleMesh mesh;
  std::vector<Ring> rings;
  for (Index i = 0; i < segments; ++i) {
    const KnotFrame frame = knotFrame(kTurn * i / segments);
    rings.push_back(addCircle(mesh, kKnotTube, 0, sides));
    for (Index k = 0; k < sides; ++k) {
      Vector3d& vertex = mesh.vertices[rings.back()[k]];
      vertex = frame.point + vertex.x() * frame.normal + vertex.y() * frame.binormal;
    }
  }
  for (Index i = 0; i < segments; ++i) addStrip(mesh, rings[i], rings[(i + 1) % segments]);
  return mesh;
}

}  // namespace spheretree::models
