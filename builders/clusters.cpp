// SPDX-License-Identifier: GPL-3.0-or-later
//
// The pieces of a region and the centres they belong to. The price of a unit at a centre is the stand-off of
// a ball there that holds it: the distance to its farthest corner less the depth of the centre. (P. Hubbard
// 1996 and G. Bradshaw 2002 hand out sample points; with cells cover is a fact.)
#include "builders/clusters.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include "builders/holds.hpp"
#include "medial/morton.hpp"

namespace spheretree::builders {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using medial::Ball;

using Link = std::pair<std::uint32_t, std::uint32_t>;

// As a fraction of the diagonal: far above rounding, far below anything that matters.
constexpr double kCostStep = 1e-9;
// Units that are shared out together, in runs of runs: they lie close together, so most centres are ruled out
// for all of them at once.
constexpr std::size_t kRun = 64;
constexpr std::size_t kShortRun = 8;

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

void makeUnique(std::vector<std::uint32_t>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

/// The box around the corners of the units first, .., last - 1.
AlignedBox3d boundsOf(const Units& units, std::size_t first, std::size_t last) {
  AlignedBox3d box;
  for (std::size_t unit = first; unit < last; ++unit) {
    for (const Vector3d& p : units.corners(unit)) box.extend(p);
  }
  return box;
}

/// Finds the cheapest centre for every unit.
class Sharing {
 public:
  Sharing(const ReduceRequest& request, const Units& units, const std::vector<DepthProbe>& centers)
      : request_(request), units_(units), tie_(costStep(request)) {
    for (std::uint32_t k = 0; k < centers.size(); ++k) all_.push_back({centers[k].at, centers[k].depth, k});
  }

  std::vector<std::uint32_t> run() {
    const std::size_t count = units_.size();
    std::vector<std::uint32_t> owner(count, kNone);
    for (std::size_t first = 0; first < count; first += kRun) {
      request_.context.checkCancelled();
      const std::size_t last = std::min(count, first + kRun);
      sift(first, last, all_, near_);
      for (std::size_t start = first; start < last; start += kShortRun) {
        const std::size_t end = std::min(last, start + kShortRun);
        sift(start, end, near_, nearest_);
        for (std::size_t unit = start; unit < end; ++unit) owner[unit] = cheapest(unit);
      }
    }
    return owner;
  }

 private:
  struct Center {
    Vector3d at;
    double depth;
    std::uint32_t number;
  };

  /// The centres that may be the cheapest for a unit of the run, the likeliest of them first.
  void sift(std::size_t first, std::size_t last, const std::vector<Center>& from, std::vector<Center>& to) {
    const AlignedBox3d box = boundsOf(units_, first, last);
    const Vector3d middle = box.center();
    // Every corner is within half the diagonal of the middle, so the price of a unit is at most that far from
    // the price of the middle, and a centre that is a whole diagonal dearer there is never the cheapest.
    const double margin = box.diagonal().norm() + tie_;
    double least = kInfinity;
    std::size_t likeliest = 0;
    to.clear();
    for (const Center& center : from) {
      const double squared = (center.at - middle).squaredNorm();
      const double limit = least + margin + center.depth;
      if (limit < 0 || squared > limit * limit) continue;
      const double price = std::sqrt(squared) - center.depth;
      if (price < least) {
        least = price;
        likeliest = to.size();
      }
      to.push_back(center);
    }
    std::swap(to.front(), to[likeliest]);
  }

  [[nodiscard]] std::uint32_t cheapest(std::size_t unit) {
    const Vector3d& corner = units_.corners(unit).front();
    double best = kInfinity;
    asGood_.clear();
    for (const Center& center : nearest_) {
      const double limit = best + center.depth + tie_;
      if (limit < 0 || (corner - center.at).squaredNorm() > limit * limit) continue;
      const double price = std::sqrt(units_.farthestSquared(unit, center.at)) - center.depth;
      best = std::min(best, price);
      if (price <= best + tie_) asGood_.emplace_back(price, center.number);
    }
    // The first of those that are equal but for rounding.
    std::uint32_t result = kNone;
    for (const auto& [price, number] : asGood_) {
      if (price <= best + tie_) result = std::min(result, number);
    }
    return result;
  }

  const ReduceRequest& request_;
  const Units& units_;
  double tie_;
  std::vector<Center> all_;
  std::vector<Center> near_;                              // of the long run
  std::vector<Center> nearest_;                           // of the short run
  std::vector<std::pair<double, std::uint32_t>> asGood_;  // scratch
};

/// Links what cannot be reached yet along a space-filling curve through the centres.
void joinComponents(const std::vector<Cluster>& clusters, std::vector<Link>& links) {
  std::vector<std::uint32_t> leader(clusters.size());
  for (std::uint32_t i = 0; i < leader.size(); ++i) leader[i] = i;
  const auto find = [&](std::uint32_t i) {
    while (leader[i] != i) i = leader[i] = leader[leader[i]];
    return i;
  };
  for (const auto& [a, b] : links) leader[find(a)] = find(b);
  AlignedBox3d box;
  for (const Cluster& cluster : clusters) box.extend(cluster.fit.center.at);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> curve;
  for (std::uint32_t i = 0; i < clusters.size(); ++i) {
    curve.emplace_back(medial::mortonCode(clusters[i].fit.center.at, box), i);
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

/// Clusters from the owner of every unit. `links` are pairs of owners that are neighbours.
std::vector<Cluster> clustersOf(const Units& units, const std::vector<DepthProbe>& centers,
                                const std::vector<std::uint32_t>& owner, const std::vector<Link>& links) {
  std::vector<Cluster> clusters;
  std::vector<std::uint32_t> number(centers.size(), kNone);
  for (std::uint32_t unit = 0; unit < units.size(); ++unit) {
    std::uint32_t& n = number[owner[unit]];
    if (n == kNone) {
      n = static_cast<std::uint32_t>(clusters.size());
      clusters.emplace_back();
      clusters.back().fit.center = centers[owner[unit]];
    }
    clusters[n].units.push_back(unit);
  }
  std::vector<Link> known;
  for (const auto& [a, b] : links) {
    if (number[a] != kNone && number[b] != kNone) known.emplace_back(number[a], number[b]);
  }
  // Going through the clusters in order: the last one that used a corner is another's neighbour there.
  std::vector<std::uint32_t> user(units.pointCount(), kNone);
  for (std::uint32_t n = 0; n < clusters.size(); ++n) {
    Cluster& cluster = clusters[n];
    for (const std::uint32_t unit : cluster.units) {
      const std::span<const Vector3d> corners = units.corners(unit);
      const std::span<const std::uint32_t> numbers = units.numbers(unit);
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        std::uint32_t& last = user[numbers[i]];
        if (last == n) continue;
        if (last != kNone) known.emplace_back(last, n);
        last = n;
        cluster.points.push(corners[i]);
      }
    }
    cluster.fit.reach = std::sqrt(farthestSquared(cluster.points, cluster.fit.center.at));
  }
  joinComponents(clusters, known);
  for (const auto& [a, b] : known) {
    clusters[a].neighbours.push_back(b);
    clusters[b].neighbours.push_back(a);
  }
  for (Cluster& cluster : clusters) makeUnique(cluster.neighbours);
  return clusters;
}

/// The middles of runs of units.
void appendRunCenters(const ReduceRequest& request, const Units& units, std::size_t runs,
                      std::vector<DepthProbe>& centers) {
  for (std::size_t run = 0; run < runs; ++run) {
    const AlignedBox3d box = boundsOf(units, units.size() * run / runs, units.size() * (run + 1) / runs);
    centers.push_back(probeDepth(request.surface, box.center()));
  }
}

}  // namespace

double costStep(const ReduceRequest& request) {
  return kCostStep * request.surface.diagonal();
}

std::vector<Cluster> medialClusters(const ReduceRequest& request, const Units& units,
                                    const medial::MedialAxis& axis, std::size_t leastCenters) {
  const AlignedBox3d box = boundsOf(units, 0, units.size());
  // A centre farther from the region's bounds than its own radius is not the best for any cell.
  std::vector<DepthProbe> centers;
  std::vector<std::uint32_t> number(axis.balls.size(), kNone);
  for (std::uint32_t i = 0; i < axis.balls.size(); ++i) {
    const Ball& ball = axis.balls[i].ball;
    if (box.squaredExteriorDistance(ball.center) > ball.radius * ball.radius) continue;
    number[i] = static_cast<std::uint32_t>(centers.size());
    centers.push_back({ball.center, axis.balls[i].depth, Vector3d::Zero()});
  }
  std::vector<Link> links;
  for (const auto& [a, b] : axis.neighbours) {
    if (number[a] != kNone && number[b] != kNone) links.emplace_back(number[a], number[b]);
  }
  if (centers.size() < leastCenters) {
    appendRunCenters(request, units, std::min(units.size(), leastCenters), centers);
  }
  return clustersOf(units, centers, Sharing(request, units, centers).run(), links);
}

std::vector<Cluster> reshare(const ReduceRequest& request, const Units& units,
                             std::span<const Cluster> clusters, const FitEffort& effort) {
  std::vector<DepthProbe> centers;
  std::vector<Link> links;
  for (std::uint32_t n = 0; n < clusters.size(); ++n) {
    centers.push_back(clusters[n].fit.center);
    for (const std::uint32_t b : clusters[n].neighbours) {
      if (b > n) links.emplace_back(n, b);
    }
  }
  std::vector<Cluster> result = clustersOf(units, centers, Sharing(request, units, centers).run(), links);
  for (Cluster& cluster : result) {
    request.context.checkCancelled();
    cluster.fit = fitBall(request.surface, cluster.points, cluster.fit.center, effort);
  }
  return result;
}

std::vector<Cluster> withoutEmpty(std::vector<Cluster> clusters) {
  std::vector<std::uint32_t> number(clusters.size(), kNone);
  std::vector<Cluster> result;
  for (std::uint32_t n = 0; n < clusters.size(); ++n) {
    if (clusters[n].units.empty()) continue;
    number[n] = static_cast<std::uint32_t>(result.size());
    result.push_back(std::move(clusters[n]));
  }
  for (Cluster& cluster : result) {
    for (std::uint32_t& n : cluster.neighbours) n = number[n];
  }
  return result;
}

double worstOf(std::span<const Cluster> clusters) {
  double worst = 0;
  for (const Cluster& cluster : clusters) worst = std::max(worst, cluster.fit.standOff());
  return worst;
}

std::vector<Ball> ballsOf(std::span<const Cluster> clusters) {
  std::vector<Ball> balls;
  for (const Cluster& cluster : clusters) {
    balls.push_back({cluster.fit.center.at, cluster.fit.reach * (1 + kHoldsMargin)});
  }
  return balls;
}

}  // namespace spheretree::builders
