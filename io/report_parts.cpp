// SPDX-License-Identifier: GPL-3.0-or-later
//
// The pieces that reports have in common (docs/reports.md).

#include "io/report_parts.hpp"

#include <array>
#include <charconv>
#include <initializer_list>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include <spheretree/version.hpp>

namespace spheretree::io {
namespace {

using Json = nlohmann::ordered_json;
using builders::Bounds;
using builders::LevelMetrics;

constexpr std::string_view kCsvHeader =
    "level,spheres,overhang_worst_lower,overhang_worst_upper,overhang_mean,overhang_worst_lower_relative,"
    "overhang_worst_upper_relative,overhang_mean_relative,volume_ratio,surface_certified,uncovered_lower,"
    "uncovered_upper,solid_certified,solid_uncovered_lower,solid_uncovered_upper,mesh_hash,tree_hash,"
    "winners\n";

/// A path may hold any bytes; those that are not UTF-8 are replaced.
std::string textOf(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

double diagonalOf(const Provenance& provenance) {
  return provenance.check.bounds.diagonal().norm();
}

Json bracket(const Bounds& bounds, double unit = 1) {
  return {{"lower", bounds.lower / unit}, {"upper", bounds.upper / unit}};
}

Json effortOf(bool certified, const builders::ProofEffort& effort) {
  return {{"certified", certified}, {"cells", effort.cells}, {"deepest_subdivision", effort.deepest}};
}

Json vectorOf(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

}  // namespace

std::string toolJson() {
  return textOf(
      {{"name", "spheretree"}, {"version", SPHERETREE_VERSION}, {"git_revision", SPHERETREE_GIT_REVISION}});
}

std::string meshJson(const Provenance& provenance) {
  const MeshCheck& check = provenance.check;
  const ImportReport& import = provenance.import;
  const double diagonal = diagonalOf(provenance);
  return textOf(
      {{"path", provenance.meshPath},
       {"content_hash", import.contentHash},
       {"triangles", check.triangles},
       {"vertices", check.vertices},
       {"components", check.components},
       {"closed", check.closed},
       {"manifold", check.manifold},
       {"oriented", check.oriented},
       {"boundary_edges", check.boundaryEdges},
       {"non_manifold_edges", check.nonManifoldEdges},
       {"misoriented_edges", check.misorientedEdges},
       {"non_manifold_vertices", check.nonManifoldVertices},
       {"self_intersections", check.selfIntersections},
       {"self_intersections_complete", check.allSelfIntersections},
       {"genus", check.genus ? Json(*check.genus) : Json(nullptr)},
       {"area", check.area},
       {"volume", check.volume},
       {"bounds", {{"min", vectorOf(check.bounds.min())}, {"max", vectorOf(check.bounds.max())}}},
       {"diagonal", diagonal},
       {"units", "mesh units"},
       {"import",
        {{"meshes", import.meshes},
         {"polygons", import.polygons},
         {"triangulated", import.triangulated},
         {"welded_vertices", import.weldedVertices},
         {"degenerate_triangles", import.degenerateTriangles},
         {"duplicate_triangles", import.duplicateTriangles}}},
       {"repair",
        {{"rule", repairName(provenance.repair)},
         {"actions", provenance.repairActions},
         {"wrap_stand_off", provenance.wrapOffset},
         {"wrap_stand_off_relative", provenance.wrapOffset > 0 ? provenance.wrapOffset / diagonal : 0.0}}}});
}

std::string levelJson(std::size_t level, const LevelMetrics& metrics, double diagonal) {
  Json surface = effortOf(metrics.surface.certified, metrics.surface.effort);
  surface["uncovered"] = bracket(metrics.surface.uncovered);
  surface["distance"] = bracket(metrics.surface.distance);
  surface["distance_relative"] = bracket(metrics.surface.distance, diagonal);
  Json solid = effortOf(metrics.solid.certified, metrics.solid.effort);
  solid["uncovered"] = bracket(metrics.solid.uncovered);
  return textOf({{"level", level},
                 {"spheres", metrics.spheres},
                 {"overhang_worst", bracket(metrics.overhangWorst)},
                 {"overhang_worst_relative", bracket(metrics.overhangWorst, diagonal)},
                 {"overhang_mean", metrics.overhangMean},
                 {"overhang_mean_relative", metrics.overhangMean / diagonal},
                 {"worst_sphere", metrics.worstBall},
                 {"volume", metrics.volume},
                 {"volume_ratio", metrics.volumeRatio},
                 {"surface_cover", std::move(surface)},
                 {"solid_cover", std::move(solid)}});
}

std::string withoutClock(const std::string& reportJson) {
  Json report = Json::parse(reportJson);
  for (const char* key : {"threads", "stages", "peak_memory_bytes"}) report.erase(key);
  return textOf(report);
}

std::string briefLevelJson(const std::string& levelJson) {
  const Json level = Json::parse(levelJson);
  return textOf({{"level", level.at("level")},
                 {"spheres", level.at("spheres")},
                 {"overhang_worst", level.at("overhang_worst").at("upper")},
                 {"overhang_worst_relative", level.at("overhang_worst_relative").at("upper")},
                 {"overhang_mean", level.at("overhang_mean")},
                 {"overhang_mean_relative", level.at("overhang_mean_relative")},
                 {"volume_ratio", level.at("volume_ratio")},
                 {"surface_certified", level.at("surface_cover").at("certified")},
                 {"solid_certified", level.at("solid_cover").at("certified")}});
}

std::string chainJson(const builders::ChainProof& proof) {
  return textOf(effortOf(proof.certified, proof.effort));
}

std::string repairName(Repair rule) {
  switch (rule) {
    case Repair::Off:
      return "off";
    case Repair::Orient:
      return "orient";
    case Repair::Fill:
      return "fill";
    case Repair::Wrap:
      return "wrap";
    case Repair::Auto:
      return "auto";
  }
  return "off";
}

std::string qualityName(builders::Quality quality) {
  switch (quality) {
    case builders::Quality::Fast:
      return "fast";
    case builders::Quality::Best:
      return "best";
    case builders::Quality::Normal:
      break;
  }
  return "normal";
}

std::string objectiveName(builders::Objective objective) {
  switch (objective) {
    case builders::Objective::Mean:
      return "mean";
    case builders::Objective::Volume:
      return "volume";
    case builders::Objective::Worst:
      break;
  }
  return "worst";
}

std::string exactNumber(double value) {
  std::array<char, 32> digits{};
  const auto [end, code] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  static_cast<void>(code);
  return {digits.data(), end};
}

std::string csvCell(const std::string& jsonValue) {
  const Json value = Json::parse(jsonValue);
  if (value.is_null()) return {};
  if (value.is_number_float()) return exactNumber(value.get<double>());
  if (!value.is_string()) return value.dump();
  const auto text = value.get<std::string>();
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char letter : text) quoted += letter == '"' ? "\"\"" : std::string(1, letter);
  return quoted + "\"";
}

std::string readableNumber(double value) {
  constexpr int kDigits = 6;
  std::array<char, 32> digits{};
  const auto [end, code] =
      std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::general, kDigits);
  static_cast<void>(code);
  return {digits.data(), end};
}

std::string levelCsvHeader() {
  return std::string(kCsvHeader);
}

std::string levelCsvRow(std::size_t level, const LevelMetrics& metrics, const Provenance& provenance,
                        const std::string& treeHash, const Winners& winners) {
  const double diagonal = diagonalOf(provenance);
  std::string row = std::to_string(level) + "," + std::to_string(metrics.spheres);
  const auto add = [&row](const std::string& cell) { row += "," + cell; };
  const std::initializer_list<double> lengths = {metrics.overhangWorst.lower, metrics.overhangWorst.upper,
                                                 metrics.overhangMean};
  for (const double length : lengths) add(exactNumber(length));
  for (const double length : lengths) add(exactNumber(length / diagonal));
  add(exactNumber(metrics.volumeRatio));
  add(metrics.surface.certified ? "1" : "0");
  add(exactNumber(metrics.surface.uncovered.lower));
  add(exactNumber(metrics.surface.uncovered.upper));
  add(metrics.solid.certified ? "1" : "0");
  add(exactNumber(metrics.solid.uncovered.lower));
  add(exactNumber(metrics.solid.uncovered.upper));
  add(provenance.import.contentHash);
  add(treeHash);
  std::string won;
  for (const auto& [name, sets] : winners)
    won += (won.empty() ? "" : " ") + name + "=" + std::to_string(sets);
  add(won);
  return row + "\n";
}

}  // namespace spheretree::io
