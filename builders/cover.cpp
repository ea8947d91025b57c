// SPDX-License-Identifier: GPL-3.0-or-later
//
// Proofs that balls cover a surface, and what is missing when they do not.
//
// Reference: docs/error-metrics.md. The idea in one line: balls are convex, so a ball that holds the corners
// of a piece of a triangle holds the piece; a piece that no ball holds is halved.
//
// Summary: every triangle is taken apart by bisection until each piece is held, or a corner of some piece is
// found that no ball holds (then no subdivision can help), or the pieces become absurdly small. Triangles
// that were not proved get their missing area in closed form (disc_cover.hpp), and the missing distance by
// branch and bound: for a fixed ball the distance to it is convex, so over a piece it is largest at a corner.

#include "builders/cover.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <queue>
#include <vector>

#include <Eigen/Geometry>

#include "builders/ball_index.hpp"
#include "builders/chains.hpp"
#include "builders/disc_cover.hpp"
#include "builders/holds.hpp"
#include "medial/cell_set.hpp"
#include "medial/parallel.hpp"

namespace spheretree::builders {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using medial::Ball;
using medial::Context;
using medial::Surface;
using medial::SurfaceCell;

/// Pieces with no edge longer than this fraction of the diagonal are not halved again: the rounding of their
/// corners is no longer negligible against their size, and a builder's slack is a thousand times larger.
constexpr double kSmallestPiece = 1e-9;
/// Gap at which the largest uncovered distance counts as known: fraction of the value, and of the diagonal.
constexpr double kRelativeGap = 1e-2;
constexpr double kAbsoluteGap = 1e-5;
/// Pieces examined for the largest distance; after that the bracket stays as wide as it is.
constexpr std::size_t kMaxDistancePieces = 200'000;

SurfaceCell cellOf(const Surface& surface, std::size_t triangle) {
  return {surface.mesh().corner(triangle, 0), surface.mesh().corner(triangle, 1),
          surface.mesh().corner(triangle, 2)};
}

AlignedBox3d boxOf(const SurfaceCell& cell) {
  AlignedBox3d box(cell[0]);
  box.extend(cell[1]);
  box.extend(cell[2]);
  return box;
}

void add(ProofEffort& sum, const ProofEffort& part) {
  sum.cells += part.cells;
  sum.deepest = std::max(sum.deepest, part.deepest);
}

/// The proof for one triangle and one set of balls.
class TriangleProof {
 public:
  TriangleProof(std::span<const Ball> balls, double smallestPiece)
      : balls_(balls), smallestPiece_(smallestPiece) {}

  /// Whether the balls hold the cell. `candidates` are those that may meet it.
  bool prove(const SurfaceCell& cell, const std::vector<std::uint32_t>& candidates, std::uint32_t depth = 0) {
    ++effort_.cells;
    effort_.deepest = std::max(effort_.deepest, depth);
    unsigned held = 0;  // by any ball, one bit per corner
    for (const std::uint32_t i : candidates) {
      unsigned here = 0;
      for (unsigned k = 0; k < 3; ++k) here |= holds(balls_[i], cell[k]) ? 1U << k : 0U;
      if (here == kAllCorners) return true;
      held |= here;
    }
    if (held != kAllCorners || medial::longestEdge(cell) <= smallestPiece_) return false;
    const auto [left, right] = medial::bisect(cell);
    return proveHalf(left, candidates, depth + 1) && proveHalf(right, candidates, depth + 1);
  }

  [[nodiscard]] const ProofEffort& effort() const { return effort_; }

 private:
  static constexpr unsigned kAllCorners = 7;

  bool proveHalf(const SurfaceCell& half, const std::vector<std::uint32_t>& candidates, std::uint32_t depth) {
    std::vector<std::uint32_t> fewer;
    fewer.reserve(candidates.size());
    const AlignedBox3d box = boxOf(half);
    for (const std::uint32_t i : candidates) {
      if (meets(balls_[i], box)) fewer.push_back(i);
    }
    return prove(half, fewer, depth);
  }

  std::span<const Ball> balls_;
  double smallestPiece_;
  ProofEffort effort_;
};

/// The largest distance of a point of some triangles to the union of the balls.
class FarthestPoint {
 public:
  FarthestPoint(std::span<const Ball> balls, const BallIndex& index, double diagonal)
      : balls_(balls), index_(index), absoluteGap_(kAbsoluteGap * diagonal) {}

  void add(const SurfaceCell& cell) {
    for (const Vector3d& corner : cell) lower_ = std::max(lower_, index_.nearest(corner).distance);
    push(cell, std::numeric_limits<double>::infinity());
  }

  Bounds bound(const Context& context) {
    while (!open_.empty() && order_ < kMaxDistancePieces && !closeEnough()) {
      context.checkCancelled();
      const Piece piece = open_.top();
      open_.pop();
      const auto [left, right] = medial::bisect(piece.cell);
      push(left, piece.upper);
      push(right, piece.upper);
    }
    return {lower_, open_.empty() ? lower_ : std::max(lower_, open_.top().upper)};
  }

 private:
  struct Piece {
    SurfaceCell cell;
    double upper;
    std::size_t order;
    bool operator<(const Piece& other) const {
      return upper != other.upper ? upper < other.upper : order > other.order;
    }
  };

