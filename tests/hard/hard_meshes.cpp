// SPDX-License-Identifier: GPL-3.0-or-later
//
// Meshes of tests/hard/cases.csv: decent shapes, and one thing done to each. Everything random has a seed.
#include "tests/hard/hard_inputs.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "io/soup_cleaning.hpp"
#include "medial/random.hpp"
#include "models/assemble.hpp"
#include "models/shapes.hpp"

namespace spheretree::test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using medial::TriangleMesh;
using models::joined;
using models::makeBall;
using models::makeBox;
using models::makeCylinder;
using models::moved;
using models::reversed;
using Index = std::uint32_t;

constexpr double kTurn = 2 * std::numbers::pi;

// --- tools ---

TriangleMesh scaled(TriangleMesh mesh, double factor) {
  for (Vector3d& vertex : mesh.vertices) vertex *= factor;
  return mesh;
}

TriangleMesh cube() {
  return makeBox(Vector3d::Ones());
}

/// The sheet origin + [0, n] u + [0, n] v in unit steps, facing u x v.
TriangleMesh sheet(const Vector3d& origin, const Vector3d& u, const Vector3d& v, Index n) {
  TriangleMesh mesh;
  for (Index i = 0; i <= n; ++i) {
    for (Index j = 0; j <= n; ++j) mesh.vertices.emplace_back(origin + i * u + j * v);
  }
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      const Index a = i * (n + 1) + j;
      const Index b = a + n + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  }
  return mesh;
}

/// A unit cube with n x n squares on every side. Coordinates are multiples of 1 / n in double, welded.
TriangleMesh gridCube(Index n) {
  const Vector3d x = Vector3d::UnitX();
  const Vector3d y = Vector3d::UnitY();
  const Vector3d z = Vector3d::UnitZ();
  TriangleMesh mesh;
  for (const auto& [u, v] : {std::pair{x, y}, {y, z}, {z, x}}) {
    mesh = joined(std::move(mesh), sheet(n * u.cross(v), u, v, n));
    mesh = joined(std::move(mesh), sheet(Vector3d::Zero(), v, u, n));
  }
  return scaled(io::weldVertices(std::move(mesh)), 1.0 / n);
}

/// Extrudes a convex polygon, given counter-clockwise, from z = 0 to `height`.
TriangleMesh prism(const std::vector<Vector2d>& outline, double height) {
  TriangleMesh mesh;
  const auto n = static_cast<Index>(outline.size());
  for (const double z : {0.0, height}) {
    for (const Vector2d& corner : outline) mesh.vertices.emplace_back(corner.x(), corner.y(), z);
  }
  for (Index i = 0; i < n; ++i) {
    const Index next = (i + 1) % n;
    mesh.triangles.push_back({i, next, n + next});
    mesh.triangles.push_back({i, n + next, n + i});
  }
  for (Index i = 1; i + 1 < n; ++i) {
    mesh.triangles.push_back({0, i + 1, i});
    mesh.triangles.push_back({n, n + i, n + i + 1});
  }
  return mesh;
}

/// Keeps the triangles that `wanted` says yes to, by index.
template <class Wanted>
TriangleMesh filtered(TriangleMesh mesh, Wanted wanted) {
  std::vector<TriangleMesh::Triangle> kept;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (wanted(t)) kept.push_back(mesh.triangles[t]);
  mesh.triangles = std::move(kept);
  return mesh;
}

/// Every corner has its own vertex, shaken by up to `amount` along each axis.
TriangleMesh shakenSoup(const TriangleMesh& mesh, double amount) {
  medial::Random random(7);
  TriangleMesh soup;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto first = static_cast<Index>(soup.vertices.size());
    soup.triangles.push_back({first, first + 1, first + 2});
    for (std::size_t k = 0; k < 3; ++k) {
      Vector3d vertex = mesh.corner(t, k);
      for (double& coordinate : vertex) coordinate += random.uniform(-amount, amount);
      soup.vertices.push_back(vertex);
    }
  }
  return soup;
}

/// A closed or half-closed grid of n x m vertices, index (i, j) -> point. `twist` joins the last column to
/// the first one upside down.
enum class Seam { Straight, Twisted };

template <class Point>
TriangleMesh ring(Index n, Index rows, Seam seam, Point point) {
  TriangleMesh mesh;
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < rows; ++j) mesh.vertices.push_back(point(i, j));
  }
  const auto at = [&](Index i, Index j) {
    const bool turned = i == n && seam == Seam::Twisted;
    return (i % n) * rows + (turned ? rows - 1 - j : j);
  };
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j + 1 < rows; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

