// SPDX-License-Identifier: GPL-3.0-or-later
//
// The repair rules, gentlest first. Each one either yields a mesh that bounds a solid or says what stands in
// its way and which rule to try; `Auto` is nothing but that order.

#include "io/mesh_repair.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <utility>

#include "io/guarded.hpp"
#include "io/mesh_closing.hpp"
#include "io/mesh_orientation.hpp"
#include "io/mesh_topology.hpp"
#include "io/soup_cleaning.hpp"

namespace spheretree::io {
namespace {

std::string counted(std::size_t count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::string shortNumber(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

Error unsuitable(const std::string& why) {
  return {ErrorCode::UnsuitableMesh, why};
}

std::optional<Error> impossible(const medial::TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return unsuitable("the mesh has no triangle");
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      if (corner >= mesh.vertices.size()) return unsuitable("a triangle uses a vertex that is not there");
      if (!mesh.vertices[corner].allFinite())
        return unsuitable("a vertex has a coordinate that is not a finite number");
    }
  }
  if (const std::string reason = medial::whyNotMeasurable(mesh); !reason.empty()) return unsuitable(reason);
  return std::nullopt;
}

bool enclosesNothing(const medial::TriangleMesh& mesh) {
  return isFlat({medial::signedVolumeOf(mesh), medial::areaOf(mesh), medial::diagonalOf(mesh)});
}

/// Why a mesh that is not balanced does not bound a solid.
std::string openness(const medial::TriangleMesh& mesh) {
  const Topology topology = topologyOf(mesh);
  std::string text;
  const auto add = [&](std::size_t count, const std::string& one, const std::string& many) {
    if (count > 0) text += (text.empty() ? "" : ", ") + counted(count, one, many);
  };
  add(topology.boundaryEdges, "boundary edge", "boundary edges");
  add(topology.misorientedEdges, "edge with two triangles that disagree",
      "edges with two triangles that disagree");
  add(topology.nonManifoldEdges, "edge with more than two triangles", "edges with more than two triangles");
  return (topology.boundaryEdges > 0 ? "the mesh is open: " : "the mesh does not bound a solid: ") + text;
}

Result<RepairedMesh> accept(const medial::TriangleMesh& mesh) {
  if (!medial::boundsVolume(mesh)) {
    const bool open = topologyOf(mesh).boundaryEdges > 0;
    return unsuitable(openness(mesh) + "; repair rule " + (open ? "fill or wrap" : "orient or wrap") +
                      " may help");
  }
  const std::size_t insideOut = turnShellsOutwards(mesh).turnedShells;
  if (insideOut > 0) {
    return unsuitable(counted(insideOut, "shell of the mesh is", "shells of the mesh are") +
                      " inside out; repair rule orient helps");
  }
  if (enclosesNothing(mesh))
    return unsuitable("the mesh is closed but encloses no volume; repair rule wrap helps");
  RepairedMesh repaired;
  repaired.mesh = mesh;
  return repaired;
}

/// Welded, without triangles that have no area.
RepairedMesh tidied(const medial::TriangleMesh& mesh, Repair rule) {
  RepairedMesh repaired;
  repaired.rule = rule;
  repaired.mesh = mesh;
  const std::size_t before = topologyOf(repaired.mesh).vertices;
  repaired.mesh = weldVertices(std::move(repaired.mesh));
  const std::size_t welded = before - repaired.mesh.vertices.size();
  const std::size_t dropped = removeDegenerate(repaired.mesh);
  if (welded > 0)
    repaired.actions.push_back("Welded " + counted(welded, "vertex", "vertices") +
                               " to others at the same position.");
  if (dropped > 0)
    repaired.actions.push_back("Dropped " + counted(dropped, "triangle", "triangles") + " without area.");
  return repaired;
}

/// Tidied, and neighbours agree.
Result<RepairedMesh> agreed(const medial::TriangleMesh& mesh, Repair rule) {
  RepairedMesh repaired = tidied(mesh, rule);
  Agreement agreement = agreeWithNeighbours(std::move(repaired.mesh));
  if (!agreement.orientable)
    return unsuitable("the mesh has a one-sided part that cannot be oriented; repair rule wrap helps");
  repaired.mesh = std::move(agreement.mesh);
  if (agreement.flipped > 0) {
    repaired.actions.push_back("Turned " + counted(agreement.flipped, "triangle", "triangles") +
                               " to agree with the neighbours.");
  }
  return repaired;
}

/// The last step of orient and fill, on a balanced mesh.
Result<RepairedMesh> pointedOutwards(RepairedMesh repaired) {
  Outward outward = turnShellsOutwards(std::move(repaired.mesh));
  repaired.mesh = std::move(outward.mesh);
  if (outward.turnedShells > 0)
    repaired.actions.push_back("Turned " + counted(outward.turnedShells, "shell", "shells") + " outwards.");
  if (enclosesNothing(repaired.mesh))
    return unsuitable("the mesh encloses no volume once it is closed; repair rule wrap helps");
  return repaired;
}

Result<RepairedMesh> orient(const medial::TriangleMesh& mesh) {
  Result<RepairedMesh> repaired = agreed(mesh, Repair::Orient);
  if (!repaired) return repaired;
  if (!medial::boundsVolume(repaired->mesh))
    return unsuitable(openness(repaired->mesh) + "; repair rule fill or wrap may help");
  return pointedOutwards(std::move(*repaired));
}

Result<RepairedMesh> fill(const medial::TriangleMesh& mesh) {
  Result<RepairedMesh> repaired = agreed(mesh, Repair::Fill);
  if (!repaired) return repaired;
  if (medial::boundsVolume(repaired->mesh)) return pointedOutwards(std::move(*repaired));
  const std::size_t crowded = topologyOf(repaired->mesh).nonManifoldEdges;
  if (crowded > 0) {
    return unsuitable(
        "the mesh has " + counted(crowded, "edge", "edges") +
        " with more than two triangles, where it is unclear what a hole is; repair rule wrap helps");
  }
  FilledMesh filled = fillHoles(repaired->mesh);
  if (filled.openHoles > 0 || !medial::boundsVolume(filled.mesh)) {
    return unsuitable(counted(filled.openHoles, "hole of the mesh", "holes of the mesh") +
                      " cannot be filled; repair rule wrap helps");
  }
  repaired->mesh = std::move(filled.mesh);
  repaired->filledHoles = filled.holes;
  repaired->actions.push_back("Filled " + counted(filled.holes, "hole", "holes") + " with " +
                              counted(filled.newTriangles, "triangle", "triangles") + ".");
  const std::size_t flat = countFlatShells(repaired->mesh);
  if (flat > 0) {
    return unsuitable(counted(flat, "part of the mesh is a flat sheet", "parts of the mesh are flat sheets") +
                      " and would get no thickness by filling; repair rule wrap helps");
  }
  return pointedOutwards(std::move(*repaired));
}

Result<RepairedMesh> wrap(const medial::TriangleMesh& mesh) {
  RepairedMesh repaired = tidied(mesh, Repair::Wrap);
  if (repaired.mesh.triangles.empty()) return unsuitable("no triangle of the mesh has an area");
  const double diagonal = medial::diagonalOf(repaired.mesh);
  WrappedMesh wrapped = wrapMesh(repaired.mesh);
  if (wrapped.mesh.triangles.empty() || !medial::boundsVolume(wrapped.mesh) || enclosesNothing(wrapped.mesh))
    return unsuitable("the mesh cannot be wrapped");
  repaired.actions.push_back("Replaced the surface by a wrap of " +
                             std::to_string(wrapped.mesh.triangles.size()) +
                             " triangles that contains it: openings below " + shortNumber(wrapped.alpha) +
                             " are closed, the distance kept is " + shortNumber(wrapped.offset) +
                             ", the farthest point is " + shortNumber(wrapped.standOff) + " away (" +
                             shortNumber(100 * wrapped.standOff / diagonal) + " % of the diagonal).");
  repaired.mesh = std::move(wrapped.mesh);
  repaired.wrapOffset = wrapped.standOff;
  return repaired;
}

Result<RepairedMesh> applyRule(const medial::TriangleMesh& mesh, Repair rule) {
  switch (rule) {
    case Repair::Off:
      return accept(mesh);
    case Repair::Orient:
      return orient(mesh);
    case Repair::Fill:
      return fill(mesh);
    case Repair::Wrap:
      return wrap(mesh);
    case Repair::Auto:
      break;
  }
  for (const Repair gentle : {Repair::Off, Repair::Orient, Repair::Fill}) {
    Result<RepairedMesh> repaired = applyRule(mesh, gentle);
    if (repaired) return repaired;
  }
  return wrap(mesh);
}

}  // namespace

Result<RepairedMesh> repairMesh(const medial::TriangleMesh& mesh, Repair rule) {
  return guarded(ErrorCode::UnsuitableMesh, "the mesh cannot be repaired", [&]() -> Result<RepairedMesh> {
    if (const std::optional<Error> error = impossible(mesh)) return *error;
    return applyRule(mesh, rule);
  });
}

}  // namespace spheretree::io
