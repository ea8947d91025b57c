// SPDX-License-Identifier: GPL-3.0-or-later
//
// CGAL's triangulation behind numbers. Cospherical points are told apart by CGAL's symbolic perturbation
// (Devillers, Teillaud 2003), which looks at coordinates only, so the order of insertion does not matter.
#include "medial/delaunay.hpp"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

namespace spheretree::medial {
namespace {

using Eigen::Vector3d;

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<std::uint32_t, Kernel>;
using CellBase =
    CGAL::Triangulation_cell_base_with_info_3<std::uint32_t, Kernel, CGAL::Triangulation_cell_base_3<Kernel>>;
using Structure = CGAL::Triangulation_data_structure_3<VertexBase, CellBase>;
using Triangulation = CGAL::Delaunay_triangulation_3<Kernel, Structure>;
using CellHandle = Triangulation::Cell_handle;

Kernel::Point_3 toPoint(const Vector3d& p) {
  return {p.x(), p.y(), p.z()};
}

}  // namespace

std::optional<Ball> circumscribedBall(const std::array<Vector3d, 4>& corners) {
  const Vector3d& a = corners[0];
  const Vector3d u = corners[1] - a;
  const Vector3d v = corners[2] - a;
  const Vector3d w = corners[3] - a;
  const double determinant = 2 * u.dot(v.cross(w));
  if (determinant == 0) return std::nullopt;
  const Vector3d toCenter =
      (u.squaredNorm() * v.cross(w) + v.squaredNorm() * w.cross(u) + w.squaredNorm() * u.cross(v)) /
      determinant;
  double nearest = toCenter.norm();
  double farthest = nearest;
  for (const Vector3d& edge : {u, v, w}) {
    const double distance = (edge - toCenter).norm();
    nearest = std::min(nearest, distance);
    farthest = std::max(farthest, distance);
  }
  if (!(farthest - nearest <= kCircumsphere * farthest)) return std::nullopt;
  return Ball{a + toCenter, nearest};
}

struct Delaunay::Impl {
  Triangulation triangulation;
  std::vector<CellHandle> handles;  // by number; stale when dead
  std::vector<Corners> corners;     // corners[n][0] == kNone: dead
  std::vector<std::uint32_t> removed;
  std::vector<std::uint32_t> created;
  std::vector<CellHandle> scratch;

  explicit Impl(const std::vector<std::pair<Kernel::Point_3, std::uint32_t>>& points)
      : triangulation(points.begin(), points.end()) {
    numberAll();
  }

  void numberAll() {
    for (const auto cell : triangulation.all_cell_handles()) cell->info() = kNone;
    if (triangulation.dimension() < 3) return;
    for (const auto cell : triangulation.finite_cell_handles()) give(cell);
  }

  void give(const CellHandle& cell) {
    const auto number = static_cast<std::uint32_t>(handles.size());
    cell->info() = number;
    handles.push_back(cell);
    Corners& own = corners.emplace_back();
    for (int k = 0; k < 4; ++k) own[static_cast<std::size_t>(k)] = cell->vertex(k)->info();
    created.push_back(number);
  }

  /// A cell whose circumsphere holds the point; none when the point is there already.
  CellHandle conflictingCell(const Kernel::Point_3& point, const CellHandle& near) const {
    const auto conflicts = [&](const CellHandle& cell) {
      return triangulation.side_of_sphere(cell, point, true) == CGAL::ON_BOUNDED_SIDE;
    };
    if (near != CellHandle() && conflicts(near)) return near;
    Triangulation::Locate_type type{};
    int i = 0;
    int j = 0;
    const CellHandle found = triangulation.locate(point, type, i, j, near);
    if (type == Triangulation::VERTEX || !conflicts(found)) return {};
    return found;
  }

  void insertInSpace(const Kernel::Point_3& point, std::uint32_t index, const CellHandle& near) {
    const CellHandle start = conflictingCell(point, near);
    if (start == CellHandle()) return;
    scratch.clear();
    Triangulation::Facet border;
    triangulation.find_conflicts(point, start, CGAL::Oneset_iterator<Triangulation::Facet>(border),
                                 std::back_inserter(scratch));
    for (const CellHandle& cell : scratch) {
      if (cell->info() == kNone) continue;
      corners[cell->info()][0] = kNone;
      removed.push_back(cell->info());
    }
    const auto vertex =
        triangulation.insert_in_hole(point, scratch.begin(), scratch.end(), border.first, border.second);
    vertex->info() = index;
    scratch.clear();
    triangulation.incident_cells(vertex, std::back_inserter(scratch));
    for (const CellHandle& cell : scratch) {
      cell->info() = kNone;
      if (!triangulation.is_infinite(cell)) give(cell);
    }
  }
};

Delaunay::Delaunay(std::span<const Vector3d> points) {
  std::vector<std::pair<Kernel::Point_3, std::uint32_t>> numbered;
  numbered.reserve(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) numbered.emplace_back(toPoint(points[i]), i);
  impl_ = std::make_unique<Impl>(numbered);
}

Delaunay::~Delaunay() = default;

std::size_t Delaunay::size() const noexcept {
  return impl_->corners.size();
}

bool Delaunay::alive(std::uint32_t tetrahedron) const noexcept {
  return impl_->corners[tetrahedron][0] != kNone;
}

const Delaunay::Corners& Delaunay::corners(std::uint32_t tetrahedron) const noexcept {
  return impl_->corners[tetrahedron];
}

std::uint32_t Delaunay::neighbour(std::uint32_t tetrahedron, std::size_t corner) const {
  return impl_->handles[tetrahedron]->neighbor(static_cast<int>(corner))->info();
}

Delaunay::Change Delaunay::insert(const Vector3d& point, std::uint32_t index, std::uint32_t near) {
  impl_->removed.clear();
  impl_->created.clear();
  if (impl_->triangulation.dimension() < 3) {
    // A plane figure has no tetrahedra that could be removed; the first point beside it gives all at once.
    const auto vertex = impl_->triangulation.insert(toPoint(point));
    vertex->info() = index;
    impl_->numberAll();
  } else {
    impl_->insertInSpace(toPoint(point), index, near == kNone ? CellHandle() : impl_->handles[near]);
  }
  return {impl_->removed, impl_->created};
}

}  // namespace spheretree::medial
