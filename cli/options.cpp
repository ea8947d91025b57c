// SPDX-License-Identifier: GPL-3.0-or-later
//
// A configuration file is flat: a setting a line, the same names as on the command line, so that one file
// serves every subcommand that builds. CLI11's own set_config() wants a section per subcommand and reads the
// file with the program's options only; the few lines below use its TOML reader instead.
#include "cli/options.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <sstream>
#include <system_error>
#include <utility>

#include <CLI/CLI.hpp>

#include "builders/catalogue.hpp"
#include "io/report_parts.hpp"

namespace spheretree::cli {
namespace {

using builders::BuildSettings;
using builders::SettingLimits;

constexpr std::array kCoverNames{Named<builders::Cover>{"surface", builders::Cover::Surface},
                                 Named<builders::Cover>{"solid", builders::Cover::Solid}};
constexpr std::array kRepairRules{io::Repair::Off, io::Repair::Orient, io::Repair::Fill, io::Repair::Wrap,
                                  io::Repair::Auto};
constexpr unsigned kMostThreads = 1024;  // more than any machine has; stops a slip of the finger
// Far beyond what helps: another two slips of the finger.
constexpr std::uint32_t kMostSamples = 10'000'000;
constexpr std::uint32_t kMostOrientations = 100'000;

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

/// Only one builder looks at these.
struct OwnSetting {
  const char* name;
  const char* builder;
};
constexpr std::array kOwnSettings{OwnSetting{"samples", "hubbard"}, OwnSetting{"orientations", "grid"}};

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
    if (option->empty()) option->add_result(item.inputs);  // the command line wins
  }
}

std::string whyNoReport(const std::string& path) {
  const std::string ending = endingOf(path);
  if (ending == ".json" || ending == ".csv") return {};
  return path + ": a report is written as .json or .csv, not as " +
         (ending.empty() ? "a file without ending" : ending);
}

std::string whyNoFraction(const std::string& text) {
  double value = -1;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool number = code == std::errc{} && end == text.data() + text.size();
  if (number && value >= 0 && value <= 1) return {};
  return "'" + text + "' is not a fraction in [0, 1]";
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
  const std::vector<CLI::Option*> own = {
      addNumber(app, "--samples", settings.hubbard.samples, SettingLimits::kLeastSamples, kMostSamples,
                "hubbard: surface samples for the medial axis; more is tighter and slower"),
      addNumber(app, "--orientations", settings.grid.orientations, std::uint32_t{0}, kMostOrientations,
                "grid: orientations tried per ball besides the axes of the mesh")};
  for (CLI::Option* option : own) option->configurable()->group("Of one builder");
}

void checkSettings(const CLI::App& app, const BuildSettings& settings, const ConfigFile& config) {
  for (const OwnSetting& own : kOwnSettings) {
    const std::string flag = std::string("--") + own.name;
    const bool typed = app.count(flag) > 0 && config.keys.count(own.name) == 0;
    if (typed && settings.builder != own.builder) {
      throw CLI::ValidationError(
          flag, std::string("belongs to --builder ") + own.builder + ", not " + settings.builder);
    }
  }
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

std::string endingOf(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return ending;
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
