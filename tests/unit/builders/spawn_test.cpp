// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/unit/builders/reducer_facts.hpp"

namespace spheretree::builders {
namespace {

class SpawnReducer : public testing::Test {
 protected:
  std::unique_ptr<Reducer> reducer_ = makeSpawnReducer();
};

TEST_F(SpawnReducer, NeedsNoAxis) {
  EXPECT_FALSE(reducer_->wantsAxis());
}

TEST_F(SpawnReducer, TwoBallsAreTwoBalls) {
  facts::twoBallsAreTwoBalls(*reducer_);
}

TEST_F(SpawnReducer, ACubeNeedsWhatItNeeds) {
  facts::aCubeNeedsWhatItNeeds(*reducer_);
}

TEST_F(SpawnReducer, EveryCellIsHeldAtOneStandOff) {
  facts::everyCellIsHeldAtOneStandOff(*reducer_);
}

TEST_F(SpawnReducer, MoreBallsStandOffLess) {
  facts::moreBallsStandOffLess(*reducer_);
}

TEST_F(SpawnReducer, GoodEnoughTakesTheFewest) {
  facts::goodEnoughTakesTheFewest(*reducer_);
}

TEST_F(SpawnReducer, OtherObjectivesCoverToo) {
  facts::otherObjectivesCoverToo(*reducer_);
}

TEST_F(SpawnReducer, SameRequestSameBits) {
  facts::sameRequestSameBits(*reducer_);
}

TEST_F(SpawnReducer, StopsInTheMiddle) {
  facts::stopsInTheMiddle(*reducer_);
}

TEST_F(SpawnReducer, TreesAreCertified) {
  facts::treesAreCertified("spawn");
}

}  // namespace
}  // namespace spheretree::builders
