// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/patch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

#include "medial/surface_samples.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;
using medial::Surface;

constexpr std::uint32_t kNobody = std::numeric_limits<std::uint32_t>::max();
// Another ball must need less stand-off by this fraction before a piece changes hands.
constexpr double kHysteresis = 1e-9;
// A sweep that gains less than this fraction of the energy is the last.
constexpr double kLastGain = 2e-3;
// How fast a ball gets dearer that will need more balls below it than it may have.
constexpr double kLoadPower = 6;
// After so many sweeps an energy this many times the wanted one will not come down to it.
constexpr std::array<double, 3> kHope{3, 1.6, 1.25};
// Balls that stick out less than this share of the worst need not be fitted while the worst counts.
constexpr double kIgnored = 0.6;

}  // namespace

double BallCost::operator()(const Fit& fit, double load) const {
  const double standOff = std::max(0.0, fit.standOff());
  if (standOff <= goodEnough) return 1e-6 * standOff / scale;
  const double crowd = load > 0 ? std::pow(load / fairLoad, kLoadPower) : 0;
  switch (objective) {
    case Objective::Mean:
      return std::pow(standOff / scale, 1.5) + crowd;
    case Objective::Volume:
      return standOff * fit.reach * fit.reach / (scale * scale * scale) + crowd;
    case Objective::Worst:
      break;
  }
  return std::pow(standOff / scale, power) + crowd;
}

void BallCost::weighLoad(double load, double weight) {
  fairLoad = std::max(fairLoad, load * std::pow(weight, -1 / kLoadPower));
}

Patch::Patch(const RefineRequest& request, const LevelProblem& problem, const CornerIndex& corners,
             const std::vector<LevelBall>& level, std::span<const std::uint32_t> members,
             const BallCost& cost)
    : request_(request), problem_(problem), cost_(cost), members_(members.begin(), members.end()) {
  std::size_t count = 0;
  for (const std::uint32_t m : members_) count += level[m].pieces.size();
  pieces_.reserve(count);
  owner_.reserve(count);
  start_.reserve(count + 1);
  start_.push_back(0);
  for (std::uint32_t i = 0; i < members_.size(); ++i) {
    const LevelBall& ball = level[members_[i]];
    balls_.push_back({ball.fit, ball.load, ball.parent,
                      ball.pieces.empty() ? Member::State::Idle : Member::State::Used, false});
    for (const std::uint32_t piece : ball.pieces) {
      pieces_.push_back(piece);
      owner_.push_back(i);
      const std::span<const std::uint32_t> places = corners.of(piece);
      corner_.insert(corner_.end(), places.begin(), places.end());
      start_.push_back(static_cast<std::uint32_t>(corner_.size()));
    }
  }
  numberCorners(corners);
  reach_.resize(members_.size() * pieces_.size());
  for (std::size_t i = 0; i < members_.size(); ++i) measure(i);
}

namespace {

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__)
__attribute__((target_clones("default", "avx2"), optimize("O3", "no-math-errno")))
#endif
void takeRoots(double* values, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) values[i] = std::sqrt(values[i]);
}

}  // namespace

/// Makes numbers of the level's places numbers of the patch's own.
void Patch::numberCorners(const CornerIndex& corners) {
  if (corner_.empty()) return;
  const auto [least, most] = std::minmax_element(corner_.begin(), corner_.end());
  const std::uint32_t first = *least;
  std::vector<std::uint32_t> number(*most - first + 1, kNobody);
  for (std::uint32_t& corner : corner_) {
    std::uint32_t& own = number[corner - first];
    if (own == kNobody) {
      own = static_cast<std::uint32_t>(points_.size());
      points_.push(corners.place(corner));
    }
    corner = own;
  }
  marked_.assign(points_.size(), 0);
}

/// Fills the row of reaches of one ball.
void Patch::measure(std::size_t member) {
  squaredDistances(points_, balls_[member].fit.center.at, squared_);
  const double* squared = squared_.data();
  double* row = reach_.data() + member * pieces_.size();
  for (std::size_t piece = 0; piece < pieces_.size(); ++piece) {
    double most = squared[corner_[start_[piece]]];
    for (std::uint32_t i = start_[piece] + 1; i < start_[piece + 1]; ++i)
      most = std::max(most, squared[corner_[i]]);
    row[piece] = most;
  }
  takeRoots(row, pieces_.size());
}

