// SPDX-License-Identifier: MIT
//
// The walk of pair_query.cpp, compiled once per instruction set: pair_walk.cpp includes this file inside a
// namespace that defines SPHERETREE_PATH (the attributes of its functions) and testBlocks(), which alone
// touches more than one lane at a time. It makes the same operations in the same order on every path, without
// fusing any, so all paths agree bit for bit.

/// Moves the balls of `blockA` into the frame of B, radii enlarged by the margin, to `placed`, and tests them
/// against those of `blockB`, unused lanes as well.
SPHERETREE_PATH inline Overlaps testBlocks(const PairWalk& walk, const BallBlock& blockA,
                                           const BallBlock& blockB, BallBlock& placed);

/// Tests the blocks that the frame names.
SPHERETREE_PATH inline std::uint64_t testFrame(const PairWalk& walk, PairFrame& frame) {
  const Overlaps overlaps =
      testBlocks(walk, walk.treeA->blocks()[frame.blockA], walk.treeB->blocks()[frame.blockB], frame.a);
  std::uint64_t pending = overlaps.pairs;
  const std::uint32_t both = frame.lanesA & frame.lanesB;
  if (both != kAllLanes) pending &= pairsOf(frame.lanesA, frame.lanesB);
  frame.next = nextOf(pending, overlaps.deepest);
  return pending;
}

/// Goes on to the next block of the families; there must be one.
SPHERETREE_PATH inline void nextBlocks(const PairWalk& walk, PairFrame& frame) {
  if (frame.furtherB > 0) {
    --frame.furtherB;
    ++frame.blockB;
    frame.lanesB = walk.treeB->lanes(frame.blockB);
    return;
  }
  --frame.furtherA;
  ++frame.blockA;
  frame.lanesA = walk.treeA->lanes(frame.blockA);
  frame.blockB = frame.familyB.block;
  frame.lanesB = frame.familyB.lanes;
  frame.furtherB = frame.familyB.further;
}

SPHERETREE_PATH inline std::uint64_t enter(const PairWalk& walk, PairFrame& frame, QueryTree::Family a,
                                           QueryTree::Family b) {
  frame.blockA = a.block;
  frame.blockB = b.block;
  frame.lanesA = a.lanes;
  frame.lanesB = b.lanes;
  frame.furtherA = a.further;
  frame.furtherB = b.further;
  frame.familyB = b;
  return testFrame(walk, frame);
}

SPHERETREE_PATH WalkEnd advance(PairWalk& walk, WalkLimits limits) {
  const QueryTree& treeA = *walk.treeA;
  const QueryTree& treeB = *walk.treeB;
  std::int32_t depth = walk.depth;
  PairFrame* frame = walk.frames.data() + (depth > 0 ? depth : 0);
  std::uint64_t pending = depth >= 0 ? frame->pending : 0;
  std::uint64_t tests = walk.tests;
  WalkEnd end = WalkEnd::Complete;
  if (walk.fresh) {
    walk.fresh = false;
    depth = 0;
    pending = enter(walk, *frame, treeA.rootFamily(), treeB.rootFamily());
    tests += kTestsPerStep;
  }
  while (depth >= 0) {
    const auto level = static_cast<std::uint32_t>(depth) + 1;
    if (pending != 0) {
      walk.reached = std::max(walk.reached, level);
      if (level >= limits.level) {
        end = WalkEnd::Found;
        break;
      }
    }
    if (pending == 0 && (frame->furtherA | frame->furtherB) == 0) {
      if (--depth < 0) break;
      --frame;
      pending = frame->pending;
      continue;
    }
    if (tests >= limits.tests) {
      end = WalkEnd::OutOfBudget;
      break;
    }
    tests += kTestsPerStep;
    if (pending != 0) {
      const std::uint32_t bit = frame->next;
      const std::uint32_t laneA = bit % kBlockLanes;
      const std::uint32_t laneB = bit / kBlockLanes;
      pending &= ~(std::uint64_t{1} << bit);
      frame->next = static_cast<std::uint8_t>(std::countr_zero(pending));
      PairFrame& below = frame[1];
      const std::uint64_t found =
          enter(walk, below, treeA.family(frame->blockA, laneA), treeB.family(frame->blockB, laneB));
      if (found == 0 && (below.furtherA | below.furtherB) == 0) continue;
      frame->entered = static_cast<std::uint8_t>(bit);
      frame->pending = pending;
      ++depth;
      ++frame;
      pending = found;
    } else {
      nextBlocks(walk, *frame);
      pending = testFrame(walk, *frame);
    }
  }
  if (depth >= 0) frame->pending = pending;
  walk.depth = depth;
  walk.tests = tests;
  return end;
}
