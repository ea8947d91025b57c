// SPDX-License-Identifier: GPL-3.0-or-later
//
// One ball, its points given: minimise f(c) = max |p - c| - depth(c). The first term is convex and cheap, the
// second costs a closest-point query, so each query is kept as a linear piece of the depth and the steps are
// found on the model max |p - c| - min over pieces, within a trust region.
#include "builders/fit_ball.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

// The compiler makes wide versions and chooses at run time; without contraction all give the same bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__)
#define SPHERETREE_WIDE __attribute__((target_clones("default", "avx2", "avx512f"), optimize("O3")))
#else
#define SPHERETREE_WIDE
#endif

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;
using medial::Surface;

constexpr std::size_t kMostPieces = 12;
// Steps on the model between two queries, and steps of the search for the shortest subgradient.
constexpr int kModelSteps = 8;
constexpr int kGilbertSteps = 24;
// A new place counts as better when it brings this share of what the model promised.
constexpr double kAcceptShare = 0.05;
constexpr double kTrustedShare = 0.6;
// First steps are at most this fraction of the stand-off.
constexpr double kFirstTrust = 0.25;

/// The model of f near a place.
class Model {
 public:
  void setPoints(const PointBlock& all, const Vector3d& center, double reach, double trust) {
    // Points that cannot become the farthest anywhere within the trust region do not count.
    const double least = std::max(0.0, reach - 2 * trust);
    squaredDistances(all, center, squared_);
    far_.clear();
    for (std::size_t i = 0; i < squared_.size(); ++i) {
      if (squared_[i] >= least * least) far_.push({all.x[i], all.y[i], all.z[i]});
    }
  }

  void addPiece(const DepthProbe& probe) {
    // A piece that promises less depth than there is has been proved wrong here.
    for (std::size_t k = 0; k < count_;) {
      if (depthOf(pieces_[k], probe.at) < probe.depth - 1e-12 * std::abs(probe.depth)) {
        pieces_[k] = pieces_[--count_];
      } else {
        ++k;
      }
    }
    if (count_ == kMostPieces) {
      for (std::size_t k = 1; k < count_; ++k) pieces_[k - 1] = pieces_[k];
      --count_;
    }
    pieces_[count_++] = probe;
  }

  [[nodiscard]] double value(const Vector3d& c) const {
    return std::sqrt(farthestSquared(far_, c)) - depth(c);
  }

  /// The shortest subgradient of the pieces that are within `slack` of the largest.
  [[nodiscard]] Vector3d direction(const Vector3d& c, double slack) {
    const double reach = std::sqrt(farthestSquared(far_, c));
    const double least = depth(c);
    const double close = std::max(0.0, reach - slack);
    up_.clear();
    for (std::size_t i = 0; i < far_.size(); ++i) {
      const Vector3d u(c.x() - far_.x[i], c.y() - far_.y[i], c.z() - far_.z[i]);
      const double squared = u.squaredNorm();
      if (squared >= close * close && squared > 0) up_.push_back(u / std::sqrt(squared));
    }
    down_.clear();
    for (std::size_t k = 0; k < count_; ++k) {
      if (depthOf(pieces_[k], c) <= least + slack) down_.push_back(-pieces_[k].gradient);
    }
    if (up_.empty() || down_.empty()) return Vector3d::Zero();
    Vector3d z = up_.front() + down_.front();
    for (int step = 0; step < kGilbertSteps; ++step) {
      const Vector3d s = support(up_, z) + support(down_, z);
      const Vector3d toward = s - z;
      const double gain = -z.dot(toward);
      if (gain <= 1e-4 * z.squaredNorm()) break;
      z += std::min(1.0, gain / toward.squaredNorm()) * toward;
    }
    return z;
  }

 private:
  static double depthOf(const DepthProbe& piece, const Vector3d& c) {
    return piece.depth + piece.gradient.dot(c - piece.at);
  }
  static const Vector3d& support(const std::vector<Vector3d>& set, const Vector3d& z) {
    const Vector3d* least = &set.front();
    double value = least->dot(z);
    for (const Vector3d& s : set) {
      const double v = s.dot(z);
      if (v < value) {
        value = v;
        least = &s;
      }
    }
    return *least;
  }
  [[nodiscard]] double depth(const Vector3d& c) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < count_; ++k) least = std::min(least, depthOf(pieces_[k], c));
    return least;
  }

  PointBlock far_;
  std::vector<double> squared_;
  std::array<DepthProbe, kMostPieces> pieces_;
  std::size_t count_ = 0;
  std::vector<Vector3d> up_;
  std::vector<Vector3d> down_;
};

