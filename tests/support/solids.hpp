// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "medial/random.hpp"
#include "medial/surface.hpp"
#include "models/shapes.hpp"

namespace spheretree::test {

/// A generated model that bounds a solid as it is.
struct Solid {
  std::string name;
  medial::Surface surface;
};

/// All of them, in the catalogue's order.
inline std::vector<Solid> allSolids() {
  std::vector<Solid> solids;
  for (const models::Model& model : models::allModels()) {
    Result<medial::Surface> surface = medial::Surface::create(model.make());
    if (surface) solids.push_back({std::string(model.name), std::move(surface).value()});
  }
  return solids;
}

/// Uniform by area within one triangle.
inline Eigen::Vector3d randomPoint(const medial::TriangleMesh& mesh, std::size_t triangle,
                                   medial::Random& random) {
  double u = random.uniform();
  double v = random.uniform();
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  const Eigen::Vector3d& a = mesh.corner(triangle, 0);
  return a + u * (mesh.corner(triangle, 1) - a) + v * (mesh.corner(triangle, 2) - a);
}

inline Eigen::Matrix3d randomRotation(medial::Random& random) {
  Eigen::Vector4d q;
  do {
    for (int k = 0; k < 4; ++k) q[k] = random.uniform(-1, 1);
  } while (q.squaredNorm() > 1 || q.squaredNorm() < 0.01);
  return Eigen::Quaterniond(q.normalized()).toRotationMatrix();
}

}  // namespace spheretree::test
