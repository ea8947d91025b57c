// SPDX-License-Identifier: GPL-3.0-or-later
//
// spheretree mesh, on a mesh of every kind.
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/program.hpp"

namespace spheretree::tests {
namespace {

using Json = nlohmann::json;
using Names = std::vector<std::string>;

class Mesh : public ProgramTest {
 protected:
  Json inspected(const std::vector<std::string>& arguments) {
    const Finished finished = run(arguments);
    EXPECT_EQ(finished.exitCode, 0) << finished.err;
    return Json::parse(finished.out, nullptr, false);
  }
};

/// Every face of the box the other way round.
std::string insideOutBoxObj() {
  const std::string box = boxObj();
  return box.substr(0, box.find("f ")) + "f 2 3 4 1\nf 5 6 2 1\nf 6 7 3 2\nf 7 8 4 3\nf 8 5 1 4\nf 8 7 6 5\n";
}

/// Two boxes that share one edge.
std::string edgeToEdgeObj() {
  std::string text = boxObj();
  const std::string other = boxObj(1, 1, 0);
  text += other.substr(0, other.find("f "));
  return text + "f 9 12 11 10\nf 9 10 14 13\nf 10 11 15 14\nf 11 12 16 15\nf 12 9 13 16\nf 13 14 15 16\n";
}

TEST_F(Mesh, AClosedMeshBoundsASolid) {
  write("box.obj", boxObj());
  const Json report = inspected({"mesh", "box.obj", "--json"});
  for (const char* key : {"tool", "mesh", "bounds_solid", "reason", "result"})
    EXPECT_TRUE(report.contains(key)) << key;
  EXPECT_TRUE(report.at("bounds_solid").get<bool>());
  EXPECT_TRUE(report.at("result").is_null());
  const Json& mesh = report.at("mesh");
  EXPECT_EQ(mesh.at("triangles"), 12);
  EXPECT_EQ(mesh.at("vertices"), 8);
  EXPECT_EQ(mesh.at("genus"), 0);
  EXPECT_EQ(mesh.at("import").at("triangulated"), 6);
  EXPECT_DOUBLE_EQ(mesh.at("volume").get<double>(), 1);
  EXPECT_DOUBLE_EQ(mesh.at("area").get<double>(), 6);
  EXPECT_EQ(names(), Names{"box.obj"});
}

TEST_F(Mesh, InspectingReportsAnUnsuitableMeshAndSucceeds) {
  write("open.obj", openBoxObj());
  const Finished text = run({"mesh", "open.obj"});
  EXPECT_EQ(text.exitCode, 0) << text.err;
  EXPECT_NE(text.out.find("no: 4 boundary edges"), std::string::npos) << text.out;
  const Json report = inspected({"mesh", "open.obj", "--json"});
  EXPECT_FALSE(report.at("bounds_solid").get<bool>());
  EXPECT_TRUE(report.at("reason").is_string());
  EXPECT_FALSE(report.at("mesh").at("closed").get<bool>());
}

TEST_F(Mesh, ARepairCanBeTriedWithoutWriting) {
  write("open.obj", openBoxObj());
  const Json report = inspected({"mesh", "open.obj", "--repair", "fill", "--json"});
  EXPECT_EQ(report.at("result").at("repair").at("rule"), "fill");
  EXPECT_TRUE(report.at("result").at("path").is_null());
  EXPECT_NEAR(report.at("result").at("volume").get<double>(), 1, 1e-12);
  EXPECT_EQ(run({"mesh", "open.obj", "--repair", "orient"}).exitCode, 4);
  EXPECT_EQ(names(), Names{"open.obj"});
}

TEST_F(Mesh, AnInsideOutMeshIsTurned) {
  write("in.obj", insideOutBoxObj());
  EXPECT_FALSE(inspected({"mesh", "in.obj", "--json"}).at("bounds_solid").get<bool>());
  EXPECT_EQ(run({"mesh", "in.obj", "-o", "out.obj"}).exitCode, 0);
  EXPECT_DOUBLE_EQ(inspected({"mesh", "out.obj", "--json"}).at("mesh").at("volume").get<double>(), 1);
}

TEST_F(Mesh, ANonManifoldMeshMayStillBoundASolid) {
  write("edge.obj", edgeToEdgeObj());
  const Json report = inspected({"mesh", "edge.obj", "--json"});
  EXPECT_FALSE(report.at("mesh").at("manifold").get<bool>());
  EXPECT_TRUE(report.at("bounds_solid").get<bool>());
  EXPECT_DOUBLE_EQ(report.at("mesh").at("volume").get<double>(), 2);
  EXPECT_EQ(run({"build", "edge.obj", "-o", "edge.sph", "--levels", "2", "--builder", "octree"}).exitCode, 0);
}

TEST_F(Mesh, ALoneTriangleIsWrapped) {
  write("leaf.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Json report = inspected({"mesh", "leaf.obj", "-o", "leaf.off", "--json"});
  EXPECT_EQ(report.at("result").at("repair").at("rule"), "wrap");
  EXPECT_GT(report.at("result").at("repair").at("wrap_stand_off").get<double>(), 0);
  EXPECT_TRUE(inspected({"mesh", "leaf.off", "--json"}).at("bounds_solid").get<bool>());
}

TEST_F(Mesh, DegenerateAndDuplicateTrianglesAreCounted) {
  write("dirty.obj", boxObj() + "f 1 1 2\nf 1 4 3\n");
  const Json import = inspected({"mesh", "dirty.obj", "--json"}).at("mesh").at("import");
  EXPECT_EQ(import.at("degenerate_triangles"), 1);
  EXPECT_EQ(import.at("duplicate_triangles"), 1);
}

TEST_F(Mesh, EveryWritableFormatReadsBack) {
  write("box.obj", boxObj(3, 4, 5));
  for (const char* output : {"out.obj", "out.off", "out.ply", "out.stl"}) {
    SCOPED_TRACE(output);
    const Finished written = run({"mesh", "box.obj", "-o", output});
    EXPECT_EQ(written.exitCode, 0) << written.err;
    EXPECT_NE(written.out.find(std::string("wrote ") + output), std::string::npos);
    const Json mesh = inspected({"mesh", output, "--json"}).at("mesh");
    EXPECT_EQ(mesh.at("triangles"), 12);
    EXPECT_EQ(mesh.at("vertices"), 8);
    EXPECT_NEAR(mesh.at("volume").get<double>(), 1, 1e-6);
  }
}

TEST_F(Mesh, SimplifyingKeepsTheSolidAndTheLimit) {
  write("leaf.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  ASSERT_EQ(run({"mesh", "leaf.obj", "-o", "wrap.obj"}).exitCode, 0);
  const Json report = inspected({"mesh", "wrap.obj", "-o", "small.obj", "--simplify", "100", "--json"});
  EXPECT_LE(report.at("result").at("triangles").get<int>(), 100);
  EXPECT_GT(report.at("result").at("triangles_before_simplifying").get<int>(), 100);
  EXPECT_TRUE(inspected({"mesh", "small.obj", "--json"}).at("bounds_solid").get<bool>());
}

TEST_F(Mesh, OutputsAreProtected) {
  write("box.obj", boxObj());
  write("out.obj", "precious");
  EXPECT_EQ(run({"mesh", "box.obj", "-o", "out.obj"}).exitCode, 6);
  EXPECT_EQ(run({"mesh", "box.obj", "-o", "box.obj", "--force"}).exitCode, 2);
  EXPECT_EQ(read("out.obj"), "precious");
  EXPECT_EQ(read("box.obj"), boxObj());
  EXPECT_EQ(run({"mesh", "box.obj", "-o", "out.obj", "--force"}).exitCode, 0);
  EXPECT_NE(read("out.obj"), "precious");
}

}  // namespace
}  // namespace spheretree::tests
