// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/export.hpp"

#include <numeric>
#include <utility>

#include "builders/metrics.hpp"
#include "io/export_formats.hpp"
#include "io/files.hpp"
#include "io/guarded.hpp"
#include "io/tree_levels.hpp"

namespace spheretree::io {
namespace {

constexpr std::array<ExportEntry, 6> kFormats{{
    {ExportFormat::Json, "json", ".json", "everything: levels, parents, what the file says about itself"},
    {ExportFormat::Foam, "foam", "", "JSON as the tool foam writes it: sets of spheres, level by level"},
    {ExportFormat::Urdf, "urdf", ".urdf", "a robot of one link with a collision element per ball"},
    {ExportFormat::Srdf, "srdf", ".srdf", "link_sphere_approximation for MoveIt"},
    {ExportFormat::Curobo, "curobo", ".yml", "collision_spheres for cuRobo"},
    {ExportFormat::Glb, "glb", ".glb", "binary glTF to look at: a node per level, a colour per level"},
}};

/// Formats for robots know sets of balls, not trees.
bool isForRobots(ExportFormat format) {
  return format == ExportFormat::Urdf || format == ExportFormat::Srdf || format == ExportFormat::Curobo;
}

LinkBalls linkOf(const ExportSource& source, std::size_t level) {
  std::vector<Node> nodes;
  for (const std::size_t place : nodesAtLevel(source.file.tree, level).nodes)
    nodes.push_back(source.file.tree.nodes()[place]);
  return {source.name, builders::ballsOf(nodes)};
}

std::string textOf(ExportFormat format, const ExportSource& source, const std::vector<std::size_t>& levels) {
  if (format == ExportFormat::Json) return exportJson(source, levels);
  if (format == ExportFormat::Foam) return exportFoam(source, levels);
  if (format == ExportFormat::Glb) return exportGlb(source, levels);
  const std::array<LinkBalls, 1> links{linkOf(source, levels.back())};
  if (format == ExportFormat::Srdf) return srdfText(source.name, links);
  if (format == ExportFormat::Curobo) return curoboText(source.name, links);
  return urdfText(source.name, links);
}

}  // namespace

const std::array<ExportEntry, 6>& exportFormats() {
  return kFormats;
}

std::optional<ExportFormat> exportFormatOf(const std::filesystem::path& path) {
  const std::string ending = path.extension() == ".yaml" ? ".yml" : endingOf(path);
  for (const ExportEntry& entry : kFormats) {
    if (!entry.ending.empty() && entry.ending == ending) return entry.format;
  }
  return std::nullopt;
}

Result<std::string> exportTree(ExportFormat format, const ExportSource& source) {
  const std::size_t count = source.file.tree.levelCount();
  if (source.level && *source.level >= count) {
    return Error{ErrorCode::InvalidArgument, "has no level " + std::to_string(*source.level) +
                                                 ": its levels are 0 to " + std::to_string(count - 1)};
  }
  std::vector<std::size_t> levels(count);
  std::iota(levels.begin(), levels.end(), std::size_t{0});
  if (source.level) {
    levels = {*source.level};
  } else if (isForRobots(format)) {
    levels = {count - 1};
  }
  return guarded(ErrorCode::Internal, "export",
                 [&]() -> Result<std::string> { return textOf(format, source, levels); });
}

}  // namespace spheretree::io
