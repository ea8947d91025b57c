// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "models/shapes.hpp"
#include "topology.hpp"

namespace spheretree::models {
namespace {

using tests::Topology;
using tests::topologyOf;

const Model& modelNamed(std::string_view name) {
  const auto models = allModels();
  const auto found =
      std::find_if(models.begin(), models.end(), [&](const Model& m) { return m.name == name; });
  EXPECT_NE(found, models.end()) << name;
  return *found;
}

bool isSolid(Group group) {
  return group == Group::Closed || group == Group::Thin || group == Group::MultiComponent;
}

TEST(Catalogue, HasEveryGroupAndNoNameTwice) {
  std::set<std::string_view> names;
  std::set<Group> groups;
  for (const Model& model : allModels()) {
    EXPECT_TRUE(names.insert(model.name).second) << model.name;
    groups.insert(model.group);
    EXPECT_FALSE(model.note.empty()) << model.name;
    EXPECT_FALSE(nameOf(model.group).empty()) << model.name;
  }
  EXPECT_EQ(groups.size(), 5U);
}

TEST(Catalogue, ModelsAreSmallAndFinite) {
  for (const Model& model : allModels()) {
    SCOPED_TRACE(model.name);
    const TriangleMesh mesh = model.make();
    EXPECT_GE(mesh.triangles.size(), 12U);
    EXPECT_LE(mesh.triangles.size(), 2000U);
    EXPECT_TRUE(tests::hasValidIndices(mesh));
    for (const Eigen::Vector3d& vertex : mesh.vertices) ASSERT_TRUE(vertex.allFinite());
  }
}

TEST(Catalogue, SolidsBoundAPositiveVolume) {
  for (const Model& model : allModels()) {
    if (!isSolid(model.group)) continue;
    SCOPED_TRACE(model.name);
    const TriangleMesh mesh = model.make();
    const Topology topology = topologyOf(mesh);
    EXPECT_EQ(topology.unbalancedEdges, 0U);
    EXPECT_EQ(topology.crowdedEdges, 0U);
    EXPECT_GT(medial::signedVolumeOf(mesh), 0);
    EXPECT_EQ(topology.shells, model.group == Group::MultiComponent ? 2U : 1U);
  }
}

TEST(Catalogue, StatedVolumesAreTheMeshes) {
  std::size_t stated = 0;
  for (const Model& model : allModels()) {
    if (!model.volume) continue;
    ++stated;
    EXPECT_NEAR(medial::signedVolumeOf(model.make()) / *model.volume, 1, 1e-12) << model.name;
  }
  EXPECT_GE(stated, 14U);
}

TEST(Catalogue, ThinModelsAreThin) {
  for (const Model& model : allModels()) {
    if (model.group != Group::Thin) continue;
    const Eigen::Vector3d sides = medial::boundsOf(model.make()).sizes();
    EXPECT_LE(sides.minCoeff(), 0.02 * sides.maxCoeff()) << model.name;
  }
}

/// Number of closed chains of edges that only one triangle uses; 0 when the boundary is not made of chains.
std::size_t holesOf(const TriangleMesh& mesh) {
  std::map<std::uint32_t, std::uint32_t> next;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      ++balance[{t[k], t[(k + 1) % 3]}];
      --balance[{t[(k + 1) % 3], t[k]}];
    }
  }
  for (const auto& [edge, surplus] : balance) {
    if (surplus > 0 && !next.emplace(edge).second) return 0;  // two chains meet in a vertex
  }
  std::size_t holes = 0;
  while (!next.empty()) {
    for (auto link = next.begin(); link != next.end();) {
      const std::uint32_t to = link->second;
      next.erase(link);
      link = next.find(to);
    }
    ++holes;
  }
  return holes;
}

TEST(Catalogue, OpenModelsHaveTheHolesTheyNameAndNoOtherDefect) {
  const std::map<std::string_view, std::size_t> holes{
      {"open_box", 1}, {"tube", 2}, {"half_ball", 1}, {"punctured_ball", 3}};
  std::size_t seen = 0;
  for (const Model& model : allModels()) {
    if (model.group != Group::Open) continue;
    SCOPED_TRACE(model.name);
    const TriangleMesh mesh = model.make();
    const Topology topology = topologyOf(mesh);
    EXPECT_GT(topology.openEdges, 0U);
    EXPECT_EQ(topology.openEdges, topology.unbalancedEdges) << "oriented everywhere";
    EXPECT_EQ(topology.crowdedEdges, 0U);
    EXPECT_EQ(topology.shells, 1U);
    EXPECT_EQ(holesOf(mesh), holes.at(model.name));
    EXPECT_EQ(topology.euler(), 2 - static_cast<long>(holes.at(model.name))) << "a ball with that many holes";
    ++seen;
  }
  EXPECT_EQ(seen, holes.size());
}

TEST(Catalogue, DegenerateModelsHaveTheirDefect) {
  const TriangleMesh sliver = modelNamed("box_sliver").make();
  std::size_t flat = 0;
  for (std::size_t t = 0; t < sliver.triangles.size(); ++t) {
    const Eigen::Vector3d a = sliver.corner(t, 0);
    flat += (sliver.corner(t, 1) - a).cross(sliver.corner(t, 2) - a).isZero(0) ? 1U : 0U;
  }
  EXPECT_EQ(flat, 1U);
  EXPECT_EQ(topologyOf(sliver).unbalancedEdges, 0U) << "closed as long as the sliver stays";

  EXPECT_EQ(topologyOf(modelNamed("box_duplicate").make()).crowdedEdges, 3U);

  const Topology flipped = topologyOf(modelNamed("box_flipped").make());
  EXPECT_EQ(flipped.unbalancedEdges, 3U);
  EXPECT_EQ(flipped.openEdges, 0U);

  const Topology unwelded = topologyOf(modelNamed("box_unwelded").make());
  EXPECT_EQ(unwelded.vertices, 36U);
  EXPECT_EQ(unwelded.shells, 12U);

  // 2 x 0.5 x 0.5 and 0.75 x 0.625 x 2, both centred: the overlap counts twice in the signed volume.
  const TriangleMesh crossing = modelNamed("crossing_boxes").make();
  EXPECT_DOUBLE_EQ(medial::signedVolumeOf(crossing), 2 * 0.5 * 0.5 + 0.75 * 0.625 * 2);
  EXPECT_EQ(topologyOf(crossing).shells, 2U);
}

TEST(Catalogue, ReadmeTableSaysWhatTheModelsAre) {
  std::ifstream readme(SPHERETREE_MODELS_README);
  ASSERT_TRUE(readme) << SPHERETREE_MODELS_README;
  const std::regex row(R"(\| `(\w+)` \| (\d+) \| (yes|no) \| (\w+) \| .*\|)");
  std::set<std::string> described;
  for (std::string line; std::getline(readme, line);) {
    std::smatch cells;
    if (!std::regex_match(line, cells, row)) continue;
    SCOPED_TRACE(line);
    const Model& model = modelNamed(cells.str(1));
    const TriangleMesh mesh = model.make();
    EXPECT_EQ(cells.str(2), std::to_string(mesh.triangles.size()));
    EXPECT_EQ(cells.str(3), topologyOf(mesh).unbalancedEdges == 0 ? "yes" : "no");
    EXPECT_EQ(cells.str(4), nameOf(model.group));
    described.insert(cells.str(1));
  }
  EXPECT_EQ(described.size(), allModels().size());
}

}  // namespace
}  // namespace spheretree::models
