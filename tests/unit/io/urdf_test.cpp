// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/mesh_check.hpp"
#include "io/urdf.hpp"
#include "io/urdf_parts.hpp"
#include "tests/unit/io/test_folder.hpp"

namespace spheretree::io {
namespace {

using Eigen::Vector3d;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> found(std::string_view xml, std::string_view name) {
  std::vector<std::string> texts;
  for (const TextRange& range : elementRanges(xml, name))
    texts.emplace_back(xml.substr(range.begin, range.end - range.begin));
  return texts;
}

TEST(XmlPlaces, ElementsAreFoundWithTheirTags) {
  EXPECT_THAT(found("<a><c x='1'>t</c>\n<c/><b/></a>", "c"), ElementsAre("<c x='1'>t</c>", "<c/>"));
  EXPECT_THAT(found("<a><cc/><c ><c/></c></a>", "c"), ElementsAre("<c ><c/></c>", "<c/>"));
}

TEST(XmlPlaces, WhatOnlyLooksLikeAnElementIsNone) {
  EXPECT_THAT(found("<a><!-- <c/> --><![CDATA[<c/>]]><?c <c/> ?><b t='<c/>' u=\"a>b\"/><c/></a>", "c"),
              ElementsAre("<c/>"));
}

TEST(XmlPlaces, CommentsAreFound) {
  const std::string xml = "<c><!--one--><b t='<!--no-->'/><!-- <b/> --></c>";
  std::vector<std::string> texts;
  for (const TextRange& range : commentRanges(xml))
    texts.push_back(xml.substr(range.begin, range.end - range.begin));
  EXPECT_THAT(texts, ElementsAre("<!--one-->", "<!-- <b/> -->"));
}

/// Closed, consistent, outwards, and of the volume that it should have.
void expectSolid(const medial::TriangleMesh& mesh, double volume, double tolerance) {
  const MeshCheck check = checkMesh(mesh);
  EXPECT_TRUE(check.closed);
  EXPECT_TRUE(check.manifold);
  EXPECT_TRUE(check.oriented);
  EXPECT_EQ(check.components, 1U);
  EXPECT_NEAR(medial::signedVolumeOf(mesh) / volume, 1, tolerance);
}

TEST(Primitives, AreSolidsOfTheRightVolume) {
  using std::numbers::pi;
  expectSolid(boxMesh({1, 2, 3}), 6, 1e-12);
  expectSolid(cylinderMesh(0.5, 2).mesh, pi * 0.25 * 2, 0.01);
  expectSolid(capsuleMesh(0.5, 2).mesh, pi * 0.25 * 2 + 4.0 / 3 * pi * 0.125, 0.01);
  expectSolid(capsuleMesh(0.5, 0).mesh, 4.0 / 3 * pi * 0.125, 0.01);
}

TEST(Primitives, TheStandOffIsThatOfTheFacets) {
  // The middle of a facet is where the mesh is farthest below a cylinder.
  const RoundMesh round = cylinderMesh(2, 1);
  double deepest = 0;
  for (std::size_t t = 0; t < round.mesh.triangles.size(); ++t) {
    const Vector3d& a = round.mesh.corner(t, 0);
    const Vector3d& b = round.mesh.corner(t, 1);
    if (std::abs(std::hypot(a.x(), a.y()) - 2) > 1e-9 || std::abs(std::hypot(b.x(), b.y()) - 2) > 1e-9)
      continue;
    const Vector3d middle = (a + b) / 2;
    deepest = std::max(deepest, 2 - std::hypot(middle.x(), middle.y()));
  }
  EXPECT_NEAR(round.standOff, deepest, 1e-12);
}

class Robot : public tests::InFolder {
 protected:
  void SetUp() override {
    InFolder::SetUp();
    if (!whyNoUrdf().empty()) GTEST_SKIP() << whyNoUrdf();
  }
  RobotSettings fast() const {
    RobotSettings settings;
    settings.build.levels = 2;
    settings.build.branch = 8;
    settings.build.builder = "octree";
    return settings;
  }
  Result<SphereRobot> convert(const std::string& link, const RobotSettings& settings) const {
    const std::string urdf = "<robot name=\"r\"><link name=\"arm\">" + link + "</link></robot>";
    return sphereRobot(put("r.urdf", urdf), settings, medial::Context(1));
  }
  void expectRefused(const std::string& link, const std::string& reason) const {
    const Result<SphereRobot> robot = convert(link, fast());
    ASSERT_FALSE(robot) << link;
    EXPECT_EQ(robot.error().code, ErrorCode::UnreadableInput);
    EXPECT_THAT(robot.error().message, HasSubstr("r.urdf: link 'arm': "));
    EXPECT_THAT(robot.error().message, HasSubstr(reason));
  }
};

std::string collision(const std::string& geometry, const std::string& origin = {}) {
  return "<collision>" + origin + "<geometry>" + geometry + "</geometry></collision>";
}

TEST_F(Robot, ASphereStaysAsItIs) {
  const Result<SphereRobot> robot =
      convert(collision("<sphere radius=\"0.25\"/>", "<origin xyz=\"1 2 3\" rpy=\"1 1 1\"/>"), fast());
  ASSERT_TRUE(robot) << robot.error().message;
  EXPECT_EQ(robot->urdf, contentOf(in("r.urdf")));
  ASSERT_EQ(robot->links().size(), 1U);
  const medial::Ball ball = robot->links()[0].balls.at(0);
  EXPECT_EQ(ball.center, Vector3d(1, 2, 3));
  EXPECT_EQ(ball.radius, 0.25);
}

TEST_F(Robot, RoundBodiesAreHeldWholeNotOnlyTheirFacets) {
  const Result<SphereRobot> robot = convert(collision("<cylinder radius=\"1\" length=\"3\"/>"), fast());
  ASSERT_TRUE(robot) << robot.error().message;
  const std::vector<medial::Ball>& balls = robot->parts.at(0).balls;
  for (int i = 0; i < 720; ++i) {
    for (const double z : {-1.5, -0.7, 0.0, 1.1, 1.5}) {
      const double angle = i * std::numbers::pi / 360;
      const Vector3d p(std::cos(angle), std::sin(angle), z);
      EXPECT_TRUE(std::any_of(balls.begin(), balls.end(),
                              [&](const medial::Ball& b) { return (p - b.center).norm() <= b.radius; }))
          << i << " " << z;
    }
  }
}

TEST_F(Robot, WhatCannotBeReadIsRefusedByName) {
  expectRefused(collision("<mesh filename=\"no.stl\"/>"), "no.stl");
  expectRefused(collision("<mesh filename=\"package://nowhere/a.stl\"/>"), "--package nowhere=");
  expectRefused(collision("<mesh filename=\"http://a/b.stl\"/>"), "'http' is not file or package");
  expectRefused(collision("<mesh/>"), "no filename");
  expectRefused(collision("<box size=\"1 2\"/>"), "the size '1 2' of <box> is not 3 numbers");
  expectRefused(collision("<box size=\"1 2 x\"/>"), "is not 3 numbers");
  expectRefused(collision("<box size=\"1 2 -3\"/>"), "not above 0");
  expectRefused(collision("<cylinder radius=\"nan\" length=\"1\"/>"), "is not a number");
  expectRefused(collision("<cone/>"), "<cone> is not known");
  expectRefused("<collision/>", "no geometry");
  put("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  expectRefused(collision("<mesh filename=\"open.obj\" scale=\"1 0 1\"/>"), "scale of 0");
}

TEST_F(Robot, DocumentsThatAreNoRobotAreRefused) {
  for (const auto& [text, reason] : std::vector<std::pair<std::string, std::string>>{
           {"<robot><link>", "line 1"},
           {"<sdf/>", "no <robot>"},
           {"<robot xmlns:xacro=\"x\">\n<xacro:arm/></robot>", "line 2: <xacro:arm> is xacro"}}) {
    const Result<SphereRobot> robot = sphereRobot(put("r.urdf", text), fast(), medial::Context(1));
    ASSERT_FALSE(robot) << text;
    EXPECT_THAT(robot.error().message, HasSubstr(reason));
  }
}

TEST_F(Robot, BudgetsAreByLink) {
  builders::BuildSettings build = fast().build;
  const auto links = readBudgets(
      put("b.json", R"({"default": 12, "links": {"arm": 1, "hand": {"levels": 3, "max_error": 0.1}}})"),
      build);
  ASSERT_TRUE(links) << links.error().message;
  EXPECT_EQ(build.branch, 12U);
  EXPECT_EQ(build.levels, 2U);
  EXPECT_EQ(links->at("arm").levels, 1U);
  EXPECT_EQ(links->at("hand").levels, 3U);
  EXPECT_EQ(links->at("hand").branch, 12U);
  EXPECT_EQ(links->at("hand").maxError, 0.1);

  RobotSettings settings = fast();
  settings.links["arm"] = links->at("arm");
  const Result<SphereRobot> one = convert(collision("<box size=\"1 1 1\"/>"), settings);
  ASSERT_TRUE(one) << one.error().message;
  EXPECT_EQ(one->parts.at(0).balls.size(), 1U);
  settings.links["leg"] = links->at("arm");
  const Result<SphereRobot> other = convert("", settings);
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().message, HasSubstr("has no link 'leg'"));
}

TEST_F(Robot, WrongBudgetsNameTheLink) {
  for (const auto& [text, reason] : std::vector<std::pair<std::string, std::string>>{
           {"[]", "not a JSON object"},
           {R"({"links": {"arm": 0}})", "link 'arm': 0 is not a whole number"},
           {R"({"links": {"arm": {"sphere": 3}}})", "link 'arm': 'sphere' is not"},
           {R"({"link": 3})", "'link' is neither"},
           {R"({"default": "many"})", "default: is neither"}}) {
    builders::BuildSettings build;
    const auto links = readBudgets(put("b.json", text), build);
    ASSERT_FALSE(links) << text;
    EXPECT_EQ(links.error().code, ErrorCode::UnreadableInput);
    EXPECT_THAT(links.error().message, HasSubstr(reason));
  }
}

}  // namespace
}  // namespace spheretree::io
