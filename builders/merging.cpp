// SPDX-License-Identifier: GPL-3.0-or-later
//
// P. Hubbard, "Approximating polyhedra with spheres for time-critical collision detection", ACM TOG 15(3),
// 1996: balls are merged pairwise, cheapest pair first, until few enough are left. The cost of a merge is the
// overhang of the ball around the cells of both.
#include "builders/merging.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <queue>
#include <span>
#include <tuple>
#include "medial/min_ball.hpp"
#include <utility>

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;
using medial::Ball;

// Of the walk of a merged centre.
constexpr FitEffort kWalk{4, 5e-3};

struct Merge {
  std::int64_t cost;  // overhang in steps of costStep()
  std::uint32_t a;
  std::uint32_t b;
  std::uint32_t versionA;
  std::uint32_t versionB;
  DepthProbe center;
  double reach;

  /// std::priority_queue serves the greatest: the cheapest merge, then the lowest indices.
  bool operator<(const Merge& other) const {
    return std::tuple(cost, a, b) > std::tuple(other.cost, other.a, other.b);
  }
};

class Merging {
 public:
  Merging(const ReduceRequest& request, std::vector<Cluster> clusters, MergedCenter center)
      : request_(request), step_(costStep(request)), clusters_(std::move(clusters)), center_(center) {
    state_.resize(clusters_.size());
  }

  std::vector<Cluster> run(std::size_t wanted) {
    for (std::uint32_t a = 0; a < clusters_.size(); ++a) {
      for (const std::uint32_t b : clusters_[a].neighbours) {
        if (b > a) queue_.push(propose(a, b));
      }
    }
    std::size_t alive = clusters_.size();
    while (alive > wanted && !queue_.empty()) {
      const Merge merge = queue_.top();
      queue_.pop();
      if (!current(merge)) continue;
      apply(merge);
      --alive;
    }
    return withoutEmpty(std::move(clusters_));
  }

 private:
  struct State {
    std::uint32_t version = 0;
    bool alive = true;
  };

  Merge propose(std::uint32_t a, std::uint32_t b) {
    if (++proposals_ % kProposalsPerCheck == 0) request_.context.checkCancelled();
    if (a > b) std::swap(a, b);
    Merge merge{0, a, b, state_[a].version, state_[b].version, {}, 0};
    const Fit& first = clusters_[a].fit;
    const Fit& second = clusters_[b].fit;
    double best = std::numeric_limits<double>::infinity();
    const auto consider = [&](const DepthProbe& center, double reach) {
      if (reach - center.depth > best - step_) return;
      best = reach - center.depth;
      merge.center = center;
      merge.reach = reach;
    };
    consider(first.center, std::max(first.reach, reachOf(b, first.center.at)));
    consider(second.center, std::max(second.reach, reachOf(a, second.center.at)));
    // The depth changes no faster than the place: a known depth near by may save the query.
    const auto considerUnknown = [&](const Vector3d& at, double reach) {
      for (const DepthProbe* known : {&first.center, &second.center}) {
        if (reach - (known->depth + (at - known->at).norm()) > best - step_) return;
      }
      consider(probeDepth(request_.surface, at), reach);
    };
    if (center_ != MergedCenter::Old) {
      if (center_ == MergedCenter::Any) {
      positions_.clear();
      for (auto n : {a, b}) for (std::size_t i = 0; i < clusters_[n].points.size(); ++i) positions_.emplace_back(clusters_[n].points.x[i], clusters_[n].points.y[i], clusters_[n].points.z[i]);
      const Ball smallest = medial::minBall(positions_);
      considerUnknown(smallest.center, smallest.radius);
      }
      const double radiusSum = first.reach + second.reach;
      const double weight = radiusSum > 0 ? first.reach / radiusSum : 0.5;
      const Vector3d between = weight * first.center.at + (1 - weight) * second.center.at;
      considerUnknown(between, std::max(reachOf(a, between), reachOf(b, between)));
    }
    static int OB = getenv("OB") ? atoi(getenv("OB")) : 0;
    auto cube = [](double x) { return x * x * x; };
    if (OB == 1) best -= first.standOff() + second.standOff();
    if (OB == 3) best -= 0.5 * (first.standOff() + second.standOff());
    if (OB == 2) best = cube(merge.reach) - cube(first.reach) - cube(second.reach);
    if (OB == 4) best = std::cbrt(best * merge.reach * merge.reach);
    if (OB == 5) best = std::cbrt(cube(merge.reach) - cube(merge.center.depth));
    merge.cost = std::llround(best / step_);
    return merge;
  }

  [[nodiscard]] double reachOf(std::uint32_t cluster, const Vector3d& center) const {
    return std::sqrt(farthestSquared(clusters_[cluster].points, center));
  }


  [[nodiscard]] bool current(const Merge& merge) const {
    const State& a = state_[merge.a];
    const State& b = state_[merge.b];
    return a.alive && b.alive && a.version == merge.versionA && b.version == merge.versionB;
  }

  /// b joins a.
  void apply(const Merge& merge) {
    Cluster& a = clusters_[merge.a];
    Cluster& b = clusters_[merge.b];
    for (std::size_t i = 0; i < b.points.size(); ++i) a.points.push({b.points.x[i], b.points.y[i], b.points.z[i]});
    a.units.insert(a.units.end(), b.units.begin(), b.units.end());
    std::vector<std::uint32_t> neighbours;
    std::set_union(a.neighbours.begin(), a.neighbours.end(), b.neighbours.begin(), b.neighbours.end(),
                   std::back_inserter(neighbours));
    std::erase_if(neighbours, [&](std::uint32_t n) { return n == merge.a || n == merge.b; });
    a.neighbours = std::move(neighbours);
    a.fit = {merge.center, merge.reach};
    if (center_ == MergedCenter::Moved) a.fit = fitBall(request_.surface, a.points, a.fit.center, kWalk);
    ++state_[merge.a].version;
    state_[merge.b].alive = false;
    b = {};
    for (const std::uint32_t n : a.neighbours) {
      std::vector<std::uint32_t>& back = clusters_[n].neighbours;
      std::erase(back, merge.b);
      const auto at = std::lower_bound(back.begin(), back.end(), merge.a);
      if (at == back.end() || *at != merge.a) back.insert(at, merge.a);
      queue_.push(propose(merge.a, n));
    }
  }

  static constexpr std::size_t kProposalsPerCheck = 64;

  const ReduceRequest& request_;
  double step_;
  std::vector<Cluster> clusters_;
  std::vector<State> state_;
  MergedCenter center_;
  std::priority_queue<Merge> queue_;
  std::size_t proposals_ = 0;
  std::vector<Vector3d> positions_;  // scratch
};

}  // namespace

std::vector<Cluster> mergeClusters(const ReduceRequest& request, std::vector<Cluster> clusters,
                                   std::size_t wanted, MergedCenter center) {
  return Merging(request, std::move(clusters), center).run(wanted);
}

}  // namespace spheretree::builders
