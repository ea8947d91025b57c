// SPDX-License-Identifier: GPL-3.0-or-later
//
// spheretree batch: many meshes become trees (docs/batch.md). What it does is io's; here is what it is told
// and what it says.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/interrupt.hpp"
#include "cli/options.hpp"
#include "cli/outputs.hpp"
#include "cli/progress_bar.hpp"
#include "cli/solid_input.hpp"
#include "cli/text_table.hpp"
#include "io/batch_plan.hpp"
#include "io/batch_run.hpp"
#include "io/batch_summary.hpp"
#include "io/html_pages.hpp"

namespace spheretree::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kErrorDigits = 4;    // of an error in a sentence
constexpr int kSecondsDigits = 3;  // of a time in a sentence
constexpr std::uint32_t kMostShards = 1'000'000;
constexpr double kMostSeconds = 1e9;  // 30 years

enum class Deed : std::uint8_t { Build, Forecast };

struct BatchCommandOptions {
  io::BatchRequest request;
  io::BatchOptions batch;
  std::vector<std::string> merge;
  std::vector<std::string> summaries;
  std::string folder;
  Deed deed = Deed::Build;
  Verbosity verbosity = Verbosity::Normal;
  ConfigFile config;
};

// --- summaries ---

std::string summaryStem(const BatchCommandOptions& options) {
  const auto& shard = options.request.shard;
  if (!shard) return "summary";
  return "summary-" + std::to_string(shard->index) + "-of-" + std::to_string(shard->count);
}

std::vector<fs::path> summaryPaths(const BatchCommandOptions& options) {
  if (!options.summaries.empty()) return {options.summaries.begin(), options.summaries.end()};
  std::vector<fs::path> paths;
  for (const char* ending : {".json", ".csv", ".html"}) {
    if (std::string_view(ending) == ".html" && !io::whyNoHtml().empty()) continue;
    paths.push_back(fs::path(options.folder) / (summaryStem(options) + ending));
  }
  return paths;
}

Result<std::string> summaryText(const fs::path& path, const std::string& json, const fs::path& folder) {
  const std::string ending = endingOf(path);
  if (ending == ".csv") return io::summaryCsv(json);
  if (ending == ".html") return io::batchPage(json, io::summaryThumbnails(json, folder));
  return json;
}

Result<Done> checkSummaries(const BatchCommandOptions& options) {
  for (const fs::path& path : summaryPaths(options)) {
    if (options.batch.overwrite == io::Overwrite::Replace) break;
    const Result<Done> free = io::checkSummaryPlace(path);
    if (!free) return Error{free.error().code, free.error().message + "; --force replaces it"};
  }
  return Done{};
}

Result<Done> writeSummaries(const BatchCommandOptions& options, const std::string& json) {
  std::vector<Output> outputs;
  for (const fs::path& path : summaryPaths(options)) {
    Result<std::string> text = summaryText(path, json, options.folder);
    if (!text) return Error{text.error().code, path.string() + ": " + text.error().message};
    outputs.push_back({path, std::move(*text)});
  }
  return writeOutputs(outputs, io::Overwrite::Replace);
}

// --- progress ---

std::string clockText(double seconds) {
  constexpr long kMinute = 60;
  constexpr long kHour = 60 * kMinute;
  const long whole = std::lround(std::min(seconds, kMostSeconds));
  const auto two = [](long value) { return (value < 10 ? "0" : "") + std::to_string(value); };
  const std::string tail = two(whole / kMinute % kMinute) + ":" + two(whole % kMinute);
  return whole < kHour ? tail : std::to_string(whole / kHour) + ":" + tail;
}

/// "123/500, 2.1/s, 03:10 left, 4 failed"
std::string progressNote(const io::BatchProgress& progress) {
  std::string note = std::to_string(progress.settled) + "/" + std::to_string(progress.assets);
  const auto built = static_cast<double>(progress.settled - progress.skipped);
  if (built > 0 && progress.seconds > 0) note += ", " + shortNumber(built / progress.seconds, 2) + "/s";
  if (progress.workDone > 0)
    note += ", " + clockText(progress.seconds * (progress.work - progress.workDone) / progress.workDone) +
            " left";
  if (progress.failed > 0) note += ", " + std::to_string(progress.failed) + " failed";
  return note;
}

/// What is said about an asset as soon as it is settled.
std::string describe(const io::BatchAsset& asset, const io::AssetOutcome& outcome) {
  if (outcome.record.state == io::AssetState::Failed) return "failed: " + outcome.record.reason;
  std::string text = asset.output + ": " + io::stateName(outcome.record.state);
  if (outcome.action == io::AssetAction::Skipped) return text + " before";
  if (outcome.cost) text += ", " + shortNumber(outcome.cost->seconds, kSecondsDigits) + " s";
  if (!outcome.record.reason.empty()) text += ", " + outcome.record.reason;
  return text;
}

