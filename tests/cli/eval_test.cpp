// SPDX-License-Identifier: GPL-3.0-or-later
//
// eval and info: reading trees, ours and others'.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/program.hpp"

namespace spheretree::tests {
namespace {

using Json = nlohmann::json;

class Eval : public ProgramTest {
 protected:
  Eval() {
    write("box.obj", boxObj());
    write("far.obj", boxObj(10, -20, 30));
    write("classic.sph", classicBoxTree());
  }

  Json evaluated(const std::vector<std::string>& arguments) {
    const Finished finished = run(arguments);
    EXPECT_EQ(finished.exitCode, 0) << finished.err;
    return Json::parse(finished.out, nullptr, false);
  }
};

class Info : public Eval {};

void expectBracket(const Json& bracket, double value) {
  const double lower = bracket.at("lower").get<double>();
  const double upper = bracket.at("upper").get<double>();
  EXPECT_LE(lower, value * (1 + 1e-6));
  EXPECT_GE(upper, value * (1 - 1e-6));
  EXPECT_LE(upper - lower, 0.011 * value);
}

/// The closed forms of classicBoxTree() around its box.
void expectClassicFigures(const Json& report) {
  constexpr double kRoot = 0.8661;
  constexpr double kOctant = 0.4331;
  ASSERT_EQ(report.at("levels").size(), 2U);
  const Json& top = report.at("levels").at(0);
  const Json& leaves = report.at("levels").at(1);
  EXPECT_EQ(top.at("spheres"), 1);
  EXPECT_EQ(leaves.at("spheres"), 8);
  expectBracket(top.at("overhang_worst"), kRoot - 0.5);
  expectBracket(top.at("overhang_worst_relative"), (kRoot - 0.5) / std::sqrt(3.0));
  expectBracket(leaves.at("overhang_worst"), kOctant - 0.25);
  EXPECT_NEAR(top.at("volume_ratio").get<double>(), 4.0 / 3 * M_PI * std::pow(kRoot, 3), 1e-4);
  for (const Json& level : report.at("levels")) {
    EXPECT_TRUE(level.at("surface_cover").at("certified").get<bool>());
    EXPECT_TRUE(level.at("solid_cover").at("certified").get<bool>());
  }
  EXPECT_TRUE(report.at("certificate").at("surface_chains").at("certified").get<bool>());
}

TEST_F(Eval, MeasuresAForeignTree) {
  const Json report = evaluated({"eval", "box.obj", "classic.sph", "--json"});
  for (const char* key :
       {"tool", "mesh", "tree", "frame", "shift", "levels", "certificate", "max_error", "error_bound_met"})
    EXPECT_TRUE(report.contains(key)) << key;
  EXPECT_EQ(report.at("frame"), "mesh");
  expectClassicFigures(report);
}

TEST_F(Eval, BoxCentredTreesAreMeasuredWhereTheyBelong) {
  const Json report = evaluated({"eval", "far.obj", "classic.sph", "--json", "--frame", "Box-Centred"});
  EXPECT_EQ(report.at("frame"), "box-centred");
  EXPECT_EQ(report.at("shift"), Json({10.0, -20.0, 30.0}));
  expectClassicFigures(report);
}

TEST_F(Eval, ATreeElsewhereCoversNothing) {
  const Json report = evaluated({"eval", "far.obj", "classic.sph", "--json"});
  const Json& cover = report.at("levels").at(1).at("surface_cover");
  EXPECT_FALSE(cover.at("certified").get<bool>());
  EXPECT_NEAR(cover.at("uncovered").at("lower").get<double>(), 1, 1e-9);
  EXPECT_FALSE(report.at("certificate").at("surface_chains").at("certified").get<bool>());
  const Finished table = run({"eval", "far.obj", "classic.sph"});
  EXPECT_EQ(table.exitCode, 0);  // measured: that is what was asked for
  EXPECT_NE(table.out.find("not 100 %"), std::string::npos) << table.out;
  EXPECT_NE(table.out.find("not certified"), std::string::npos) << table.out;
}

TEST_F(Eval, TheTableAndTheReportsSayTheSame) {
  const Finished table =
      run({"eval", "box.obj", "classic.sph", "--report", "e.json", "--report", "e.csv", "--threads", "1"});
  EXPECT_EQ(table.exitCode, 0) << table.err;
  EXPECT_EQ(table.err, "");
  EXPECT_NE(table.out.find("certified: every level covers the whole solid"), std::string::npos) << table.out;
  EXPECT_EQ(read("e.json"), run({"eval", "box.obj", "classic.sph", "--json", "--threads", "2"}).out);
  const std::string csv = read("e.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 2);
  EXPECT_EQ(run({"eval", "box.obj", "classic.sph", "--report", "e.csv"}).exitCode, 6);
  EXPECT_EQ(run({"eval", "box.obj", "classic.sph", "--report", "e.csv", "--force"}).exitCode, 0);
}

TEST_F(Eval, MaxErrorJudgesTheLastLevel) {
  // The leaves stick out by 0.1831 of 1.7321: 10.57 %.
  EXPECT_EQ(run({"eval", "box.obj", "classic.sph", "--max-error", "0.11"}).exitCode, 0);
  const Finished missed = run({"eval", "box.obj", "classic.sph", "--max-error", "0.1"});
  EXPECT_EQ(missed.exitCode, 5);
  EXPECT_NE(missed.out.find("level"), std::string::npos);
  EXPECT_EQ(run({"eval", "box.obj", "classic.sph", "--max-error", "0"}).exitCode, 5);
}

TEST_F(Eval, AChildlessBallStandsForItselfFurtherDown) {
  // The root has one child around each half of the box, and only the first is refined: into two balls around
  // its quarters.
  write("uneven.sph",
        "3 2\n0 0 0 0.8661 1\n-0.25 0 0 0.7501 1\n0.25 0 0 0.7501 1\n"
        "-0.25 -0.25 0 0.6125 1\n-0.25 0.25 0 0.6125 1\n0 0 0 -1 0\n0 0 0 -1 0\n");
  const Json report = evaluated({"eval", "box.obj", "uneven.sph", "--json"});
  const Json& last = report.at("levels").at(2);
  EXPECT_EQ(last.at("spheres"), 3);
  EXPECT_EQ(last.at("from_above"), 1);
  EXPECT_EQ(last.at("worst_node"), 2);
  EXPECT_TRUE(last.at("surface_cover").at("certified").get<bool>());
  EXPECT_TRUE(report.at("certificate").at("surface_chains").at("certified").get<bool>());
  EXPECT_NE(run({"eval", "box.obj", "uneven.sph"}).out.find("level 2 includes 1 childless sphere"),
            std::string::npos);
}

TEST_F(Eval, AgreesWithTheBuildAboutOurOwnTree) {
  ASSERT_EQ(run({"build", "box.obj", "-o", "box.sph", "--levels", "3", "--builder", "octree", "--report",
                 "box.json", "-q"})
                .exitCode,
            0);
  const Json built = Json::parse(read("box.json"));
  const Json report = evaluated({"eval", "box.obj", "box.sph", "--json"});
  ASSERT_EQ(report.at("levels").size(), built.at("levels").size());
  for (std::size_t k = 0; k < built.at("levels").size(); ++k) {
    for (const auto& [key, value] : built.at("levels").at(k).items()) {
      if (key == "winners") continue;
      EXPECT_EQ(report.at("levels").at(k).at(key), value) << "level " << k << " " << key;
    }
  }
  EXPECT_EQ(report.at("tree").at("content_hash"), built.at("tree").at("content_hash"));
}

TEST_F(Info, SaysWhatIsInAForeignTree) {
  const Finished finished = run({"info", "classic.sph", "--json"});
  EXPECT_EQ(finished.exitCode, 0) << finished.err;
  const Json info = Json::parse(finished.out);
  EXPECT_EQ(info.at("branch"), 8);
  EXPECT_EQ(info.at("spheres"), 9);
  EXPECT_EQ(info.at("most_children"), 8);
  ASSERT_EQ(info.at("levels").size(), 2U);
  EXPECT_EQ(info.at("levels").at(1).at("spheres"), 8);
  EXPECT_EQ(info.at("levels").at(1).at("childless"), 8);
  EXPECT_FLOAT_EQ(info.at("levels").at(1).at("radius").at("max").get<float>(), 0.4331F);
  EXPECT_FLOAT_EQ(info.at("bounds").at("max").at(0).get<float>(), 0.8661F);
  EXPECT_TRUE(info.at("metadata").empty());
  EXPECT_TRUE(info.at("warnings").empty());
  EXPECT_EQ(info.at("content_hash").get<std::string>().size(), 32U);
}

TEST_F(Info, ShowsTheMetadataOfOurOwn) {
  ASSERT_EQ(run({"build", "box.obj", "-o", "box.sph", "--levels", "2", "--builder", "octree", "-q"}).exitCode,
            0);
  const Finished text = run({"info", "box.sph"});
  EXPECT_EQ(text.exitCode, 0);
  EXPECT_NE(text.out.find("builder: octree\n"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("frame: mesh\n"), std::string::npos) << text.out;
}

TEST_F(Info, WarnsAboutWhatIsOddButUsable) {
  write("extra.sph", "1 8\n0 0 0 1 1\n0 0 0 1 1\n");
  const Finished finished = run({"info", "extra.sph"});
  EXPECT_EQ(finished.exitCode, 0);
  EXPECT_NE(finished.err.find("warning: extra.sph"), std::string::npos) << finished.err;
  EXPECT_EQ(Json::parse(run({"info", "extra.sph", "--json"}).out).at("warnings").size(), 1U);
}

TEST_F(Info, ListsTheBuilders) {
  const Finished table = run({"list"});
  EXPECT_EQ(table.exitCode, 0);
  const Json builders = Json::parse(run({"list", "--json"}).out);
  int defaults = 0;
  for (const Json& builder : builders) {
    for (const char* key : {"name", "summary", "reference"}) {
      EXPECT_FALSE(builder.at(key).get<std::string>().empty());
      EXPECT_NE(table.out.find(builder.at(key).get<std::string>()), std::string::npos);
    }
    defaults += builder.at("default").get<bool>() ? 1 : 0;
  }
  EXPECT_EQ(defaults, 1);
}

}  // namespace
}  // namespace spheretree::tests