// --- cospherical ---

/// Rings of latitude: every ring is cocircular, all of them are cospherical.
TriangleMesh latitudeBall(Index rings, Index segments) {
  TriangleMesh mesh;
  for (Index i = 1; i < rings; ++i) {
    const double polar = std::numbers::pi * i / rings;
    for (Index k = 0; k < segments; ++k) {
      const double angle = kTurn * k / segments;
      mesh.vertices.emplace_back(std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle),
                                 std::cos(polar));
    }
  }
  const auto north = static_cast<Index>(mesh.vertices.size());
  mesh.vertices.emplace_back(0, 0, 1);
  mesh.vertices.emplace_back(0, 0, -1);
  const auto at = [&](Index i, Index k) { return (i - 1) * segments + k % segments; };
  for (Index k = 0; k < segments; ++k) {
    mesh.triangles.push_back({north, at(1, k), at(1, k + 1)});
    for (Index i = 1; i + 1 < rings; ++i) {
      mesh.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      mesh.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
    mesh.triangles.push_back({north + 1, at(rings - 1, k + 1), at(rings - 1, k)});
  }
  return mesh;
}

// --- slivers and near-duplicates ---

/// A cube, each of its twelve triangles cut in three by a point at `height` from the middle of an edge.
TriangleMesh sliverCube(double height) {
  TriangleMesh mesh = cube();
  std::vector<TriangleMesh::Triangle> fine;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vector3d middle = (mesh.vertices[a] + mesh.vertices[b]) / 2;
    const Vector3d inwards = (mesh.vertices[c] - middle).normalized();
    const auto m = static_cast<Index>(mesh.vertices.size());
    mesh.vertices.emplace_back(middle + height * inwards);
    fine.push_back({a, b, m});
    fine.push_back({b, c, m});
    fine.push_back({c, a, m});
  }
  mesh.triangles = std::move(fine);
  return mesh;
}

/// A prism over a circle of 16 corners, each of which is there twice, `gap` apart.
TriangleMesh doubledCorners(double gap) {
  std::vector<Vector2d> outline;
  for (Index i = 0; i < 16; ++i) {
    const double angle = kTurn * i / 16;
    const Vector2d corner(std::cos(angle), std::sin(angle));
    const Vector2d along(-corner.y(), corner.x());
    outline.emplace_back(corner - gap / 2 * along);
    outline.emplace_back(corner + gap / 2 * along);
  }
  return prism(outline, 1);
}

// --- components ---

/// Solids and cavities in turn, or solids only.
enum class Shells { Alternating, Outwards };

TriangleMesh nestedShells(Index count, Shells shells) {
  TriangleMesh mesh;
  for (Index k = 0; k < count; ++k) {
    TriangleMesh ball = makeBall(1 - 0.15 * k, 2);
    mesh = joined(std::move(mesh), shells == Shells::Alternating && k % 2 == 1 ? reversed(ball) : ball);
  }
  return mesh;
}

/// A cubic lattice of n^3 small cubes, each shifted a little so that no two are alike.
TriangleMesh lattice(Index n) {
  medial::Random random(3);
  TriangleMesh mesh;
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      for (Index k = 0; k < n; ++k) {
        const Vector3d shift(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2));
        mesh = joined(std::move(mesh), moved(scaled(cube(), 0.5), Vector3d(i, j, k) + shift));
      }
    }
  }
  return mesh;
}

// --- crowded edges and vertices ---

TriangleMesh cubesSharingAnEdge() {
  return io::weldVertices(joined(cube(), moved(cube(), {1, 1, 0})));
}

TriangleMesh cubesSharingAVertex() {
  return io::weldVertices(joined(cube(), moved(cube(), {1, 1, 1})));
}

/// Two cubes with the wall between them there once.
TriangleMesh cubesWithOneWall() {
  const TriangleMesh both = io::weldVertices(joined(cube(), moved(cube(), {1, 0, 0})));
  bool kept = false;
  std::size_t walls = 0;
  return filtered(both, [&](std::size_t t) {
    for (std::size_t k = 0; k < 3; ++k)
      if (both.corner(t, k).x() != 0.5) return true;
    kept = walls++ < 2;  // two triangles of the first cube, then two of the second
    return kept;
  });
}

/// A cube with a sheet standing on its top.
TriangleMesh cubeWithFin() {
  TriangleMesh mesh = cube();
  const auto first = static_cast<Index>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(),
                       {Vector3d(-0.4, 0, 0.5), Vector3d(0.4, 0, 0.5), Vector3d(0, 0, 1)});
  mesh.triangles.push_back({first, first + 1, first + 2});
  return mesh;
}

