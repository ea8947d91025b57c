// SPDX-License-Identifier: GPL-3.0-or-later
#include "random_case.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

#include "builders/catalogue.hpp"
#include "medial/random.hpp"
#include "models/assemble.hpp"
#include "models/shapes.hpp"
#include "tests/support/solids.hpp"

namespace spheretree::soak {
namespace {

using Eigen::Vector3d;
using medial::Random;
using medial::TriangleMesh;

std::uint32_t below(Random& random, std::uint32_t bound) {
  return static_cast<std::uint32_t>(random.next() % bound);
}

Vector3d somePoint(Random& random, double reach) {
  const double x = random.uniform(-reach, reach);
  const double y = random.uniform(-reach, reach);
  return {x, y, random.uniform(-reach, reach)};
}

TriangleMesh someShape(Random& random, std::string& what) {
  const std::uint32_t segments = 3 + below(random, 14);
  const double thin = std::pow(10, random.uniform(-3, 0));
  switch (below(random, 12)) {
    case 0:
      what = "ball";
      return models::makeBall(1, below(random, 3));
    case 1:
      what = "box";
      return models::makeBox({1, random.uniform(0.1, 1), thin});
    case 2:
      what = "cylinder";
      return models::makeCylinder(0.5, 2 * thin, segments);
    case 3:
      what = "cone";
      return models::makeCone(0.5, random.uniform(0.05, 2), segments);
    case 4:
      what = "torus";
      return models::makeTorus(1, random.uniform(0.05, 0.9), segments, 3 + below(random, 8));
    case 5:
      what = "L";
      return models::makeLBlock();
    case 6:
      what = "U";
      return models::makeUBlock();
    case 7:
      what = "hollow ball";
      return models::makeHollowBall(1, random.uniform(0.2, 0.95), 1 + below(random, 2));
    case 8:
      what = "tangent balls";
      return models::makeTangentBalls(0.5, 1 + below(random, 2));
    case 9:
      what = "comb";
      return models::makeComb(2 + below(random, 3));
    case 10:
      what = "gear";
      return models::makeGear(4 + below(random, 6));
    default:
      what = "knot";
      return models::makeKnot(24 + below(random, 12), 3 + below(random, 3));
  }
}

/// Bends, stretches, shakes: still closed and oriented, perhaps crossing itself.
void deform(TriangleMesh& mesh, Random& random, std::string& what) {
  const double length = medial::diagonalOf(mesh);
  if (below(random, 2) == 0) {
    const Vector3d stretch(std::exp2(random.uniform(-2, 2)), std::exp2(random.uniform(-2, 2)), 1);
    for (Vector3d& v : mesh.vertices) v = v.cwiseProduct(stretch);
    what += ", stretched";
  }
  if (below(random, 3) == 0) {
    const double bend = random.uniform(0.02, 0.2) * length;
    const double wave = random.uniform(1, 6) / length;
    for (Vector3d& v : mesh.vertices) v.z() += bend * std::sin(wave * v.x() + 2 * wave * v.y());
    what += ", bent";
  }
  if (below(random, 3) == 0) {
    const double shake = std::pow(10, random.uniform(-9, -1.5)) * length;
    for (Vector3d& v : mesh.vertices) v += somePoint(random, shake);
    what += ", shaken";
  }
}

/// Anywhere, turned, of any size.
void place(TriangleMesh& mesh, Random& random, std::string& what) {
  if (below(random, 2) == 0) return;
  const Eigen::Matrix3d turn = test::randomRotation(random);
  const double scale = std::pow(10, random.uniform(-6, 6));
  const Vector3d shift = somePoint(random, std::pow(10, random.uniform(-1, 4)) * scale);
  for (Vector3d& v : mesh.vertices) v = scale * (turn * v) + shift;
  what += ", placed";
}

builders::BuildSettings someSettings(Random& random, std::string& what) {
  using builders::Toggle;
  builders::BuildSettings settings;
  // The default builder is what most people run.
  const auto builders = builders::catalogue();
  settings.builder =
      below(random, 3) == 0 ? builders.back().name : builders[random.next() % builders.size()].name;
  settings.branch = 2 + below(random, 9);
  settings.levels = 1 + below(random, settings.branch > 4 ? 3 : 5);
  settings.quality = below(random, 8) == 0 ? builders::Quality::Normal : builders::Quality::Fast;
  settings.cover = below(random, 5) == 0 ? builders::Cover::Solid : builders::Cover::Surface;
  settings.objective = static_cast<builders::Objective>(below(random, 3));
  settings.maxError = below(random, 4) == 0 ? std::pow(10, random.uniform(-3, -0.5)) : 0;
  settings.seed = random.next();
  settings.axis = {random.uniform(0.3, 1.5), 20 + below(random, 80)};
  settings.hubbard.samples = 50 + below(random, 400);
  settings.grid.orientations = 1 + below(random, 3);
  constexpr std::array<Toggle, 3> kToggles{Toggle::Auto, Toggle::Off, Toggle::On};
  settings.refine = kToggles[below(random, 3)];
  // Linking needs refining.
  settings.link = settings.refine == Toggle::On ? kToggles[below(random, 3)] : Toggle::Auto;
  what += "; " + settings.builder + ", branch " + std::to_string(settings.branch) + ", " +
          std::to_string(settings.levels) + " levels" +
          (settings.cover == builders::Cover::Solid ? ", solid" : "") +
          (settings.quality == builders::Quality::Normal ? ", normal" : "");
  return settings;
}

}  // namespace

Case makeCase(std::uint64_t seed) {
  Random random(seed);
  Case made;
  made.seed = seed;
  made.mesh = someShape(random, made.what);
  deform(made.mesh, random, made.what);
  if (below(random, 4) == 0) {
    std::string other;
    const Vector3d away = somePoint(random, 1.5);
    made.mesh = models::joined(std::move(made.mesh), models::moved(someShape(random, other), away));
    made.what += " and " + other;
  }
  if (below(random, 8) == 0) {
    const std::size_t first = random.next() % made.mesh.triangles.size();
    made.mesh.triangles.erase(made.mesh.triangles.begin() + static_cast<std::ptrdiff_t>(first));
    made.mended = true;
    made.what += ", one triangle cut away";
  }
  place(made.mesh, random, made.what);
  made.settings = someSettings(random, made.what);
  return made;
}

}  // namespace spheretree::soak
