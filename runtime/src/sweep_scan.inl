// SPDX-License-Identifier: MIT
//
// The sweep along one strip, compiled once per instruction set: sweep_kernels.cpp includes this file inside a
// namespace that defines SPHERETREE_PATH (the attributes of its functions) and what else differs: kLanes,
// Rows, sameRows(), rowsAt(), groupHits(), laneOf(), stepOf(), and for kLanes records at once Ends.
//
// Which records hit, cross a border or end when is not to be predicted, and a wrong guess costs as much as
// testing thirty records: hits and crossings are set aside without a branch and worked off in batches.

/// Delivers what has been set aside.
SPHERETREE_PATH inline void flush(StripScan& scan, HitList& hits) {
  for (std::uint32_t k = 0; k < hits.count; ++k) {
    const HitList::Entry entry = hits.entries[k];
    for (std::uint32_t mask = entry.mask; mask != 0; mask &= mask - 1) {
      const auto bit = static_cast<std::uint32_t>(std::countr_zero(mask));
      const std::uint32_t i = entry.first + entry.firstStride * laneOf(bit);
      const std::uint32_t j = entry.other + laneOf(bit) + entry.otherStride * stepOf(bit);
      if (j < entry.end) report(scan, i, j);
    }
  }
  hits.count = 0;
}

/// Tests a record that reaches out of its strip against those of the strips above that may touch it.
SPHERETREE_PATH inline void testAbove(StripScan& scan, HitList& hits, std::uint32_t strip, std::uint32_t i) {
  const std::uint32_t begin = coordinateOf(scan.low[i], scan.sweepLane);
  const std::uint32_t end = kMaxCoordinate - coordinateOf(scan.high[i], scan.sweepLane);
  const std::uint32_t across = kMaxCoordinate - coordinateOf(scan.high[i], scan.stripLane);
  const Rows rows = sameRows(scan.low[i], scan.high[i]);
  const std::uint32_t last = partOf(across, scan.strips);
  for (std::uint32_t above = strip + 1; above <= last; ++above) {
    const std::uint32_t* const bounds = scan.bounds + std::size_t{above} * scan.cells;
    const std::uint32_t first = begin - std::min(begin, scan.longest[above]);
    const std::uint32_t to = bounds[partOf(end, scan.cells) + 1];
    for (std::uint32_t j = bounds[partOf(first, scan.cells)]; j < to; j += kLanes * kGroup) {
      const std::uint32_t mask = groupHits<kLanes>(rows, scan.low + j, scan.high + j);
      if (hits.add({i, 0, j, kLanes, to, mask})) flush(scan, hits);
      scan.tests += kLanes * kGroup;
    }
  }
}

/// Tests kLanes neighbouring records at once, each against the one `distance` places on, for growing
/// distances.
SPHERETREE_PATH inline void testNeighbours(StripScan& scan, HitList& hits, std::uint32_t first,
                                           std::uint32_t distances, std::uint32_t end) {
  const Rows rows = rowsAt(scan.low + first, scan.high + first);
  for (std::uint32_t distance = 1; distance <= distances; distance += kGroup) {
    const std::uint32_t other = first + distance;
    const std::uint32_t mask = groupHits<1>(rows, scan.low + other, scan.high + other);
    if (hits.add({first, 1, other, 1, end, mask})) flush(scan, hits);
    scan.tests += kLanes * kGroup;
  }
}

/// Works off the crossing records; those from `end` on belong to another strip.
SPHERETREE_PATH inline void testCrossings(StripScan& scan, HitList& hits, std::uint32_t strip,
                                          std::uint32_t end, CrossingList& crossings) {
  for (std::uint32_t k = 0; k < crossings.count; ++k) {
    if (crossings.records[k] < end) testAbove(scan, hits, strip, crossings.records[k]);
  }
  crossings.count = 0;
}

SPHERETREE_PATH void scanStrip(StripScan& scan, std::uint32_t strip) {
  const std::uint32_t* const bounds = scan.bounds + std::size_t{strip} * scan.cells;
  const std::uint32_t end = bounds[scan.cells];
  Ends ends(scan, lastOfPart(strip, scan.strips));
  HitList hits;
  CrossingList crossings;
  for (std::uint32_t first = bounds[0]; first < end; first += kLanes) {
    ends.take(scan.low + first, scan.high + first);
    const std::uint32_t reach = bounds[partOf(ends.furthest(), scan.cells) + 1];
    testNeighbours(scan, hits, first, reach - first - 1, end);
    ends.addCrossings(first, crossings);
    if (crossings.count >= kCrossingBatch) testCrossings(scan, hits, strip, end, crossings);
  }
  testCrossings(scan, hits, strip, end, crossings);
  flush(scan, hits);
  scan.longest[strip] = ends.longest();
}
