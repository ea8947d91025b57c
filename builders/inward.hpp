// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "medial/surface.hpp"

namespace spheretree::builders {

/// Where a ball may be centred, and how deep that lies in the solid (Surface::depth).
struct Candidate {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double depth = 0;
};

/// The centre of a ball inside the solid that touches the surface at `touch` and does not fit if it were
/// more than a few per cent larger; `inward` is a unit vector, `radius` a guess of any quality. The depth is
/// exact; 0 at `touch` itself when nothing fits.
[[nodiscard]] Candidate growInward(const medial::Surface& surface, const Eigen::Vector3d& touch,
                                   const Eigen::Vector3d& inward, double radius);

/// Moves a point straight away from the nearest point of the surface, or through it from outside, until
/// another one is nearly as near: close to the medial axis. On the way in the depth grows at least as fast as
/// the distance to anything, so no cell needs a greater stand-off than it did. A known ball around the point,
/// of radius depth, saves a test for being inside.
[[nodiscard]] Candidate pushInward(const medial::Surface& surface, const Eigen::Vector3d& point,
                                   const Candidate* known = nullptr);

/// What a ball needs for some points.
struct Pull {
  double need = 0;                                      ///< stand-off that holds them
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< towards those that ask most; unit length, or zero
};
[[nodiscard]] Pull pullOn(const Candidate& ball, std::span<const Eigen::Vector3d> points);

struct SlideSettings {
  double length = 0;  ///< of the first step, mesh units; halved when a step does not help
  int steps = 0;      ///< a handful of distance queries each
};

/// Moves a ball towards where it needs to stand off less for these points, step by step along the medial
/// axis. All places tried, not only those that were better.
[[nodiscard]] std::vector<Candidate> slide(const medial::Surface& surface, const Candidate& ball,
                                           std::span<const Eigen::Vector3d> points,
                                           const SlideSettings& settings);

}  // namespace spheretree::builders
