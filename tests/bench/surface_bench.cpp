// SPDX-License-Identifier: GPL-3.0-or-later
//
// Queries per second of medial::Surface, one thread, on bumpy balls of growing size, and the ratio of the
// time per query to that on the smallest: logarithmic growth means a constant step per row. Two sets of
// points: anywhere in the bounding box (half of them deep inside, the hard ones) and near the surface, where
// builders ask most. Median of several repeats after a warm-up.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "medial/random.hpp"
#include "medial/surface.hpp"
#include "medial/surface_samples.hpp"
#include "models/shapes.hpp"

namespace {

using Eigen::Vector3d;
using spheretree::medial::Surface;

constexpr std::size_t kQueries = 100'000;
constexpr int kRepeats = 5;

Surface bumpyBall(std::uint32_t subdivisions) {
  spheretree::medial::TriangleMesh mesh = spheretree::models::makeBall(1, subdivisions);
  for (Vector3d& v : mesh.vertices)
    v *= 1 + 0.1 * std::sin(7 * v.x()) * std::sin(5 * v.y() + 1) * std::sin(6 * v.z());
  return std::move(Surface::create(std::move(mesh))).value();
}

template <class Query>
double secondsPerQuery(const std::vector<Vector3d>& points, const Query& query) {
  std::vector<double> seconds;
  double sink = 0;
  for (int repeat = 0; repeat <= kRepeats; ++repeat) {
    const auto start = std::chrono::steady_clock::now();
    for (const Vector3d& p : points) sink += query(p);
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
    if (repeat > 0) seconds.push_back(spent.count() / static_cast<double>(points.size()));
  }
  if (sink == 0.123456789) std::puts("");  // keeps the queries
  std::nth_element(seconds.begin(), seconds.begin() + kRepeats / 2, seconds.end());
  return seconds[kRepeats / 2];
}

}  // namespace

int main() {
  std::puts("triangles,closest anywhere /s,ratio,closest near /s,ratio,inside /s,ratio");
  double first[3] = {0, 0, 0};
  for (std::uint32_t subdivisions = 3; subdivisions <= 7; ++subdivisions) {
    const Surface surface = bumpyBall(subdivisions);
    spheretree::medial::Random random(1);
    std::vector<Vector3d> anywhere;
    std::vector<Vector3d> near;
    const auto samples = spheretree::medial::sampleSurface(surface, kQueries);
    for (std::size_t i = 0; i < kQueries; ++i) {
      Vector3d p;
      Vector3d offset;
      for (int k = 0; k < 3; ++k) {
        p[k] = random.uniform(surface.bounds().min()[k], surface.bounds().max()[k]);
        offset[k] = random.uniform(-0.05, 0.05);
      }
      anywhere.push_back(p);
      near.push_back(samples[random.next() % samples.size()].point + offset);
    }
    const auto closest = [&](const Vector3d& p) { return surface.closestPoint(p).distance; };
    const auto inside = [&](const Vector3d& p) { return surface.inside(p) ? 1.0 : 0.0; };
    const double times[3] = {secondsPerQuery(anywhere, closest), secondsPerQuery(near, closest),
                             secondsPerQuery(anywhere, inside)};
    std::printf("%zu", surface.mesh().triangles.size());
    for (int k = 0; k < 3; ++k) {
      if (first[k] == 0) first[k] = times[k];
      std::printf(",%.0f,%.2f", 1 / times[k], times[k] / first[k]);
    }
    std::puts("");
  }
}
