// SPDX-License-Identifier: MIT
//
// The strip itself: the third part of what sweep_scan.inl begins.

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
  Neighbours neighbours;
  RecordList crossings;
  for (std::uint32_t first = bounds[0]; first < end; first += kLanes) {
    ends.take(scan.low + first, scan.high + first);
    neighbours.meet(scan, hits, ends, bounds, first);
    ends.addCrossings(first, crossings);
    if (crossings.full()) testCrossings(scan, hits, strip, end, crossings);
  }
  neighbours.finish(scan, hits, bounds);
  testCrossings(scan, hits, strip, end, crossings);
  flush(scan, hits);
  scan.longest[strip] = ends.longest();
}
