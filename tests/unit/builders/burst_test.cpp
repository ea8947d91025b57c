// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/unit/builders/cluster_facts.hpp"

namespace spheretree::builders {
namespace {

class BurstReducer : public testing::Test {
 protected:
  std::unique_ptr<Reducer> reducer_ = makeBurstReducer();
};

TEST_F(BurstReducer, WantsAnAxis) {
  EXPECT_TRUE(reducer_->wantsAxis());
}

TEST_F(BurstReducer, OneBallIsOneBall) {
  facts::oneBallIsOneBall(*reducer_);
}

TEST_F(BurstReducer, TwoBallsAreTwoBalls) {
  facts::twoBallsAreTwoBalls(*reducer_);
}

TEST_F(BurstReducer, PartsFarApartStayApart) {
  facts::partsFarApartStayApart(*reducer_);
}

TEST_F(BurstReducer, NeighboursComeTogether) {
  facts::neighboursComeTogether(*reducer_);
}

TEST_F(BurstReducer, EveryCellIsHeld) {
  facts::everyCellIsHeld(*reducer_);
}

TEST_F(BurstReducer, OneTriangleTakesOneBall) {
  facts::oneTriangleTakesOneBall(*reducer_);
}

TEST_F(BurstReducer, ACubeInOneAndInEight) {
  facts::aCubeInOneAndInEight(*reducer_);
}

TEST_F(BurstReducer, APlateIsASquare) {
  facts::aPlateIsASquare(*reducer_);
}

TEST_F(BurstReducer, MoreBallsStandOffLess) {
  facts::moreBallsStandOffLess(*reducer_);
}

TEST_F(BurstReducer, GoodEnoughTakesTheFewest) {
  facts::goodEnoughTakesTheFewest(*reducer_);
}

TEST_F(BurstReducer, GoodEnoughEndsEarly) {
  facts::goodEnoughEndsEarly(*reducer_);
}

TEST_F(BurstReducer, SameBitsForAnyThreads) {
  facts::sameBitsForAnyThreads(*reducer_, "burst");
}

TEST_F(BurstReducer, StopsInTheMiddle) {
  facts::stopsInTheMiddle(*reducer_);
}

TEST_F(BurstReducer, TreesAreCertified) {
  facts::treesAreCertified("burst");
}

TEST_F(BurstReducer, DoesWithoutAnAxis) {
  facts::doesWithoutAnAxis(*reducer_);
}

}  // namespace
}  // namespace spheretree::builders
