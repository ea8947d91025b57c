// SPDX-License-Identifier: GPL-3.0-or-later
//
// P. Hubbard, "Approximating polyhedra with spheres for time-critical collision detection", ACM TOG 15(3),
// 1996: the balls of one static medial axis are merged pairwise, cheapest pair first, until few enough are
// left. Here a ball stands for the cells that it needs to stick out least for; merging two balls makes a ball
// around the cells of both, and the cost of a merge is the overhang of that ball.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <queue>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "builders/overhang.hpp"
#include "builders/reducer.hpp"
#include "medial/medial_axis.hpp"
#include "medial/min_ball.hpp"
#include "medial/morton.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;
using medial::Ball;
using medial::CellSet;
using medial::MedialAxis;
using medial::Surface;

// Overhangs nearer to each other than this fraction of the diagonal are equal: which merge goes first must
// not hang on rounding, or a turned object would get another tree.
constexpr double kCostStep = 1e-9;

// Cells that are given to their medial balls together.
constexpr std::size_t kBlock = 8;

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// A ball and the corner points of the cells that it answers for.
struct Cluster {
  Ball ball;
  double depth = 0;
  std::vector<std::uint32_t> points;      // indices into CellSet::points(), ascending
  std::vector<std::uint32_t> neighbours;  // clusters, ascending; may be stale after merges
  std::uint32_t version = 0;
  bool alive = true;
};

struct Merge {
  std::int64_t cost;  // overhang in steps of kCostStep
  std::uint32_t a;
  std::uint32_t b;
  std::uint32_t versionA;
  std::uint32_t versionB;
  Ball ball;
  double depth;

  /// std::priority_queue serves the greatest: the cheapest merge, then the lowest indices.
  bool operator<(const Merge& other) const {
    return std::tuple(cost, a, b) > std::tuple(other.cost, other.a, other.b);
  }
};

class Merger {
 public:
  Merger(const ReduceRequest& request, const MedialAxis& axis)
      : request_(request), axis_(axis), costStep_(kCostStep * request.surface.diagonal()) {}

  std::vector<Ball> run() {
    makeClusters();
    linkClusters();
    for (std::uint32_t a = 0; a < clusters_.size(); ++a) {
      for (const std::uint32_t b : clusters_[a].neighbours) {
        if (b > a) queue_.push(propose(a, b));
      }
    }
    std::size_t alive = clusters_.size();
    while (alive > request_.maxBalls && !queue_.empty()) {
      const Merge merge = queue_.top();
      queue_.pop();
      if (!current(merge)) continue;
      apply(merge);
      --alive;
      if (alive % 64 == 0) request_.context.checkCancelled();
    }
    std::vector<Ball> balls;
    for (const Cluster& cluster : clusters_) {
      if (cluster.alive) balls.push_back(cluster.ball);
    }
    return balls;
  }

 private:
  /// The medial balls that may be the best for a cell of the region: a centre farther from the region's
  /// bounds than its own radius is not.
  std::vector<std::uint32_t> candidates() const {
    Eigen::AlignedBox3d box;
    for (const Vector3d& p : request_.cells.points()) box.extend(p);
    std::vector<std::uint32_t> near;
    for (std::uint32_t i = 0; i < axis_.balls.size(); ++i) {
      const Ball& ball = axis_.balls[i].ball;
      if (box.squaredExteriorDistance(ball.center) <= ball.radius * ball.radius) near.push_back(i);
    }
    return near;
  }

