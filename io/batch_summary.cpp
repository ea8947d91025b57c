// SPDX-License-Identifier: GPL-3.0-or-later
//
// The records say what there is to say about the assets, so a summary is put together from them, whether they
// are from this run or from an earlier one. What a clock or the machine decides stands in `run` alone.

#include "io/batch_summary.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

#include "io/files.hpp"
#include "io/html_pages.hpp"
#include "io/report_parts.hpp"
#include "io/scene_budget.hpp"

namespace spheretree::io {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kKind = "spheretree batch summary";
constexpr int kSchema = 1;
constexpr std::string_view kCsvHead =
    "input,output,state,trouble,reason,triangles,repair,levels,spheres,tree_bytes,worst_relative,mean_"
    "relative,"
    "volume_ratio,level_spheres,level_worst_relative,mesh_hash,tree_hash,tree_file_hash,memory_estimate_"
    "bytes,"
    "action,seconds,peak_memory_bytes,threads";

Json number(std::uint64_t value) {
  return value;
}

Json textOrNull(const std::string& text) {
  return text.empty() ? Json(nullptr) : Json(text);
}

// --- assets ---

/// What the record of a tree says about it.
void addBuild(const Json& record, Json& asset) {
  const Json& mesh = record.at("mesh");
  asset["mesh"] = {{"content_hash", mesh.at("content_hash")},
                   {"triangles", mesh.at("triangles")},
                   {"diagonal", mesh.at("diagonal")},
                   {"repair", mesh.at("repair").at("rule")},
                   {"closed", mesh.at("closed")}};
  const Json& tree = record.at("tree");
  asset["tree"] = {{"content_hash", tree.at("content_hash")},
                   {"file_hash", tree.at("file_hash")},
                   {"bytes", tree.at("bytes")},
                   {"levels", tree.at("levels")},
                   {"spheres", tree.at("spheres")}};
  for (const Json& level : record.at("levels"))
    asset["levels"].push_back(Json::parse(briefLevelJson(level.dump())));
}

Json assetJson(const BatchAsset& asset, const AssetOutcome& outcome, Pages pages) {
  const AssetRecord& record = outcome.record;
  const bool built = record.state == AssetState::Done || record.state == AssetState::Missed;
  const bool untried = record.state == AssetState::Pending;
  Json json = {
      {"input", asset.input.generic_string()},
      {"output", asset.output},
      {"record", asset.record()},
      {"page", built && pages == Pages::With ? Json(asset.page()) : Json(nullptr)},
      {"state", stateName(record.state)},
      {"trouble", record.trouble == Trouble::None ? Json(nullptr) : Json(troubleName(record.trouble))},
      {"reason",
       untried ? Json("another asset failed before, and --fail-fast was given") : textOrNull(record.reason)},
      {"mesh", nullptr},
      {"settings", Json::parse(settingsJson(asset.settings))},
      {"tree", nullptr},
      {"levels", Json::array()},
      {"memory_estimate_bytes", outcome.memoryEstimate > 0 ? number(outcome.memoryEstimate) : Json(nullptr)}};
  if (!built) return json;
  const Json whole = Json::parse(record.json);
  json["settings"] = whole.at("settings");
  addBuild(whole, json);
  return json;
}

std::string actionName(AssetAction action) {
  switch (action) {
    case AssetAction::Built:
      return "built";
    case AssetAction::Skipped:
      return "skipped";
    case AssetAction::None:
      break;
  }
  return "none";
}

Json costJson(const BatchAsset& asset, const AssetOutcome& outcome) {
  Json json = {{"output", asset.output}, {"action", actionName(outcome.action)}};
  json["seconds"] = outcome.cost ? Json(outcome.cost->seconds) : Json(nullptr);
  json["peak_memory_bytes"] = outcome.cost ? Json(outcome.cost->peakMemoryBytes) : Json(nullptr);
  json["threads"] = outcome.cost ? Json(outcome.cost->threads) : Json(nullptr);
  return json;
}

// --- totals ---

std::uint64_t sumOf(const Json& assets, const char* part, const char* key) {
  std::uint64_t sum = 0;
  for (const Json& asset : assets)
    if (!asset.at(part).is_null()) sum += asset.at(part).at(key).get<std::uint64_t>();
  return sum;
}

std::size_t countOf(const Json& assets, AssetState state) {
  const std::string name = stateName(state);
  return static_cast<std::size_t>(std::count_if(
      assets.begin(), assets.end(), [&name](const Json& asset) { return asset.at("state") == name; }));
}

Json totalsJson(const Json& assets) {
  return {{"assets", assets.size()},
          {"done", countOf(assets, AssetState::Done)},
          {"missed", countOf(assets, AssetState::Missed)},
          {"failed", countOf(assets, AssetState::Failed)},
          {"pending", countOf(assets, AssetState::Pending)},
          {"triangles", sumOf(assets, "mesh", "triangles")},
          {"spheres", sumOf(assets, "tree", "spheres")},
          {"bytes", sumOf(assets, "tree", "bytes")}};
}

// --- scene ---

void addBudget(const TreeBudget& budget, const std::string& prefix, Json& json) {
  json[prefix + "levels"] = budget.levels;
  json[prefix + "spheres"] = budget.spheres;
  json[prefix + "file_bytes"] = budget.fileBytes;
  json[prefix + "runtime_bytes"] = budget.runtimeBytes;
  json[prefix + "sphere_tests"] = budget.sphereTests;
}

Json useJson(const BatchAsset& asset, const fs::path& tree) {
  Json json = {{"output", asset.output},
               {"instances", asset.use->count},
               {"largest_scale", asset.use->largestScale},
               {"tolerance", asset.tolerance > 0 ? Json(asset.tolerance) : Json(nullptr)}};
  const Result<TreeBudget> budget = budgetOf(tree);
  if (!budget) return json;
  addBudget(*budget, "", json);
  addBudget(fullBudget(asset.fullLevels, asset.settings.branch), "full_", json);
  return json;
}

/// Sums over the trees, which are shared; means over the instances, which meet each other.
Json sceneTotals(const Json& assets) {
  Json totals;
  std::uint64_t instances = 0;
  for (const Json& asset : assets)
    if (asset.contains("levels")) instances += asset.at("instances").get<std::uint64_t>();
  totals["instances"] = instances;
  for (const std::string prefix : {"", "full_"}) {
    for (const std::string key : {"file_bytes", "runtime_bytes"}) {
      std::uint64_t sum = 0;
      for (const Json& asset : assets)
        if (asset.contains("levels")) sum += asset.at(prefix + key).get<std::uint64_t>();
      totals[prefix + key] = sum;
    }
    double tests = 0;
    for (const Json& asset : assets) {
      if (asset.contains("levels"))
        tests += asset.at("instances").get<double>() * asset.at(prefix + "sphere_tests").get<double>();
    }
    totals[prefix + "sphere_tests"] = instances > 0 ? tests / static_cast<double>(instances) : 0.0;
  }
  return totals;
}

Json sceneOf(Json uses) {
  if (uses.empty()) return nullptr;
  Json totals = sceneTotals(uses);
  return {{"assets", std::move(uses)}, {"totals", std::move(totals)}};
}

/// Names of files may hold any bytes; those that are not UTF-8 are replaced.
std::string textOf(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

// --- CSV ---

std::string cellText(const Json& value) {
  return csvCell(value.dump());
}

std::string partOf(const Json& asset, const char* part, const char* key) {
  return asset.at(part).is_null() ? std::string() : cellText(asset.at(part).at(key));
}

/// One figure of all levels, with blanks between.
std::string ofLevels(const Json& levels, const char* key) {
  std::string text;
  for (const Json& level : levels) text += (text.empty() ? "" : " ") + cellText(level.at(key));
  return text;
}

std::string ofLast(const Json& levels, const char* key) {
  return levels.empty() ? std::string() : cellText(levels.back().at(key));
}

std::string csvRow(const Json& asset, const Json& cost) {
  const Json& levels = asset.at("levels");
  const std::vector<std::string> cells = {cellText(asset.at("input")),
                                          cellText(asset.at("output")),
                                          cellText(asset.at("state")),
                                          cellText(asset.at("trouble")),
                                          cellText(asset.at("reason")),
                                          partOf(asset, "mesh", "triangles"),
                                          partOf(asset, "mesh", "repair"),
                                          partOf(asset, "tree", "levels"),
                                          partOf(asset, "tree", "spheres"),
                                          partOf(asset, "tree", "bytes"),
                                          ofLast(levels, "overhang_worst_relative"),
                                          ofLast(levels, "overhang_mean_relative"),
                                          ofLast(levels, "volume_ratio"),
                                          ofLevels(levels, "spheres"),
                                          ofLevels(levels, "overhang_worst_relative"),
                                          partOf(asset, "mesh", "content_hash"),
                                          partOf(asset, "tree", "content_hash"),
                                          partOf(asset, "tree", "file_hash"),
                                          cellText(asset.at("memory_estimate_bytes")),
                                          cellText(cost.at("action")),
                                          cellText(cost.at("seconds")),
                                          cellText(cost.at("peak_memory_bytes")),
                                          cellText(cost.at("threads"))};
  std::string row;
  for (const std::string& cell : cells) row += (row.empty() ? "" : ",") + cell;
  return row + "\n";
}

// --- merging ---

/// Ends the merging.
struct Mismatch : std::runtime_error {
  using std::runtime_error::runtime_error;
};

Json readSummary(const fs::path& path) {
  const Result<std::string> text = readFile(path);
  if (!text) throw std::invalid_argument(text.error().message);
  Json json = Json::parse(*text, nullptr, false);
  if (!json.is_object() || json.value("kind", "") != kKind || json.value("schema", 0) != kSchema)
    throw Mismatch(path.string() + ": is no summary of a batch");
  return json;
}

void checkShards(const std::vector<Json>& parts, const std::vector<fs::path>& paths) {
  std::set<std::uint64_t> seen;
  const Json& first = parts.front();
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const Json& part = parts[k];
    const std::string name = paths[k].string() + ": ";
    if (part.at("tool") != first.at("tool"))
      throw Mismatch(name + "was written by another version than " + paths[0].string());
    if (part.at("settings") != first.at("settings"))
      throw Mismatch(name + "has other settings than " + paths[0].string());
    if (part.at("shard").is_null() != first.at("shard").is_null() ||
        (!part.at("shard").is_null() && part.at("shard").at("count") != first.at("shard").at("count")))
      throw Mismatch(name + "is a shard of another count than " + paths[0].string());
    if (part.at("shard").is_null()) continue;
    const auto index = part.at("shard").at("index").get<std::uint64_t>();
    if (!seen.insert(index).second)
      throw Mismatch(name + "shard " + std::to_string(index) + " is there twice");
  }
  if (first.at("shard").is_null()) return;
  const auto count = first.at("shard").at("count").get<std::uint64_t>();
  for (std::uint64_t index = 1; index <= count; ++index) {
    if (seen.count(index) == 0)
      throw Mismatch("shard " + std::to_string(index) + " of " + std::to_string(count) + " is missing");
  }
}

/// The entries of all parts, sorted by output. Each is there once.
Json joined(const std::vector<Json>& parts, const std::function<const Json*(const Json&)>& list) {
  std::map<std::string, Json> sorted;
  for (const Json& part : parts) {
    const Json* entries = list(part);
    if (entries == nullptr) continue;
    for (const Json& entry : *entries) {
      const auto output = entry.at("output").get<std::string>();
      if (!sorted.emplace(output, entry).second) throw Mismatch(output + ": is in two of the summaries");
    }
  }
  Json all = Json::array();
  for (auto& [output, entry] : sorted) all.push_back(std::move(entry));
  return all;
}

Json mergedRuns(const std::vector<Json>& parts) {
  Json run = {
      {"seconds", 0.0}, {"jobs", 0}, {"threads", 0}, {"memory_limit_bytes", 0}, {"peak_memory_bytes", 0}};
  for (const Json& part : parts) {
    for (const char* key : {"jobs", "threads", "memory_limit_bytes", "peak_memory_bytes"})
      run[key] = std::max(run[key].get<std::uint64_t>(), part.at("run").at(key).get<std::uint64_t>());
    run["seconds"] = std::max(run["seconds"].get<double>(), part.at("run").at("seconds").get<double>());
  }
  run["assets"] = joined(parts, [](const Json& part) { return &part.at("run").at("assets"); });
  return run;
}

Json merged(const std::vector<Json>& parts) {
  Json assets = joined(parts, [](const Json& part) { return &part.at("assets"); });
  Json uses = joined(parts, [](const Json& part) {
    return part.at("scene").is_null() ? nullptr : &part.at("scene").at("assets");
  });
  Json json = {{"kind", kKind},
               {"schema", kSchema},
               {"tool", parts.front().at("tool")},
               {"shard", nullptr},
               {"settings", parts.front().at("settings")},
               {"totals", totalsJson(assets)}};
  json["assets"] = std::move(assets);
  json["scene"] = sceneOf(std::move(uses));
  json["run"] = mergedRuns(parts);
  return json;
}

}  // namespace

