// SPDX-License-Identifier: GPL-3.0-or-later
//
// G. Bradshaw, C. O'Sullivan, "Adaptive medial-axis approximation for sphere-tree construction", ACM TOG
// 23(1), 2004, section 5: of many medial balls the one that costs least bursts and its neighbours grow to
// cover what it covered, until few enough are left. Here each unit goes to the neighbour that needs to stick
// out least for it, and the cost of a ball is what its dearest unit needs. The queue is lazy: costs are found
// again when their turn comes.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

#include "builders/clusters.hpp"
#include "builders/reducer.hpp"
#include "builders/stages.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kPricesPerCheck = 16;  // well below a millisecond

/// What becomes of the centres of the balls that grow.
enum class Growth : std::uint8_t { Fixed, Following };

struct Removal {
  enum class Cost : std::uint8_t { Exact, AtLeast };

  std::int64_t cost;  // overhang in steps of costStep()
  Cost known;
  std::uint32_t ball;
  std::uint32_t version;

  /// std::priority_queue serves the greatest: the cheapest removal, then the lowest number.
  bool operator<(const Removal& other) const {
    return std::tuple(cost, ball) > std::tuple(other.cost, other.ball);
  }
};

class Bursting {
 public:
  Bursting(const ReduceRequest& request, const Units& units, std::vector<Cluster> clusters, Growth growth)
      : request_(request),
        units_(units),
        growth_(growth),
        step_(costStep(request)),
        clusters_(std::move(clusters)),
        version_(clusters_.size(), 0) {}

  std::vector<Cluster> run(std::size_t wanted) {
    std::size_t left = clusters_.size();
    if (left <= wanted) return std::move(clusters_);
    for (std::uint32_t ball = 0; ball < clusters_.size(); ++ball) {
      queue_.push(price(ball, std::numeric_limits<std::int64_t>::max()));
    }
    while (left > wanted) {
      const Removal removal = queue_.top();
      queue_.pop();
      if (clusters_[removal.ball].units.empty()) continue;
      if (removal.known == Removal::Cost::Exact && removal.version == version_[removal.ball]) {
        burst(removal.ball);
        --left;
      } else {
        queue_.push(price(removal.ball, queue_.empty() ? removal.cost : queue_.top().cost));
      }
    }
    return withoutEmpty(std::move(clusters_));
  }

 private:
  struct Taker {
    std::size_t index = 0;  // in the neighbours
    double standOff = kInfinity;
  };

  /// The neighbour that needs to stick out least for a unit, or any that need not stick out more than
  /// `enough`. Asks them in turn, beginning with number `first`.
  [[nodiscard]] Taker takerOf(const Cluster& from, std::uint32_t unit, double enough = -kInfinity,
                              std::size_t first = 0) const {
    const Vector3d& corner = units_.corners(unit).front();
    Taker best;
    for (std::size_t i = 0; i < from.neighbours.size(); ++i) {
      const std::size_t index = (first + i) % from.neighbours.size();
      const DepthProbe& center = clusters_[from.neighbours[index]].fit.center;
      const double limit = best.standOff + center.depth - step_;
      if (limit < 0 || (corner - center.at).squaredNorm() > limit * limit) continue;
      const double standOff = std::sqrt(units_.farthestSquared(unit, center.at)) - center.depth;
      if (standOff > best.standOff - step_) continue;
      best = {index, standOff};
      if (standOff <= enough) break;
    }
    return best;
  }

  /// What it costs to do without a ball. A cost above `enough` need not be known any better.
  Removal price(std::uint32_t ball, std::int64_t enough) {
    if (++prices_ % kPricesPerCheck == 0) request_.context.checkCancelled();
    Cluster& cluster = clusters_[ball];
    Removal removal{0, Removal::Cost::Exact, ball, version_[ball]};
    Taker dearest{0, -kInfinity};
    std::size_t likely = 0;
    for (std::uint32_t& unit : cluster.units) {
      const Taker taker = takerOf(cluster, unit, dearest.standOff, likely);
      likely = taker.index;
      if (taker.standOff <= dearest.standOff) continue;
      dearest = taker;
      removal.cost = std::llround(dearest.standOff / step_);
      // It goes first: next time it is likely to decide at once.
      std::swap(cluster.units.front(), unit);
      if (removal.cost <= enough) continue;
      removal.known = Removal::Cost::AtLeast;
      break;
    }
    return removal;
  }

  void burst(std::uint32_t ball) {
    const Cluster gone = std::exchange(clusters_[ball], {});
    std::vector<std::uint32_t> takers;
    for (const std::uint32_t unit : gone.units) {
      const std::uint32_t taker = gone.neighbours[takerOf(gone, unit).index];
      takers.push_back(taker);
      give(unit, clusters_[taker]);
    }
    std::sort(takers.begin(), takers.end());
    takers.erase(std::unique(takers.begin(), takers.end()), takers.end());
    for (const std::uint32_t n : gone.neighbours) {
      std::erase(clusters_[n].neighbours, ball);
      ++version_[n];
    }
    for (const std::uint32_t taker : takers) {
      for (const std::uint32_t n : gone.neighbours) link(taker, n);
      if (growth_ == Growth::Fixed) continue;
      Cluster& grown = clusters_[taker];
      grown.fit = fitBall(request_.surface, grown.points, grown.fit.center, kFollow);
      for (const std::uint32_t n : grown.neighbours) ++version_[n];
    }
  }

  void give(std::uint32_t unit, Cluster& taker) {
    taker.units.push_back(unit);
    for (const Vector3d& p : units_.corners(unit)) taker.points.push(p);
    const double reach = std::sqrt(units_.farthestSquared(unit, taker.fit.center.at));
    taker.fit.reach = std::max(taker.fit.reach, reach);
  }

  void link(std::uint32_t a, std::uint32_t b) {
    if (a == b) return;
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
      std::vector<std::uint32_t>& list = clusters_[from].neighbours;
      const auto at = std::lower_bound(list.begin(), list.end(), to);
      if (at == list.end() || *at != to) list.insert(at, to);
    }
  }

  const ReduceRequest& request_;
  const Units& units_;
  Growth growth_;
  double step_;
  std::vector<Cluster> clusters_;       // a ball that burst has no units
  std::vector<std::uint32_t> version_;  // of each ball, raised when its cost may have changed
  std::priority_queue<Removal> queue_;
  std::size_t prices_ = 0;
};

class BurstReducer final : public Reducer {
 public:
  [[nodiscard]] bool wantsAxis() const override { return true; }

  [[nodiscard]] std::vector<medial::Ball> reduce(const ReduceRequest& request) const override {
    const auto burstBy = [&](Growth growth) -> ReduceTo {
      return [&request, growth](const Units& units, std::vector<Cluster> clusters, std::size_t wanted) {
        return Bursting(request, units, std::move(clusters), growth).run(wanted);
      };
    };
    return reduceInStages(request, burstBy(Growth::Fixed), burstBy(Growth::Following));
  }
};

}  // namespace

std::unique_ptr<Reducer> makeBurstReducer() {
  return std::make_unique<BurstReducer>();
}

}  // namespace spheretree::builders
