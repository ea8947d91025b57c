// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include <spheretree/result.hpp>
#include <spheretree/sph.hpp>

namespace spheretree::io {

/// What a tree can be turned into (docs/exports.md).
enum class ExportFormat : std::uint8_t { Json, Foam, Urdf, Srdf, Curobo, Glb };

/// One row per format: what the command line and the tests read.
struct ExportEntry {
  ExportFormat format{};
  std::string_view name;
  std::string_view ending;   ///< that stands for it, with its dot; empty: must be asked for by name
  std::string_view summary;  ///< one line
};

[[nodiscard]] const std::array<ExportEntry, 6>& exportFormats();

/// The format that the ending of a file stands for.
[[nodiscard]] std::optional<ExportFormat> exportFormatOf(const std::filesystem::path& path);

struct ExportSource {
  const SphFile& file;
  std::string name;                  ///< of the robot, the link, the scene
  std::optional<std::size_t> level;  ///< this one only; robots otherwise get the last, the others all of them
};

/// The bytes of the file. Every number is exactly that of the tree. Errors: InvalidArgument when the tree has
/// no such level.
Result<std::string> exportTree(ExportFormat format, const ExportSource& source);

}  // namespace spheretree::io
