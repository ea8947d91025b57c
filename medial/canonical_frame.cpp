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

/// The direction perpendicular to `axes` that most area faces.
Vector3d dominantFacing(const std::vector<Facing>& candidates, const std::vector<Vector3d>& axes) {
  Vector3d best = Vector3d::Zero();
  double most = -1;
  for (const Facing& candidate : candidates) {
    const Vector3d rest = across(candidate.direction, axes);
    const double vote = candidate.area * rest.squaredNorm();
    // Equal votes up to rounding: the first one stays.
    if (vote > most * (1 + 1e-9)) {
      most = vote;
      best = rest;
    }
  }
  if (best.norm() > 0) return best.normalized();
  return axes.empty() ? Vector3d(Vector3d::UnitX()) : Vector3d(axes.front().unitOrthogonal());
}

/// Makes an axis point to the side where the surface reaches out with its third moment.
Vector3d directed(const TriangleMesh& mesh, const Vector3d& centroid, const Vector3d& axis) {
  double third = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vector3d& a = mesh.corner(t, 0);
    const double area = (mesh.corner(t, 1) - a).cross(mesh.corner(t, 2) - a).norm() / 2;
    const double x = ((a + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3 - centroid).dot(axis);
    third += area * x * x * x;
  }
  return third < 0 ? Vector3d(-axis) : axis;
}

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
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(moments.covariance);
  const Vector3d values = solver.eigenvalues();  // ascending
  std::vector<Vector3d> axes;
  for (int k = 2; k >= 0; --k) {
    double gap = values[2];
    for (int other = 0; other < 3; ++other) {
      if (other != k) gap = std::min(gap, std::abs(values[k] - values[other]));
    }
    if (gap > kDistinct * values[2]) axes.push_back(solver.eigenvectors().col(k));
  }
  if (axes.size() < 2) {
    std::vector<Facing> candidates = facings(mesh, {});
    while (axes.size() < 2) {
      // The largest triangles of a plate all face along the axis that is known already.
      const bool silent = std::all_of(candidates.begin(), candidates.end(), [&](const Facing& candidate) {
        return across(candidate.direction, axes).isZero(0);
      });
      if (silent) candidates = facings(mesh, axes);
      axes.push_back(dominantFacing(candidates, axes));
    }
  }
  CanonicalFrame frame;
  frame.origin = moments.centroid;
  const Vector3d first = directed(mesh, frame.origin, axes[0]);
  const Vector3d second = directed(mesh, frame.origin, (axes[1] - axes[1].dot(first) * first).normalized());
  frame.axes.row(0) = first;
  frame.axes.row(1) = second;
  frame.axes.row(2) = first.cross(second);
  double farthest = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k)
      farthest = std::max(farthest, (mesh.corner(t, k) - frame.origin).norm());
  }
  frame.scale = farthest;
  return frame;
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
