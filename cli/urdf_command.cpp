// SPDX-License-Identifier: GPL-3.0-or-later
//
// spheretree urdf: a robot whose collision geometry becomes balls.
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/interrupt.hpp"
#include "cli/options.hpp"
#include "cli/outputs.hpp"
#include "cli/progress_bar.hpp"
#include "cli/text_table.hpp"
#include "io/urdf.hpp"

namespace spheretree::cli {
namespace {

namespace fs = std::filesystem;

// Enough for a link of an arm, and few enough for a planner.
constexpr std::uint32_t kSpheres = 32;
constexpr int kLengthDigits = 4;
constexpr int kShareDigits = 3;

struct UrdfOptions {
  std::string robot;
  std::string output;
  std::string srdf;     // empty: none
  std::string curobo;   // empty: none
  std::string budgets;  // empty: none
  io::RobotSettings settings;
  io::Overwrite overwrite = io::Overwrite::Refuse;
  Verbosity verbosity = Verbosity::Normal;
  unsigned threads = 0;
  ConfigFile config;
};

std::vector<fs::path> outputPaths(const UrdfOptions& options) {
  std::vector<fs::path> paths{options.output};
  for (const std::string& more : {options.srdf, options.curobo}) {
    if (!more.empty()) paths.emplace_back(more);
  }
  return paths;
}

/// The folders of ROS_PACKAGE_PATH.
std::vector<fs::path> packagePath() {
  std::vector<fs::path> folders;
  const char* value = std::getenv("ROS_PACKAGE_PATH");
  std::istringstream list(value == nullptr ? "" : value);
  for (std::string folder; std::getline(list, folder, ':');) {
    if (!folder.empty()) folders.emplace_back(folder);
  }
  return folders;
}

void addPackage(io::RobotSettings& settings, const std::string& text) {
  const std::size_t at = text.find('=');
  if (at == 0 || at == std::string::npos || at + 1 == text.size())
    throw CLI::ValidationError("--package", "'" + text + "' is not NAME=FOLDER");
  settings.packages[text.substr(0, at)] = text.substr(at + 1);
}

std::string tableOf(const io::SphereRobot& robot) {
  using Align = TextTable::Align;
  TextTable table({{"link", Align::Left},
                   {"collision geometry", Align::Left},
                   {"triangles"},
                   {"spheres"},
                   {"worst overhang"},
                   {"% of diagonal"}});
  std::size_t spheres = 0;
  for (const io::RobotPart& part : robot.parts) {
    spheres += part.balls.size();
    table.add({part.link, part.geometry, part.triangles == 0 ? "exact" : std::to_string(part.triangles),
               std::to_string(part.balls.size()), shortNumber(part.overhang, kLengthDigits),
               shortNumber(100 * part.overhang / part.diagonal, kShareDigits)});
  }
  return table.text() + robot.name + ": " + counted(spheres, "sphere", "spheres") + " on " +
         counted(robot.links().size(), "link", "links") + "\n";
}

ExitCode runUrdf(const UrdfOptions& options) {
  const std::vector<fs::path> outputs = outputPaths(options);
  std::vector<fs::path> inputs{options.robot};
  for (const std::string& more : {options.config.path, options.budgets}) {
    if (!more.empty()) inputs.emplace_back(more);
  }
  if (const Result<Done> free = checkOutputs(inputs, outputs, options.overwrite); !free)
    return fail(free.error());
  io::RobotSettings settings = options.settings;
  settings.packagePath = packagePath();
  if (!options.budgets.empty()) {
    Result<std::map<std::string, builders::BuildSettings>> links =
        io::readBudgets(options.budgets, settings.build);
    if (!links) return fail(links.error());
    settings.links = std::move(*links);
  }

  ProgressBar bar(options.verbosity);
  medial::Context context(options.threads, bar.callback());
  const CancelOnInterrupt interruptible(context);
  const Result<io::SphereRobot> robot = io::sphereRobot(options.robot, settings, context);
  bar.wipe();
  if (!robot) return fail(robot.error());
  for (const std::string& warning : robot->warnings) warn(options.robot + ": " + warning);

  std::vector<Output> files{{options.output, robot->urdf}};
  if (!options.srdf.empty()) files.push_back({options.srdf, io::srdfText(robot->name, robot->links())});
  if (!options.curobo.empty()) files.push_back({options.curobo, io::curoboText(robot->name, robot->links())});
  if (const Result<Done> written = writeOutputs(files, options.overwrite); !written)
    return fail(written.error());
  if (options.verbosity == Verbosity::Quiet) return ExitCode::Done;
  std::string text = tableOf(*robot);
  for (const fs::path& path : outputs) text += "wrote " + path.string() + "\n";
  print(text);
  return ExitCode::Done;
}

}  // namespace

Command setupUrdf(CLI::App& program) {
  const auto options = std::make_shared<UrdfOptions>();
  options->settings.build.levels = 2;
  options->settings.build.branch = kSpheres;
  CLI::App* app = program.add_subcommand("urdf", "Turn the collision geometry of a robot into spheres");
  addConfig(*app, options->config);
  addSettings(*app, options->settings.build);
  app->add_option("ROBOT", options->robot, "Robot description to read (URDF, not xacro)")
      ->option_text(" ")
      ->required()
      ->configurable(false);
  app->add_option_function<std::vector<std::string>>(
         "--package",
         [options](const std::vector<std::string>& texts) {
           for (const std::string& text : texts) addPackage(options->settings, text);
         },
         "Where a package is: its name, an equals sign, its folder; repeatable. Otherwise ROS_PACKAGE_PATH "
         "and the folders above ROBOT")
      ->type_name("PACKAGE")
      ->allow_extra_args(false)
      ->configurable(false)
      ->group("Robot");
  app->add_option("--budgets", options->budgets, "Spheres, levels or errors by link, as JSON")
      ->type_name("FILE.json")
      ->configurable(false)
      ->group("Robot");
  addRepair(*app, options->settings.repair)->configurable()->group("Robot");
  app->add_option("-o,--output", options->output, "Robot description to write")
      ->type_name("FILE.urdf")
      ->required()
      ->configurable(false)
      ->group("Output");
  app->add_option("--srdf", options->srdf, "Also write link_sphere_approximation for MoveIt")
      ->type_name("FILE.srdf")
      ->configurable(false)
      ->group("Output");
  app->add_option("--curobo", options->curobo, "Also write collision_spheres for cuRobo")
      ->type_name("FILE.yml")
      ->configurable(false)
      ->group("Output");
  addForce(*app, options->overwrite)->group("Output");
  addThreads(*app, options->threads)->configurable()->group("Run");
  addVerbosity(*app, options->verbosity);
  app->callback([app, options] { checkSettings(*app, options->settings.build, options->config); });
  app->footer("Example: spheretree urdf arm.urdf -o arm-spheres.urdf --branch 64");
  return {app, [app, options] {
            if (!options->config.print) return runUrdf(*options);
            print(configText(*app));
            return ExitCode::Done;
          }};
}

}  // namespace spheretree::cli
