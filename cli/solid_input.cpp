// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/solid_input.hpp"

#include <utility>

#include "cli/console.hpp"
#include "io/mesh_check.hpp"
#include "io/mesh_import.hpp"
#include "io/report_parts.hpp"

namespace spheretree::cli {
namespace {

constexpr int kDigits = 5;  // of lengths in a remark

Error named(const std::filesystem::path& path, const Error& error) {
  return {error.code, path.string() + ": " + error.message};
}

}  // namespace

Result<SolidInput> readSolid(const std::filesystem::path& mesh, io::Repair rule, Frame frame,
                             const medial::Context& context) {
  context.report("read mesh", 0);
  Result<io::ImportedMesh> imported = io::importMesh(mesh);
  if (!imported) return imported.error();
  context.report("repair mesh", 0);
  Result<io::RepairedMesh> repaired = io::repairMesh(imported->mesh, rule);
  if (!repaired) return named(mesh, repaired.error());

  // Moving the mesh rather than the balls leaves the numbers of the tree as they were written.
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  if (frame == Frame::BoxCentred) shift = medial::boundsOf(imported->mesh).center();
  for (Eigen::Vector3d& vertex : repaired->mesh.vertices) vertex -= shift;

  context.report("check mesh", 0);
  io::Provenance provenance;
  provenance.meshPath = mesh.string();
  provenance.import = std::move(imported->report);
  provenance.check = io::checkMesh(repaired->mesh);
  provenance.repair = repaired->rule;
  provenance.repairActions = std::move(repaired->actions);
  provenance.wrapOffset = repaired->wrapOffset;
  context.report("index mesh", 0);
  Result<medial::Surface> surface = medial::Surface::create(std::move(repaired->mesh));
  if (!surface) return named(mesh, surface.error());
  return SolidInput{std::move(*surface), std::move(provenance), shift};
}

std::string describeMesh(const io::Provenance& provenance) {
  const io::MeshCheck& check = provenance.check;
  std::string line = provenance.meshPath + ": " + counted(check.triangles, "triangle", "triangles") +
                     ", diagonal " + shortNumber(check.bounds.diagonal().norm(), kDigits) + ", repair rule " +
                     io::repairName(provenance.repair);
  if (provenance.repairActions.empty()) return line + ": bounds a solid as it is\n";
  line += ":";
  for (const std::string& action : provenance.repairActions) line += " " + action;
  return line + "\n";
}

std::string shapeWarning(const io::Provenance& provenance) {
  if (provenance.repair != io::Repair::Fill && provenance.repair != io::Repair::Wrap) return {};
  std::string sentence = provenance.meshPath + ": does not bound a solid; the repair rule " +
                         io::repairName(provenance.repair) + " changed its shape:";
  for (const std::string& action : provenance.repairActions) sentence += " " + action;
  return sentence;
}

std::string describeImport(const io::Provenance& provenance) {
  const io::ImportReport& import = provenance.import;
  return provenance.meshPath + ": " + counted(import.meshes, "mesh", "meshes") + ", " +
         counted(import.polygons, "polygon", "polygons") + " (" + std::to_string(import.triangulated) +
         " triangulated), " + counted(import.weldedVertices, "vertex", "vertices") + " welded, " +
         std::to_string(import.degenerateTriangles) + " degenerate and " +
         std::to_string(import.duplicateTriangles) + " duplicate triangles dropped, content hash " +
         import.contentHash;
}

}  // namespace spheretree::cli
