// SPDX-License-Identifier: GPL-3.0-or-later
//
// Small files by hand, right and wrong, for the readers of our own.
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/files.hpp"
#include "io/mesh_check.hpp"
#include "io/mesh_import.hpp"
#include "io/mesh_readers.hpp"
#include "medial/triangle_mesh.hpp"
#include "test_folder.hpp"

namespace spheretree::io {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

// A tetrahedron with legs of length 1 on the axes: volume 1/6. Four corners, four faces, outwards.
const std::string kObjVertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
const std::string kObjTetrahedron = kObjVertices + "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
const std::string kOffTetrahedron =
    "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
const std::string kPlyTetrahedron =
    "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";

std::string stlFacet(const std::string& a, const std::string& b, const std::string& c) {
  return "facet normal 0 0 0\n outer loop\n  vertex " + a + "\n  vertex " + b + "\n  vertex " + c +
         "\n endloop\nendfacet\n";
}
const std::string kStlFacets = stlFacet("0 0 0", "0 1 0", "1 0 0") + stlFacet("0 0 0", "1 0 0", "0 0 1") +
                               stlFacet("1 0 0", "0 1 0", "0 0 1") + stlFacet("0 1 0", "0 0 0", "0 0 1");
const std::string kStlTetrahedron = "solid corner of a facet\n" + kStlFacets + "endsolid corner\n";

/// Appends a number's bytes, least significant first.
template <class Number>
void append(std::string& bytes, Number number) {
  for (std::size_t k = 0; k < sizeof(Number); ++k)
    bytes += static_cast<char>((static_cast<std::uint64_t>(number) >> (8 * k)) & 0xffU);
}

std::string binaryStl(std::uint32_t announced, std::uint32_t held, float coordinate = 1) {
  std::string bytes = "solid, but binary";
  bytes.resize(80, '\0');
  append(bytes, announced);
  for (std::uint32_t t = 0; t < held; ++t) {
    for (int k = 0; k < 3; ++k) append(bytes, std::bit_cast<std::uint32_t>(0.0F));
    // Corner k at coordinate * (t + 1) on axis k.
    for (int corner = 0; corner < 3; ++corner) {
      for (int axis = 0; axis < 3; ++axis)
        append(bytes,
               std::bit_cast<std::uint32_t>(axis == corner ? coordinate * static_cast<float>(t + 1) : 0.0F));
    }
    append(bytes, std::uint16_t{0});
  }
  return bytes;
}

class MeshReaders : public tests::InFolder {
 protected:
  void expectTetrahedron(const std::string& name, const std::string& bytes) {
    SCOPED_TRACE(name + ":\n" + bytes.substr(0, 400));
    const Result<ImportedMesh> imported = importMesh(put(name, bytes));
    ASSERT_TRUE(imported.ok()) << imported.error().message;
    const medial::TriangleMesh& mesh = imported.value().mesh;
    EXPECT_EQ(mesh.vertices.size(), 4U);
    EXPECT_EQ(mesh.triangles.size(), 4U);
    EXPECT_TRUE(medial::boundsVolume(mesh));
    EXPECT_DOUBLE_EQ(medial::signedVolumeOf(mesh), 1.0 / 6);
    EXPECT_EQ(imported.value().report.contentHash, contentHash(bytes));
  }

