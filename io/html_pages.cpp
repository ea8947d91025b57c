// SPDX-License-Identifier: GPL-3.0-or-later
//
// A page is a template of io/html/ with its style, its scripts and its data put in place of `{{name}}`. The
// scripts draw the page from the same JSON that other programs read. What only the picture needs travels as
// base64: 16-bit steps for the vertices of the mesh, the floats of the balls as they are.
#include "io/html_pages.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <nlohmann/json.hpp>

#include "io/html/assets.hpp"
#include "io/mesh_simplify.hpp"
#include "io/pair_timing.hpp"
#include "io/report_parts.hpp"

namespace spheretree::io {
namespace {

using Json = nlohmann::ordered_json;
using Eigen::Vector3d;

// More triangles than this make a page slow and large, and the picture no better.
constexpr std::size_t kMostTriangles = 60'000;
constexpr double kMostSteps = 65535;  // vertices have 16 bits along each axis of the mesh's box

// Poses that a page's plot of speed is measured on: some tenths of a second, and the mean is steady.
constexpr std::size_t kPoses = 200;
constexpr std::uint64_t kPoseSeed = 1;

constexpr const char* kNoHtml =
    "HTML reports need the packages libjs-three and libjs-chart.js, which were missing when this program was "
    "built";

// --- text ---

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    std::uint32_t word = 0;
    const std::size_t here = std::min<std::size_t>(3, bytes.size() - k);
    for (std::size_t b = 0; b < 3; ++b) {
      word = word << 8U | (b < here ? static_cast<unsigned char>(bytes[k + b]) : 0U);
    }
    for (unsigned digit = 0; digit < 4; ++digit) {
      text += digit <= here ? kDigits[word >> (18U - 6 * digit) & 63U] : '=';
    }
  }
  return text;
}

/// Little-endian bytes, whatever the machine has.
class Packed {
 public:
  void add8(std::uint8_t value) { bytes_ += static_cast<char>(value); }
  void add16(std::uint32_t value) {
    add8(static_cast<std::uint8_t>(value & 255U));
    add8(static_cast<std::uint8_t>(value >> 8U & 255U));
  }
  void add32(std::uint32_t value) {
    add16(value & 65535U);
    add16(value >> 16U);
  }
  void add(float value) { add32(std::bit_cast<std::uint32_t>(value)); }
  [[nodiscard]] std::string text() const { return base64(bytes_); }

 private:
  std::string bytes_;
};

/// JSON inside a `<script>`: no string of it can end that, or begin a comment.
std::string embedded(const Json& json) {
  std::string text;
  for (const char letter : json.dump(-1, ' ', false, Json::error_handler_t::replace)) {
    if (letter == '<') {
      text += "\\u003c";
    } else {
      text += letter;
    }
  }
  return text;
}

using Data = std::vector<std::pair<std::string_view, std::string>>;

std::string filled(std::string_view text, const Data& data) {
  std::string page;
  while (true) {
    const std::size_t begin = text.find("{{");
    const std::size_t end = text.find("}}", begin);
    if (end == std::string_view::npos) return page += text;
    const std::string_view name = text.substr(begin + 2, end - begin - 2);
    page += text.substr(0, begin);
    const auto given = std::find_if(data.begin(), data.end(), [&](const auto& d) { return d.first == name; });
    page += given != data.end() ? std::string_view(given->second) : htmlAsset(name);
    text.remove_prefix(end + 2);
  }
}

Error notMade() {
  return {ErrorCode::InvalidArgument, whyNoHtml()};
}

// --- the picture ---

Json meshOf(const medial::TriangleMesh& mesh) {
  const Eigen::AlignedBox3d box = medial::boundsOf(mesh);
  const Vector3d step = (box.sizes() / kMostSteps).cwiseMax(std::numeric_limits<double>::min());
  Packed positions;
  for (const Vector3d& vertex : mesh.vertices) {
    for (int k = 0; k < 3; ++k) {
      const double steps = std::clamp(std::round((vertex[k] - box.min()[k]) / step[k]), 0.0, kMostSteps);
      positions.add16(static_cast<std::uint32_t>(steps));
    }
  }
  const bool narrow = mesh.vertices.size() <= static_cast<std::size_t>(kMostSteps);
  Packed triangles;
  for (const auto& triangle : mesh.triangles) {
    for (const auto vertex : triangle) {
      const auto index = static_cast<std::uint32_t>(vertex);
      narrow ? triangles.add16(index) : triangles.add32(index);
    }
  }
  return {{"shown", mesh.triangles.size()},         {"min", {box.min().x(), box.min().y(), box.min().z()}},
          {"step", {step.x(), step.y(), step.z()}}, {"index_bytes", narrow ? 2 : 4},
          {"positions", positions.text()},          {"triangles", triangles.text()}};
}

