// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "medial/ball.hpp"
#include "medial/context.hpp"
#include "medial/surface.hpp"

namespace spheretree::medial {

/// A ball of the approximate medial axis.
struct MedialBall {
  Ball ball;  ///< centre: a Voronoi vertex inside the solid; radius: distance to its nearest samples
  double depth =
      0;  ///< exact distance of the centre to the surface, positive; at most ball.radius + rounding
};

/// An approximation of the interior medial axis by the Voronoi vertices of surface samples.
struct MedialAxis {
  std::vector<MedialBall> balls;
  /// Pairs (a < b) of balls whose Delaunay tetrahedra share a facet, ascending.
  std::vector<std::array<std::uint32_t, 2>> neighbours;
};

struct MedialAxisSettings {
  std::uint32_t samples = 2000;  ///< about how many surface points; mesh vertices first, then by area
};

/// The static medial axis (Hubbard 1996, section 4): Delaunay tetrahedra of surface samples, the
/// circumcentres inside the solid, depth from the exact closest point. Works in a normalised copy; slivers
/// whose circumcentre contradicts the surface distance are dropped, and a sample without any ball (the solid
/// is thinner than the samples are dense) gets the largest ball that touches the surface there.
/// Deterministic.
[[nodiscard]] MedialAxis staticMedialAxis(const Surface& surface, const MedialAxisSettings& settings,
                                          const Context& context);

}  // namespace spheretree::medial
