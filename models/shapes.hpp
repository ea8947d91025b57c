// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include <Eigen/Core>

#include "medial/triangle_mesh.hpp"

namespace spheretree::models {

using medial::TriangleMesh;

/// Meshes of solids whose volume, area or medial axis is known. All closed and oriented outwards; lengths in
/// the unit that the arguments are given in. Resolution arguments count segments, at least 3.

/// Icosphere of 20 * 4^subdivisions triangles, vertices on the ball. With at least one subdivision the six
/// points on the coordinate axes are vertices, exactly.
TriangleMesh makeBall(double radius, std::uint32_t subdivisions);
TriangleMesh makeBox(const Eigen::Vector3d& size);                                ///< 12 triangles, centred
TriangleMesh makeCylinder(double radius, double height, std::uint32_t segments);  ///< prism along z, centred
TriangleMesh makeCone(double radius, double height,
                      std::uint32_t segments);  ///< apex at z = height, base at 0
TriangleMesh makeTorus(double majorRadius, double minorRadius, std::uint32_t segments, std::uint32_t sides);
TriangleMesh makeSlab();    ///< 1 x 1 x 0.001
TriangleMesh makeNeedle();  ///< 1 x 0.001 x 0.001
TriangleMesh makeLBlock();  ///< 2 x 2 x 1 without one unit cube: volume 3
TriangleMesh makeUBlock();  ///< 3 x 2 x 1 without the unit cube between the arms: volume 5
TriangleMesh makeHollowBall(double outer, double inner, std::uint32_t subdivisions);
/// Two, at x = -radius and x = radius, sharing the vertex at the origin; at least one subdivision.
TriangleMesh makeTangentBalls(double radius, std::uint32_t subdivisions);
/// A bar of 2 teeth - 1 unit cubes with teeth three cubes long: volume 5 teeth - 1.
TriangleMesh makeComb(std::uint32_t teeth);
/// Spur gear of tip radius 1, root radius 0.8, bore radius 0.3, thickness 0.4; straight tooth flanks.
TriangleMesh makeGear(std::uint32_t teeth);
/// Tube of radius 0.35 around a trefoil knot on a torus of radii 2 and 1; segments along it, sides around it.
TriangleMesh makeKnot(std::uint32_t segments, std::uint32_t sides);

/// Which property of a model makes it interesting; tests loop over whole groups.
enum class Group : std::uint8_t {
  Closed,          ///< one closed, oriented manifold
  Open,            ///< with boundary edges
  Thin,            ///< closed, with places a hundred times thinner than the model is long
  MultiComponent,  ///< closed, several shells
  Degenerate       ///< a defect that files have: sliver, duplicate, flipped, unwelded, crossing
};

/// As the README and `make_models --list` write it: closed, open, thin, multi_component, degenerate.
[[nodiscard]] std::string_view nameOf(Group group);

struct Model {
  std::string_view name;
  Group group = Group::Closed;
  TriangleMesh (*make)() = nullptr;  ///< at its standard size and resolution
  std::optional<double> volume;      ///< signed, of the mesh itself, where a closed form exists
  std::string_view note;             ///< why it is here
};

/// Every generated model, by name: what `make_models`, the README table and the typed tests read.
[[nodiscard]] std::span<const Model> allModels();

}  // namespace spheretree::models
