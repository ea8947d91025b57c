// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/unit/builders/reducer_facts.hpp"

namespace spheretree::builders {
namespace {

class ExpandReducer : public testing::Test {
 protected:
  std::unique_ptr<Reducer> reducer_ = makeExpandReducer();
};

TEST_F(ExpandReducer, WantsAnAxis) {
  EXPECT_TRUE(reducer_->wantsAxis());
}

TEST_F(ExpandReducer, TwoBallsAreTwoBalls) {
  facts::twoBallsAreTwoBalls(*reducer_);
}

TEST_F(ExpandReducer, ACubeNeedsWhatItNeeds) {
  facts::aCubeNeedsWhatItNeeds(*reducer_);
}

TEST_F(ExpandReducer, EveryCellIsHeldAtOneStandOff) {
  facts::everyCellIsHeldAtOneStandOff(*reducer_);
}

TEST_F(ExpandReducer, MoreBallsStandOffLess) {
  facts::moreBallsStandOffLess(*reducer_);
}

TEST_F(ExpandReducer, GoodEnoughTakesTheFewest) {
  facts::goodEnoughTakesTheFewest(*reducer_);
}

TEST_F(ExpandReducer, OtherObjectivesCoverToo) {
  facts::otherObjectivesCoverToo(*reducer_);
}

TEST_F(ExpandReducer, SameRequestSameBits) {
  facts::sameRequestSameBits(*reducer_);
}

TEST_F(ExpandReducer, StopsInTheMiddle) {
  facts::stopsInTheMiddle(*reducer_);
}

TEST_F(ExpandReducer, TreesAreCertified) {
  facts::treesAreCertified("expand");
}

TEST_F(ExpandReducer, DoesWithoutAnAxis) {
  RegionOf region(surfaceOf(models::makeTorus(2, 0.6, 48, 24)));
  const double with = region.worst(region.reduce(*reducer_, 8));
  region.axis = {};
  const std::vector<medial::Ball> balls = region.reduce(*reducer_, 8);
  EXPECT_TRUE(region.covered(balls));
  EXPECT_LT(region.worst(balls), 1.2 * with);
}

}  // namespace
}  // namespace spheretree::builders
