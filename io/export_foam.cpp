// SPDX-License-Identifier: GPL-3.0-or-later
//
// As the tool foam (S. Coumar, Z. Kingston et al., "Foam: a tool for spherical approximation of robot
// geometry", 2025) stores what it makes: a list with an entry per depth, each a set of spheres with its mean,
// best and worst error in mesh units. The errors are those of the metadata, null where a file says nothing.
#include <charconv>
#include <optional>
#include <string_view>

#include <nlohmann/json.hpp>

#include "io/export_formats.hpp"
#include "io/tree_levels.hpp"

namespace spheretree::io {
namespace {

using Json = nlohmann::ordered_json;

std::string_view metadataOf(const SphFile& file, std::string_view key) {
  for (const auto& [name, value] : file.metadata) {
    if (name == key) return value;
  }
  return {};
}

/// The number behind `label`, times `unit`.
Json numberBehind(std::string_view text, std::string_view label, double unit) {
  const std::size_t at = text.find(label);
  if (at == std::string_view::npos) return nullptr;
  text.remove_prefix(at + label.size());
  double value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  static_cast<void>(end);
  return code == std::errc{} ? Json(value * unit) : Json(nullptr);
}

/// The upper end of "overhang-worst=[0.1,0.2]".
Json worstOf(std::string_view line, double diagonal) {
  const std::size_t begin = line.find("overhang-worst=[");
  if (begin == std::string_view::npos) return nullptr;
  return numberBehind(line.substr(begin), ",", diagonal);
}

}  // namespace

std::string exportFoam(const ExportSource& source, std::span<const std::size_t> levels) {
  const SphereTree& tree = source.file.tree;
  const Json diagonal = numberBehind(metadataOf(source.file, "mesh-diagonal"), "", 1);
  Json list = Json::array();
  for (const std::size_t level : levels) {
    Json spheres = Json::array();
    for (const std::size_t place : nodesAtLevel(tree, level).nodes) {
      const Sphere& ball = tree.nodes()[place].ball;
      spheres.push_back({{"origin",
                          {static_cast<double>(ball.center.x), static_cast<double>(ball.center.y),
                           static_cast<double>(ball.center.z)}},
                         {"radius", static_cast<double>(ball.radius)}});
    }
    Json mean;
    Json worst;
    if (diagonal.is_number()) {
      const std::string_view line = metadataOf(source.file, "level-" + std::to_string(level));
      mean = numberBehind(line, "overhang-mean=", diagonal.get<double>());
      worst = worstOf(line, diagonal.get<double>());
    }
    list.push_back({{"mean", mean}, {"best", nullptr}, {"worst", worst}, {"spheres", std::move(spheres)}});
  }
  return list.dump(1) + "\n";
}

}  // namespace spheretree::io
