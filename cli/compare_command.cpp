// SPDX-License-Identifier: GPL-3.0-or-later
//
// spheretree compare: every builder on one mesh (docs/compare.md).
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "builders/catalogue.hpp"
#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/interrupt.hpp"
#include "cli/options.hpp"
#include "cli/outputs.hpp"
#include "cli/progress_bar.hpp"
#include "cli/solid_input.hpp"
#include "cli/text_table.hpp"
#include "io/compare.hpp"
#include "io/html_pages.hpp"
#include "io/report_parts.hpp"

namespace spheretree::cli {
namespace {

namespace fs = std::filesystem;
using builders::Quality;

constexpr std::array kQualities{Quality::Fast, Quality::Normal, Quality::Best};
constexpr std::size_t kMostPoses = 10'000'000;
constexpr int kSecondsDigits = 3;
constexpr int kPercentDigits = 3;
constexpr int kCostDigits = 3;

struct CompareCommandOptions {
  std::string mesh;
  io::CompareOptions compare;
  std::vector<std::string> reports;
  io::Repair repair = io::Repair::Auto;
  io::Overwrite overwrite = io::Overwrite::Refuse;
  Verbosity verbosity = Verbosity::Normal;
  unsigned threads = 0;
  ConfigFile config;
};

/// "512: 2.96 % 1.1 us *", the last for rows that no other row beats on that level.
std::string levelText(const io::ComparedLevel& level, double diagonal) {
  constexpr double kPercent = 100;
  std::string text = std::to_string(level.metrics.spheres) + ": " +
                     shortNumber(kPercent * level.metrics.overhangWorst.upper / diagonal, kPercentDigits) +
                     " %";
  if (level.cost) text += " " + shortNumber(level.cost->microseconds, kCostDigits) + " us";
  return text + (level.nonDominated ? " *" : "  ");
}

std::string table(const std::vector<io::ComparedRow>& rows, double diagonal) {
  using Align = TextTable::Align;
  std::size_t levels = 0;
  for (const io::ComparedRow& row : rows) levels = std::max(levels, row.levels.size());
  std::vector<TextTable::Column> columns{{"builder", Align::Left}, {"seconds"}, {"spheres"}};
  for (std::size_t k = 1; k < levels; ++k) columns.push_back({"level " + std::to_string(k) + "  "});
  TextTable text(std::move(columns));
  std::string failures;
  for (const io::ComparedRow& row : rows) {
    if (!row.reason.empty()) {
      failures += row.contender.name + " failed: " + row.reason + "\n";
      continue;
    }
    std::vector<std::string> cells{row.contender.name, shortNumber(row.buildSeconds, kSecondsDigits),
                                   std::to_string(row.spheres)};
    for (std::size_t k = 1; k < levels; ++k)
      cells.push_back(k < row.levels.size() ? levelText(row.levels[k], diagonal) : "-  ");
    text.add(std::move(cells));
  }
  return "spheres: worst overhang in % of the diagonal, microseconds per close pair\n" + text.text() +
         "* no other row has as few spheres, as small an overhang and as short a build on that level\n" +
         failures;
}

Result<std::string> reportText(const std::string& path, const std::string& json) {
  const std::string ending = endingOf(path);
  if (ending == ".csv") return io::comparisonCsv(json);
  if (ending == ".html") return io::comparePage(json);
  return json;
}

Result<std::vector<Output>> format(const std::string& json, const CompareCommandOptions& options) {
  std::vector<Output> outputs;
  for (const std::string& report : options.reports) {
    Result<std::string> text = reportText(report, json);
    if (!text) return Error{text.error().code, report + ": " + text.error().message};
    outputs.push_back({report, std::move(*text)});
  }
  return outputs;
}

ExitCode runCompare(const CompareCommandOptions& options) {
  std::vector<fs::path> inputs{options.mesh};
  if (!options.config.path.empty()) inputs.emplace_back(options.config.path);
  const std::vector<fs::path> reports(options.reports.begin(), options.reports.end());
  if (const Result<Done> free = checkOutputs(inputs, reports, options.overwrite); !free)
    return fail(free.error());
  ProgressBar bar(options.verbosity);
  medial::Context context(options.threads, bar.callback());
  const Result<SolidInput> input = readSolid(options.mesh, options.repair, Frame::Mesh, context);
  bar.wipe();
  if (!input) return fail(input.error());
  if (const std::string sentence = shapeWarning(input->provenance); !sentence.empty()) warn(sentence);

  const CancelOnInterrupt interruptible(context);
  const Result<std::vector<io::ComparedRow>> rows =
      io::compareBuilders(input->surface, options.compare, context);
  bar.wipe();
  if (!rows) return fail({rows.error().code, options.mesh + ": " + rows.error().message});
  const std::string json = io::formatComparison(*rows, options.compare, input->provenance, context.threads());
  const Result<std::vector<Output>> outputs = format(json, options);
  if (!outputs) return fail(outputs.error());
  if (const Result<Done> written = writeOutputs(*outputs, options.overwrite); !written)
    return fail(written.error());
  if (options.verbosity != Verbosity::Quiet) {
    print(describeMesh(input->provenance) + table(*rows, input->surface.diagonal()));
    for (const std::string& report : options.reports) print("wrote " + report + "\n");
  }
  const bool failed =
      std::any_of(rows->begin(), rows->end(), [](const io::ComparedRow& row) { return !row.reason.empty(); });
  return failed ? ExitCode::OurFault : ExitCode::Done;
}

/// `--builders`, `--qualities`: words out of a list, or `all`.
void addWords(CLI::App& app, const std::string& flag, const std::vector<std::string>& words,
              std::function<void(const std::vector<std::string>&)> choose, const std::string& description) {
  const auto chosen = [words](const std::string& list) {
    std::vector<std::string> names;
    for (const std::string& part : CLI::detail::split(list, ','))
      names.push_back(io::lowerCase(CLI::detail::trim_copy(part)));
    return names == std::vector<std::string>{"all"} ? words : names;
  };
  const auto whyNot = [words, chosen](const std::string& list) {
    for (const std::string& name : chosen(list)) {
      if (std::find(words.begin(), words.end(), name) == words.end())
        return "'" + name + "' is none of all, " + CLI::detail::join(words, ", ");
    }
    return std::string();
  };
  app.add_option_function<std::string>(
         flag, [chosen, choose = std::move(choose)](const std::string& list) { choose(chosen(list)); },
         description)
      ->check(whyNot)
      ->type_name("NAME,..")
      ->default_str("all")
      ->configurable(false);
}

void addContenders(CLI::App& app, io::CompareOptions& compare) {
  std::vector<std::string> names;
  for (const builders::CatalogueEntry& entry : builders::catalogue()) names.emplace_back(entry.name);
  compare.builders = names;
  addWords(
      app, "--builders", names, [&compare](const auto& chosen) { compare.builders = chosen; },
      "The builders to compare (spheretree list)");
  compare.qualities = {kQualities.begin(), kQualities.end()};
  std::vector<std::string> qualities;
  for (const Quality quality : kQualities) qualities.push_back(io::qualityName(quality));
  const auto choose = [&compare](const std::vector<std::string>& chosen) {
    compare.qualities.clear();
    for (const Quality quality : kQualities) {
      if (std::find(chosen.begin(), chosen.end(), io::qualityName(quality)) != chosen.end())
        compare.qualities.push_back(quality);
    }
  };
  addWords(app, "--qualities", qualities, choose, "The qualities of the builders that refine");
  addCount(app, "--poses", compare.poses, 0, kMostPoses, "Close poses that queries are timed on");
}

}  // namespace

Command setupCompare(CLI::App& program) {
  const auto options = std::make_shared<CompareCommandOptions>();
  CLI::App* app =
      program.add_subcommand("compare", "Build a mesh with every builder: time, errors, runtime cost");
  addConfig(*app, options->config);
  addSettings(*app, options->compare.settings);
  // These two are what is compared.
  for (const char* name : {"--builder", "--quality"}) app->remove_option(app->get_option(name));
  app->add_option("MESH", options->mesh, "Mesh to read")->option_text(" ")->required()->configurable(false);
  addContenders(*app, options->compare);
  addRepair(*app, options->repair)->configurable()->group("Mesh");
  addReports(*app, options->reports)->group("Output");
  addForce(*app, options->overwrite)->group("Output");
  addThreads(*app, options->threads)->configurable()->group("Run");
  addVerbosity(*app, options->verbosity);
  app->footer("Example: spheretree compare bunny.obj --qualities fast,normal --report bunny.html");
  return {app, [app, options] {
            if (!options->config.print) return runCompare(*options);
            print(configText(*app));
            return ExitCode::Done;
          }};
}

}  // namespace spheretree::cli
