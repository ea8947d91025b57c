// SPDX-License-Identifier: GPL-3.0-or-later
//
// The certified bounds bracket what independent dense sampling finds.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "builders/build_tree.hpp"
#include "builders/catalogue.hpp"
#include "tests/support/solids.hpp"
#include "tests/support/trees.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;

/// The deepest of many random points of the ball outside the solid: a lower bound without any cleverness.
double sampledOverhang(const medial::Surface& surface, const medial::Ball& ball, int count,
                       medial::Random& random) {
  double worst = 0;
  for (int i = 0; i < count; ++i) {
    Vector3d direction;
    do {
      for (int k = 0; k < 3; ++k) direction[k] = random.uniform(-1, 1);
    } while (direction.squaredNorm() > 1 || direction.squaredNorm() < 1e-4);
    // Half of them on the boundary, half inside, where cavities are, densest around the centre.
    const double reach = i % 2 == 0 ? random.uniform() : 1.0;
    worst = std::max(worst, -surface.depth(ball.center + reach * ball.radius * direction.normalized()));
  }
  return worst;
}

TEST(OverhangProperty, BracketsDenseSampling) {
  constexpr std::uint64_t kSeed = 4711;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  medial::Random random(kSeed);
  for (const test::Solid& solid : test::allSolids()) {
    for (const CatalogueEntry& builder : catalogue()) {
      SCOPED_TRACE(solid.name + " " + std::string(builder.name));
      BuildSettings settings = test::quickSettings(builder.name, 2);
      settings.quality = builders::Quality::Fast;
      settings.hubbard.samples = 300;
      settings.grid.orientations = 1;
      const Result<BuildResult> built = buildTree(solid.surface, settings, medial::Context(2));
      ASSERT_TRUE(built.ok()) << built.error().message;
      const double slack = 1e-9 * solid.surface.diagonal();
      for (std::size_t depth = 0; depth < built->tree.levelCount(); ++depth) {
        const LevelMetrics& m = built->report.levels[depth].metrics;
        const std::vector<medial::Ball> balls = ballsOf(built->tree.level(depth));
        double worst = 0;
        double sum = 0;
        for (std::size_t i = 0; i < balls.size(); ++i) {
          const double sampled = sampledOverhang(solid.surface, balls[i], 1000, random);
          EXPECT_LE(sampled, m.ballOverhang[i] + slack);
          worst = std::max(worst, sampled);
          sum += m.ballOverhang[i];
        }
        EXPECT_LE(worst, m.overhangWorst.upper + slack);
        // 500 points on a sphere leave holes of a fifth of its radius; the bracket may not be farther off.
        EXPECT_GE(worst, m.overhangWorst.lower - 0.2 * balls[m.worstBall].radius);
        EXPECT_LE(m.overhangWorst.upper - m.overhangWorst.lower,
                  std::max(0.01 * m.overhangWorst.upper, 1e-5 * solid.surface.diagonal()) * 1.000001);
        EXPECT_NEAR(m.overhangMean, sum / static_cast<double>(balls.size()), slack);
      }
    }
  }
}

}  // namespace
}  // namespace spheretree::builders