  /// Gives every cell to the medial ball with the least stand-off; the balls with cells become clusters.
  void makeClusters() {
    const CellSet& cells = request_.cells;
    const std::vector<std::uint32_t> near = candidates();
    const std::span<const Vector3d> points = cells.points();
    if (near.empty()) {
      // No medial ball reaches here: one cluster holds everything.
      clusters_.resize(1);
      clusters_[0].points.resize(points.size());
      for (std::uint32_t i = 0; i < points.size(); ++i) clusters_[0].points[i] = i;
      fit(clusters_[0]);
      return;
    }
    owner_.assign(cells.size(), kNone);
    for (std::size_t first = 0; first < cells.size(); first += kBlock) {
      findOwners(first, std::min(cells.size(), first + kBlock), near);
    }
    std::vector<std::uint32_t> number(near.size(), kNone);
    for (std::size_t cell = 0; cell < cells.size(); ++cell) {
      std::uint32_t& n = number[owner_[cell]];
      if (n == kNone) {
        n = static_cast<std::uint32_t>(clusters_.size());
        clusters_.emplace_back();
        const medial::MedialBall& source = axis_.balls[near[owner_[cell]]];
        clusters_.back().ball.center = source.ball.center;
        clusters_.back().depth = source.depth;
      }
      owner_[cell] = n;
      const auto corners = cells.corners(cell);
      clusters_[n].points.insert(clusters_[n].points.end(), corners.begin(), corners.end());
    }
    for (Cluster& cluster : clusters_) {
      makeUnique(cluster.points);
      cluster.ball.radius = std::sqrt(farthestSquared(cluster.points, cluster.ball.center));
    }
    ofMedialBall_.assign(axis_.balls.size(), kNone);
    for (std::size_t k = 0; k < near.size(); ++k) ofMedialBall_[near[k]] = number[k];
  }

