// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "builders/corner_index.hpp"
#include "builders/fit_ball.hpp"
#include "builders/refine.hpp"

namespace spheretree::builders {

/// What one ball of a level costs; the balls of a level are to have the least sum.
///
/// A high power makes the sum follow its largest term and still tell two levels with the same worst ball
/// apart.
struct BallCost {
  Objective objective = Objective::Worst;
  double power = 8;
  double scale = 1;       ///< stand-off that costs one
  double goodEnough = 0;  ///< stand-offs up to this cost next to nothing
  double fairLoad = 1;    ///< load that costs one; LevelProblem::loads

  [[nodiscard]] double operator()(const Fit& fit, double load) const;

  /// Makes the given load cost `weight`, unless loads like this are fair anyway.
  void weighLoad(double load, double weight);
};

/// Some balls of a level with all their pieces, cut out to be worked on: everything else stands still. Holds
/// the reach of every ball to every piece, so sharing out costs no distance.
class Patch {
 public:
  /// Takes a copy of what it needs from the level. `corners` are those of the problem's pieces.
  Patch(const RefineRequest& request, const LevelProblem& problem, const CornerIndex& corners,
        const std::vector<LevelBall>& level, std::span<const std::uint32_t> members, const BallCost& cost);

  [[nodiscard]] double energy() const;
  [[nodiscard]] const std::vector<std::uint32_t>& members() const noexcept { return members_; }
  [[nodiscard]] double worst() const;

  /// Puts a ball below another parent, which must be allowed for all its pieces.
  void adopt(std::size_t member, std::uint32_t parent) { balls_[member].parent = parent; }

  /// Takes ball `from` (a number within the patch) away and puts it below `parent` where ball `at` reaches
  /// farthest, both to be fitted; `variant` chooses among ways to divide. False when a piece of `from` has
  /// nobody else: the patch is of no use then.
  [[nodiscard]] bool move(std::size_t from, std::size_t at, std::uint32_t parent, std::uint32_t variant,
                          const FitEffort& effort);

  /// Takes a ball away; its pieces go to the others. False when a piece has nobody else.
  [[nodiscard]] bool remove(std::size_t ball);

  /// Alternating refinement: centres, then pieces, until nothing is gained, or until an energy below `target`
  /// is out of sight.
  void relax(std::size_t sweeps, const FitEffort& effort, double target);

  /// The balls as they are now, with their pieces by their numbers in the problem. A ball without pieces is
  /// not in use.
  [[nodiscard]] LevelBall ball(std::size_t member) const;

 private:
  struct Member {
    Fit fit;
    double load = 0;
    std::uint32_t parent = 0;
    enum class State : std::uint8_t { Gone, Idle, Used } state = State::Used;  // idle: without pieces
    bool dirty = true;  // its pieces changed since it was fitted
  };

  void numberCorners(const CornerIndex& corners);
  void gather(std::size_t member);
  void measure(std::size_t member);
  void fit(std::size_t member, const FitEffort& effort);
  void fitDirty(const FitEffort& effort);
  void shareOut();
  void peel(std::size_t member);
  bool placeOrphans();
  [[nodiscard]] DepthProbe startFor(const Eigen::Vector3d& seed, const Eigen::Vector3d& old) const;
  [[nodiscard]] double loadOf(std::size_t piece) const {
    return problem_.loads.empty() ? 0 : problem_.loads[pieces_[piece]];
  }
  [[nodiscard]] double costOf(const Member& ball) const { return cost_(ball.fit, ball.load); }
  [[nodiscard]] bool mayHave(std::size_t member, std::size_t piece) const;
  [[nodiscard]] double reach(std::size_t member, std::size_t piece) const {
    return reach_[member * pieces_.size() + piece];
  }

  const RefineRequest& request_;
  const LevelProblem& problem_;
  BallCost cost_;
  std::vector<std::uint32_t> members_;
  std::vector<Member> balls_;
  std::vector<std::uint32_t> pieces_;  // numbers in the problem
  PointBlock points_;                  // of all pieces, each place once
  std::vector<std::uint32_t> corner_;  // of each piece, numbers in points_
  std::vector<std::uint32_t> start_;   // of each piece in corner_
  std::vector<std::uint32_t> owner_;
  std::vector<double> reach_;
  std::vector<double> squared_;  // scratch
  // Scratch.
  PointBlock own_;                     // the points of one ball
  std::vector<std::uint32_t> marked_;  // of each point, the call of gather() that took it last
  std::uint32_t mark_ = 0;
  std::vector<std::pair<double, std::uint32_t>> far_;
  std::vector<std::pair<double, std::uint32_t>> order_;
  std::vector<Member> grown_;
  std::vector<std::uint32_t> taker_;
  std::vector<double> needed_;
};

}  // namespace spheretree::builders
