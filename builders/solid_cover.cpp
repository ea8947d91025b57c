// SPDX-License-Identifier: GPL-3.0-or-later
//
// Proofs that balls cover a solid, and how much is missing when they do not.
//
// Reference: docs/error-metrics.md.
//
// Summary: an octree over the solid. The solid inside a cube lies in the convex hull of solidPoints(), so a
// ball that holds those points holds it. Cubes that no ball holds are split, all of one size before the next,
// until none is left, or the volume still in doubt is small and some point of the solid is known to be
// outside, or the budget is spent. Cubes inside the solid that no ball meets are the volume that is missing
// for certain.

#include "builders/solid_cover.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "builders/ball_index.hpp"
#include "builders/chains.hpp"
#include "builders/holds.hpp"
#include "builders/solid_gap.hpp"
#include "medial/parallel.hpp"
#include "medial/solid_cells.hpp"

namespace spheretree::builders {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using medial::Ball;
using medial::Context;
using medial::Surface;

/// Cubes examined before the bracket is handed over as it is (about a second of one processor), and before
/// proving gives way to measuring.
constexpr std::size_t kMaxCubes = 300'000;
constexpr std::size_t kMaxProofCubes = 150'000;
/// When the bracket is already as narrow as wanted and no uncovered point is known, the cover may be complete
/// and is worth proving: this many times the cubes spent so far.
constexpr std::size_t kPatience = 4;
/// Chain proofs give up on cubes whose side is below this fraction of the diagonal (see cover.cpp).
constexpr double kSmallestPiece = 1e-9;
/// Chain proofs run in parallel over the cubes of this depth.
constexpr std::uint32_t kSharedDepth = 3;

/// The triangles of `candidates` that may meet the cube.
std::vector<std::uint32_t> trianglesIn(const Surface& surface, const AlignedBox3d& cube,
                                       std::span<const std::uint32_t> candidates) {
  std::vector<std::uint32_t> result;
  for (const std::uint32_t t : candidates) {
    AlignedBox3d box(surface.mesh().corner(t, 0));
    box.extend(surface.mesh().corner(t, 1)).extend(surface.mesh().corner(t, 2));
    if (cube.intersects(box)) result.push_back(t);
  }
  return result;
}

bool holdsAll(const Ball& ball, std::span<const Vector3d> points) {
  return std::all_of(points.begin(), points.end(), [&](const Vector3d& p) { return holds(ball, p); });
}

/// What a cube knows of its neighbourhood; shared by its octants, which narrow it down when their turn comes.
struct Surroundings {
  std::vector<std::uint32_t> balls;      ///< that meet the cube
  std::vector<std::uint32_t> triangles;  ///< that may meet it
  bool inner = false;                    ///< no surface in it, all solid
};

/// A cube on its way through measureSolidCover.
struct Candidate {
  AlignedBox3d cube;
  std::shared_ptr<const Surroundings> around;  ///< of the cube it is an octant of
};

/// What looking at a cube gave.
struct Finding {
  enum class Kind : std::uint8_t {
    Settled,   ///< covered, or no solid in it
    Measured,  ///< what is missing in it is known
    Doubtful   ///< to be split
  };
  Kind kind = Kind::Settled;
  Bounds missing;                              ///< volume, if measured
  bool refuted = false;                        ///< holds a point of the solid that is in no ball
  std::shared_ptr<const Surroundings> around;  ///< of the cube itself, if doubtful
};

enum class Goal : std::uint8_t { Prove, Measure };

class SolidProof {
 public:
  SolidProof(const Surface& surface, std::span<const Ball> balls) : surface_(surface), balls_(balls) {}

  [[nodiscard]] Candidate root() const {
    const AlignedBox3d cube = medial::solidRootCube(surface_);
    Surroundings all{BallIndex(balls_).meeting(cube), surface_.trianglesNear(cube), false};
    return {cube, std::make_shared<const Surroundings>(std::move(all))};
  }

