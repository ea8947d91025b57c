// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/union_volume.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "medial/random.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;
using medial::Ball;
using medial::Random;

constexpr double kPi = std::numbers::pi;

double ballVolume(double r) {
  return 4 * kPi / 3 * r * r * r;
}

/// What two balls at distance d have in common.
double lensVolume(double a, double b, double d) {
  if (d >= a + b) return 0;
  if (d <= std::abs(a - b)) return ballVolume(std::min(a, b));
  return kPi * (a + b - d) * (a + b - d) * (d * d + 2 * d * (a + b) - 3 * (a - b) * (a - b)) / (12 * d);
}

void expectRelative(double measured, double expected, double tolerance = 1e-12) {
  EXPECT_NEAR(measured, expected, tolerance * expected);
}

std::vector<Ball> lattice(int n, double radius, const Eigen::Matrix3d& pose = Eigen::Matrix3d::Identity()) {
  std::vector<Ball> balls;
  for (int x = 0; x < n; ++x) {
    for (int y = 0; y < n; ++y) {
      for (int z = 0; z < n; ++z) balls.push_back({pose * Vector3d(x, y, z), radius});
    }
  }
  return balls;
}

Eigen::Matrix3d someRotation() {
  return Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
}

TEST(UnionVolume, OfNothingIsZero) {
  EXPECT_EQ(unionVolume({}), 0);
  EXPECT_EQ(unionVolume(std::vector<Ball>{{Vector3d(1, 2, 3), 0}}), 0);
}

TEST(UnionVolume, OfOneBall) {
  expectRelative(unionVolume(std::vector<Ball>{{Vector3d(5, -3, 2), 0.25}}), ballVolume(0.25));
}

TEST(UnionVolume, OfEqualBallsCountsOne) {
  const Ball ball{Vector3d(0.1, 0.2, 0.3), 1.5};
  expectRelative(unionVolume(std::vector<Ball>{ball, ball, ball}), ballVolume(1.5));
}

TEST(UnionVolume, OfTwoBallsIsTheSumWithoutTheLens) {
  const Vector3d direction = Vector3d(3, -1, 2).normalized();
  for (const double radius : {0.05, 0.5, 0.999999, 1.0, 1.7}) {
    const double inner = std::abs(1 - radius);  // one inside the other up to this distance
    for (const double distance : {0.0, 1e-9, 1e-4, 0.1, 0.3, inner, inner * (1 + 1e-9), 0.5, 1.0,
                                  1 + radius - 1e-9, 1 + radius, 3.0}) {
      SCOPED_TRACE(testing::Message() << "radius " << radius << " distance " << distance);
      const std::vector<Ball> balls{{Vector3d(1, 1, 1), 1},
                                    {Vector3d(1, 1, 1) + distance * direction, radius}};
      expectRelative(unionVolume(balls),
                     ballVolume(1) + ballVolume(radius) - lensVolume(1, radius, distance));
    }
  }
}

TEST(UnionVolume, OfBallsCutByThreeOrthogonalPlanes) {
  // Eight balls at the corners of a cube meet in its three mid planes.
  for (const double half : {0.72, 0.8, 0.95}) {
    std::vector<Ball> balls;
    for (int k = 0; k < 8; ++k) {
      balls.push_back(
          {Vector3d((k & 1) != 0 ? half : -half, (k & 2) != 0 ? half : -half, (k & 4) != 0 ? half : -half),
           1});
    }
    const double cap = lensVolume(1, 1, 2 * half) / 2;
    expectRelative(unionVolume(balls), 8 * (ballVolume(1) - 3 * cap));
  }
}

TEST(UnionVolume, OfAPencilOfBallsIsThatOfItsOuterTwo) {
  // Balls through one circle: all radical planes coincide, up to the noise added here.
  for (const double noise : {0.0, 1e-15, 1e-12, 1e-9, 1e-7}) {
    for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
      SCOPED_TRACE(testing::Message() << "noise " << noise << " seed " << seed);
      Random random(seed);
      const auto shaken = [&] { return noise * random.uniform(-1, 1); };
      std::vector<Ball> balls;
      for (const double height : {-0.8, -0.3, -0.1, 0.0, 0.2, 0.4, 0.7}) {
        const Vector3d center = Vector3d(height, 2 * height, -height) / std::sqrt(6.0);
        balls.push_back(
            {center + Vector3d(shaken(), shaken(), shaken()), std::hypot(height, 1.0) + shaken()});
      }
      const double low = balls.front().radius;
      const double high = balls.back().radius;
      const double expected = ballVolume(low) + ballVolume(high) - lensVolume(low, high, 1.5);
      expectRelative(unionVolume(balls), expected, 1e-12 + 20 * noise);
    }
  }
}

TEST(UnionVolume, OfALatticeByInclusionAndExclusion) {
  // Only neighbours along an axis overlap, and no three of them have a common point.
  for (const double radius : {0.4, 0.5, 0.6, 0.7, std::sqrt(0.5)}) {
    const double expected = 64 * ballVolume(radius) - 3 * 4 * 4 * 3 * lensVolume(radius, radius, 1);
    expectRelative(unionVolume(lattice(4, radius)), expected);
    expectRelative(unionVolume(lattice(4, radius, someRotation())), expected);
  }
}

