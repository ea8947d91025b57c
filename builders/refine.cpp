// SPDX-License-Identifier: GPL-3.0-or-later
//
// A level as a whole: minimax alternating refinement (S. Lloyd 1957 with a maximum for the mean; P. Agarwal,
// C. Procopiuc, "Approximation algorithms for projective clustering", 2003, for the exchange of centres).
//   1. centres: each ball moves to where its pieces need the least stand-off (fit_ball.hpp);
//   2. pieces: each goes to the ball that needs the least stand-off for it, among those that may have it;
//   3. balls: one that is little needed is taken away and put where a ball sticks out far, if the level is
//      better for it after 1 and 2 were repeated around both places;
//   4. seams: pieces that decide how far a ball sticks out are cut in two.
// Every step keeps the cover, none makes the level worse.
#include "builders/refine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>
#include <utility>

#include <Eigen/Geometry>

#include "builders/corner_index.hpp"
#include "builders/patch.hpp"
#include "medial/parallel.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;

// Balls near a change that may react to it.
constexpr std::size_t kMostNeighbours = 12;
// Pieces of a ball that are looked at to find its neighbours.
constexpr std::size_t kLookedAt = 24;
// Attempts that are made side by side. Fixed, so that the number of threads never matters.
constexpr std::size_t kBatch = 16;
// Balls that a batch of attempts apart from each other is looked for among, the costliest.
constexpr std::size_t kMostLooked = 512;
constexpr std::uint32_t kVariants = 3;
// How near to the worst a ball must be to take one from elsewhere.
constexpr double kWorthwhile = 0.7;
// The price of taking a ball away is an estimate from above: up to this many times the gain it is worth a
// try.
constexpr double kMostPrice = 300;
// Room is made by at most so many balls that change their parent.
constexpr std::uint32_t kMostHandovers = 6;
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kRelaxSweeps = 4;
// A piece is cut when its own stand-off is more than this share of its ball's, and its ball's more than this
// share of the worst.
constexpr double kCriticalPiece = 0.92;
constexpr double kCriticalBall = 0.5;
// Pieces shorter than this fraction of their ball's reach are not cut any more.
constexpr double kShortest = 0.02;
// A sweep that lowers the energy by less than this fraction is the last.
constexpr double kLastGain = 2e-3;
constexpr double kPower = 10;
// No ball sticks out more than the worst.
constexpr double kNever = 2;

class LevelRefiner {
 public:
  LevelRefiner(LevelProblem& problem, std::vector<LevelBall> balls, const RefineRequest& request)
      : problem_(problem), request_(request), balls_(std::move(balls)) {
    cost_.objective = request.objective;
    cost_.power = kPower;
    cost_.goodEnough = request.goodEnough;
    cost_.fairLoad = problem.fairLoad;
    version_.resize(balls_.size());
    for (std::uint32_t& v : version_) v = ++clock_;
    corners_ = CornerIndex(problem.pieces);
  }

  std::vector<LevelBall> run() {
    shareOutAnew();
    for (std::size_t round = 0;; ++round) {
      rescale();
      sweep(request_.effort.sweeps);
      polish();
      rescale();
      if (round == 0 || round + 1 == request_.effort.rounds) {
        exchange(std::max(request_.effort.leastTrials, request_.effort.trialsPerBall * balls_.size()));
      }
      if (round >= request_.effort.rounds) break;
      if (!cutSeams()) break;
    }
    if (request_.goodEnough > 0) dropUnneeded();
    std::erase_if(balls_, [](const LevelBall& ball) { return ball.pieces.empty(); });
    return std::move(balls_);
  }

 private:
  [[nodiscard]] double standOff(std::size_t ball, std::size_t piece) const {
    const DepthProbe& center = balls_[ball].fit.center;
    return std::sqrt(farthestSquared(problem_.pieces[piece], center.at)) - center.depth;
  }

  [[nodiscard]] bool mayHave(std::size_t ball, std::size_t piece) const {
    const std::vector<std::uint32_t>& allowed = problem_.allowed[piece];
    return allowed.size() == problem_.parents ||
           std::binary_search(allowed.begin(), allowed.end(), balls_[ball].parent);
  }

  [[nodiscard]] double worst() const {
    double worst = 0;
    for (const LevelBall& ball : balls_) {
      if (!ball.pieces.empty()) worst = std::max(worst, ball.fit.standOff());
    }
    return worst;
  }

