// SPDX-License-Identifier: GPL-3.0-or-later
//
// What reading a robot description needs besides an XML library: places in the text, so that all but the
// collision geometry stays as it is to the byte, and meshes of the primitives.
#include "io/urdf_parts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace spheretree::io {
namespace {

using Eigen::Vector3d;
using medial::TriangleMesh;

// Corners of a circle: a polygon with so many is within 0.25 % of the radius.
constexpr std::uint32_t kSegments = 45;
// Rings of a half ball, as fine.
constexpr std::uint32_t kRings = 12;

/// Behind the end mark that comes next, or the end of the text.
std::size_t behind(std::string_view xml, std::string_view mark, std::size_t from) {
  const std::size_t at = xml.find(mark, from);
  return at == std::string_view::npos ? xml.size() : at + mark.size();
}

/// Behind the tag that begins at `at`; quoted values may hold `>`.
std::size_t behindTag(std::string_view xml, std::size_t at) {
  char quote = 0;
  for (; at < xml.size(); ++at) {
    const char letter = xml[at];
    if (quote != 0) {
      if (letter == quote) quote = 0;
    } else if (letter == '"' || letter == '\'') {
      quote = letter;
    } else if (letter == '>') {
      return at + 1;
    }
  }
  return at;
}

struct Token {
  enum class Kind : std::uint8_t { Open, Close, Whole, Comment, Other };
  Kind kind = Kind::Other;
  std::string_view name;
  TextRange range;
};

/// The next thing in angle brackets; an empty range at the end of the text.
Token nextToken(std::string_view xml, std::size_t from) {
  Token token;
  const std::size_t begin = std::min(xml.find('<', from), xml.size());
  token.range = {begin, xml.size()};
  if (begin == xml.size()) return token;
  const std::string_view rest = xml.substr(begin);
  if (rest.substr(0, 4) == "<!--") {
    token.kind = Token::Kind::Comment;
    token.range.end = behind(xml, "-->", begin + 4);
  } else if (rest.substr(0, 9) == "<![CDATA[") {
    token.range.end = behind(xml, "]]>", begin);
  } else if (rest.substr(0, 2) == "<?") {
    token.range.end = behind(xml, "?>", begin);
  } else {
    const bool closes = rest.substr(0, 2) == "</";
    const std::size_t name = begin + (closes ? 2 : 1);
    token.range.end = behindTag(xml, begin);
    const std::size_t nameEnd = std::min(xml.find_first_of(" \t\r\n/>", name), xml.size());
    token.name = xml.substr(name, nameEnd - name);
    const bool whole = token.range.end >= begin + 3 && xml[token.range.end - 2] == '/';
    token.kind = closes ? Token::Kind::Close : whole ? Token::Kind::Whole : Token::Kind::Open;
  }
  return token;
}

/// A closed surface of revolution: rings of `kSegments` corners between two poles, from below to above.
TriangleMesh revolved(double lowPole, const std::vector<std::pair<double, double>>& rings, double highPole) {
  TriangleMesh mesh;
  mesh.vertices.emplace_back(0, 0, lowPole);
  for (const auto& [radius, z] : rings) {
    for (std::uint32_t k = 0; k < kSegments; ++k) {
      const double angle = 2 * std::numbers::pi * k / kSegments;
      mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  }
  mesh.vertices.emplace_back(0, 0, highPole);
  const auto top = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  const auto corner = [](std::size_t ring, std::uint32_t k) {
    return static_cast<std::uint32_t>(1 + ring * kSegments + k % kSegments);
  };
  for (std::uint32_t k = 0; k < kSegments; ++k) {
    mesh.triangles.push_back({0, corner(0, k + 1), corner(0, k)});
    for (std::size_t ring = 0; ring + 1 < rings.size(); ++ring) {
      mesh.triangles.push_back({corner(ring, k), corner(ring, k + 1), corner(ring + 1, k + 1)});
      mesh.triangles.push_back({corner(ring, k), corner(ring + 1, k + 1), corner(ring + 1, k)});
    }
    mesh.triangles.push_back({corner(rings.size() - 1, k), corner(rings.size() - 1, k + 1), top});
  }
  return mesh;
}

}  // namespace

std::vector<TextRange> elementRanges(std::string_view xml, std::string_view name) {
  std::vector<TextRange> ranges;
  std::vector<std::size_t> open;  // places in `ranges`
  for (Token token = nextToken(xml, 0); token.range.begin < xml.size();
       token = nextToken(xml, token.range.end)) {
    if (token.name != name) continue;
    if (token.kind == Token::Kind::Close) {
      if (open.empty()) continue;
      ranges[open.back()].end = token.range.end;
      open.pop_back();
    } else {
      if (token.kind == Token::Kind::Open) open.push_back(ranges.size());
      ranges.push_back(token.range);
    }
  }
  return ranges;
}

std::vector<TextRange> commentRanges(std::string_view xml) {
  std::vector<TextRange> ranges;
  for (Token token = nextToken(xml, 0); token.range.begin < xml.size();
       token = nextToken(xml, token.range.end)) {
    if (token.kind == Token::Kind::Comment) ranges.push_back(token.range);
  }
  return ranges;
}

TriangleMesh boxMesh(const Vector3d& size) {
  TriangleMesh mesh;
  for (int k = 0; k < 8; ++k) {
    const Vector3d corner((k & 1) != 0 ? 0.5 : -0.5, (k & 2) != 0 ? 0.5 : -0.5, (k & 4) != 0 ? 0.5 : -0.5);
    mesh.vertices.emplace_back(corner.cwiseProduct(size));
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

RoundMesh cylinderMesh(double radius, double length) {
  const double half = length / 2;
  return {revolved(-half, {{radius, -half}, {radius, half}}, half),
          radius * (1 - std::cos(std::numbers::pi / kSegments))};
}

RoundMesh capsuleMesh(double radius, double length) {
  const double half = length / 2;
  const double step = std::numbers::pi / 2 / kRings;
  std::vector<std::pair<double, double>> rings;
  for (std::uint32_t k = 1; k <= kRings; ++k)
    rings.emplace_back(radius * std::sin(k * step), -half - radius * std::cos(k * step));
  for (std::uint32_t k = kRings; k >= 1; --k)
    rings.emplace_back(radius * std::sin(k * step), half + radius * std::cos(k * step));
  if (length <= 0) rings.erase(rings.begin() + kRings);  // a ball has one equator
  // A facet lies below the ball by no more than the two arcs that it spans.
  const double lost = 1 - std::cos(std::numbers::pi / kSegments) * std::cos(step / 2);
  return {revolved(-half - radius, rings, half + radius), radius * lost};
}

}  // namespace spheretree::io
