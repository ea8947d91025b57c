// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "builders/settings.hpp"
#include "medial/ball.hpp"
#include "medial/surface.hpp"

namespace spheretree::builders {

/// What a set of balls costs; smaller is better.
struct SetError {
  double first = 0;   ///< what the objective names, in its own unit
  double second = 0;  ///< decides between equals: the mean overhang, or the worst when the mean comes first

  friend bool operator<(const SetError& a, const SetError& b) {
    return a.first != b.first ? a.first < b.first : a.second < b.second;
  }
};

/// By the quick bound of the overhang, radius - depth. One query per ball; the volume is that of the union.
[[nodiscard]] SetError setError(const medial::Surface& surface, std::span<const medial::Ball> balls,
                                Objective objective);

}  // namespace spheretree::builders