  [[nodiscard]] double energy() const {
    double sum = 0;
    for (const LevelBall& ball : balls_) {
      if (!ball.pieces.empty()) sum += cost_(ball.fit, ball.load);
    }
    return sum;
  }

  /// The worst stand-off costs one and the worst load its weight, so that neither is ever all that counts.
  void rescale() {
    cost_.scale = std::max(worst(), std::numeric_limits<double>::min());
    cost_.fairLoad = problem_.fairLoad;
    for (const LevelBall& ball : balls_) cost_.weighLoad(ball.load, problem_.loadWeight);
  }

  /// Every piece to the best of all balls that may have it.
  void shareOutAnew() {
    std::vector<std::vector<std::uint32_t>> below(problem_.parents);
    for (std::uint32_t b = 0; b < balls_.size(); ++b) below[balls_[b].parent].push_back(b);
    std::vector<std::uint32_t> owner(problem_.pieces.size(), 0);
    constexpr std::size_t kBlock = 256;
    medial::parallelFor((owner.size() + kBlock - 1) / kBlock, request_.context, [&](std::size_t block) {
      const std::size_t end = std::min(owner.size(), (block + 1) * kBlock);
      for (std::size_t piece = block * kBlock; piece < end; ++piece) {
        double least = std::numeric_limits<double>::infinity();
        const Vector3d& first = problem_.pieces[piece].points.front();
        for (const std::uint32_t parent : problem_.allowed[piece]) {
          for (const std::uint32_t b : below[parent]) {
            const DepthProbe& center = balls_[b].fit.center;
            const double limit = least + center.depth;
            if (limit < 0 || (first - center.at).squaredNorm() >= limit * limit) continue;
            const double value = standOff(b, piece);
            if (value >= least) continue;
            least = value;
            owner[piece] = b;
          }
        }
      }
    });
    takeOver(owner);
  }

  void takeOver(const std::vector<std::uint32_t>& owner) {
    for (LevelBall& ball : balls_) ball.pieces.clear();
    for (std::uint32_t piece = 0; piece < owner.size(); ++piece) balls_[owner[piece]].pieces.push_back(piece);
    medial::parallelFor(balls_.size(), request_.context, [&](std::size_t b) { measure(b); });
  }

  void measure(std::size_t b) {
    double most = 0;
    for (const std::uint32_t piece : balls_[b].pieces) {
      most = std::max(most, farthestSquared(problem_.pieces[piece], balls_[b].fit.center.at));
    }
    balls_[b].fit.reach = std::sqrt(most);
    balls_[b].load = 0;
    if (problem_.loads.empty()) return;
    for (const std::uint32_t piece : balls_[b].pieces) balls_[b].load += problem_.loads[piece];
  }

  /// Where the balls are, side by side; to be called before neighbours() when balls have moved.
  void gatherCenters() {
    ++gathered_;
    nearOf_.resize(balls_.size(), 0);
    near_.resize(balls_.size());
    centers_.clear();
    depths_.clear();
    for (const LevelBall& ball : balls_) {
      centers_.push(ball.fit.center.at);
      depths_.push_back(ball.fit.center.depth);
    }
  }

  /// The balls that may be better for a part of ball a than a is, the likeliest first.
  [[nodiscard]] std::vector<std::uint32_t> neighbours(std::size_t a, std::size_t most) const {
    const LevelBall& ball = balls_[a];
    const double limit = 1.05 * std::max(cost_.scale, ball.fit.standOff());
    std::vector<std::pair<double, std::uint32_t>> near;
    std::vector<double> squared;
    squaredDistances(centers_, ball.fit.center.at, squared);
    for (std::uint32_t b = 0; b < squared.size(); ++b) {
      const double within = ball.fit.reach + depths_[b] + limit;
      if (within < 0 || squared[b] > within * within || b == a) continue;
      const DepthProbe& center = balls_[b].fit.center;
      double least = std::numeric_limits<double>::infinity();
      const std::size_t step = 1 + ball.pieces.size() / kLookedAt;
      for (std::size_t k = 0; k < ball.pieces.size(); k += step) {
        const std::uint32_t piece = ball.pieces[k];
        if (!mayHave(b, piece)) continue;
        least = std::min(least, (problem_.pieces[piece].points.front() - center.at).squaredNorm());
      }
      const double value = std::sqrt(least) - center.depth;
      if (value <= limit) near.emplace_back(value, b);
    }
    std::sort(near.begin(), near.end());
    if (near.size() > most) near.resize(most);
    std::vector<std::uint32_t> result;
    for (const auto& [value, b] : near) result.push_back(b);
    return result;
  }

