// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/foresight.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "builders/grouping.hpp"
#include "medial/parallel.hpp"
#include "medial/random.hpp"
#include "medial/surface_samples.hpp"

namespace spheretree::builders {
namespace {

// A ball that needs this many times the children it may have sticks out, on every level below it, this power
// of it farther: the number of balls that a stand-off takes goes with about its power 1.5 (measured; a smooth
// surface has 1).
constexpr double kStandOffPerLoad = 0.67;
// Powers of stand-off and load in the cost of a ball (patch.cpp); what makes their trade-offs comparable.
constexpr double kPowerRatio = 10.0 / 6.0;
// Leaves are spread over the surface as if there were fewer by this share, so that there is room to move.
constexpr double kSpareLeaves = 0.05;
// Where a level sticks out less than its median, no more than so much less counts.
constexpr double kLeastLesson = 0.5;

}  // namespace

void Foresight::spread(std::vector<Piece> pieces, RefineRequest request) {
  LevelProblem problem;
  const double slots = std::pow(settings_.branch, static_cast<double>(settings_.levels - 1));
  problem.branch = static_cast<std::uint32_t>(std::max(1.0, slots * (1 - kSpareLeaves)));
  problem.pieces = std::move(pieces);
  problem.allowed.assign(problem.pieces.size(), {0});
  request.effort = spreadEffort(settings_.quality);
  for (const LevelBall& ball : refineLevel(problem, farApartBalls(problem), request)) {
    leaves_.push_back(ball.fit);
    points_.emplace_back();
    for (const std::uint32_t piece : ball.pieces) {
      for (const Eigen::Vector3d& p : problem.pieces[piece].points) points_.back().push(p);
    }
  }
}

/// As many balls as the problem may have, touching the surface at places far from each other.
std::vector<LevelBall> Foresight::farApartBalls(const LevelProblem& problem) const {
  std::vector<Eigen::Vector3d> places;
  for (const Piece& piece : problem.pieces) places.push_back(piece.points.front());
  const std::vector<std::size_t> chosen = farApart(places, 0, problem.branch);
  std::vector<LevelBall> balls(chosen.size());
  medial::parallelFor(chosen.size(), context_, [&](std::size_t i) {
    const medial::ClosestPoint on = surface_.closestPoint(places[chosen[i]]);
    balls[i].fit.center = probeDepth(surface_, medial::tangentBall(surface_, {on.point, on.triangle}).center);
  });
  return balls;
}

/// Of each piece, the leaf that needs the least stand-off for it.
std::vector<std::uint32_t> Foresight::nearestLeaves(const std::vector<Piece>& pieces) const {
  std::vector<std::uint32_t> nearest(pieces.size(), 0);
  constexpr std::size_t kBlock = 256;
  medial::parallelFor((pieces.size() + kBlock - 1) / kBlock, context_, [&](std::size_t block) {
    for (std::size_t i = block * kBlock; i < std::min(pieces.size(), (block + 1) * kBlock); ++i) {
      const Eigen::Vector3d& p = pieces[i].points.front();
      double least = std::numeric_limits<double>::infinity();
      for (std::uint32_t k = 0; k < leaves_.size(); ++k) {
        const DepthProbe& center = leaves_[k].center;
        const double limit = least + center.depth;
        if (limit < 0 || (p - center.at).squaredNorm() >= limit * limit) continue;
        least = (p - center.at).norm() - center.depth;
        nearest[i] = k;
      }
    }
  });
  return nearest;
}

void Foresight::weigh(LevelProblem& problem, std::size_t depth, double pressure) const {
  if (leaves_.empty() || depth + 1 >= settings_.levels) return;
  const std::vector<std::uint32_t> nearest = nearestLeaves(problem.pieces);
  std::vector<double> areaOfLeaf(leaves_.size(), 0);
  for (std::size_t i = 0; i < nearest.size(); ++i) areaOfLeaf[nearest[i]] += areaOf(problem.pieces[i]);
  const double levelsBelow = static_cast<double>(settings_.levels - 1 - depth);
  const double share =
      std::pow(settings_.branch, static_cast<double>(depth + 1)) / static_cast<double>(leaves_.size());
  problem.loads.resize(nearest.size());
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    const double whole = areaOfLeaf[nearest[i]];
    problem.loads[i] = whole > 0 ? share * areaOf(problem.pieces[i]) / whole : 0;
  }
  if (!lessons_.empty()) {
    const double before = std::accumulate(problem.loads.begin(), problem.loads.end(), 0.0);
    for (std::size_t i = 0; i < nearest.size(); ++i) problem.loads[i] *= lessons_[nearest[i]];
    const double after = std::accumulate(problem.loads.begin(), problem.loads.end(), 0.0);
    for (double& load : problem.loads) load *= before / after;
  }
  problem.fairLoad = settings_.branch;
  problem.loadWeight = kStandOffPerLoad * levelsBelow * kPowerRatio * pressure;
}

