// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far a ball sticks out of the solid, by branch and bound.
//
// Reference: the one-sided Hausdorff distance as in M. Guthe, P. Borodin, R. Klein, "Fast and accurate
// Hausdorff distance calculation between meshes", WSCG 2005, here from a ball and with an octree over the
// ball.
//
// Summary: let out(x) be the distance of x to the surface, negative inside the solid. It is 1-Lipschitz, and
// the wanted value is its maximum over the ball. Cubes are taken best first. The part of the ball in a cube
// cannot stick out farther than
//   out(center) + (largest distance of the part to the ball's centre),
//   out(p) + (half the cube's diagonal), p the projection of the cube's centre onto the ball, and
//   the largest distance of the part to one triangle, which is a convex function and so reaches its maximum
//   over the cube, cut by a tangent plane of the ball, at a corner.
// The last one is what makes it fast: near a smooth maximum it is wrong by the square of the cube's size
// only. Lower bounds are values of out, first at the point behind the surface point nearest to the centre
// (where a ball over a convex part of the surface sticks out most), then after climbing from the best point
// so far.

#include "builders/overhang.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <queue>
#include <vector>

#include <Eigen/Geometry>

#include "medial/triangle_frame.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;
using medial::Ball;
using medial::ClosestPoint;
using medial::Surface;

/// Cubes examined before the bracket is handed over as it is. A typical ball needs about a hundred.
constexpr int kMaxCubes = 20'000;
/// Steps of one climb; the step halves on failure, so this also limits its precision, which the bracket
/// shows.
constexpr int kClimbSteps = 12;
/// Coordinates are rounded; a bound computed from them is raised by this fraction of their size.
constexpr double kRounding = 8 * std::numeric_limits<double>::epsilon();

/// Distance to one triangle, prepared for many points. May be too large by rounding, never much too small.
class TriangleDistance {
 public:
  TriangleDistance(const Surface& surface, std::uint32_t triangle) {
    for (std::size_t k = 0; k < 3; ++k) corner_[k] = surface.mesh().corner(triangle, k);
    for (std::size_t k = 0; k < 3; ++k) {
      edge_[k] = corner_[(k + 1) % 3] - corner_[k];
      inverseSquared_[k] = edge_[k].squaredNorm() > 0 ? 1 / edge_[k].squaredNorm() : 0;
    }
    normal_ = edge_[0].cross(edge_[1]);
    const double length = normal_.norm();
    // The plane of a sliver is noise; its edges are as good.
    constexpr double kSliver = 1e-10;
    const double longest = std::max({edge_[0].squaredNorm(), edge_[1].squaredNorm(), edge_[2].squaredNorm()});
    flat_ = length > kSliver * longest;
    // Below this fraction of it the cross product has lost digits.
    constexpr double kThin = 1e-2;
    if (flat_)
      normal_ =
          length > kThin * longest ? Vector3d(normal_ / length) : medial::TriangleFrame(corner_).normal();
  }

  [[nodiscard]] double operator()(const Vector3d& x) const {
    double best = std::numeric_limits<double>::infinity();
    bool above = flat_;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3d from = x - corner_[k];
      if (flat_ && normal_.cross(edge_[k]).dot(from) >= 0) continue;  // on the inner side of this edge
      above = false;
      const double along = std::clamp(from.dot(edge_[k]) * inverseSquared_[k], 0.0, 1.0);
      best = std::min(best, (from - along * edge_[k]).squaredNorm());
    }
    return above ? std::abs(normal_.dot(x - corner_[0])) : std::sqrt(best);
  }

 private:
  std::array<Vector3d, 3> corner_;
  std::array<Vector3d, 3> edge_;
  std::array<double, 3> inverseSquared_;
  Vector3d normal_;
  bool flat_;
};

struct Cube {
  Vector3d center;
  double half;
  double upper;                ///< nothing in it sticks out farther
  std::uint32_t order;         ///< ties go to the older one
  std::uint32_t triangle = 0;  ///< nearest to the cube's probe, once examined
  bool examined = false;
};

