// SPDX-License-Identifier: GPL-3.0-or-later
//
// B. Gärtner, "Fast and robust smallest enclosing balls", ESA 1999: Welzl's move-to-front recursion, driven
// by pivoting on the farthest point. The support ball of up to four points is solved from its Gram system;
// a point that is affinely dependent on the others adds nothing and is refused.
#include "medial/min_ball.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Dense>

namespace spheretree::medial {
namespace {

using Eigen::Vector3d;

/// The smallest ball with all of its (at most four) points on its boundary.
class Support {
 public:
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] const Vector3d& center() const { return center_[size_]; }
  [[nodiscard]] double squaredRadius() const { return squaredRadius_[size_]; }

  /// False, and no change, when the point is too nearly in the affine hull of the others.
  bool push(const Vector3d& p) {
    if (size_ == 4) return false;
    if (size_ == 0) {
      points_[0] = p;
      center_[1] = p;
      squaredRadius_[1] = 0;
      size_ = 1;
      return true;
    }
    // Orthogonal part of the new point to the hull of the others; the centre moves along it.
    Vector3d q = p - points_[0];
    const double scale = q.squaredNorm();
    for (std::size_t i = 1; i < size_; ++i) q -= q.dot(direction_[i]) * direction_[i];
    for (std::size_t i = 1; i < size_; ++i) q -= q.dot(direction_[i]) * direction_[i];
    const double height = q.norm();
    constexpr double kDependent = 1e-10;  // relative height below which the solution is noise
    if (!(height * height > kDependent * kDependent * scale)) return false;
    const Vector3d unit = q / height;
    const Vector3d toNew = p - center_[size_];
    const double excess = toNew.squaredNorm() - squaredRadius_[size_];
    const double move = excess / (2 * height);
    points_[size_] = p;
    direction_[size_] = unit;
    center_[size_ + 1] = center_[size_] + move * unit;
    squaredRadius_[size_ + 1] = squaredRadius_[size_] + move * move;
    ++size_;
    return true;
  }

  void pop() { --size_; }

 private:
  std::size_t size_ = 0;
  Vector3d points_[4];
  Vector3d direction_[4];
  Vector3d center_[5] = {Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero(),
                         Vector3d::Zero()};
  double squaredRadius_[5] = {-1, 0, 0, 0, 0};
};

/// At most a few dozen pivots; the ones that matter move to the front.
using PointList = std::vector<Vector3d>;

struct Candidate {
  Vector3d center = Vector3d::Zero();
  double squaredRadius = -1;
};

/// Welzl's recursion over the first `count` points, with the support's points forced onto the boundary.
void moveToFront(PointList& points, std::size_t count, Support& support, Candidate& candidate) {
  candidate = {support.center(), support.squaredRadius()};
  if (support.size() == 4) return;
  for (std::size_t i = 0; i < count; ++i) {
    constexpr double kInside = 1e-14;  // relative: a point this near the boundary is not worth a recursion
    const Vector3d point = points[i];
    const double squared = (point - candidate.center).squaredNorm();
    if (squared > candidate.squaredRadius * (1 + kInside) && support.push(point)) {
      moveToFront(points, i, support, candidate);
      support.pop();
      const auto at = points.begin() + static_cast<std::ptrdiff_t>(i);
      std::rotate(points.begin(), at, at + 1);
    }
  }
}

}  // namespace

Ball minBall(std::span<const Vector3d> points) {
  if (points.empty()) return {};
  // Pivoting: solve for a few points, add the farthest one outside, repeat while the ball grows.
  PointList list{points.front()};
  Candidate best{points.front(), 0};
  double bestFarthest = -1;
  constexpr int kMaxPivots = 200;  // a handful is typical; the bound only guards against cycling by rounding
  Candidate candidate = best;
  for (int pivot = 0; pivot < kMaxPivots; ++pivot) {
    double farthest = -1;
    std::size_t index = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double squared = (points[i] - candidate.center).squaredNorm();
      if (squared > farthest) {
        farthest = squared;
        index = i;
      }
    }
    if (bestFarthest < 0 || farthest < bestFarthest) {
      bestFarthest = farthest;
      best = candidate;
    }
    constexpr double kEnough = 1e-14;
    if (farthest <= candidate.squaredRadius * (1 + kEnough)) break;
    list.insert(list.begin(), points[index]);
    Support support;
    moveToFront(list, list.size(), support, candidate);
  }
  return {best.center, std::sqrt(bestFarthest)};
}

}  // namespace spheretree::medial