  /// `goal` says whether a proof is still hoped for; measuring is of no use to it.
  [[nodiscard]] Finding examine(const Candidate& candidate, Goal goal) const {
    const AlignedBox3d& cube = candidate.cube;
    Surroundings here;
    here.inner = candidate.around->inner;
    for (const std::uint32_t i : candidate.around->balls) {
      if (meets(balls_[i], cube)) here.balls.push_back(i);
    }
    const auto corners = medial::cornersOf(cube);
    if (held(here, corners)) return {};
    std::vector<Vector3d> onSurface;
    if (!here.inner) {
      here.triangles = trianglesIn(surface_, cube, candidate.around->triangles);
      onSurface = medial::surfacePoints(surface_, cube, here.triangles);
      here.inner = onSurface.empty();
      if (here.inner && !surface_.inside(cube.center())) return {};
      if (!here.inner && heldWithCorners(here, onSurface, corners)) return {};
    }
    if (here.inner) here.triangles.clear();
    if (goal == Goal::Measure) {
      std::vector<Ball> balls;
      for (const std::uint32_t i : here.balls) balls.push_back(balls_[i]);
      if (const auto missing = solidOutside(surface_, cube, here.triangles, balls)) {
        return {Finding::Kind::Measured, *missing, true, {}};
      }
    }
    const bool refuted = here.inner ? someOutside(here, corners) : someOutside(here, onSurface);
    return {Finding::Kind::Doubtful, {}, refuted, std::make_shared<const Surroundings>(std::move(here))};
  }

 private:
  [[nodiscard]] bool held(const Surroundings& here, std::span<const Vector3d> points) const {
    return std::any_of(here.balls.begin(), here.balls.end(),
                       [&](std::uint32_t i) { return holdsAll(balls_[i], points); });
  }

  /// Whether one ball holds the solidPoints(): whether corners are solid is asked only where it matters.
  [[nodiscard]] bool heldWithCorners(const Surroundings& here, std::span<const Vector3d> onSurface,
                                     std::span<const Vector3d> corners) const {
    std::array<std::optional<bool>, 8> solid;
    for (const std::uint32_t i : here.balls) {
      if (!holdsAll(balls_[i], onSurface)) continue;
      bool all = true;
      for (std::size_t k = 0; k < 8 && all; ++k) {
        if (holds(balls_[i], corners[k])) continue;
        if (!solid[k]) solid[k] = surface_.inside(corners[k]);
        all = !*solid[k];
      }
      if (all) return true;
    }
    return false;
  }

  [[nodiscard]] bool someOutside(const Surroundings& here, std::span<const Vector3d> points) const {
    return std::any_of(points.begin(), points.end(), [&](const Vector3d& p) {
      return std::none_of(here.balls.begin(), here.balls.end(),
                          [&](std::uint32_t i) { return holds(balls_[i], p); });
    });
  }

  const Surface& surface_;
  std::span<const Ball> balls_;
};

/// A cube on its way through proveSolidChains.
struct Cube {
  AlignedBox3d box;
  bool inner = false;                    ///< no surface in it, all solid
  std::vector<std::uint32_t> triangles;  ///< that may meet it; none if inner

  [[nodiscard]] Cube octant(const Surface& surface, const AlignedBox3d& octantBox) const {
    return {octantBox, inner, trianglesIn(surface, octantBox, triangles)};
  }
};

/// The chain proof below one cube.
class CubeChains {
 public:
  CubeChains(const Surface& surface, const Chains& chains) : surface_(surface), chains_(chains) {}

  bool prove(const Cube& given, std::span<const Chains::Link> links, std::uint32_t depth) {
    ++effort_.cells;
    effort_.deepest = std::max(effort_.deepest, depth);
    using Verdict = Chains::Verdict;
    const auto corners = medial::cornersOf(given.box);
    if (chains_.judge(links, corners).verdict == Verdict::Proved) return true;
    std::vector<Vector3d> points;
    if (!given.inner) points = medial::surfacePoints(surface_, given.box, given.triangles);
    const bool inner = points.empty();
    if (inner && !given.inner && !surface_.inside(given.box.center())) return true;
    Chains::Judgement judgement = chains_.judge(links, inner ? std::span<const Vector3d>(corners) : points);
    if (!inner && judgement.verdict == Verdict::Proved) {
      judgement = chains_.judge(links, medial::solidPoints(surface_, given.box, given.triangles));
    }
    if (judgement.verdict == Verdict::Proved) return true;
    const Cube cube = inner ? Cube{given.box, true, {}} : given;
    failedLevel_ = judgement.level;
    const double smallest = kSmallestPiece * surface_.diagonal();
    if (judgement.verdict == Verdict::Refuted || cube.box.sizes().x() <= smallest) return false;
    for (const AlignedBox3d& box : medial::octants(cube.box)) {
      if (!prove(cube.octant(surface_, box), chains_.narrowed(links, box), depth + 1)) return false;
    }
    return true;
  }

