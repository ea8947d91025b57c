// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <spheretree/result.hpp>

#include "medial/triangle_mesh.hpp"

namespace spheretree::io {

/// What may be done to a mesh that does not bound a solid.
enum class Repair : std::uint8_t {
  Off,     ///< refuse it by name
  Orient,  ///< make orientations agree and point outwards; refuse it if it is still not closed
  Fill,    ///< as Orient, then triangulate the holes; refuse it if that does not close it
  Wrap,    ///< replace it by an alpha wrap that strictly contains it (Portaneri et al. 2022): always
           ///< conservative
  Auto  ///< the first of off, orient, fill, wrap that gives a closed, oriented mesh without losing anything
};

struct RepairedMesh {
  medial::TriangleMesh mesh;
  Repair rule = Repair::Off;         ///< what was used in the end; Off: the mesh is the input, untouched
  std::vector<std::string> actions;  ///< one sentence per thing that was done, none for Off
  std::size_t filledHoles = 0;
  double wrapOffset =
      0;  ///< how far a wrap may stand off the input, mesh units; part of the reported overhang
};

/// Makes the mesh a closed, consistently outward-oriented one by the stated rule, or refuses with
/// UnsuitableMesh and a sentence that names what is wrong and which rule would help.
///
/// Self-intersections are allowed: a solid is where the surface winds around at least once.
Result<RepairedMesh> repairMesh(const medial::TriangleMesh& mesh, Repair rule);

}  // namespace spheretree::io