struct LessPromising {
  bool operator()(const Cube& a, const Cube& b) const {
    return a.upper != b.upper ? a.upper < b.upper : a.order > b.order;
  }
};

class Search {
 public:
  Search(const Surface& surface, const Ball& ball, double relativeGap, double absoluteGap)
      : surface_(surface), ball_(ball), relativeGap_(relativeGap), absoluteGap_(absoluteGap) {
    result_.witness = ball.center;
  }

  Overhang run() {
    const ClosestPoint nearest = surface_.closestPoint(ball_.center);
    const bool inside = surface_.inside(ball_.center);
    outAtCenter_ = inside ? -nearest.distance : nearest.distance;
    const double quick = ball_.radius + outAtCenter_;
    if (!(quick > 0)) return result_;
    result_.value = {std::max(0.0, outAtCenter_), quick};
    if (!closeEnough(quick)) {
      startAt(nearest, inside);
      if (!closeEnough(quick)) refine(quick);
    }
    result_.value.upper += kRounding * (ball_.center.cwiseAbs().maxCoeff() + ball_.radius);
    return result_;
  }

 private:
  [[nodiscard]] bool closeEnough(double upper) const {
    return upper - result_.value.lower <= std::max(relativeGap_ * upper, absoluteGap_);
  }

  [[nodiscard]] Vector3d onBall(const Vector3d& x) const {
    const Vector3d radial = x - ball_.center;
    const double length = radial.norm();
    return length <= ball_.radius ? x : Vector3d(ball_.center + (ball_.radius / length) * radial);
  }

  /// Takes note of a point outside the solid; true when it beats the best so far.
  bool offer(const Vector3d& x, double distance) {
    if (distance <= result_.value.lower) return false;
    result_.value.lower = distance;
    result_.witness = x;
    return true;
  }

  /// Goes away from the surface, within the ball, for as long as that gains anything.
  void climb(Vector3d x, Vector3d nearest, double step) {
    for (int k = 0; k < kClimbSteps; ++k) {
      const Vector3d uphill = x - nearest;
      const double length = uphill.norm();
      if (!(length > 0)) return;
      const Vector3d next = onBall(x + (step / length) * uphill);
      const ClosestPoint there = surface_.closestPoint(next);
      if (there.distance > result_.value.lower && !surface_.inside(next) && offer(next, there.distance)) {
        x = next;
        nearest = there.point;
      } else {
        step /= 2;
      }
    }
  }

  void startAt(const ClosestPoint& nearest, bool inside) {
    Vector3d outward =
        inside ? Vector3d(nearest.point - ball_.center) : Vector3d(ball_.center - nearest.point);
    if (!(outward.norm() > 0)) {
      const auto corner = [&](std::size_t k) { return surface_.mesh().corner(nearest.triangle, k); };
      outward = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    }
    const double length = outward.norm();
    if (!(length > 0)) return;
    const Vector3d pole = ball_.center + (ball_.radius / length) * outward;
    const ClosestPoint there = surface_.closestPoint(pole);
    if (surface_.inside(pole)) return;
    offer(pole, there.distance);
    if (!closeEnough(result_.value.upper)) climb(pole, there.point, ball_.radius / 2);
  }

