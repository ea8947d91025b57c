// SPDX-License-Identifier: MIT
//
// The walks of pair_query.cpp and box_shapes.cpp, compiled once per instruction set: pair_walk.cpp includes
// this file inside a namespace that defines SPHERETREE_PATH (the attributes of its functions) and
// testBlocks() and testBlock(), which alone touch more than one lane at a time. It makes the same operations
// in the same order on every path, without fusing any, so all paths agree bit for bit.

/// Moves the balls of `blockA` into the frame of B, radii enlarged by the margin, to `placed`, and tests them
/// against those of `blockB`, unused lanes as well.
SPHERETREE_PATH inline Overlaps testBlocks(const BallPlacement& how, const BallBlock& blockA,
                                           const BallBlock& blockB, BallBlock& placed);

/// Moves the balls of `block` into the frame of the box, radii enlarged by the margin, and tests them against
/// it, unused lanes as well.
SPHERETREE_PATH inline BoxHits testBlock(const BoxWalk& walk, const BallBlock& block);

/// Tests the blocks that the frame names.
SPHERETREE_PATH inline std::uint64_t testFrame(const PairWalk& walk, PairFrame& frame) {
  const Overlaps overlaps = testBlocks(walk.placement, walk.treeA->blocks()[frame.blockA],
                                       walk.treeB->blocks()[frame.blockB], frame.a);
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

SPHERETREE_PATH bool touchBox(BoxWalk& walk) {
  struct Frame {
    std::uint32_t block;
    std::uint32_t pending;  // lanes that touch, not looked into yet
    std::uint32_t next;     // the one to look into next
    std::uint32_t further;  // blocks of the family that are still to come
  };
  const QueryTree& tree = *walk.tree;
  std::array<Frame, kMaxQueryLevels - 1> frames;
  Frame* frame = frames.data();
  Frame* const last = frame + (walk.level - 1);
  QueryTree::Family family = tree.rootFamily();
  std::uint32_t lanes = family.lanes;
  frame->block = family.block;
  frame->further = family.further;
  for (;;) {
    const BoxHits hits = testBlock(walk, tree.blocks()[frame->block]);
    frame->pending = hits.lanes & lanes;
    const auto deepest = static_cast<std::uint32_t>(kLaneBits - (hits.deepest & kLaneBits));
    const bool usable = (frame->pending >> deepest & 1U) != 0;
    frame->next = usable ? deepest : static_cast<std::uint32_t>(std::countr_zero(frame->pending));
    while (frame->pending == 0 && frame->further == 0) {
      if (frame == frames.data()) return false;
      --frame;
    }
    if (frame->pending == 0) {
      --frame->further;
      lanes = tree.lanes(++frame->block);
      continue;
    }
    if (frame == last) {
      walk.found = place(walk.placement.pose, tree.ball(frame->block, frame->next), walk.placement.margin);
      return true;
    }
    family = tree.family(frame->block, frame->next);
    lanes = family.lanes;
    frame->pending &= ~(1U << frame->next);
    frame->next = static_cast<std::uint32_t>(std::countr_zero(frame->pending));
    ++frame;
    frame->block = family.block;
    frame->further = family.further;
  }
}
