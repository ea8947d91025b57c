// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/mesh_repair.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/mesh_check.hpp"
#include "medial/surface.hpp"
#include "models/shapes.hpp"

namespace spheretree::io {
namespace {

using Eigen::Vector3d;
using medial::TriangleMesh;
using testing::HasSubstr;

TriangleMesh joined(TriangleMesh a, const TriangleMesh& b, const Vector3d& shift) {
  const auto base = static_cast<std::uint32_t>(a.vertices.size());
  for (const Vector3d& vertex : b.vertices) a.vertices.push_back(vertex + shift);
  for (const auto& t : b.triangles) a.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  return a;
}

TriangleMesh turnedOver(TriangleMesh mesh) {
  for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  return mesh;
}

/// A box without its top.
TriangleMesh openBox() {
  TriangleMesh mesh = models::makeBox({2, 3, 5});
  std::erase_if(mesh.triangles, [&](const auto& t) {
    return mesh.vertices[t[0]].z() > 0 && mesh.vertices[t[1]].z() > 0 && mesh.vertices[t[2]].z() > 0;
  });
  return mesh;
}

TriangleMesh oneTriangle() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
}

void expectSolid(const TriangleMesh& mesh) {
  EXPECT_TRUE(medial::boundsVolume(mesh));
  EXPECT_GT(medial::signedVolumeOf(mesh), 0);
}

/// The rule that Auto takes for a mesh that must be repairable, with the result checked.
RepairedMesh repairedByAuto(const TriangleMesh& mesh) {
  Result<RepairedMesh> repaired = repairMesh(mesh, Repair::Auto);
  if (!repaired.ok()) {
    ADD_FAILURE() << repaired.error().message;
    return {};
  }
  expectSolid(repaired->mesh);
  EXPECT_EQ(repaired->actions.empty(), repaired->rule == Repair::Off);
  return std::move(*repaired);
}

std::string refusal(const TriangleMesh& mesh, Repair rule) {
  const Result<RepairedMesh> repaired = repairMesh(mesh, rule);
  if (repaired.ok()) {
    ADD_FAILURE() << "was accepted";
    return "";
  }
  EXPECT_EQ(repaired.error().code, ErrorCode::UnsuitableMesh);
  return repaired.error().message;
}

TEST(RepairOff, SolidsOfAllKindsPassUntouched) {
  for (const models::Model& model : models::allModels()) {
    if (model.group != models::Group::Closed && model.group != models::Group::Thin) continue;
    SCOPED_TRACE(model.name);
    const TriangleMesh mesh = model.make();
    const RepairedMesh repaired = repairedByAuto(mesh);
    EXPECT_EQ(repaired.rule, Repair::Off);
    EXPECT_EQ(repaired.mesh.vertices, mesh.vertices);
    EXPECT_EQ(repaired.mesh.triangles, mesh.triangles);
    EXPECT_EQ(repaired.wrapOffset, 0);
  }
}

TEST(RepairOff, CavitiesOverlapsAndSharedEdgesAreSolidsToo) {
  EXPECT_EQ(repairedByAuto(models::makeHollowBall(2, 1, 2)).rule, Repair::Off);
  EXPECT_EQ(repairedByAuto(models::makeTangentBalls(1, 2)).rule, Repair::Off);
  const TriangleMesh box = models::makeBox({1, 1, 1});
  EXPECT_EQ(repairedByAuto(joined(box, box, {0.5, 0.5, 0.5})).rule, Repair::Off);
  // Two boxes that share an edge: four triangles on it, two in each direction.
  EXPECT_EQ(repairedByAuto(joined(box, box, {1, 1, 0})).rule, Repair::Off);
}

TEST(RepairOff, NamesWhatIsWrongAndWhatWouldHelp) {
  EXPECT_THAT(refusal({}, Repair::Off), HasSubstr("no triangle"));
  EXPECT_THAT(refusal({{{0, 0, 0}}, {{0, 1, 2}}}, Repair::Auto), HasSubstr("vertex that is not there"));
  EXPECT_THAT(refusal({{{0, 0, 0}, {1, 0, 0}, {0, std::numeric_limits<double>::quiet_NaN(), 0}}, {{0, 1, 2}}},
                      Repair::Auto),
              HasSubstr("not a finite"));
  EXPECT_THAT(refusal(openBox(), Repair::Off),
              HasSubstr("4 boundary edges; repair rule fill or wrap may help"));
  TriangleMesh flipped = models::makeBox({1, 1, 1});
  std::swap(flipped.triangles[0][0], flipped.triangles[0][1]);
  EXPECT_THAT(refusal(flipped, Repair::Off),
              HasSubstr("3 edges with two triangles that disagree; repair rule orient"));
  EXPECT_THAT(refusal(turnedOver(models::makeBox({1, 1, 1})), Repair::Off),
              HasSubstr("1 shell of the mesh is inside out"));
  TriangleMesh sheet = oneTriangle();
  sheet.triangles.push_back({1, 0, 2});
  EXPECT_THAT(refusal(sheet, Repair::Off), HasSubstr("encloses no volume"));
}

TEST(RepairOrient, FlippedTrianglesAgreeAgain) {
  TriangleMesh mesh = models::makeTorus(2, 0.5, 24, 12);
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 3)
    std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
  const RepairedMesh repaired = repairedByAuto(mesh);
  EXPECT_EQ(repaired.rule, Repair::Orient);
  EXPECT_THAT(repaired.actions, testing::ElementsAre("Turned 192 triangles to agree with the neighbours."));
  EXPECT_NEAR(medial::signedVolumeOf(repaired.mesh),
              medial::signedVolumeOf(models::makeTorus(2, 0.5, 24, 12)), 1e-12);
}