std::string formatSummary(const BatchPlan& plan, const BatchOptions& options,
                          const builders::BuildSettings& settings, const BatchResult& result) {
  Json assets = Json::array();
  Json costs = Json::array();
  Json uses = Json::array();
  std::uint64_t peak = 0;
  for (std::size_t k = 0; k < plan.assets.size(); ++k) {
    const BatchAsset& asset = plan.assets[k];
    const AssetOutcome& outcome = result.outcomes[k];
    assets.push_back(assetJson(asset, outcome, options.pages));
    costs.push_back(costJson(asset, outcome));
    if (asset.use) uses.push_back(useJson(asset, options.folder / asset.output));
    if (outcome.cost) peak = std::max(peak, outcome.cost->peakMemoryBytes);
  }
  Json json = {{"kind", kKind},
               {"schema", kSchema},
               {"tool", Json::parse(toolJson())},
               {"shard", nullptr},
               {"settings", Json::parse(settingsJson(settings))},
               {"totals", totalsJson(assets)}};
  if (options.shard) json["shard"] = {{"index", options.shard->index}, {"count", options.shard->count}};
  json["assets"] = std::move(assets);
  json["scene"] = sceneOf(std::move(uses));
  json["run"] = {{"seconds", result.seconds},        {"jobs", result.limits.jobs},
                 {"threads", result.limits.threads}, {"memory_limit_bytes", result.limits.memoryBytes},
                 {"peak_memory_bytes", peak},        {"assets", std::move(costs)}};
  return textOf(json);
}

