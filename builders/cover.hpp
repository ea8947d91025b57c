// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <spheretree/sphere_tree.hpp>

#include "builders/overhang.hpp"
#include "medial/ball.hpp"
#include "medial/context.hpp"
#include "medial/surface.hpp"

namespace spheretree::builders {

/// What a proof looked at.
struct ProofEffort {
  std::uint64_t cells = 0;    ///< pieces examined
  std::uint32_t deepest = 0;  ///< most subdivisions of one piece
};

/// How much of the surface lies outside the union of some balls.
struct SurfaceCover {
  bool certified = false;  ///< true: proved that nothing lies outside; the bounds are then all 0
  Bounds uncovered;        ///< fraction of the surface area outside, bracketed
  Bounds distance;         ///< largest distance of such a point to the union, mesh units, bracketed
  ProofEffort effort;
};

/// Proves cover of the whole mesh by subdivision (docs/error-metrics.md), or measures what is missing.
/// Without balls the distance is infinite.
[[nodiscard]] SurfaceCover measureSurfaceCover(const medial::Surface& surface,
                                               std::span<const medial::Ball> balls,
                                               const medial::Context& context);

/// Whether every point of the surface lies in a chain of balls from the root to the last level, each a child
/// of the one before. That is what makes a top-down search safe: a pruned pair cannot hide a contact. A node
/// without children stands for itself on the levels below it.
struct ChainProof {
  bool certified = false;
  std::uint32_t failedTriangle = 0;  ///< a triangle with a point that no chain holds, when not certified
  std::uint32_t failedLevel = 0;
  ProofEffort effort;
};

[[nodiscard]] ChainProof proveSurfaceChains(const medial::Surface& surface, const SphereTree& tree,
                                            const medial::Context& context);

}  // namespace spheretree::builders
