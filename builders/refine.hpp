// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "builders/fit_ball.hpp"
#include "builders/pieces.hpp"
#include "builders/settings.hpp"
#include "medial/ball.hpp"
#include "medial/context.hpp"
#include "medial/surface.hpp"

namespace spheretree::builders {

/// A level to be covered: pieces, and the balls of the level above that may answer for each of them.
struct LevelProblem {
  std::vector<Piece> pieces;
  std::vector<std::vector<std::uint32_t>>
      allowed;  ///< per piece the parents that hold it, ascending, not empty
  /// Per piece, how many balls of the next level it will need, a fraction; empty when that does not count.
  std::vector<double> loads;
  double fairLoad = 1;    ///< loads of a ball up to this are what the next level expects
  double loadWeight = 1;  ///< what the largest load costs, where the largest stand-off costs one
  std::size_t parents = 1;
  std::uint32_t branch = 8;  ///< most balls below one parent
  /// The parents that hold a part of a piece which was allowed the given ones, at least those; null: the
  /// same.
  std::function<std::vector<std::uint32_t>(const Piece&, const std::vector<std::uint32_t>&)> allowedPart;
};

/// A ball of the level and the pieces that it answers for.
struct LevelBall {
  Fit fit;
  std::uint32_t parent = 0;
  std::vector<std::uint32_t> pieces;  ///< ascending
  double load = 0;                    ///< sum over the pieces
};

/// How much work goes into a level; each is a number of steps, so time never decides.
struct RefineEffort {
  std::size_t rounds = 3;         ///< rounds of cutting pieces at the seams
  std::size_t sweeps = 6;         ///< most sweeps of the alternating refinement per round
  std::size_t trialsPerBall = 8;  ///< attempts to move a ball from where it is not needed to where it is
  std::size_t leastTrials = 100;
  std::uint32_t tries = 8;  ///< attempts to relieve one ball before it is left as it is
  FitEffort fit;            ///< of balls that stay where they are
  FitEffort trial;          ///< while it is open whether a move will do
  double polishFrom = 0;    ///< share of the worst stand-off from which on balls are refined one by one
};

/// What a quality means here.
[[nodiscard]] RefineEffort refineEffort(Quality quality);

/// How often a linked tree is built as a whole.
struct BuildEffort {
  bool sketch =
      true;  ///< coarse levels first, and leaves spread without parents: show where balls are needed
  std::size_t starts = 0;         ///< further sets that the first level is refined from
  std::size_t pressures = 1;      ///< how many weights of loads each of them is refined with
  std::size_t lookedAhead = 1;    ///< first levels below which the second one is tried
  std::size_t carefulLevels = 1;  ///< below so many, sets are rough: one reducer, a coarse axis and pieces
  double roughPolishFrom = 0;     ///< RefineEffort::polishFrom of rough levels
  std::size_t roughTrialsPerBall = 1;  ///< RefineEffort::trialsPerBall of rough levels
  std::size_t fairSteps = 0;           ///< of the annealing of first levels with even loads
  std::size_t fairStarts = 0;          ///< sets that each of them is started from
  std::size_t lessons = 0;  ///< how often the second level is mended for what the third one has shown
};

[[nodiscard]] BuildEffort buildEffort(Quality quality);

/// Just enough to see where balls will be needed.
[[nodiscard]] RefineEffort sketchEffort();

/// For leaves that need no parents yet.
[[nodiscard]] RefineEffort spreadEffort(Quality quality);

struct RefineRequest {
  const medial::Surface& surface;
  Objective objective = Objective::Worst;
  double goodEnough = 0;  ///< overhang, mesh units; below it fewer balls are better than tighter ones
  RefineEffort effort;
  std::uint64_t seed = 1;
  const medial::Context& context;
};

/// Covers the pieces of `problem` tighter, starting from `balls` (centres and parents; the pieces are shared
/// out anew). Never more than `branch` balls below a parent; every piece ends in one ball of an allowed
/// parent. Cuts pieces, so `problem` changes with the result. Same result for any number of threads.
[[nodiscard]] std::vector<LevelBall> refineLevel(LevelProblem& problem, std::vector<LevelBall> balls,
                                                 const RefineRequest& request);

}  // namespace spheretree::builders
