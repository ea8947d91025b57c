// SPDX-License-Identifier: GPL-3.0-or-later
#include "case_checks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <spheretree/distance_query.hpp>
#include <spheretree/pair_query.hpp>
#include <spheretree/sph.hpp>

#include "builders/build_tree.hpp"
#include "io/mesh_repair.hpp"
#include "medial/random.hpp"
#include "tests/support/naive.hpp"
#include "tests/support/solids.hpp"
#include "tests/support/trees.hpp"

namespace spheretree::soak {
namespace {

using builders::BuildResult;
using Eigen::Vector3d;
using medial::Random;
using medial::TriangleMesh;
namespace naive = test::naive;

// Work of the naive checks per case: about as much as the build itself.
constexpr std::size_t kMostChainPieces = 100'000;
constexpr std::size_t kMostCubes = 1500;
constexpr std::size_t kBallsBracketed = 3;
constexpr std::size_t kPoses = 4;
constexpr std::size_t kMostTrianglePairs = 40'000;
constexpr int kSolidPoints = 100;

/// Of coordinates that are rounded where they are compared.
constexpr double kRounding = 1e-9;

std::string levelFlaw(const BuildResult& built, const builders::BuildSettings& settings) {
  if (built.tree.levelCount() > settings.levels) return "more levels than asked for";
  if (built.tree.maxChildren() > settings.branch) return "more children than the branching factor";
  if (built.report.levels.size() != built.tree.levelCount())
    return "the report has other levels than the tree";
  for (const builders::LevelReport& level : built.report.levels) {
    const builders::LevelMetrics& m = level.metrics;
    if (!m.surface.certified) return "a level is not certified";
    if (!(m.overhangWorst.lower <= m.overhangWorst.upper))
      return "an overhang is bracketed the wrong way round";
    if (!std::isfinite(m.overhangWorst.upper)) return "an overhang is not finite";
    if (!(m.volume > 0)) return "a level has no volume";
    if (settings.cover == builders::Cover::Solid && !m.solid.certified) return "the solid is not certified";
  }
  return "";
}

std::string coverFlaw(const TriangleMesh& mesh, const BuildResult& built, Verdict& verdict) {
  switch (naive::chainsCover(mesh, built.tree, kMostChainPieces)) {
    case naive::Verdict::Refuted:
      return "a point of the surface is in no chain";
    case naive::Verdict::Undecided:
      ++verdict.undecided;
      break;
    case naive::Verdict::Proved:
      break;
  }
  return "";
}

std::string solidFlaw(const medial::Surface& surface, const BuildResult& built, Random& random) {
  const std::size_t below = built.tree.levelCount() - 1;
  for (int i = 0; i < kSolidPoints; ++i) {
    Vector3d p = surface.bounds().min();
    for (int k = 0; k < 3; ++k) p[k] += random.uniform() * surface.bounds().sizes()[k];
    if (std::lround(naive::windingNumber(surface.mesh(), p)) < 1) continue;
    if (!naive::chainHolds(built.tree, built.tree.root(), std::span(&p, 1), below))
      return "a point of the solid is in no chain";
  }
  return "";
}

std::string overhangFlaw(const medial::Surface& surface, const BuildResult& built, Random& random,
                         Verdict& verdict) {
  const double noise = kRounding * surface.diagonal();
  for (std::size_t k = 0; k < kBallsBracketed; ++k) {
    const std::size_t depth = random.next() % built.tree.levelCount();
    const builders::LevelMetrics& m = built.report.levels[depth].metrics;
    // The ball that sets the level's figure, and others.
    const std::size_t ball = k == 0 ? m.worstBall : random.next() % m.ballOverhang.size();
    const naive::Bracket bracket =
        naive::overhang(surface.mesh(), naive::ballOf(built.tree.level(depth)[ball].ball),
                        1e-3 * surface.diagonal(), kMostCubes);
    ++verdict.brackets;
    if (bracket.lower > m.ballOverhang[ball] + noise) return "a ball sticks out farther than certified";
    if (bracket.lower > m.overhangWorst.upper + noise) return "a level sticks out farther than certified";
    if (k == 0 && m.overhangWorst.lower > bracket.upper + noise)
      return "the certified lower bound is above what is possible";
  }
  return "";
}

std::string textFlaw(const BuildResult& built, const builders::BuildSettings& settings) {
  const Result<std::string> text = formatSph(built.tree, settings.branch);
  if (!text) return "the tree cannot be written: " + text.error().message;
  const Result<SphFile> file = parseSph(*text);
  if (!file) return "the file cannot be read: " + file.error().message;
  return test::sameBits(file->tree, built.tree) ? "" : "the file holds another tree";
}

std::vector<float> standOffsOf(const builders::BuildReport& report) {
  std::vector<float> standOffs;
  for (const builders::LevelReport& level : report.levels) {
    standOffs.push_back(std::nextafter(static_cast<float>(level.metrics.overhangWorst.upper),
                                       std::numeric_limits<float>::infinity()));
  }
  return standOffs;
}

/// A pose in float and the same one in double.
struct Placed {
  Pose pose;
  TriangleMesh mesh;
};

Placed placed(const TriangleMesh& mesh, const Vector3d& middle, double length, Random& random) {
  const Eigen::Quaterniond q(test::randomRotation(random));
  Placed result{{}, mesh};
  result.pose.rotation = {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()),
                          static_cast<float>(q.w())};
  result.pose.scale = static_cast<float>(random.uniform(0.5, 2));
  const Rotation& r = result.pose.rotation;
  const Eigen::Matrix3d turn = Eigen::Quaterniond(static_cast<double>(r.w), static_cast<double>(r.x),
                                                  static_cast<double>(r.y), static_cast<double>(r.z))
                                   .normalized()
                                   .toRotationMatrix();
  const double scale = static_cast<double>(result.pose.scale);
  // The middle of the body comes to lie near the origin: at random places bodies hardly ever meet.
  Vector3d shift = -scale * (turn * middle);
  for (int k = 0; k < 3; ++k) shift[k] += random.uniform(-0.5, 0.5) * length;
  result.pose.translation = {static_cast<float>(shift.x()), static_cast<float>(shift.y()),
                             static_cast<float>(shift.z())};
  const Vector3d exact(static_cast<double>(result.pose.translation.x),
                       static_cast<double>(result.pose.translation.y),
                       static_cast<double>(result.pose.translation.z));
  for (Vector3d& v : result.mesh.vertices) v = scale * (turn * v) + exact;
  return result;
}

std::string poseFlaw(const QueryTree& tree, const Placed& a, const Placed& b, double length,
                     Verdict& verdict) {
  const double apart = naive::distance(a.mesh, b.mesh);
  const double solids = apart > 0 ? naive::distanceOfSolids(a.mesh, b.mesh) : 0;
  const double noise = kRounding * length;
  ++verdict.poses;
  verdict.meetings += apart == 0 ? 1U : 0U;
  PairQuery query(tree, tree);
  for (std::uint32_t level = 0; level < tree.levelCount(); ++level) {
    query.restart(a.pose, b.pose);
    const Answer answer = query.advance({.deepestLevel = level});
    if (answer == Answer::Undecided) return "a query without a budget is undecided";
    if (apart == 0 && answer == Answer::Disjoint) return "a query missed a collision";
    if (answer == Answer::Overlapping && solids > static_cast<double>(query.slackBound()) + noise)
      return "a collision is claimed where the solids are farther apart than the slack";
  }
  const DistanceBounds bounds = distanceBetween(tree, a.pose, tree, b.pose);
  if (static_cast<double>(bounds.lower) > apart + noise) return "the distance is below its lower bound";
  if (static_cast<double>(bounds.upper) < solids - noise) return "the distance is above its upper bound";
  return "";
}

std::string queryFlaw(const medial::Surface& surface, const BuildResult& built, Random& random,
                      Verdict& verdict) {
  const Result<QueryTree> tree = QueryTree::create(built.tree, standOffsOf(built.report));
  if (!tree) return "the tree cannot be queried: " + tree.error().message;
  const TriangleMesh& mesh = surface.mesh();
  if (mesh.triangles.size() * mesh.triangles.size() > kMostTrianglePairs) return "";
  for (std::size_t i = 0; i < kPoses; ++i) {
    const Placed a = placed(mesh, surface.bounds().center(), surface.diagonal(), random);
    const Placed b = placed(mesh, surface.bounds().center(), surface.diagonal(), random);
    if (std::string flaw = poseFlaw(*tree, a, b, surface.diagonal(), verdict); !flaw.empty()) return flaw;
  }
  return "";
}

/// The first flaw of a tree that was built.
std::string treeFlaw(const medial::Surface& surface, const BuildResult& built, const Case& given,
                     Random& random, Verdict& verdict) {
  std::string flaw = levelFlaw(built, given.settings);
  if (flaw.empty()) flaw = coverFlaw(surface.mesh(), built, verdict);
  if (flaw.empty() && given.settings.cover == builders::Cover::Solid)
    flaw = solidFlaw(surface, built, random);
  if (flaw.empty()) flaw = overhangFlaw(surface, built, random, verdict);
  if (flaw.empty()) flaw = textFlaw(built, given.settings);
  if (flaw.empty()) flaw = queryFlaw(surface, built, random, verdict);
  return flaw;
}

}  // namespace

Verdict check(const Case& given) {
  Verdict verdict;
  TriangleMesh mesh = given.mesh;
  if (given.mended) {
    Result<io::RepairedMesh> repaired = io::repairMesh(mesh, io::Repair::Fill);
    if (!repaired) {
      verdict.refusal = repaired.error().message;
      return verdict;
    }
    mesh = std::move(repaired->mesh);
  }
  const Result<medial::Surface> surface = medial::Surface::create(std::move(mesh));
  if (!surface) {
    verdict.refusal = surface.error().message;
    return verdict;
  }
  const Result<BuildResult> built = builders::buildTree(*surface, given.settings, medial::Context(1));
  if (!built) {
    verdict.flaw = "no tree: " + built.error().message;
    return verdict;
  }
  Random random(given.seed, 1);
  verdict.flaw = treeFlaw(*surface, *built, given, random, verdict);
  return verdict;
}

}  // namespace spheretree::soak
