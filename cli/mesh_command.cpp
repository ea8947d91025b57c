// SPDX-License-Identifier: GPL-3.0-or-later
//
// spheretree mesh: inspects a mesh; with an output, repairs, simplifies and writes it.
#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/interrupt.hpp"
#include "cli/options.hpp"
#include "cli/outputs.hpp"
#include "io/mesh_check.hpp"
#include "io/mesh_import.hpp"
#include "io/mesh_repair.hpp"
#include "io/mesh_simplify.hpp"
#include "io/mesh_write.hpp"
#include "io/report_parts.hpp"

namespace spheretree::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kDigits = 6;
constexpr std::size_t kLeastTriangles = 4;  // a tetrahedron

struct MeshOptions {
  std::string input;
  std::string output;  ///< empty: inspect only
  io::Repair repair = io::Repair::Auto;
  bool repairGiven = false;
  std::size_t simplify = 0;  ///< triangles wanted; 0: leave it
  io::Overwrite overwrite = io::Overwrite::Refuse;
  bool json = false;
};

// What io::writeMesh knows; asked before the work instead of after it.
constexpr std::array<std::string_view, 4> kEndings{".obj", ".off", ".ply", ".stl"};

std::string whyNotWritable(const std::string& path) {
  if (std::find(kEndings.begin(), kEndings.end(), endingOf(path)) != kEndings.end()) return {};
  return path + ": a mesh is written as .obj, .off, .ply or .stl";
}

std::string whyTooFew(const std::string& text) {
  std::size_t triangles = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), triangles);
  const bool whole = code == std::errc{} && end == text.data() + text.size();
  if (whole && triangles >= kLeastTriangles) return {};
  return "'" + text + "' is not a whole number of at least " + std::to_string(kLeastTriangles);
}

/// What became of the mesh, when something was asked for.
struct Product {
  medial::TriangleMesh mesh;
  io::Provenance provenance;  ///< facts about the mesh above
  std::size_t beforeSimplifying = 0;
};

struct Inspection {
  io::Provenance provenance;  ///< facts about the mesh as imported
  std::string whyUnsuitable;  ///< empty when it bounds a solid as it is
  std::optional<Product> product;
};

Result<Product> process(const MeshOptions& options, const io::ImportedMesh& imported) {
  Result<io::RepairedMesh> repaired = io::repairMesh(imported.mesh, options.repair);
  if (!repaired) return repaired.error();
  Product product;
  product.mesh = std::move(repaired->mesh);
  product.beforeSimplifying = product.mesh.triangles.size();
  if (options.simplify > 0) {
    Result<medial::TriangleMesh> simplified = io::simplifyMesh(product.mesh, options.simplify);
    if (!simplified) return simplified.error();
    product.mesh = std::move(*simplified);
  }
  product.provenance.meshPath = options.input;
  product.provenance.import = imported.report;
  product.provenance.check = io::checkMesh(product.mesh);
  product.provenance.repair = repaired->rule;
  product.provenance.repairActions = std::move(repaired->actions);
  product.provenance.wrapOffset = repaired->wrapOffset;
  return product;
}

Result<Inspection> inspect(const MeshOptions& options) {
  Result<io::ImportedMesh> imported = io::importMesh(options.input);
  if (!imported) return imported.error();
  Inspection inspection;
  inspection.provenance.meshPath = options.input;
  inspection.provenance.import = imported->report;
  inspection.provenance.check = io::checkMesh(imported->mesh);
  const Result<io::RepairedMesh> asItIs = io::repairMesh(imported->mesh, io::Repair::Off);
  if (!asItIs) inspection.whyUnsuitable = asItIs.error().message;
  if (options.output.empty() && !options.repairGiven) return inspection;
  Result<Product> product = process(options, *imported);
  if (!product) return Error{product.error().code, options.input + ": " + product.error().message};
  inspection.product = std::move(*product);
  return inspection;
}

std::string textOf(const Eigen::Vector3d& v) {
  return "(" + shortNumber(v.x(), kDigits) + ", " + shortNumber(v.y(), kDigits) + ", " +
         shortNumber(v.z(), kDigits) + ")";
}

/// "yes", or "no" and what stands against it.
std::string verdict(bool holds, const std::string& against) {
  return holds ? "yes" : "no: " + against;
}

/// A line of the report, names in one column.
std::string line(const std::string& name, const std::string& value) {
  constexpr std::size_t kNameWidth = 20;
  return "  " + name + std::string(kNameWidth - std::min(kNameWidth, name.size()), ' ') + value + "\n";
}

