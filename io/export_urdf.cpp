// SPDX-License-Identifier: GPL-3.0-or-later
//
// URDF, https://wiki.ros.org/urdf/XML/link: spheres have no orientation, so that their origin is a place.
#include <array>

#include "io/export_formats.hpp"
#include "io/report_parts.hpp"

namespace spheretree::io {

std::string xmlQuoted(std::string_view text) {
  std::string quoted;
  for (const char letter : text) {
    switch (letter) {
      case '&':
        quoted += "&amp;";
        break;
      case '<':
        quoted += "&lt;";
        break;
      case '>':
        quoted += "&gt;";
        break;
      case '"':
        quoted += "&quot;";
        break;
      default:
        quoted += letter;
    }
  }
  return quoted;
}

std::string xmlTriple(const Eigen::Vector3d& v) {
  return exactNumber(v.x()) + " " + exactNumber(v.y()) + " " + exactNumber(v.z());
}

std::string collisionXml(const medial::Ball& ball, std::string_view name, std::string_view extra,
                         std::string_view indent) {
  const std::string line = "\n" + std::string(indent);
  std::string text = "<collision";
  if (!name.empty()) text += " name=\"" + xmlQuoted(name) + "\"";
  text += ">" + line + "  <origin xyz=\"" + xmlTriple(ball.center) + "\" rpy=\"0 0 0\"/>";
  text += line + "  <geometry><sphere radius=\"" + exactNumber(ball.radius) + "\"/></geometry>";
  if (!extra.empty()) text += line + "  " + std::string(extra);
  return text + line + "</collision>";
}

std::string urdfText(std::string_view robot, std::span<const LinkBalls> links) {
  std::string text = "<?xml version=\"1.0\"?>\n<robot name=\"" + xmlQuoted(robot) + "\">\n";
  for (const LinkBalls& link : links) {
    text += "  <link name=\"" + xmlQuoted(link.link) + "\">\n";
    for (const medial::Ball& ball : link.balls) text += "    " + collisionXml(ball, "", "", "    ") + "\n";
    text += "  </link>\n";
  }
  return text + "</robot>\n";
}

}  // namespace spheretree::io
