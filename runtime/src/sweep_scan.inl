// SPDX-License-Identifier: MIT
//
// The sweep along one strip, compiled once per instruction set: sweep_kernels.cpp includes this file inside a
// namespace that defines SPHERETREE_PATH (the attributes of its functions) and what else differs:
// windowHits(), stepHits() and Ends.
//
// Which records hit, cross a border or reach far is not to be predicted, and a wrong guess costs as much as
// testing thirty records: what is found is set aside without a branch and worked off in batches.

/// Delivers what has been set aside.
SPHERETREE_PATH inline void flush(StripScan& scan, HitList& hits) {
  for (std::uint32_t k = 0; k < hits.count; ++k) {
    const HitList::Entry entry = hits.entries[k];
    for (std::uint64_t mask = entry.mask; mask != 0; mask &= mask - 1) {
      const auto bit = static_cast<std::uint32_t>(std::countr_zero(mask));
      const std::uint32_t i = entry.first + bit / kRow * entry.firstStride;
      const std::uint32_t j = entry.other + bit / kRow * entry.otherStride + bit % kRow;
      if (j < entry.end) report(scan, i, j);
    }
  }
  hits.count = 0;
}

/// Tests one record against those from `from` to `to` - 1.
SPHERETREE_PATH inline void testRange(StripScan& scan, HitList& hits, std::uint32_t i, std::uint32_t from,
                                      std::uint32_t to) {
  for (std::uint32_t j = from; j < to; j += kStep) {
    const std::uint32_t mask = stepHits(scan.low[i], scan.high[i], scan.low + j, scan.high + j);
    if (hits.add({mask, i, j, to, 0, kRow})) flush(scan, hits);
    scan.tests += kStep;
  }
}

/// Tests records that reach farther along their strip than a row.
SPHERETREE_PATH inline void testFar(StripScan& scan, HitList& hits, const std::uint32_t* bounds,
                                    RecordList& far) {
  for (std::uint32_t k = 0; k < far.count; ++k) {
    const std::uint32_t i = far.records[k];
    const std::uint32_t last = kMaxCoordinate - coordinateOf(scan.high[i], scan.sweepLane);
    testRange(scan, hits, i, i + 1 + kRow, bounds[partOf(last, scan.cells) + 1]);
  }
  far.count = 0;
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

/// Works off the crossing records; those from `end` on belong to another strip.
SPHERETREE_PATH inline void testCrossings(StripScan& scan, HitList& hits, std::uint32_t strip,
                                          std::uint32_t end, RecordList& crossings) {
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
  RecordList far;
  RecordList crossings;
  for (std::uint32_t first = bounds[0]; first < end; first += kRow) {
    const std::uint64_t* const low = scan.low + first;
    const std::uint64_t* const high = scan.high + first;
    ends.take(low, high);
    if (hits.add({windowHits(low, high), first, first + 1, end, 1, 1})) flush(scan, hits);
    // Of the last records of a strip, those behind a row belong to another one.
    const std::uint32_t inside = std::min(kRow, end - std::min(end, first + 1 + kRow));
    Ends::add(ends.reaching(low + 1 + kRow) & ((1U << inside) - 1), first, far);
    Ends::add(ends.crossing(), first, crossings);
    if (far.full()) testFar(scan, hits, bounds, far);
    if (crossings.full()) testCrossings(scan, hits, strip, end, crossings);
  }
  scan.tests += std::uint64_t{kRow} * (end - bounds[0]);
  testFar(scan, hits, bounds, far);
  testCrossings(scan, hits, strip, end, crossings);
  flush(scan, hits);
  scan.longest[strip] = ends.longest();
}
