// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/fair_cover.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "builders/cell_lanes.hpp"
#include "medial/random.hpp"

namespace spheretree::builders {
namespace {

// First and last temperature, in units of the fair load, and farthest move, in diagonals.
constexpr double kHot = 0.05;
constexpr double kCold = 0.0005;
constexpr double kFar = 0.1;
constexpr double kNear = 0.003;
// At first so many steps are jumps to one of the places, in the end none.
constexpr double kJumps = 0.15;
// What is not held counts this many times as much in the end as in the beginning.
constexpr double kStrictness = 20;
// The state is computed anew after so many steps, and the best one of so many is not older.
constexpr std::size_t kStage = 256;
// Distances are in single precision.
constexpr double kRounding = 1e-6;
constexpr int kRoundsOfBids = 300;
constexpr double kBid = 0.3;
constexpr double kBidsFade = 0.1;

using Mask = std::uint16_t;
static_assert(kMostFairBalls <= 16);

class Annealer {
 public:
  Annealer(const FairCoverRequest& request, std::span<const DepthProbe> start)
      : request_(request),
        random_(request.seed),
        middle_(request.surface.bounds().center()),
        fair_(std::accumulate(request.loads.begin(), request.loads.end(), 0.0) /
              static_cast<double>(start.size())),
        masks_(request.pieces.size(), 0),
        balls_(start.size()) {
    std::vector<Point32> corners;
    for (const Piece& piece : request.pieces) {
      corners.clear();
      for (const Eigen::Vector3d& p : piece.points) corners.push_back(toPoint32(p - middle_));
      lanes_.add(corners);
    }
    for (std::size_t b = 0; b < balls_.size(); ++b) {
      balls_[b] = ballAt(start[b]);
      put(b);
    }
    gather();
  }

  FairCover run() {
    double now = energy();
    FairCover best = state();
    double bestEnergy = now;
    for (std::size_t i = 0; i < request_.steps; ++i) {
      const double t = static_cast<double>(i) / static_cast<double>(request_.steps);
      if (i % kStage == 0) {
        strictness_ = 1 + kStrictness * t;
        gather();
        now = energy();
        best = state();
        bestEnergy = now;
      }
      const std::size_t b = random_.next() % balls_.size();
      Ball other = ballAt(moved(balls_[b].center, t));
      if (other.radius <= 0) continue;
      std::swap(balls_[b], other);
      put(b);
      const double then = energy();
      if (then > now && random_.uniform() >= std::exp((now - then) / (kHot * std::pow(kCold / kHot, t)))) {
        std::swap(balls_[b], other);
        takeBack();
        continue;
      }
      now = then;
      if (now < bestEnergy) {
        bestEnergy = now;
        best = state();
      }
    }
    return best;
  }

 private:
  struct Ball {
    DepthProbe center;
    double radius = 0;
    std::vector<float> squared;  // distances to the farthest corners of the pieces
  };

  [[nodiscard]] Ball ballAt(const DepthProbe& center) const {
    Ball ball{center, center.depth + request_.limit, {}};
    if (ball.radius > 0) {
      lanes_.farthestSquared(0, lanes_.size(), toPoint32(center.at - middle_), ball.squared);
    } else {
      ball.squared.assign(lanes_.size(), std::numeric_limits<float>::max());
    }
    return ball;
  }

  [[nodiscard]] DepthProbe moved(const DepthProbe& from, double t) {
    if (random_.uniform() < kJumps * (1 - t)) return request_.places[random_.next() % request_.places.size()];
    const double reach = request_.surface.diagonal() * kFar * std::pow(kNear / kFar, t);
    Eigen::Vector3d at = from.at;
    for (int axis = 0; axis < 3; ++axis) at[axis] += reach * (random_.uniform() + random_.uniform() - 1);
    return probeDepth(request_.surface, at);
  }

  /// Ball b is another one now.
  void put(std::size_t b) {
    const double radius = std::max(0.0, balls_[b].radius) * (1 - kRounding);
    const auto within = static_cast<float>(radius * radius);
    const auto bit = static_cast<Mask>(1U << b);
    changed_.clear();
    for (std::uint32_t p = 0; p < masks_.size(); ++p) {
      const Mask old = masks_[p];
      const auto fresh = static_cast<Mask>((old & ~bit) | (balls_[b].squared[p] <= within ? bit : 0));
      if (fresh == old) continue;
      changed_.emplace_back(p, old);
      change(p, fresh);
    }
  }

  void takeBack() {
    for (const auto& [p, old] : changed_) change(p, old);
  }

  void change(std::uint32_t p, Mask fresh) {
    held_[masks_[p]] -= request_.loads[p];
    held_[fresh] += request_.loads[p];
    if (masks_[p] == 0) --free_;
    if (fresh == 0) ++free_;
    masks_[p] = fresh;
  }

