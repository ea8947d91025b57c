// SPDX-License-Identifier: GPL-3.0-or-later
#include "medial/surface_samples.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "medial/morton.hpp"

namespace spheretree::medial {
namespace {

using Eigen::Vector3d;

double areaOfTriangle(const TriangleMesh& mesh, std::size_t t) {
  const Vector3d& a = mesh.corner(t, 0);
  return (mesh.corner(t, 1) - a).cross(mesh.corner(t, 2) - a).norm() / 2;
}

/// The used vertices, each with the first triangle that uses it.
std::vector<SurfaceSample> vertexSamples(const TriangleMesh& mesh) {
  std::vector<bool> seen(mesh.vertices.size(), false);
  std::vector<SurfaceSample> samples;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (seen[v]) continue;
      seen[v] = true;
      samples.push_back({mesh.vertices[v], t});
    }
  }
  return samples;
}

/// One point per equal share of the area; the place inside the triangle by the R2 sequence (Roberts 2018).
void addAreaSamples(const Surface& surface, std::size_t count, std::vector<SurfaceSample>& samples) {
  const TriangleMesh& mesh = surface.mesh();
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
  order.reserve(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vector3d middle = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3;
    order.emplace_back(mortonCode(middle, surface.bounds()), t);
  }
  std::sort(order.begin(), order.end());
  constexpr double kR2X = 0.7548776662466927;
  constexpr double kR2Y = 0.5698402909980532;
  const double share = surface.area() / static_cast<double>(count);
  double covered = 0;
  std::size_t placed = 0;
  for (const auto& [code, t] : order) {
    covered += areaOfTriangle(mesh, t);
    while (placed < count && (static_cast<double>(placed) + 0.5) * share <= covered) {
      const auto n = static_cast<double>(placed++);
      double u = std::fmod(0.5 + n * kR2X, 1.0);
      double v = std::fmod(0.5 + n * kR2Y, 1.0);
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      const Vector3d& a = mesh.corner(t, 0);
      samples.push_back({a + u * (mesh.corner(t, 1) - a) + v * (mesh.corner(t, 2) - a), t});
    }
  }
}

}  // namespace

std::vector<SurfaceSample> sampleSurface(const Surface& surface, std::uint32_t count) {
  std::vector<SurfaceSample> samples = vertexSamples(surface.mesh());
  if (samples.size() > count) samples.clear();
  if (samples.size() < count) addAreaSamples(surface, count - samples.size(), samples);
  return samples;
}

Ball tangentBall(const Surface& surface, const SurfaceSample& sample) {
  const TriangleMesh& mesh = surface.mesh();
  const Vector3d& a = mesh.corner(sample.triangle, 0);
  const Vector3d normal =
      (mesh.corner(sample.triangle, 1) - a).cross(mesh.corner(sample.triangle, 2) - a).normalized();
  double radius = surface.diagonal() / 2;
  Vector3d center = sample.point - radius * normal;
  constexpr int kMaxShrinks = 40;  // it converges in about five steps
  constexpr double kConverged = 1e-9;
  for (int i = 0; i < kMaxShrinks; ++i) {
    const ClosestPoint closest = surface.closestPoint(center);
    if (closest.distance >= radius * (1 - kConverged)) break;
    // The ball through the sample, tangent there, and through the intruder.
    const Vector3d chord = sample.point - closest.point;
    const double along = chord.dot(normal);
    const double shrunk = along > 0 ? chord.squaredNorm() / (2 * along) : 0;
    if (!(shrunk < radius) || shrunk <= 0) {
      radius /= 2;
    } else {
      radius = shrunk;
    }
    center = sample.point - radius * normal;
  }
  return {center, std::max(0.0, surface.depth(center))};
}

}  // namespace spheretree::medial