  /// Finds what closest() will be asked for, on all threads.
  void findClosest(std::vector<std::uint32_t> balls) {
    // Each once: no two threads may look for the neighbours of the same ball.
    std::sort(balls.begin(), balls.end());
    balls.erase(std::unique(balls.begin(), balls.end()), balls.end());
    medial::parallelFor(balls.size(), request_.context,
                        [&](std::size_t i) { static_cast<void>(closest(balls[i])); });
  }

  /// As many as a batch may have.
  static std::vector<std::uint32_t> firstOf(const std::vector<std::uint32_t>& order) {
    return {order.begin(), order.begin() + static_cast<std::ptrdiff_t>(std::min(kBatch, order.size()))};
  }

  /// The few balls next to ball a, found once between two calls of gatherCenters().
  [[nodiscard]] const std::vector<std::uint32_t>& closest(std::size_t a) {
    if (nearOf_[a] != gathered_) {
      nearOf_[a] = gathered_;
      near_[a] = neighbours(a, kMostNeighbours);
    }
    return near_[a];
  }

  /// Centres, then pieces, over the whole level.
  void sweep(std::size_t most) {
    double before = energy();
    for (std::size_t i = 0; i < most; ++i) {
      const std::vector<LevelBall> old = balls_;
      medial::parallelFor(balls_.size(), request_.context, [&](std::size_t b) { fit(b); });
      std::vector<std::uint32_t> owner(problem_.pieces.size());
      gatherCenters();
      medial::parallelFor(balls_.size(), request_.context, [&](std::size_t a) {
        const std::vector<std::uint32_t> near = neighbours(a, balls_.size());
        for (const std::uint32_t piece : balls_[a].pieces) owner[piece] = bestFor(piece, a, near);
      });
      takeOver(owner);
      for (std::uint32_t& v : version_) v = ++clock_;
      const double now = energy();
      if (now > before) balls_ = old;
      if (!(now < before * (1 - kLastGain))) break;
      before = now;
    }
  }

  /// Refines around every ball, the costliest first, as far down as the effort goes.
  void polish() {
    const double floor = request_.objective == Objective::Worst ? request_.effort.polishFrom * worst() : 0;
    std::vector<bool> done(balls_.size(), false);
    for (;;) {
      gatherCenters();
      std::vector<Attempt> attempts;
      std::vector<bool> busy(balls_.size(), false);
      std::vector<std::uint32_t> order = byCost();
      std::erase_if(order, [&](std::uint32_t b) { return done[b] || balls_[b].fit.standOff() < floor; });
      findClosest(firstOf(order));
      for (const std::uint32_t b : order) {
        if (attempts.size() >= kBatch) break;
        if (busy[b]) continue;
        Attempt a;
        a.still = true;
        a.members = membersOf(b, b);
        if (std::any_of(a.members.begin(), a.members.end(), [&](std::uint32_t m) { return busy[m]; }))
          continue;
        for (const std::uint32_t m : a.members) busy[m] = true;
        done[b] = true;
        attempts.push_back(std::move(a));
      }
      if (attempts.empty()) return;
      static_cast<void>(attempt(attempts));
    }
  }

  [[nodiscard]] std::uint32_t bestFor(std::uint32_t piece, std::size_t owner,
                                      const std::vector<std::uint32_t>& near) const {
    double least = standOff(owner, piece);
    auto best = static_cast<std::uint32_t>(owner);
    const Vector3d& first = problem_.pieces[piece].points.front();
    for (const std::uint32_t b : near) {
      const DepthProbe& center = balls_[b].fit.center;
      const double limit = least + center.depth;
      if (limit < 0 || (first - center.at).squaredNorm() >= limit * limit) continue;
      if (!mayHave(b, piece)) continue;
      const double value = standOff(b, piece);
      if (value >= least) continue;
      least = value;
      best = b;
    }
    return best;
  }

