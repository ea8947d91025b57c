// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "builders/settings.hpp"
#include "tests/cli/program.hpp"

namespace spheretree::tests {
namespace {

using Json = nlohmann::json;
using Arguments = std::vector<std::string>;
using Names = std::vector<std::string>;

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ",") + word;
  return text;
}

/// Few levels and samples: these tests are about the program, not about the tree.
Arguments smallBuild(Arguments more) {
  Arguments arguments{"build", "box.obj", "-o", "box.sph", "--levels", "3"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

class Build : public ProgramTest {
 protected:
  Build() { write("box.obj", boxObj()); }

  /// Runs the same command in a folder of its own.
  Finished runIn(const std::string& name, const Arguments& arguments) {
    std::filesystem::create_directory(folder_ / name);
    write(name + "/box.obj", boxObj());
    return run(arguments, name);
  }
};

TEST_F(Build, PrintsATableAndWritesTreeAndReports) {
  const Finished finished =
      run(smallBuild({"--builder", "octree", "--report", "box.json", "--report", "box.CSV"}));
  EXPECT_EQ(finished.exitCode, 0) << finished.err;
  EXPECT_EQ(finished.err, "");  // no progress bar: that is no terminal
  for (const char* word : {"level", "spheres", "repair rule off", "certified", "wrote box.sph",
                           "wrote box.json", "wrote box.CSV"})
    EXPECT_NE(finished.out.find(word), std::string::npos) << word << " in\n" << finished.out;
  EXPECT_EQ(names(), (Names{"box.CSV", "box.json", "box.obj", "box.sph"}));
  EXPECT_EQ(read("box.sph").rfind("3 8\n", 0), 0U);
  const std::string csv = read("box.CSV");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 3);
}

TEST_F(Build, TheReportHoldsTheDocumentedKeys) {
  ASSERT_EQ(run(smallBuild({"--builder", "octree", "--report", "box.json"})).exitCode, 0);
  const Json report = Json::parse(read("box.json"));
  for (const char* key : {"tool", "mesh", "settings", "threads", "levels", "certificate", "error_bound_met",
                          "stages", "peak_memory_bytes", "tree"})
    EXPECT_TRUE(report.contains(key)) << key;
  ASSERT_EQ(report.at("levels").size(), 3U);
  for (const Json& level : report.at("levels")) {
    for (const char* key : {"level", "spheres", "overhang_worst", "overhang_worst_relative", "overhang_mean",
                            "volume_ratio", "surface_cover", "solid_cover", "winners"})
      EXPECT_TRUE(level.contains(key)) << key;
    EXPECT_TRUE(level.at("surface_cover").at("certified").get<bool>());
  }
  // The ball around a unit box sticks out by (sqrt(3) - 1) / 2 over the middle of every face.
  const Json& worst = report.at("levels").at(0).at("overhang_worst");
  const double expected = (std::sqrt(3.0) - 1) / 2;
  EXPECT_LE(worst.at("lower").get<double>(), expected * (1 + 1e-5));  // written balls are a little larger
  EXPECT_GE(worst.at("upper").get<double>(), expected);
  EXPECT_EQ(report.at("mesh").at("repair").at("rule"), "off");
}

TEST_F(Build, CombinedTellsWhoWonAndWhatAutoMeant) {
  const Finished finished =
      run(smallBuild({"--quality", "fast", "--axis-balls", "50", "--reducers", "expand,merge,grid",
                      "--report", "box.json", "--report", "box.csv"}));
  ASSERT_EQ(finished.exitCode, 0) << finished.err;
  EXPECT_NE(finished.out.find("combined of grid, merge, expand: branch 8, 3 levels, seed 1, quality fast, "
                              "refined, linked\n"),
            std::string::npos)
      << finished.out;
  EXPECT_NE(finished.out.find("sets won\n"), std::string::npos) << finished.out;
  const auto report = nlohmann::ordered_json::parse(read("box.json"));
  const auto& settings = report.at("settings");
  EXPECT_EQ(settings.at("builder"), "combined");
  EXPECT_EQ(settings.at("quality"), "fast");
  EXPECT_EQ(settings.at("objective"), "worst");
  EXPECT_EQ(settings.at("refine"), "on");
  EXPECT_EQ(settings.at("link"), "on");
  EXPECT_EQ(settings.at("reducers"), nlohmann::ordered_json({"grid", "merge", "expand"}));
  EXPECT_EQ(settings.at("axis_error"), 0.5);
  EXPECT_EQ(settings.at("axis_balls"), 50);

  // One set below the root, up to eight below its children; table, JSON and CSV count alike.
  const std::string csv = read("box.csv");
  for (const std::size_t level : {1U, 2U}) {
    std::size_t sets = 0;
    std::string inTable;
    std::string inCsv;
    for (const auto& [name, won] : report.at("levels").at(level).at("winners").items()) {
      sets += won.get<std::size_t>();
      inTable += (inTable.empty() ? "" : ", ") + name + " " + won.dump();
      inCsv += (inCsv.empty() ? "" : " ") + name + "=" + won.dump();
    }
    EXPECT_EQ(sets >= 1 && sets <= (level == 1 ? 1U : 8U), true) << sets;
    EXPECT_NE(finished.out.find("  " + inTable + "\n"), std::string::npos) << inTable << "\n" << finished.out;
    EXPECT_NE(csv.find("," + inCsv + "\n"), std::string::npos) << inCsv << "\n" << csv;
  }
}

TEST_F(Build, AReducerOnItsOwnIsNotRefinedUnlessAsked) {
  for (const char* refine : {"auto", "on"}) {
    const std::string report = std::string(refine) + ".json";
    const Finished finished =
        run({"build", "box.obj", "-o", std::string(refine) + ".sph", "--builder", "grid", "--levels", "2",
             "--orientations", "2", "--refine", refine, "--report", report});
    ASSERT_EQ(finished.exitCode, 0) << finished.err;
    EXPECT_EQ(finished.out.find("sets won"), std::string::npos) << "there was no competition";
    EXPECT_EQ(finished.out.find("refined") != std::string::npos, std::string(refine) == "on") << finished.out;
    const Json settings = Json::parse(read(report)).at("settings");
    EXPECT_EQ(settings.at("refine"), std::string(refine) == "on" ? "on" : "off");
    EXPECT_EQ(settings.at("link"), "off");
    EXPECT_FALSE(settings.contains("axis_error"));
    EXPECT_FALSE(settings.contains("reducers"));
  }
}

TEST_F(Build, DumpsTheBallsOfTheMedialAxisInTheFrameOfTheMesh) {
  write("far.obj", boxObj(100, 20, 3));
  const Finished finished = run({"build", "far.obj", "-o", "far.sph", "--levels", "2", "--builder", "octree",
                                 "--dump-medial", "axis.ply"});
  ASSERT_EQ(finished.exitCode, 0) << finished.err;
  EXPECT_NE(finished.out.find("wrote axis.ply"), std::string::npos);
  std::istringstream text(read("axis.ply"));
  std::string word;
  std::size_t balls = 0;
  while (text >> word && word != "end_header") {
    if (word == "vertex") text >> balls;
  }
  ASSERT_GE(balls, 200U);
  double deepest = 0;
  for (std::size_t i = 0; i < balls; ++i) {
    double x = 0;
    double y = 0;
    double z = 0;
    double radius = 0;
    double depth = 0;
    ASSERT_TRUE(text >> x >> y >> z >> radius >> depth);
    // In a cube of side 1 the depth of a point is the distance to the nearest face.
    const double off = std::max({std::abs(x - 100), std::abs(y - 20), std::abs(z - 3)});
    ASSERT_NEAR(depth, 0.5 - off, 1e-9);
    deepest = std::max(deepest, depth);
  }
  EXPECT_GT(deepest, 0.45);
}

TEST_F(Build, QuietPrintsNothing) {
  const Finished finished = run(smallBuild({"--builder", "octree", "-q"}));
  EXPECT_EQ(finished.exitCode, 0);
  EXPECT_EQ(finished.out, "");
  EXPECT_EQ(finished.err, "");
  EXPECT_TRUE(exists("box.sph"));
}

TEST_F(Build, VerboseTalksOnStandardErrorOnly) {
  const Finished plain = runIn("plain", smallBuild({"--builder", "octree"}));
  const Finished verbose = runIn("verbose", smallBuild({"--builder", "octree", "-v"}));
  EXPECT_EQ(verbose.exitCode, 0);
  EXPECT_EQ(verbose.out, plain.out);
  EXPECT_NE(verbose.err.find("content hash"), std::string::npos) << verbose.err;
}

TEST_F(Build, AnExistingOutputIsReplacedByForceOnly) {
  write("box.sph", "precious");
  const Finished refused = run(smallBuild({"--builder", "octree"}));
  EXPECT_EQ(refused.exitCode, 6);
  EXPECT_NE(refused.err.find("--force"), std::string::npos) << refused.err;
  EXPECT_EQ(read("box.sph"), "precious");
  EXPECT_EQ(run(smallBuild({"--builder", "octree", "--force"})).exitCode, 0);
  EXPECT_EQ(read("box.sph").rfind("3 8\n", 0), 0U);
}

TEST_F(Build, AnExistingReportStopsTheBuildBeforeItBegins) {
  write("box.json", "precious");
  EXPECT_EQ(run(smallBuild({"--builder", "octree", "--report", "box.json"})).exitCode, 6);
  EXPECT_EQ(names(), (Names{"box.json", "box.obj"}));
}

TEST_F(Build, AMissedErrorBoundIsCodeFiveAndTheTreeIsWritten) {
  const Finished missed =
      run(smallBuild({"--builder", "octree", "--max-error", "0.001", "--report", "box.json"}));
  EXPECT_EQ(missed.exitCode, 5);
  EXPECT_NE(missed.out.find("wrote box.sph"), std::string::npos);
  EXPECT_NE(missed.err.find("--max-error"), std::string::npos) << missed.err;
  EXPECT_TRUE(exists("box.sph"));
  EXPECT_FALSE(Json::parse(read("box.json")).at("error_bound_met").get<bool>());
}

TEST_F(Build, AGenerousErrorBoundEndsTheRefinementEarly) {
  const Finished met = run(smallBuild({"--builder", "octree", "--max-error", "0.5"}));
  EXPECT_EQ(met.exitCode, 0) << met.err;
  EXPECT_EQ(read("box.sph").rfind("1 8\n", 0), 0U);
}

TEST_F(Build, AnyNumberOfThreadsGivesTheSameBytes) {
  for (const Arguments& settings : {Arguments{"--builder", "hubbard", "--samples", "400", "--seed", "7"},
                                    Arguments{"--quality", "fast", "--axis-balls", "50", "--seed", "7"}}) {
    SCOPED_TRACE(settings[1]);
    std::vector<std::string> trees;
    std::vector<std::string> tables;
    for (const char* threads : {"1", "2", "7"}) {
      Arguments arguments = smallBuild(settings);
      arguments.insert(arguments.end(), {"--threads", threads});
      const Finished finished = runIn(settings[1] + threads, arguments);
      ASSERT_EQ(finished.exitCode, 0) << finished.err;
      trees.push_back(read(settings[1] + threads + "/box.sph"));
      tables.push_back(finished.out);
    }
    EXPECT_FALSE(trees[0].empty());
    EXPECT_EQ(trees[0], trees[1]);
    EXPECT_EQ(trees[0], trees[2]);
    EXPECT_EQ(tables[0], tables[1]);
    EXPECT_EQ(tables[0], tables[2]);
  }
}

class Config : public Build {
 protected:
  /// Prints the settings as a file and builds with them, typed and from the file.
  void expectRoundTrip(const Arguments& settings);
};

void Config::expectRoundTrip(const Arguments& settings) {
  Arguments print{"build", "--print-config"};
  print.insert(print.end(), settings.begin(), settings.end());
  const Finished printed = run(print);
  ASSERT_EQ(printed.exitCode, 0) << printed.err;
  EXPECT_EQ(names(), Names{"box.obj"});
  write("settings.toml", printed.out);

  // Printing what was read prints it again.
  EXPECT_EQ(run({"build", "--config", "settings.toml", "--print-config"}).out, printed.out);

  Arguments typed{"build", "box.obj", "-o", "box.sph"};
  const Arguments fromFile{"build", "box.obj", "-o", "box.sph", "--config", "../settings.toml"};
  typed.insert(typed.end(), settings.begin(), settings.end());
  const Finished first = runIn("typed", typed);
  const Finished second = runIn("file", fromFile);
  EXPECT_EQ(first.exitCode, second.exitCode) << first.err << second.err;
  EXPECT_EQ(first.out, second.out);
  EXPECT_FALSE(read("typed/box.sph").empty());
  EXPECT_EQ(read("typed/box.sph"), read("file/box.sph"));
}

TEST_F(Config, APrintedOneRebuildsTheSameBytes) {
  expectRoundTrip({"--builder", "HUBBARD", "--branch", "5", "--levels", "3", "--max-error", "1e-2", "--seed",
                   "99", "--cover", "Surface", "--samples", "300", "--repair", "Orient", "--threads", "1"});
  // And the settings are not simply ignored.
  runIn("default", {"build", "box.obj", "-o", "box.sph", "--builder", "hubbard", "--samples", "300"});
  EXPECT_NE(read("typed/box.sph"), read("default/box.sph"));
}

TEST_F(Config, APrintedOneOfCombinedRebuildsTheSameBytes) {
  expectRoundTrip({"--levels", "3", "--quality", "FAST", "--objective", "Mean", "--refine", "On", "--link",
                   "off", "--reducers", "Expand, merge", "--axis-error", "0.8", "--axis-balls", "60"});
  EXPECT_NE(read("settings.toml").find("reducers=\"expand,merge\"\n"), std::string::npos)
      << read("settings.toml");
}

TEST_F(Config, ReducersMayBeAListOfToml) {
  write("settings.toml", "reducers = [\"Merge\", \"expand\"]\n");
  const Finished printed = run({"build", "--config", "settings.toml", "--print-config"});
  EXPECT_EQ(printed.exitCode, 0) << printed.err;
  EXPECT_NE(printed.out.find("reducers=\"merge,expand\"\n"), std::string::npos) << printed.out;
}

TEST_F(Config, OneForAllBuildersServesEach) {
  write("all.toml", run({"build", "--print-config", "--quality", "fast", "--levels", "2"}).out);
  for (const char* builder : {"octree", "grid", "merge"}) {
    const Finished finished =
        run({"build", "box.obj", "-o", "box.sph", "--force", "--config", "all.toml", "--builder", builder});
    EXPECT_EQ(finished.exitCode, 0) << builder << ": " << finished.err;
  }
}

TEST_F(Build, PrintedDefaultsNeedNoFiles) {
  const Finished printed = run({"build", "--print-config"});
  EXPECT_EQ(printed.exitCode, 0) << printed.err;
  for (const char* line :
       {"builder=\"combined\"\n", "branch=8\n", "levels=4\n", "max-error=0\n", "cover=\"surface\"\n",
        "seed=1\n", "quality=\"normal\"\n", "objective=\"worst\"\n", "refine=\"auto\"\n", "link=\"auto\"\n",
        "axis-error=0.5\n", "axis-balls=200\n", "repair=\"auto\"\n", "samples=2000\n"})
    EXPECT_NE(printed.out.find(line), std::string::npos) << line << " in\n" << printed.out;
  const std::string reducers = joined(builders::BuildSettings{}.combined.reducers);
  EXPECT_NE(printed.out.find("reducers=\"" + reducers + "\"\n"), std::string::npos) << printed.out;
}

TEST_F(Build, TheCommandLineWinsOverTheConfig) {
  write("settings.toml", "builder = \"octree\"\nlevels = 4\n");
  EXPECT_EQ(run(smallBuild({"--config", "settings.toml"})).exitCode, 0);
  EXPECT_EQ(read("box.sph").rfind("3 8\n", 0), 0U);
}

TEST_F(Build, TheConfigIsAnInputToo) {
  write("settings.toml", "levels = 2\n");
  EXPECT_EQ(run({"build", "box.obj", "-o", "settings.toml", "--config", "settings.toml", "--force"}).exitCode,
            2);
  EXPECT_EQ(read("settings.toml"), "levels = 2\n");
}

TEST_F(Build, AConfigWithMistakesIsCodeTwo) {
  for (const char* text :
       {"colour = 3\n", "[build]\nlevels = 3\n", "levels = 3\nbranch = 8\nlevels = 3\n", "levels = 99\n",
        "levels = many\n", "builder = \"nobody\"\n", "reducers = \"merge,nobody\"\n", "axis-error = 0\n",
        "quality = 3\n", "refine = \"off\"\nlink = \"on\"\n", "output = \"a.sph\"\n", "force = true\n",
        "levels\n"}) {
    SCOPED_TRACE(text);
    write("settings.toml", text);
    const Finished finished = run({"build", "box.obj", "-o", "box.sph", "--config", "settings.toml"});
    EXPECT_EQ(finished.exitCode, 2);
    EXPECT_EQ(finished.out, "");
    EXPECT_FALSE(exists("box.sph"));
  }
}

TEST_F(Build, ARepairIsNamedAndAChangedShapeIsWarnedAbout) {
  write("open.obj", openBoxObj());
  const Finished finished =
      run({"build", "open.obj", "-o", "open.sph", "--levels", "2", "--builder", "octree"});
  EXPECT_EQ(finished.exitCode, 0) << finished.err;
  EXPECT_NE(finished.out.find("repair rule fill"), std::string::npos) << finished.out;
  EXPECT_NE(finished.err.find("warning"), std::string::npos) << finished.err;
}

TEST_F(Build, EveryBuilderOfTheListBuilds) {
  const Json builders = Json::parse(run({"list", "--json"}).out);
  ASSERT_FALSE(builders.empty());
  for (const Json& builder : builders) {
    const auto name = builder.at("name").get<std::string>();
    Arguments arguments{"build", "box.obj",   "-o", name + ".sph", "--levels",
                        "2",     "--builder", name, "--cover",     "solid"};
    if (name == "combined") arguments.insert(arguments.end(), {"--quality", "fast"});
    const Finished finished = run(arguments);
    EXPECT_EQ(finished.exitCode, 0) << name << ": " << finished.err;
    EXPECT_NE(finished.out.find("certified: every level covers the whole solid"), std::string::npos) << name;
  }
}

TEST_F(Build, NamesWithBlanksWork) {
  write("my box.obj", boxObj());
  const Finished finished =
      run({"build", "my box.obj", "-o", "my box.sph", "--levels", "1", "--report", "my report.csv"});
  EXPECT_EQ(finished.exitCode, 0) << finished.err;
  EXPECT_TRUE(exists("my box.sph"));
  EXPECT_TRUE(exists("my report.csv"));
}

}  // namespace
}  // namespace spheretree::tests