/// A line for every asset that was worked on; skipped ones only when the user wants to hear all.
class Reporter {
 public:
  explicit Reporter(Verbosity verbosity) : verbosity_(verbosity), bar_(verbosity) {}

  io::BatchObserver observer() {
    return {[this](const io::BatchAsset& asset, const io::AssetOutcome& outcome,
                   const io::BatchProgress& progress) { settled(asset, outcome, progress); },
            [this](const io::BatchProgress& progress) { draw(progress); }};
  }
  void wipe() { bar_.wipe(); }

 private:
  void settled(const io::BatchAsset& asset, const io::AssetOutcome& outcome,
               const io::BatchProgress& progress) {
    const bool failed = outcome.record.state == io::AssetState::Failed;
    const bool skipped = outcome.action == io::AssetAction::Skipped;
    const bool plain = verbosity_ != Verbosity::Quiet && !bar_.shown();
    const bool wanted = (failed && !skipped) || verbosity_ == Verbosity::Verbose || (plain && !skipped);
    if (wanted) {
      bar_.wipe();
      remark("[" + std::to_string(progress.settled) + "/" + std::to_string(progress.assets) + "] " +
             describe(asset, outcome));
    }
    draw(progress);
  }

  void draw(const io::BatchProgress& progress) {
    if (!bar_.shown()) return;
    bar_.draw("batch", progress.work > 0 ? progress.workDone / progress.work : 0, progressNote(progress));
  }

  Verbosity verbosity_;
  ProgressBar bar_;
};

// --- results ---

std::string totalsLine(const io::BatchTotals& totals) {
  std::string text = counted(totals.assets, "asset", "assets") + ": " + std::to_string(totals.done) + " done";
  if (totals.missed > 0) text += ", " + std::to_string(totals.missed) + " missed the error asked for";
  if (totals.failed > 0) text += ", " + std::to_string(totals.failed) + " failed";
  if (totals.pending > 0) text += ", " + std::to_string(totals.pending) + " not tried";
  return text;
}

ExitCode exitCodeOf(const io::BatchTotals& totals) {
  if (totals.failed > 0 || totals.pending > 0) return ExitCode::SomeFailed;
  return totals.missed > 0 ? ExitCode::ErrorBoundMissed : ExitCode::Done;
}

std::string resultText(const io::BatchPlan& plan, const io::BatchResult& result,
                       const io::BatchTotals& totals, const BatchCommandOptions& options) {
  std::string text;
  std::size_t skipped = 0;
  for (std::size_t k = 0; k < plan.assets.size(); ++k) {
    const io::AssetOutcome& outcome = result.outcomes[k];
    skipped += outcome.action == io::AssetAction::Skipped ? 1U : 0U;
    if (!outcome.record.reason.empty()) {
      const bool failed = outcome.record.state == io::AssetState::Failed;
      text += io::stateName(outcome.record.state) + ": " + (failed ? "" : plan.assets[k].output + ": ") +
              outcome.record.reason + "\n";
    }
  }
  text += totalsLine(totals);
  if (skipped > 0) text += ", " + std::to_string(skipped) + " of them skipped: nothing changed";
  text += "\n";
  for (const fs::path& path : summaryPaths(options)) text += "wrote " + path.string() + "\n";
  return text;
}

// --- deeds ---

std::string megabytes(std::uint64_t bytes) {
  constexpr std::uint64_t kMegabyte = 1'000'000;
  return std::to_string((bytes + kMegabyte - 1) / kMegabyte);
}

ExitCode forecast(const io::BatchPlan& plan, const BatchCommandOptions& options) {
  using Align = TextTable::Align;
  TextTable table({{"", Align::Left},
                   {"input", Align::Left},
                   {"output", Align::Left},
                   {"triangles, about"},
                   {"MB, about"},
                   {"", Align::Left}});
  const std::vector<io::AssetForecast> forecasts = io::forecastBatch(plan, options.batch);
  std::size_t toBuild = 0;
  for (std::size_t k = 0; k < plan.assets.size(); ++k) {
    const io::AssetForecast& look = forecasts[k];
    const bool skip = look.action == io::AssetAction::Skipped;
    const bool builds = !skip && look.reason.empty();
    toBuild += builds ? 1U : 0U;
    table.add({builds ? "build"
               : skip ? "skip"
                      : "fail",
               plan.assets[k].input.string(), plan.assets[k].output, std::to_string(look.triangleGuess),
               megabytes(look.memoryEstimate), look.reason});
  }
  print(table.text());
  print(counted(plan.assets.size(), "asset", "assets") + ", " + std::to_string(toBuild) +
        " to build; nothing was written\n");
  return ExitCode::Done;
}

