// SPDX-License-Identifier: GPL-3.0-or-later
//
// spheretree eval: measures any `.sph` against a mesh, whoever wrote it.
//
// A level of a file is what a search at that depth has in hand: the balls at that depth, and the childless
// balls above it, which stand for themselves further down. That is how the proof of chains sees it too.
#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "builders/cover.hpp"
#include "builders/metrics.hpp"
#include "builders/solid_cover.hpp"
#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/interrupt.hpp"
#include "cli/level_table.hpp"
#include "cli/options.hpp"
#include "cli/outputs.hpp"
#include "cli/progress_bar.hpp"
#include "cli/solid_input.hpp"
#include "io/html_pages.hpp"
#include "io/report_parts.hpp"
#include "io/tree_files.hpp"
#include "io/tree_levels.hpp"

namespace spheretree::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using builders::ChainProof;
using builders::LevelMetrics;

constexpr std::array kFrameNames{Named<Frame>{"mesh", Frame::Mesh},
                                 Named<Frame>{"box-centred", Frame::BoxCentred}};
constexpr int kErrorDigits = 4;  // of an error in a sentence

struct EvalOptions {
  std::string mesh;
  std::string tree;
  std::vector<std::string> reports;
  std::optional<double> maxError;
  Frame frame = Frame::Mesh;
  io::Repair repair = io::Repair::Auto;
  io::Overwrite overwrite = io::Overwrite::Refuse;
  unsigned threads = 0;
  bool json = false;
};

struct EvaluatedLevel {
  LevelMetrics metrics;
  std::vector<std::size_t> nodes;  ///< that were measured, places in SphereTree::nodes()
  std::size_t fromAbove = 0;
  std::size_t worstNode = 0;  ///< the ball of the largest overhang, a place in SphereTree::nodes()
};

struct Evaluation {
  std::vector<EvaluatedLevel> levels;
  ChainProof surfaceChains;
  std::optional<ChainProof> solidChains;  ///< attempted when every level covers the solid
  bool boundMet = true;
};

EvaluatedLevel evaluateLevel(const medial::Surface& surface, const SphereTree& tree, std::size_t depth,
                             const medial::Context& context) {
  io::LevelNodes level = io::nodesAtLevel(tree, depth);
  std::vector<Node> nodes;
  for (const std::size_t place : level.nodes) nodes.push_back(tree.nodes()[place]);
  EvaluatedLevel result;
  result.metrics = builders::measureLevel(surface, builders::ballsOf(nodes), context);
  result.fromAbove = level.fromAbove;
  result.worstNode = level.nodes.at(result.metrics.worstBall);
  result.nodes = std::move(level.nodes);
  return result;
}

Evaluation evaluate(const medial::Surface& surface, const SphereTree& tree, std::optional<double> maxError,
                    const medial::Context& context) {
  Evaluation evaluation;
  bool solid = true;
  for (std::size_t k = 0; k < tree.levelCount(); ++k) {
    context.report("measure", static_cast<double>(k) / static_cast<double>(tree.levelCount()));
    evaluation.levels.push_back(evaluateLevel(surface, tree, k, context));
    solid = solid && evaluation.levels.back().metrics.solid.certified;
  }
  context.report("prove", 0);
  evaluation.surfaceChains = builders::proveSurfaceChains(surface, tree, context);
  if (solid) evaluation.solidChains = builders::proveSolidChains(surface, tree, context);
  const double worst = evaluation.levels.back().metrics.overhangWorst.upper;
  evaluation.boundMet = !maxError || worst <= *maxError * surface.diagonal();
  return evaluation;
}

/// All there is to report on, gathered once.
struct Subject {
  const EvalOptions& options;
  const SphFile& file;
  const SolidInput& input;
  const Evaluation& evaluation;
};

Json chainOf(const ChainProof& proof, bool namesTriangle) {
  Json json = Json::parse(io::chainJson(proof));
  if (proof.certified) return json;
  json["failed_level"] = proof.failedLevel;
  if (namesTriangle) json["failed_triangle"] = proof.failedTriangle;
  return json;
}

