// SPDX-License-Identifier: GPL-3.0-or-later
#include "medial/canonical_frame.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace spheretree::medial {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Principal moments nearer than this fraction of the largest one do not tell their axes apart.
constexpr double kDistinct = 0.02;
// Directions are voted for by this many of the largest triangles.
constexpr std::size_t kVoters = 32;
// Above that a mesh is no machine part whose sides are alike, and every choice costs a pass over it.
constexpr std::size_t kFewTriangles = 100'000;
// Sums over a mesh that differ by less than this fraction differ by rounding.
constexpr double kEqual = 1e-9;
// Facets are parallel when the sine of their angle is below this.
constexpr double kParallel = 1e-3;

struct Moments {
  double area = 0;
  Vector3d centroid = Vector3d::Zero();
  Matrix3d covariance = Matrix3d::Zero();
};

/// Integrals over the surface; the vertices are taken relative to `near`, which keeps the digits.
Moments momentsOf(const TriangleMesh& mesh, const Vector3d& near) {
  Moments m;
  Matrix3d second = Matrix3d::Zero();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vector3d a = mesh.corner(t, 0) - near;
    const Vector3d b = mesh.corner(t, 1) - near;
    const Vector3d c = mesh.corner(t, 2) - near;
    const double area = (b - a).cross(c - a).norm() / 2;
    const Vector3d sum = a + b + c;
    m.area += area;
    m.centroid += area / 3 * sum;
    second += area / 12 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
  }
  m.centroid /= m.area;
  m.covariance = second / m.area - m.centroid * m.centroid.transpose();
  m.centroid += near;
  return m;
}

/// The principal axes that can be told from the others, that of the largest moment first.
std::vector<Vector3d> distinctAxes(const Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(covariance);
  const Vector3d values = solver.eigenvalues();  // ascending
  std::vector<Vector3d> axes;
  for (int k = 2; k >= 0; --k) {
    double gap = values[2];
    for (int other = 0; other < 3; ++other) {
      if (other != k) gap = std::min(gap, std::abs(values[k] - values[other]));
    }
    if (gap > kDistinct * values[2]) axes.push_back(solver.eigenvectors().col(k));
  }
  return axes;
}

struct Facing {
  Vector3d direction;
  double area;
};

/// The part of a unit vector that is perpendicular to the axes; zero when that is no more than rounding may
/// leave, which points anywhere.
Vector3d across(const Vector3d& direction, const std::vector<Vector3d>& axes) {
  Vector3d rest = direction;
  for (const Vector3d& axis : axes) rest -= rest.dot(axis) * axis;
  return rest.norm() > kParallel ? rest : Vector3d(Vector3d::Zero());
}

/// The directions of the largest triangles with the area of everything parallel to them. Triangles that face
/// along the axes have no voice.
std::vector<Facing> facings(const TriangleMesh& mesh, const std::vector<Vector3d>& axes) {
  std::vector<std::pair<double, std::uint32_t>> largest;
  std::vector<Vector3d> normals(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vector3d& a = mesh.corner(t, 0);
    normals[t] = (mesh.corner(t, 1) - a).cross(mesh.corner(t, 2) - a);
    if (!across(normals[t].normalized(), axes).isZero(0)) largest.emplace_back(-normals[t].norm(), t);
  }
  const std::size_t voters = std::min(kVoters, largest.size());
  std::partial_sort(largest.begin(), largest.begin() + static_cast<std::ptrdiff_t>(voters), largest.end());
  std::vector<Facing> result;
  for (std::size_t i = 0; i < voters; ++i) {
    const Vector3d direction = normals[largest[i].second].normalized();
    double area = 0;
    for (const Vector3d& normal : normals) {
      const double length = normal.norm();
      if (direction.cross(normal).norm() <= kParallel * length) area += length / 2;
    }
    result.push_back({direction, area});
  }
  return result;
}

/// The directions perpendicular to `axes` that most area faces: several where a symmetric shape leaves a
/// choice, `most` at most.
std::vector<Vector3d> dominantFacings(const TriangleMesh& mesh, const std::vector<Vector3d>& axes,
                                      std::size_t most) {
  std::vector<Vector3d> directions;
  std::vector<double> votes;
  double highest = 0;
  for (const Facing& candidate : facings(mesh, axes)) {
    const Vector3d rest = across(candidate.direction, axes);
    votes.push_back(candidate.area * rest.squaredNorm());
    directions.push_back(rest.normalized());
    highest = std::max(highest, votes.back());
  }
  if (!(highest > 0)) return {axes.empty() ? Vector3d(Vector3d::UnitX()) : axes.front().unitOrthogonal()};
  std::vector<Vector3d> best;
  for (std::size_t k = 0; k < votes.size() && best.size() < most; ++k) {
    const auto parallel = [&](const Vector3d& other) {
      return directions[k].cross(other).norm() <= kParallel;
    };
    if (votes[k] >= highest * (1 - kEqual) && std::none_of(best.begin(), best.end(), parallel))
      best.push_back(directions[k]);
  }
  return best;
}

