// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/export.hpp"
#include "medial/ball.hpp"

namespace spheretree::io {

// The formats, a file each (export_json.cpp, ..). `levels` are those asked for, never empty.

[[nodiscard]] std::string exportJson(const ExportSource& source, std::span<const std::size_t> levels);
[[nodiscard]] std::string exportFoam(const ExportSource& source, std::span<const std::size_t> levels);
[[nodiscard]] std::string exportGlb(const ExportSource& source, std::span<const std::size_t> levels);

/// The balls of one link of a robot, in its frame.
struct LinkBalls {
  std::string link;
  std::vector<medial::Ball> balls;
};

/// A robot of links without joints: each link's balls as `<collision>` elements.
[[nodiscard]] std::string urdfText(std::string_view robot, std::span<const LinkBalls> links);

/// `<link_sphere_approximation>` of each link (MoveIt).
[[nodiscard]] std::string srdfText(std::string_view robot, std::span<const LinkBalls> links);

/// `collision_spheres` of each link (cuRobo).
[[nodiscard]] std::string curoboText(std::string_view robot, std::span<const LinkBalls> links);

/// A ball as a URDF `<collision>`, on lines that begin with `indent`. `name`: of the element, may be empty.
/// `extra`: elements, as XML, that go in as well.
[[nodiscard]] std::string collisionXml(const medial::Ball& ball, std::string_view name,
                                       std::string_view extra, std::string_view indent);

/// Text between the quotes of an XML attribute.
[[nodiscard]] std::string xmlQuoted(std::string_view text);

/// "x y z", numbers that read back exactly.
[[nodiscard]] std::string xmlTriple(const Eigen::Vector3d& v);

}  // namespace spheretree::io
