// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/set_error.hpp"

#include <algorithm>

#include "builders/overhang.hpp"
#include "builders/union_volume.hpp"

namespace spheretree::builders {

SetError setError(const medial::Surface& surface, std::span<const medial::Ball> balls, Objective objective) {
  double worst = 0;
  double sum = 0;
  for (const medial::Ball& ball : balls) {
    const double overhang = quickOverhang(surface, ball);
    worst = std::max(worst, overhang);
    sum += overhang;
  }
  const double mean = balls.empty() ? 0 : sum / static_cast<double>(balls.size());
  switch (objective) {
    case Objective::Mean:
      return {mean, worst};
    case Objective::Volume:
      return {unionVolume(balls), mean};
    case Objective::Worst:
      break;
  }
  return {worst, mean};
}

}  // namespace spheretree::builders
