// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "medial/medial_axis.hpp"

namespace spheretree::io {

/// A medial axis as a PLY point cloud (text): a vertex with `x y z radius depth` for every ball, an edge for
/// every two neighbours. Numbers are the shortest that read back as the same double.
[[nodiscard]] std::string formatMedialAxis(const medial::MedialAxis& axis);

}  // namespace spheretree::io