  void expectRefused(const std::string& name, const std::string& bytes, const std::string& why) {
    SCOPED_TRACE(name + ":\n" + bytes.substr(0, 400));
    const Result<ImportedMesh> imported = importMesh(put(name, bytes));
    ASSERT_FALSE(imported.ok());
    EXPECT_EQ(imported.error().code, ErrorCode::UnreadableInput);
    EXPECT_THAT(imported.error().message, StartsWith(in(name).string() + ": "));
    EXPECT_THAT(imported.error().message, HasSubstr(why));
  }
};

TEST_F(MeshReaders, ObjInAllItsSpellings) {
  expectTetrahedron("a.obj", kObjTetrahedron);
  expectTetrahedron("A.OBJ", kObjTetrahedron);
  expectTetrahedron("a.obj", kObjVertices +
                                 "vt 0 0\nvn 0 0 1\nf 1/1 3/1 2/1\nf 1//1 2//1 4//1\nf 2/1/1 3/1/1 4/1/1\n"
                                 "f 3 1/1 4//1\n");
  expectTetrahedron("a.obj", kObjVertices + "f -4 -2 -3\nf -4 -3 -1\nf -3 -2 -1\nf -2 -4 -1");
  expectTetrahedron(
      "a.obj",
      "# no Unix\r\nmtllib none.mtl\r\no a\r\nv 0 0 0\r\nv\t1 0 0 1.0\r\n  v 0 1 0 0.5 0.5 0.5\r\n"
      "v 0 0 1\r\ng one two\r\nusemtl x\r\ns off\r\nf 1\t3  2\r\nl 1 2\r\np 1\r\ng three\r\n"
      "f 1 2 \\\r\n4 # comment\r\nf 2 3 4\r\nf 3 1 4\r\n");
  expectTetrahedron("a.obj", "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n" + kObjVertices);  // faces before vertices
  expectTetrahedron(
      "a.obj", "v +0 -0.0 0e5\nv 1.0 0 1e-999\nv 0 1E0 0\nv 0 0 .1e1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4");
}

TEST_F(MeshReaders, ObjCountsObjectsAndPolygons) {
  const std::string cube =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\no first\nf 4 3 2 1\nf 5 6 7 "
      "8\n"
      "g empty\ng second\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  const Result<ImportedMesh> imported = importMesh(put("a.obj", cube));
  ASSERT_TRUE(imported.ok()) << imported.error().message;
  EXPECT_EQ(imported.value().report.meshes, 2U);
  EXPECT_EQ(imported.value().report.polygons, 6U);
  EXPECT_EQ(imported.value().report.triangulated, 6U);
  EXPECT_EQ(imported.value().mesh.triangles.size(), 12U);
  EXPECT_TRUE(medial::boundsVolume(imported.value().mesh));
  EXPECT_DOUBLE_EQ(medial::signedVolumeOf(imported.value().mesh), 1);
}

TEST_F(MeshReaders, ObjMistakesAreNamedWithTheirLine) {
  expectRefused("a.obj", kObjVertices + "f 1 2 5\n", "line 5: face uses vertex 5 of 4");
  expectRefused("a.obj", kObjVertices + "f 1 2 999999999\nf 1 2 3\n",
                "line 5: face uses vertex 999999999 of 4");
  expectRefused("a.obj", kObjVertices + "f 1 2 99999999999999999999\n", "line 5: face corner");
  expectRefused("a.obj", kObjVertices + "f 1 2 -5\n", "line 5: face uses vertex -5 of 4");
  expectRefused("a.obj", kObjVertices + "f 1 2 0\n", "line 5: face corner \"0\" is not a vertex number");
  expectRefused("a.obj", kObjVertices + "f 1 2 x\n", "line 5: face corner \"x\" is not a vertex number");
  expectRefused("a.obj", "v 0 0 nan\n", "line 1: vertex coordinate \"nan\" is not a finite number");
  expectRefused("a.obj", "v 0 inf 0\n", "line 1: vertex coordinate \"inf\" is not a finite number");
  expectRefused("a.obj", "v 0 1e999 0\n", "line 1: vertex coordinate \"1e999\" is not a finite number");
  expectRefused("a.obj", "\nv 0 0\n", "line 2: vertex coordinate \"\" is not a finite number");
  expectRefused("a.obj", "This is a letter.\n", "holds no polygon");
  expectRefused("a.obj", kObjVertices, "holds no polygon");
  expectRefused("a.obj", kObjVertices + "f 1 1 2\nf 1 2\n", "holds no triangle with an area");
  expectRefused("a.obj", "", "is empty");
  expectRefused("a.obj", binaryStl(1, 1), "binary data");
}

TEST_F(MeshReaders, DoublesSurviveFarFromTheOrigin) {
  // At a million diagonals from the origin floats are 0.06 apart: the tetrahedron would be gone.
  const std::string far =
      "v 1000000.125 0 0\nv 1000001.125 0 0\nv 1000000.125 1 0\nv 1000000.125 0 1\n"
      "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  const Result<ImportedMesh> imported = importMesh(put("a.obj", far));
  ASSERT_TRUE(imported.ok());
  EXPECT_NEAR(medial::signedVolumeOf(imported.value().mesh), 1.0 / 6, 1e-9);
  EXPECT_EQ(medial::boundsOf(imported.value().mesh).min().x(), 1000000.125);
}

TEST_F(MeshReaders, OffInAllItsSpellings) {
  expectTetrahedron("a.off", kOffTetrahedron);
  expectTetrahedron("a.off",
                    "# comment\nOFF 4 4 6\n\n0 0 0 # origin\n1 0 0\n0 1 0\n0 0 1\n"
                    "3 0 2 1 255 0 0\n3 0 1 3\n\n3 1 2 3 0.5 0.5 0.5 1\n3 2 0 3");
  expectTetrahedron("a.off",
                    "COFF\r\n4 4 0\r\n0 0 0 1 0 0 1\r\n1 0 0 1 0 0 1\r\n0 1 0 1 0 0 1\r\n0 0 1 1 0 0 1\r\n"
                    "3 0 2 1\r\n3 0 1 3\r\n3 1 2 3\r\n3 2 0 3\r\n");
}

TEST_F(MeshReaders, OffMistakesAreNamed) {
  expectRefused("a.off", "OBJ\n", "first word must be OFF");
  expectRefused("a.off", "4OFF\n1 1 0\n", "first word must be OFF");
  expectRefused("a.off", "OFF BINARY\n", "\"BINARY\" is not a count");
  expectRefused("a.off", "OFF\n", "counts of vertices and faces are missing");
  expectRefused("a.off", "OFF\n4000000000 4000000000 0\n0 0 0\n", "after 1 of 4000000000 vertices");
  expectRefused("a.off", "OFF\n-1 3 0\n", "\"-1\" is not a count");
  expectRefused("a.off", "OFF\n1 4000000000 0\n0 0 0\n", "after 0 of 4000000000 faces");
  expectRefused("a.off", "OFF\n1 1 0\n0 0 0\n4000000000 0 0 0\n", "face corner \"\"");
  expectRefused("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "face uses vertex 3 of 3");
  expectRefused("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", "face uses vertex -1 of 3");
  expectRefused("a.off", "OFF\n1 0 0\n0 0 nan\n", "\"nan\" is not a finite number");
  expectRefused("a.off", "OFF\n0 0 0\n", "holds no polygon");
}

TEST_F(MeshReaders, PlyTextAndBothByteOrders) {
  expectTetrahedron("a.ply", kPlyTetrahedron);
  // More properties and elements than needed, double coordinates in another order, list with the other name.
  for (const bool big : {false, true}) {
    std::string bytes =
        std::string("ply\nformat binary_") + (big ? "big" : "little") +
        "_endian 1.0\nelement vertex 4\nproperty uchar red\nproperty double z\nproperty double y\n"
        "property double x\nproperty list ushort float junk\nelement edge 1\nproperty int vertex1\n"
        "element face 4\nproperty float quality\nproperty list uint8 uint32 vertex_index\nend_header\n";
    const auto add = [&](auto number) {
      std::string part;
      append(part, number);
      bytes += big ? std::string(part.rbegin(), part.rend()) : part;
    };
    for (const std::array<double, 3>& p : {std::array<double, 3>{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
      add(std::uint8_t{'\n'});
      for (const std::size_t axis : {2U, 1U, 0U}) add(std::bit_cast<std::uint64_t>(p[axis]));
      add(std::uint16_t{2});
      add(std::uint32_t{7});
      add(std::uint32_t{7});
    }
    add(std::uint32_t{3});
    for (const std::array<std::uint32_t, 3>& t :
         {std::array<std::uint32_t, 3>{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}) {
      add(std::bit_cast<std::uint32_t>(0.5F));
      add(std::uint8_t{3});
      for (const std::uint32_t corner : t) add(corner);
    }
    expectTetrahedron("a.ply", bytes);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      ASSERT_FALSE(readPly(std::string_view(bytes).substr(0, size)).ok()) << "cut at " << size;
    }
  }
}

TEST_F(MeshReaders, PlyStripsTurnEveryOtherTriangle) {
  const std::string start =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
  expectTetrahedron("a.ply", start + "6 0 2 1 3 0 2\n");
  expectTetrahedron("a.ply", start + "12 0 2 1 3 -1 1 3 0 -1 2 0 3\n");
}

TEST_F(MeshReaders, PlyMistakesAreNamed) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n";
  expectRefused("a.ply", "plywood\n", "does not begin with ply");
  expectRefused("a.ply", "ply\nformat ascii 1.0\n", "no end_header");
  expectRefused("a.ply", "ply\nformat xml 1.0\nend_header\n", "line 2: format \"xml\" is not known");
  expectRefused("a.ply", "ply\nproperty int x\nend_header\n", "line 2: property before any element");
  expectRefused("a.ply", head + "property quad w\n", "type \"quad\" is not known");
  expectRefused("a.ply", head + faces + points + "3 0 1 3\n", "uses vertex 3 of 3");
  expectRefused("a.ply", head + faces + points + "3 0 1 -1\n", "face 0: a corner is not a vertex number");
  expectRefused("a.ply", head + faces + points + "-3 0 1 2\n", "face 0: the file ends here");
  expectRefused("a.ply", head + faces + points + "3 0 1\n", "face 0: the file ends here");
  expectRefused("a.ply", head + faces + points + "4000000000 0 1 2\n", "face 0: the file ends here");
  expectRefused("a.ply", head + faces + "0 0 nan\n" + points,
                "vertex 0: a coordinate is missing or not a finite");
  expectRefused("a.ply",
                "ply\nformat ascii 1.0\nelement void 4000000000000\nelement vertex 4000000000000\n"
                "property float x\nend_header\n",
                "vertex 0: the file ends here");
}

TEST_F(MeshReaders, StlText) {
  expectTetrahedron("a.stl", kStlTetrahedron);
  expectTetrahedron("a.stl", "  solid\n" + kStlFacets + "endsolid\nsolid facet\nendsolid facet\n");
  expectRefused("a.stl", "solid\n" + kStlFacets, "the file ends before endsolid");
  expectRefused("a.stl", kStlTetrahedron.substr(0, kStlTetrahedron.size() / 2),
                "the file ends before endsolid");
  expectRefused("a.stl", "solid\nvertex 0 0 0\nendsolid\n", "line 2: vertex outside a facet");
  expectRefused("a.stl", "solid\n" + stlFacet("0 0 nan", "0 0 1", "0 1 0") + "endsolid\n",
                "\"nan\" is not a finite");
  expectRefused("a.stl", "solid\nendsolid\n", "holds no polygon");
  expectRefused("a.stl", "Dear reader,\n" + std::string(500, 'x'), "does not begin with solid");
}

TEST_F(MeshReaders, StlBinary) {
  const Result<ImportedMesh> imported = importMesh(put("a.stl", binaryStl(3, 3)));
  ASSERT_TRUE(imported.ok()) << imported.error().message;
  EXPECT_EQ(imported.value().mesh.triangles.size(), 3U);
  EXPECT_EQ(imported.value().mesh.vertices.size(), 9U);
  EXPECT_TRUE(importMesh(put("a.stl", binaryStl(2, 3))).ok())
      << "bytes after the triangles are somebody else's";
  expectRefused("a.stl", binaryStl(4'000'000'000, 2), "announces 4000000000 triangles but has room for 2");
  expectRefused("a.stl", binaryStl(3, 3).substr(0, 200), "announces 3 triangles but has room for 2");
  expectRefused("a.stl", binaryStl(3, 3).substr(0, 50), "too short");
  expectRefused("a.stl", binaryStl(1, 1, std::numeric_limits<float>::infinity()),
                "triangle 0 has a coordinate");
  expectRefused("a.stl", binaryStl(0, 0), "holds no polygon");
}

struct Reader {
  Result<PolygonSoup> (*read)(std::string_view);
  std::string bytes;
};

TEST_F(MeshReaders, MutilatedFilesGiveAnErrorOrPolygonsThatMakeSense) {
  const std::vector<Reader> readers = {{&readObj, kObjTetrahedron},
                                       {&readOff, kOffTetrahedron},
                                       {&readPly, kPlyTetrahedron},
                                       {&readStl, kStlTetrahedron},
                                       {&readStl, binaryStl(3, 3)}};
  constexpr int kRounds = 5000;
  for (std::size_t which = 0; which < readers.size(); ++which) {
    for (int round = 0; round < kRounds; ++round) {
      SCOPED_TRACE("reader " + std::to_string(which) + ", seed " + std::to_string(round));
      std::mt19937 random(static_cast<std::uint32_t>(round));
      std::string bytes = readers[which].bytes;
      for (std::uint32_t edits = 1 + random() % 4; edits > 0 && !bytes.empty(); --edits) {
        const std::size_t place = random() % bytes.size();
        const char letter = "0123456789-+.e/ \n\\xv\xff"[random() % 21];
        switch (random() % 4) {
          case 0:
            bytes[place] = letter;
            break;
          case 1:
            bytes.insert(place, 1 + random() % 12, letter);
            break;
          case 2:
            bytes.erase(place, random() % 20);
            break;
          default:
            bytes.insert(place, bytes.substr(random() % bytes.size(), random() % 60));
            break;
        }
      }
      const Result<PolygonSoup> soup = readers[which].read(bytes);
      if (!soup.ok()) {
        ASSERT_FALSE(soup.error().message.empty());
        continue;
      }
      for (const std::uint32_t corner : soup.value().corners) ASSERT_LT(corner, soup.value().points.size());
      for (const Eigen::Vector3d& point : soup.value().points) ASSERT_TRUE(point.allFinite());
      if (!soup.value().polygonEnds.empty()) {
        ASSERT_EQ(soup.value().polygonEnds.back(), soup.value().corners.size());
      }
    }
  }
}

TEST_F(MeshReaders, OtherThingsAreRefused) {
  expectRefused("a.txt", "hello", "no mesh format is known by the ending .txt");
  expectRefused("noending", "hello", "no mesh format is known by the ending of this name");
  expectRefused("a.glb", "not a glb at all", "");
  expectRefused("a.dae", "<COLLADA", "");
  expectRefused("a.fbx", std::string("Kaydara FBX Binary  \0\x1a\0\xff\xff\xff\xff", 27), "");
  expectRefused("a.3ds", "MM\xff\xff\xff\xff", "");
  expectRefused(
      "a.gltf",
      "{\"asset\":{\"version\":\"2.0\"},\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":9}}]}]}",
      "");
  const Result<ImportedMesh> folder = importMesh(folder_);
  ASSERT_FALSE(folder.ok());
  EXPECT_THAT(folder.error().message, HasSubstr("is a directory"));
  const Result<ImportedMesh> missing = importMesh(in("none.obj"));
  ASSERT_FALSE(missing.ok());
  EXPECT_THAT(missing.error().message, HasSubstr("No such file"));
}

}  // namespace
}  // namespace spheretree::io