ExitCode merge(const BatchCommandOptions& options) {
  const Result<std::string> json = io::mergeSummaries({options.merge.begin(), options.merge.end()});
  if (!json) return fail(json.error());
  if (const Result<Done> free = checkSummaries(options); !free) return fail(free.error());
  std::error_code failure;
  fs::create_directories(options.folder, failure);
  if (failure) return fail({ErrorCode::UnwritableOutput, options.folder + ": " + failure.message()});
  if (const Result<Done> written = writeSummaries(options, *json); !written) return fail(written.error());
  const io::BatchTotals totals = io::totalsOf(*json);
  if (options.verbosity != Verbosity::Quiet) {
    print(totalsLine(totals) + "\n");
    for (const fs::path& path : summaryPaths(options)) print("wrote " + path.string() + "\n");
  }
  return exitCodeOf(totals);
}

/// In the process of an asset.
Result<io::BuiltAsset> buildOne(const io::BatchAsset& asset, unsigned threads, io::Pages pages) {
  const medial::Context context(threads);
  const Result<SolidInput> input = readSolid(asset.input, asset.repair, Frame::Mesh, context);
  if (!input) return input.error();
  return io::buildAsset(input->surface, input->provenance, asset, pages, context);
}

ExitCode build(const io::BatchPlan& plan, BatchCommandOptions options) {
  if (const Result<Done> free = checkSummaries(options); !free) return fail(free.error());
  std::error_code failure;
  fs::create_directories(options.folder, failure);
  if (failure) return fail({ErrorCode::UnwritableOutput, options.folder + ": " + failure.message()});
  options.batch.summaries = summaryPaths(options);

  Result<io::BatchJournal> journal = io::BatchJournal::open(options.folder, options.request.shard);
  if (!journal) return fail(journal.error());
  for (const fs::path& path : options.batch.summaries) {
    if (endingOf(path) == ".json") journal->recall(io::costsIn(path));
  }
  medial::Context context(options.batch.limits.threads);
  Reporter reporter(options.verbosity);
  const io::Pages pages = options.batch.pages;
  const auto work = [pages](const io::BatchAsset& asset, unsigned threads) {
    return buildOne(asset, threads, pages);
  };
  Result<io::BatchResult> result = Error{};
  {
    const CancelOnInterrupt interruptible(context);
    result = io::runBatch(plan, options.batch, work, reporter.observer(), *journal, context);
  }
  reporter.wipe();
  if (!result) return fail(result.error());
  const std::string json = io::formatSummary(plan, options.batch, options.request.settings, *result);
  if (const Result<Done> written = writeSummaries(options, json); !written) return fail(written.error());
  journal->remove();
  const io::BatchTotals totals = io::totalsOf(json);
  if (options.verbosity != Verbosity::Quiet) print(resultText(plan, *result, totals, options));
  return exitCodeOf(totals);
}

ExitCode runBatchCommand(const BatchCommandOptions& options) {
  if (!options.merge.empty()) return merge(options);
  const Result<io::BatchPlan> plan = io::planBatch(options.request);
  if (!plan) return fail(plan.error());
  return options.deed == Deed::Forecast ? forecast(*plan, options) : build(*plan, options);
}

// --- options ---

std::string whyNoShard(const std::string& text, io::Shard& shard) {
  const std::size_t slash = text.find('/');
  const auto number = [](const std::string& digits, std::uint32_t& value) {
    const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return code == std::errc{} && end == digits.data() + digits.size();
  };
  const bool read = slash != std::string::npos && number(text.substr(0, slash), shard.index) &&
                    number(text.substr(slash + 1), shard.count);
  if (read && shard.index >= 1 && shard.index <= shard.count && shard.count <= kMostShards) return {};
  return "'" + text + "' is not K/N with K from 1 to N";
}

std::string whyNoSummary(const std::string& path) {
  const std::string ending = endingOf(path);
  if (ending == ".json" || ending == ".csv") return {};
  if (ending == ".html") return io::whyNoHtml().empty() ? "" : path + ": " + io::whyNoHtml();
  return path + ": a summary is written as .json, .csv or .html";
}

std::string whyNoSeconds(const std::string& text) {
  double value = -1;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool number = code == std::errc{} && end == text.data() + text.size();
  if (number && value >= 0 && value <= kMostSeconds) return {};
  return "'" + text + "' is not a number of seconds";
}

