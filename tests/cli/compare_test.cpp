// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/program.hpp"

namespace spheretree::tests {
namespace {

using Json = nlohmann::json;
using Arguments = std::vector<std::string>;

class Compare : public ProgramTest {
 protected:
  Compare() { write("box.obj", boxObj()); }

  Finished compare(const Arguments& more) {
    Arguments arguments{"compare", "box.obj", "--levels", "3", "--poses", "200"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }
};

/// Whether `a` is nowhere worse than `b` and somewhere better, on one level.
bool beats(const Json& a, const Json& b, std::size_t depth) {
  const auto figures = [depth](const Json& row) {
    const Json& level = row.at("levels").at(depth);
    return std::vector<double>{level.at("spheres").get<double>(), level.at("overhang_worst").get<double>(),
                               row.at("build_seconds").get<double>()};
  };
  const std::vector<double> x = figures(a);
  const std::vector<double> y = figures(b);
  return x != y && std::equal(x.begin(), x.end(), y.begin(), [](double p, double q) { return p <= q; });
}

TEST_F(Compare, EveryBuilderOfTheListIsARow) {
  const Finished finished =
      compare({"--qualities", "fast", "--report", "box.json", "--report", "box.csv", "--threads", "2"});
  ASSERT_EQ(finished.exitCode, 0) << finished.err;
  const Json json = Json::parse(read("box.json"));
  const Json builders = Json::parse(run({"list", "--json"}).out);
  const Json& rows = json.at("rows");
  ASSERT_EQ(rows.size(), builders.size());
  std::size_t lines = 1;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Json& row = rows.at(k);
    EXPECT_EQ(row.at("builder"), builders.at(k).at("name"));
    EXPECT_EQ(row.at("state"), "done");
    EXPECT_NE(finished.out.find("\n" + row.at("name").get<std::string>()), std::string::npos) << finished.out;
    lines += row.at("levels").size();
    for (std::size_t depth = 0; depth < row.at("levels").size(); ++depth) {
      const Json& level = row.at("levels").at(depth);
      EXPECT_TRUE(level.at("surface_certified").get<bool>());
      EXPECT_GT(level.at("microseconds_per_close_pair").get<double>(), 0);
      bool beaten = false;
      for (const Json& other : rows)
        beaten = beaten || (other.at("levels").size() > depth && beats(other, row, depth));
      EXPECT_EQ(level.at("non_dominated").get<bool>(), !beaten) << row.at("name") << " level " << depth;
    }
    // The roots alone are one test; deeper answers take more.
    EXPECT_EQ(row.at("levels").at(0).at("sphere_tests_per_close_pair"), 1);
    EXPECT_GT(row.at("levels").at(1).at("sphere_tests_per_close_pair").get<double>(), 1);
    EXPECT_EQ(row.at("non_dominated"), row.at("levels").back().at("non_dominated"));
  }
  const std::string csv = read("box.csv");
  EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), lines);
}

TEST_F(Compare, ARowIsTheTreeOfBuild) {
  ASSERT_EQ(compare({"--builders", "octree,grid", "--report", "box.json"}).exitCode, 0);
  ASSERT_EQ(run({"build", "box.obj", "-o", "box.sph", "--builder", "grid", "--levels", "3"}).exitCode, 0);
  const Json info = Json::parse(run({"info", "box.sph", "--json"}).out);
  EXPECT_EQ(Json::parse(read("box.json")).at("rows").at(1).at("tree_hash"), info.at("content_hash"));
}

TEST_F(Compare, QueriesCountTheSameOnEveryRun) {
  std::vector<Json> tests;
  for (const char* name : {"a.json", "b.json"}) {
    ASSERT_EQ(compare({"--builders", "octree", "--report", name}).exitCode, 0);
    tests.push_back(
        Json::parse(read(name)).at("rows").at(0).at("levels").at(2).at("sphere_tests_per_close_pair"));
  }
  EXPECT_EQ(tests[0], tests[1]);
}

TEST_F(Compare, QualitiesAreRowsOfBuildersThatRefineOnly) {
  ASSERT_EQ(compare({"--builders", "Octree, combined", "--qualities", "fast,normal", "--report", "box.json"})
                .exitCode,
            0);
  std::vector<std::string> names;
  const Json json = Json::parse(read("box.json"));
  for (const Json& row : json.at("rows")) names.push_back(row.at("name"));
  EXPECT_EQ(names, (std::vector<std::string>{"octree", "combined fast", "combined normal"}));
}

TEST_F(Compare, WrongUsageIsCodeTwo) {
  EXPECT_EQ(compare({"--builders", "nobody"}).exitCode, 2);
  EXPECT_EQ(compare({"--qualities", "good"}).exitCode, 2);
  EXPECT_EQ(compare({"--builder", "octree"}).exitCode, 2);
  EXPECT_EQ(compare({"--report", "box.txt"}).exitCode, 2);
  EXPECT_EQ(run({"compare", "missing.obj"}).exitCode, 3);
}

}  // namespace
}  // namespace spheretree::tests
