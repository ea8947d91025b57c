// SPDX-License-Identifier: GPL-3.0-or-later
//
// The narrow phase against exact triangle intersection, in random poses of pairs of models, rotations
// included: never disjoint when the surfaces meet, at any level and with any budget, and never overlapping
// when the solids are farther apart than the query says.
//
// A few hundred poses by default; SPHERETREE_POSES sets how many in all.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <list>
#include <memory>
#include <string>
#include <vector>

#include <spheretree/distance_query.hpp>
#include <spheretree/pair_query.hpp>

#include "builders/build_tree.hpp"
#include "tests/support/solids.hpp"
#include "tests/support/tally.hpp"
#include "tests/support/trees.hpp"

namespace spheretree {
namespace {

using Eigen::Vector3d;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

constexpr std::size_t kDefaultPoses = 300;
constexpr std::uint64_t kSeed = 20261122;

Kernel::Point_3 point(const Vector3d& p) {
  return {p.x(), p.y(), p.z()};
}

/// A model with its tree, ready for both kinds of test.
struct Subject {
  std::string name;
  medial::Surface surface;
  QueryTree tree;
  Triangles triangles;
  std::unique_ptr<Tree> exact;  // refers to triangles
  double radius = 0;            // of the ball around the origin that holds it
};

std::vector<float> standOffsOf(const builders::BuildReport& report) {
  std::vector<float> standOffs;
  for (const builders::LevelReport& level : report.levels) {
    standOffs.push_back(std::nextafter(static_cast<float>(level.metrics.overhangWorst.upper),
                                       std::numeric_limits<float>::infinity()));
  }
  return standOffs;
}

void addSubject(std::list<Subject>& subjects, const std::string& model, const std::string& builder) {
  for (const models::Model& candidate : models::allModels()) {
    if (candidate.name != model) continue;
    Result<medial::Surface> surface = medial::Surface::create(candidate.make());
    ASSERT_TRUE(surface.ok()) << model;
    const builders::BuildSettings settings = test::quickSettings(builder, 4);
    const Result<builders::BuildResult> built = builders::buildTree(*surface, settings, medial::Context(2));
    ASSERT_TRUE(built.ok()) << built.error().message;
    Result<QueryTree> tree = QueryTree::create(built.value().tree, standOffsOf(built.value().report));
    ASSERT_TRUE(tree.ok()) << tree.error().message;
    subjects.push_back(
        {model + " by " + builder, std::move(surface).value(), std::move(tree).value(), {}, {}, 0});
    Subject& subject = subjects.back();
    const medial::TriangleMesh& mesh = subject.surface.mesh();
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      subject.triangles.push_back(
          {point(mesh.corner(t, 0)), point(mesh.corner(t, 1)), point(mesh.corner(t, 2))});
    subject.exact = std::make_unique<Tree>(subject.triangles.cbegin(), subject.triangles.cend());
    subject.exact->build();
    for (const Vector3d& vertex : mesh.vertices) subject.radius = std::max(subject.radius, vertex.norm());
    return;
  }
  FAIL() << "no model called " << model;
}

/// A pose in double that the floats of a Pose mean exactly, but for the length of the quaternion.
struct Motion {
  Eigen::Matrix3d turn;
  Vector3d shift;
  double scale = 1;

  explicit Motion(const Pose& pose)
      : turn(Eigen::Quaterniond(static_cast<double>(pose.rotation.w), static_cast<double>(pose.rotation.x),
                                static_cast<double>(pose.rotation.y), static_cast<double>(pose.rotation.z))
                 .normalized()
                 .toRotationMatrix()),
        shift(static_cast<double>(pose.translation.x), static_cast<double>(pose.translation.y),
              static_cast<double>(pose.translation.z)),
        scale(static_cast<double>(pose.scale)) {}

