// SPDX-License-Identifier: MIT
//
// All pairs, in order. Kept as plain as it can be: the other engines are held to it.

#include <spheretree/brute_force.hpp>

#include "box_check.hpp"

namespace spheretree {

Result<Done> BruteForce::findPairs(std::span<const Aabb> boxes, std::vector<BodyPair>& pairs) {
  pairs.clear();
  if (boxes.size() > detail::kMaxBodies) return detail::tooManyBoxes();
  if (const std::size_t fault = detail::firstFault(boxes); fault != detail::kNoFault)
    return detail::faultAt(fault);
  const auto count = static_cast<std::uint32_t>(boxes.size());
  for (std::uint32_t a = 0; a < count; ++a) {
    for (std::uint32_t b = a + 1; b < count; ++b) {
      if (overlap(boxes[a], boxes[b])) pairs.push_back({a, b});
    }
  }
  return Done{};
}

}  // namespace spheretree
