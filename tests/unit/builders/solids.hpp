// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include <spheretree/sphere_tree.hpp>

#include "builders/region.hpp"
#include "medial/ball.hpp"
#include "medial/random.hpp"
#include "medial/surface.hpp"
#include "models/shapes.hpp"

namespace spheretree::builders {

inline medial::Surface surfaceOf(medial::TriangleMesh mesh) {
  auto surface = medial::Surface::create(std::move(mesh));
  EXPECT_TRUE(surface.ok()) << (surface.ok() ? "" : surface.error().message);
  return std::move(surface).value();
}

inline medial::Surface boxSurface(double x, double y, double z) {
  return surfaceOf(models::makeBox({x, y, z}));
}

/// The whole surface in pieces no longer than `size`.
inline std::vector<Piece> piecesOfAll(const medial::Surface& surface, double size) {
  Region region;
  for (std::uint32_t t = 0; t < surface.mesh().triangles.size(); ++t) {
    region.surface.push_back(
        {surface.mesh().corner(t, 0), surface.mesh().corner(t, 1), surface.mesh().corner(t, 2)});
  }
  return piecesOf(surface, region, {size, size});
}

inline Eigen::Vector3d randomIn(medial::Random& random, const Eigen::AlignedBox3d& box) {
  Eigen::Vector3d p;
  for (Eigen::Index k = 0; k < 3; ++k) p[k] = random.uniform(box.min()[k], box.max()[k]);
  return p;
}

/// The ball around a box, a millionth larger, as builders make them: proofs have no patience with touching.
inline medial::Ball ballAround(const Eigen::AlignedBox3d& box) {
  return {box.center(), box.diagonal().norm() / 2 * (1 + 1e-6)};
}

inline Eigen::AlignedBox3d boxAt(const Eigen::Vector3d& center, const Eigen::Vector3d& sides) {
  return {center - sides / 2, center + sides / 2};
}

/// A tree from balls and the numbers of their parents.
inline SphereTree treeOf(const std::vector<std::pair<medial::Ball, std::uint32_t>>& nodes) {
  std::vector<SphereTree::Entry> entries;
  for (const auto& [ball, parent] : nodes) {
    const Vec3 center{static_cast<float>(ball.center.x()), static_cast<float>(ball.center.y()),
                      static_cast<float>(ball.center.z())};
    entries.push_back({{center, static_cast<float>(ball.radius)}, entries.empty() ? kNoParent : parent});
  }
  auto tree = SphereTree::create(entries);
  EXPECT_TRUE(tree.ok()) << (tree.ok() ? "" : tree.error().message);
  return std::move(tree).value();
}

}  // namespace spheretree::builders