  void fit(std::size_t b) {
    if (balls_[b].pieces.empty()) return;
    std::vector<std::uint32_t> places;
    for (const std::uint32_t piece : balls_[b].pieces) {
      const std::span<const std::uint32_t> more = corners_.of(piece);
      places.insert(places.end(), more.begin(), more.end());
    }
    std::sort(places.begin(), places.end());
    places.erase(std::unique(places.begin(), places.end()), places.end());
    PointBlock points;
    for (const std::uint32_t place : places) points.push(corners_.place(place));
    balls_[b].fit = fitBall(request_.surface, points, balls_[b].fit.center, request_.effort.fit);
  }

  [[nodiscard]] std::vector<std::uint32_t> childCounts() const {
    std::vector<std::uint32_t> count(problem_.parents, 0);
    for (const LevelBall& ball : balls_) ++count[ball.parent];
    return count;
  }

  /// The parents that may have the farthest pieces of a ball, those of the most pieces first.
  [[nodiscard]] std::vector<std::uint32_t> parentsOf(std::size_t b) const {
    std::vector<std::pair<int, std::uint32_t>> count;
    for (const std::uint32_t piece : balls_[b].pieces) {
      if (standOff(b, piece) < 0.8 * balls_[b].fit.standOff()) continue;
      for (const std::uint32_t parent : problem_.allowed[piece]) {
        const auto at =
            std::find_if(count.begin(), count.end(), [&](const auto& c) { return c.second == parent; });
        if (at == count.end()) {
          count.emplace_back(-1, parent);
        } else {
          --at->first;
        }
      }
    }
    std::sort(count.begin(), count.end());
    std::vector<std::uint32_t> parents;
    for (const auto& [n, parent] : count) parents.push_back(parent);
    return parents;
  }

  [[nodiscard]] std::vector<std::uint32_t> byCost() const {
    std::vector<std::pair<double, std::uint32_t>> order;
    for (std::uint32_t b = 0; b < balls_.size(); ++b) {
      if (!balls_[b].pieces.empty()) order.emplace_back(-cost_(balls_[b].fit, balls_[b].load), b);
    }
    std::sort(order.begin(), order.end());
    std::vector<std::uint32_t> result;
    for (const auto& [cost, b] : order) result.push_back(b);
    return result;
  }

  /// A ball that goes to another parent as it is, to make room.
  struct Step {
    std::uint32_t ball = 0;
    std::uint32_t parent = 0;
  };

  struct Attempt {
    std::uint32_t from = 0;
    std::uint32_t at = 0;
    std::uint32_t parent = 0;
    std::uint32_t variant = 0;
    std::vector<Step> path;
    std::vector<std::uint32_t> members;
    bool still = false;  // nothing is moved, only refined
    double gain = 0;
    std::vector<LevelBall> result;
  };