  /// The largest distance of the ball's part in the cube to a triangle, or a little more.
  [[nodiscard]] double farthestFrom(const TriangleDistance& distance, const Vector3d& center,
                                    double half) const {
    const Vector3d radial = center - ball_.center;
    const double length = radial.norm();
    std::array<Vector3d, 8> corner;
    std::array<double, 8> above;  // height over the tangent plane of the ball below the cube's centre
    for (unsigned k = 0; k < 8; ++k) {
      corner[k] =
          center + half * Vector3d((k & 1U) != 0 ? 1 : -1, (k & 2U) != 0 ? 1 : -1, (k & 4U) != 0 ? 1 : -1);
      above[k] = length > 0 ? (corner[k] - ball_.center).dot(radial) / length - ball_.radius : -1;
    }
    double farthest = 0;
    for (unsigned k = 0; k < 8; ++k) {
      if (above[k] <= 0) farthest = std::max(farthest, distance(corner[k]));
      for (const unsigned bit : {1U, 2U, 4U}) {
        const unsigned other = k | bit;
        if (other == k || (above[k] <= 0) == (above[other] <= 0)) continue;
        const double along = above[k] / (above[k] - above[other]);
        farthest = std::max(farthest, distance(corner[k] + along * (corner[other] - corner[k])));
      }
    }
    return farthest;
  }

  void refine(double quick) {
    push({ball_.center, ball_.radius, quick, 0});
    for (int examined = 0; !queue_.empty() && examined < kMaxCubes;) {
      Cube cube = queue_.top();
      if (closeEnough(cube.upper)) break;
      queue_.pop();
      if (cube.examined) {
        split(cube);
        continue;
      }
      ++examined;
      examine(cube);
      push(cube);
    }
    const double open = queue_.empty() ? 0 : queue_.top().upper;
    result_.value.upper = std::max(result_.value.lower, open);
  }

  void push(const Cube& cube) {
    if (cube.upper > result_.value.lower) queue_.push(cube);
  }

  /// One distance query: sharpens the cube's bound and perhaps the best value.
  void examine(Cube& cube) {
    const Vector3d probe = onBall(cube.center);
    const ClosestPoint nearest = surface_.closestPoint(probe);
    const double reach = std::sqrt(3.0) * cube.half;
    cube.examined = true;
    cube.triangle = nearest.triangle;
    cube.upper = std::min(cube.upper, nearest.distance + reach);
    if (cube.upper <= result_.value.lower) return;
    const TriangleDistance distance(surface_, nearest.triangle);
    cube.upper = std::min(cube.upper, farthestFrom(distance, cube.center, cube.half));
    if (cube.upper <= result_.value.lower) return;
    if (surface_.inside(probe)) {
      cube.upper = std::min(cube.upper, reach - nearest.distance);
    } else if (offer(probe, nearest.distance)) {
      climb(probe, nearest.point, cube.half);
    }
  }

  void split(const Cube& cube) {
    const TriangleDistance distance(surface_, cube.triangle);
    const double half = cube.half / 2;
    for (unsigned k = 0; k < 8; ++k) {
      const Vector3d center = cube.center + half * Vector3d((k & 1U) != 0 ? 1 : -1, (k & 2U) != 0 ? 1 : -1,
                                                            (k & 4U) != 0 ? 1 : -1);
      const Eigen::Array3d offset = (center - ball_.center).array().abs();
      if ((offset - half).max(0.0).matrix().norm() > ball_.radius) continue;  // misses the ball
      const double reach = std::min(ball_.radius, (offset + half).matrix().norm());
      const double upper = std::min(cube.upper, outAtCenter_ + reach);
      if (upper <= result_.value.lower) continue;
      push({center, half, std::min(upper, farthestFrom(distance, center, half)), ++order_});
    }
  }

  const Surface& surface_;
  const Ball& ball_;
  double relativeGap_;
  double absoluteGap_;
  double outAtCenter_ = 0;
  Overhang result_;
  std::priority_queue<Cube, std::vector<Cube>, LessPromising> queue_;
  std::uint32_t order_ = 0;
};

}  // namespace

double quickOverhang(const Surface& surface, const Ball& ball) {
  return std::max(0.0, ball.radius - surface.depth(ball.center));
}

Overhang boundOverhang(const Surface& surface, const Ball& ball, double relativeGap, double absoluteGap) {
  return Search(surface, ball, relativeGap, absoluteGap).run();
}

}  // namespace spheretree::builders
