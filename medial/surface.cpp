// SPDX-License-Identifier: GPL-3.0-or-later
#include "medial/surface.hpp"

#include <string>
#include <utility>

#include "medial/triangle_bvh.hpp"

namespace spheretree::medial {

struct Surface::Impl {
  explicit Impl(TriangleMesh given)
      : mesh(std::move(given)),
        bounds(boundsOf(mesh)),
        diagonal(bounds.diagonal().norm()),
        volume(signedVolumeOf(mesh)),
        area(areaOf(mesh)),
        bvh(mesh) {}

  TriangleMesh mesh;
  Eigen::AlignedBox3d bounds;
  double diagonal;
  double volume;
  double area;
  TriangleBvh bvh;
};

namespace {

/// A sentence saying why the mesh cannot be a solid's boundary; empty when it can.
std::string whyUnsuitable(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return "the mesh has no triangles";
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (v >= mesh.vertices.size()) {
        return "triangle " + std::to_string(t) + " refers to vertex " + std::to_string(v) + " of " +
               std::to_string(mesh.vertices.size());
      }
      if (!mesh.vertices[v].allFinite()) return "vertex " + std::to_string(v) + " is not finite";
    }
  }
  if (std::string reason = whyNotMeasurable(mesh); !reason.empty()) return reason;
  if (!boundsVolume(mesh)) {
    return "the mesh is open or inconsistently oriented: some edge is not used equally often in both "
           "directions";
  }
  if (!(signedVolumeOf(mesh) > 0)) return "the mesh encloses no positive volume";
  return {};
}

}  // namespace

Result<Surface> Surface::create(TriangleMesh mesh) {
  if (std::string reason = whyUnsuitable(mesh); !reason.empty()) {
    return Error{ErrorCode::UnsuitableMesh, std::move(reason)};
  }
  return Surface(std::make_unique<Impl>(std::move(mesh)));
}

Surface::Surface(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
Surface::Surface(Surface&&) noexcept = default;
Surface& Surface::operator=(Surface&&) noexcept = default;
Surface::~Surface() = default;

const TriangleMesh& Surface::mesh() const noexcept {
  return impl_->mesh;
}
const Eigen::AlignedBox3d& Surface::bounds() const noexcept {
  return impl_->bounds;
}
double Surface::diagonal() const noexcept {
  return impl_->diagonal;
}
double Surface::volume() const noexcept {
  return impl_->volume;
}
double Surface::area() const noexcept {
  return impl_->area;
}

ClosestPoint Surface::closestPoint(const Eigen::Vector3d& point) const {
  return impl_->bvh.closestPoint(point);
}

ClosestPoint Surface::roughlyClosestPoint(const Eigen::Vector3d& point) const {
  return impl_->bvh.roughlyClosestPoint(point);
}

double Surface::depth(const Eigen::Vector3d& point) const {
  const double distance = impl_->bvh.closestPoint(point).distance;
  return inside(point) ? distance : -distance;
}

bool Surface::inside(const Eigen::Vector3d& point) const {
  return impl_->bvh.windingNumber(point) > 0;
}

std::vector<std::uint32_t> Surface::trianglesNear(const Eigen::AlignedBox3d& box) const {
  return impl_->bvh.trianglesNear(box);
}

}  // namespace spheretree::medial
