// SPDX-License-Identifier: GPL-3.0-or-later
#include "medial/triangle_mesh.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

namespace spheretree::medial {
namespace {

// The highest power of a length that is computed is the fifth, a third moment of area: 1e-300 to 1e300.
constexpr double kLongestLength = 1e60;
constexpr double kShortestLength = 1e-60;

std::string shortNumber(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

}  // namespace

Eigen::AlignedBox3d boundsOf(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) box.extend(mesh.corner(t, k));
  }
  return box;
}

double diagonalOf(const TriangleMesh& mesh) {
  return mesh.triangles.empty() ? 0.0 : boundsOf(mesh).diagonal().norm();
}

std::string whyNotMeasurable(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return {};
  const Eigen::AlignedBox3d box = boundsOf(mesh);
  const double reach = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  if (!(reach <= kLongestLength))
    return "the mesh reaches out to " + shortNumber(reach) + ", too far to compute with";
  const double size = box.sizes().maxCoeff();
  if (size < kShortestLength)
    return "the mesh is only " + shortNumber(size) + " long, too small to compute with";
  return {};
}

double areaOf(const TriangleMesh& mesh) {
  double area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector3d& a = mesh.corner(t, 0);
    area += (mesh.corner(t, 1) - a).cross(mesh.corner(t, 2) - a).norm() / 2;
  }
  return area;
}

double signedVolumeOf(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return 0;
  // Relative to the middle of the mesh: a far-away origin would cancel the digits away.
  const Eigen::Vector3d origin = boundsOf(mesh).center();
  double volume = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector3d a = mesh.corner(t, 0) - origin;
    const Eigen::Vector3d b = mesh.corner(t, 1) - origin;
    const Eigen::Vector3d c = mesh.corner(t, 2) - origin;
    volume += a.dot(b.cross(c)) / 6;
  }
  return volume;
}

bool boundsVolume(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return false;
  struct Use {
    std::uint32_t low;
    std::uint32_t high;
    int direction;
  };
  std::vector<Use> uses;
  uses.reserve(3 * mesh.triangles.size());
  for (const TriangleMesh::Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = t[k];
      const std::uint32_t to = t[(k + 1) % 3];
      uses.push_back(from < to ? Use{from, to, 1} : Use{to, from, -1});
    }
  }
  std::sort(uses.begin(), uses.end(),
            [](const Use& a, const Use& b) { return std::pair(a.low, a.high) < std::pair(b.low, b.high); });
  for (std::size_t i = 0; i < uses.size();) {
    int balance = 0;
    std::size_t j = i;
    for (; j < uses.size() && uses[j].low == uses[i].low && uses[j].high == uses[i].high; ++j) {
      balance += uses[j].direction;
    }
    if (balance != 0) return false;
    i = j;
  }
  return true;
}

}  // namespace spheretree::medial
