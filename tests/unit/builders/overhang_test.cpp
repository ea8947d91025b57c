// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/overhang.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "solids.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;
using medial::Ball;
using medial::Random;
using medial::Surface;

constexpr double kRelative = 1e-2;
constexpr double kTiny = 1e-9;

void expectBracket(const Overhang& overhang, double truth, double relative = kRelative) {
  EXPECT_LE(overhang.value.lower, truth + kTiny);
  EXPECT_GE(overhang.value.upper, truth - kTiny);
  EXPECT_LE(overhang.value.upper - overhang.value.lower, relative * overhang.value.upper + kTiny);
}

void expectWitness(const Surface& surface, const Ball& ball, const Overhang& overhang) {
  EXPECT_LE((overhang.witness - ball.center).norm(), ball.radius * (1 + 1e-12));
  if (overhang.value.lower > 0) {
    EXPECT_DOUBLE_EQ(-surface.depth(overhang.witness), overhang.value.lower);
  }
}

TEST(Overhang, OfTheBallAroundACubeIsAtTheFaceCentres) {
  for (const double side : {1.0, 1e-5, 250.0}) {
    const Surface cube = boxSurface(side, side, side);
    const Ball ball{Vector3d::Zero(), std::sqrt(0.75) * side};
    const Overhang overhang = boundOverhang(cube, ball, 1e-6, 0);
    EXPECT_NEAR(overhang.value.lower, (std::sqrt(3.0) - 1) / 2 * side, 1e-6 * side);
    EXPECT_NEAR(overhang.value.upper, (std::sqrt(3.0) - 1) / 2 * side, 1e-6 * side);
    expectWitness(cube, ball, overhang);
  }
}

TEST(Overhang, OfABallInsideTheSolidIsZero) {
  const Surface cube = boxSurface(1, 1, 1);
  const Overhang overhang = boundOverhang(cube, {Vector3d(0.1, 0, 0), 0.39}, kRelative, 0);
  EXPECT_EQ(overhang.value.lower, 0);
  EXPECT_EQ(overhang.value.upper, 0);
}

TEST(Overhang, OfAPointIsItsDistanceOutside) {
  const Surface cube = boxSurface(1, 1, 1);
  EXPECT_EQ(boundOverhang(cube, {Vector3d(0.3, 0.2, 0.1), 0}, kRelative, 0).value.upper, 0);
  expectBracket(boundOverhang(cube, {Vector3d(2, 0, 0), 0}, kRelative, 0), 1.5);
  // On the surface itself.
  EXPECT_LE(boundOverhang(cube, {Vector3d(0.5, 0, 0), 0}, kRelative, 0).value.upper, 1e-12);
}

TEST(Overhang, OfConcentricBallsIsTheDifferenceOfRadii) {
  const Surface solid = surfaceOf(models::makeBall(1, 3));
  const double inradius = solid.depth(Vector3d::Zero());
  expectBracket(boundOverhang(solid, {Vector3d::Zero(), 1.5}, kRelative, 0), 1.5 - inradius);
}

TEST(Overhang, OfABallCentredOnAFaceReachesStraightOut) {
  const Surface cube = boxSurface(2, 2, 2);
  expectBracket(boundOverhang(cube, {Vector3d(1, 0, 0), 0.5}, kRelative, 0), 0.5);
}

TEST(Overhang, OfABallOverACavityIsInsideTheCavity) {
  const Surface shell = surfaceOf(models::makeHollowBall(1, 0.5, 3));
  const double cavity = -shell.depth(Vector3d::Zero());  // about 0.5
  ASSERT_GT(cavity, 0.49);
  // Concentric and within the outer shell; and off the centre, where it also sticks out by 0.3.
  for (const Ball& ball : {Ball{Vector3d::Zero(), 0.8}, Ball{Vector3d(0.6, 0, 0), 0.7}}) {
    const Overhang overhang = boundOverhang(shell, ball, kRelative, 0);
    expectBracket(overhang, cavity);
    expectWitness(shell, ball, overhang);
    EXPECT_LT(overhang.witness.norm(), 0.02);
  }
}