  /// Sums without what rounding has left in them.
  void gather() {
    held_.assign(std::size_t{1} << balls_.size(), 0);
    free_ = 0;
    for (std::size_t p = 0; p < masks_.size(); ++p) {
      held_[masks_[p]] += request_.loads[p];
      if (masks_[p] == 0) ++free_;
    }
  }

  /// Largest load, in units of the fair one, of a set of balls that may share what only they hold; smoothed
  /// when `smooth`, so that every set above the average counts.
  [[nodiscard]] double crowding(bool smooth) {
    sums_ = held_;
    sums_[0] = 0;
    for (std::size_t bit = 1; bit < sums_.size(); bit *= 2) {
      for (std::size_t s = 0; s < sums_.size(); ++s) {
        if ((s & bit) != 0) sums_[s] += sums_[s ^ bit];
      }
    }
    double most = 0;
    double sum = 0;
    for (std::size_t s = 1; s < sums_.size(); ++s) {
      const double load = sums_[s] / (fair_ * static_cast<double>(std::popcount(s)));
      most = std::max(most, load);
      const double fourth = (load * load) * (load * load);
      sum += (fourth * fourth) * (fourth * fourth);
    }
    return smooth ? std::sqrt(std::sqrt(std::sqrt(std::sqrt(sum)))) : most;
  }

  [[nodiscard]] double energy() {
    double missed = 0;
    if (free_ > 0) {
      double farthest = 0;
      for (std::size_t p = 0; p < masks_.size(); ++p) {
        if (masks_[p] != 0) continue;
        double least = std::numeric_limits<double>::infinity();
        for (const Ball& ball : balls_) {
          least = std::min(least, std::sqrt(static_cast<double>(ball.squared[p])) - ball.radius);
        }
        farthest = std::max(farthest, least);
      }
      missed = std::max(0.0, held_[0]) / fair_ + farthest / request_.limit;
    }
    return crowding(true) + strictness_ * missed;
  }

  [[nodiscard]] FairCover state() {
    FairCover cover;
    for (const Ball& ball : balls_) cover.centers.push_back(ball.center);
    cover.load = fair_ * crowding(false);
    cover.complete = free_ == 0;
    return cover;
  }

  const FairCoverRequest& request_;
  medial::Random random_;
  Eigen::Vector3d middle_;
  double fair_;  // load of a ball when all have the same
  CellLanes lanes_;
  std::vector<Mask> masks_;  // of each piece, the balls that hold it
  std::vector<Ball> balls_;
  std::vector<double> held_ = std::vector<double>(std::size_t{1} << kMostFairBalls);  // load, by mask
  std::vector<double> sums_;                                                          // of subsets
  std::size_t free_ = 0;                                                              // pieces in no ball
  std::vector<std::pair<std::uint32_t, Mask>> changed_;                               // by the last put()
  double strictness_ = 1;
};

}  // namespace

FairCover fairCover(const FairCoverRequest& request, std::span<const DepthProbe> start) {
  return Annealer(request, start).run();
}

std::vector<std::uint32_t> shareFairly(const FairCoverRequest& request, const FairCover& cover) {
  struct Offer {
    std::uint32_t ball;
    double standOff;  // in units of the limit
  };
  std::vector<std::vector<Offer>> offers(request.pieces.size());
  for (std::size_t p = 0; p < offers.size(); ++p) {
    for (std::uint32_t b = 0; b < cover.centers.size(); ++b) {
      double squared = 0;
      for (const Eigen::Vector3d& corner : request.pieces[p].points) {
        squared = std::max(squared, (corner - cover.centers[b].at).squaredNorm());
      }
      const double standOff = (std::sqrt(squared) - cover.centers[b].depth) / request.limit;
      if (standOff <= 1) offers[p].push_back({b, standOff});
    }
  }
  const double fair = std::accumulate(request.loads.begin(), request.loads.end(), 0.0) /
                      static_cast<double>(cover.centers.size());
  std::vector<double> price(cover.centers.size(), 0);
  std::vector<std::uint32_t> owner(offers.size(), 0);
  for (int round = 0; round < kRoundsOfBids; ++round) {
    std::vector<double> load(price.size(), 0);
    for (std::size_t p = 0; p < owner.size(); ++p) {
      double least = std::numeric_limits<double>::infinity();
      for (const Offer& offer : offers[p]) {
        const double cost = offer.standOff + price[offer.ball];
        if (cost >= least) continue;
        least = cost;
        owner[p] = offer.ball;
      }
      load[owner[p]] += request.loads[p];
    }
    const double bid = kBid / (1 + kBidsFade * round);
    for (std::size_t b = 0; b < price.size(); ++b) {
      price[b] = std::max(0.0, price[b] + bid * (load[b] / fair - 1));
    }
  }
  return owner;
}

}  // namespace spheretree::builders
