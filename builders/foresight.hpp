// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "builders/ancestry.hpp"
#include "builders/fit_ball.hpp"
#include "builders/refine.hpp"
#include "builders/settings.hpp"
#include "medial/context.hpp"
#include "medial/surface.hpp"

namespace spheretree::builders {

/// Where balls will be needed on the levels to come: as many as the last level may have, spread over the
/// surface as if they needed no parents (docs/builders/refine.md).
class Foresight {
 public:
  /// Foresees nothing until the leaves are spread. All arguments must outlive it.
  Foresight(const medial::Surface& surface, const BuildSettings& settings, const medial::Context& context)
      : surface_(surface), settings_(settings), context_(context) {}

  /// Spreads the leaves over these pieces, which hold the whole surface.
  void spread(std::vector<Piece> pieces, RefineRequest request);

  /// Tells a problem whose balls will be on level `depth` how many children each piece will need: as many as
  /// leaves were spread there, in the proportion of the levels' sizes. `pressure` is how much that counts.
  void weigh(LevelProblem& problem, std::size_t depth, double pressure) const;

  /// How loads are foreseen from now on: more where the level below has turned out to stick out more than its
  /// median. `levels` from the root down; the last is that level.
  void learn(std::span<const std::vector<LevelNode>> levels);

  /// The centres of the leaves; empty until they are spread.
  [[nodiscard]] std::vector<DepthProbe> places() const;

  /// What balls on level `depth` will lead to: the sum over it and the levels below of the logarithm of the
  /// worst stand-off.
  [[nodiscard]] double prospect(std::span<const LevelBall> balls, std::size_t depth) const;

  /// The same of balls whose worst stand-off and largest load are known.
  [[nodiscard]] double prospect(double standOff, double load, std::size_t depth) const;

  /// Up to `count` first levels that share the leaves out evenly, without their pieces: one grown from the
  /// centres of the given balls, the others from centres far from each other.
  [[nodiscard]] std::vector<std::vector<LevelBall>> evenSets(std::span<const LevelBall> given,
                                                             std::size_t count) const;

 private:
  [[nodiscard]] std::vector<LevelBall> farApartBalls(const LevelProblem& problem) const;
  [[nodiscard]] std::vector<std::uint32_t> nearestLeaves(const std::vector<Piece>& pieces) const;

  const medial::Surface& surface_;
  const BuildSettings& settings_;
  const medial::Context& context_;
  std::vector<Fit> leaves_;
  std::vector<PointBlock> points_;  // of each leaf, what it holds
  std::vector<double> lessons_;     // of each leaf, how many times its share it needs; empty: once
};

}  // namespace spheretree::builders