TEST(RepairOrient, InsideOutThingsAreTurnedAndCavitiesKept) {
  const TriangleMesh box = models::makeBox({1, 1, 1});
  const RepairedMesh turned = repairedByAuto(turnedOver(box));
  EXPECT_EQ(turned.rule, Repair::Orient);
  EXPECT_THAT(turned.actions, testing::ElementsAre("Turned 1 shell outwards."));
  EXPECT_DOUBLE_EQ(medial::signedVolumeOf(turned.mesh), 1);

  const TriangleMesh hollow = models::makeHollowBall(2, 1, 2);
  const RepairedMesh hollowAgain = repairedByAuto(turnedOver(hollow));
  EXPECT_NEAR(medial::signedVolumeOf(hollowAgain.mesh), medial::signedVolumeOf(hollow), 1e-12);

  // One of two boxes side by side, the bigger or the smaller.
  for (const double size : {0.5, 2.0}) {
    const RepairedMesh pair =
        repairedByAuto(joined(box, turnedOver(models::makeBox({size, size, size})), {5, 0, 0}));
    EXPECT_EQ(pair.rule, Repair::Orient);
    EXPECT_DOUBLE_EQ(medial::signedVolumeOf(pair.mesh), 1 + size * size * size);
  }
  // Two that share an edge, one of them inside out: balanced, yet half of it would be missing.
  const RepairedMesh sharing = repairedByAuto(joined(box, turnedOver(box), {1, 1, 0}));
  EXPECT_DOUBLE_EQ(medial::signedVolumeOf(sharing.mesh), 2);
}

TEST(RepairOrient, UnweldedTrianglesAreJoined) {
  const TriangleMesh box = models::makeBox({2, 3, 5});
  TriangleMesh loose;
  for (std::size_t t = 0; t < box.triangles.size(); ++t) {
    const auto base = static_cast<std::uint32_t>(loose.vertices.size());
    for (std::size_t k = 0; k < 3; ++k) loose.vertices.push_back(box.corner(t, k));
    loose.triangles.push_back({base, base + 1, base + 2});
  }
  const RepairedMesh repaired = repairedByAuto(loose);
  EXPECT_EQ(repaired.rule, Repair::Orient);
  EXPECT_THAT(repaired.actions, testing::ElementsAre("Welded 28 vertices to others at the same position."));
  EXPECT_EQ(repaired.mesh.vertices.size(), 8U);
}

TEST(RepairOrient, RefusesWhatIsOpen) {
  EXPECT_THAT(refusal(openBox(), Repair::Orient), HasSubstr("the mesh is open: 4 boundary edges"));
}