/// The mesh, or one with fewer triangles that looks the same from where a page shows it.
Json shownMesh(const medial::TriangleMesh& mesh) {
  if (mesh.triangles.size() <= kMostTriangles) return meshOf(mesh);
  const Result<medial::TriangleMesh> fewer = simplifyMesh(mesh, kMostTriangles);
  return meshOf(fewer ? fewer.value() : mesh);
}

/// Names of reducers, numbered as they come; number 0 is nobody.
class MakerNames {
 public:
  std::uint8_t number(std::string_view name) {
    const auto at = std::find(names_.begin(), names_.end(), name);
    if (at == names_.end()) names_.emplace_back(name);
    return static_cast<std::uint8_t>(std::find(names_.begin(), names_.end(), name) - names_.begin());
  }
  [[nodiscard]] const std::vector<std::string>& all() const { return names_; }

 private:
  std::vector<std::string> names_{""};
};

Json levelOf(const LevelView& level, const SphereTree& tree, MakerNames& names) {
  Packed balls;
  Packed overhang;
  Packed parents;
  Packed makers;
  for (std::size_t k = 0; k < level.nodes.size(); ++k) {
    const Node& node = tree.nodes()[level.nodes[k]];
    for (const float number : {node.ball.center.x, node.ball.center.y, node.ball.center.z, node.ball.radius})
      balls.add(number);
    overhang.add(static_cast<float>(level.overhang[k]));
    parents.add32(node.parent == kNoParent ? 0 : node.parent);
    if (!level.won.empty()) makers.add8(names.number(level.won[k]));
  }
  return {{"balls", balls.text()},
          {"overhang", overhang.text()},
          {"parents", parents.text()},
          {"makers", level.won.empty() ? Json(nullptr) : Json(makers.text())}};
}

Json viewOf(const TreeView& view) {
  const Eigen::AlignedBox3d box = medial::boundsOf(view.mesh);
  MakerNames names;
  Json levels = Json::array();
  for (const LevelView& level : view.levels) levels.push_back(levelOf(level, view.tree, names));
  const Vector3d centre = box.center();
  return {{"centre", {centre.x(), centre.y(), centre.z()}},
          {"diagonal", box.diagonal().norm()},
          {"mesh", shownMesh(view.mesh)},
          {"makers", names.all()},
          {"levels", std::move(levels)}};
}

/// Adds to each level of a report what queries down to it cost.
void addCosts(Json& report, const SphereTree& tree, const medial::TriangleMesh& mesh, PageTimes times) {
  const std::vector<PairCost> costs = pairCosts(tree, closePoses(mesh, kPoses, kPoseSeed));
  for (std::size_t k = 0; k < costs.size() && k < report["levels"].size(); ++k) {
    if (times == PageTimes::Shown) report["levels"][k]["microseconds_per_close_pair"] = costs[k].microseconds;
    report["levels"][k]["sphere_tests_per_close_pair"] = costs[k].sphereTests;
  }
}

}  // namespace

std::string whyNoHtml() {
  return htmlAsset("three.js").empty() || htmlAsset("chart.js").empty() ? kNoHtml : "";
}

Result<std::string> treePage(const std::string& reportJson, const TreeView& view, PageTimes times) {
  if (!whyNoHtml().empty()) return notMade();
  Json report = Json::parse(times == PageTimes::Shown ? reportJson : withoutClock(reportJson));
  addCosts(report, view.tree, view.mesh, times);
  return filled(htmlAsset("tree_page.html"),
                {{"report", embedded(report)}, {"view", embedded(viewOf(view))}});
}

Result<std::string> formatHtmlReport(const builders::BuildResult& build, const Provenance& provenance,
                                     const medial::Surface& surface, PageTimes times) {
  TreeView view{surface.mesh(), build.tree, {}};
  std::size_t first = 0;
  for (const builders::LevelReport& level : build.report.levels) {
    LevelView& shown = view.levels.emplace_back();
    for (std::size_t k = 0; k < level.metrics.spheres; ++k) shown.nodes.push_back(first + k);
    shown.overhang = level.metrics.ballOverhang;
    shown.won = level.makers;
    first += level.metrics.spheres;
  }
  return treePage(formatJsonReport(build, provenance), view, times);
}

Result<std::string> batchPage(std::string_view summaryJson, std::span<const std::string> thumbnails) {
  if (!whyNoHtml().empty()) return notMade();
  Json pictures = Json::array();
  for (const std::string& thumbnail : thumbnails) pictures.push_back(thumbnail);
  return filled(htmlAsset("batch_page.html"),
                {{"summary", embedded(Json::parse(summaryJson))}, {"thumbnails", embedded(pictures)}});
}

Result<std::string> comparePage(std::string_view compareJson) {
  if (!whyNoHtml().empty()) return notMade();
  return filled(htmlAsset("compare_page.html"), {{"comparison", embedded(Json::parse(compareJson))}});
}

}  // namespace spheretree::io
