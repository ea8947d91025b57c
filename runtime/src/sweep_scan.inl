// SPDX-License-Identifier: MIT
//
// The sweep along one strip, compiled once per instruction set: sweep_kernels.cpp includes this file inside a
// namespace that defines SPHERETREE_PATH (the attributes of its functions) and what else differs: kLanes,
// Rows, sameRows(), rowsAt(), groupHits(), laneOf(), stepOf(), and for kLanes records at once Ends. Then come
// Neighbours, of sweep_distances.inl or another, and sweep_strip.inl.
//
// Which records hit, cross a border or end when is not to be predicted, and a wrong guess costs as much as
// testing thirty records: hits and crossings are set aside without a branch and worked off in batches.

/// Delivers what has been set aside.
SPHERETREE_PATH inline void flush(StripScan& scan, HitList& hits) {
  for (std::uint32_t k = 0; k < hits.count; ++k) {
    const HitList::Entry entry = hits.entries[k];
    for (std::uint64_t mask = entry.mask; mask != 0; mask &= mask - 1) {
      const auto bit = static_cast<std::uint32_t>(std::countr_zero(mask));
      const std::uint32_t lane = laneOf(bit);
      const std::uint32_t step = stepOf(bit);
      const std::uint32_t i = entry.first + entry.firstPerLane * lane + entry.firstPerStep * step;
      const std::uint32_t j = entry.other + lane + entry.otherPerStep * step;
      if (j < entry.end) report(scan, i, j);
    }
  }
  hits.count = 0;
}

/// Tests one record against those from `from` to `to` - 1.
SPHERETREE_PATH inline void testRange(StripScan& scan, HitList& hits, std::uint32_t i, std::uint32_t from,
                                      std::uint32_t to) {
  const Rows rows = sameRows(scan.low[i], scan.high[i]);
  for (std::uint32_t j = from; j < to; j += kLanes * kGroup) {
    const std::uint32_t mask = groupHits<kLanes>(rows, scan.low + j, scan.high + j);
    if (hits.add({mask, i, j, to, 0, 0, kLanes})) flush(scan, hits);
    scan.tests += kLanes * kGroup;
  }
}

/// Tests a record that reaches out of its strip against those of the strips above that may touch it.
SPHERETREE_PATH inline void testAbove(StripScan& scan, HitList& hits, std::uint32_t strip, std::uint32_t i) {
  const std::uint32_t begin = coordinateOf(scan.low[i], scan.sweepLane);
  const std::uint32_t end = kMaxCoordinate - coordinateOf(scan.high[i], scan.sweepLane);
  const std::uint32_t across = kMaxCoordinate - coordinateOf(scan.high[i], scan.stripLane);
  const std::uint32_t last = partOf(across, scan.strips);
  for (std::uint32_t above = strip + 1; above <= last; ++above) {
    const std::uint32_t* const bounds = scan.bounds + std::size_t{above} * scan.cells;
    const std::uint32_t first = begin - std::min(begin, scan.longest[above]);
    testRange(scan, hits, i, bounds[partOf(first, scan.cells)], bounds[partOf(end, scan.cells) + 1]);
  }
}