std::string summaryCsv(std::string_view summaryJson) {
  const Json json = Json::parse(summaryJson);
  std::string text = std::string(kCsvHead) + "\n";
  const Json& assets = json.at("assets");
  for (std::size_t k = 0; k < assets.size(); ++k) text += csvRow(assets[k], json.at("run").at("assets")[k]);
  return text;
}

std::vector<std::string> summaryThumbnails(std::string_view summaryJson, const fs::path& folder) {
  std::vector<std::string> pictures;
  const Json json = Json::parse(summaryJson);
  for (const Json& asset : json.at("assets")) {
    pictures.emplace_back();
    if (asset.at("tree").is_null()) continue;
    const Result<SphFile> file = readTree(folder / asset.at("output").get<std::string>());
    if (file) pictures.back() = thumbnailSvg(file->tree);
  }
  return pictures;
}

Result<std::string> mergeSummaries(const std::vector<fs::path>& paths) {
  try {
    std::vector<Json> parts;
    for (const fs::path& path : paths) parts.push_back(readSummary(path));
    checkShards(parts, paths);
    return textOf(merged(parts));
  } catch (const Mismatch& failure) {
    return Error{ErrorCode::InvalidArgument, failure.what()};
  } catch (const std::invalid_argument& failure) {
    return Error{ErrorCode::UnreadableInput, failure.what()};
  } catch (const Json::exception&) {
    return Error{ErrorCode::InvalidArgument,
                 paths.front().string() + ": a summary lacks parts that belong there"};
  }
}

