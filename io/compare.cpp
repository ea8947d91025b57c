// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every builder on one mesh, one after the other, each with all threads.

#include "io/compare.hpp"

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

#include "builders/build_tree.hpp"
#include "builders/catalogue.hpp"
#include "builders/settings_use.hpp"
#include "io/report_parts.hpp"

namespace spheretree::io {
namespace {

using Json = nlohmann::ordered_json;
using builders::BuildReport;
using builders::BuildSettings;

constexpr const char* kKind = "spheretree comparison";
constexpr int kSchema = 1;
constexpr std::string_view kCsvHead =
    "name,builder,quality,state,reason,build_seconds,level,spheres,overhang_worst,overhang_worst_relative,"
    "overhang_mean,overhang_mean_relative,volume_ratio,surface_certified,microseconds_per_close_pair,"
    "sphere_tests_per_close_pair,non_dominated,mesh_hash,tree_hash\n";

/// Of the builder alone, without proofs and measurements.
double buildSeconds(const BuildReport& report) {
  for (const builders::StageTime& stage : report.stages)
    if (stage.stage == "build") return stage.seconds;
  return 0;
}

ComparedRow rowOf(const Contender& contender, const builders::BuildResult& build,
                  const std::vector<PairCost>& costs) {
  ComparedRow row;
  row.contender = contender;
  row.buildSeconds = buildSeconds(build.report);
  row.spheres = build.tree.nodes().size();
  row.treeHash = treeHash(build.tree);
  for (std::size_t k = 0; k < build.report.levels.size(); ++k) {
    ComparedLevel level;
    level.metrics = build.report.levels[k].metrics;
    if (k < costs.size()) level.cost = costs[k];
    row.levels.push_back(std::move(level));
  }
  return row;
}

/// Whether `a` is nowhere worse than `b` and somewhere better.
bool beats(const ComparedRow& a, const ComparedRow& b, std::size_t depth) {
  const builders::LevelMetrics& x = a.levels[depth].metrics;
  const builders::LevelMetrics& y = b.levels[depth].metrics;
  const bool asGood = x.spheres <= y.spheres && x.overhangWorst.upper <= y.overhangWorst.upper &&
                      a.buildSeconds <= b.buildSeconds;
  const bool better = x.spheres < y.spheres || x.overhangWorst.upper < y.overhangWorst.upper ||
                      a.buildSeconds < b.buildSeconds;
  return asGood && better;
}

void markNonDominated(std::vector<ComparedRow>& rows) {
  for (ComparedRow& row : rows) {
    for (std::size_t depth = 0; depth < row.levels.size(); ++depth) {
      row.levels[depth].nonDominated = std::none_of(rows.begin(), rows.end(), [&](const ComparedRow& other) {
        return other.levels.size() > depth && beats(other, row, depth);
      });
    }
  }
}

Json levelOf(std::size_t depth, const ComparedLevel& level, double diagonal) {
  Json json = Json::parse(briefLevelJson(levelJson(depth, level.metrics, diagonal)));
  json["microseconds_per_close_pair"] = level.cost ? Json(level.cost->microseconds) : Json(nullptr);
  json["sphere_tests_per_close_pair"] = level.cost ? Json(level.cost->sphereTests) : Json(nullptr);
  json["non_dominated"] = level.nonDominated;
  return json;
}

Json jsonOf(const ComparedRow& row, double diagonal) {
  const BuildSettings& settings = row.contender.settings;
  const bool done = row.reason.empty();
  Json json = {{"name", row.contender.name},
               {"builder", settings.builder},
               {"quality", builders::refines(settings) ? Json(qualityName(settings.quality)) : Json(nullptr)},
               {"state", done ? "done" : "failed"},
               {"reason", done ? Json(nullptr) : Json(row.reason)},
               {"settings", Json::parse(settingsJson(settings))},
               {"build_seconds", nullptr},
               {"spheres", nullptr},
               {"tree_hash", nullptr},
               {"non_dominated", false},
               {"levels", Json::array()}};
  if (!done) return json;
  json["build_seconds"] = row.buildSeconds;
  json["spheres"] = row.spheres;
  json["tree_hash"] = row.treeHash;
  json["non_dominated"] = row.nonDominated();
  for (std::size_t k = 0; k < row.levels.size(); ++k)
    json["levels"].push_back(levelOf(k, row.levels[k], diagonal));
  return json;
}

/// What all rows have in common.
Json sharedSettings(const BuildSettings& settings) {
  const Json all = Json::parse(settingsJson(settings));
  Json shared;
  for (const char* key : {"branch", "levels", "max_error", "cover", "seed"}) shared[key] = all.at(key);
  return shared;
}

}  // namespace

std::vector<Contender> contendersOf(const CompareOptions& options) {
  std::vector<Contender> contenders;
  for (const builders::CatalogueEntry& entry : builders::catalogue()) {
    const std::string name(entry.name);
    if (std::find(options.builders.begin(), options.builders.end(), name) == options.builders.end()) continue;
    for (const builders::Quality quality : options.qualities) {
      Contender contender{name, options.settings};
      contender.settings.builder = name;
      contender.settings.quality = quality;
      const bool looks = builders::refines(contender.settings);
      if (looks) contender.name += " " + qualityName(quality);
      contenders.push_back(std::move(contender));
      if (!looks) break;
    }
  }
  return contenders;
}

Result<std::vector<ComparedRow>> compareBuilders(const medial::Surface& surface,
                                                 const CompareOptions& options,
                                                 const medial::Context& context) {
  const std::vector<Contender> contenders = contendersOf(options);
  for (const Contender& contender : contenders) {
    if (const std::string reason = builders::whyInvalid(contender.settings); !reason.empty())
      return Error{ErrorCode::InvalidArgument, contender.name + ": " + reason};
  }
  const std::vector<PosePair> poses = closePoses(surface.mesh(), options.poses, options.poseSeed);
  std::vector<ComparedRow> rows;
  for (const Contender& contender : contenders) {
    const Result<builders::BuildResult> build = builders::buildTree(surface, contender.settings, context);
    if (build) {
      rows.push_back(rowOf(contender, *build, pairCosts(build->tree, poses)));
      continue;
    }
    if (build.error().code == ErrorCode::Cancelled) return build.error();
    ComparedRow row;
    row.contender = contender;
    row.reason = build.error().message;
    rows.push_back(std::move(row));
  }
  markNonDominated(rows);
  return rows;
}

std::string formatComparison(const std::vector<ComparedRow>& rows, const CompareOptions& options,
                             const Provenance& provenance, unsigned threads) {
  const double diagonal = provenance.check.bounds.diagonal().norm();
  Json list = Json::array();
  for (const ComparedRow& row : rows) list.push_back(jsonOf(row, diagonal));
  const Json json = {{"kind", kKind},
                     {"schema", kSchema},
                     {"tool", Json::parse(toolJson())},
                     {"mesh", Json::parse(meshJson(provenance))},
                     {"settings", sharedSettings(options.settings)},
                     {"threads", threads},
                     {"poses", {{"count", options.poses}, {"seed", options.poseSeed}}},
                     {"rows", std::move(list)}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string comparisonCsv(std::string_view comparisonJson) {
  const Json json = Json::parse(comparisonJson);
  std::string text(kCsvHead);
  for (const Json& row : json.at("rows")) {
    const auto cell = [](const Json& value) { return csvCell(value.dump()); };
    std::string head;
    for (const char* key : {"name", "builder", "quality", "state", "reason", "build_seconds"})
      head += cell(row.at(key)) + ",";
    const std::string tail =
        "," + cell(json.at("mesh").at("content_hash")) + "," + cell(row.at("tree_hash")) + "\n";
    if (row.at("levels").empty()) text += head + ",,,,,,,,,," + tail;
    for (const Json& level : row.at("levels")) {
      std::string cells;
      for (const char* key : {"level", "spheres", "overhang_worst", "overhang_worst_relative",
                              "overhang_mean", "overhang_mean_relative", "volume_ratio", "surface_certified",
                              "microseconds_per_close_pair", "sphere_tests_per_close_pair", "non_dominated"})
        cells += (cells.empty() ? "" : ",") + cell(level.at(key));
      text += head + cells + tail;
    }
  }
  return text;
}

}  // namespace spheretree::io