  /// Tries all, takes over those that gain, the best first, as long as they do not touch each other.
  std::size_t attempt(std::vector<Attempt>& attempts) {
    medial::parallelFor(attempts.size(), request_.context, [&](std::size_t i) {
      Attempt& a = attempts[i];
      Patch patch(request_, problem_, corners_, balls_, a.members, cost_);
      const double before = patch.energy();
      const auto number = [&](std::uint32_t b) {
        return static_cast<std::size_t>(std::find(a.members.begin(), a.members.end(), b) - a.members.begin());
      };
      for (const Step& step : a.path) {
        if (const std::size_t k = number(step.ball); k < a.members.size()) patch.adopt(k, step.parent);
      }
      // Balls that changed their parent since the price of this one was taken may not have its pieces now.
      if (!a.still && !patch.move(number(a.from), number(a.at), a.parent, a.variant, request_.effort.trial)) {
        return;
      }
      patch.relax(kRelaxSweeps, a.still ? request_.effort.fit : request_.effort.trial,
                  a.still ? std::numeric_limits<double>::infinity() : before);
      a.gain = before - patch.energy();
      if (!(a.gain > 1e-6 * before)) return;
      for (std::size_t k = 0; k < a.members.size(); ++k) a.result.push_back(patch.ball(k));
    });
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < attempts.size(); ++i) {
      if (!attempts[i].result.empty()) order.push_back(i);
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return attempts[a].gain > attempts[b].gain; });
    std::vector<bool> touched(balls_.size(), false);
    std::size_t taken = 0;
    for (const std::size_t i : order) {
      Attempt& a = attempts[i];
      if (std::any_of(a.members.begin(), a.members.end(), [&](std::uint32_t m) { return touched[m]; }) ||
          std::any_of(a.path.begin(), a.path.end(), [&](const Step& step) { return touched[step.ball]; })) {
        continue;
      }
      for (const Step& step : a.path) {
        touched[step.ball] = true;
        balls_[step.ball].parent = step.parent;
        version_[step.ball] = ++clock_;
      }
      for (std::size_t k = 0; k < a.members.size(); ++k) {
        touched[a.members[k]] = true;
        balls_[a.members[k]] = std::move(a.result[k]);
        version_[a.members[k]] = ++clock_;
      }
      ++taken;
    }
    return taken;
  }

  [[nodiscard]] std::vector<std::uint32_t> membersOf(std::uint32_t from, std::uint32_t at) {
    std::vector<std::uint32_t> members{from};
    if (at != from) members.push_back(at);
    for (const std::uint32_t centre : {at, from}) {
      for (const std::uint32_t n : closest(centre)) {
        if (std::find(members.begin(), members.end(), n) == members.end()) members.push_back(n);
      }
    }
    return members;
  }

  /// What it costs at most to do without ball v.
  [[nodiscard]] double removalCost(std::uint32_t v) {
    const std::vector<std::uint32_t>& near = closest(v);
    std::vector<LevelBall> grown(near.size());
    for (std::size_t k = 0; k < near.size(); ++k) {
      grown[k].fit = balls_[near[k]].fit;
      grown[k].load = balls_[near[k]].load;
    }
    for (const std::uint32_t piece : balls_[v].pieces) {
      double least = std::numeric_limits<double>::infinity();
      std::size_t best = near.size();
      for (std::size_t k = 0; k < near.size(); ++k) {
        if (!mayHave(near[k], piece)) continue;
        const double value = standOff(near[k], piece);
        if (value >= least) continue;
        least = value;
        best = k;
      }
      if (best == near.size()) return std::numeric_limits<double>::infinity();
      grown[best].fit.reach = std::max(grown[best].fit.reach, least + grown[best].fit.center.depth);
      if (!problem_.loads.empty()) grown[best].load += problem_.loads[piece];
    }
    double cost = -cost_(balls_[v].fit, balls_[v].load);
    for (std::size_t k = 0; k < near.size(); ++k) {
      cost += cost_(grown[k].fit, grown[k].load) - cost_(balls_[near[k]].fit, balls_[near[k]].load);
    }
    return cost;
  }

  /// Which parent can hand a ball to which other as it is: all pieces of the ball are allowed there.
  struct Handover {
    std::uint32_t to = 0;
    std::uint32_t ball = 0;
  };

  void findHandovers() {
    handovers_.resize(problem_.parents);
    for (std::vector<Handover>& list : handovers_) list.clear();
    if (problem_.parents == 1) return;
    commonOf_.resize(balls_.size());
    common_.resize(balls_.size());
    medial::parallelFor(balls_.size(), request_.context, [&](std::size_t b) {
      if (commonOf_[b] == version_[b]) return;
      commonOf_[b] = version_[b];
      common_[b].clear();
      for (const std::uint32_t piece : balls_[b].pieces) {
        const std::vector<std::uint32_t>& allowed = problem_.allowed[piece];
        if (piece == balls_[b].pieces.front()) {
          common_[b] = allowed;
          continue;
        }
        std::erase_if(common_[b], [&](std::uint32_t parent) {
          return !std::binary_search(allowed.begin(), allowed.end(), parent);
        });
        if (common_[b].size() <= 1) break;
      }
    });
    for (std::uint32_t b = 0; b < balls_.size(); ++b) {
      for (const std::uint32_t to : common_[b]) {
        if (to != balls_[b].parent) handovers_[balls_[b].parent].push_back({to, b});
      }
    }
  }

  /// The shortest ways to make room below `from`, by handing balls on from parent to parent.
  struct Routes {
    std::vector<std::uint32_t> distance;  // kNone: cannot be reached
    std::vector<Step> last;               // the ball handed to this parent, and by whom
  };

  [[nodiscard]] Routes routesFrom(std::uint32_t from, std::uint32_t except) const {
    Routes routes{std::vector<std::uint32_t>(problem_.parents, kNone), std::vector<Step>(problem_.parents)};
    routes.distance[from] = 0;
    std::vector<std::uint32_t> queue{from};
    for (std::size_t i = 0; i < queue.size(); ++i) {
      const std::uint32_t parent = queue[i];
      if (routes.distance[parent] >= kMostHandovers) break;
      for (const Handover& handover : handovers_[parent]) {
        if (handover.ball == except || routes.distance[handover.to] != kNone) continue;
        routes.distance[handover.to] = routes.distance[parent] + 1;
        routes.last[handover.to] = {handover.ball, parent};
        queue.push_back(handover.to);
      }
    }
    return routes;
  }

  /// Moves balls from where they are little needed, or not yet used, to where much sticks out.
  void exchange(std::size_t budget) {
    tries_.clear();
    triesOf_.clear();
    removal_.clear();
    removalOf_.clear();
    for (std::size_t used = 0; used < budget;) {
      request_.context.checkCancelled();
      rescale();
      gatherCenters();
      tries_.resize(balls_.size(), 0);
      triesOf_.resize(balls_.size(), kNone);
      findHandovers();
      const std::vector<Victim> victims = findVictims();
      std::vector<Attempt> attempts;
      std::vector<bool> busy(balls_.size(), false);
      std::vector<std::uint32_t> room = childCounts();
      const std::vector<std::uint32_t> order = byCost();
      std::vector<std::uint32_t> likely = firstOf(order);
      for (std::size_t v = 0; v < std::min(kBatch, victims.size()); ++v) {
        if (victims[v].ball != kNone) likely.push_back(victims[v].ball);
      }
      findClosest(likely);
      const std::size_t old = balls_.size();
      for (const bool apart : {true, false}) {
        std::size_t looked = 0;
        for (const std::uint32_t at : order) {
          if (attempts.size() >= kBatch || (apart && looked >= kMostLooked)) break;
          if (apart && busy[at]) continue;
          propose(at, apart, victims, room, busy, attempts);
          ++looked;
        }
      }
      if (attempts.empty()) break;
      used += attempts.size();
      static_cast<void>(attempt(attempts));
      // New balls that found nothing to do leave again.
      fresh_ = 0;
      for (std::size_t b = balls_.size(); b-- > old;) {
        if (balls_[b].pieces.empty()) balls_.erase(balls_.begin() + static_cast<std::ptrdiff_t>(b));
      }
      version_.resize(old);
      while (version_.size() < balls_.size()) version_.push_back(++clock_);
    }
  }

  /// A ball that may be taken away, or room for one more.
  struct Victim {
    double price = 0;
    std::uint32_t ball = 0;  // kNone: room
    std::uint32_t parent = 0;
  };

  [[nodiscard]] std::vector<Victim> findVictims() {
    removal_.resize(balls_.size());
    removalOf_.resize(balls_.size(), kNone);
    medial::parallelFor(balls_.size(), request_.context, [&](std::size_t b) {
      if (removalOf_[b] == version_[b]) return;
      removalOf_[b] = version_[b];
      removal_[b] = balls_[b].pieces.empty() ? 0 : removalCost(static_cast<std::uint32_t>(b));
    });
    std::vector<Victim> victims;
    const std::vector<std::uint32_t> count = childCounts();
    for (std::uint32_t parent = 0; parent < problem_.parents; ++parent) {
      if (count[parent] < problem_.branch) victims.push_back({0, kNone, parent});
    }
    for (std::uint32_t b = 0; b < balls_.size(); ++b) {
      if (std::isfinite(removal_[b])) victims.push_back({removal_[b], b, balls_[b].parent});
    }
    std::stable_sort(victims.begin(), victims.end(),
                     [](const Victim& a, const Victim& b) { return a.price < b.price; });
    return victims;
  }

  void propose(std::uint32_t at, bool apart, const std::vector<Victim>& victims,
               std::vector<std::uint32_t>& room, std::vector<bool>& busy, std::vector<Attempt>& attempts) {
    const double cost = cost_(balls_[at].fit, balls_[at].load);
    if (balls_[at].fit.standOff() <= request_.goodEnough) return;
    if (triesOf_[at] != version_[at]) {
      triesOf_[at] = version_[at];
      tries_[at] = 0;
    }
    if (tries_[at] >= request_.effort.tries) return;
    const std::vector<std::uint32_t> parents = parentsOf(at);
    if (parents.empty()) return;
    const std::uint32_t parent = parents[tries_[at] % std::min<std::size_t>(parents.size(), 2)];
    const Routes routes = routesFrom(parent, at);
    std::uint32_t skip = tries_[at] / 2;
    // Room costs nothing; a ball is taken from elsewhere only for those near the worst.
    const double most = balls_[at].fit.standOff() < kWorthwhile * cost_.scale ? 0 : kMostPrice * cost;
    for (const Victim& victim : victims) {
      if (victim.ball != kNone && victim.price >= most) break;
      if (routes.distance[victim.parent] == kNone || victim.ball == at) continue;
      if (victim.ball == kNone && room[victim.parent] >= problem_.branch) continue;
      if (victim.ball != kNone && skip > 0) {
        --skip;
        continue;
      }
      if (apart && victim.ball != kNone && busy[victim.ball]) continue;
      Attempt a;
      a.at = at;
      a.parent = parent;
      a.variant = tries_[at] % kVariants;
      bool usable = true;
      for (std::uint32_t to = victim.parent; to != parent; to = routes.last[to].parent) {
        const std::uint32_t ball = routes.last[to].ball;
        usable = usable && ball != victim.ball && !(apart && busy[ball]);
        a.path.push_back({ball, to});
      }
      if (!usable) continue;
      a.members = membersOf(victim.ball == kNone ? at : victim.ball, at);
      if (apart &&
          std::any_of(a.members.begin(), a.members.end(), [&](std::uint32_t m) { return busy[m]; })) {
        continue;
      }
      for (const std::uint32_t m : a.members) busy[m] = true;
      for (const Step& step : a.path) busy[step.ball] = true;
      if (victim.ball == kNone) {
        ++room[victim.parent];
        a.from = static_cast<std::uint32_t>(balls_.size());
        LevelBall fresh;
        fresh.fit = balls_[at].fit;
        fresh.parent = parent;
        balls_.push_back(std::move(fresh));
        version_.push_back(++clock_);
        ++fresh_;
        busy.push_back(true);
        a.members.push_back(a.from);
      } else {
        a.from = victim.ball;
      }
      ++tries_[at];
      attempts.push_back(std::move(a));
      return;
    }
    if (!apart) tries_[at] = request_.effort.tries;
  }

  /// A piece that is replaced by two.
  struct Cut {
    std::uint32_t piece = 0;
    std::pair<Piece, Piece> parts;
    std::pair<std::vector<std::uint32_t>, std::vector<std::uint32_t>> allowed;
  };

  /// The pieces of a ball that decide how far it sticks out, cut.
  [[nodiscard]] std::vector<Cut> cutsOf(std::size_t b) const {
    const LevelBall& ball = balls_[b];
    const double limit = kCriticalPiece * ball.fit.standOff();
    std::vector<Cut> cuts;
    for (const std::uint32_t number : ball.pieces) {
      const Piece& piece = problem_.pieces[number];
      if (piece.triangles.empty() || standOff(b, number) < limit) continue;
      if (piece.size() < kShortest * ball.fit.reach) continue;
      Cut done{number, cut(piece), {problem_.allowed[number], problem_.allowed[number]}};
      if (problem_.allowedPart) {
        done.allowed = {problem_.allowedPart(done.parts.first, problem_.allowed[number]),
                        problem_.allowedPart(done.parts.second, problem_.allowed[number])};
      }
      cuts.push_back(std::move(done));
    }
    return cuts;
  }

  /// Cuts the pieces that decide how far their ball sticks out; false when there were none.
  bool cutSeams() {
    const double top = worst();
    std::vector<std::vector<Cut>> cuts(balls_.size());
    medial::parallelFor(balls_.size(), request_.context, [&](std::size_t b) {
      if (balls_[b].fit.standOff() >= kCriticalBall * top) cuts[b] = cutsOf(b);
    });
    const std::size_t old = problem_.pieces.size();
    for (std::size_t b = 0; b < balls_.size(); ++b) {
      for (Cut& done : cuts[b]) {
        if (!problem_.loads.empty()) {
          const double share =
              areaOf(done.parts.first) / (areaOf(done.parts.first) + areaOf(done.parts.second));
          problem_.loads.push_back((1 - share) * problem_.loads[done.piece]);
          problem_.loads[done.piece] *= share;
        }
        balls_[b].pieces.push_back(static_cast<std::uint32_t>(problem_.pieces.size()));
        problem_.pieces[done.piece] = std::move(done.parts.first);
        problem_.allowed[done.piece] = std::move(done.allowed.first);
        problem_.pieces.push_back(std::move(done.parts.second));
        problem_.allowed.push_back(std::move(done.allowed.second));
      }
    }
    if (problem_.pieces.size() == old) return false;
    corners_ = CornerIndex(problem_.pieces);
    return true;
  }

  /// Takes balls away as long as the rest stays good enough.
  void dropUnneeded() {
    for (bool dropped = true; dropped;) {
      dropped = false;
      std::vector<std::pair<double, std::uint32_t>> order;
      for (std::uint32_t b = 0; b < balls_.size(); ++b) {
        if (!balls_[b].pieces.empty()) order.emplace_back(balls_[b].fit.reach, b);
      }
      std::sort(order.begin(), order.end());
      for (const auto& [price, v] : order) {
        if (balls_[v].pieces.empty()) continue;
        request_.context.checkCancelled();
        gatherCenters();
        std::vector<std::uint32_t> members{v};
        for (const std::uint32_t n : closest(v)) {
          if (!balls_[n].pieces.empty()) members.push_back(n);  // what is out of use stays so
        }
        Patch patch(request_, problem_, corners_, balls_, members, cost_);
        const double allowed = std::max(request_.goodEnough, patch.worst());
        if (!patch.remove(0)) continue;
        patch.relax(2 * kRelaxSweeps, request_.effort.fit, std::numeric_limits<double>::infinity());
        if (patch.worst() > allowed) continue;
        for (std::size_t k = 0; k < members.size(); ++k) balls_[members[k]] = patch.ball(k);
        dropped = true;
      }
    }
  }

  LevelProblem& problem_;
  CornerIndex corners_;  // of its pieces
  const RefineRequest& request_;
  std::vector<LevelBall> balls_;
  PointBlock centers_;                              // of balls_, without those that stand for room
  std::vector<double> depths_;                      // of the centres
  std::uint32_t gathered_ = 0;                      // calls of gatherCenters()
  std::vector<std::vector<std::uint32_t>> near_;    // of each ball, those next to it
  std::vector<std::uint32_t> nearOf_;               // the call that near_ belongs to
  std::vector<std::uint32_t> version_;              // of each ball, a new one with every change
  std::vector<std::vector<Handover>> handovers_;    // by the parent that hands over
  std::vector<std::vector<std::uint32_t>> common_;  // of each ball, the parents allowed for all its pieces
  std::vector<std::uint32_t> commonOf_;             // the version that common_ belongs to
  std::vector<double> removal_;                     // of each ball, what it costs to do without it
  std::vector<std::uint32_t> removalOf_;            // the version that removal_ belongs to
  std::vector<std::uint32_t> tries_;    // of each ball, attempts to relieve it since it changed last
  std::vector<std::uint32_t> triesOf_;  // the version that tries_ belongs to
  std::uint32_t clock_ = 0;
  std::size_t fresh_ = 0;  // how many of the last balls stand for room that an attempt may use
  BallCost cost_;
};

}  // namespace

