// SPDX-License-Identifier: GPL-3.0-or-later
//
// P. Hubbard, "Approximating polyhedra with spheres for time-critical collision detection", ACM TOG 15(3),
// 1996: balls are merged pairwise, cheapest pair first, until few enough are left. The cost of a merge is the
// overhang of the ball around what both answer for.
#include "builders/merging.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <queue>
#include <tuple>
#include <utility>

#include "medial/min_ball.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;
using medial::Ball;

constexpr std::size_t kProposalsPerCheck = 64;  // well below a millisecond

struct Merge {
  std::int64_t cost;  // overhang in steps of costStep()
  std::uint32_t a;
  std::uint32_t b;
  std::uint32_t versionA;
  std::uint32_t versionB;
  Fit fit;

  /// std::priority_queue serves the greatest: the cheapest merge, then the lowest numbers.
  bool operator<(const Merge& other) const {
    return std::tuple(cost, a, b) > std::tuple(other.cost, other.a, other.b);
  }
};

class Merging {
 public:
  Merging(const ReduceRequest& request, std::vector<Cluster> clusters, const MergeRules& rules)
      : request_(request),
        rules_(rules),
        step_(costStep(request)),
        clusters_(std::move(clusters)),
        version_(clusters_.size(), 0) {}

  std::vector<Cluster> run(std::size_t wanted) {
    std::size_t left = clusters_.size();
    if (left <= wanted) return std::move(clusters_);
    for (std::uint32_t a = 0; a < clusters_.size(); ++a) {
      for (const std::uint32_t b : clusters_[a].neighbours) {
        if (b > a) queue_.push(propose(a, b));
      }
    }
    while (left > wanted && !queue_.empty()) {
      const Merge merge = queue_.top();
      queue_.pop();
      if (version_[merge.a] != merge.versionA || version_[merge.b] != merge.versionB) continue;
      apply(merge);
      --left;
    }
    return withoutEmpty(std::move(clusters_));
  }

 private:
  Merge propose(std::uint32_t a, std::uint32_t b) {
    if (++proposals_ % kProposalsPerCheck == 0) request_.context.checkCancelled();
    if (a > b) std::swap(a, b);
    const Fit& first = clusters_[a].fit;
    const Fit& second = clusters_[b].fit;
    Fit best{{}, std::numeric_limits<double>::infinity()};
    const auto consider = [&](const Fit& fit) {
      if (fit.standOff() <= best.standOff() - step_) best = fit;
    };
    // The depth changes no faster than the place: a known depth near by may save the query.
    const auto considerUnknown = [&](const Vector3d& at, double reach) {
      for (const DepthProbe* known : {&first.center, &second.center}) {
        if (reach - (known->depth + (at - known->at).norm()) > best.standOff() - step_) return;
      }
      consider({probeDepth(request_.surface, at), reach});
    };
    consider({first.center, std::max(first.reach, reachOf(b, first.center.at))});
    consider({second.center, std::max(second.reach, reachOf(a, second.center.at))});
    if (rules_.center == MergedCenter::Enclosing) {
      const Ball smallest = smallestAround(a, b);
      considerUnknown(smallest.center, smallest.radius);
    }
    if (rules_.center != MergedCenter::Old) {
      const double radiusSum = first.reach + second.reach;
      const double weight = radiusSum > 0 ? first.reach / radiusSum : 0.5;
      const Vector3d between = weight * first.center.at + (1 - weight) * second.center.at;
      considerUnknown(between, std::max(reachOf(a, between), reachOf(b, between)));
    }
    return {std::llround(best.standOff() / step_), a, b, version_[a], version_[b], best};
  }

  [[nodiscard]] double reachOf(std::uint32_t cluster, const Vector3d& center) const {
    return std::sqrt(farthestSquared(clusters_[cluster].points, center));
  }

  Ball smallestAround(std::uint32_t a, std::uint32_t b) {
    positions_.clear();
    for (const std::uint32_t n : {a, b}) {
      const PointBlock& points = clusters_[n].points;
      for (std::size_t i = 0; i < points.size(); ++i) {
        positions_.emplace_back(points.x[i], points.y[i], points.z[i]);
      }
    }
    return medial::minBall(positions_);
  }

  /// b joins a.
  void apply(const Merge& merge) {
    Cluster& a = clusters_[merge.a];
    Cluster& b = clusters_[merge.b];
    a.units.insert(a.units.end(), b.units.begin(), b.units.end());
    a.points.append(b.points);
    std::vector<std::uint32_t> neighbours;
    std::set_union(a.neighbours.begin(), a.neighbours.end(), b.neighbours.begin(), b.neighbours.end(),
                   std::back_inserter(neighbours));
    std::erase_if(neighbours, [&](std::uint32_t n) { return n == merge.a || n == merge.b; });
    a.neighbours = std::move(neighbours);
    a.fit = merge.fit;
    if (rules_.walk.queries > 0) {
      a.fit = fitBall(request_.surface, a.points, a.fit.center, rules_.walk);
    }
    b = {};
    ++version_[merge.a];
    ++version_[merge.b];
    for (const std::uint32_t n : a.neighbours) {
      std::vector<std::uint32_t>& back = clusters_[n].neighbours;
      std::erase(back, merge.b);
      const auto at = std::lower_bound(back.begin(), back.end(), merge.a);
      if (at == back.end() || *at != merge.a) back.insert(at, merge.a);
      queue_.push(propose(merge.a, n));
    }
  }

  const ReduceRequest& request_;
  MergeRules rules_;
  double step_;
  std::vector<Cluster> clusters_;
  std::vector<std::uint32_t> version_;  // of each cluster, raised with every change
  std::priority_queue<Merge> queue_;
  std::size_t proposals_ = 0;
  std::vector<Vector3d> positions_;  // scratch
};

}  // namespace

std::vector<Cluster> mergeClusters(const ReduceRequest& request, std::vector<Cluster> clusters,
                                   std::size_t wanted, const MergeRules& rules) {
  return Merging(request, std::move(clusters), rules).run(wanted);
}

}  // namespace spheretree::builders
