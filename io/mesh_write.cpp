// SPDX-License-Identifier: GPL-3.0-or-later
//
// Triangle meshes as bytes. Text numbers are the shortest that read back as the same double (17 digits at
// most). PLY is little-endian with doubles; STL knows floats only.

#include "io/mesh_write.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>

#include "io/guarded.hpp"

namespace spheretree::io {
namespace {

using medial::TriangleMesh;

constexpr std::size_t kStlHeaderBytes = 80;

void appendNumber(std::string& text, double value) {
  std::array<char, 32> digits{};  // the longest shortest form has 24
  const auto [end, code] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  static_cast<void>(code);
  text.append(digits.data(), end);
}

void appendVertex(std::string& text, const Eigen::Vector3d& vertex) {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (axis > 0) text += ' ';
    appendNumber(text, vertex[axis]);
  }
  text += '\n';
}

void appendCorners(std::string& text, const TriangleMesh::Triangle& triangle, std::uint32_t firstNumber) {
  for (const std::uint32_t corner : triangle) text += ' ' + std::to_string(corner + firstNumber);
  text += '\n';
}

/// Little-endian on every machine.
template <class Bits>
void appendBits(std::string& bytes, Bits value) {
  for (std::size_t k = 0; k < sizeof(Bits); ++k) {
    bytes += static_cast<char>((std::uint64_t{value} >> (8 * k)) & 0xffU);
  }
}

std::string toObj(const TriangleMesh& mesh) {
  std::string text = "# spheretree\n";
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    text += "v ";
    appendVertex(text, vertex);
  }
  for (const TriangleMesh::Triangle& triangle : mesh.triangles) {
    text += 'f';
    appendCorners(text, triangle, 1);
  }
  return text;
}

std::string toOff(const TriangleMesh& mesh) {
  std::string text =
      "OFF\n" + std::to_string(mesh.vertices.size()) + " " + std::to_string(mesh.triangles.size()) + " 0\n";
  for (const Eigen::Vector3d& vertex : mesh.vertices) appendVertex(text, vertex);
  for (const TriangleMesh::Triangle& triangle : mesh.triangles) {
    text += '3';
    appendCorners(text, triangle, 0);
  }
  return text;
}

std::string toPly(const TriangleMesh& mesh) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\ncomment spheretree\n"
      "element vertex " +
      std::to_string(mesh.vertices.size()) +
      "\nproperty double x\nproperty double y\nproperty double z\n"
      "element face " +
      std::to_string(mesh.triangles.size()) + "\nproperty list uchar uint vertex_indices\nend_header\n";
  for (const Eigen::Vector3d& vertex : mesh.vertices)
    for (const double coordinate : vertex) appendBits(bytes, std::bit_cast<std::uint64_t>(coordinate));
  for (const TriangleMesh::Triangle& triangle : mesh.triangles) {
    bytes += '\3';
    for (const std::uint32_t corner : triangle) appendBits(bytes, corner);
  }
  return bytes;
}

std::string toStl(const TriangleMesh& mesh) {
  std::string bytes = "spheretree";  // anything but "solid"
  bytes.resize(kStlHeaderBytes, ' ');
  appendBits(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  const auto appendFloats = [&](const Eigen::Vector3d& vector) {
    for (const double coordinate : vector)
      appendBits(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(coordinate)));
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector3d& a = mesh.corner(t, 0);
    const Eigen::Vector3d normal = (mesh.corner(t, 1) - a).cross(mesh.corner(t, 2) - a);
    appendFloats(normal.stableNormalized());
    for (std::size_t k = 0; k < 3; ++k) appendFloats(mesh.corner(t, k));
    appendBits(bytes, std::uint16_t{0});
  }
  return bytes;
}

}  // namespace

Result<Done> writeMesh(const std::filesystem::path& path, const TriangleMesh& mesh, Overwrite overwrite) {
  return guarded(ErrorCode::UnwritableOutput, path.string(), [&]() -> Result<Done> {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    if (extension == ".obj") return writeFileAtomically(path, toObj(mesh), overwrite);
    if (extension == ".off") return writeFileAtomically(path, toOff(mesh), overwrite);
    if (extension == ".ply") return writeFileAtomically(path, toPly(mesh), overwrite);
    if (extension == ".stl") return writeFileAtomically(path, toStl(mesh), overwrite);
    return Error{
        ErrorCode::InvalidArgument,
        path.string() + ": meshes are written as .obj, .off, .ply or .stl, by the ending of the name"};
  });
}

}  // namespace spheretree::io