TEST(RepairFill, AnOpenBoxGetsItsLid) {
  const RepairedMesh repaired = repairedByAuto(openBox());
  EXPECT_EQ(repaired.rule, Repair::Fill);
  EXPECT_EQ(repaired.filledHoles, 1U);
  EXPECT_THAT(repaired.actions, testing::ElementsAre("Filled 1 hole with 2 triangles."));
  EXPECT_DOUBLE_EQ(medial::signedVolumeOf(repaired.mesh), 30);
  EXPECT_EQ(repaired.mesh.vertices.size(), 8U);
}

TEST(RepairFill, ATubeGetsTwoCapsWhicheverWayItFaces) {
  // 1000 segments: rims longer than the cubic search would bear.
  for (const std::uint32_t segments : {6U, 64U, 1000U}) {
    TriangleMesh tube = models::makeCylinder(1, 2, segments);
    std::erase_if(tube.triangles, [&](const auto& t) {
      return tube.vertices[t[0]].z() == tube.vertices[t[1]].z() &&
             tube.vertices[t[1]].z() == tube.vertices[t[2]].z();
    });
    for (const TriangleMesh& mesh : {tube, turnedOver(tube)}) {
      const RepairedMesh repaired = repairedByAuto(mesh);
      EXPECT_EQ(repaired.rule, Repair::Fill);
      EXPECT_EQ(repaired.filledHoles, 2U);
      const double count = segments;
      EXPECT_NEAR(medial::signedVolumeOf(repaired.mesh), count * std::sin(2 * std::numbers::pi / count),
                  1e-9);
    }
  }
}

TEST(RepairFill, EveryMissingTriangleOfABallIsFound) {
  TriangleMesh ball = models::makeBall(1, 3);
  const double volume = medial::signedVolumeOf(ball);
  std::size_t count = 0;
  std::erase_if(ball.triangles, [&](const auto&) { return count++ % 40 == 0; });
  const RepairedMesh repaired = repairedByAuto(ball);
  EXPECT_EQ(repaired.rule, Repair::Fill);
  EXPECT_EQ(repaired.mesh.triangles.size(), ball.triangles.size() + 32);
  EXPECT_NEAR(medial::signedVolumeOf(repaired.mesh), volume, 1e-12);
}

TEST(RepairFill, RefusesSheetsAndFins) {
  EXPECT_THAT(refusal(oneTriangle(), Repair::Fill), HasSubstr("wrap"));
  EXPECT_THAT(refusal(joined(models::makeBox({1, 1, 1}), oneTriangle(), {3, 0, 0}), Repair::Fill),
              HasSubstr("1 part of the mesh is a flat sheet"));
  TriangleMesh fin = models::makeBox({1, 1, 1});
  fin.vertices.emplace_back(3, 4, 5);
  fin.triangles.push_back({fin.triangles[0][0], fin.triangles[0][1], 8});
  EXPECT_THAT(refusal(fin, Repair::Fill), HasSubstr("1 edge with more than two triangles"));
}

/// The wrap of a mesh holds its vertices inside, stands off as it says, and is a decent mesh.
void expectWrapped(const TriangleMesh& mesh, const RepairedMesh& repaired) {
  EXPECT_EQ(repaired.rule, Repair::Wrap);
  EXPECT_FALSE(repaired.actions.empty());
  const MeshCheck check = checkMesh(repaired.mesh);
  EXPECT_TRUE(check.closed && check.manifold && check.oriented);
  EXPECT_EQ(check.selfIntersections, 0U);
  EXPECT_GT(check.volume, 0);
  EXPECT_GT(repaired.wrapOffset, 0);
  EXPECT_LT(repaired.wrapOffset, medial::diagonalOf(mesh));
  const Result<medial::Surface> surface = medial::Surface::create(repaired.mesh);
  ASSERT_TRUE(surface.ok()) << surface.error().message;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const Vector3d& weight : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1),
                                   Vector3d(1.0 / 3, 1.0 / 3, 1.0 / 3), Vector3d(0.5, 0.5, 0)}) {
      const Vector3d point =
          mesh.corner(t, 0) * weight[0] + mesh.corner(t, 1) * weight[1] + mesh.corner(t, 2) * weight[2];
      EXPECT_GT(surface.value().depth(point), 0)
          << "triangle " << t << " sticks out at " << point.transpose();
    }
  }
}

