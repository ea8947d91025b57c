// SPDX-License-Identifier: GPL-3.0-or-later
//
// A configuration file is flat: a setting a line, the same names as on the command line, so that one file
// serves every subcommand that builds. CLI11's own set_config() wants a section per subcommand and reads the
// file with the program's options only; the few lines below use its TOML reader instead.
#include "cli/options.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

#include <CLI/CLI.hpp>

#include "builders/catalogue.hpp"
#include "builders/settings_use.hpp"
#include "io/html_pages.hpp"
#include "io/report_parts.hpp"

namespace spheretree::cli {
namespace {

using builders::BuildSettings;
using builders::SettingLimits;

constexpr std::array kCoverNames{Named<builders::Cover>{"surface", builders::Cover::Surface},
                                 Named<builders::Cover>{"solid", builders::Cover::Solid}};
constexpr std::array kQualityNames{Named<builders::Quality>{"fast", builders::Quality::Fast},
                                   Named<builders::Quality>{"normal", builders::Quality::Normal},
                                   Named<builders::Quality>{"best", builders::Quality::Best}};
constexpr std::array kObjectiveNames{Named<builders::Objective>{"worst", builders::Objective::Worst},
                                     Named<builders::Objective>{"mean", builders::Objective::Mean},
                                     Named<builders::Objective>{"volume", builders::Objective::Volume}};
constexpr std::array kToggleNames{Named<builders::Toggle>{"auto", builders::Toggle::Auto},
                                  Named<builders::Toggle>{"on", builders::Toggle::On},
                                  Named<builders::Toggle>{"off", builders::Toggle::Off}};
constexpr std::array kRepairRules{io::Repair::Off, io::Repair::Orient, io::Repair::Fill, io::Repair::Wrap,
                                  io::Repair::Auto};
constexpr unsigned kMostThreads = 1024;  // more than any machine has; stops a slip of the finger
// Far beyond what helps: another two slips of the finger.
constexpr std::uint32_t kMostSamples = 10'000'000;
constexpr std::uint32_t kMostOrientations = 100'000;
constexpr std::uint32_t kMostAxisBalls = 1'000'000;

/// A whole number between `least` and `most`, which the help shows. (CLI11's own conversion takes -1 for the
/// largest number there is.)
template <class Number>
CLI::Option* addNumber(CLI::App& app, const std::string& flag, Number& target, Number least, Number most,
                       const std::string& description) {
  const std::string top = most == std::numeric_limits<Number>::max() ? "2^64-1" : std::to_string(most);
  const std::string range = "[" + std::to_string(least) + ", " + top + "]";
  const auto whyNot = [least, most, range](const std::string& text) {
    Number value{};
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool whole = code == std::errc{} && end == text.data() + text.size();
    return whole && value >= least && value <= most ? std::string()
                                                    : "'" + text + "' is not a whole number in " + range;
  };
  return app.add_option(flag, target, description)
      ->type_name("N in " + range)
      ->check(whyNot)
      ->capture_default_str();
}

/// A setting that some builds do not look at.
struct OwnSetting {
  const char* name;
  const char* owners;  ///< in words, for the sentence that refuses it
  bool (*used)(const BuildSettings&);
};

bool usesReducer(const BuildSettings& settings, std::string_view reducer) {
  const std::vector<std::string_view> names = builders::reducersInUse(settings);
  return std::find(names.begin(), names.end(), reducer) != names.end();
}
bool usesReducers(const BuildSettings& settings) {
  return !builders::reducersInUse(settings).empty();
}
bool usesHubbard(const BuildSettings& settings) {
  return usesReducer(settings, "hubbard");
}
bool usesGrid(const BuildSettings& settings) {
  return usesReducer(settings, "grid");
}
bool isCombined(const BuildSettings& settings) {
  return settings.builder == "combined";
}

constexpr const char* kWithReducers = "builders with reducers";
constexpr const char* kOnAxis = "merge, burst and expand";
constexpr std::array kOwnSettings{OwnSetting{"quality", kWithReducers, &usesReducers},
                                  OwnSetting{"objective", kWithReducers, &usesReducers},
                                  OwnSetting{"refine", kWithReducers, &usesReducers},
                                  OwnSetting{"link", kWithReducers, &usesReducers},
                                  OwnSetting{"reducers", "combined", &isCombined},
                                  OwnSetting{"axis-error", kOnAxis, &builders::usesAxis},
                                  OwnSetting{"axis-balls", kOnAxis, &builders::usesAxis},
                                  OwnSetting{"samples", "hubbard", &usesHubbard},
                                  OwnSetting{"orientations", "grid", &usesGrid}};

/// How the builder was asked for, as far as it matters to a setting of another one.
std::string chosenBuilder(const BuildSettings& settings) {
  if (!isCombined(settings)) return settings.builder;
  std::string names;
  for (const std::string_view name : builders::reducersInUse(settings))
    names += (names.empty() ? "" : ",") + std::string(name);
  return "combined of " + names;
}

/// "section.key", or "[section]" for the items that stand for its beginning and its end.
std::string nameOf(const CLI::ConfigItem& item) {
  if (item.name != "++" && item.name != "--") return item.fullname();
  return "[" + CLI::detail::join(item.parents, ".") + "]";
}

void readConfig(CLI::App& app, ConfigFile& config, const std::string& path) {
  config.path = path;
  const Result<std::string> text = io::readFile(path);
  if (!text) throw CLI::FileError(text.error().message);
  std::istringstream stream(text.value());
  for (const CLI::ConfigItem& item : CLI::ConfigTOML().from_config(stream)) {
    CLI::Option* option = item.parents.empty() ? app.get_option_no_throw("--" + item.name) : nullptr;
    if (option == nullptr || !option->get_configurable()) {
      throw CLI::ConfigError(path + ": there is no setting '" + nameOf(item) + "' for " + app.get_name());
    }
    if (!config.keys.insert(item.name).second) {
      throw CLI::ConfigError(path + ": the setting '" + item.name + "' is given twice");
    }
    // A list is one value here, as on the command line, which wins.
    if (option->empty()) option->add_result(CLI::detail::join(item.inputs, ","));
  }
}

std::string whyNoReport(const std::string& path) {
  const std::string ending = io::endingOf(path);
  if (ending == ".json" || ending == ".csv") return {};
  if (ending == ".html") return io::whyNoHtml().empty() ? "" : path + ": " + io::whyNoHtml();
  return path + ": a report is written as .json, .csv or .html, not as " +
         (ending.empty() ? "a file without ending" : ending);
}

std::string whyNoFraction(const std::string& text) {
  double value = -1;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool number = code == std::errc{} && end == text.data() + text.size();
  if (number && value >= 0 && value <= 1) return {};
  return "'" + text + "' is not a fraction in [0, 1]";
}

std::string whyNotPositive(const std::string& text) {
  double value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool number = code == std::errc{} && end == text.data() + text.size();
  if (number && value > 0 && std::isfinite(value)) return {};
  return "'" + text + "' is not a number above 0";
}

/// The words of a list, in lower case and without the blanks around them.
std::vector<std::string> wordsOf(const std::string& list) {
  std::vector<std::string> words = CLI::detail::split(list, ',');
  for (std::string& word : words) word = io::lowerCase(CLI::detail::trim_copy(word));
  return words;
}

CLI::Option* addReducers(CLI::App& app, std::vector<std::string>& reducers) {
  const auto choose = [&reducers](const std::string& list) { reducers = wordsOf(list); };
  const auto check = [](const std::string& list) {
    const std::vector<std::string> words = wordsOf(list);
    if (const std::string reason = builders::whyNoReducers(words); !reason.empty())
      throw CLI::ValidationError(reason);
    return CLI::detail::join(words, ",");
  };
  return app
      .add_option_function<std::string>("--reducers", choose,
                                        "combined: the reducers that compete for every set of balls")
      ->transform(check)
      ->type_name("NAME,..")
      ->default_str(CLI::detail::join(reducers, ","));
}

/// What decides how much is tried for a tree.
void addEffort(CLI::App& app, BuildSettings& settings) {
  const std::vector<CLI::Option*> options = {
      addChoice(app, "--quality", settings.quality, kQualityNames, "How much work goes into the refinement"),
      addChoice(app, "--objective", settings.objective, kObjectiveNames,
                "What is to be small: the worst overhang, the mean one, or the volume of the balls"),
      addChoice(app, "--refine", settings.refine, kToggleNames,
                "Refine what the reducers made; auto: for combined only"),
      addChoice(app, "--link", settings.link, kToggleNames,
                "Refine a level as one, across the seams of the level above; needs refine; auto: for "
                "combined only")};
  for (CLI::Option* option : options) option->configurable()->group("Tree");
}

/// Settings of one builder, or of a few.
void addOwnSettings(CLI::App& app, BuildSettings& settings) {
  const std::vector<CLI::Option*> own = {
      addReducers(app, settings.combined.reducers),
      app.add_option("--axis-error", settings.axis.error,
                     "merge, burst, expand: refine the medial axis of a region until no ball of it sticks "
                     "out by more than this fraction of what the ball above does")
          ->type_name("NUMBER above 0")
          ->check(whyNotPositive)
          ->capture_default_str(),
      addNumber(app, "--axis-balls", settings.axis.leastBalls, std::uint32_t{0}, kMostAxisBalls,
                "merge, burst, expand: and until the region has as many balls"),
      addNumber(app, "--samples", settings.hubbard.samples, SettingLimits::kLeastSamples, kMostSamples,
                "hubbard: surface samples for the medial axis; more is tighter and slower"),
      addNumber(app, "--orientations", settings.grid.orientations, std::uint32_t{0}, kMostOrientations,
                "grid: orientations tried per ball besides the axes of the mesh")};
  for (CLI::Option* option : own) option->configurable()->group("Of some builders");
}

}  // namespace

CLI::Option* addChoice(CLI::App& app, const std::string& flag, const std::vector<std::string>& words,
                       std::size_t current, std::function<void(std::size_t)> choose,
                       const std::string& description) {
  const auto chosen = [words, choose = std::move(choose)](const std::string& word) {
    choose(static_cast<std::size_t>(std::find(words.begin(), words.end(), word) - words.begin()));
  };
  CLI::Option* option = app.add_option_function<std::string>(flag, chosen, description);
  option->transform(CLI::IsMember(words, CLI::ignore_case).description(""));
  std::string type;
  for (const std::string& word : words) type += (type.empty() ? "" : "|") + word;
  option->type_name(type);
  option->default_str(words.at(current));
  return option;
}

void addConfig(CLI::App& app, ConfigFile& config) {
  app.add_option_function<std::string>(
         "--config", [&app, &config](const std::string& path) { readConfig(app, config, path); },
         "Read settings from FILE, as --print-config writes it; options given here win")
      ->type_name("FILE")
      ->configurable(false);
  app.add_flag_callback(
         "--print-config",
         [&app, &config] {
           config.print = true;
           for (CLI::Option* option : app.get_options({})) option->required(false);
         },
         "Print the settings that would be used and end")
      ->configurable(false);
}

std::string configText(const CLI::App& app) {
  return CLI::ConfigTOML().to_config(&app, true, false, "");
}

void addSettings(CLI::App& app, BuildSettings& settings) {
  std::vector<std::string> names;
  std::size_t current = 0;
  for (const builders::CatalogueEntry& entry : builders::catalogue()) {
    if (entry.name == settings.builder) current = names.size();
    names.emplace_back(entry.name);
  }
  const auto choose = [&settings, names](std::size_t k) { settings.builder = names[k]; };
  const std::vector<CLI::Option*> options = {
      addChoice(app, "--builder", names, current, choose, "How the balls are made (spheretree list)"),
      addNumber(app, "--branch", settings.branch, SettingLimits::kLeastBranch, SettingLimits::kMostBranch,
                "Most children of a ball"),
      addNumber(app, "--levels", settings.levels, std::uint32_t{1}, SettingLimits::kMostLevels,
                "Levels of the tree, the root included"),
      requireFraction(
          app.add_option("--max-error", settings.maxError,
                         "Do not refine balls that stick out by at most this fraction of the bounding box "
                         "diagonal; exit code 5 if the last level does not get there. 0 refines all")
              ->capture_default_str()),
      addChoice(app, "--cover", settings.cover, kCoverNames,
                "What every level covers: the surface, or all of the solid"),
      addNumber(app, "--seed", settings.seed, std::uint64_t{0}, std::numeric_limits<std::uint64_t>::max(),
                "Feeds every random choice: same seed, same bytes")};
  for (CLI::Option* option : options) option->configurable()->group("Tree");
  addEffort(app, settings);
  addOwnSettings(app, settings);
}

void checkSettings(const CLI::App& app, const BuildSettings& settings, const ConfigFile& config) {
  for (const OwnSetting& own : kOwnSettings) {
    const std::string flag = std::string("--") + own.name;
    const bool typed = app.count(flag) > 0 && config.keys.count(own.name) == 0;
    if (typed && !own.used(settings)) {
      throw CLI::ValidationError(
          flag, std::string("belongs to ") + own.owners + ", not " + chosenBuilder(settings));
    }
  }
  if (const std::string reason = builders::whyInvalid(settings); !reason.empty())
    throw CLI::ValidationError(reason);
}

CLI::Option* addRepair(CLI::App& app, io::Repair& rule) {
  std::vector<std::string> words;
  std::size_t current = 0;
  for (const io::Repair candidate : kRepairRules) {
    if (candidate == rule) current = words.size();
    words.push_back(io::repairName(candidate));
  }
  const auto choose = [&rule](std::size_t k) { rule = kRepairRules.at(k); };
  CLI::Option* option = addChoice(app, "--repair", words, current, choose,
                                  "What may be done to a mesh that does not bound a solid; auto is the first "
                                  "of the others that helps");
  return option->configurable(false);
}

CLI::Option* addThreads(CLI::App& app, unsigned& threads) {
  CLI::Option* option =
      addNumber(app, "--threads", threads, 0U, kMostThreads, "Threads; 0 takes all. Never changes a result");
  return option->configurable(false);
}

CLI::Option* addCount(CLI::App& app, const std::string& flag, std::size_t& target, std::size_t least,
                      std::size_t most, const std::string& description) {
  return addNumber(app, flag, target, least, most, description)->configurable(false);
}

CLI::Option* addJobs(CLI::App& app, unsigned& jobs) {
  CLI::Option* option = addNumber(app, "--jobs", jobs, 0U, kMostThreads,
                                  "Assets at once; 0: as many as threads. Never changes a result");
  return option->configurable(false);
}

CLI::Option* addForce(CLI::App& app, io::Overwrite& overwrite) {
  return app
      .add_flag_callback(
          "--force", [&overwrite] { overwrite = io::Overwrite::Replace; }, "Replace outputs that exist")
      ->configurable(false);
}

CLI::Option* addReports(CLI::App& app, std::vector<std::string>& reports) {
  return app
      .add_option("--report", reports, "Also write a report, .json or .csv; may be given several times")
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->check(whyNoReport)
      ->configurable(false);
}

CLI::Option* requireFraction(CLI::Option* option) {
  return option->type_name("FRACTION in [0, 1]")->check(whyNoFraction);
}

void addVerbosity(CLI::App& app, Verbosity& verbosity) {
  CLI::Option* quiet = app.add_flag_callback(
      "-q,--quiet", [&verbosity] { verbosity = Verbosity::Quiet; }, "Print nothing but warnings and errors");
  CLI::Option* verbose = app.add_flag_callback(
      "-v,--verbose", [&verbosity] { verbosity = Verbosity::Verbose; }, "Say on standard error what is done");
  quiet->excludes(verbose)->configurable(false)->option_text(" ");
  verbose->configurable(false)->option_text(" ");
}

}  // namespace spheretree::cli
