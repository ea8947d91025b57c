// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "medial/ball.hpp"
#include "medial/cell_set.hpp"
#include "medial/context.hpp"
#include "medial/medial_axis.hpp"
#include "medial/surface.hpp"
#include "medial/surface_samples.hpp"

namespace spheretree::medial {

/// When the axis of a region is fine enough.
struct AxisGoal {
  double overhang = 0;           ///< mesh units: no ball of the region sticks out more (radius - depth)
  std::uint32_t leastBalls = 0;  ///< of the region; no more than three times as many come back, or 600
};

/// A tetrahedron of sites whose circumcentre is a ball of the axis: what regions below start from.
struct AxisTetrahedron {
  std::array<std::uint32_t, 4> sites{};  ///< indices into RegionAxis::sites, ascending
  MedialBall ball;
  ClosestPoint nearest;  ///< of the surface to the ball's centre
};

/// The medial axis near a region and the surface points it was made from, for the regions below.
struct RegionAxis {
  std::vector<SurfaceSample> sites;
  std::vector<AxisTetrahedron> tetrahedra;  ///< in the order of their sites
  /// First balls around circumcentres, radius: distance to the nearest sites; neighbours: their tetrahedra,
  /// or those of balls that were left out for them, share a facet. Then balls that touch the surface where
  /// the others do not reach, radius: depth; neighbours: the nearest centres.
  MedialAxis axis;
};

/// The axis everywhere, from about `samples` surface points: what refineAxis() starts from.
[[nodiscard]] RegionAxis coarseAxis(const Surface& surface, std::uint32_t samples, const Context& context);

/// The axis of the region made of `cells`, refined locally from the parent's (Bradshaw, O'Sullivan 2004,
/// section 4). The cost is that of the region, whatever the size of the model. Deterministic; any number of
/// threads may refine different regions of one parent at once.
///
/// A ball belongs to the region when it holds a corner of a cell after growing from its depth by
/// goal.overhang, or by the radius of the largest cell if that is more: no other ball can be useful there at
/// such a stand-off. Of balls that differ by less than a twentieth of the goal, one is kept.
///
/// Every cell lies in some ball that grew from its depth by three tenths of goal.overhang or, if that is
/// more, by about the radius of the largest cell. So there are candidates wherever there is surface.
///
/// The overhang is missed when it takes more than 500 + 2 goal.leastBalls insertions, the number of balls
/// when the region has fewer cells than that or its balls are all alike.
[[nodiscard]] RegionAxis refineAxis(const Surface& surface, const RegionAxis& parent, const CellSet& cells,
                                    const AxisGoal& goal, const Context& context);

}  // namespace spheretree::medial