  [[nodiscard]] Vector3d there(const Vector3d& p) const { return turn * (scale * p) + shift; }
  [[nodiscard]] Vector3d back(const Vector3d& p) const { return turn.transpose() * (p - shift) / scale; }
};

Pose randomPose(medial::Random& random) {
  const Eigen::Quaterniond q(test::randomRotation(random));
  Pose pose;
  pose.rotation = {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()),
                   static_cast<float>(q.w())};
  return pose;
}

/// Everything in the frame of B.
class Judge {
 public:
  Judge(const Subject& a, const Pose& poseA, const Subject& b, const Pose& poseB)
      : a_(a), b_(b), motionA_(poseA), motionB_(poseB) {
    for (const Vector3d& vertex : a.surface.mesh().vertices)
      vertices_.push_back(motionB_.back(motionA_.there(vertex)));
  }

  [[nodiscard]] bool surfacesMeet() const {
    for (const auto& t : a_.surface.mesh().triangles) {
      const Kernel::Triangle_3 triangle(point(vertices_[t[0]]), point(vertices_[t[1]]),
                                        point(vertices_[t[2]]));
      if (b_.exact->do_intersect(triangle)) return true;
    }
    return false;
  }

  /// Of the solids, world units; only valid when the surfaces do not meet. The nearest points of two
  /// triangles that do not meet are a corner and a point of the other, or lie on two edges; edges are looked
  /// at only when corners are farther apart than `enough`.
  [[nodiscard]] double distance(double enough) const {
    if (b_.surface.inside(vertices_.front()) ||
        a_.surface.inside(motionA_.back(motionB_.there(b_.surface.mesh().vertices.front()))))
      return 0;
    double least = std::numeric_limits<double>::infinity();
    for (const Vector3d& vertex : vertices_)
      least = std::min(least, b_.surface.closestPoint(vertex).distance * motionB_.scale);
    for (const Vector3d& vertex : b_.surface.mesh().vertices) {
      const Vector3d inA = motionA_.back(motionB_.there(vertex));
      least = std::min(least, a_.surface.closestPoint(inA).distance * motionA_.scale);
    }
    return least <= enough ? least : std::min(least, distanceOfEdges());
  }

 private:
  [[nodiscard]] double distanceOfEdges() const {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& s : a_.surface.mesh().triangles) {
      for (const auto& t : b_.surface.mesh().triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
          const Kernel::Segment_3 x(point(vertices_[s[i]]), point(vertices_[s[(i + 1) % 3]]));
          for (std::size_t j = 0; j < 3; ++j) {
            const Kernel::Segment_3 y(point(b_.surface.mesh().vertices[t[j]]),
                                      point(b_.surface.mesh().vertices[t[(j + 1) % 3]]));
            least = std::min(least, CGAL::squared_distance(x, y));
          }
        }
      }
    }
    return std::sqrt(least) * motionB_.scale;
  }

  const Subject& a_;
  const Subject& b_;
  Motion motionA_;
  Motion motionB_;
  std::vector<Vector3d> vertices_;  // of A
};

struct Tally {
  std::size_t meets = 0;
  std::size_t disjoint = 0;   // proved by the deepest level
  std::size_t falseHits = 0;  // at the deepest level
};

