// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>

#include "random_case.hpp"

namespace spheretree::soak {

/// What checking a case came to.
struct Verdict {
  std::string flaw;           ///< what does not hold, empty when all does
  std::string refusal;        ///< why there is no tree, by name; empty when there is one
  std::size_t poses = 0;      ///< pairs of poses whose queries were compared with the meshes
  std::size_t meetings = 0;   ///< of these, with surfaces that cross
  std::size_t brackets = 0;   ///< certified overhangs compared with brackets of our own
  std::size_t undecided = 0;  ///< chain proofs that took too many pieces to be repeated naively
};

/// Builds the case and holds everything that is promised of a tree against checks that share no code with
/// it (tests/support/naive.hpp): the chains cover, the overhang is bracketed, the `.sph` text gives the same
/// bits, queries miss nothing and keep their bounds.
[[nodiscard]] Verdict check(const Case& given);

}  // namespace spheretree::soak
