// SPDX-License-Identifier: GPL-3.0-or-later
//
// Files that lie, end early or are something else. The tiny ones that a person can write are in files/.
#include "tests/hard/hard_inputs.hpp"

#include <cstddef>
#include <cstdint>

#include "medial/random.hpp"

namespace spheretree::test {
namespace {

constexpr std::uint32_t kFourBillion = 4'000'000'000U;

std::string littleEndian(std::uint32_t value) {
  std::string bytes;
  for (unsigned k = 0; k < 4; ++k) bytes += static_cast<char>((value >> (8 * k)) & 0xffU);
  return bytes;
}

std::string noise(std::size_t count) {
  medial::Random random(13);
  std::string bytes;
  while (bytes.size() < count) bytes += static_cast<char>(random.next() & 0xffU);
  return bytes;
}

std::string binaryStl(std::uint32_t announced, std::size_t triangles) {
  return std::string(80, ' ') + littleEndian(announced) + std::string(50 * triangles, '\0');
}

std::string plyHeader(const std::string& format, std::uint32_t vertices, std::uint32_t faces) {
  return "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(vertices) +
         "\nproperty double x\nproperty double y\nproperty double z\nelement face " + std::to_string(faces) +
         "\nproperty list uint uint vertex_indices\nend_header\n";
}

std::string glb(std::uint32_t announced, const std::string& json) {
  return "glTF" + littleEndian(2) + littleEndian(announced) +
         littleEndian(static_cast<std::uint32_t>(json.size())) + "JSON" + json;
}

std::string repeated(const std::string& piece, std::size_t count) {
  std::string text;
  for (std::size_t k = 0; k < count; ++k) text += piece;
  return text;
}

/// A scene whose nodes are what `nodes` says; node 0 is the root.
std::string gltf(const std::string& nodes) {
  return "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[" + nodes +
         "]}";
}

std::string nodeChain(std::size_t length) {
  std::string nodes;
  for (std::size_t k = 1; k <= length; ++k) nodes += "{\"children\":[" + std::to_string(k) + "]},";
  return nodes + "{}";
}

constexpr HardInput kFiles[] = {
    {"empty.obj", nullptr, [] { return std::string(); }},
    {"empty.off", nullptr, [] { return std::string(); }},
    {"empty.ply", nullptr, [] { return std::string(); }},
    {"empty.stl", nullptr, [] { return std::string(); }},
    {"empty.glb", nullptr, [] { return std::string(); }},
    {"truncated.stl", nullptr, [] { return binaryStl(12, 5); }},
    {"four_billion.stl", nullptr, [] { return binaryStl(kFourBillion, 1); }},
    {"truncated.ply", nullptr,
     [] { return plyHeader("binary_little_endian", 8, 12) + std::string(8 * 24, '\0') + littleEndian(3); }},
    {"four_billion.ply", nullptr,
     [] { return plyHeader("ascii", 3, kFourBillion) + "0 0 0\n1 0 0\n0 1 0\n"; }},
    {"four_billion_vertices.ply", nullptr,
     [] { return plyHeader("binary_little_endian", kFourBillion, 1) + std::string(72, '\0'); }},
    {"four_billion_corners.ply", nullptr,
     [] {
       return plyHeader("binary_little_endian", 3, 1) + std::string(72, '\0') + littleEndian(kFourBillion);
     }},
    {"header_only.ply", nullptr, [] { return plyHeader("ascii", 0, 0); }},
    {"four_billion.off", nullptr, [] { return std::string("OFF\n3 4000000000 0\n0 0 0\n1 0 0\n0 1 0\n"); }},
    {"truncated.glb", nullptr, [] { return glb(4096, "{\"asset\":{\"version\":\"2.0\"},\"meshes\":["); }},
    {"four_billion.glb", nullptr, [] { return glb(kFourBillion, "{\"asset\":{\"version\":\"2.0\"}}  "); }},
    {"noise.obj", nullptr, [] { return noise(4096); }},
    {"noise.ply", nullptr, [] { return noise(4096); }},
    {"noise.stl", nullptr, [] { return noise(4096); }},
    {"noise.off", nullptr, [] { return noise(4096); }},
    {"noise.glb", nullptr, [] { return noise(4096); }},
    {"noise.fbx", nullptr, [] { return noise(4096); }},
    {"noise.3ds", nullptr, [] { return noise(4096); }},
    {"noise.xyz", nullptr, [] { return noise(4096); }},
    {"zeros.stl", nullptr, [] { return std::string(4096, '\0'); }},
    {"one_long_line.obj", nullptr, [] { return "v " + std::string(std::size_t{1} << 24U, '9') + "\n"; }},
    {"node_circle.gltf", nullptr, [] { return gltf("{\"children\":[1]},{\"children\":[0]}"); }},
    {"node_chain.gltf", nullptr, [] { return gltf(nodeChain(100000)); }},
    {"tags.dae", nullptr,
     [] {
       return "<?xml version=\"1.0\"?><COLLADA version=\"1.4.1\"><library_visual_scenes><visual_scene "
              "id=\"s\">" +
              repeated("<node>", 200000) + repeated("</node>", 200000) +
              "</visual_scene></library_visual_scenes></COLLADA>";
     }},
    {"braces.gltf", nullptr, [] { return std::string(std::size_t{1} << 20U, '['); }},
};

}  // namespace

std::span<const HardInput> brokenFiles() {
  return kFiles;
}

}  // namespace spheretree::test