double Patch::energy() const {
  double sum = 0;
  for (const Member& ball : balls_) {
    if (ball.state == Member::State::Used) sum += costOf(ball);
  }
  return sum;
}

double Patch::worst() const {
  double worst = 0;
  for (const Member& ball : balls_) {
    if (ball.state == Member::State::Used) worst = std::max(worst, ball.fit.standOff());
  }
  return worst;
}

void Patch::gather(std::size_t member) {
  own_.clear();
  ++mark_;
  for (std::size_t piece = 0; piece < pieces_.size(); ++piece) {
    if (owner_[piece] != member) continue;
    for (std::uint32_t k = start_[piece]; k < start_[piece + 1]; ++k) {
      const std::uint32_t i = corner_[k];
      if (marked_[i] == mark_) continue;
      marked_[i] = mark_;
      own_.push(points_.at(i));
    }
  }
}

bool Patch::mayHave(std::size_t member, std::size_t piece) const {
  const std::vector<std::uint32_t>& allowed = problem_.allowed[pieces_[piece]];
  return allowed.size() == problem_.parents ||
         std::binary_search(allowed.begin(), allowed.end(), balls_[member].parent);
}

/// Gives pieces without an owner to the balls that need the least stand-off for them; false when a piece
/// finds nobody.
bool Patch::placeOrphans() {
  bool possible = true;
  for (std::size_t piece = 0; piece < pieces_.size(); ++piece) {
    if (owner_[piece] != kNobody) continue;
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < balls_.size(); ++i) {
      if (balls_[i].state == Member::State::Gone) continue;
      const double standOff = reach(i, piece) - balls_[i].fit.center.depth;
      if (standOff >= least || !mayHave(i, piece)) continue;
      least = standOff;
      owner_[piece] = i;
    }
    if (owner_[piece] == kNobody) {
      possible = false;
      continue;
    }
    Member& taker = balls_[owner_[piece]];
    taker.load += loadOf(piece);
    taker.fit.reach = taker.state == Member::State::Used
                          ? std::max(taker.fit.reach, reach(owner_[piece], piece))
                          : reach(owner_[piece], piece);
    taker.state = Member::State::Used;
    taker.dirty = true;
  }
  return possible;
}

/// Hands the farthest pieces of a ball to others, as many as make the sum of all costs least.
void Patch::peel(std::size_t member) {
  Member& giver = balls_[member];
  const double depth = giver.fit.center.depth;
  const double floor = 0.5 * giver.fit.standOff() + depth;
  far_.clear();
  double rest = 0;  // reach of the pieces that are not looked at
  for (std::uint32_t piece = 0; piece < pieces_.size(); ++piece) {
    if (owner_[piece] != member) continue;
    const double r = reach(member, piece);
    if (r > floor) {
      far_.emplace_back(-r, piece);
    } else {
      rest = std::max(rest, r);
    }
  }
  std::sort(far_.begin(), far_.end());
  grown_.resize(balls_.size());
  for (std::size_t i = 0; i < balls_.size(); ++i) {
    grown_[i] = balls_[i];
    Fit& fit = grown_[i].fit;
    if (balls_[i].state == Member::State::Idle) fit.reach = std::max(0.0, fit.center.depth);
  }
  taker_.clear();
  const double before = costOf(giver);
  Member shrunk = giver;
  double extra = 0;
  double best = 0;
  std::size_t count = 0;
  for (std::size_t k = 0; k < far_.size(); ++k) {
    const std::uint32_t piece = far_[k].second;
    std::uint32_t taker = kNobody;
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < balls_.size(); ++i) {
      if (i == member || balls_[i].state == Member::State::Gone) continue;
      // A ball that need not grow costs nothing, otherwise the one that ends lowest.
      const double r = reach(i, piece);
      const Fit& fit = grown_[i].fit;
      const double standOff =
          r <= fit.reach ? -1 / (1 + r - fit.center.depth + fit.reach) : r - fit.center.depth;
      if (standOff >= least || !mayHave(i, piece)) continue;
      least = standOff;
      taker = i;
    }
    if (taker == kNobody) break;
    taker_.push_back(taker);
    const double load = loadOf(piece);
    if (const double r = reach(taker, piece); r > grown_[taker].fit.reach || load > 0) {
      extra -= costOf(grown_[taker]);
      grown_[taker].fit.reach = std::max(grown_[taker].fit.reach, r);
      grown_[taker].load += load;
      extra += costOf(grown_[taker]);
      if (extra > before) break;
    }
    shrunk.fit.reach = k + 1 < far_.size() ? -far_[k + 1].first : rest;
    shrunk.load -= load;
    const double change = (shrunk.fit.reach > 0 ? costOf(shrunk) : 0) + extra - before;
    if (change < best - kHysteresis * before) {
      best = change;
      count = k + 1;
    }
  }
  if (count == 0) return;
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t piece = far_[k].second;
    Member& taker = balls_[taker_[k]];
    owner_[piece] = taker_[k];
    taker.load += loadOf(piece);
    giver.load -= loadOf(piece);
    const double r = reach(taker_[k], piece);
    taker.fit.reach = taker.state == Member::State::Used ? std::max(taker.fit.reach, r) : r;
    taker.state = Member::State::Used;
    taker.dirty = true;
  }
  giver.dirty = true;
  giver.fit.reach = count < far_.size() ? -far_[count].first : rest;
  if (!(giver.fit.reach > 0)) {
    giver.state = Member::State::Idle;
    giver.load = 0;
  }
}