void addInputs(CLI::App& app, BatchCommandOptions& options) {
  options.request.endings = io::meshEndings();
  app.add_option("INPUT", options.request.inputs,
                 "Meshes, folders of them, patterns with * ? [] and **, manifests (.json, .csv)")
      ->option_text(" ")
      ->configurable(false);
  app.add_option("--merge-summaries", options.merge,
                 "Join the JSON summaries of all shards into those of the whole; builds nothing")
      ->type_name("FILE.json..")
      ->configurable(false)
      ->group("Shards");
  app.add_option_function<std::string>(
         "--shard",
         [&options](const std::string& text) { whyNoShard(text, options.request.shard.emplace()); },
         "Build every N-th asset only, from the K-th on: for array jobs. Writes summary-K-of-N")
      ->type_name("K/N")
      ->check([](const std::string& text) {
        io::Shard shard;
        return whyNoShard(text, shard);
      })
      ->configurable(false)
      ->group("Shards");
}

void addOutputs(CLI::App& app, BatchCommandOptions& options) {
  app.add_option("-o,--output", options.folder, "Folder to write into, made if missing")
      ->type_name("FOLDER")
      ->required()
      ->configurable(false)
      ->group("Output");
  app.add_option("--summary", options.summaries,
                 "Write this summary, .json, .csv or .html, instead of all three in the folder; may be given "
                 "several times")
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->check(whyNoSummary)
      ->configurable(false)
      ->group("Output");
  app.add_flag_callback(
         "--pages", [&options] { options.batch.pages = io::Pages::With; },
         "Also write an HTML report beside every tree")
      ->configurable(false)
      ->group("Output");
  app.add_flag_callback(
         "--dry-run", [&options] { options.deed = Deed::Forecast; },
         "Say what would be built and what skipped, and end")
      ->configurable(false)
      ->group("Output");
  app.add_flag_callback(
         "--force", [&options] { options.batch.overwrite = io::Overwrite::Replace; },
         "Build everything again, and replace outputs that no batch wrote")
      ->configurable(false)
      ->group("Output");
}

void addLimits(CLI::App& app, BatchCommandOptions& options) {
  io::BatchLimits& limits = options.batch.limits;
  addJobs(app, limits.jobs)->group("Run");
  addThreads(app, limits.threads)->configurable()->group("Run");
  app.add_option(
         "--memory-limit", limits.memoryBytes,
         "Memory of all assets together, such as 8G; 0 takes four fifths of what is free. Large assets "
         "run alone")
      ->transform(CLI::AsSizeValue(false).description(""))
      ->type_name("BYTES")
      ->default_str("0")
      ->configurable(false)
      ->group("Run");
  app.add_option("--timeout", limits.timeoutSeconds, "Give an asset up after so many seconds; 0 never does")
      ->type_name("SECONDS")
      ->check(whyNoSeconds)
      ->capture_default_str()
      ->configurable(false)
      ->group("Run");
  CLI::Option* keep = app.add_flag_callback(
      "--keep-going", [&options] { options.batch.onFailure = io::OnFailure::KeepGoing; },
      "Go on after an asset failed; that is the default");
  CLI::Option* fast = app.add_flag_callback(
      "--fail-fast", [&options] { options.batch.onFailure = io::OnFailure::FailFast; },
      "Stop when an asset fails");
  keep->excludes(fast)->configurable(false)->group("Run");
  fast->configurable(false)->group("Run");
}

void checkBatch(const CLI::App& app, BatchCommandOptions& options) {
  checkSettings(app, options.request.settings, options.config);
  if (options.config.print) return;
  if (options.merge.empty() && options.request.inputs.empty()) throw CLI::RequiredError("INPUT");
  if (!options.merge.empty() && !options.request.inputs.empty())
    throw CLI::ValidationError("--merge-summaries", "takes summaries, and no other input");
  if (options.batch.pages == io::Pages::With && !io::whyNoHtml().empty())
    throw CLI::ValidationError("--pages", io::whyNoHtml());
  options.batch.folder = options.folder;
  options.batch.shard = options.request.shard;
  const bool chosen = app.count("--levels") > 0;
  if (chosen) options.request.levels = options.request.settings.levels;
}

}  // namespace

Command setupBatch(CLI::App& program) {
  const auto options = std::make_shared<BatchCommandOptions>();
  CLI::App* app = program.add_subcommand("batch", "Turn many meshes into sphere trees");
  addConfig(*app, options->config);
  addSettings(*app, options->request.settings);
  addInputs(*app, *options);
  addRepair(*app, options->request.repair)->configurable()->group("Mesh");
  addOutputs(*app, *options);
  addLimits(*app, *options);
  addVerbosity(*app, options->verbosity);
  app->callback([app, options] { checkBatch(*app, *options); });
  app->footer(
      "Example: spheretree batch assets/ -o trees --quality fast\n"
      "Exit code 7: an asset failed, the others are done.");
  return {app, [app, options] {
            if (!options->config.print) return runBatchCommand(*options);
            print(configText(*app));
            return ExitCode::Done;
          }};
}

}  // namespace spheretree::cli
