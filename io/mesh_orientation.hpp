// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "medial/triangle_mesh.hpp"

namespace spheretree::io {

/// A mesh whose neighbours agree as far as they can.
struct Agreement {
  medial::TriangleMesh mesh;
  std::size_t flipped = 0;  ///< triangles that were turned
  bool orientable = true;   ///< false: some part is one-sided, like a Moebius strip, and cannot agree
};

/// Turns triangles until neighbours over edges with exactly two triangles run along them in opposite
/// directions. In each connected patch the orientation that holds the larger area stays. O(n log n).
[[nodiscard]] Agreement agreeWithNeighbours(medial::TriangleMesh mesh);

/// A mesh whose shells point outwards.
struct Outward {
  medial::TriangleMesh mesh;
  std::size_t turnedShells = 0;
};

/// Turns every shell (a least part that is closed by itself) that is inside out in a mesh that
/// medial::boundsVolume() accepts: one that winds negatively although it does not lie in another shell, where
/// it would be a cavity.
///
/// When the whole mesh has a negative volume it is judged as if turned first, so that cavities stay cavities.
/// Flat shells have no inside and stay as they are.
[[nodiscard]] Outward turnShellsOutwards(medial::TriangleMesh mesh);

/// What tells a solid from a folded sheet.
struct Thickness {
  double volume = 0;
  double area = 0;
  double diagonal = 0;
};

/// True when the volume is zero up to rounding.
[[nodiscard]] bool isFlat(const Thickness& thickness);

/// Shells without an inside, like a sheet with two sides, in a mesh that medial::boundsVolume() accepts.
[[nodiscard]] std::size_t countFlatShells(const medial::TriangleMesh& mesh);

}  // namespace spheretree::io
