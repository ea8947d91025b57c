// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "builders/cover.hpp"
#include "builders/overhang.hpp"
#include "builders/solid_cover.hpp"
#include "medial/ball.hpp"
#include "medial/context.hpp"
#include "medial/surface.hpp"

namespace spheretree::builders {

/// The error of one level, measured from its balls alone: it does not matter who made them. Lengths in mesh
/// units; divide by Surface::diagonal() for the relative figures.
struct LevelMetrics {
  std::size_t spheres = 0;
  Bounds overhangWorst;              ///< gap at most 1 % of the value or 1e-5 of the diagonal
  double overhangMean = 0;           ///< mean of the balls' own upper bounds
  std::uint32_t worstBall = 0;       ///< index of the ball that reaches overhangWorst.upper
  std::vector<double> ballOverhang;  ///< upper bound per ball
  SurfaceCover surface;
  SolidCover solid;
  double volume = 0;       ///< of the union of the balls
  double volumeRatio = 0;  ///< volume / volume of the solid
};

/// How closely the figure of a level is wanted, beyond what every ball is known to.
struct Sharpness {
  double relativeGap = 1e-4;     ///< of the worst ball's bracket
  std::uint32_t mostBalls = 16;  ///< looked at again, one after the other: whichever may be the worst
};

/// How far each ball sticks out, and the farthest of them.
struct LevelOverhang {
  std::vector<Bounds> balls;    ///< gap at most 1 % of the value or 1e-5 of the diagonal
  Bounds worst;                 ///< closer than that as a rule: Sharpness
  std::uint32_t worstBall = 0;  ///< index of the ball that reaches worst.upper
};

[[nodiscard]] LevelOverhang levelOverhang(const medial::Surface& surface, std::span<const medial::Ball> balls,
                                          const medial::Context& context, const Sharpness& sharpness = {});

/// Everything in docs/error-metrics.md for one set of balls.
[[nodiscard]] LevelMetrics measureLevel(const medial::Surface& surface, std::span<const medial::Ball> balls,
                                        const medial::Context& context);

/// The balls of one level of a tree, in double.
[[nodiscard]] std::vector<medial::Ball> ballsOf(std::span<const Node> nodes);

}  // namespace spheretree::builders
