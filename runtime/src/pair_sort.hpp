// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include <spheretree/broad_phase.hpp>

namespace spheretree::detail {

/// Brings pairs of bodies 0 .. bodyCount - 1 into ascending order; linear in their number. `scratch` lends
/// its memory and is left with anything in it.
void sortPairs(std::vector<BodyPair>& pairs, std::vector<BodyPair>& scratch, std::size_t bodyCount);

}  // namespace spheretree::detail
