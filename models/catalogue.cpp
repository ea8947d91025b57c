// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every model at its standard size, with its closed-form volume where there is one. The open and the
// degenerate ones are closed shapes with something taken away or done to them.
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "models/assemble.hpp"
#include "models/shapes.hpp"

namespace spheretree::models {
namespace {

using Eigen::Vector3d;
using Index = std::uint32_t;

constexpr double kTurn = 2 * std::numbers::pi;

const Vector3d kBoxSize(1, 0.6, 0.4);  // three different sides: every axis can be told from the others

/// Area of the regular polygon with its corners on the circle.
double polygonArea(double radius, Index corners) {
  return 0.5 * corners * radius * radius * std::sin(kTurn / corners);
}

/// The cross-section rides on a polygon instead of a circle: each of its wedges sweeps area * R * sin(turn).
double torusVolume(double majorRadius, double minorRadius, Index segments, Index sides) {
  return polygonArea(minorRadius, sides) * majorRadius * segments * std::sin(kTurn / segments);
}

/// Star polygon root, root, tip, tip around the centre, minus the bore with as many corners; sizes as
/// documented for makeGear().
double gearVolume(Index teeth) {
  constexpr double kTip = 1;
  constexpr double kRoot = 0.8;
  constexpr double kBore = 0.3;
  constexpr double kThickness = 0.4;
  const double star = kRoot * kRoot + 2 * kRoot * kTip + kTip * kTip;
  return kThickness * 0.5 * teeth * std::sin(kTurn / (4 * teeth)) * (star - 4 * kBore * kBore);
}

template <class Drop>
TriangleMesh without(TriangleMesh mesh, Drop drop) {
  std::vector<TriangleMesh::Triangle> kept;
  for (const TriangleMesh::Triangle& triangle : mesh.triangles) {
    const Vector3d centroid =
        (mesh.vertices[triangle[0]] + mesh.vertices[triangle[1]] + mesh.vertices[triangle[2]]) / 3;
    if (!drop(centroid)) kept.push_back(triangle);
  }
  mesh.triangles = std::move(kept);
  return mesh;
}

/// Four flat triangles for each. Vertices at edge midpoints are not shared; see welded().
TriangleMesh quartered(const TriangleMesh& mesh) {
  TriangleMesh fine;
  const auto add = [&fine](const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    const auto first = static_cast<Index>(fine.vertices.size());
    fine.vertices.insert(fine.vertices.end(), {a, b, c});
    fine.triangles.push_back({first, first + 1, first + 2});
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vector3d a = mesh.corner(t, 0);
    const Vector3d b = mesh.corner(t, 1);
    const Vector3d c = mesh.corner(t, 2);
    const Vector3d ab = (a + b) / 2;
    const Vector3d bc = (b + c) / 2;
    const Vector3d ca = (c + a) / 2;
    add(a, ab, ca);
    add(b, bc, ab);
    add(c, ca, bc);
    add(ab, bc, ca);
  }
  return fine;
}

/// One vertex per position, the first of equals.
TriangleMesh welded(const TriangleMesh& mesh) {
  TriangleMesh result;
  std::vector<Index> newIndex;
  for (const Vector3d& vertex : mesh.vertices) {
    Index place = 0;  // quadratic, and these meshes are tiny
    while (place < result.vertices.size() && result.vertices[place] != vertex) ++place;
    if (place == result.vertices.size()) result.vertices.push_back(vertex);
    newIndex.push_back(place);
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    result.triangles.push_back({newIndex[a], newIndex[b], newIndex[c]});
  }
  return result;
}

/// One vertex per corner, as STL has it.
TriangleMesh unwelded(const TriangleMesh& mesh) {
  TriangleMesh soup;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto first = static_cast<Index>(soup.vertices.size());
    soup.triangles.push_back({first, first + 1, first + 2});
    for (std::size_t k = 0; k < 3; ++k) soup.vertices.push_back(mesh.corner(t, k));
  }
  return soup;
}

TriangleMesh makeIcosahedron() {
  return makeBall(1, 0);
}
TriangleMesh makeStandardBall() {
  return makeBall(1, 3);
}
TriangleMesh makeCube() {
  return makeBox(Vector3d::Ones());
}
TriangleMesh makeStandardBox() {
  return makeBox(kBoxSize);
}
TriangleMesh makeStandardCylinder() {
  return makeCylinder(0.5, 2, 32);
}
TriangleMesh makeStandardTorus() {
  return makeTorus(1, 0.25, 36, 16);
}
TriangleMesh makeStandardComb() {
  return makeComb(6);
}
TriangleMesh makeStandardGear() {
  return makeGear(12);
}
TriangleMesh makeStandardKnot() {
  return makeKnot(94, 8);
}
TriangleMesh makeSpike() {
  return makeCone(0.01, 1, 16);
}
TriangleMesh makeStandardHollowBall() {
  return makeHollowBall(1, 0.7, 2);
}
TriangleMesh makeStandardTangentBalls() {
  return makeTangentBalls(0.5, 2);
}

TriangleMesh makeTwoBoxes() {
  return joined(moved(makeCube(), {-1, 0, 0}), moved(makeBox(Vector3d::Constant(0.5)), {1, 0, 0}));
}

TriangleMesh makeCrossingBoxes() {
  return joined(makeBox({2, 0.5, 0.5}), makeBox({0.75, 0.625, 2}));
}

TriangleMesh makeOpenBox() {
  return without(welded(quartered(makeStandardBox())),
                 [](const Vector3d& centroid) { return centroid.z() > 0.49 * kBoxSize.z(); });
}

TriangleMesh makeTube() {
  return without(makeStandardCylinder(),
                 [](const Vector3d& centroid) { return centroid.head<2>().norm() < 0.4; });
}

TriangleMesh makeHalfBall() {
  return without(makeStandardBall(), [](const Vector3d& centroid) { return centroid.z() < 0; });
}

TriangleMesh makePuncturedBall() {
  return without(makeStandardBall(), [](const Vector3d& centroid) {
    constexpr double kHole = 0.25;  // wide enough for a few triangles, so that a filling has to invent some
    return (centroid - Vector3d::UnitX()).norm() < kHole || (centroid - Vector3d::UnitY()).norm() < kHole ||
           (centroid + Vector3d::UnitZ()).norm() < kHole;
  });
}

/// One edge is cut in two for one of its faces only; a triangle of area 0 closes the gap.
TriangleMesh makeBoxWithSliver() {
  TriangleMesh mesh = makeCube();
  const auto [a, b, c] = mesh.triangles.front();
  const auto middle = static_cast<Index>(mesh.vertices.size());
  mesh.vertices.emplace_back((mesh.vertices[a] + mesh.vertices[b]) / 2);
  mesh.triangles.front() = {a, middle, c};
  mesh.triangles.push_back({middle, b, c});
  mesh.triangles.push_back({a, b, middle});
  return mesh;
}

TriangleMesh makeBoxWithDuplicate() {
  TriangleMesh mesh = makeStandardBox();
  mesh.triangles.push_back(mesh.triangles.front());
  return mesh;
}

TriangleMesh makeBoxWithFlippedFacet() {
  TriangleMesh mesh = makeStandardBox();
  std::swap(mesh.triangles.front()[1], mesh.triangles.front()[2]);
  return mesh;
}

TriangleMesh makeUnweldedBox() {
  return unwelded(makeStandardBox());
}

std::vector<Model> makeCatalogue() {
  const double icosahedron = 2.0 / 3 * std::sqrt(10 + 2 * std::sqrt(5.0));  // corners at distance 1
  return {
      {"ball",
       Group::Closed,
       makeStandardBall,
       {},
       "one ball of the tree is enough; its medial axis is a point"},
      {"icosahedron", Group::Closed, makeIcosahedron, icosahedron,
       "the coarsest ball; every corner is alike"},
      {"cube", Group::Closed, makeCube, 1.0, "overhang of its ball known by hand; many cospherical points"},
      {"box", Group::Closed, makeStandardBox, kBoxSize.prod(), "three different sides, 12 large triangles"},
      {"cylinder", Group::Closed, makeStandardCylinder, 2 * polygonArea(0.5, 32), "sharp rims, long facets"},
      {"torus", Group::Closed, makeStandardTorus, torusVolume(1, 0.25, 36, 16),
       "genus 1; its medial axis is a circle"},
      {"l_block", Group::Closed, makeLBlock, 3.0, "one reflex edge"},
      {"u_block", Group::Closed, makeUBlock, 5.0, "a gap that a convex bound would fill"},
      {"comb", Group::Closed, makeStandardComb, 29.0, "many gaps in a row, branching medial axis"},
      {"gear", Group::Closed, makeStandardGear, gearVolume(12),
       "machine part: genus 1, small teeth around a large body"},
      {"knot",
       Group::Closed,
       makeStandardKnot,
       {},
       "curved, genus 1, close strands: the demo when there is no bunny"},
      {"slab", Group::Thin, makeSlab, 0.001, "1000 times wider than thick"},
      {"needle", Group::Thin, makeNeedle, 0.001 * 0.001, "1000 times longer than thick"},
      {"spike", Group::Thin, makeSpike, polygonArea(0.01, 16) / 3, "tapers to a point like a horn"},
      {"two_boxes", Group::MultiComponent, makeTwoBoxes, 1.125, "two solids far apart"},
      {"tangent_balls",
       Group::MultiComponent,
       makeStandardTangentBalls,
       {},
       "two solids that share one vertex"},
      {"hollow_ball",
       Group::MultiComponent,
       makeStandardHollowBall,
       {},
       "a cavity: the inner shell faces inwards"},
      {"open_box", Group::Open, makeOpenBox, {}, "a box without lid: one hole with a flat rim"},
      {"tube", Group::Open, makeTube, {}, "a cylinder without caps: two holes"},
      {"half_ball", Group::Open, makeHalfBall, {}, "one large hole with a ragged rim"},
      {"punctured_ball", Group::Open, makePuncturedBall, {}, "three small holes, as scans have them"},
      {"box_sliver", Group::Degenerate, makeBoxWithSliver, 1.0, "a triangle of area 0 closes a split edge"},
      {"box_duplicate", Group::Degenerate, makeBoxWithDuplicate, {}, "one triangle listed twice"},
      {"box_flipped", Group::Degenerate, makeBoxWithFlippedFacet, {}, "one triangle faces inwards"},
      {"box_unwelded", Group::Degenerate, makeUnweldedBox, kBoxSize.prod(),
       "every corner has its own vertex, as in STL"},
      {"crossing_boxes", Group::Degenerate, makeCrossingBoxes, {}, "two shells that cut through each other"},
  };
}

}  // namespace

std::string_view nameOf(Group group) {
  switch (group) {
    case Group::Closed:
      return "closed";
    case Group::Open:
      return "open";
    case Group::Thin:
      return "thin";
    case Group::MultiComponent:
      return "multi_component";
    case Group::Degenerate:
      return "degenerate";
  }
  return {};
}

std::span<const Model> allModels() {
  static const std::vector<Model> models = makeCatalogue();
  return models;
}

}  // namespace spheretree::models
