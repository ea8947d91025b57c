// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bytes -> mesh file -> import -> repair -> a small build -> `.sph`. The first byte is the format (o, f, p, s
// for OBJ, OFF, PLY, STL), the second chooses the repair rule, the builder and the shape of the tree; the
// file begins with the third.

#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include <spheretree/query_tree.hpp>

#include "builders/build_tree.hpp"
#include "builders/catalogue.hpp"
#include "fuzz_target.hpp"
#include "io/mesh_import.hpp"
#include "io/mesh_repair.hpp"
#include "medial/context.hpp"
#include "medial/surface.hpp"
#include "sph_checks.hpp"

namespace spheretree::fuzz {
namespace {

// What is larger is read and repaired, and that is all: a fuzzer wants many inputs a second, and all builders
// but the first take a second with sanitizers.
constexpr std::size_t kMostTriangles = 64;
constexpr std::size_t kMostTrianglesToReduce = 16;
/// So does a wrap, so only one choice in sixteen may end in one.
constexpr std::size_t kMostTrianglesToWrap = 8;

struct Choice {
  io::Repair repair = io::Repair::Fill;
  builders::BuildSettings settings;
};

std::string_view extensionOf(std::uint8_t format) {
  constexpr std::array<std::string_view, 4> kExtensions{".obj", ".off", ".ply", ".stl"};
  constexpr std::string_view kLetters = "ofps";
  const std::size_t place = kLetters.find(static_cast<char>(format));
  return kExtensions[place == std::string_view::npos ? format % kExtensions.size() : place];
}

Choice choiceOf(std::uint8_t byte) {
  constexpr std::array<io::Repair, 4> kRepairs{io::Repair::Fill, io::Repair::Orient, io::Repair::Off,
                                               io::Repair::Fill};
  Choice choice;
  const std::uint8_t low = byte % 16;
  const std::uint8_t high = byte / 16;
  choice.repair = low == 15 ? io::Repair::Auto : kRepairs[low % 4];
  // Three quarters of the choices are the fast builder.
  const auto builders = builders::catalogue();
  builders::BuildSettings& settings = choice.settings;
  settings.builder =
      high < 12 ? builders.front().name : builders[(2U * (high - 12U) + low / 8U) % builders.size()].name;
  settings.quality = builders::Quality::Fast;
  settings.levels = high < 4 ? 3 : 2;
  settings.branch = low % 2 == 0 ? 3 : 6;
  settings.cover = high % 8 == 5 ? builders::Cover::Solid : builders::Cover::Surface;
  settings.axis = {2, 8};
  settings.hubbard.samples = 12;
  settings.grid.orientations = 1;
  return choice;
}

std::string meshFlaw(const medial::TriangleMesh& mesh) {
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    if (!vertex.allFinite()) return "a vertex is not finite";
  }
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      if (corner >= mesh.vertices.size()) return "a triangle uses a vertex that is not there";
    }
  }
  return "";
}

std::string buildFlaw(medial::TriangleMesh mesh, const builders::BuildSettings& settings) {
  // Whatever has no volume left in double precision may still be refused here, by name.
  const Result<medial::Surface> surface = medial::Surface::create(std::move(mesh));
  if (!surface) return surface.error().code == ErrorCode::UnsuitableMesh ? "" : surface.error().message;
  const Result<builders::BuildResult> built = builders::buildTree(*surface, settings, medial::Context(1));
  if (!built) return settings.builder + ": " + built.error().message;
  if (!built->report.surfaceChains.certified) return "the tree is not certified";
  const Result<std::string> text = formatSph(built->tree, settings.branch);
  if (!text) return "the tree cannot be written: " + text.error().message;
  if (std::string flaw = codecFlaw(*text, SphLoadLimits{}.levels); !flaw.empty()) return flaw;
  const Result<QueryTree> tree = QueryTree::create(built->tree);
  return tree ? "" : "the tree cannot be queried: " + tree.error().message;
}

std::string importFlaw(std::string_view bytes) {
  if (bytes.size() < 2) return "";
  const auto format = static_cast<std::uint8_t>(bytes[0]);
  const Choice choice = choiceOf(static_cast<std::uint8_t>(bytes[1]));
  const std::string path = asFile(bytes.substr(2), extensionOf(format));
  Result<io::ImportedMesh> imported = io::importMesh(path);
  if (!imported) {
    const Error& error = imported.error();
    if (error.code != ErrorCode::UnreadableInput)
      return "another error than UnreadableInput: " + error.message;
    return error.message.starts_with(path) ? "" : "the error does not name the file: " + error.message;
  }
  if (std::string flaw = meshFlaw(imported->mesh); !flaw.empty()) return flaw;
  if (choice.repair == io::Repair::Auto && imported->mesh.triangles.size() > kMostTrianglesToWrap) return "";
  Result<io::RepairedMesh> repaired = io::repairMesh(imported->mesh, choice.repair);
  if (!repaired) {
    const Error& error = repaired.error();
    return error.code == ErrorCode::UnsuitableMesh ? ""
                                                   : "another error than UnsuitableMesh: " + error.message;
  }
  if (std::string flaw = meshFlaw(repaired->mesh); !flaw.empty()) return flaw;
  if (!medial::boundsVolume(repaired->mesh)) return "the repaired mesh is open";
  const bool quick = choice.settings.builder == builders::catalogue().front().name;
  if (repaired->mesh.triangles.size() > (quick ? kMostTriangles : kMostTrianglesToReduce)) return "";
  return buildFlaw(std::move(repaired->mesh), choice.settings);
}

}  // namespace
}  // namespace spheretree::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace spheretree::fuzz;
  failOn(importFlaw({reinterpret_cast<const char*>(data), size}));
  return 0;
}
