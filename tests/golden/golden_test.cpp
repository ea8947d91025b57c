// SPDX-License-Identifier: GPL-3.0-or-later
//
// trees.csv says which bytes and which errors each builder gives on some models. A change of either is a
// change of behaviour: look at the errors, and when the new ones are wanted, write the file anew with
//   SPHERETREE_UPDATE_GOLDEN=1 golden_tests
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <string>
#include <vector>

#include "builders/build_tree.hpp"
#include "builders/catalogue.hpp"
#include "io/tree_files.hpp"
#include "tests/support/solids.hpp"

namespace spheretree {
namespace {

struct Row {
  std::string model;
  std::string builder;
  std::string hash;
  std::vector<double> worst;  // per level, fraction of the diagonal

  [[nodiscard]] std::string text() const {
    std::ostringstream out;
    out << model << ',' << builder << ',' << hash;
    for (const double w : worst) out << ',' << std::setprecision(6) << w;
    return out.str();
  }
};

std::vector<Row> buildRows() {
  constexpr std::array kModels{"cube", "l_block", "torus", "gear", "slab", "hollow_ball", "tangent_balls"};
  std::vector<Row> rows;
  for (const test::Solid& solid : test::allSolids()) {
    if (std::find(kModels.begin(), kModels.end(), solid.name) == kModels.end()) continue;
    for (const builders::CatalogueEntry& builder : builders::catalogue()) {
      builders::BuildSettings settings;
      settings.builder = builder.name;
      settings.levels = 3;
      settings.quality = builders::Quality::Fast;
      settings.hubbard.samples = 800;
      settings.grid.orientations = 3;
      const auto built = builders::buildTree(solid.surface, settings, medial::Context(2));
      EXPECT_TRUE(built.ok()) << (built.ok() ? "" : built.error().message);
      if (!built.ok()) continue;
      Row row{solid.name, std::string(builder.name), io::treeHash(built->tree), {}};
      for (const builders::LevelReport& level : built->report.levels) {
        row.worst.push_back(level.metrics.overhangWorst.upper / solid.surface.diagonal());
      }
      rows.push_back(row);
    }
  }
  return rows;
}

TEST(Golden, TreesAreWhatTheyWere) {
  const std::vector<Row> rows = buildRows();
  ASSERT_FALSE(rows.empty());
  if (std::getenv("SPHERETREE_UPDATE_GOLDEN") != nullptr) {
    std::ofstream out(SPHERETREE_GOLDEN_FILE);
    out << "model,builder,tree hash,worst overhang per level\n";
    for (const Row& row : rows) out << row.text() << '\n';
    GTEST_SKIP() << "wrote " << SPHERETREE_GOLDEN_FILE;
  }
  std::ifstream in(SPHERETREE_GOLDEN_FILE);
  ASSERT_TRUE(in) << SPHERETREE_GOLDEN_FILE;
  std::string line;
  std::getline(in, line);
  for (const Row& row : rows) {
    ASSERT_TRUE(std::getline(in, line)) << "missing: " << row.text();
    EXPECT_EQ(row.text(), line);
  }
  EXPECT_FALSE(std::getline(in, line)) << "not built any more: " << line;
}

}  // namespace
}  // namespace spheretree
