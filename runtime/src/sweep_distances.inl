// SPDX-License-Identifier: MIT
//
// How neighbours along a strip meet where registers are narrower than eight records.

/// Tests kLanes neighbouring records at once, each against the one `distance` places on, for growing
/// distances.
class Neighbours {
 public:
  SPHERETREE_PATH void meet(StripScan& scan, HitList& hits, const Ends& ends, const std::uint32_t* bounds,
                            std::uint32_t first) noexcept {
    const std::uint32_t distances = bounds[partOf(ends.furthest(), scan.cells) + 1] - first - 1;
    const Rows rows = rowsAt(scan.low + first, scan.high + first);
    for (std::uint32_t distance = 1; distance <= distances; distance += kGroup) {
      const std::uint32_t other = first + distance;
      const std::uint32_t mask = groupHits<1>(rows, scan.low + other, scan.high + other);
      if (hits.add({mask, first, other, bounds[scan.cells], 1, 0, 1})) flush(scan, hits);
      scan.tests += kLanes * kGroup;
    }
  }

  static void finish(StripScan&, HitList&, const std::uint32_t*) noexcept {}
};