BuildCosts costsIn(const fs::path& path) {
  BuildCosts costs;
  const Result<std::string> text = readFile(path);
  if (!text) return costs;
  const Json json = Json::parse(*text, nullptr, false);
  if (!json.is_object() || json.value("kind", "") != kKind) return costs;
  try {
    for (const Json& entry : json.at("run").at("assets")) {
      if (entry.at("seconds").is_null()) continue;
      costs[entry.at("output").get<std::string>()] = {entry.at("seconds").get<double>(),
                                                      entry.at("peak_memory_bytes").get<std::uint64_t>(),
                                                      entry.at("threads").get<unsigned>()};
    }
  } catch (const Json::exception&) {
    costs.clear();  // a summary of another make: its figures are not missed
  }
  return costs;
}

Result<Done> checkSummaryPlace(const fs::path& path) {
  std::error_code failure;
  if (!fs::exists(path, failure)) return Done{};
  const Result<std::string> text = readFile(path);
  if (!text) return text.error();
  // A page holds the JSON that it shows.
  const bool ours =
      endingOf(path) == ".csv" ? text->rfind(kCsvHead, 0) == 0 : text->find(kKind) != std::string::npos;
  if (ours) return Done{};
  return Error{ErrorCode::UnwritableOutput, path.string() + ": exists already, and is no summary of a batch"};
}

BatchTotals totalsOf(std::string_view summaryJson) {
  const Json totals = Json::parse(summaryJson).at("totals");
  return {totals.at("assets").get<std::size_t>(), totals.at("done").get<std::size_t>(),
          totals.at("missed").get<std::size_t>(), totals.at("failed").get<std::size_t>(),
          totals.at("pending").get<std::size_t>()};
}

}  // namespace spheretree::io
