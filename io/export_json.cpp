// SPDX-License-Identifier: GPL-3.0-or-later
//
// The whole tree for scripts (docs/exports.md).
#include <nlohmann/json.hpp>

#include "io/export_formats.hpp"
#include "io/report_parts.hpp"
#include "io/tree_files.hpp"

namespace spheretree::io {
namespace {

using Json = nlohmann::ordered_json;

Json sphereOf(const Node& node, std::size_t levelAbove) {
  const Vec3& c = node.ball.center;
  // Floats as the doubles they are: no digit is lost, whoever reads them.
  return {{"center", {static_cast<double>(c.x), static_cast<double>(c.y), static_cast<double>(c.z)}},
          {"radius", static_cast<double>(node.ball.radius)},
          {"parent", node.parent == kNoParent ? Json(nullptr) : Json(node.parent - levelAbove)},
          {"children", node.childCount}};
}

}  // namespace

std::string exportJson(const ExportSource& source, std::span<const std::size_t> levels) {
  const SphereTree& tree = source.file.tree;
  Json list = Json::array();
  for (const std::size_t level : levels) {
    const Node* above = level == 0 ? tree.nodes().data() : tree.level(level - 1).data();
    Json spheres = Json::array();
    for (const Node& node : tree.level(level))
      spheres.push_back(sphereOf(node, static_cast<std::size_t>(above - tree.nodes().data())));
    list.push_back({{"level", level}, {"spheres", std::move(spheres)}});
  }
  Json metadata = Json::array();
  for (const auto& [key, value] : source.file.metadata) metadata.push_back({{"key", key}, {"value", value}});
  const Json json = {{"kind", "spheretree tree"},
                     {"schema", 1},
                     {"tool", Json::parse(toolJson())},
                     {"name", source.name},
                     {"frame", "mesh"},
                     {"units", "mesh units"},
                     {"branch", source.file.branch},
                     {"content_hash", treeHash(tree)},
                     {"metadata", std::move(metadata)},
                     {"levels", std::move(list)}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace spheretree::io
