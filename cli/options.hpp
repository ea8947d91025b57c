// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "builders/settings.hpp"
#include "cli/console.hpp"
#include "io/files.hpp"
#include "io/mesh_repair.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
class Option;
}  // namespace CLI

namespace spheretree::cli {

// Options that several subcommands share. Every function binds to a variable that must outlive the parser
// and already holds the default, which is what the help shows. Options of `--config` files are marked
// configurable, all others are not.

/// An enum value and the word for it on the command line.
template <class Enum>
struct Named {
  const char* name = "";
  Enum value{};
};

template <class Enum, std::size_t N>
[[nodiscard]] std::string nameOf(const std::array<Named<Enum>, N>& names, Enum value) {
  for (const Named<Enum>& named : names) {
    if (named.value == value) return named.name;
  }
  return {};
}

/// An option that takes one of a few words, in upper or lower case. `choose` gets the index of the word.
CLI::Option* addChoice(CLI::App& app, const std::string& flag, const std::vector<std::string>& words,
                       std::size_t current, std::function<void(std::size_t)> choose,
                       const std::string& description);

template <class Enum, std::size_t N>
CLI::Option* addChoice(CLI::App& app, const std::string& flag, Enum& target,
                       const std::array<Named<Enum>, N>& names, const std::string& description) {
  std::vector<std::string> words;
  std::size_t current = 0;
  for (std::size_t k = 0; k < N; ++k) {
    words.emplace_back(names[k].name);
    if (names[k].value == target) current = k;
  }
  return addChoice(
      app, flag, words, current, [&target, names](std::size_t k) { target = names[k].value; }, description);
}

/// A `--config` file, which settings came from it, and whether to print them all instead of working.
struct ConfigFile {
  std::string path;  ///< empty: there is none
  std::set<std::string> keys;
  bool print = false;
};

/// Adds `--config` and `--print-config`. To be called before the options that the file may set.
void addConfig(CLI::App& app, ConfigFile& config);

/// The configurable options as `--config` reads them: TOML, one `key=value` a line.
[[nodiscard]] std::string configText(const CLI::App& app);

/// All of BuildSettings.
void addSettings(CLI::App& app, builders::BuildSettings& settings);

/// Refuses settings on the command line that another builder than the chosen one would use, and settings
/// that contradict each other wherever they stand. Throws CLI::ValidationError.
void checkSettings(const CLI::App& app, const builders::BuildSettings& settings, const ConfigFile& config);

CLI::Option* addRepair(CLI::App& app, io::Repair& rule);
CLI::Option* addThreads(CLI::App& app, unsigned& threads);
/// A whole number between `least` and `most`.
CLI::Option* addCount(CLI::App& app, const std::string& flag, std::size_t& target, std::size_t least,
                      std::size_t most, const std::string& description);

/// `--jobs`: how many assets at once.
CLI::Option* addJobs(CLI::App& app, unsigned& jobs);
CLI::Option* addForce(CLI::App& app, io::Overwrite& overwrite);

/// `--report FILE.json|FILE.csv`, repeatable.
CLI::Option* addReports(CLI::App& app, std::vector<std::string>& reports);

using io::endingOf;

/// A value in [0, 1].
CLI::Option* requireFraction(CLI::Option* option);

/// `-q` and `-v`.
void addVerbosity(CLI::App& app, Verbosity& verbosity);

}  // namespace spheretree::cli
