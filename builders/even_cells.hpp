// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "medial/cell_set.hpp"

namespace spheretree::builders {

/// About `count` cells, at least one, ascending: one per equal share of the area along the order of the
/// cells. Stands in for all of them where a rough idea is enough.
[[nodiscard]] std::vector<std::uint32_t> evenCells(const medial::CellSet& cells, std::size_t count);

}  // namespace spheretree::builders