/// An axis, pointing to the side where the surface reaches out with its third moment; both ways where that
/// vanishes.
std::vector<Vector3d> directed(const TriangleMesh& mesh, const CanonicalFrame& frame, const Vector3d& axis) {
  double third = 0;
  double size = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vector3d& a = mesh.corner(t, 0);
    const double area = (mesh.corner(t, 1) - a).cross(mesh.corner(t, 2) - a).norm() / 2;
    const double x = ((a + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3 - frame.origin).dot(axis) / frame.scale;
    third += area * x * x * x;
    size += area * std::abs(x * x * x);
  }
  if (std::abs(third) <= kEqual * size) return {axis, -axis};
  return {third < 0 ? Vector3d(-axis) : axis};
}

/// A positive number that depends on how the triangles lie in the frame, and not on where the mesh is: the
/// sum, over their centroids, of a peak across a skew plane. Its narrowness makes it see many-fold
/// symmetries, which have no low moments.
double signatureOf(const TriangleMesh& mesh, const CanonicalFrame& frame) {
  constexpr double kNarrowness = 16;
  const Vector3d across = kNarrowness / (3 * frame.scale) * frame.axes.transpose() * Vector3d(1, 0.7, 0.4);
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vector3d corners = mesh.corner(t, 0) - frame.origin + mesh.corner(t, 1) - frame.origin +
                             mesh.corner(t, 2) - frame.origin;
    const double x = across.dot(corners) - 1;  // the plane is not through the middle: both sides differ
    sum += 1 / (1 + x * x);
  }
  return sum;
}

/// Of frames that are equally good, the one with the largest signature: where two of these are equal, the
/// shape looks the same in both.
class BestFrame {
 public:
  BestFrame(const TriangleMesh& mesh, CanonicalFrame frame) : mesh_(mesh), frame_(std::move(frame)) {}

  void add(const Vector3d& first, const Vector3d& second) {
    CanonicalFrame frame = frame_;
    frame.axes.row(0) = first;
    frame.axes.row(1) = second;
    frame.axes.row(2) = first.cross(second);
    const double signature = signatureOf(mesh_, frame);
    if (signature <= highest_ * (1 + kEqual)) return;
    highest_ = signature;
    frame_ = frame;
  }
  [[nodiscard]] const CanonicalFrame& frame() const { return frame_; }

 private:
  const TriangleMesh& mesh_;
  CanonicalFrame frame_;
  double highest_ = 0;  // signatures are positive
};

/// Vertices in lexicographic order, triangles beginning with their first vertex and in lexicographic order,
/// too.
TriangleMesh sortedByPlace(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> order(mesh.vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Vector3d& p = mesh.vertices[a];
    const Vector3d& q = mesh.vertices[b];
    return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
  });
  TriangleMesh sorted;
  std::vector<std::uint32_t> place(order.size());
  sorted.vertices.reserve(order.size());
  for (const std::uint32_t old : order) {
    place[old] = static_cast<std::uint32_t>(sorted.vertices.size());
    sorted.vertices.push_back(mesh.vertices[old]);
  }
  sorted.triangles.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    TriangleMesh::Triangle triangle{place[a], place[b], place[c]};
    std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
    sorted.triangles.push_back(triangle);
  }
  std::sort(sorted.triangles.begin(), sorted.triangles.end());
  return sorted;
}

// Far above what rounding leaves of a moved mesh, far below what a tree in single precision can tell apart.
constexpr double kPlace = 0x1p-32;

}  // namespace

CanonicalFrame canonicalFrame(const TriangleMesh& given) {
  const TriangleMesh mesh = sortedByPlace(given);  // sums and ties in an order that is not the file's
  const Moments moments = momentsOf(mesh, boundsOf(mesh).center());
  CanonicalFrame frame;
  frame.origin = moments.centroid;
  double farthest = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k)
      farthest = std::max(farthest, (mesh.corner(t, k) - frame.origin).norm());
  }
  frame.scale = farthest;

  const std::vector<Vector3d> axes = distinctAxes(moments.covariance);
  const std::size_t most = mesh.triangles.size() > kFewTriangles ? 1 : kVoters;
  BestFrame best(mesh, frame);
  for (const Vector3d& a : axes.empty() ? dominantFacings(mesh, {}, most) : std::vector{axes[0]}) {
    for (const Vector3d& b : axes.size() < 2 ? dominantFacings(mesh, {a}, most) : std::vector{axes[1]}) {
      for (const Vector3d& first : directed(mesh, frame, a)) {
        for (const Vector3d& second : directed(mesh, frame, (b - b.dot(first) * first).normalized()))
          best.add(first, second);
      }
    }
  }
  return best.frame();
}

TriangleMesh toFrame(const TriangleMesh& mesh, const CanonicalFrame& frame, Places places) {
  TriangleMesh moved;
  moved.triangles = mesh.triangles;
  moved.vertices.reserve(mesh.vertices.size());
  for (const Vector3d& v : mesh.vertices) {
    const Vector3d at = frame.forward(v);
    moved.vertices.push_back(places == Places::Exact ? at : Vector3d((at / kPlace).array().round() * kPlace));
  }
  return sortedByPlace(moved);
}

}  // namespace spheretree::medial
