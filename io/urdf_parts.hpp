// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "medial/triangle_mesh.hpp"

namespace spheretree::io {

/// A run of bytes of a text.
struct TextRange {
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// Where the elements called `name` are in a well-formed XML text, in document order, tags included.
/// Comments, CDATA and processing instructions are not looked into.
[[nodiscard]] std::vector<TextRange> elementRanges(std::string_view xml, std::string_view name);

/// The comments in a piece of XML, in order.
[[nodiscard]] std::vector<TextRange> commentRanges(std::string_view xml);

/// A mesh in place of a round body, and how far the two may be from each other.
struct RoundMesh {
  medial::TriangleMesh mesh;
  double standOff = 0;  ///< every point of the body's surface is at most this far from the mesh
};

/// Around the origin, as URDF has them; round ones along z.
[[nodiscard]] medial::TriangleMesh boxMesh(const Eigen::Vector3d& size);
[[nodiscard]] RoundMesh cylinderMesh(double radius, double length);
/// `length` is that of the cylinder between the two half balls.
[[nodiscard]] RoundMesh capsuleMesh(double radius, double length);

}  // namespace spheretree::io
