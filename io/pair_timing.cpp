// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a tree costs at run time, measured with the runtime itself: narrow queries of a solid against itself
// in random close poses, as tests/bench/narrow_phase_bench.cpp does against other libraries. Rotations: K.
// Shoemake, Uniform random rotations, Graphics Gems III, 1992.

#include "io/pair_timing.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <spheretree/pair_query.hpp>
#include <spheretree/query_tree.hpp>

#include "medial/random.hpp"

namespace spheretree::io {
namespace {

constexpr int kPasses = 5;  // the first of which warms the caches and is not counted

struct Box {
  Eigen::Vector3d min;
  Eigen::Vector3d max;
};

Eigen::Quaterniond randomRotation(medial::Random& random) {
  constexpr double kTurn = 2 * std::numbers::pi;
  const double u = random.uniform();
  const double v = random.uniform(0, kTurn);
  const double w = random.uniform(0, kTurn);
  const double r = std::sqrt(1 - u);
  const double s = std::sqrt(u);
  return {s * std::cos(w), r * std::sin(v), r * std::cos(v), s * std::sin(w)};
}

Box boundsOf(const medial::TriangleMesh& mesh, const Eigen::Quaterniond& rotation) {
  const Eigen::Matrix3d turn = rotation.toRotationMatrix();
  constexpr double kFar = std::numeric_limits<double>::max();
  Box box{Eigen::Vector3d::Constant(kFar), Eigen::Vector3d::Constant(-kFar)};
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    const Eigen::Vector3d point = turn * vertex;
    box = {box.min.cwiseMin(point), box.max.cwiseMax(point)};
  }
  return box;
}

Rotation toFloat(const Eigen::Quaterniond& q) {
  return {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()),
          static_cast<float>(q.w())};
}

/// All poses down to one level.
double passSeconds(const QueryTree& tree, const std::vector<PosePair>& poses, std::uint32_t level,
                   std::uint64_t& tests) {
  PairQuery query(tree, tree);
  QueryLimits limits;
  limits.deepestLevel = level;
  tests = 0;
  const auto start = std::chrono::steady_clock::now();
  for (const PosePair& pose : poses) {
    query.restart(pose.a, pose.b);
    static_cast<void>(query.advance(limits));
    tests += query.sphereTests();
  }
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

std::vector<PosePair> closePoses(const medial::TriangleMesh& mesh, std::size_t count, std::uint64_t seed) {
  std::vector<PosePair> poses;
  for (std::size_t k = 0; k < count; ++k) {
    medial::Random random(seed, k);
    const Eigen::Quaterniond turnA = randomRotation(random);
    const Eigen::Quaterniond turnB = randomRotation(random);
    const Box a = boundsOf(mesh, turnA);
    const Box b = boundsOf(mesh, turnB);
    PosePair pair;
    pair.a.rotation = toFloat(turnA);
    pair.b.rotation = toFloat(turnB);
    // A may stand anywhere between the places where the boxes just touch.
    const auto place = [&](int axis) {
      return static_cast<float>(random.uniform(b.min[axis] - a.max[axis], b.max[axis] - a.min[axis]));
    };
    pair.a.translation.x = place(0);
    pair.a.translation.y = place(1);
    pair.a.translation.z = place(2);
    poses.push_back(pair);
  }
  return poses;
}

std::vector<PairCost> pairCosts(const SphereTree& tree, const std::vector<PosePair>& poses) {
  const Result<QueryTree> laidOut = QueryTree::create(tree);
  if (!laidOut || poses.empty()) return {};
  constexpr double kMicroseconds = 1e6;
  const auto count = static_cast<double>(poses.size());
  std::vector<PairCost> costs;
  for (std::uint32_t level = 0; level < laidOut->levelCount(); ++level) {
    PairCost cost;
    for (int pass = 0; pass < kPasses; ++pass) {
      std::uint64_t tests = 0;
      const double each = passSeconds(*laidOut, poses, level, tests) * kMicroseconds / count;
      if (pass == 1 || (pass > 1 && each < cost.microseconds)) cost.microseconds = each;
      cost.sphereTests = static_cast<double>(tests) / count;
    }
    costs.push_back(cost);
  }
  return costs;
}

}  // namespace spheretree::io