TEST(Overhang, BetweenParallelWallsIsHalfTheirDistance) {
  // The maximum is reached on a whole plane between the arms of the U, the hardest case for branch and bound.
  const Surface block = surfaceOf(models::makeUBlock());
  const Vector3d notch(block.bounds().center().x(), block.bounds().max().y() - 0.5,
                       block.bounds().center().z());
  ASSERT_NEAR(block.depth(notch), -0.5, 1e-12);
  expectBracket(boundOverhang(block, {notch, 0.4}, kRelative, 0), 0.5);
}

TEST(Overhang, OfAFarBallIsMeasuredToItsFarPole) {
  const Surface cube = boxSurface(1, 1, 1);
  expectBracket(boundOverhang(cube, {Vector3d(100, 0, 0), 3}, kRelative, 0), 102.5);
  expectBracket(boundOverhang(cube, {Vector3d(1e6, 0, 0), 3}, 1e-9, 0), 1e6 + 2.5, 1e-6);
}

TEST(Overhang, OfAHugeBallIsMeasuredAcrossTheSolid) {
  const Surface cube = boxSurface(1, 1, 1);
  for (const double radius : {3.0, 10.0, 1e3, 1e7}) {
    SCOPED_TRACE(testing::Message() << "radius " << radius);
    // Farthest from a cube is the direction of its face centres: everything else is nearer to an edge.
    expectBracket(boundOverhang(cube, {Vector3d::Zero(), radius}, kRelative, 0), radius - 0.5);
  }
}

TEST(Overhang, StaysABracketWhenTheGapIsOutOfReach) {
  const Surface solid = surfaceOf(models::makeBall(1, 2));
  const double truth = 1.2 - solid.depth(Vector3d::Zero());
  const Overhang overhang = boundOverhang(solid, {Vector3d(1e-3, 2e-3, 0), 1.2}, 0, 0);
  EXPECT_LE(overhang.value.lower, truth + 3e-3);
  EXPECT_GE(overhang.value.upper, truth - 3e-3);
}

TEST(Overhang, HoldsUpAgainstDenseSampling) {
  const std::uint64_t seed = 4;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  Random random(seed);
  std::vector<Surface> solids;
  solids.push_back(surfaceOf(models::makeLBlock()));
  solids.push_back(surfaceOf(models::makeTorus(1, 0.3, 24, 12)));
  solids.push_back(surfaceOf(models::makeHollowBall(1, 0.7, 2)));
  solids.push_back(surfaceOf(models::makeComb(3)));
  for (const Surface& solid : solids) {
    for (int k = 0; k < 60; ++k) {
      const Ball ball{randomIn(random, solid.bounds()), random.uniform(0.05, 0.5) * solid.diagonal()};
      SCOPED_TRACE(testing::Message()
                   << "ball " << k << " at " << ball.center.transpose() << " radius " << ball.radius);
      const double absolute = 1e-5 * solid.diagonal();
      const Overhang overhang = boundOverhang(solid, ball, kRelative, absolute);
      EXPECT_LE(overhang.value.upper - overhang.value.lower,
                std::max(kRelative * overhang.value.upper, absolute) + kTiny);
      EXPECT_LE(overhang.value.upper, quickOverhang(solid, ball) + kTiny);
      expectWitness(solid, ball, overhang);
      // A much finer search must not find a point beyond the coarse search's bound.
      EXPECT_LE(boundOverhang(solid, ball, kRelative / 20, absolute).value.lower, overhang.value.upper);
      for (int sample = 0; sample < 400; ++sample) {
        Vector3d direction = randomIn(random, boxAt(Vector3d::Zero(), Vector3d::Constant(2)));
        if (direction.norm() > 1) direction.normalize();
        EXPECT_LE(-solid.depth(ball.center + ball.radius * direction), overhang.value.upper + kTiny);
      }
    }
  }
}

TEST(Overhang, IsTheSameEveryTime) {
  const Surface torus = surfaceOf(models::makeTorus(1, 0.3, 24, 12));
  const Ball ball{Vector3d(0.8, 0.1, 0.05), 0.6};
  const Overhang first = boundOverhang(torus, ball, 1e-3, 0);
  const Overhang second = boundOverhang(torus, ball, 1e-3, 0);
  EXPECT_EQ(first.value.lower, second.value.lower);
  EXPECT_EQ(first.value.upper, second.value.upper);
  EXPECT_EQ(first.witness, second.witness);
}

}  // namespace
}  // namespace spheretree::builders
