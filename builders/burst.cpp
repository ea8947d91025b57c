// SPDX-License-Identifier: GPL-3.0-or-later
//
// G. Bradshaw, C. O'Sullivan, "Adaptive medial-axis approximation for sphere-tree construction", ACM TOG
// 23(1), 2004, section 5: of many medial balls the one that costs least is burst, and its neighbours grow to
// cover what it covered, until few enough are left. The cost of a ball is the largest overhang that one of its
// cells needs at the neighbour that pays least for it.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <iterator>
#include <limits>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

#include "builders/clusters.hpp"
#include "builders/reducer.hpp"

namespace spheretree::builders {
namespace {


constexpr FitEffort kWalk{4, 5e-3};

struct Removal {
  std::int64_t cost;  // overhang in steps of costStep()
  std::uint32_t ball;
  std::uint64_t time;  // when the cost was found

  bool operator<(const Removal& other) const {
    return std::tuple(cost, ball) > std::tuple(other.cost, other.ball);
  }
};

class Bursting {
 public:
  Bursting(const ReduceRequest& request, const Units& units, std::vector<Cluster> clusters, bool moving)
      : request_(request), units_(units), step_(costStep(request)), clusters_(std::move(clusters)), moving_(moving), state_(clusters_.size()) {}

  std::vector<Cluster> run(std::size_t wanted) {
    for (std::uint32_t n = 0; n < clusters_.size(); ++n) push(n);
    initial_ = false;
    std::size_t alive = clusters_.size();
    while (alive > wanted && !queue_.empty()) {
      const Removal removal = queue_.top();
      queue_.pop();
      const State& state = state_[removal.ball];
      if (!state.alive) continue;
      if (removal.time == 0 || removal.time < state.changed) {
        push(removal.ball);
        continue;
      }
      burst(removal.ball);
      --alive;
    }
    return withoutEmpty(std::move(clusters_));
  }

 private:
  struct State {
    std::uint64_t changed = 0;  // when the ball or one of its neighbours last changed
    bool alive = true;
  };
  struct Taker {
    std::uint32_t ball = 0;
    double price = 0;
    std::size_t at = 0;
  };

  /// The neighbour that needs to stick out least for a cell.
  Taker takerOf(const Cluster& from, std::uint32_t cell) const {
    return takerOf(from, cell, -std::numeric_limits<double>::infinity(), 0);
  }
  /// any neighbour whose price is at most `enough` will do.
  Taker takerOf(const Cluster& from, std::uint32_t cell, double enough, std::size_t hint) const {
    const Eigen::Vector3d& corner = units_.corners(cell).front();
    Taker best{0, std::numeric_limits<double>::infinity()};
    for (std::size_t i = 0; i < from.neighbours.size(); ++i) {
      const std::size_t at = (i + hint) % from.neighbours.size();
      const std::uint32_t n = from.neighbours[at];
      const DepthProbe& center = clusters_[n].fit.center;
      const double limit = best.price + center.depth - step_;
      if (limit < 0 || (corner - center.at).squaredNorm() > limit * limit) continue;
      const double price = std::sqrt(units_.farthestSquared(cell, center.at)) - center.depth;
      if (price < best.price - step_) best = {n, price, at};
      if (best.price <= enough) break;
    }
    return best;
  }

  /// Prices a ball. A price beyond that of the next in the queue need not be known any better: the ball is
  /// looked at again when its turn comes.
  void push(std::uint32_t ball) {
    if (++evaluations_ % 16 == 0) request_.context.checkCancelled();
    std::int64_t enough = queue_.empty()||initial_ ? std::numeric_limits<std::int64_t>::max() : queue_.top().cost;
    std::vector<std::uint32_t>& cells = clusters_[ball].units;
    Removal removal{std::numeric_limits<std::int64_t>::min(), ball, ++time_};
    double dearest = -std::numeric_limits<double>::infinity();
    std::size_t hint = 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const Taker taker = takerOf(clusters_[ball], cells[i], dearest, hint);
      hint = taker.at;
      if (taker.price <= dearest) continue;
      dearest = taker.price;
      const std::int64_t cost = std::llround(taker.price / step_);
      removal.cost = cost;
      // The dearest cell goes first: next time it is likely to decide at once.
      std::swap(cells[0], cells[i]);
      if (cost > enough) {
        removal.time = 0;
        break;
      }
    }
    queue_.push(removal);
  }

  void burst(std::uint32_t ball) {
    Cluster gone = std::move(clusters_[ball]);
    clusters_[ball] = {};
    state_[ball].alive = false;
    std::vector<std::uint32_t> takers;
    for (const std::uint32_t cell : gone.units) {
      const std::uint32_t taker = takerOf(gone, cell).ball;
      takers.push_back(taker);
      Cluster& cluster = clusters_[taker];
      cluster.units.push_back(cell);
      for (const Eigen::Vector3d& p : units_.corners(cell)) cluster.points.push(p);
      cluster.fit.reach = std::max(cluster.fit.reach, std::sqrt(units_.farthestSquared(cell, cluster.fit.center.at)));
    }
    std::sort(takers.begin(), takers.end());
    takers.erase(std::unique(takers.begin(), takers.end()), takers.end());
    ++time_;
    for (const std::uint32_t n : gone.neighbours) {
      std::erase(clusters_[n].neighbours, ball);
      state_[n].changed = time_;
    }
    for (const std::uint32_t t : takers) {
      Cluster& taker = clusters_[t];
      if (moving_) taker.fit = fitBall(request_.surface, taker.points, taker.fit.center, kWalk);
      for (const std::uint32_t n : gone.neighbours) {
        if (n == t) continue;
        link(t, n);
        link(n, t);
      }
      if (moving_) for (const std::uint32_t n : taker.neighbours) state_[n].changed = time_;
    }
  }

  void link(std::uint32_t from, std::uint32_t to) {
    std::vector<std::uint32_t>& list = clusters_[from].neighbours;
    const auto at = std::lower_bound(list.begin(), list.end(), to);
    if (at == list.end() || *at != to) list.insert(at, to);
  }

  const ReduceRequest& request_;
  const Units& units_;
  double step_;
  std::vector<Cluster> clusters_;
  bool moving_;
  std::vector<State> state_;
  std::priority_queue<Removal> queue_;
  std::uint64_t time_ = 0;
  std::size_t evaluations_ = 0;bool initial_ = true;
};

class BurstReducer final : public Reducer {
 public:
  [[nodiscard]] bool wantsAxis() const override { return true; }

  [[nodiscard]] std::vector<medial::Ball> reduce(const ReduceRequest& request) const override {
    const auto burst = [&](bool moving) {
      return [&request, moving](const Units& units, std::vector<Cluster> clusters, std::size_t wanted) {
        return Bursting(request, units, std::move(clusters), moving).run(wanted);
      };
    };
    return reduceInStages(request, burst(false), burst(true));
  }
};

}  // namespace

std::unique_ptr<Reducer> makeBurstReducer() {
  return std::make_unique<BurstReducer>();
}

}  // namespace spheretree::builders
