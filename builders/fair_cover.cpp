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

/// Of a ball when all have the same.
double fairLoad(const FairCoverRequest& request, std::size_t balls) {
  return std::accumulate(request.loads.begin(), request.loads.end(), 0.0) / static_cast<double>(balls);
}

class Annealer {
 public:
  Annealer(const FairCoverRequest& request, std::span<const DepthProbe> start)
      : request_(request),
        random_(request.seed),
        middle_(request.surface.bounds().center()),
        fair_(fairLoad(request, start.size())),
        masks_(request.pieces.size(), 0),
        balls_(start.size()) {
    std::vector<Point32> corners;
    for (const Piece& piece : request.pieces) {
      corners.clear();
      for (const Eigen::Vector3d& p : piece.points) corners.push_back(toPoint32(p - middle_));
      lanes_.add(corners);
    }
    gather();
    for (std::size_t b = 0; b < balls_.size(); ++b) {
      aim(balls_[b], start[b]);
      put(b);
    }
  }

  FairCover run() {
    Judgement now = judge();
    FairCover best = cover(now);
    double bestEnergy = now.energy;
    Ball other;
    for (std::size_t i = 0; i < request_.steps; ++i) {
      const double t = static_cast<double>(i) / static_cast<double>(request_.steps);
      if (i % kStage == 0) {
        strictness_ = 1 + kStrictness * t;
        gather();
        now = judge();
        best = cover(now);
        bestEnergy = now.energy;
      }
      const std::size_t b = random_.next() % balls_.size();
      const DepthProbe center = moved(balls_[b].center, t);
      if (center.depth + request_.limit <= 0) continue;
      aim(other, center);
      std::swap(balls_[b], other);
      put(b);
      const Judgement then = judge();
      const double temperature = kHot * std::pow(kCold / kHot, t);
      if (then.energy > now.energy &&
          random_.uniform() >= std::exp((now.energy - then.energy) / temperature)) {
        std::swap(balls_[b], other);
        takeBack();
        continue;
      }
      now = then;
      if (now.energy < bestEnergy) {
        bestEnergy = now.energy;
        best = cover(now);
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

  struct Judgement {
    double energy;
    double load;  // the largest, shared as evenly as can be
  };

  void aim(Ball& ball, const DepthProbe& center) const {
    ball.center = center;
    ball.radius = center.depth + request_.limit;
    if (ball.radius > 0) {
      lanes_.farthestSquared(0, lanes_.size(), toPoint32(center.at - middle_), ball.squared);
    } else {
      ball.squared.assign(lanes_.size(), std::numeric_limits<float>::max());
    }
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

  /// The energy is the largest load of a set of balls that may share what only they hold, in units of the
  /// fair one and smoothed, so that every set above the average counts; and what is in no ball.
  [[nodiscard]] Judgement judge() {
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
    const double smooth = std::sqrt(std::sqrt(std::sqrt(std::sqrt(sum))));
    return {smooth + strictness_ * missed(), fair_ * most};
  }

  /// What is in no ball: its load in units of the fair one, and how far balls miss it in units of the limit.
  [[nodiscard]] double missed() const {
    if (free_ == 0) return 0;
    double farthest = 0;
    for (std::size_t p = 0; p < masks_.size(); ++p) {
      if (masks_[p] != 0) continue;
      double least = std::numeric_limits<double>::infinity();
      for (const Ball& ball : balls_) {
        least = std::min(least, std::sqrt(static_cast<double>(ball.squared[p])) - ball.radius);
      }
      farthest = std::max(farthest, least);
    }
    return std::max(0.0, held_[0]) / fair_ + farthest / request_.limit;
  }

  [[nodiscard]] FairCover cover(const Judgement& now) const {
    FairCover cover;
    for (const Ball& ball : balls_) cover.centers.push_back(ball.center);
    cover.load = now.load;
    cover.complete = free_ == 0;
    return cover;
  }

  const FairCoverRequest& request_;
  medial::Random random_;
  Eigen::Vector3d middle_;
  double fair_;
  CellLanes lanes_;
  std::vector<Mask> masks_;  // of each piece, the balls that hold it
  std::vector<Ball> balls_;
  std::vector<double> held_;                             // load, by mask
  std::vector<double> sums_;                             // of subsets
  std::size_t free_ = 0;                                 // pieces in no ball
  std::vector<std::pair<std::uint32_t, Mask>> changed_;  // by the last put()
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
      const double reach = std::sqrt(farthestSquared(request.pieces[p], cover.centers[b].at));
      const double standOff = (reach - cover.centers[b].depth) / request.limit;
      if (standOff <= 1) offers[p].push_back({b, standOff});
    }
  }
  const double fair = fairLoad(request, cover.centers.size());
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
