// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include <spheretree/sphere_tree.hpp>

#include "builders/cover.hpp"
#include "medial/ball.hpp"
#include "medial/context.hpp"
#include "medial/surface.hpp"

namespace spheretree::builders {

/// How much of the solid lies outside the union of some balls.
struct SolidCover {
  bool certified = false;  ///< true: proved that nothing lies outside
  Bounds uncovered;        ///< fraction of the solid's volume outside, bracketed
  ProofEffort effort;
};

/// Proves solid cover by octree cells, or brackets what is missing. Stops refining when the bracket is
/// narrower than `wantedGap` (fraction of the volume) and nothing is left to hope for, or after a fixed
/// number of cells. Balls that meet in a point without overlapping can use up that number although they
/// cover.
[[nodiscard]] SolidCover measureSolidCover(const medial::Surface& surface,
                                           std::span<const medial::Ball> balls, double wantedGap,
                                           const medial::Context& context);

/// As proveSurfaceChains, for every point of the solid. failedTriangle is meaningless.
[[nodiscard]] ChainProof proveSolidChains(const medial::Surface& surface, const SphereTree& tree,
                                          const medial::Context& context);

}  // namespace spheretree::builders