  [[nodiscard]] const ProofEffort& effort() const { return effort_; }
  [[nodiscard]] std::uint32_t failedLevel() const { return failedLevel_; }

 private:
  const Surface& surface_;
  const Chains& chains_;
  ProofEffort effort_;
  std::uint32_t failedLevel_ = 0;
};

}  // namespace

SolidCover measureSolidCover(const Surface& surface, std::span<const Ball> balls, double wantedGap,
                             const Context& context) {
  const SolidProof proof(surface, balls);
  const double total = surface.volume();
  SolidCover cover;
  std::vector<Candidate> open{proof.root()};
  Bounds missing;
  double doubtful = open.front().cube.volume();
  auto goal = Goal::Prove;
  bool measured = false;
  std::size_t patience = kMaxProofCubes;
  for (std::uint32_t depth = 0; !open.empty() && cover.effort.cells + open.size() <= kMaxCubes; ++depth) {
    const bool narrow = missing.upper - missing.lower + doubtful <= wantedGap * total;
    if (narrow) patience = std::min(patience, kPatience * cover.effort.cells);
    if (cover.effort.cells + open.size() > patience) goal = Goal::Measure;
    if (narrow && goal == Goal::Measure) break;
    std::vector<Finding> findings(open.size());
    medial::parallelFor(open.size(), context,
                        [&](std::size_t i) { findings[i] = proof.examine(open[i], goal); });
    cover.effort.cells += open.size();
    cover.effort.deepest = depth;
    const double volume = open.front().cube.volume();
    std::vector<Candidate> next;
    doubtful = 0;
    for (std::size_t i = 0; i < open.size(); ++i) {
      if (findings[i].refuted) goal = Goal::Measure;
      measured = measured || findings[i].kind == Finding::Kind::Measured;
      missing.lower += findings[i].missing.lower;
      missing.upper += findings[i].missing.upper;
      if (findings[i].kind != Finding::Kind::Doubtful) continue;
      doubtful += volume;
      for (const AlignedBox3d& octant : medial::octants(open[i].cube))
        next.push_back({octant, findings[i].around});
    }
    open = std::move(next);
  }
  cover.certified = open.empty() && !measured;
  if (cover.certified) return cover;
  cover.uncovered.lower = std::min(1.0, missing.lower / total);
  cover.uncovered.upper = std::min(1.0, (missing.upper + doubtful) / total);
  return cover;
}

ChainProof proveSolidChains(const Surface& surface, const SphereTree& tree, const Context& context) {
  struct Slot {
    bool proved = false;
    std::uint32_t failedLevel = 0;
    ProofEffort effort;
  };
  const Chains chains(tree);
  const AlignedBox3d root = medial::solidRootCube(surface);
  std::vector<Cube> cubes{{root, false, surface.trianglesNear(root)}};
  for (std::uint32_t depth = 0; depth < kSharedDepth; ++depth) {
    std::vector<Cube> finer;
    for (const Cube& cube : cubes) {
      for (const AlignedBox3d& box : medial::octants(cube.box)) finer.push_back(cube.octant(surface, box));
    }
    cubes = std::move(finer);
  }
  std::vector<Slot> slots(cubes.size());
  medial::parallelFor(cubes.size(), context, [&](std::size_t i) {
    CubeChains proof(surface, chains);
    slots[i].proved = proof.prove(cubes[i], chains.linksIn(cubes[i].box), kSharedDepth);
    slots[i].failedLevel = proof.failedLevel();
    slots[i].effort = proof.effort();
  });
  ChainProof result;
  result.certified = true;
  for (const Slot& slot : slots) {
    result.effort.cells += slot.effort.cells;
    result.effort.deepest = std::max(result.effort.deepest, slot.effort.deepest);
    if (slot.proved || !result.certified) continue;
    result.certified = false;
    result.failedLevel = slot.failedLevel;
  }
  return result;
}

}  // namespace spheretree::builders