  [[nodiscard]] bool closeEnough() const {
    const double upper = open_.top().upper;
    return upper - lower_ <= std::max(kRelativeGap * upper, absoluteGap_);
  }

  void push(const SurfaceCell& cell, double upper) {
    const Vector3d middle = (cell[0] + cell[1] + cell[2]) / 3;
    const auto [nearest, distance] = index_.nearest(middle);
    lower_ = std::max(lower_, distance);
    double farthest = -std::numeric_limits<double>::infinity();
    for (const Vector3d& corner : cell) {
      farthest = std::max(farthest, (corner - balls_[nearest].center).norm() - balls_[nearest].radius);
    }
    upper = std::min(upper, farthest);
    if (upper > lower_) open_.push({cell, upper, order_++});
  }

  std::span<const Ball> balls_;
  const BallIndex& index_;
  double absoluteGap_;
  double lower_ = 0;
  std::priority_queue<Piece> open_;
  std::size_t order_ = 0;
};

/// The chain proof for one triangle.
class TriangleChains {
 public:
  TriangleChains(const Chains& chains, double smallestPiece)
      : chains_(chains), smallestPiece_(smallestPiece) {}

  bool prove(const SurfaceCell& cell, std::span<const Chains::Link> links, std::uint32_t depth = 0) {
    ++effort_.cells;
    effort_.deepest = std::max(effort_.deepest, depth);
    const Chains::Judgement judgement = chains_.judge(links, cell);
    if (judgement.verdict == Chains::Verdict::Proved) return true;
    failedLevel_ = judgement.level;
    if (judgement.verdict == Chains::Verdict::Refuted || medial::longestEdge(cell) <= smallestPiece_) {
      return false;
    }
    const auto [left, right] = medial::bisect(cell);
    return prove(left, chains_.narrowed(links, boxOf(left)), depth + 1) &&
           prove(right, chains_.narrowed(links, boxOf(right)), depth + 1);
  }

  [[nodiscard]] const ProofEffort& effort() const { return effort_; }
  [[nodiscard]] std::uint32_t failedLevel() const { return failedLevel_; }

 private:
  const Chains& chains_;
  double smallestPiece_;
  ProofEffort effort_;
  std::uint32_t failedLevel_ = 0;
};

}  // namespace

SurfaceCover measureSurfaceCover(const Surface& surface, std::span<const Ball> balls,
                                 const Context& context) {
  struct Slot {
    bool covered = false;
    Bounds area;
    ProofEffort effort;
  };
  const std::size_t triangles = surface.mesh().triangles.size();
  const BallIndex index(balls);
  std::vector<Slot> slots(triangles);
  medial::parallelFor(triangles, context, [&](std::size_t t) {
    const SurfaceCell cell = cellOf(surface, t);
    const auto candidates = index.meeting(boxOf(cell));
    TriangleProof proof(balls, kSmallestPiece * surface.diagonal());
    slots[t].covered = proof.prove(cell, candidates);
    slots[t].effort = proof.effort();
    if (!slots[t].covered) slots[t].area = areaOutside(cell, balls, candidates);
  });

  SurfaceCover cover;
  cover.certified = true;
  FarthestPoint farthest(balls, index, surface.diagonal());
  for (std::size_t t = 0; t < triangles; ++t) {
    add(cover.effort, slots[t].effort);
    if (slots[t].covered) continue;
    cover.certified = false;
    cover.uncovered.lower += slots[t].area.lower;
    cover.uncovered.upper += slots[t].area.upper;
    if (!balls.empty()) farthest.add(cellOf(surface, t));
  }
  if (cover.certified) return cover;
  cover.uncovered.lower = std::min(1.0, cover.uncovered.lower / surface.area());
  cover.uncovered.upper = std::min(1.0, cover.uncovered.upper / surface.area());
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  cover.distance = balls.empty() ? Bounds{kInfinity, kInfinity} : farthest.bound(context);
  return cover;
}

ChainProof proveSurfaceChains(const Surface& surface, const SphereTree& tree, const Context& context) {
  struct Slot {
    bool proved = false;
    std::uint32_t failedLevel = 0;
    ProofEffort effort;
  };
  const std::size_t triangles = surface.mesh().triangles.size();
  const Chains chains(tree);
  std::vector<Slot> slots(triangles);
  medial::parallelFor(triangles, context, [&](std::size_t t) {
    const SurfaceCell cell = cellOf(surface, t);
    TriangleChains proof(chains, kSmallestPiece * surface.diagonal());
    slots[t].proved = proof.prove(cell, chains.linksIn(boxOf(cell)));
    slots[t].failedLevel = proof.failedLevel();
    slots[t].effort = proof.effort();
  });

  ChainProof result;
  result.certified = true;
  for (std::size_t t = 0; t < triangles; ++t) {
    add(result.effort, slots[t].effort);
    if (slots[t].proved || !result.certified) continue;
    result.certified = false;
    result.failedTriangle = static_cast<std::uint32_t>(t);
    result.failedLevel = slots[t].failedLevel;
  }
  return result;
}

}  // namespace spheretree::builders
