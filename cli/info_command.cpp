// SPDX-License-Identifier: GPL-3.0-or-later
//
// spheretree info: what a `.sph` file says, without a mesh.
#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <spheretree/aabb.hpp>

#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/text_table.hpp"
#include "io/tree_files.hpp"

namespace spheretree::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kDigits = 6;

struct InfoOptions {
  std::string tree;
  bool json = false;
};

/// What there is to say about the nodes of one depth.
struct LevelFacts {
  std::size_t spheres = 0;
  std::size_t childless = 0;
  float smallest = 0;
  float largest = 0;
};

LevelFacts factsOf(std::span<const Node> nodes) {
  LevelFacts facts;
  facts.spheres = nodes.size();
  const auto byRadius = [](const Node& a, const Node& b) { return a.ball.radius < b.ball.radius; };
  const auto [smallest, largest] = std::minmax_element(nodes.begin(), nodes.end(), byRadius);
  facts.smallest = smallest->ball.radius;
  facts.largest = largest->ball.radius;
  facts.childless = static_cast<std::size_t>(
      std::count_if(nodes.begin(), nodes.end(), [](const Node& node) { return node.childCount == 0; }));
  return facts;
}

Aabb boundsOfAll(std::span<const Node> nodes) {
  Aabb box = boundsOf(nodes.front().ball);
  for (const Node& node : nodes) {
    const Aabb one = boundsOf(node.ball);
    box.min = {std::min(box.min.x, one.min.x), std::min(box.min.y, one.min.y),
               std::min(box.min.z, one.min.z)};
    box.max = {std::max(box.max.x, one.max.x), std::max(box.max.y, one.max.y),
               std::max(box.max.z, one.max.z)};
  }
  return box;
}

Json jsonOf(Vec3 v) {
  return {v.x, v.y, v.z};
}

std::string asJson(const std::string& path, const SphFile& file) {
  Json levels = Json::array();
  for (std::size_t k = 0; k < file.tree.levelCount(); ++k) {
    const LevelFacts facts = factsOf(file.tree.level(k));
    levels.push_back({{"level", k},
                      {"spheres", facts.spheres},
                      {"childless", facts.childless},
                      {"radius", {{"min", facts.smallest}, {"max", facts.largest}}}});
  }
  Json metadata = Json::array();
  for (const auto& [key, value] : file.metadata) metadata.push_back({{"key", key}, {"value", value}});
  const Aabb box = boundsOfAll(file.tree.nodes());
  const Json json = {{"path", path},
                     {"content_hash", io::treeHash(file.tree)},
                     {"branch", file.branch},
                     {"most_children", file.tree.maxChildren()},
                     {"spheres", file.tree.nodes().size()},
                     {"bounds", {{"min", jsonOf(box.min)}, {"max", jsonOf(box.max)}}},
                     {"levels", std::move(levels)},
                     {"metadata", std::move(metadata)},
                     {"warnings", file.warnings}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string number(float value) {
  return shortNumber(static_cast<double>(value), kDigits);
}

std::string textOf(Vec3 v) {
  return "(" + number(v.x) + ", " + number(v.y) + ", " + number(v.z) + ")";
}

std::string asText(const std::string& path, const SphFile& file) {
  const SphereTree& tree = file.tree;
  const Aabb box = boundsOfAll(tree.nodes());
  std::string text = path;
  text += ": " + counted(tree.levelCount(), "level", "levels");
  text += ", branch " + std::to_string(file.branch);
  text += " (most children " + std::to_string(tree.maxChildren()) + "), ";
  text += counted(tree.nodes().size(), "sphere", "spheres");
  text += "\nbounds " + textOf(box.min) + " to " + textOf(box.max);
  text += "\nhash " + io::treeHash(tree) + "\n";
  TextTable table({{"level"}, {"spheres"}, {"childless"}, {"radius from"}, {"to"}});
  for (std::size_t k = 0; k < tree.levelCount(); ++k) {
    const LevelFacts facts = factsOf(tree.level(k));
    table.add({std::to_string(k), std::to_string(facts.spheres), std::to_string(facts.childless),
               number(facts.smallest), number(facts.largest)});
  }
  text += table.text();
  for (const auto& [key, value] : file.metadata) text.append(key).append(": ").append(value).append("\n");
  return text;
}

ExitCode runInfo(const InfoOptions& options) {
  const Result<SphFile> file = io::readTree(options.tree);
  if (!file) return fail(file.error());
  for (const std::string& warning : file.value().warnings) warn(options.tree + ": " + warning);
  print(options.json ? asJson(options.tree, file.value()) : asText(options.tree, file.value()));
  return ExitCode::Done;
}

}  // namespace

Command setupInfo(CLI::App& program) {
  const auto options = std::make_shared<InfoOptions>();
  CLI::App* app = program.add_subcommand("info", "Say what is in a .sph file");
  app->add_option("TREE", options->tree, "Tree to read")->option_text(" ")->required();
  app->add_flag("--json", options->json, "Print JSON");
  app->footer("Example: spheretree info bunny.sph --json");
  return {app, [options] { return runInfo(*options); }};
}

}  // namespace spheretree::cli