TEST(RepairWrap, ASingleTriangleBecomesAThinSolid) {
  const RepairedMesh repaired = repairedByAuto(oneTriangle());
  expectWrapped(oneTriangle(), repaired);
  // Everything within the stand-off of a triangle of area 1/2 and perimeter 2 + sqrt(2).
  const double d = repaired.wrapOffset;
  EXPECT_LT(medial::signedVolumeOf(repaired.mesh), 2 * d * 0.5 +
                                                       std::numbers::pi / 2 * d * d * (2 + std::sqrt(2.0)) +
                                                       4 * std::numbers::pi / 3 * d * d * d);
}

TEST(RepairWrap, FallsToItWhenFillingWouldNotDo) {
  TriangleMesh fin = models::makeBox({0.1, 0.1, 1});
  fin.vertices.emplace_back(0.2, 0.2, 0);
  fin.triangles.push_back({fin.triangles[0][0], fin.triangles[0][1], 8});
  expectWrapped(fin, repairedByAuto(fin));

  // Two triangles, each with its own back: closed and balanced, but without an inside.
  TriangleMesh doubled;
  doubled.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 0.3, 0}, {0.5, -0.1, 0.2}};
  doubled.triangles = {{0, 1, 2}, {1, 0, 3}, {1, 0, 2}, {0, 1, 3}};
  EXPECT_TRUE(medial::boundsVolume(doubled));
  expectWrapped(doubled, repairedByAuto(doubled));
}

TEST(RepairWrap, AMoebiusStripHasNoOtherWay) {
  TriangleMesh strip;
  constexpr std::uint32_t kSteps = 40;
  for (std::uint32_t k = 0; k < kSteps; ++k) {
    const double angle = 2 * std::numbers::pi * k / kSteps;
    const Vector3d out(std::cos(angle), std::sin(angle), 0);
    const Vector3d rung = 0.3 * (std::cos(angle / 2) * out + std::sin(angle / 2) * Vector3d::UnitZ());
    strip.vertices.push_back(out - rung);
    strip.vertices.push_back(out + rung);
  }
  for (std::uint32_t k = 0; k < kSteps; ++k) {
    const bool last = k + 1 == kSteps;  // where it closes, the two rims change places
    const std::uint32_t a = 2 * k, b = 2 * k + 1, c = last ? 1 : 2 * k + 2, d = last ? 0 : 2 * k + 3;
    strip.triangles.push_back({a, c, b});
    strip.triangles.push_back({b, c, d});
  }
  EXPECT_THAT(refusal(strip, Repair::Fill), HasSubstr("one-sided"));
  expectWrapped(strip, repairedByAuto(strip));
}

TEST(RepairWrap, OnRequestAndFarFromTheOrigin) {
  TriangleMesh pipe = models::makeBox({1, 1, 8});
  std::erase_if(pipe.triangles, [&](const auto& t) {
    return (pipe.vertices[t[0]] + pipe.vertices[t[1]] + pipe.vertices[t[2]]).z() > 11;
  });
  ASSERT_EQ(pipe.triangles.size(), 10U);
  for (Vector3d& vertex : pipe.vertices) vertex += Vector3d(1e4, -2e4, 3e4);
  const Result<RepairedMesh> repaired = repairMesh(pipe, Repair::Wrap);
  ASSERT_TRUE(repaired.ok()) << repaired.error().message;
  expectWrapped(pipe, repaired.value());
  // The wrap goes in through the open end: walls, not a full box.
  EXPECT_LT(medial::signedVolumeOf(repaired.value().mesh), 0.2 * 8);
}

TEST(RepairMesh, IsTheSameEveryTime) {
  const RepairedMesh first = repairedByAuto(oneTriangle());
  const RepairedMesh second = repairedByAuto(oneTriangle());
  EXPECT_EQ(first.mesh.vertices, second.mesh.vertices);
  EXPECT_EQ(first.mesh.triangles, second.mesh.triangles);
  EXPECT_EQ(first.wrapOffset, second.wrapOffset);
}

}  // namespace
}  // namespace spheretree::io