void Patch::fitDirty(const FitEffort& effort) {
  const double floor = cost_.objective == Objective::Worst ? kIgnored * worst() : 0;
  for (std::size_t i = 0; i < balls_.size(); ++i) {
    if (balls_[i].state == Member::State::Used && balls_[i].dirty && balls_[i].fit.standOff() >= floor)
      fit(i, effort);
  }
}

/// Every piece to the ball that needs the least stand-off for it.
void Patch::shareOut() {
  needed_.assign(balls_.size(), 0);
  for (Member& ball : balls_) ball.load = 0;
  for (std::size_t piece = 0; piece < pieces_.size(); ++piece) {
    const std::uint32_t old = owner_[piece];
    std::uint32_t best = old;
    double least = reach(old, piece) - balls_[old].fit.center.depth;
    least -= kHysteresis * std::abs(least);
    for (std::uint32_t i = 0; i < balls_.size(); ++i) {
      if (i == old || balls_[i].state == Member::State::Gone) continue;
      const double standOff = reach(i, piece) - balls_[i].fit.center.depth;
      if (standOff >= least || !mayHave(i, piece)) continue;
      least = standOff;
      best = i;
    }
    if (best != old) {
      balls_[best].dirty = true;
      balls_[old].dirty = true;
      owner_[piece] = best;
    }
    needed_[best] = std::max(needed_[best], reach(best, piece));
    balls_[best].load += loadOf(piece);
  }
  for (std::size_t i = 0; i < balls_.size(); ++i) {
    if (balls_[i].state == Member::State::Gone) continue;
    balls_[i].fit.reach = needed_[i];
    balls_[i].state = needed_[i] > 0 ? Member::State::Used : Member::State::Idle;
  }
}

void Patch::relax(std::size_t sweeps, const FitEffort& effort, double target) {
  fitDirty(effort);
  double before = energy();
  // Least stand-off for each piece comes near a good state fast, and then past it.
  for (std::size_t sweep = 0; sweep < sweeps; ++sweep) {
    request_.context.checkCancelled();
    const std::vector<Member> oldBalls = balls_;
    const std::vector<std::uint32_t> oldOwner = owner_;
    shareOut();
    fitDirty(effort);
    const double now = energy();
    if (now > before) {
      for (std::size_t i = 0; i < balls_.size(); ++i) {
        const bool moved = balls_[i].fit.center.at != oldBalls[i].fit.center.at;
        balls_[i] = oldBalls[i];
        if (moved) measure(i);
      }
      owner_ = oldOwner;
      break;
    }
    const bool last = !(now < before * (1 - kLastGain));
    before = now;
    if (now > target * kHope[std::min(sweep, kHope.size() - 1)]) return;
    if (last) break;
  }
  for (std::size_t sweep = 0; sweep < sweeps; ++sweep) {
    request_.context.checkCancelled();
    order_.clear();
    for (std::uint32_t i = 0; i < balls_.size(); ++i) {
      if (balls_[i].state == Member::State::Used) order_.emplace_back(-balls_[i].fit.standOff(), i);
    }
    std::sort(order_.begin(), order_.end());
    for (const auto& [standOff, i] : order_) peel(i);
    fitDirty(effort);
    const double now = energy();
    if (!(now < before * (1 - kLastGain))) break;
    before = now;
    if (now > target * kHope.back()) return;
  }
}

