// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where an object stands, how it is turned and how large it is does not matter: relative errors stay within
// one per cent. The reference length is the untransformed diagonal, because the bounding box of a turned
// object has another one.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "builders/build_tree.hpp"
#include "builders/catalogue.hpp"
#include "tests/support/solids.hpp"
#include "tests/support/trees.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Errors {
  std::vector<double> worst;
  std::vector<double> mean;
};

Errors errorsOf(const medial::TriangleMesh& mesh, std::string_view builder, double length) {
  BuildSettings settings = test::quickSettings(builder);
  settings.quality = builders::Quality::Fast;
  settings.hubbard.samples = 800;
  settings.grid.orientations = 3;
  const Result<medial::Surface> surface = medial::Surface::create(mesh);
  EXPECT_TRUE(surface.ok());
  const Result<BuildResult> built = buildTree(*surface, settings, medial::Context(2));
  EXPECT_TRUE(built.ok()) << (built.ok() ? "" : built.error().message);
  Errors errors;
  for (const LevelReport& level : built->report.levels) {
    // The middle of the bracket: its width is not a property of the tree.
    const Bounds& worst = level.metrics.overhangWorst;
    errors.worst.push_back((worst.lower + worst.upper) / 2 / length);
    errors.mean.push_back(level.metrics.overhangMean / length);
  }
  return errors;
}

medial::TriangleMesh transformed(medial::TriangleMesh mesh, const Matrix3d& linear, const Vector3d& offset) {
  for (Vector3d& v : mesh.vertices) v = linear * v + offset;
  return mesh;
}

class Invariance : public testing::TestWithParam<CatalogueEntry> {
 protected:
  /// Meshes without symmetries: where several choices are equally good, rounding may pick another one.
  static std::vector<std::pair<std::string, medial::TriangleMesh>> models() {
    medial::TriangleMesh potato = spheretree::models::makeBall(1, 3);
    for (Vector3d& v : potato.vertices) {
      v = Vector3d(1.7 * v.x(), 1.2 * v.y(), 0.9 * v.z()) *
          (1 + 0.15 * std::sin(3 * v.x() + 2 * v.y()) + 0.1 * v.z());
    }
    medial::TriangleMesh wedge = spheretree::models::makeBox({3, 2, 1});
    for (Vector3d& v : wedge.vertices)
      v += Vector3d(0.21 * v.y() + 0.1 * v.z(), 0.13 * v.x() * v.z(), 0.07 * v.y());
    return {{"potato", potato}, {"wedge", wedge}};
  }

  void expectSame(const medial::TriangleMesh& changed, const Errors& expected, double length) const {
    const Errors errors = errorsOf(changed, GetParam().name, length);
    ASSERT_EQ(errors.worst.size(), expected.worst.size());
    for (std::size_t depth = 0; depth < errors.worst.size(); ++depth) {
      EXPECT_NEAR(errors.worst[depth] / expected.worst[depth], 1, 0.01) << "level " << depth;
      EXPECT_NEAR(errors.mean[depth] / expected.mean[depth], 1, 0.01) << "level " << depth;
    }
  }
};

INSTANTIATE_TEST_SUITE_P(Catalogue, Invariance, testing::ValuesIn(catalogue().begin(), catalogue().end()),
                         [](const auto& row) { return std::string(row.param.name); });

TEST_P(Invariance, Rotation) {
  for (const auto& [name, mesh] : models()) {
    const double length = medial::diagonalOf(mesh);
    const Errors expected = errorsOf(mesh, GetParam().name, length);
    for (const std::uint64_t seed : {11U, 12U, 13U}) {
      SCOPED_TRACE(name + ", seed " + std::to_string(seed));
      medial::Random random(seed);
      expectSame(transformed(mesh, test::randomRotation(random), Vector3d::Zero()), expected, length);
    }
  }
}

TEST_P(Invariance, TranslationByAThousandDiagonals) {
  for (const auto& [name, mesh] : models()) {
    SCOPED_TRACE(name);
    const double length = medial::diagonalOf(mesh);
    const Vector3d offset = 1000 * length * Vector3d(0.6, -0.64, 0.48);
    expectSame(transformed(mesh, Matrix3d::Identity(), offset), errorsOf(mesh, GetParam().name, length),
               length);
  }
}

TEST_P(Invariance, Scale) {
  for (const auto& [name, mesh] : models()) {
    const double length = medial::diagonalOf(mesh);
    const Errors expected = errorsOf(mesh, GetParam().name, length);
    for (const double scale : {1e-3, 0.37, 1e3}) {
      SCOPED_TRACE(name + ", scale " + std::to_string(scale));
      expectSame(transformed(mesh, scale * Matrix3d::Identity(), Vector3d::Zero()), expected, scale * length);
    }
  }
}

}  // namespace
}  // namespace spheretree::builders
