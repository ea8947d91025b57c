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
/// the unit that the arguments are given in. Resolution arguments count segments.
TriangleMesh makeBall(double radius, std::uint32_t subdivisions);  ///< icosphere, vertices on the ball
TriangleMesh makeBox(const Eigen::Vector3d& size);                 ///< 12 triangles, centred on the origin
TriangleMesh makeCylinder(double radius, double height, std::uint32_t segments);
TriangleMesh makeTorus(double majorRadius, double minorRadius, std::uint32_t segments, std::uint32_t sides);
TriangleMesh makeSlab();                                           ///< 1 x 1 x 0.001
TriangleMesh makeNeedle();                                         ///< 1 x 0.001 x 0.001
TriangleMesh makeLBlock();
TriangleMesh makeUBlock();
TriangleMesh makeHollowBall(double outer, double inner, std::uint32_t subdivisions);
TriangleMesh makeTangentBalls(double radius, std::uint32_t subdivisions);  ///< two, touching in one vertex
TriangleMesh makeComb(std::uint32_t teeth);
TriangleMesh makeGear(std::uint32_t teeth);

/// Which property of a model makes it interesting; tests loop over whole groups.
enum class Group : std::uint8_t { Closed, Open, Thin, MultiComponent, Degenerate };

struct Model {
  std::string_view name;
  Group group = Group::Closed;
  TriangleMesh (*make)() = nullptr;       ///< at its standard size and resolution
  std::optional<double> volume;           ///< of the mesh itself, where a closed form exists
  std::string_view note;                  ///< why it is here
};

/// Every generated model, by name: what `make_models`, the README table and the typed tests read.
[[nodiscard]] std::span<const Model> allModels();

}  // namespace spheretree::models
