// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/medial_dump.hpp"

#include <array>
#include <charconv>

namespace spheretree::io {
namespace {

void append(std::string& text, double value) {
  std::array<char, 32> digits{};  // the longest shortest form has 24
  const auto [end, code] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  static_cast<void>(code);
  text.append(digits.data(), end);
}

}  // namespace

std::string formatMedialAxis(const medial::MedialAxis& axis) {
  std::string text =
      "ply\nformat ascii 1.0\ncomment spheretree medial axis\n"
      "element vertex " +
      std::to_string(axis.balls.size()) +
      "\nproperty double x\nproperty double y\nproperty double z\nproperty double radius\n"
      "property double depth\nelement edge " +
      std::to_string(axis.neighbours.size()) + "\nproperty uint vertex1\nproperty uint vertex2\nend_header\n";
  for (const medial::MedialBall& ball : axis.balls) {
    for (const double coordinate : ball.ball.center) {
      append(text, coordinate);
      text += ' ';
    }
    append(text, ball.ball.radius);
    text += ' ';
    append(text, ball.depth);
    text += '\n';
  }
  for (const auto& [a, b] : axis.neighbours) text += std::to_string(a) + ' ' + std::to_string(b) + '\n';
  return text;
}

}  // namespace spheretree::io
