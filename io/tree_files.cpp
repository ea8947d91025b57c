// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is written about a tree: the metadata of its .sph file (docs/file-format.md), the JSON and the CSV
// report (docs/reports.md), the pieces of which that other reports share are in report_parts.cpp. Relative
// figures are fractions of the bounding box diagonal of the mesh that the tree covers.

#include "io/tree_files.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <bit>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include <spheretree/version.hpp>

#include "builders/settings_use.hpp"
#include "io/guarded.hpp"
#include "io/report_parts.hpp"

namespace spheretree::io {
namespace {

using Json = nlohmann::ordered_json;
using builders::BuildResult;
using builders::BuildSettings;
using builders::LevelMetrics;
using Metadata = std::vector<std::pair<std::string, std::string>>;

// Of the `#` lines. Raised when a key changes its meaning.
constexpr const char* kFormatVersion = "1";
constexpr const char* kUnits = "mesh units";

std::string coverName(builders::Cover cover) {
  return cover == builders::Cover::Solid ? "solid" : "surface";
}

double diagonalOf(const Provenance& provenance) {
  return provenance.check.bounds.diagonal().norm();
}

/// A length as a fraction of the diagonal.
double relative(double length, const Provenance& provenance) {
  return length / diagonalOf(provenance);
}

const char* onOff(bool on) {
  return on ? "on" : "off";
}

// --- settings ---

/// The settings that the build looked at, decided, in the order in which they are written.
Json settingsOf(const BuildSettings& settings) {
  Json json = {{"builder", settings.builder},        {"branch", settings.branch},
               {"levels", settings.levels},          {"max_error", settings.maxError},
               {"cover", coverName(settings.cover)}, {"seed", settings.seed}};
  const std::vector<std::string_view> reducers = builders::reducersInUse(settings);
  if (reducers.empty()) return json;
  json["quality"] = qualityName(settings.quality);
  json["objective"] = objectiveName(settings.objective);
  json["refine"] = onOff(builders::refines(settings));
  json["link"] = onOff(builders::links(settings));
  if (settings.builder == "combined") json["reducers"] = reducers;
  if (builders::usesAxis(settings)) {
    json["axis_error"] = settings.axis.error;
    json["axis_balls"] = settings.axis.leastBalls;
  }
  for (const std::string_view name : reducers) {
    if (name == "hubbard") json["samples"] = settings.hubbard.samples;
    if (name == "grid") json["orientations"] = settings.grid.orientations;
  }
  return json;
}

// --- .sph ---

/// `max_error` as `max-error=0`, a list as `merge,expand`.
std::string settingText(const std::string& name, const Json& value) {
  std::string text = name;
  std::replace(text.begin(), text.end(), '_', '-');
  text += '=';
  if (value.is_number_float()) return text + exactNumber(value.get<double>());
  if (value.is_string()) return text + value.get<std::string>();
  if (!value.is_array()) return text + value.dump();
  for (std::size_t k = 0; k < value.size(); ++k) text += (k == 0 ? "" : ",") + value[k].get<std::string>();
  return text;
}

/// All but the builder, which has a line of its own.
std::string settingsLine(const BuildSettings& settings) {
  const Json json = settingsOf(settings);
  std::string line;
  for (const auto& [name, value] : json.items()) {
    if (name == "builder") continue;
    line += (line.empty() ? "" : " ") + settingText(name, value);
  }
  return line;
}

std::string levelLine(const LevelMetrics& metrics, const Provenance& provenance) {
  return "spheres=" + std::to_string(metrics.spheres) + " overhang-worst=[" +
         readableNumber(relative(metrics.overhangWorst.lower, provenance)) + "," +
         readableNumber(relative(metrics.overhangWorst.upper, provenance)) +
         "] overhang-mean=" + readableNumber(relative(metrics.overhangMean, provenance)) +
         " volume-ratio=" + readableNumber(metrics.volumeRatio) +
         " covered=" + (metrics.surface.certified ? "yes" : "no") +
         " solid-covered=" + (metrics.solid.certified ? "yes" : "no");
}

Metadata metadataOf(const BuildResult& build, const Provenance& provenance) {
  Metadata metadata = {{"format-version", kFormatVersion},
                       {"tool", "spheretree " SPHERETREE_VERSION},
                       {"mesh-hash", provenance.import.contentHash},
                       {"mesh-triangles", std::to_string(provenance.check.triangles)},
                       {"repair", repairName(provenance.repair)},
                       {"builder", build.report.settings.builder},
                       {"settings", settingsLine(build.report.settings)},
                       {"frame", "mesh"},
                       {"units", kUnits},
                       {"mesh-diagonal", readableNumber(diagonalOf(provenance))}};
  if (provenance.wrapOffset > 0)
    metadata.emplace_back("wrap-stand-off", readableNumber(relative(provenance.wrapOffset, provenance)));
  for (std::size_t k = 0; k < build.report.levels.size(); ++k)
    metadata.emplace_back("level-" + std::to_string(k),
                          levelLine(build.report.levels[k].metrics, provenance));
  metadata.emplace_back("surface-chains",
                        build.report.surfaceChains.certified ? "certified" : "not certified");
  metadata.emplace_back("solid-chains", build.report.solidChains.certified ? "certified" : "not certified");
  return metadata;
}

// --- tree hash ---

void appendWord(std::string& bytes, std::uint32_t word) {
  for (unsigned k = 0; k < 4; ++k) bytes += static_cast<char>((word >> (8 * k)) & 0xffU);
}

// --- JSON ---

Json levelOf(std::size_t index, const builders::LevelReport& level, const Provenance& provenance) {
  Json json = Json::parse(levelJson(index, level.metrics, diagonalOf(provenance)));
  json["winners"] = Json::object();
  for (const auto& [name, sets] : level.winners) json["winners"][name] = sets;
  return json;
}

/// Largest resident set of this process so far, in bytes.
std::uint64_t peakMemory() {
  rusage usage{};
  if (::getrusage(RUSAGE_SELF, &usage) != 0) return 0;
  constexpr std::uint64_t kKibibyte = 1024;  // Linux counts in those
  return static_cast<std::uint64_t>(usage.ru_maxrss) * kKibibyte;
}

Json reportOf(const BuildResult& build, const Provenance& provenance) {
  const builders::BuildReport& report = build.report;
  Json levels = Json::array();
  for (std::size_t k = 0; k < report.levels.size(); ++k)
    levels.push_back(levelOf(k, report.levels[k], provenance));
  Json stages = Json::array();
  for (const builders::StageTime& stage : report.stages)
    stages.push_back({{"stage", stage.stage}, {"seconds", stage.seconds}});
  return {{"tool", Json::parse(toolJson())},
          {"mesh", Json::parse(meshJson(provenance))},
          {"settings", settingsOf(report.settings)},
          {"threads", report.threads},
          {"levels", std::move(levels)},
          {"certificate",
           {{"surface_chains", Json::parse(chainJson(report.surfaceChains))},
            {"solid_chains", Json::parse(chainJson(report.solidChains))}}},
          {"error_bound_met", report.errorBoundMet},
          {"stages", std::move(stages)},
          {"peak_memory_bytes", peakMemory()},
          {"tree",
           {{"content_hash", treeHash(build.tree)},
            {"levels", build.tree.levelCount()},
            {"spheres", build.tree.nodes().size()},
            {"most_children", build.tree.maxChildren()}}}};
}

}  // namespace

Result<SphFile> readTree(const std::filesystem::path& path, SphLoadLimits limits) {
  return guarded(ErrorCode::UnreadableInput, path.string(), [&]() -> Result<SphFile> {
    const Result<std::string> text = readFile(path);
    if (!text) return text.error();
    Result<SphFile> file = parseSph(text.value(), limits);
    if (!file) return Error{file.error().code, path.string() + ": " + file.error().message};
    return file;
  });
}

Result<std::string> formatTree(const BuildResult& build, const Provenance& provenance) {
  return formatSph(build.tree, build.report.settings.branch, metadataOf(build, provenance));
}

std::string treeHash(const SphereTree& tree) {
  std::string bytes;
  appendWord(bytes, static_cast<std::uint32_t>(tree.levelCount()));
  for (std::size_t depth = 0; depth < tree.levelCount(); ++depth) {
    appendWord(bytes, static_cast<std::uint32_t>(tree.level(depth).size()));
    for (const Node& node : tree.level(depth)) {
      appendWord(bytes, node.parent);
      for (const float number :
           {node.ball.center.x, node.ball.center.y, node.ball.center.z, node.ball.radius})
        appendWord(bytes, std::bit_cast<std::uint32_t>(number));
    }
  }
  return contentHash(bytes);
}

std::string settingsJson(const BuildSettings& settings) {
  return settingsOf(settings).dump();
}

std::string formatJsonReport(const BuildResult& build, const Provenance& provenance) {
  // A path may hold any bytes; those that are not UTF-8 are replaced.
  return reportOf(build, provenance).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string formatCsvReport(const BuildResult& build, const Provenance& provenance) {
  const std::string hash = treeHash(build.tree);
  std::string text = levelCsvHeader();
  for (std::size_t k = 0; k < build.report.levels.size(); ++k)
    text += levelCsvRow(k, build.report.levels[k].metrics, provenance, hash, build.report.levels[k].winners);
  return text;
}

}  // namespace spheretree::io
