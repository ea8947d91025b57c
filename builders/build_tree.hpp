// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <spheretree/result.hpp>

#include "builders/report.hpp"
#include "builders/settings.hpp"
#include "medial/context.hpp"
#include "medial/medial_axis.hpp"
#include "medial/surface.hpp"

namespace spheretree::builders {

/// Builds a sphere tree around the surface, proves its cover on the floats it returns and measures every
/// level. Never returns an uncertified tree: a failed proof is an Internal error.
///
/// Fewer levels than asked for come back when every ball already meets settings.maxError, or when the builder
/// finds no children that stick out less than their parents (one ball fits a ball best). A single ball of
/// which that is true is repeated on the levels below, so that each level is a cover by itself.
///
/// Errors: InvalidArgument (settings out of range, unknown builder), UnsuitableMesh (too large for single
/// precision, or too far from the origin for its size), Cancelled.
Result<BuildResult> buildTree(const medial::Surface& surface, const BuildSettings& settings,
                              const medial::Context& context);

/// The refined medial axis (docs/medial-axis.md) that builders choose the children of the root from, in the
/// surface's own coordinates: for looking at. Errors: as buildTree.
Result<medial::MedialAxis> rootMedialAxis(const medial::Surface& surface, const BuildSettings& settings,
                                          const medial::Context& context);

}  // namespace spheretree::builders