RefineEffort refineEffort(Quality quality) {
  switch (quality) {
    case Quality::Fast:
      return {1, 3, 2, 30, 2, {4, 1e-2}, {4, 2e-2}, 0.8};
    case Quality::Best:
      return {4, 12, 10, 300, 16, {12, 3e-4}, {6, 5e-3}, 0};
    case Quality::Normal:
      break;
  }
  return {2, 6, 2, 80, 6, {8, 1e-3}, {5, 1e-2}, 0};
}

BuildEffort buildEffort(Quality quality) {
  switch (quality) {
    case Quality::Fast:
      return {false, 0, 1, 1, 2, kNever, 2};
    case Quality::Best:
      return {true, 4, 2, 10, SettingLimits::kMostLevels, 0, 1, 30000, 3, 3};
    case Quality::Normal:
      break;
  }
  return {true, 2, 1, 3, 2, 0.4, 1, 12000, 1, 0};
}

RefineEffort sketchEffort() {
  return {0, 3, 1, 30, 1, {4, 1e-2}, {4, 2e-2}, 0};
}

RefineEffort spreadEffort(Quality quality) {
  if (quality == Quality::Best) return refineEffort(Quality::Normal);
  return {0, 3, 1, 30, 2, {4, 1e-2}, {4, 2e-2}, 0};
}

std::vector<LevelBall> refineLevel(LevelProblem& problem, std::vector<LevelBall> balls,
                                   const RefineRequest& request) {
  return LevelRefiner(problem, std::move(balls), request).run();
}

}  // namespace spheretree::builders
