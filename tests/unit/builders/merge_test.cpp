// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/unit/builders/cluster_facts.hpp"

namespace spheretree::builders {
namespace {

class MergeReducer : public testing::Test {
 protected:
  std::unique_ptr<Reducer> reducer_ = makeMergeReducer();
};

TEST_F(MergeReducer, WantsAnAxis) {
  EXPECT_TRUE(reducer_->wantsAxis());
}

TEST_F(MergeReducer, OneBallIsOneBall) {
  facts::oneBallIsOneBall(*reducer_);
}

TEST_F(MergeReducer, TwoBallsAreTwoBalls) {
  facts::twoBallsAreTwoBalls(*reducer_);
}

TEST_F(MergeReducer, PartsFarApartStayApart) {
  facts::partsFarApartStayApart(*reducer_);
}

TEST_F(MergeReducer, NeighboursComeTogether) {
  facts::neighboursComeTogether(*reducer_);
}

TEST_F(MergeReducer, EveryCellIsHeld) {
  facts::everyCellIsHeld(*reducer_);
}

TEST_F(MergeReducer, OneTriangleTakesOneBall) {
  facts::oneTriangleTakesOneBall(*reducer_);
}

TEST_F(MergeReducer, ACubeInOneAndInEight) {
  facts::aCubeInOneAndInEight(*reducer_);
}

TEST_F(MergeReducer, APlateIsASquare) {
  facts::aPlateIsASquare(*reducer_);
}

TEST_F(MergeReducer, MoreBallsStandOffLess) {
  facts::moreBallsStandOffLess(*reducer_);
}

TEST_F(MergeReducer, GoodEnoughTakesTheFewest) {
  facts::goodEnoughTakesTheFewest(*reducer_);
}

TEST_F(MergeReducer, GoodEnoughEndsEarly) {
  facts::goodEnoughEndsEarly(*reducer_);
}

TEST_F(MergeReducer, SameBitsForAnyThreads) {
  facts::sameBitsForAnyThreads(*reducer_, "merge");
}

TEST_F(MergeReducer, StopsInTheMiddle) {
  facts::stopsInTheMiddle(*reducer_);
}

TEST_F(MergeReducer, TreesAreCertified) {
  facts::treesAreCertified("merge");
}

TEST_F(MergeReducer, DoesWithoutAnAxis) {
  facts::doesWithoutAnAxis(*reducer_);
}

}  // namespace
}  // namespace spheretree::builders