std::string asJson(const Subject& s) {
  const SphereTree& tree = s.file.tree;
  Json levels = Json::array();
  for (std::size_t k = 0; k < s.evaluation.levels.size(); ++k) {
    const EvaluatedLevel& level = s.evaluation.levels[k];
    Json json = Json::parse(io::levelJson(k, level.metrics, s.input.surface.diagonal()));
    json["from_above"] = level.fromAbove;
    json["worst_node"] = level.worstNode;
    levels.push_back(std::move(json));
  }
  Json certificate = {{"surface_chains", chainOf(s.evaluation.surfaceChains, true)}};
  certificate["solid_chains"] =
      s.evaluation.solidChains ? chainOf(*s.evaluation.solidChains, false) : Json(nullptr);
  const Eigen::Vector3d& shift = s.input.shift;
  const Json json = {{"tool", Json::parse(io::toolJson())},
                     {"mesh", Json::parse(io::meshJson(s.input.provenance))},
                     {"tree",
                      {{"path", s.options.tree},
                       {"content_hash", io::treeHash(tree)},
                       {"levels", tree.levelCount()},
                       {"branch", s.file.branch},
                       {"spheres", tree.nodes().size()},
                       {"warnings", s.file.warnings}}},
                     {"frame", nameOf(kFrameNames, s.options.frame)},
                     {"shift", {shift.x(), shift.y(), shift.z()}},
                     {"levels", std::move(levels)},
                     {"certificate", std::move(certificate)},
                     {"max_error", s.options.maxError ? Json(*s.options.maxError) : Json(nullptr)},
                     {"error_bound_met", s.evaluation.boundMet}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string asCsv(const Subject& s) {
  const std::string hash = io::treeHash(s.file.tree);
  std::string text = io::levelCsvHeader();
  for (std::size_t k = 0; k < s.evaluation.levels.size(); ++k)
    text += io::levelCsvRow(k, s.evaluation.levels[k].metrics, s.input.provenance, hash);
  return text;
}

Result<std::string> asHtml(const Subject& s) {
  io::TreeView view{s.input.surface.mesh(), s.file.tree, {}};
  for (const EvaluatedLevel& level : s.evaluation.levels)
    view.levels.push_back({level.nodes, level.metrics.ballOverhang, {}});
  return io::treePage(asJson(s), view, io::PageTimes::Shown);
}

Result<std::string> formatReport(const std::string& ending, const Subject& s) {
  if (ending == ".csv") return asCsv(s);
  if (ending == ".html") return asHtml(s);
  return asJson(s);
}

std::string describeChains(const Evaluation& evaluation) {
  const ChainProof& proof = evaluation.surfaceChains;
  if (!proof.certified) {
    return "not certified: near triangle " + std::to_string(proof.failedTriangle) +
           " no chain of balls from the root reaches level " + std::to_string(proof.failedLevel) + "\n";
  }
  const bool solid = evaluation.solidChains && evaluation.solidChains->certified;
  return std::string("certified: every level covers the whole ") + (solid ? "solid" : "surface") +
         ", children what their parents stand for\n";
}

std::string asText(const Subject& s) {
  std::string text = describeMesh(s.input.provenance);
  text += s.options.tree + ": " + counted(s.file.tree.levelCount(), "level", "levels") + ", branch " +
          std::to_string(s.file.branch) + ", frame " + nameOf(kFrameNames, s.options.frame) + "\n";
  std::vector<const LevelMetrics*> levels;
  for (const EvaluatedLevel& level : s.evaluation.levels) levels.push_back(&level.metrics);
  text += levelTable(levels, s.input.surface.diagonal()) + describeChains(s.evaluation);
  for (std::size_t k = 0; k < s.evaluation.levels.size(); ++k) {
    const std::size_t fromAbove = s.evaluation.levels[k].fromAbove;
    if (fromAbove == 0) continue;
    text += "level " + std::to_string(k) + " includes " +
            counted(fromAbove, "childless sphere", "childless spheres") + " from above\n";
  }
  for (const std::string& report : s.options.reports) text += "wrote " + report + "\n";
  return text;
}

ExitCode present(const Subject& s) {
  std::vector<Output> outputs;
  for (const std::string& report : s.options.reports) {
    Result<std::string> text = formatReport(endingOf(report), s);
    if (!text) return fail(text.error());
    outputs.push_back({report, std::move(*text)});
  }
  if (const Result<Done> written = writeOutputs(outputs, s.options.overwrite); !written)
    return fail(written.error());
  print(s.options.json ? asJson(s) : asText(s));
  if (s.evaluation.boundMet) return ExitCode::Done;
  const double worst = s.evaluation.levels.back().metrics.overhangWorst.upper / s.input.surface.diagonal();
  return fail({ErrorCode::ErrorBoundMissed, s.options.tree + ": the last level sticks out by " +
                                                shortNumber(worst, kErrorDigits) +
                                                " of the diagonal, more than --max-error " +
                                                shortNumber(*s.options.maxError, kErrorDigits)});
}

ExitCode runEval(const EvalOptions& options) {
  const std::vector<fs::path> inputs{options.mesh, options.tree};
  const std::vector<fs::path> reports(options.reports.begin(), options.reports.end());
  if (const Result<Done> free = checkOutputs(inputs, reports, options.overwrite); !free)
    return fail(free.error());
  const Result<SphFile> file = io::readTree(options.tree);
  if (!file) return fail(file.error());

  ProgressBar bar(Verbosity::Normal);
  medial::Context context(options.threads, bar.callback());
  const Result<SolidInput> input = readSolid(options.mesh, options.repair, options.frame, context);
  bar.wipe();
  if (!input) return fail(input.error());
  for (const std::string& warning : file.value().warnings) warn(options.tree + ": " + warning);
  if (const std::string sentence = shapeWarning(input.value().provenance); !sentence.empty()) warn(sentence);

  const CancelOnInterrupt interruptible(context);
  const Evaluation evaluation = evaluate(input.value().surface, file.value().tree, options.maxError, context);
  context.checkCancelled();
  bar.wipe();
  return present({options, file.value(), input.value(), evaluation});
}

}  // namespace

Command setupEval(CLI::App& program) {
  const auto options = std::make_shared<EvalOptions>();
  CLI::App* app = program.add_subcommand("eval", "Measure any .sph file against a mesh");
  app->add_option("MESH", options->mesh, "Mesh that the tree stands for")->option_text(" ")->required();
  app->add_option("TREE", options->tree, "Tree to measure, ours or not")->option_text(" ")->required();
  addChoice(*app, "--frame", options->frame, kFrameNames,
            "Where the tree's origin is: as in the mesh, or in the middle of its bounding box");
  addRepair(*app, options->repair);
  requireFraction(app->add_option("--max-error", options->maxError,
                                  "Exit code 5 if the last level sticks out by more than this fraction of "
                                  "the bounding box diagonal"));
  app->add_flag("--json", options->json, "Print JSON instead of the table");
  addReports(*app, options->reports);
  addForce(*app, options->overwrite);
  addThreads(*app, options->threads);
  app->footer("Example: spheretree eval bunny.obj classic-bunny.sph --frame box-centred");
  return {app, [options] { return runEval(*options); }};
}

}  // namespace spheretree::cli