/// `count` square pages around one common edge.
TriangleMesh book(Index count) {
  TriangleMesh mesh;
  mesh.vertices = {Vector3d::Zero(), Vector3d::UnitZ()};
  for (Index i = 0; i < count; ++i) {
    const double angle = 2.0 * i / count;
    const auto first = static_cast<Index>(mesh.vertices.size());
    const Vector3d out(std::cos(angle), std::sin(angle), 0);
    mesh.vertices.push_back(out);
    mesh.vertices.emplace_back(out + Vector3d::UnitZ());
    mesh.triangles.push_back({0, first, first + 1});
    mesh.triangles.push_back({0, first + 1, 1});
  }
  return mesh;
}

// --- orientation ---

TriangleMesh randomlyFlipped(TriangleMesh mesh) {
  medial::Random random(11);
  for (TriangleMesh::Triangle& triangle : mesh.triangles)
    if (random.uniform() < 0.5) std::swap(triangle[1], triangle[2]);
  return mesh;
}

// --- open and one-sided ---

/// Without every `every`-th triangle.
TriangleMesh holed(const TriangleMesh& mesh, std::size_t every) {
  return filtered(mesh, [every](std::size_t t) { return t % every != 0; });
}

TriangleMesh gridTopBox() {
  // The other five sides keep their two triangles: the rim of the top has vertices that they do not have.
  const TriangleMesh box = cube();
  TriangleMesh rest = filtered(box, [&](std::size_t t) {
    return box.corner(t, 0).z() + box.corner(t, 1).z() + box.corner(t, 2).z() < 1.4;
  });
  return io::weldVertices(joined(
      std::move(rest), sheet(Vector3d(-0.5, -0.5, 0.5), Vector3d(0.25, 0, 0), Vector3d(0, 0.25, 0), 4)));
}

TriangleMesh moebius() {
  constexpr Index kSegments = 48;
  constexpr Index kRows = 4;
  return ring(kSegments, kRows, Seam::Twisted, [](Index i, Index j) {
    const double angle = kTurn * i / kSegments;
    const double across = 0.3 * (2.0 * j / (kRows - 1) - 1);
    const double reach = 1 + across * std::cos(angle / 2);
    return Vector3d(reach * std::cos(angle), reach * std::sin(angle), across * std::sin(angle / 2));
  });
}

/// The figure of eight, turned by half a turn on its way around: closed, one-sided, crosses itself.
TriangleMesh klein() {
  constexpr Index kSegments = 48;
  constexpr Index kRows = 25;  // the first and the last are the same row
  TriangleMesh mesh = ring(kSegments, kRows, Seam::Twisted, [](Index i, Index j) {
    const double u = kTurn * i / kSegments;
    const double v = kTurn * (j % (kRows - 1)) / (kRows - 1);
    const double reach = 1 + 0.4 * (std::cos(u / 2) * std::sin(v) - std::sin(u / 2) * std::sin(2 * v));
    return Vector3d(reach * std::cos(u), reach * std::sin(u),
                    0.4 * (std::sin(u / 2) * std::sin(v) + std::cos(u / 2) * std::sin(2 * v)));
  });
  return io::weldVertices(std::move(mesh));
}

// --- almost nothing ---

TriangleMesh singleTriangle() {
  return {{Vector3d::Zero(), Vector3d::UnitX(), Vector3d::UnitY()}, {{0, 1, 2}}};
}

/// The same sheet from both sides, closed along its rim.
TriangleMesh doubleSheet() {
  const TriangleMesh front = sheet(Vector3d::Zero(), Vector3d::UnitX(), Vector3d::UnitY(), 4);
  return io::weldVertices(joined(front, reversed(front)));
}