std::string factsText(const io::MeshCheck& check) {
  const std::string boundary = counted(check.boundaryEdges, "boundary edge", "boundary edges");
  const std::string crowded = counted(check.nonManifoldEdges, "edge", "edges") + " and " +
                              counted(check.nonManifoldVertices, "vertex", "vertices");
  const std::string turned =
      counted(check.misorientedEdges, "edge whose triangles disagree", "edges whose triangles disagree");
  std::string text =
      line("triangles", std::to_string(check.triangles) + ", vertices " + std::to_string(check.vertices) +
                            ", components " + std::to_string(check.components));
  text += line("closed", verdict(check.closed, boundary));
  text += line("manifold", verdict(check.manifold, crowded));
  text += line("oriented", verdict(check.oriented, turned));
  text += line("self-intersections",
               (check.allSelfIntersections ? "" : "at least ") + std::to_string(check.selfIntersections));
  text += line("genus", check.genus ? std::to_string(*check.genus) : "undefined");
  text += line("area", shortNumber(check.area, kDigits));
  text += line("volume", check.closed && check.oriented ? shortNumber(check.volume, kDigits) : "undefined");
  text += line("bounds", textOf(check.bounds.min()) + " to " + textOf(check.bounds.max()) + ", diagonal " +
                             shortNumber(check.bounds.diagonal().norm(), kDigits));
  return text;
}

std::string importText(const io::ImportReport& import) {
  return line("imported", counted(import.meshes, "mesh", "meshes") + ", " +
                              counted(import.polygons, "polygon", "polygons") + ", " +
                              std::to_string(import.triangulated) + " triangulated, " +
                              std::to_string(import.weldedVertices) + " vertices welded, " +
                              std::to_string(import.degenerateTriangles) + " degenerate and " +
                              std::to_string(import.duplicateTriangles) + " duplicate triangles dropped");
}

std::string asText(const MeshOptions& options, const Inspection& inspection) {
  std::string text =
      options.input + "\n" + importText(inspection.provenance.import) +
      factsText(inspection.provenance.check) +
      line("bounds a solid", verdict(inspection.whyUnsuitable.empty(), inspection.whyUnsuitable));
  if (!inspection.product) return text;
  const Product& product = *inspection.product;
  text += options.output.empty() ? "after repair\n" : options.output + "\n";
  text += line("repair rule", io::repairName(product.provenance.repair));
  for (const std::string& action : product.provenance.repairActions) text += line("", action);
  if (options.simplify > 0) {
    text += line("simplified", "from " + std::to_string(product.beforeSimplifying) + " to " +
                                   std::to_string(product.mesh.triangles.size()) + " triangles");
  }
  text += factsText(product.provenance.check);
  if (!options.output.empty()) text += "wrote " + options.output + "\n";
  return text;
}

std::string asJson(const MeshOptions& options, const Inspection& inspection) {
  Json json = {{"tool", Json::parse(io::toolJson())},
               {"mesh", Json::parse(io::meshJson(inspection.provenance))},
               {"bounds_solid", inspection.whyUnsuitable.empty()},
               {"reason", inspection.whyUnsuitable.empty() ? Json(nullptr) : Json(inspection.whyUnsuitable)},
               {"result", nullptr}};
  if (inspection.product) {
    Json result = Json::parse(io::meshJson(inspection.product->provenance));
    result["path"] = options.output.empty() ? Json(nullptr) : Json(options.output);
    result["triangles_before_simplifying"] = inspection.product->beforeSimplifying;
    json["result"] = std::move(result);
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

ExitCode runMesh(const MeshOptions& options) {
  std::vector<fs::path> outputs;
  if (!options.output.empty()) outputs.emplace_back(options.output);
  const std::vector<fs::path> inputs{options.input};
  if (const Result<Done> free = checkOutputs(inputs, outputs, options.overwrite); !free)
    return fail(free.error());
  const Result<Inspection> inspection = inspect(options);
  if (!inspection) return fail(inspection.error());
  if (!options.output.empty()) {
    const HoldInterrupts hold;
    const Result<Done> written =
        io::writeMesh(options.output, inspection.value().product->mesh, options.overwrite);
    if (!written) return fail(written.error());
  }
  print(options.json ? asJson(options, inspection.value()) : asText(options, inspection.value()));
  return ExitCode::Done;
}

}  // namespace

Command setupMesh(CLI::App& program) {
  const auto options = std::make_shared<MeshOptions>();
  CLI::App* app = program.add_subcommand("mesh", "Inspect a mesh; repair, simplify and write it");
  app->add_option("IN", options->input, "Mesh to read")->option_text(" ")->required();
  CLI::Option* output = app->add_option("-o,--output", options->output,
                                        "Mesh to write: .obj, .off, .ply or .stl. Without it "
                                        "nothing is written")
                            ->type_name("OUT")
                            ->check(whyNotWritable);
  CLI::Option* repair = addRepair(*app, options->repair);
  repair->description(
      "What may be done to a mesh that does not bound a solid. Without -o, only to see "
      "whether it would help");
  app->add_option("--simplify", options->simplify, "Collapse edges until at most N triangles remain")
      ->type_name("N, at least " + std::to_string(kLeastTriangles))
      ->check(whyTooFew)
      ->needs(output);
  app->add_flag("--json", options->json, "Print JSON");
  addForce(*app, options->overwrite);
  app->callback([options, repair] { options->repairGiven = repair->count() > 0; });
  app->footer("Example: spheretree mesh scan.ply -o clean.obj --repair wrap --simplify 1500");
  return {app, [options] { return runMesh(*options); }};
}

}  // namespace spheretree::cli
