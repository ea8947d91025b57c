// SPDX-License-Identifier: GPL-3.0-or-later
//
// The sphere file of a robot for cuRobo, https://curobo.org: `collision_spheres`, a list of center and radius
// by link. Names are quoted as in JSON, which YAML reads the same way.
#include <nlohmann/json.hpp>

#include "io/export_formats.hpp"
#include "io/report_parts.hpp"

namespace spheretree::io {
namespace {

/// With a point, so that no reader takes it for an integer or, with an exponent, for a word (YAML 1.1).
std::string yamlNumber(double value) {
  std::string text = exactNumber(value);
  const std::size_t exponent = text.find('e');
  if (text.find('.') == std::string::npos) text.insert(std::min(exponent, text.size()), ".0");
  return text;
}

std::string yamlText(std::string_view text) {
  using Json = nlohmann::json;
  return Json(std::string(text)).dump(-1, ' ', true, Json::error_handler_t::replace);
}

}  // namespace

std::string curoboText(std::string_view robot, std::span<const LinkBalls> links) {
  std::string text = "# Collision spheres of " + yamlText(robot) + "\ncollision_spheres:\n";
  for (const LinkBalls& link : links) {
    text += "  " + yamlText(link.link) + ":" + (link.balls.empty() ? " []\n" : "\n");
    for (const medial::Ball& ball : link.balls) {
      text += "    - center: [" + yamlNumber(ball.center.x()) + ", " + yamlNumber(ball.center.y()) + ", " +
              yamlNumber(ball.center.z()) + "]\n      radius: " + yamlNumber(ball.radius) + "\n";
    }
  }
  return text;
}

}  // namespace spheretree::io
