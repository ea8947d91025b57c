// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far the errors of a tree change when the same object comes in another way: moved, scaled, turned, with
// its vertices or triangles in another order, with a vertex per corner. Prints a row per model, builder and
// change; docs/robustness.md is made of them.
//   invariance_bench [--runs N] [--builders A,B] [--models A,B] [--changes A,B]
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "builders/build_tree.hpp"
#include "builders/catalogue.hpp"
#include "builders/metrics.hpp"
#include "io/soup_cleaning.hpp"
#include "io/tree_files.hpp"
#include "solids.hpp"

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using spheretree::medial::Random;
using spheretree::medial::TriangleMesh;
namespace builders = spheretree::builders;
namespace medial = spheretree::medial;
namespace models = spheretree::models;

struct Errors {
  std::vector<double> worst;  ///< per level, fraction of the diagonal of the mesh as it was
  std::vector<double> mean;
  double bracket = 0;  ///< the widest of those around `worst`, fraction of the diagonal
  std::string hash;
};

struct NamedMesh {
  std::string name;
  TriangleMesh mesh;
};

/// No symmetry, a right-angled one, a round one, a machine part and a finer round one.
std::vector<NamedMesh> studied() {
  const auto potato = [](std::uint32_t subdivisions) {
    TriangleMesh mesh = models::makeBall(1, subdivisions);
    for (Vector3d& v : mesh.vertices) {
      v = Vector3d(1.7 * v.x(), 1.2 * v.y(), 0.9 * v.z()) *
          (1 + 0.15 * std::sin(3 * v.x() + 2 * v.y()) + 0.1 * v.z());
    }
    return mesh;
  };
  TriangleMesh wedge = models::makeBox({3, 2, 1});
  for (Vector3d& v : wedge.vertices)
    v += Vector3d(0.21 * v.y() + 0.1 * v.z(), 0.13 * v.x() * v.z(), 0.07 * v.y());
  return {{"wedge", wedge},
          {"potato", potato(2)},
          {"l_block", models::makeLBlock()},
          {"gear", models::makeGear(12)},
          {"fine_potato", potato(3)}};
}

// A report brackets the worst overhang more widely than trees differ, so it is looked at again, every ball
// that may be the worst.
constexpr builders::Sharpness kSharp{1e-7, std::numeric_limits<std::uint32_t>::max()};

Errors errorsOf(TriangleMesh mesh, const std::string& builder, double length) {
  builders::BuildSettings settings;
  settings.builder = builder;
  settings.levels = 3;
  settings.quality = builders::Quality::Fast;
  const auto surface = medial::Surface::create(std::move(mesh));
  if (!surface) throw std::runtime_error(surface.error().message);
  const auto built = builders::buildTree(*surface, settings, medial::Context(1));
  if (!built) throw std::runtime_error(built.error().message);
  Errors errors;
  errors.hash = spheretree::io::treeHash(built->tree);
  for (std::size_t depth = 0; depth < built->tree.levelCount(); ++depth) {
    const std::vector<medial::Ball> balls = builders::ballsOf(built->tree.level(depth));
    const builders::Bounds worst = builders::levelOverhang(*surface, balls, medial::Context(1), kSharp).worst;
    errors.worst.push_back((worst.lower + worst.upper) / 2 / length);
    errors.bracket = std::max(errors.bracket, (worst.upper - worst.lower) / length);
    errors.mean.push_back(built->report.levels[depth].metrics.overhangMean / length);
  }
  return errors;
}

// --- changes; `length` becomes that of the changed mesh ---

struct Changed {
  TriangleMesh mesh;
  double length;
};

Changed translated(Changed object, Random& random) {
  const Vector3d offset(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  for (Vector3d& v : object.mesh.vertices) v += object.length * offset;
  return object;
}

Changed scaled(Changed object, Random& random) {
  const double factor = std::exp(random.uniform(-7, 7));  // a thousandth to a thousandfold
  for (Vector3d& v : object.mesh.vertices) v *= factor;
  object.length *= factor;
  return object;
}

Changed rotated(Changed object, Random& random) {
  const Matrix3d rotation = spheretree::test::randomRotation(random);
  for (Vector3d& v : object.mesh.vertices) v = rotation * v;
  return object;
}

Changed similar(Changed object, Random& random) {
  return translated(scaled(rotated(std::move(object), random), random), random);
}

std::vector<std::uint32_t> shuffled(std::size_t count, Random& random) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0U);
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[random.next() % i]);
  return order;
}

Changed reorderedVertices(Changed object, Random& random) {
  const std::vector<std::uint32_t> place = shuffled(object.mesh.vertices.size(), random);
  const std::vector<Vector3d> old = object.mesh.vertices;
  for (std::size_t v = 0; v < old.size(); ++v) object.mesh.vertices[place[v]] = old[v];
  for (TriangleMesh::Triangle& triangle : object.mesh.triangles)
    for (std::uint32_t& corner : triangle) corner = place[corner];
  return object;
}

