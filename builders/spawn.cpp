// SPDX-License-Identifier: GPL-3.0-or-later
//
// The Spawn reducer of G. Bradshaw, C. O'Sullivan, "Adaptive medial-axis approximation for sphere-tree
// construction", ACM TOG 23(1), 2004: balls of one stand-off are grown, one after the other, where something
// is uncovered, and the least stand-off is searched at which few enough cover. Here growing is to start with
// the largest ball inside the solid that touches the surface there, and to climb: the centre moves while the
// ball then holds more of what nothing holds yet, always along the medial axis. Whatever was grown for one
// stand-off is a candidate for the next, and for the swaps that end the search.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "builders/inward.hpp"
#include "builders/reducer.hpp"
#include "builders/stand_off_search.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;
using medial::Ball;

// A climb starts with steps of this fraction of the ball's radius, and ends with steps of that.
constexpr double kFirstStep = 0.5;
constexpr double kLastStep = 0.1;
// What nothing holds yet pulls a ball when it is within so many radii.
constexpr double kPull = 1.5;

class Spawner {
 public:
  explicit Spawner(const ReduceRequest& request)
      : request_(request), search_(request), table_(search_.table()), rows_(table_.rows().size()) {
    for (const std::uint32_t cell : table_.rows()) middle_.push_back(search_.middleOf(cell));
    seed_.resize(rows_);
  }

  std::vector<Ball> run() {
    const Candidate whole = pushInward(request_.surface, search_.box().center());
    std::vector<std::uint32_t> best{table_.addCandidate(whole)};
    double high = standOffFor(whole);
    if (request_.goodEnough > 0) {
      if (const auto set = grow(request_.goodEnough)) {
        search_.startFrom(*set, request_.goodEnough);
        return search_.finish();
      }
    }
    high = search_.bisect(high, [&](double standOff) {
      auto set = grow(standOff);
      if (set) best = std::move(*set);
      return set.has_value();
    });
    search_.startFrom(std::move(best), high);
    return search_.finish();
  }

 private:
  /// With which one ball holds all rows.
  double standOffFor(const Candidate& ball) {
    const std::span<const float> reaches = table_.reachesSquared(ball.center);
    const float farthest = std::sqrt(*std::max_element(reaches.begin(), reaches.end()));
    constexpr double kRounding = 1e-6;
    return static_cast<double>(farthest) * (1 + kRounding) - ball.depth;
  }

  /// Balls that hold all rows, as far as maxBalls go: the row that is farthest from being held first.
  std::optional<std::vector<std::uint32_t>> grow(double standOff) {
    held_.assign(rows_, 0);
    std::vector<double> missing(rows_);
    for (std::size_t row = 0; row < rows_; ++row)
      missing[row] = (middle_[row] - search_.box().center()).norm();
    std::vector<std::uint32_t> set;
    for (;;) {
      request_.context.checkCancelled();
      std::uint32_t farthest = 0;
      double most = -std::numeric_limits<double>::infinity();
      for (std::uint32_t row = 0; row < rows_; ++row) {
        if (held_[row] != 0 || missing[row] <= most) continue;
        most = missing[row];
        farthest = row;
      }
      if (held_[farthest] != 0) return set;
      if (set.size() == request_.maxBalls) return std::nullopt;
      const Candidate ball = climb(farthest, standOff);
      if (gainOf(ball, standOff, farthest) <= 0) return std::nullopt;
      const bool first = set.empty();
      set.push_back(table_.addCandidate(ball));
      const std::span<const float> reaches = table_.reachesSquared(ball.center);
      const float limit = table_.squaredRadius(set.back(), standOff);
      for (std::size_t row = 0; row < rows_; ++row) {
        if (reaches[row] <= limit) held_[row] = 1;
        const double own = static_cast<double>(std::sqrt(reaches[row])) - ball.depth;
        missing[row] = first ? own : std::min(missing[row], own);
      }
    }
  }

  /// How many rows a ball would hold that nothing holds yet; -1 when `must` is not one of them. Rows stand
  /// for equal areas.
  int gainOf(const Candidate& ball, double standOff, std::uint32_t must) {
    const double radius = ball.depth + standOff;
    const double reach = request_.cells.farthestSquared(table_.rows()[must], ball.center);
    if (radius < 0 || reach > radius * radius) return -1;
    const std::span<const float> reaches = table_.reachesSquared(ball.center);
    const auto limit = static_cast<float>(radius * radius);
    int gain = 0;
    for (std::size_t row = 0; row < rows_; ++row) gain += held_[row] == 0 && reaches[row] <= limit ? 1 : 0;
    return gain;
  }

  /// The ball that holds `row` and, as far as small steps lead, most of what nothing holds yet.
  Candidate climb(std::uint32_t row, double standOff) {
    if (!seed_[row]) seed_[row] = search_.growFrom(table_.rows()[row]);
    Candidate best = *seed_[row];
    int gain = gainOf(best, standOff, row);
    for (const Candidate& grown : grown_) {
      const int other = gainOf(grown, standOff, row);
      if (other <= gain) continue;
      gain = other;
      best = grown;
    }
    const double radius = best.depth + standOff;
    for (double step = kFirstStep; step >= kLastStep;) {
      bool moved = false;
      for (const Vector3d& direction : directionsFrom(best, standOff)) {
        const Candidate trial = pushInward(request_.surface, best.center + step * radius * direction);
        const int other = gainOf(trial, standOff, row);
        if (other <= gain) continue;
        gain = other;
        best = trial;
        moved = true;
        break;
      }
      if (!moved) step /= 2;
    }
    grown_.push_back(best);
    return best;
  }

  /// Towards what nothing holds yet near by, then up, down and sideways.
  std::array<Vector3d, 7> directionsFrom(const Candidate& ball, double standOff) {
    const double near = kPull * (ball.depth + standOff);
    Vector3d pull = Vector3d::Zero();
    for (std::size_t row = 0; row < rows_; ++row) {
      const Vector3d to = middle_[row] - ball.center;
      if (held_[row] == 0 && to.squaredNorm() <= near * near) pull += to;
    }
    return {pull.stableNormalized(), Vector3d::UnitX(), -Vector3d::UnitX(), Vector3d::UnitY(),
            -Vector3d::UnitY(),      Vector3d::UnitZ(), -Vector3d::UnitZ()};
  }

  const ReduceRequest& request_;
  StandOffSearch search_;
  CoverTable& table_;
  std::size_t rows_;
  std::vector<Vector3d> middle_;                // by row
  std::vector<std::optional<Candidate>> seed_;  // by row: where a ball grows from
  std::vector<Candidate> grown_;
  std::vector<std::uint8_t> held_;  // by row
};

class SpawnReducer final : public Reducer {
 public:
  [[nodiscard]] std::vector<Ball> reduce(const ReduceRequest& request) const override {
    return Spawner(request).run();
  }
};

}  // namespace

std::unique_ptr<Reducer> makeSpawnReducer() {
  return std::make_unique<SpawnReducer>();
}

}  // namespace spheretree::builders
