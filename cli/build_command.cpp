// SPDX-License-Identifier: GPL-3.0-or-later
//
// spheretree build: a mesh becomes a `.sph` with its report.
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "builders/build_tree.hpp"
#include "builders/settings_use.hpp"
#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/interrupt.hpp"
#include "cli/level_table.hpp"
#include "cli/options.hpp"
#include "cli/outputs.hpp"
#include "cli/progress_bar.hpp"
#include "cli/solid_input.hpp"
#include "io/html_pages.hpp"
#include "io/medial_dump.hpp"
#include "io/report_parts.hpp"
#include "io/tree_files.hpp"

namespace spheretree::cli {
namespace {

namespace fs = std::filesystem;
using builders::BuildReport;
using builders::BuildResult;

constexpr int kErrorDigits = 4;  // of an error in a sentence

struct BuildOptions {
  std::string mesh;
  std::string output;
  std::vector<std::string> reports;
  std::string medialDump;  // empty: none
  builders::BuildSettings settings;
  io::Repair repair = io::Repair::Auto;
  io::Overwrite overwrite = io::Overwrite::Refuse;
  Verbosity verbosity = Verbosity::Normal;
  unsigned threads = 0;
  ConfigFile config;
};

/// The tree first: it is what took the time. When a report cannot be written after it, the tree stays.
std::vector<fs::path> outputPaths(const BuildOptions& options) {
  std::vector<fs::path> paths{options.output};
  paths.insert(paths.end(), options.reports.begin(), options.reports.end());
  if (!options.medialDump.empty()) paths.emplace_back(options.medialDump);
  return paths;
}

Result<std::string> formatReport(const std::string& ending, const BuildResult& build,
                                 const io::Provenance& provenance, const medial::Surface& surface) {
  if (ending == ".csv") return io::formatCsvReport(build, provenance);
  if (ending == ".html") return io::formatHtmlReport(build, provenance, surface, io::PageTimes::Shown);
  return io::formatJsonReport(build, provenance);
}

Result<std::vector<Output>> format(const BuildResult& build, const io::Provenance& provenance,
                                   const medial::Surface& surface, const BuildOptions& options) {
  Result<std::string> tree = io::formatTree(build, provenance);
  if (!tree) return tree.error();
  std::vector<Output> outputs;
  outputs.push_back({options.output, std::move(*tree)});
  for (const std::string& report : options.reports) {
    Result<std::string> text = formatReport(endingOf(report), build, provenance, surface);
    if (!text) return text.error();
    outputs.push_back({report, std::move(*text)});
  }
  return outputs;
}

std::string describeCertificate(const BuildReport& report) {
  const bool solid = report.settings.cover == builders::Cover::Solid;
  const builders::ProofEffort& effort = solid ? report.solidChains.effort : report.surfaceChains.effort;
  return std::string("certified: every level covers the whole ") + (solid ? "solid" : "surface") + ", " +
         counted(effort.cells, "piece", "pieces") + " checked, deepest subdivision " +
         std::to_string(effort.deepest) + "\n";
}

/// "combined of merge, expand: branch 8, 4 levels, seed 1, quality normal, refined, linked"
std::string describeSettings(const BuildResult& build) {
  const builders::BuildSettings& settings = build.report.settings;
  const std::vector<std::string_view> reducers = builders::reducersInUse(settings);
  std::string text = settings.builder;
  if (settings.builder == "combined") {
    for (std::size_t k = 0; k < reducers.size(); ++k)
      text += (k == 0 ? " of " : ", ") + std::string(reducers[k]);
  }
  text += ": branch " + std::to_string(settings.branch) + ", " +
          counted(build.tree.levelCount(), "level", "levels") + ", seed " + std::to_string(settings.seed);
  if (builders::refines(settings)) text += ", quality " + io::qualityName(settings.quality) + ", refined";
  if (builders::links(settings)) text += ", linked";
  return text;
}

/// "merge 3, expand 5" for every level; nothing when there was no competition.
std::vector<std::string> setsWon(const BuildReport& report) {
  std::vector<std::string> texts;
  if (report.settings.builder != "combined") return texts;
  for (const builders::LevelReport& level : report.levels) {
    std::string text;
    for (const auto& [name, sets] : level.winners)
      text += (text.empty() ? "" : ", ") + name + " " + std::to_string(sets);
    texts.push_back(std::move(text));
  }
  return texts;
}

std::string summary(const BuildResult& build, const io::Provenance& provenance, const BuildOptions& options,
                    double diagonal) {
  const builders::BuildSettings& settings = build.report.settings;
  std::string text = describeMesh(provenance);
  text += describeSettings(build);
  if (build.tree.levelCount() < settings.levels) {
    const bool met = settings.maxError > 0 && build.report.errorBoundMet;
    text += " (of " + std::to_string(settings.levels) +
            (met ? ": every ball meets --max-error)" : ": the next would not stick out less)");
  }
  text += "\n";
  std::vector<const builders::LevelMetrics*> levels;
  for (const builders::LevelReport& level : build.report.levels) levels.push_back(&level.metrics);
  text += levelTable(levels, diagonal, setsWon(build.report)) + describeCertificate(build.report);
  for (const fs::path& path : outputPaths(options)) text += "wrote " + path.string() + "\n";
  return text;
}

ExitCode missed(const BuildResult& build, const BuildOptions& options, double diagonal) {
  const double worst = build.report.levels.back().metrics.overhangWorst.upper / diagonal;
  return fail({ErrorCode::ErrorBoundMissed, options.output + ": the last level sticks out by " +
                                                shortNumber(worst, kErrorDigits) +
                                                " of the diagonal, more than --max-error " +
                                                shortNumber(options.settings.maxError, kErrorDigits)});
}

void remarkTimes(const BuildReport& report) {
  for (const builders::StageTime& stage : report.stages)
    remark(stage.stage + ": " + shortNumber(stage.seconds, 3) + " s on " +
           counted(report.threads, "thread", "threads"));
}

/// Worth a word: no level can be better than this.
std::string placeWarning(const BuildReport& report, const std::string& mesh) {
  constexpr double kNoticeable = 1e-3;
  if (report.coordinateStep < kNoticeable) return {};
  return mesh + ": is so far from the origin that single precision rounds the places of balls to " +
         shortNumber(100 * report.coordinateStep, 2) +
         " % of the diagonal; nearer to it the tree would be tighter";
}

ExitCode runBuild(const BuildOptions& options) {
  std::vector<fs::path> inputs{options.mesh};
  if (!options.config.path.empty()) inputs.emplace_back(options.config.path);
  if (const Result<Done> free = checkOutputs(inputs, outputPaths(options), options.overwrite); !free)
    return fail(free.error());

  ProgressBar bar(options.verbosity);
  medial::Context context(options.threads, bar.callback());
  Result<SolidInput> input = readSolid(options.mesh, options.repair, Frame::Mesh, context);
  bar.wipe();
  if (!input) return fail(input.error());
  const io::Provenance& provenance = input->provenance;
  if (options.verbosity == Verbosity::Verbose) remark(describeImport(provenance));
  if (const std::string sentence = shapeWarning(provenance); !sentence.empty()) warn(sentence);

  const CancelOnInterrupt interruptible(context);
  Result<BuildResult> build = builders::buildTree(input->surface, options.settings, context);
  bar.wipe();
  if (!build) return fail({build.error().code, options.mesh + ": " + build.error().message});
  if (const std::string sentence = placeWarning(build->report, options.mesh); !sentence.empty())
    warn(sentence);
  if (options.verbosity == Verbosity::Verbose) remarkTimes(build->report);

  Result<std::vector<Output>> outputs = format(*build, provenance, input->surface, options);
  if (!outputs) return fail({outputs.error().code, options.output + ": " + outputs.error().message});
  if (!options.medialDump.empty()) {
    const Result<medial::MedialAxis> axis =
        builders::rootMedialAxis(input->surface, options.settings, context);
    if (!axis) return fail({axis.error().code, options.mesh + ": " + axis.error().message});
    outputs->push_back({options.medialDump, io::formatMedialAxis(*axis)});
  }
  if (context.cancelled()) return fail({ErrorCode::Cancelled, options.mesh + ": cancelled"});
  if (const Result<Done> written = writeOutputs(outputs.value(), options.overwrite); !written)
    return fail(written.error());

  const double diagonal = input->surface.diagonal();
  if (options.verbosity != Verbosity::Quiet) print(summary(*build, provenance, options, diagonal));
  return build->report.errorBoundMet ? ExitCode::Done : missed(*build, options, diagonal);
}

}  // namespace

Command setupBuild(CLI::App& program) {
  const auto options = std::make_shared<BuildOptions>();
  CLI::App* app = program.add_subcommand("build", "Turn a mesh into a sphere tree");
  addConfig(*app, options->config);
  addSettings(*app, options->settings);
  app->add_option("MESH", options->mesh, "Mesh to read: OBJ, PLY, STL, OFF, glTF, Collada, 3DS, FBX")
      ->option_text(" ")
      ->required()
      ->configurable(false);
  addRepair(*app, options->repair)->configurable()->group("Mesh");
  app->add_option("-o,--output", options->output, "Tree to write")
      ->type_name("FILE.sph")
      ->required()
      ->configurable(false)
      ->group("Output");
  addReports(*app, options->reports)->group("Output");
  app->add_option("--dump-medial", options->medialDump,
                  "Also write the balls of the medial axis of everything")
      ->type_name("FILE.ply")
      ->configurable(false)
      ->group("Output");
  addForce(*app, options->overwrite)->group("Output");
  addThreads(*app, options->threads)->configurable()->group("Run");
  addVerbosity(*app, options->verbosity);
  app->callback([app, options] { checkSettings(*app, options->settings, options->config); });
  app->footer("Example: spheretree build bunny.obj -o bunny.sph --report bunny.json");
  return {app, [app, options] {
            if (!options->config.print) return runBuild(*options);
            print(configText(*app));
            return ExitCode::Done;
          }};
}

}  // namespace spheretree::cli