void checkPose(const Subject& a, const Subject& b, medial::Random& random, Tally& tally) {
  Pose poseA = randomPose(random);
  Pose poseB = randomPose(random);
  poseA.scale = static_cast<float>(random.uniform(0.7, 1.4));
  const double reach = static_cast<double>(poseA.scale) * a.radius + b.radius;
  const Vector3d away = test::randomRotation(random).col(0) * random.uniform(0, reach);
  const Vector3d place = test::randomRotation(random).col(1) * random.uniform(0, 100);
  poseB.translation = {static_cast<float>(place.x()), static_cast<float>(place.y()),
                       static_cast<float>(place.z())};
  poseA.translation = poseB.translation + Vec3{static_cast<float>(away.x()), static_cast<float>(away.y()),
                                               static_cast<float>(away.z())};
  const Judge judge(a, poseA, b, poseB);
  const bool meet = judge.surfacesMeet();
  tally.meets += meet ? 1U : 0U;
  PairQuery query(a.tree, b.tree);
  const auto levels = static_cast<std::uint32_t>(std::max(a.tree.levelCount(), b.tree.levelCount()));
  Answer last = Answer::Undecided;
  for (std::uint32_t level = 0; level < levels; ++level) {
    query.restart(poseA, poseB);
    last = query.advance({.deepestLevel = level});
    ASSERT_NE(last, Answer::Undecided);
    if (meet) {
      ASSERT_EQ(last, Answer::Overlapping) << "level " << level;
    } else if (last == Answer::Overlapping) {
      const auto bound = static_cast<double>(query.slackBound());
      ASSERT_LE(judge.distance(bound), bound) << "level " << level;
    }
  }
  tally.disjoint += last == Answer::Disjoint ? 1U : 0U;
  tally.falseHits += !meet && last == Answer::Overlapping ? 1U : 0U;
  query.restart(poseA, poseB);
  const std::uint64_t budget = 1 + random.next() % 2000;
  const Answer limited = query.advance({.sphereTests = budget});
  ASSERT_FALSE(meet && limited == Answer::Disjoint) << "budget " << budget;
  const DistanceBounds bounds = distanceBetween(a.tree, poseA, b.tree, poseB);
  if (meet) {
    ASSERT_EQ(bounds.lower, 0);
  } else {
    const auto upper = static_cast<double>(bounds.upper);
    ASSERT_LE(judge.distance(upper), upper);
    if (bounds.lower > 0) {
      ASSERT_GE(judge.distance(0), static_cast<double>(bounds.lower));
    }
  }
}

std::size_t wantedPoses() {
  return test::countFrom("SPHERETREE_POSES", kDefaultPoses);
}

TEST(NarrowPhaseProperty, NeverMissesAndKeepsItsBound) {
  std::list<Subject> subjects;
  addSubject(subjects, "gear", "hubbard");
  addSubject(subjects, "torus", "octree");
  addSubject(subjects, "u_block", "hubbard");
  addSubject(subjects, "box", "octree");
  addSubject(subjects, "comb", "hubbard");
  ASSERT_EQ(subjects.size(), 5U);
  const std::size_t pairs = subjects.size() * (subjects.size() + 1) / 2;
  const std::size_t each = (wantedPoses() + pairs - 1) / pairs;
  Tally tally;
  std::uint64_t stream = 0;
  for (auto a = subjects.begin(); a != subjects.end(); ++a) {
    for (auto b = a; b != subjects.end(); ++b, ++stream) {
      medial::Random random(kSeed, stream);
      for (std::size_t i = 0; i < each; ++i) {
        SCOPED_TRACE(a->name + " and " + b->name + ", seed " + std::to_string(kSeed) + ", pose " +
                     std::to_string(i));
        checkPose(*a, *b, random, tally);
        if (HasFatalFailure()) return;
      }
    }
  }
  RecordProperty("poses", std::to_string(each * pairs));
  RecordProperty("meets", std::to_string(tally.meets));
  RecordProperty("false_hits", std::to_string(tally.falseHits));
  test::publish({"runtime queries and distance bounds", "exact triangle tests and distances of meshes", kSeed,
                 pairs, each * pairs, HasFailure() ? 1U : 0U,
                 std::to_string(tally.meets) + " poses meet; " + std::to_string(tally.disjoint) +
                     " are proved disjoint"});
  // All three outcomes must have been tried.
  EXPECT_GT(tally.meets, each * pairs / 10);
  EXPECT_GT(tally.disjoint, each * pairs / 20);
  EXPECT_GT(tally.falseHits, 0U);
}

}  // namespace
}  // namespace spheretree