/// Triangles begin with another corner, too.
Changed reorderedTriangles(Changed object, Random& random) {
  const std::vector<TriangleMesh::Triangle> old = object.mesh.triangles;
  const std::vector<std::uint32_t> place = shuffled(old.size(), random);
  for (std::size_t t = 0; t < old.size(); ++t) {
    TriangleMesh::Triangle triangle = old[t];
    std::rotate(triangle.begin(), triangle.begin() + static_cast<std::ptrdiff_t>(random.next() % 3),
                triangle.end());
    object.mesh.triangles[place[t]] = triangle;
  }
  return object;
}

/// A vertex per corner in random order, then welded as importing does it.
Changed duplicatedVertices(Changed object, Random& random) {
  TriangleMesh soup;
  for (std::size_t t = 0; t < object.mesh.triangles.size(); ++t) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    soup.triangles.push_back({first, first + 1, first + 2});
    for (std::size_t k = 0; k < 3; ++k) soup.vertices.push_back(object.mesh.corner(t, k));
  }
  object.mesh =
      spheretree::io::weldVertices(reorderedVertices({std::move(soup), object.length}, random).mesh);
  return object;
}

struct Change {
  const char* name;
  Changed (*make)(Changed, Random&);
};

constexpr std::array kChanges{Change{"translation", translated},
                              Change{"scale", scaled},
                              Change{"rotation", rotated},
                              Change{"similarity", similar},
                              Change{"vertex order", reorderedVertices},
                              Change{"triangle order", reorderedTriangles},
                              Change{"duplicate vertices", duplicatedVertices}};

/// The largest difference from the untouched mesh, over the runs and levels.
struct Spread {
  double worst = 0;          ///< of the worst overhang, fraction of the diagonal
  double worstRelative = 0;  ///< the same, fraction of the worst overhang
  double meanRelative = 0;
  double bracket = 0;           ///< the widest of a worst overhang, fraction of the diagonal
  std::size_t otherTrees = 0;   ///< runs that gave other bytes
  std::size_t otherLevels = 0;  ///< runs that gave another number of levels
};

void add(Spread& spread, const Errors& errors, const Errors& expected) {
  spread.bracket = std::max({spread.bracket, errors.bracket, expected.bracket});
  if (errors.hash != expected.hash) ++spread.otherTrees;
  if (errors.worst.size() != expected.worst.size()) ++spread.otherLevels;
  for (std::size_t k = 0; k < std::min(errors.worst.size(), expected.worst.size()); ++k) {
    const double difference = std::abs(errors.worst[k] - expected.worst[k]);
    spread.worst = std::max(spread.worst, difference);
    spread.worstRelative = std::max(spread.worstRelative, difference / expected.worst[k]);
    spread.meanRelative =
        std::max(spread.meanRelative, std::abs(errors.mean[k] - expected.mean[k]) / expected.mean[k]);
  }
}

/// An empty list means all.
bool isWanted(const std::vector<std::string>& list, std::string_view name) {
  return list.empty() || std::find(list.begin(), list.end(), name) != list.end();
}

void study(const NamedMesh& object, const std::string& builder, std::uint64_t runs,
           const std::vector<std::string>& changes) {
  const double length = medial::diagonalOf(object.mesh);
  const Errors expected = errorsOf(object.mesh, builder, length);
  for (const Change& change : kChanges) {
    if (!isWanted(changes, change.name)) continue;
    Spread spread;
    for (std::uint64_t run = 0; run < runs; ++run) {
      Random random(2026, run);
      Changed changed = change.make({object.mesh, length}, random);
      add(spread, errorsOf(std::move(changed.mesh), builder, changed.length), expected);
    }
    std::printf("%s,%zu,%s,%s,%llu,%.3g,%.3g,%.3g,%.3g,%zu,%zu\n", object.name.c_str(),
                object.mesh.triangles.size(), builder.c_str(), change.name,
                static_cast<unsigned long long>(runs), spread.worst, spread.worstRelative,
                spread.meanRelative, spread.bracket, spread.otherTrees, spread.otherLevels);
    std::fflush(stdout);
  }
}

int run(int argc, char** argv) {
  std::uint64_t runs = 25;
  std::vector<std::string> names;
  std::vector<std::string> chosen;
  std::vector<std::string> changes;
  CLI::App app("Prints how far errors change when the same object comes in another way");
  app.add_option("--runs", runs, "Runs per model, builder and change")->capture_default_str();
  app.add_option("--builders", names, "Only these")->delimiter(',');
  app.add_option("--models", chosen, "Only these")->delimiter(',');
  app.add_option("--changes", changes, "Only these")->delimiter(',');
  CLI11_PARSE(app, argc, argv);
  std::printf("# settings: quality fast, 3 levels, branch 8, seed 1\n");
  std::printf(
      "model,triangles,builder,change,runs,worst_in_diagonals,worst_relative,mean_relative,bracket,other_"
      "trees,other_levels\n");
  for (const NamedMesh& object : studied()) {
    for (const builders::CatalogueEntry& builder : builders::catalogue()) {
      if (isWanted(chosen, object.name) && isWanted(names, builder.name))
        study(object, std::string(builder.name), runs, changes);
    }
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "invariance_bench: %s\n", failure.what());
    return 1;
  }
}