void Patch::fit(std::size_t member, const FitEffort& effort) {
  gather(member);
  Member& ball = balls_[member];
  ball.dirty = false;
  if (own_.size() == 0) return;
  const Vector3d old = ball.fit.center.at;
  ball.fit = fitBall(request_.surface, own_, ball.fit.center, effort);
  if (ball.fit.center.at != old) measure(member);
}

bool Patch::remove(std::size_t ball) {
  balls_[ball].state = Member::State::Gone;
  for (std::uint32_t& owner : owner_) {
    if (owner == ball) owner = kNobody;
  }
  return placeOrphans();
}

bool Patch::move(std::size_t from, std::size_t at, std::uint32_t parent, std::uint32_t variant,
                 const FitEffort& effort) {
  // The pieces of `at` are divided across the direction of one of its farthest ones.
  Member& grown = balls_[at];
  std::vector<std::pair<double, std::uint32_t>> far;
  for (std::uint32_t piece = 0; piece < pieces_.size(); ++piece) {
    if (owner_[piece] != at) continue;
    const std::vector<std::uint32_t>& allowed = problem_.allowed[pieces_[piece]];
    if (!std::binary_search(allowed.begin(), allowed.end(), parent)) continue;
    far.emplace_back(-reach(at, piece), piece);
  }
  if (far.empty()) return true;
  std::sort(far.begin(), far.end());
  // Variant 0 takes the farthest, the others step through the farther half.
  const std::size_t pick = variant == 0 ? 0 : (variant * (far.size() / 2 + 1) / 5) % far.size();
  const auto corner = [&](std::uint32_t piece) { return points_.at(corner_[start_[piece]]); };
  const Vector3d seed = corner(far[pick].second);
  std::vector<std::pair<double, std::uint32_t>> near;
  for (const auto& [reach, piece] : far) near.emplace_back((corner(piece) - seed).squaredNorm(), piece);
  std::sort(near.begin(), near.end());
  near.resize((near.size() + 1) / 2);

  Member& fresh = balls_[from];
  for (std::uint32_t& owner : owner_) {
    if (owner == from) owner = kNobody;
  }
  fresh.load = 0;
  for (const auto& [distance, piece] : near) {
    owner_[piece] = static_cast<std::uint32_t>(from);
    fresh.load += loadOf(piece);
    grown.load -= loadOf(piece);
  }
  fresh.parent = parent;
  fresh.state = Member::State::Used;
  gather(from);
  fresh.fit.center = startFor(seed, grown.fit.center.at);
  fit(from, request_.effort.fit);
  measure(from);
  // What is left of the old ball finds its own centre before pieces change hands.
  fit(at, effort);
  if (own_.size() == 0) {
    grown.state = Member::State::Idle;
    grown.load = 0;
  }
  return placeOrphans();
}

/// A centre to start from for the points in own_: the best of some between them and the old centre, and of
/// the largest balls inside the solid that touch the surface at the seed and in the middle.
DepthProbe Patch::startFor(const Vector3d& seed, const Vector3d& old) const {
  const Surface& surface = request_.surface;
  Vector3d middle = Vector3d::Zero();
  for (std::size_t i = 0; i < own_.size(); ++i) middle += own_.at(i);
  middle /= static_cast<double>(own_.size());
  std::vector<Vector3d> starts{0.5 * middle + 0.5 * old, 0.8 * middle + 0.2 * old};
  for (const Vector3d& place : {middle, seed}) {
    const medial::ClosestPoint on = surface.closestPoint(place);
    starts.push_back(medial::tangentBall(surface, {on.point, on.triangle}).center);
  }
  DepthProbe best;
  double least = std::numeric_limits<double>::infinity();
  for (const Vector3d& start : starts) {
    const DepthProbe probe = probeDepth(surface, start);
    const double standOff = std::sqrt(farthestSquared(own_, start)) - probe.depth;
    if (standOff >= least) continue;
    least = standOff;
    best = probe;
  }
  return best;
}

LevelBall Patch::ball(std::size_t member) const {
  LevelBall result;
  result.fit = balls_[member].fit;
  result.parent = balls_[member].parent;
  for (std::size_t piece = 0; piece < pieces_.size(); ++piece) {
    if (owner_[piece] != member) continue;
    result.pieces.push_back(pieces_[piece]);
    result.load += loadOf(piece);
  }
  std::sort(result.pieces.begin(), result.pieces.end());
  return result;
}

}  // namespace spheretree::builders
