// SPDX-License-Identifier: GPL-3.0-or-later
//
// `export` and `urdf` as a user runs them. What they write is read by programs of other people where these
// are installed: check_urdf (liburdfdom-tools), Python's YAML, JSON and XML parsers.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/cli/program.hpp"

namespace spheretree::tests {
namespace {

using Point = std::array<double, 3>;
using Names = std::vector<std::string>;

struct Ball {
  Point center{};
  double radius = 0;
};

bool isInstalled(const std::string& check) {
  return std::system((check + " >/dev/null 2>&1").c_str()) == 0;
}

class Export : public ProgramTest {
 protected:
  Export() { write("box.sph", classicBoxTree()); }

  /// What a shell command prints in the test's folder; fails the test when it fails.
  std::string shell(const std::string& command) {
    const Finished finished = finish(start("/bin/sh", {"-c", command}));
    EXPECT_EQ(finished.exitCode, 0) << command << "\n" << finished.err;
    return finished.out;
  }
  /// check_urdf (liburdfdom) ends well whatever it complains about: what counts is that it says nothing.
  std::string complaintsOfUrdfdom(const std::string& file) {
    const Finished finished = finish(start("/bin/sh", {"-c", "check_urdf " + file}));
    return finished.exitCode == 0 ? finished.err : finished.err + "code " + std::to_string(finished.exitCode);
  }
  std::string python(const std::string& program) { return shell("/usr/bin/python3 -c '" + program + "'"); }
};

TEST_F(Export, CheckUrdfTakesARobotOfBalls) {
  if (!isInstalled("command -v check_urdf")) GTEST_SKIP() << "check_urdf (liburdfdom-tools) is not installed";
  ASSERT_EQ(run({"export", "box.sph", "-o", "box.urdf"}).exitCode, 0);
  EXPECT_EQ(complaintsOfUrdfdom("box.urdf"), "");
  EXPECT_NE(shell("check_urdf box.urdf").find("root Link: box has 0 child"), std::string::npos);
  const std::string text = read("box.urdf");
  const std::regex sphere("<sphere radius=");
  EXPECT_EQ(std::distance(std::sregex_iterator(text.begin(), text.end(), sphere), std::sregex_iterator()), 8);
}

// A reader that takes anything would prove nothing.
TEST_F(Export, TheReadersRefuseWhatIsSpoiled) {
  if (!isInstalled("command -v check_urdf")) GTEST_SKIP() << "check_urdf (liburdfdom-tools) is not installed";
  if (!isInstalled("/usr/bin/python3 -c 'import yaml'")) GTEST_SKIP() << "python3-yaml is not installed";
  for (const char* name : {"a.json", "a.srdf", "a.yml", "a.urdf"})
    ASSERT_EQ(run({"export", "box.sph", "-o", name}).exitCode, 0);
  const auto refused = [this](const std::string& command) {
    return finish(start("/bin/sh", {"-c", command})).exitCode != 0;
  };
  const auto spoil = [this](const std::string& name, const std::string& what, const std::string& with) {
    std::string text = read(name);
    const std::size_t at = text.rfind(what);
    ASSERT_NE(at, std::string::npos) << name;
    write(name, text.replace(at, what.size(), with));
  };
  const std::string whole = read("a.urdf");
  for (const auto& [what, with] : std::vector<std::pair<std::string, std::string>>{
           {"<sphere radius=", "<sphere size="}, {"xyz=\"", "xyz=\"a"}, {"</geometry>", ""}}) {
    write("a.urdf", whole);
    EXPECT_EQ(complaintsOfUrdfdom("a.urdf"), "");
    spoil("a.urdf", what, with);
    EXPECT_NE(complaintsOfUrdfdom("a.urdf"), "") << what;
  }
  spoil("a.yml", "]", "");
  EXPECT_TRUE(refused("/usr/bin/python3 -c 'import yaml; yaml.safe_load(open(\"a.yml\"))'"));
  spoil("a.json", "]", "");
  EXPECT_TRUE(refused("/usr/bin/python3 -c 'import json; json.load(open(\"a.json\"))'"));
  spoil("a.srdf", "/>", ">");
  EXPECT_TRUE(refused("/usr/bin/python3 -c 'import xml.etree.ElementTree as x; x.parse(\"a.srdf\")'"));
}

TEST_F(Export, OtherParsersReadTheSameBalls) {
  if (!isInstalled("/usr/bin/python3 -c 'import yaml'")) GTEST_SKIP() << "python3-yaml is not installed";
  for (const char* name : {"a.json", "a.srdf", "a.yml", "a.urdf"})
    ASSERT_EQ(run({"export", "box.sph", "-o", name, "--name", "my box"}).exitCode, 0);
  ASSERT_EQ(run({"export", "box.sph", "-o", "foam.json", "--format", "foam"}).exitCode, 0);
  EXPECT_EQ(python(R"(
import json, yaml, xml.etree.ElementTree as xml
ours = json.load(open("a.json"))["levels"][1]["spheres"]
ours = [tuple(s["center"]) + (s["radius"],) for s in ours]
links = yaml.safe_load(open("a.yml"))["collision_spheres"]
curobo = [tuple(s["center"]) + (s["radius"],) for s in links["my box"]]
link = xml.parse("a.srdf").getroot().find("link_sphere_approximation")
srdf = [tuple(map(float, s.get("center").split())) + (float(s.get("radius")),) for s in link]
balls = xml.parse("a.urdf").getroot().find("link").findall("collision")
urdf = [tuple(map(float, b.find("origin").get("xyz").split())) + (float(b.find("geometry/sphere").get("radius")),)
        for b in balls]
foam = [tuple(s["origin"]) + (s["radius"],) for s in json.load(open("foam.json"))[1]["spheres"]]
print(len(ours), curobo == ours, srdf == ours, foam == ours, urdf == ours, link.get("link"))
)"),
            "8 True True True True my box\n");
}

TEST_F(Export, ALevelCanBeChosen) {
  ASSERT_EQ(run({"export", "box.sph", "-o", "root.srdf", "--level", "0"}).exitCode, 0);
  const std::string text = read("root.srdf");
  EXPECT_EQ(text.find("<sphere "), text.rfind("<sphere "));
  const Finished missing = run({"export", "box.sph", "-o", "no.srdf", "--level", "7"});
  EXPECT_EQ(missing.exitCode, 2);
  EXPECT_EQ(missing.err, "spheretree: box.sph: has no level 7: its levels are 0 to 1\n");
}

TEST_F(Export, MistakesWriteNothing) {
  write("there.glb", "precious");
  const Names before = names();
  EXPECT_EQ(run({"export", "box.sph", "-o", "a.xyz"}).exitCode, 2);
  EXPECT_EQ(run({"export", "box.sph", "-o", "a.glb", "--format", "fbx"}).exitCode, 2);
  EXPECT_EQ(run({"export", "no.sph", "-o", "a.glb"}).exitCode, 3);
  EXPECT_EQ(run({"export", "box.sph", "-o", "there.glb"}).exitCode, 6);
  EXPECT_EQ(run({"export", "box.sph", "-o", "box.sph", "--format", "json", "--force"}).exitCode, 2);
  EXPECT_EQ(names(), before);
  EXPECT_EQ(read("there.glb"), "precious");
}

// --- robots ---

/// Around what is replaced stands much that must survive.
std::string arm() {
  return R"(<?xml version="1.0"?>
<!-- An arm > of two links. -->
<robot name="arm"   version='1.0'>
  <link name="base">
    <inertial><mass value="1e0"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
    <visual><geometry><box size="9 9 9"/></geometry></visual>
    <collision name="foot">
      <!-- keep me -->
      <origin xyz="0 0 0.5"/>
      <geometry><sphere radius="0.5"/></geometry>
    </collision>
  </link>
  <joint name="shoulder" type="fixed"><parent link="base"/><child link="upper"/></joint>
  <link name="upper">
	<collision name="beam">
	  <!-- a box -->
	  <origin xyz="1 2 3" rpy="0.5 -0.25 2"/>
	  <geometry><mesh filename="package://arm_parts/box.obj" scale="2 -0.5 0.25"/></geometry>
	</collision>
  </link>
  <gazebo><collision>not ours</collision></gazebo>
</robot>
)";
}

class Urdf : public Export {
 protected:
  Urdf() {
    std::filesystem::create_directories(folder_ / "parts");
    write("parts/box.obj", boxObj());
    write("arm.urdf", arm());
  }
  void SetUp() override {
    write("empty.urdf", "<robot name=\"r\"/>");
    const Finished finished = run({"urdf", "empty.urdf", "-o", "empty-out.urdf"});
    if (finished.err.find("libtinyxml2-dev") != std::string::npos) GTEST_SKIP() << finished.err;
  }
  static Names command(Names more = {}) {
    Names words{"urdf", "arm.urdf", "-o", "out.urdf", "--package", "arm_parts=parts", "--quality", "fast"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
};

std::vector<Ball> ballsOf(const std::string& urdf) {
  const std::string number = "([-+.0-9e]+)";
  const std::regex pattern("<origin xyz=\"" + number + " " + number + " " + number +
                           "\" rpy=\"0 0 0\"/>\\s*<geometry><sphere radius=\"" + number + "\"/>");
  std::vector<Ball> balls;
  for (std::sregex_iterator at(urdf.begin(), urdf.end(), pattern), end; at != end; ++at) {
    const auto value = [&](std::size_t k) { return std::stod((*at)[k].str()); };
    balls.push_back({{value(1), value(2), value(3)}, value(4)});
  }
  return balls;
}

/// roll 0.5, then pitch -0.25, then yaw 2 about fixed axes, then the shift: written out, not reused.
Point placed(Point p) {
  const double cr = std::cos(0.5), sr = std::sin(0.5);
  p = {p[0], cr * p[1] - sr * p[2], sr * p[1] + cr * p[2]};
  const double cp = std::cos(-0.25), sp = std::sin(-0.25);
  p = {cp * p[0] + sp * p[2], p[1], -sp * p[0] + cp * p[2]};
  const double cy = std::cos(2.0), sy = std::sin(2.0);
  p = {cy * p[0] - sy * p[1], sy * p[0] + cy * p[1], p[2]};
  return {p[0] + 1, p[1] + 2, p[2] + 3};
}

double distance(const Point& a, const Point& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// A grid over the six faces of the mesh as the robot has it: 2 x 0.5 x 0.25 around the origin, then placed.
std::vector<Point> surfaceOfBeam() {
  constexpr int kSteps = 24;
  std::vector<Point> points;
  const auto at = [](int k) { return static_cast<double>(k) / kSteps - 0.5; };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double side : {-0.5, 0.5}) {
      for (int i = 0; i <= kSteps; ++i) {
        for (int j = 0; j <= kSteps; ++j) {
          Point p{};
          p[axis] = side;
          p[(axis + 1) % 3] = at(i);
          p[(axis + 2) % 3] = at(j);
          points.push_back(placed({p[0] * 2, p[1] * -0.5, p[2] * 0.25}));
        }
      }
    }
  }
  return points;
}

TEST_F(Urdf, BallsCoverTheMeshWhereTheRobotHasIt) {
  const Finished finished = run(command());
  ASSERT_EQ(finished.exitCode, 0) << finished.err;
  const std::vector<Ball> balls = ballsOf(read("out.urdf"));
  ASSERT_GE(balls.size(), 8U);
  ASSERT_LE(balls.size(), 32U);
  for (const Point& p : surfaceOfBeam()) {
    EXPECT_TRUE(std::any_of(balls.begin(), balls.end(),
                            [&](const Ball& b) { return distance(p, b.center) <= b.radius * (1 + 1e-9); }))
        << p[0] << " " << p[1] << " " << p[2];
  }
  // And they are about as large as the beam is thick, not balls around somewhere else.
  for (const Ball& ball : balls) EXPECT_LT(ball.radius, 0.5);
}

TEST_F(Urdf, EverythingElseStaysToTheByte) {
  ASSERT_EQ(run(command()).exitCode, 0);
  const std::string before = arm();
  const std::string after = read("out.urdf");
  const std::size_t from = before.find("<collision name=\"beam\">");
  const std::size_t behind = before.find("\n  </link>\n  <gazebo>");
  EXPECT_EQ(after.substr(0, from), before.substr(0, from));
  const std::string tail = before.substr(behind);
  EXPECT_EQ(after.substr(after.size() - tail.size()), tail);
  EXPECT_NE(after.find("\t<!-- a box -->\n\t<collision name=\"beam_0\">"), std::string::npos);
  EXPECT_EQ(after.find("box.obj"), std::string::npos);
}

TEST_F(Urdf, PrintsATableOfLinksAndWritesForPlanners) {
  const Finished finished = run(command({"--srdf", "out.srdf", "--curobo", "out.yml"}));
  ASSERT_EQ(finished.exitCode, 0) << finished.err;
  for (const char* word : {"base", "sphere", "exact", "upper", "package://arm_parts/box.obj",
                           "arm: ", "wrote out.urdf", "wrote out.srdf", "wrote out.yml"})
    EXPECT_NE(finished.out.find(word), std::string::npos) << word << " in\n" << finished.out;
  EXPECT_NE(read("out.srdf").find("<sphere center=\"0 0 0.5\" radius=\"0.5\"/>"), std::string::npos);
  EXPECT_NE(read("out.yml").find("  \"upper\":\n"), std::string::npos);
}

TEST_F(Urdf, CheckUrdfTakesTheResult) {
  if (!isInstalled("command -v check_urdf")) GTEST_SKIP() << "check_urdf (liburdfdom-tools) is not installed";
  ASSERT_EQ(run(command()).exitCode, 0);
  EXPECT_EQ(complaintsOfUrdfdom("out.urdf"), "");
  EXPECT_NE(shell("check_urdf out.urdf").find("child(1):  upper"), std::string::npos);
}

TEST_F(Urdf, PackagesAreFoundAroundTheRobotAndOnThePath) {
  std::filesystem::create_directories(folder_ / "ws/arm_parts");
  write("ws/arm_parts/box.obj", boxObj());
  EXPECT_EQ(run({"urdf", "arm.urdf", "-o", "a.urdf"}).exitCode, 3);
  ::setenv("ROS_PACKAGE_PATH", (folder_ / "ws").c_str(), 1);
  const Finished onPath = run({"urdf", "arm.urdf", "-o", "b.urdf", "--quality", "fast"});
  ::unsetenv("ROS_PACKAGE_PATH");
  EXPECT_EQ(onPath.exitCode, 0) << onPath.err;
  std::filesystem::create_directories(folder_ / "ws/arm_description/urdf");
  write("ws/arm_description/urdf/arm.urdf", arm());
  const Finished around =
      run({"urdf", "ws/arm_description/urdf/arm.urdf", "-o", "c.urdf", "--quality", "fast"});
  EXPECT_EQ(around.exitCode, 0) << around.err;
  EXPECT_EQ(read("b.urdf"), read("c.urdf"));
}

TEST_F(Urdf, MistakesNameLinkAndFileAndWriteNothing) {
  write("wrong.json", "{\"links\": {\"hand\": 3}}");
  write("parts/open.obj", openBoxObj());
  std::string open = arm();
  open.replace(open.find("box.obj"), 7, "open.obj");
  write("open.urdf", open);
  const Names before = names();
  const Finished nowhere = run({"urdf", "arm.urdf", "-o", "out.urdf"});
  EXPECT_EQ(nowhere.exitCode, 3);
  EXPECT_EQ(
      nowhere.err,
      "spheretree: arm.urdf: link 'upper': mesh package://arm_parts/box.obj: package 'arm_parts' is not "
      "found; --package arm_parts=FOLDER says where it is\n");
  const Finished hand = run(command({"--budgets", "wrong.json"}));
  EXPECT_EQ(hand.exitCode, 2);
  EXPECT_NE(hand.err.find("has no link 'hand'"), std::string::npos) << hand.err;
  const Finished unsuitable =
      run({"urdf", "open.urdf", "-o", "out.urdf", "--package", "arm_parts=parts", "--repair", "off"});
  EXPECT_EQ(unsuitable.exitCode, 4);
  EXPECT_NE(unsuitable.err.find("link 'upper': mesh parts/open.obj"), std::string::npos) << unsuitable.err;
  EXPECT_EQ(run(command({"--package", "nonsense"})).exitCode, 2);
  EXPECT_EQ(run({"urdf", "arm.urdf", "-o", "arm.urdf", "--force"}).exitCode, 2);
  EXPECT_EQ(names(), before);
}

}  // namespace
}  // namespace spheretree::tests
