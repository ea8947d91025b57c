// SPDX-License-Identifier: GPL-3.0-or-later
//
// spheretree export: a tree in the formats of other tools.
#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/options.hpp"
#include "cli/outputs.hpp"
#include "io/export.hpp"
#include "io/tree_files.hpp"

namespace spheretree::cli {
namespace {

namespace fs = std::filesystem;

struct ExportOptions {
  std::string tree;
  std::string output;
  std::optional<io::ExportFormat> format;  ///< otherwise by the ending of the output
  std::optional<std::size_t> level;
  std::string name;  ///< empty: that of the tree's file
  io::Overwrite overwrite = io::Overwrite::Refuse;
};

ExitCode runExport(const ExportOptions& options) {
  const std::optional<io::ExportFormat> format =
      options.format ? options.format : io::exportFormatOf(options.output);
  if (!format) {
    return fail(
        {ErrorCode::InvalidArgument,
         options.output + ": its ending names no format; --format does (see spheretree export --help)"});
  }
  const std::array<fs::path, 1> inputs{options.tree};
  const std::array<fs::path, 1> outputs{options.output};
  if (const Result<Done> free = checkOutputs(inputs, outputs, options.overwrite); !free)
    return fail(free.error());
  const Result<SphFile> file = io::readTree(options.tree);
  if (!file) return fail(file.error());
  for (const std::string& warning : file->warnings) warn(options.tree + ": " + warning);

  const std::string name = options.name.empty() ? fs::path(options.tree).stem().string() : options.name;
  Result<std::string> bytes = io::exportTree(*format, {*file, name, options.level});
  if (!bytes) return fail({bytes.error().code, options.tree + ": " + bytes.error().message});
  if (const Result<Done> written = writeOutputs({{options.output, std::move(*bytes)}}, options.overwrite);
      !written)
    return fail(written.error());
  print("wrote " + options.output + "\n");
  return ExitCode::Done;
}

}  // namespace

Command setupExport(CLI::App& program) {
  const auto options = std::make_shared<ExportOptions>();
  CLI::App* app = program.add_subcommand("export", "Turn a tree into a format of other tools");
  app->add_option("TREE", options->tree, "Tree to read")->option_text(" ")->required();
  app->add_option("-o,--output", options->output, "File to write")->type_name("FILE")->required();
  std::vector<std::string> words;
  for (const io::ExportEntry& entry : io::exportFormats()) words.emplace_back(entry.name);
  addChoice(
      *app, "--format", words, 0,
      [options](std::size_t k) { options->format = io::exportFormats()[k].format; },
      "What to write; by the ending of FILE if it is .json, .urdf, .srdf, .yml or .glb")
      ->default_str("");
  app->add_option("--level", options->level,
                  "This level only, 0 is the root. Otherwise urdf, srdf and curobo get the last one, the "
                  "others all of them")
      ->type_name("N")
      ->check(CLI::NonNegativeNumber);
  app->add_option("--name", options->name, "Of the robot and its link; otherwise that of TREE")
      ->type_name("NAME");
  addForce(*app, options->overwrite);
  app->footer("Example: spheretree export bunny.sph -o bunny.glb");
  return {app, [options] { return runExport(*options); }};
}

}  // namespace spheretree::cli
