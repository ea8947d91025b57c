// SPDX-License-Identifier: GPL-3.0-or-later
//
// SRDF, https://wiki.ros.org/srdf: `<link_sphere_approximation>` is what MoveIt's distance fields read.
#include "io/export_formats.hpp"
#include "io/report_parts.hpp"

namespace spheretree::io {

std::string srdfText(std::string_view robot, std::span<const LinkBalls> links) {
  std::string text = "<?xml version=\"1.0\"?>\n<robot name=\"" + xmlQuoted(robot) + "\">\n";
  for (const LinkBalls& link : links) {
    text += "  <link_sphere_approximation link=\"" + xmlQuoted(link.link) + "\">\n";
    for (const medial::Ball& ball : link.balls) {
      text += "    <sphere center=\"" + xmlTriple(ball.center) + "\" radius=\"" + exactNumber(ball.radius) +
              "\"/>\n";
    }
    text += "  </link_sphere_approximation>\n";
  }
  return text + "</robot>\n";
}

}  // namespace spheretree::io
