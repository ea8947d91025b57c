// SPDX-License-Identifier: GPL-3.0-or-later
//
// A picture of a tree for a cell of a table: the balls of one level as shaded discs, painted from far to
// near, on whole coordinates.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "io/html_pages.hpp"

namespace spheretree::io {
namespace {

using Eigen::Vector3d;

// As many as can be told apart on a thumbnail, and few enough for a page with hundreds of them.
constexpr std::size_t kMostBalls = 100;
constexpr double kSide = 1000;  // of the picture, in its own units
constexpr double kMargin = 20;
// The view that the page of a tree opens with (io/html/tree_view.js), in radians.
constexpr double kYaw = 0.55;
constexpr double kPitch = 0.3;

struct Disc {
  double x = 0;
  double y = 0;
  double radius = 0;
  double depth = 0;
};

std::span<const Node> shownLevel(const SphereTree& tree) {
  std::size_t depth = 0;
  while (depth + 1 < tree.levelCount() && tree.level(depth + 1).size() <= kMostBalls) ++depth;
  return tree.level(depth);
}

std::vector<Disc> discsOf(std::span<const Node> nodes) {
  const Eigen::Matrix3d view =
      (Eigen::AngleAxisd(kPitch, Vector3d::UnitX()) * Eigen::AngleAxisd(-kYaw, Vector3d::UnitY()))
          .toRotationMatrix();
  std::vector<Disc> discs;
  Eigen::AlignedBox2d box;
  for (const Node& node : nodes) {
    const Vector3d centre =
        view * Vector3d(static_cast<double>(node.ball.center.x), static_cast<double>(node.ball.center.y),
                        static_cast<double>(node.ball.center.z));
    const double radius = static_cast<double>(node.ball.radius);
    discs.push_back({centre.x(), -centre.y(), radius, centre.z()});
    const Eigen::Vector2d at(centre.x(), -centre.y());
    box.extend(Eigen::Vector2d(at.array() - radius));
    box.extend(Eigen::Vector2d(at.array() + radius));
  }
  const double size = box.sizes().maxCoeff();
  const double scale = size > 0 ? (kSide - 2 * kMargin) / size : 1;
  for (Disc& disc : discs) {
    disc.x = kSide / 2 + (disc.x - box.center().x()) * scale;
    disc.y = kSide / 2 + (disc.y - box.center().y()) * scale;
    disc.radius *= scale;
  }
  std::stable_sort(discs.begin(), discs.end(),
                   [](const Disc& a, const Disc& b) { return a.depth < b.depth; });
  return discs;
}

std::string whole(double value) {
  return std::to_string(std::lround(value));
}

}  // namespace

std::string thumbnailSvg(const SphereTree& tree) {
  std::string svg =
      R"(<svg class="thumbnail" xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1000 1000" aria-hidden="true">)"
      R"(<defs><radialGradient id="ball" cx=".36" cy=".3" r=".75"><stop offset="0" stop-color="#d6e9ff"/>)"
      R"(<stop offset=".55" stop-color="#4f97dd"/><stop offset="1" stop-color="#174a86"/></radialGradient></defs>)"
      "<g fill=\"url(#ball)\">";
  for (const Disc& disc : discsOf(shownLevel(tree))) {
    svg += "<circle cx=\"" + whole(disc.x) + "\" cy=\"" + whole(disc.y) + "\" r=\"" +
           whole(std::max(disc.radius, 1.0)) + "\"/>";
  }
  return svg + "</g></svg>";
}

}  // namespace spheretree::io
