// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <spheretree/result.hpp>

#include "builders/settings.hpp"
#include "io/export_formats.hpp"
#include "io/mesh_repair.hpp"
#include "medial/context.hpp"

namespace spheretree::io {

/// An empty string, or the sentence that says which package the program was built without: then
/// sphereRobot() fails with it (InvalidArgument).
[[nodiscard]] std::string whyNoUrdf();

/// How collision geometry becomes balls.
struct RobotSettings {
  builders::BuildSettings build;                         ///< of each geometry; its last level is used
  std::map<std::string, builders::BuildSettings> links;  ///< of links that differ, by name
  Repair repair = Repair::Auto;
  std::map<std::string, std::filesystem::path> packages;  ///< where package://NAME/ is
  std::vector<std::filesystem::path> packagePath;         ///< folders of packages, as in ROS_PACKAGE_PATH
};

/// Budgets of links from a JSON file (docs/exports.md), on top of `build`. Errors: UnreadableInput, naming
/// file, link and reason.
Result<std::map<std::string, builders::BuildSettings>> readBudgets(const std::filesystem::path& path,
                                                                   builders::BuildSettings& build);

/// What became of one `<collision>`.
struct RobotPart {
  std::string link;
  std::string geometry;             ///< "box", .. or the path of a mesh
  std::size_t triangles = 0;        ///< 0: exact, no mesh was needed
  std::vector<medial::Ball> balls;  ///< in the frame of the link
  double overhang = 0;              ///< worst, upper bound, units of the robot
  double diagonal = 0;              ///< of the geometry's bounding box
};

struct SphereRobot {
  std::string name;
  std::string urdf;  ///< the document with balls in place of the collision geometry, otherwise as it was
  std::vector<RobotPart> parts;  ///< in the order of the document
  std::vector<std::string> warnings;

  /// The balls of every link that has some, in the order of the document.
  [[nodiscard]] std::vector<LinkBalls> links() const;
};

/// Replaces the collision geometry of every link. Errors, with file and link: UnreadableInput (the document,
/// a mesh, a package that is nowhere), UnsuitableMesh, InvalidArgument (settings, a budget for no link),
/// Cancelled.
Result<SphereRobot> sphereRobot(const std::filesystem::path& path, const RobotSettings& settings,
                                const medial::Context& context);

}  // namespace spheretree::io
