// SPDX-License-Identifier: GPL-3.0-or-later
//
// builder x quality x model x level as CSV on standard output: spheres, errors, seconds of the build alone
// (median of several), threads, tree hash. Each hash is a proof: repeats and thread counts that give another
// one end the program with code 1. docs/benchmarks.md has the command and what plot_builds.py makes of it.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include <spheretree/version.hpp>

#include "builders/build_tree.hpp"
#include "builders/catalogue.hpp"
#include "builders/settings_use.hpp"
#include "io/mesh_import.hpp"
#include "io/report_parts.hpp"
#include "io/tree_files.hpp"
#include "medial/environment.hpp"
#include "models/shapes.hpp"

namespace {

using namespace spheretree;
using builders::BuildSettings;

constexpr int kDone = 0;
constexpr int kOurFault = 1;
constexpr int kUsage = 2;
constexpr int kUnreadable = 3;
constexpr int kUnsuitable = 4;

constexpr const char* kColumns =
    "model,triangles,builder,reducers,quality,objective,refine,link,threads,level,spheres,worst,mean,"
    "volume_ratio,covered,build_seconds,tree_hash";

/// Lists stand for all their combinations.
struct Options {
  std::vector<std::string> meshes;
  std::vector<std::string> models;
  std::vector<std::string> builders;
  std::vector<builders::Quality> qualities{builders::Quality::Fast, builders::Quality::Normal,
                                           builders::Quality::Best};
  std::vector<builders::Objective> objectives{builders::Objective::Worst};
  std::vector<builders::Toggle> refine{builders::Toggle::Auto};
  std::vector<builders::Toggle> link{builders::Toggle::Auto};
  std::vector<unsigned> threads{1};
  BuildSettings base;
  std::size_t repeats = 3;
};

struct Model {
  std::string name;
  medial::TriangleMesh mesh;
};

/// How a build is named in a row: what it uses, not what it was asked for.
struct Variant {
  BuildSettings settings;
  std::string text;
};

std::string variantText(const BuildSettings& settings) {
  std::string reducers;
  if (settings.builder == "combined") {
    for (const std::string_view name : builders::reducersInUse(settings))
      reducers += (reducers.empty() ? "" : "+") + std::string(name);
  }
  const bool refined = builders::refines(settings);
  return settings.builder + "," + reducers + "," + (refined ? io::qualityName(settings.quality) : "-") + "," +
         (builders::reducersInUse(settings).empty() ? "-" : io::objectiveName(settings.objective)) + "," +
         (refined ? "on" : "off") + "," + (builders::links(settings) ? "on" : "off");
}

/// Every combination that is allowed and makes a difference, in the order asked for.
std::vector<Variant> variantsOf(const Options& options) {
  std::vector<Variant> variants;
  std::set<std::string> known;
  BuildSettings settings = options.base;
  for (const std::string& builder : options.builders) {
    settings.builder = builder;
    for (const builders::Toggle refine : options.refine) {
      settings.refine = refine;
      for (const builders::Toggle link : options.link) {
        settings.link = link;
        for (const builders::Objective objective : options.objectives) {
          settings.objective = objective;
          for (const builders::Quality quality : options.qualities) {
            settings.quality = quality;
            std::string text = variantText(settings);
            if (!builders::whyInvalid(settings).empty() || !known.insert(text).second) continue;
            variants.push_back({settings, std::move(text)});
          }
        }
      }
    }
  }
  return variants;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Rows of one model and variant, for every number of threads. False when two builds differ.
bool bench(const std::string& name, const medial::Surface& surface, const Variant& variant,
           const Options& options) {
  std::string hash;
  for (const unsigned threads : options.threads) {
    std::fprintf(stderr, "%s %s, %u threads\n", name.c_str(), variant.text.c_str(), threads);
    const medial::Context context(threads);
    std::vector<double> seconds;
    std::vector<builders::LevelReport> levels;
    for (std::size_t repeat = 0; repeat < options.repeats; ++repeat) {
      const auto built = builders::buildTree(surface, variant.settings, context);
      if (!built) {
        std::fprintf(stderr, "build_bench: %s: %s\n", name.c_str(), built.error().message.c_str());
        return false;
      }
      seconds.push_back(built->report.stages.front().seconds);
      levels = built->report.levels;
      const std::string now = io::treeHash(built->tree);
      if (!hash.empty() && hash != now) {
        std::fprintf(stderr, "build_bench: %s: the same settings gave two trees\n", name.c_str());
        return false;
      }
      hash = now;
    }
    for (std::size_t depth = 0; depth < levels.size(); ++depth) {
      const builders::LevelMetrics& m = levels[depth].metrics;
      std::printf("%s,%zu,%s,%u,%zu,%zu,%.6f,%.6f,%.4f,%s,%.4f,%s\n", name.c_str(),
                  surface.mesh().triangles.size(), variant.text.c_str(), threads, depth, m.spheres,
                  m.overhangWorst.upper / surface.diagonal(), m.overhangMean / surface.diagonal(),
                  m.volumeRatio, m.surface.certified ? "yes" : "no", median(seconds), hash.c_str());
    }
    std::fflush(stdout);
  }
  return true;
}

/// What it ran on, as far as the machine says so.
std::string machine() {
  std::ifstream info("/proc/cpuinfo");
  std::string name = "unknown processor";
  for (std::string line; std::getline(info, line);) {
    if (line.rfind("model name", 0) != 0) continue;
    name = line.substr(line.find(':') + 2);
    break;
  }
  return name + ", " + std::to_string(std::thread::hardware_concurrency()) + " hardware threads";
}

void printHead(const Options& options) {
  std::printf("# machine: %s\n", machine().c_str());
  std::printf("# build: spheretree %s, %s %s, %s\n", SPHERETREE_VERSION,
#ifdef __clang__
              "clang", __clang_version__,
#else
              "g++", __VERSION__,
#endif
#ifdef NDEBUG
              "assertions off"
#else
              "assertions on"
#endif
  );
  std::printf("# settings: branch %u, levels %u, cover surface, seed %llu, median of %zu\n",
              options.base.branch, options.base.levels, static_cast<unsigned long long>(options.base.seed),
              options.repeats);
  std::puts(kColumns);
}

std::optional<std::vector<Model>> load(const Options& options) {
  std::vector<Model> loaded;
  for (const std::string& path : options.meshes) {
    auto imported = io::importMesh(path);
    if (!imported) {
      std::fprintf(stderr, "build_bench: %s\n", imported.error().message.c_str());
      return std::nullopt;
    }
    loaded.push_back({std::filesystem::path(path).stem().string(), std::move(imported->mesh)});
  }
  for (const std::string& name : options.models) {
    for (const models::Model& model : models::allModels()) {
      if (model.name == name) loaded.push_back({name, model.make()});
    }
  }
  return loaded;
}

template <class Enum>
void addList(CLI::App& app, const std::string& flag, std::vector<Enum>& values,
             const std::map<std::string, Enum>& names, const std::string& description) {
  app.add_option(flag, values, description)
      ->transform(CLI::CheckedTransformer(names, CLI::ignore_case))
      ->delimiter(',')
      ->allow_extra_args(false);
}

void addOptions(CLI::App& app, Options& options) {
  std::vector<std::string> models;
  for (const models::Model& model : models::allModels()) models.emplace_back(model.name);
  for (const builders::CatalogueEntry& entry : builders::catalogue())
    options.builders.emplace_back(entry.name);
  const std::map<std::string, builders::Toggle> toggles = {
      {"auto", builders::Toggle::Auto}, {"on", builders::Toggle::On}, {"off", builders::Toggle::Off}};

  app.add_option("MESH", options.meshes, "Meshes that bound a solid as they are");
  app.add_option("--models", options.models, "Generated models (make_models --list)")
      ->check(CLI::IsMember(models))
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--builders", options.builders, "Builders, all when not given")
      ->check(CLI::IsMember(options.builders))
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--reducers", options.base.combined.reducers, "Of combined")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->capture_default_str();
  addList<builders::Quality>(app, "--qualities", options.qualities,
                             {{"fast", builders::Quality::Fast},
                              {"normal", builders::Quality::Normal},
                              {"best", builders::Quality::Best}},
                             "Of refined builds, all when not given");
  addList<builders::Objective>(app, "--objectives", options.objectives,
                               {{"worst", builders::Objective::Worst},
                                {"mean", builders::Objective::Mean},
                                {"volume", builders::Objective::Volume}},
                               "worst when not given");
  addList(app, "--refine", options.refine, toggles, "auto when not given");
  addList(app, "--link", options.link, toggles, "auto when not given");
  app.add_option("--threads", options.threads, "Numbers of threads")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->capture_default_str();
  app.add_option("--branch", options.base.branch, "Most children of a ball")->capture_default_str();
  app.add_option("--levels", options.base.levels, "Levels, the root included")->capture_default_str();
  app.add_option("--repeats", options.repeats, "Builds of which the median counts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app("builder x quality x model x level, as CSV. Every list stands for all combinations");
  addOptions(app, options);
  try {
    app.parse(argc, argv);
    if (const std::string reason = builders::whyNoReducers(options.base.combined.reducers); !reason.empty())
      throw CLI::ValidationError("--reducers", reason);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kUsage;
  }
  if (options.meshes.empty() && options.models.empty()) options.models = {"knot", "gear"};
  const auto models = load(options);
  if (!models) return kUnreadable;
  printHead(options);
  for (const Model& model : *models) {
    const auto surface = medial::Surface::create(model.mesh);
    if (!surface) {
      std::fprintf(stderr, "build_bench: %s: %s\n", model.name.c_str(), surface.error().message.c_str());
      return kUnsuitable;
    }
    for (const Variant& variant : variantsOf(options)) {
      if (!bench(model.name, *surface, variant, options)) return kOurFault;
    }
  }
  return kDone;
}

}  // namespace

int main(int argc, char** argv) {
  spheretree::medial::tuneEnvironment(argv);
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "build_bench: %s\n", error.what());
    return kOurFault;
  }
}