void Foresight::learn(std::span<const std::vector<LevelNode>> levels) {
  const std::vector<LevelNode>& below = levels.back();
  std::vector<double> worst(levels[levels.size() - 2].size(), 0);  // child of each ball above
  for (const LevelNode& node : below) {
    worst[node.parent] = std::max(worst[node.parent], node.fit.standOff());
  }
  std::vector<double> sorted = worst;
  std::sort(sorted.begin(), sorted.end());
  const double median = sorted[sorted.size() / 2];
  if (!(median > 0)) return;
  lessons_.resize(leaves_.size(), 1.0);
  medial::parallelFor(leaves_.size(), context_, [&](std::size_t k) {
    double least = std::numeric_limits<double>::infinity();
    std::uint32_t parent = 0;  // of the ball that holds the leaf's part best
    for (const LevelNode& node : below) {
      const double over = std::sqrt(farthestSquared(points_[k], node.fit.center.at)) - node.fit.reach;
      if (over >= least) continue;
      least = over;
      parent = node.parent;
    }
    lessons_[k] *= std::pow(std::max(kLeastLesson, worst[parent] / median), 1 / kStandOffPerLoad);
  });
}

std::vector<DepthProbe> Foresight::places() const {
  std::vector<DepthProbe> places;
  for (const Fit& leaf : leaves_) places.push_back(leaf.center);
  return places;
}

double Foresight::prospect(std::span<const LevelBall> balls, std::size_t depth) const {
  double worst = 0;
  double load = 0;
  for (const LevelBall& ball : balls) {
    worst = std::max(worst, ball.fit.standOff());
    load = std::max(load, ball.load);
  }
  return prospect(worst, load, depth);
}

double Foresight::prospect(double standOff, double load, std::size_t depth) const {
  const double levelsBelow = static_cast<double>(settings_.levels - 1 - depth);
  return std::log(standOff) +
         kStandOffPerLoad * levelsBelow * std::log(std::max(1.0, load / settings_.branch));
}

std::vector<std::vector<LevelBall>> Foresight::evenSets(std::span<const LevelBall> given,
                                                        std::size_t count) const {
  std::vector<std::vector<LevelBall>> sets;
  const std::size_t capacity = (leaves_.size() + settings_.branch - 1) / settings_.branch;
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<DepthProbe> centers;
    if (k == 0) {
      for (const LevelBall& ball : given) centers.push_back(ball.fit.center);
    } else {
      std::vector<Eigen::Vector3d> places;
      for (const Fit& leaf : leaves_) places.push_back(leaf.center.at);
      const std::size_t first = medial::Random(settings_.seed, k).next() % leaves_.size();
      for (const std::size_t i : farApart(places, first, settings_.branch))
        centers.push_back(leaves_[i].center);
    }
    if (centers.size() * capacity < leaves_.size()) continue;
    sets.emplace_back();
    for (const Group& group :
         groupEvenly(surface_, points_, centers, capacity, refineEffort(settings_.quality).fit, context_)) {
      sets.back().push_back({group.fit, 0, {}, 0});
    }
  }
  return sets;
}

}  // namespace spheretree::builders
