// SPDX-License-Identifier: GPL-3.0-or-later
//
// The shrinking ball of J. Ma, S. W. Bae, S. Choi, "3D medial axis point approximation using nearest
// neighbors and the normal field", Visual Computer 28, 2012, by exact closest points: a ball through a point
// of the surface, tangent there, is made to touch whatever reaches into it until nothing does.
#include "builders/inward.hpp"

#include <algorithm>

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;
using medial::ClosestPoint;
using medial::Surface;

// A ball is not shrunk for the sake of this fraction of its radius: that costs two queries and gains little.
constexpr double kLoose = 0.02;
// A ball that is empty but for this fraction of its radius may be too small.
constexpr double kEmpty = 1e-9;
// First guess of the radius, for a point that is inside already: most of those asked for are near the axis.
constexpr double kFirstGuess = 1.3;
constexpr int kMaxSteps = 10;  // four are typical

/// The largest ball that touches at `touch`, but no less than `known`, which is one of them.
Candidate largestBall(const Surface& surface, const Vector3d& touch, const Vector3d& inward, double radius,
                      const Candidate& known) {
  Candidate best = known;
  bool shrunk = false;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Vector3d center = touch + radius * inward;
    const ClosestPoint closest = surface.closestPoint(center);
    const bool empty = closest.distance >= radius * (1 - kEmpty);
    if (empty || (shrunk && closest.distance >= radius * (1 - kLoose))) {
      best = {center, closest.distance};
      if (shrunk || radius > surface.diagonal()) break;
      radius *= 2;
      continue;
    }
    const Vector3d chord = closest.point - touch;
    const double along = chord.dot(inward);
    const double smaller = along > 0 ? chord.squaredNorm() / (2 * along) : 0;
    if (!(smaller < radius) || smaller <= best.depth) break;
    radius = smaller;
    shrunk = true;
  }
  if (best.depth <= known.depth) return known;
  // At a sharp edge the way in may lead out again on the other side.
  const bool near = (best.center - known.center).norm() < known.depth;
  return near || surface.inside(best.center) ? best : known;
}

// Points within this fraction of what their ball needs pull it together.
constexpr double kPulling = 0.95;

}  // namespace

Candidate growInward(const Surface& surface, const Vector3d& touch, const Vector3d& inward, double radius) {
  return largestBall(surface, touch, inward, radius, {touch, 0});
}

Candidate pushInward(const Surface& surface, const Vector3d& point, const Candidate* known) {
  const ClosestPoint closest = surface.closestPoint(point);
  const bool near = known != nullptr && (point - known->center).norm() < known->depth;
  const bool inside = near || surface.inside(point);
  const Candidate start{point, inside ? closest.distance : -closest.distance};
  if (!(closest.distance > kEmpty * surface.diagonal())) return start;
  const Vector3d inward = (inside ? 1 : -1) / closest.distance * (point - closest.point);
  if (!inside) return growInward(surface, closest.point, inward, closest.distance);
  return largestBall(surface, closest.point, inward, kFirstGuess * closest.distance, start);
}

Pull pullOn(const Candidate& ball, std::span<const Vector3d> points) {
  double farthest = 0;
  for (const Vector3d& p : points) farthest = std::max(farthest, (p - ball.center).norm());
  Pull pull{farthest - ball.depth, Vector3d::Zero()};
  const double near = farthest - (1 - kPulling) * std::max(0.0, pull.need);
  for (const Vector3d& p : points) {
    const double distance = (p - ball.center).norm();
    if (distance >= near && distance > 0) pull.direction += (p - ball.center) / distance;
  }
  pull.direction = pull.direction.stableNormalized();
  return pull;
}

std::vector<Candidate> slide(const Surface& surface, const Candidate& ball, std::span<const Vector3d> points,
                             const SlideSettings& settings) {
  std::vector<Candidate> places;
  Candidate best = ball;
  Pull pull = pullOn(ball, points);
  double length = settings.length;
  for (int i = 0; i < settings.steps; ++i) {
    places.push_back(pushInward(surface, best.center + length * pull.direction, &best));
    const Pull next = pullOn(places.back(), points);
    if (next.need < pull.need) {
      best = places.back();
      pull = next;
    } else {
      length /= 2;
    }
  }
  return places;
}

}  // namespace spheretree::builders