TEST(UnionVolume, OfAFullLatticeGrowsByOneCubePerBall) {
  // Spacing 1 and radius >= sqrt(3)/2 leave no gap, so the volume is a cubic polynomial in n with leading
  // coefficient 1: its third difference is 6. Each inner vertex of the power diagram has eight cells.
  for (const double radius : {std::sqrt(0.75), 0.9, 1.0, 1.3}) {
    for (const Eigen::Matrix3d& pose : {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), someRotation()}) {
      const auto volume = [&](int n) { return unionVolume(lattice(n, radius, pose)); };
      EXPECT_NEAR(volume(5) - 3 * volume(4) + 3 * volume(3) - volume(2), 6, 1e-9) << radius;
    }
  }
}

TEST(UnionVolume, DoesNotDependOnPositionOrScale) {
  const double expected = unionVolume(lattice(3, 0.8));
  std::vector<Ball> moved;
  for (const Ball& ball : lattice(3, 0.8))
    moved.push_back({1e-4 * (ball.center + Vector3d(7, -5, 3)), 1e-4 * ball.radius});
  expectRelative(unionVolume(moved), 1e-12 * expected, 1e-11);
}

std::vector<Ball> randomBalls(Random& random, std::size_t count, double minRadius, double maxRadius) {
  std::vector<Ball> balls;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d center(random.uniform(), random.uniform(), random.uniform());
    balls.push_back({center, random.uniform(minRadius, maxRadius)});
  }
  return balls;
}

TEST(UnionVolume, AgreesWithRandomSampling) {
  constexpr int kSamples = 200'000;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const double largest = seed % 2 == 0 ? 0.15 : 0.4;
    const auto balls = randomBalls(random, 10 + 5 * seed, 0.02, largest);
    int hits = 0;
    const double side = 1 + 2 * largest;
    for (int k = 0; k < kSamples; ++k) {
      const Vector3d at(random.uniform(-largest, 1 + largest), random.uniform(-largest, 1 + largest),
                        random.uniform(-largest, 1 + largest));
      for (const Ball& ball : balls) {
        if ((at - ball.center).squaredNorm() > ball.radius * ball.radius) continue;
        ++hits;
        break;
      }
    }
    const double fraction = static_cast<double>(hits) / kSamples;
    const double sigma = std::sqrt(fraction * (1 - fraction) / kSamples);
    EXPECT_NEAR(unionVolume(balls) / (side * side * side), fraction, 5 * sigma);
  }
}

TEST(UnionVolume, IsIndifferentToOrderAndToHiddenBalls) {
  Random random(99);
  auto balls = randomBalls(random, 200, 0.05, 0.2);
  const double expected = unionVolume(balls);
  balls.push_back({balls[17].center, balls[17].radius / 2});
  std::reverse(balls.begin(), balls.end());
  expectRelative(unionVolume(balls), expected);
}

TEST(UnionVolume, OfABallBehindPlanes) {
  const std::vector<Ball> balls{{Vector3d(1, 2, 3), 2}};
  const HalfSpace below{Vector3d::UnitZ(), 3};  // through the centre
  expectRelative(unionVolumeIn(balls, std::vector<HalfSpace>{below}), ballVolume(2) / 2);
  const HalfSpace left{-Vector3d::UnitX(), -1};
  const HalfSpace tilted{Vector3d(0, 1, 0), 2};
  expectRelative(unionVolumeIn(balls, std::vector<HalfSpace>{below, left, tilted}), ballVolume(2) / 8);
  const HalfSpace high{Vector3d::UnitZ(), 4};
  expectRelative(unionVolumeIn(balls, std::vector<HalfSpace>{high}), ballVolume(2) - lensVolume(2, 2, 2) / 2);
  EXPECT_EQ(unionVolumeIn(balls, std::vector<HalfSpace>{{Vector3d::UnitZ(), 0.5}}), 0);
}

TEST(UnionVolume, OfACoveredCubeIsTheCube) {
  std::vector<HalfSpace> cube;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    cube.push_back({Vector3d::Unit(axis), 2.75});
    cube.push_back({-Vector3d::Unit(axis), -1.25});
  }
  expectRelative(unionVolumeIn(lattice(5, 0.9), cube), 1.5 * 1.5 * 1.5, 1e-11);
  expectRelative(unionVolumeIn(std::vector<Ball>{{Vector3d(2, 2, 2), 2}}, cube), 1.5 * 1.5 * 1.5);
}

TEST(UnionVolume, HandlesAWholeTreeOfBalls) {
  // As many balls as a tree of five levels has, many of them across several others.
  Random random(7);
  const auto balls = randomBalls(random, 4681, 0.02, 0.08);
  const double volume = unionVolume(balls);
  EXPECT_GT(volume, 1);
  EXPECT_LT(volume, 1.16 * 1.16 * 1.16);
}

}  // namespace
}  // namespace spheretree::builders