  /// The owner, an index into `near`, of every cell of a run. Cells of a run lie close together, so most
  /// candidates are ruled out for all of them at once.
  void findOwners(std::size_t first, std::size_t last, const std::vector<std::uint32_t>& near) {
    const CellSet& cells = request_.cells;
    Eigen::AlignedBox3d box;
    for (std::size_t cell = first; cell < last; ++cell) {
      for (const std::uint32_t p : cells.corners(cell)) box.extend(cells.points()[p]);
    }
    const Vector3d middle = box.center();
    const double radius = box.diagonal().norm() / 2;
    // Every corner is within `radius` of the middle: so far is the stand-off of any cell from this estimate.
    std::vector<double> estimate(near.size());
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < near.size(); ++k) {
      const medial::MedialBall& candidate = axis_.balls[near[k]];
      estimate[k] = (candidate.ball.center - middle).norm() - candidate.depth;
      least = std::min(least, estimate[k]);
    }
    struct Likely {
      double estimate;
      std::uint32_t k;
      Vector3d center;
      double depth;
    };
    std::vector<Likely> likely;
    for (std::uint32_t k = 0; k < near.size(); ++k) {
      if (estimate[k] - radius > least + radius + costStep_) continue;
      const medial::MedialBall& candidate = axis_.balls[near[k]];
      likely.push_back({estimate[k], k, candidate.ball.center, candidate.depth});
    }
    // The most likely first: they rule out the others by one corner.
    std::sort(likely.begin(), likely.end(), [](const Likely& a, const Likely& b) {
      return std::pair(a.estimate, a.k) < std::pair(b.estimate, b.k);
    });
    for (std::size_t cell = first; cell < last; ++cell) {
      const Vector3d& corner = cells.points()[cells.corners(cell)[0]];
      double best = std::numeric_limits<double>::infinity();
      asGood_.clear();
      for (const Likely& candidate : likely) {
        const double limit = best + candidate.depth + costStep_;
        if (limit < 0 || (corner - candidate.center).squaredNorm() > limit * limit) continue;
        const double standOff = std::sqrt(cells.farthestSquared(cell, candidate.center)) - candidate.depth;
        best = std::min(best, standOff);
        if (standOff <= best + costStep_) asGood_.emplace_back(standOff, candidate.k);
      }
      // The first of those that are equal but for rounding.
      for (const auto& [standOff, k] : asGood_) {
        if (standOff <= best + costStep_) owner_[cell] = std::min(owner_[cell], k);
      }
    }
  }

  /// Clusters are neighbours when their medial balls are, or when their cells share a corner. What is still
  /// apart is linked along a space-filling curve, so that everything can merge with something near.
  void linkClusters() {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> links;
    if (!ofMedialBall_.empty()) {
      for (const auto& [a, b] : axis_.neighbours) {
        if (ofMedialBall_[a] != kNone && ofMedialBall_[b] != kNone) {
          links.emplace_back(ofMedialBall_[a], ofMedialBall_[b]);
        }
      }
    }
    std::vector<std::pair<std::uint32_t, std::uint32_t>> uses;  // point, cluster
    for (std::uint32_t n = 0; n < clusters_.size(); ++n) {
      for (const std::uint32_t p : clusters_[n].points) uses.emplace_back(p, n);
    }
    std::sort(uses.begin(), uses.end());
    for (std::size_t i = 1; i < uses.size(); ++i) {
      if (uses[i].first == uses[i - 1].first) links.emplace_back(uses[i - 1].second, uses[i].second);
    }
    joinComponents(links);
    for (const auto& [a, b] : links) {
      clusters_[a].neighbours.push_back(b);
      clusters_[b].neighbours.push_back(a);
    }
    for (Cluster& cluster : clusters_) makeUnique(cluster.neighbours);
  }

  void joinComponents(std::vector<std::pair<std::uint32_t, std::uint32_t>>& links) const {
    std::vector<std::uint32_t> leader(clusters_.size());
    for (std::uint32_t i = 0; i < leader.size(); ++i) leader[i] = i;
    const auto find = [&](std::uint32_t i) {
      while (leader[i] != i) i = leader[i] = leader[leader[i]];
      return i;
    };
    for (const auto& [a, b] : links) leader[find(a)] = find(b);
    Eigen::AlignedBox3d box;
    for (const Cluster& cluster : clusters_) box.extend(cluster.ball.center);
    std::vector<std::pair<std::uint64_t, std::uint32_t>> curve;
    for (std::uint32_t i = 0; i < clusters_.size(); ++i) {
      curve.emplace_back(medial::mortonCode(clusters_[i].ball.center, box), i);
    }
    std::sort(curve.begin(), curve.end());
    for (std::size_t i = 1; i < curve.size(); ++i) {
      const std::uint32_t a = curve[i - 1].second;
      const std::uint32_t b = curve[i].second;
      if (find(a) == find(b)) continue;
      leader[find(a)] = find(b);
      links.emplace_back(a, b);
    }
  }

  Merge propose(std::uint32_t a, std::uint32_t b) const {
    if (a > b) std::swap(a, b);
    const Cluster& first = clusters_[a];
    const Cluster& second = clusters_[b];
    std::vector<std::uint32_t> points;
    points.reserve(first.points.size() + second.points.size());
    std::set_union(first.points.begin(), first.points.end(), second.points.begin(), second.points.end(),
                   std::back_inserter(points));
    Cluster merged;
    merged.points = std::move(points);
    merged.ball.center = first.ball.center;
    const double radiusSum = first.ball.radius + second.ball.radius;
    const double weight = radiusSum > 0 ? first.ball.radius / radiusSum : 0.5;
    const Vector3d between = weight * first.ball.center + (1 - weight) * second.ball.center;
    fit(merged, {{first.ball.center, first.depth}, {second.ball.center, second.depth}}, {&between, 1});
    const double overhang = merged.ball.radius - merged.depth;
    return {
        std::llround(overhang / costStep_), a, b, first.version, second.version, merged.ball, merged.depth};
  }

  struct KnownCenter {
    Vector3d center;
    double depth;
  };

  /// Chooses the centre with the least overhang among those known, those guessed and that of the smallest
  /// ball.
  void fit(Cluster& cluster, const std::vector<KnownCenter>& known = {},
           std::span<const Vector3d> guesses = {}) const {
    std::vector<Vector3d> positions;
    positions.reserve(cluster.points.size());
    for (const std::uint32_t p : cluster.points) positions.push_back(request_.cells.points()[p]);
    double best = std::numeric_limits<double>::infinity();
    const auto consider = [&](const Ball& ball, double depth) {
      if (ball.radius - depth > best - costStep_) return;
      best = ball.radius - depth;
      cluster.ball = ball;
      cluster.depth = depth;
    };
    // The depth changes no faster than the place: a known depth near by may save the query.
    const auto considerUnknown = [&](const Ball& ball) {
      for (const KnownCenter& center : known) {
        if (ball.radius - (center.depth + (ball.center - center.center).norm()) > best - costStep_) return;
      }
      consider(ball, request_.surface.depth(ball.center));
    };
    for (const KnownCenter& center : known) {
      consider({center.center, std::sqrt(farthestSquared(cluster.points, center.center))}, center.depth);
    }
    considerUnknown(medial::minBall(positions));
    for (const Vector3d& guess : guesses) {
      considerUnknown({guess, std::sqrt(farthestSquared(cluster.points, guess))});
    }
  }

  bool current(const Merge& merge) const {
    const Cluster& a = clusters_[merge.a];
    const Cluster& b = clusters_[merge.b];
    return a.alive && b.alive && a.version == merge.versionA && b.version == merge.versionB;
  }

  /// b joins a.
  void apply(const Merge& merge) {
    Cluster& a = clusters_[merge.a];
    Cluster& b = clusters_[merge.b];
    std::vector<std::uint32_t> points;
    std::set_union(a.points.begin(), a.points.end(), b.points.begin(), b.points.end(),
                   std::back_inserter(points));
    std::vector<std::uint32_t> neighbours;
    std::set_union(a.neighbours.begin(), a.neighbours.end(), b.neighbours.begin(), b.neighbours.end(),
                   std::back_inserter(neighbours));
    std::erase_if(neighbours,
                  [&](std::uint32_t n) { return n == merge.a || n == merge.b || !clusters_[n].alive; });
    a.points = std::move(points);
    a.neighbours = std::move(neighbours);
    a.ball = merge.ball;
    a.depth = merge.depth;
    ++a.version;
    b = Cluster{};
    b.alive = false;
    for (const std::uint32_t n : a.neighbours) {
      std::vector<std::uint32_t>& back = clusters_[n].neighbours;
      std::erase(back, merge.b);
      const auto at = std::lower_bound(back.begin(), back.end(), merge.a);
      if (at == back.end() || *at != merge.a) back.insert(at, merge.a);
      queue_.push(propose(merge.a, n));
    }
  }

  double farthestSquared(const std::vector<std::uint32_t>& points, const Vector3d& center) const {
    double farthest = 0;
    for (const std::uint32_t p : points) {
      farthest = std::max(farthest, (request_.cells.points()[p] - center).squaredNorm());
    }
    return farthest;
  }

  static void makeUnique(std::vector<std::uint32_t>& values) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
  }

  const ReduceRequest& request_;
  const MedialAxis& axis_;
  double costStep_;  // mesh units
  std::vector<Cluster> clusters_;
  std::vector<std::uint32_t> owner_;                      // cell -> cluster
  std::vector<std::pair<double, std::uint32_t>> asGood_;  // scratch of findOwners
  std::vector<std::uint32_t> ofMedialBall_;               // ball of the axis -> cluster
  std::priority_queue<Merge> queue_;
};

class HubbardReducer final : public Reducer {
 public:
  HubbardReducer(const Surface& surface, const HubbardSettings& settings, const medial::Context& context)
      : axis_(medial::staticMedialAxis(surface, {settings.samples}, context)) {}

  [[nodiscard]] std::vector<Ball> reduce(const ReduceRequest& request) const override {
    return Merger(request, axis_).run();
  }

 private:
  MedialAxis axis_;
};

}  // namespace

std::unique_ptr<Reducer> makeHubbardReducer(const Surface& surface, const HubbardSettings& settings,
                                            const medial::Context& context) {
  return std::make_unique<HubbardReducer>(surface, settings, context);
}

}  // namespace spheretree::builders
