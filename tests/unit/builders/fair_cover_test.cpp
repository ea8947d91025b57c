// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/fair_cover.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/builders/solids.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;
using medial::Surface;

/// A bar along x, cut into pieces that weigh as much as their area.
class FairCoverOfABar : public testing::Test {
 protected:
  FairCoverOfABar() {
    for (const Piece& piece : pieces_) loads_.push_back(areaOf(piece));
    for (double x = -3.5; x <= 3.5; x += 0.5)
      places_.push_back(probeDepth(bar_, middle_ + Vector3d(x, 0, 0)));
  }

  [[nodiscard]] FairCoverRequest request(double limit, std::size_t steps) const {
    return {bar_, pieces_, loads_, places_, limit, steps, 1};
  }

  [[nodiscard]] double total() const { return std::accumulate(loads_.begin(), loads_.end(), 0.0); }

  /// How far the nearest ball must stick out to hold the piece.
  static double standOff(const Piece& piece, const DepthProbe& center) {
    double most = 0;
    for (const Vector3d& p : piece.points) most = std::max(most, (p - center.at).norm());
    return most - center.depth;
  }

  [[nodiscard]] std::vector<DepthProbe> row(std::size_t count) const {
    return {places_.begin(), places_.begin() + static_cast<std::ptrdiff_t>(count)};
  }

  Surface bar_ = boxSurface(8, 1, 1);
  Vector3d middle_ = bar_.bounds().center();
  std::vector<Piece> pieces_ = piecesOfAll(bar_, 0.25);
  std::vector<double> loads_;
  std::vector<DepthProbe> places_;
};

TEST_F(FairCoverOfABar, FourBallsShareABarEvenly) {
  const FairCoverRequest wanted = request(0.9, 5000);
  const FairCover cover = fairCover(wanted, row(4));
  ASSERT_TRUE(cover.complete);
  EXPECT_GE(cover.load, total() / 4 * (1 - 1e-9)) << "no ball can have less than the average";
  EXPECT_LE(cover.load, total() / 4 * 1.1);
  for (const Piece& piece : pieces_) {
    double least = std::numeric_limits<double>::infinity();
    for (const DepthProbe& center : cover.centers) least = std::min(least, standOff(piece, center));
    EXPECT_LE(least, wanted.limit) << "every piece is in a ball that sticks out no farther than the limit";
  }
}

TEST_F(FairCoverOfABar, BallsCrowdWhereTheLoadIs) {
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    if (pieces_[i].points.front().x() < middle_.x() - 2) loads_[i] *= 6;
  }
  const FairCover cover = fairCover(request(1.2, 5000), row(4));
  ASSERT_TRUE(cover.complete);
  EXPECT_LE(cover.load, total() / 4 * 1.4)
      << "a ball that had the heavy end alone would have 2.7 times its share";
  const auto heavySide = [&](const DepthProbe& center) { return center.at.x() < middle_.x(); };
  EXPECT_GE(std::count_if(cover.centers.begin(), cover.centers.end(), heavySide), 2);
}

TEST_F(FairCoverOfABar, WhatSeveralBallsHoldIsShared) {
  const DepthProbe inside = probeDepth(bar_, middle_);
  const FairCover twice = fairCover(request(8, 0), std::vector<DepthProbe>{inside, inside});
  EXPECT_TRUE(twice.complete);
  EXPECT_NEAR(twice.load, total() / 2, 1e-9 * total());
  const DepthProbe away = probeDepth(bar_, middle_ + Vector3d(100, 0, 0));
  const FairCover once = fairCover(request(8, 0), std::vector<DepthProbe>{inside, away});
  EXPECT_TRUE(once.complete);
  EXPECT_NEAR(once.load, total(), 1e-9 * total()) << "a ball that reaches nothing relieves nobody";
}

TEST_F(FairCoverOfABar, OneSmallBallIsNotEnough) {
  const FairCover cover = fairCover(request(0.5, 500), row(1));
  EXPECT_FALSE(cover.complete);
}

TEST_F(FairCoverOfABar, EveryPieceGoesToABallThatHoldsItAndLoadsAreEven) {
  const FairCoverRequest wanted = request(1.0, 5000);
  const FairCover cover = fairCover(wanted, row(4));
  ASSERT_TRUE(cover.complete);
  const std::vector<std::uint32_t> owner = shareFairly(wanted, cover);
  std::vector<double> load(4, 0);
  for (std::size_t i = 0; i < owner.size(); ++i) {
    load[owner[i]] += loads_[i];
    EXPECT_LE(standOff(pieces_[i], cover.centers[owner[i]]), wanted.limit);
  }
  EXPECT_LE(*std::max_element(load.begin(), load.end()), 1.1 * cover.load);
}

TEST_F(FairCoverOfABar, TheSameSeedGivesTheSameBalls) {
  const FairCover a = fairCover(request(0.9, 1000), row(4));
  const FairCover b = fairCover(request(0.9, 1000), row(4));
  for (std::size_t i = 0; i < a.centers.size(); ++i) EXPECT_EQ(a.centers[i].at, b.centers[i].at);
}

}  // namespace
}  // namespace spheretree::builders