TriangleMesh flatTetrahedron() {
  return {{Vector3d::Zero(), Vector3d::UnitX(), Vector3d::UnitY(), Vector3d(1, 1, 0)},
          {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

TriangleMesh pointsOnALine() {
  return {{Vector3d::Zero(), Vector3d::Ones(), Vector3d::Constant(2), Vector3d::Constant(3)},
          {{0, 1, 2}, {1, 2, 3}}};
}

TriangleMesh noTriangleWithArea() {
  return {{Vector3d::Ones(), Vector3d::Ones(), Vector3d::Ones()}, {{0, 1, 2}}};
}

// --- crossing itself ---

/// A bow tie extruded: one half winds the wrong way.
TriangleMesh bowTie() {
  TriangleMesh mesh;
  const std::array<Vector2d, 4> outline{{{0, 0}, {1, 1}, {1, 0}, {0, 1}}};
  for (const double z : {0.0, 0.5}) {
    for (const Vector2d& corner : outline) mesh.vertices.emplace_back(corner.x(), corner.y(), z);
  }
  for (Index i = 0; i < 4; ++i) {
    const Index next = (i + 1) % 4;
    mesh.triangles.push_back({i, next, 4 + next});
    mesh.triangles.push_back({i, 4 + next, 4 + i});
  }
  for (const auto& t : {TriangleMesh::Triangle{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}})
    mesh.triangles.push_back(t);
  return mesh;
}

/// Every vertex somewhere at random: a closed surface that crosses itself everywhere.
TriangleMesh scrambledBall() {
  TriangleMesh mesh = makeBall(1, 2);
  medial::Random random(5);
  for (Vector3d& vertex : mesh.vertices) {
    for (double& coordinate : vertex) coordinate = random.uniform(-1, 1);
  }
  return mesh;
}

TriangleMesh farAway(double diagonals) {
  const TriangleMesh mesh = makeBox({1, 0.6, 0.4});
  return moved(mesh, diagonals * medial::diagonalOf(mesh) * Vector3d(0.6, -0.64, 0.48));
}

TriangleMesh sized(double size) {
  return scaled(models::makeLBlock(), size);
}

constexpr HardInput kMeshes[] = {
    {"cube.obj", cube},
    {"cube_grid.obj", [] { return gridCube(8); }},
    {"cylinder_8.obj", [] { return makeCylinder(0.5, 2, 8); }},
    {"cylinder_128.obj", [] { return makeCylinder(0.5, 2, 128); }},
    {"icosphere_0.obj", [] { return makeBall(1, 0); }},
    {"icosphere_2.obj", [] { return makeBall(1, 2); }},
    {"icosphere_4.obj", [] { return makeBall(1, 4); }},
    {"latitude_ball_6.obj", [] { return latitudeBall(6, 6); }},
    {"latitude_ball_24.obj", [] { return latitudeBall(24, 48); }},
    {"two_balls_apart.obj",
     [] {
       return joined(makeBall(1, 2), moved(makeBall(1, 2), {3, 0, 0}));
     }},

    {"slab_1e3.obj",
     [] {
       return makeBox({1000, 1000, 1});
     }},
    {"slab_1e6.obj",
     [] {
       return makeBox({1e6, 1e6, 1});
     }},
    {"knife_edge_1e3.obj",
     [] {
       return prism({{0, 0}, {1, -5e-4}, {1, 5e-4}}, 1);
     }},
    {"knife_edge_1e6.obj",
     [] {
       return prism({{0, 0}, {1, -5e-7}, {1, 5e-7}}, 1);
     }},
    {"needle_1e3.obj", models::makeNeedle},
    {"needle_1e6.obj",
     [] {
       return makeBox({1, 1e-6, 1e-6});
     }},
    {"spike.obj", [] { return models::makeCone(1e-4, 1, 16); }},

    {"sliver_1e3.obj", [] { return sliverCube(1e-3); }},
    {"sliver_1e6.obj", [] { return sliverCube(1e-6); }},
    {"sliver_1e9.obj", [] { return sliverCube(1e-9); }},
    {"sliver_1e12.obj", [] { return sliverCube(1e-12); }},
    {"fan_10000.obj", [] { return models::makeCone(1, 1, 10000); }},
    {"fan_100000.obj", [] { return models::makeCone(1, 1, 100000); }},
    {"corners_1e-7.obj", [] { return doubledCorners(1e-7); }},
    {"corners_1e-12.obj", [] { return doubledCorners(1e-12); }},
    {"corners_1e-15.obj", [] { return doubledCorners(1e-15); }},
    {"soup_1e-7.obj", [] { return shakenSoup(makeBall(1, 1), 1e-7); }},
    {"soup_1e-15.obj", [] { return shakenSoup(makeBall(1, 1), 1e-15); }},
    {"t_junctions.obj", gridTopBox},

    {"far_1e3.obj", [] { return farAway(1e3); }},
    {"far_1e6.obj", [] { return farAway(1e6); }},
    {"far_1e9.obj", [] { return farAway(1e9); }},
    {"far_1e15.obj", [] { return farAway(1e15); }},
    {"size_1e-300.obj", [] { return sized(1e-300); }},
    {"size_1e-42.obj", [] { return sized(1e-42); }},
    {"size_1e-30.obj", [] { return sized(1e-30); }},
    {"size_1e-12.obj", [] { return sized(1e-12); }},
    {"size_1e-6.obj", [] { return sized(1e-6); }},
    {"size_1e6.obj", [] { return sized(1e6); }},
    {"size_1e12.obj", [] { return sized(1e12); }},
    {"size_1e30.obj", [] { return sized(1e30); }},
    {"size_1e39.obj", [] { return sized(1e39); }},
    {"size_1e160.obj", [] { return sized(1e160); }},
    {"size_1e307.obj", [] { return sized(1e307); }},
    {"denormals.obj", [] { return sized(5e-320); }},

    {"hollow_ball.obj", [] { return models::makeHollowBall(1, 0.7, 2); }},
    {"nested_alternating.obj", [] { return nestedShells(5, Shells::Alternating); }},
    {"nested_solids.obj", [] { return nestedShells(5, Shells::Outwards); }},
    {"thin_shell.obj", [] { return models::makeHollowBall(1, 0.999, 2); }},
    {"touching_boxes.obj",
     [] {
       return joined(cube(), moved(cube(), {1, 0.25, 0}));
     }},
    {"overlapping_boxes.obj",
     [] {
       return joined(cube(), moved(cube(), {0.5, 0.25, 0.125}));
     }},
    {"same_box_twice.obj",
     [] {
       return joined(cube(), moved(cube(), {0, 0, 0x1p-40}));
     }},
    {"gap_1e-9.obj",
     [] {
       return joined(cube(), moved(cube(), {1 + 1e-9, 0, 0}));
     }},
    {"big_and_tiny.obj",
     [] {
       return joined(cube(), moved(scaled(cube(), 1e-6), {3, 0, 0}));
     }},
    {"components_125.obj", [] { return lattice(5); }},
    {"components_10648.obj", [] { return lattice(22); }},

    {"crossing_boxes.obj",
     [] {
       return joined(makeBox({2, 0.5, 0.5}), makeBox({0.75, 0.625, 2}));
     }},
    {"spindle_torus.obj", [] { return models::makeTorus(0.5, 1, 24, 16); }},
    {"bow_tie.obj", bowTie},
    {"scrambled_ball.obj", scrambledBall},

    {"cubes_sharing_an_edge.obj", cubesSharingAnEdge},
    {"cubes_sharing_a_vertex.obj", cubesSharingAVertex},
    {"cubes_with_one_wall.obj", cubesWithOneWall},
    {"cube_with_fin.obj", cubeWithFin},
    {"book.obj", [] { return book(5); }},

    {"inside_out.obj", [] { return reversed(makeBall(1, 2)); }},
    {"one_facet_flipped.obj",
     [] {
       TriangleMesh mesh = makeBall(1, 2);
       std::swap(mesh.triangles.front()[1], mesh.triangles.front()[2]);
       return mesh;
     }},
    {"randomly_flipped.obj", [] { return randomlyFlipped(makeBall(1, 3)); }},
    {"mixed_shells.obj",
     [] {
       return joined(cube(), moved(reversed(cube()), {2, 0, 0}));
     }},

    {"one_hole.obj", [] { return holed(makeBall(1, 3), 5000); }},
    {"half_ball.obj",
     [] {
       const TriangleMesh ball = makeBall(1, 3);
       return filtered(ball, [&](std::size_t t) {
         return ball.corner(t, 0).z() + ball.corner(t, 1).z() + ball.corner(t, 2).z() > 0;
       });
     }},
    {"tube.obj",
     [] {
       const TriangleMesh solid = makeCylinder(0.5, 2, 32);
       return filtered(solid, [&](std::size_t t) { return t < 64; });
     }},
    {"holes_160.obj", [] { return holed(makeBall(1, 3), 8); }},
    {"holes_2560.obj", [] { return holed(makeBall(1, 5), 8); }},
    {"holes_40960.obj", [] { return holed(makeBall(1, 7), 8); }},
    {"moebius.obj", moebius},
    {"klein.obj", klein},

    {"single_triangle.obj", singleTriangle},
    {"flat_sheet.obj", [] { return sheet(Vector3d::Zero(), Vector3d::UnitX(), Vector3d::UnitY(), 4); }},
    {"double_sheet.obj", doubleSheet},
    {"flat_tetrahedron.obj", flatTetrahedron},
    {"points_on_a_line.obj", pointsOnALine},
    {"one_point.obj", noTriangleWithArea},

    {"ball_1310720.ply", [] { return makeBall(1, 8); }},
    {"cube_grid_1080000.ply", [] { return gridCube(300); }},
    {"knot_1200000.ply", [] { return models::makeKnot(30000, 20); }},
};

}  // namespace

std::span<const HardInput> hardMeshes() {
  return kMeshes;
}

}  // namespace spheretree::test