/// Where the model is least within the trust region around `center`, approximately.
Vector3d minimise(Model& model, const Vector3d& center, double trust, double slack) {
  Vector3d c = center;
  double value = model.value(c);
  double step = trust / 2;
  for (int i = 0; i < kModelSteps; ++i) {
    const Vector3d g = model.direction(c, slack);
    const double length = g.norm();
    if (length < 1e-3) {
      slack /= 8;
      if (slack < 1e-6 * trust) break;
      continue;
    }
    bool moved = false;
    for (int halving = 0; halving < 8; ++halving) {
      Vector3d next = c - (step / length) * g;
      if (const double out = (next - center).norm(); out > trust) {
        next = center + (trust / out) * (next - center);
      }
      const double v = model.value(next);
      if (v < value) {
        c = next;
        value = v;
        moved = true;
        if (halving == 0) step *= 1.5;
        break;
      }
      step /= 2;
    }
    if (!moved) {
      slack /= 8;
      step = std::max(step, trust / 64);
      if (slack < 1e-6 * trust) break;
    }
  }
  return c;
}

}  // namespace

void PointBlock::clear() {
  x.clear();
  y.clear();
  z.clear();
}

void PointBlock::push(const Vector3d& p) {
  x.push_back(p.x());
  y.push_back(p.y());
  z.push_back(p.z());
}

void PointBlock::append(const PointBlock& more) {
  x.insert(x.end(), more.x.begin(), more.x.end());
  y.insert(y.end(), more.y.begin(), more.y.end());
  z.insert(z.end(), more.z.begin(), more.z.end());
}

SPHERETREE_WIDE
double farthestSquared(const PointBlock& points, const Vector3d& center) {
  const std::size_t n = points.size();
  const double* x = points.x.data();
  const double* y = points.y.data();
  const double* z = points.z.data();
  const double cx = center.x();
  const double cy = center.y();
  const double cz = center.z();
  double most = 0;
#pragma omp simd reduction(max : most)
  for (std::size_t i = 0; i < n; ++i) {
    const double dx = x[i] - cx;
    const double dy = y[i] - cy;
    const double dz = z[i] - cz;
    const double d = dx * dx + dy * dy + dz * dz;
    most = most < d ? d : most;
  }
  return most;
}

SPHERETREE_WIDE
void squaredDistances(const PointBlock& points, const Vector3d& center, std::vector<double>& squared) {
  const std::size_t n = points.size();
  squared.resize(n);
  const double* x = points.x.data();
  const double* y = points.y.data();
  const double* z = points.z.data();
  double* out = squared.data();
  const double cx = center.x();
  const double cy = center.y();
  const double cz = center.z();
#pragma omp simd
  for (std::size_t i = 0; i < n; ++i) {
    const double dx = x[i] - cx;
    const double dy = y[i] - cy;
    const double dz = z[i] - cz;
    out[i] = dx * dx + dy * dy + dz * dz;
  }
}

DepthProbe probeDepth(const Surface& surface, const Vector3d& at, const DepthProbe* known) {
  const medial::ClosestPoint closest = surface.closestPoint(at);
  // A ball that the surface does not enter is inside or outside as a whole.
  const bool same = known != nullptr && (at - known->at).norm() < std::abs(known->depth);
  const bool inside = same ? known->depth > 0 : surface.inside(at);
  DepthProbe probe;
  probe.at = at;
  probe.depth = inside ? closest.distance : -closest.distance;
  const Vector3d away = at - closest.point;
  const double length = away.norm();
  if (length > 1e-9 * surface.diagonal()) {
    probe.gradient = (inside ? 1 : -1) / length * away;
  } else {
    const medial::TriangleMesh& mesh = surface.mesh();
    const Vector3d normal = (mesh.corner(closest.triangle, 1) - mesh.corner(closest.triangle, 0))
                                .cross(mesh.corner(closest.triangle, 2) - mesh.corner(closest.triangle, 0));
    probe.gradient = normal.norm() > 0 ? Vector3d(-normal.normalized()) : Vector3d::UnitX();
  }
  return probe;
}

Fit fitBall(const Surface& surface, const PointBlock& points, const DepthProbe& start,
            const FitEffort& effort) {
  Fit best{start, std::sqrt(farthestSquared(points, start.at))};
  Model model;
  model.addPiece(start);
  double trust = kFirstTrust * std::max(std::abs(best.standOff()), 0.02 * best.reach);
  for (std::size_t query = 0; query < effort.queries && trust > 0; ++query) {
    model.setPoints(points, best.center.at, best.reach, trust);
    const double worthwhile = effort.tolerance * std::max(std::abs(best.standOff()), 1e-3 * best.reach);
    const Vector3d c = minimise(model, best.center.at, trust, 0.05 * trust);
    const double promised = best.standOff() - model.value(c);
    if (promised < worthwhile) {
      break;
    }
    const Fit next{probeDepth(surface, c, &best.center), std::sqrt(farthestSquared(points, c))};
    const double gained = best.standOff() - next.standOff();
    model.addPiece(next.center);
    if (gained > kTrustedShare * promised) trust *= 3;
    if (gained < kAcceptShare * promised) trust *= 0.35;
    if (gained > 0) best = next;
  }
  return best;
}

}  // namespace spheretree::builders
