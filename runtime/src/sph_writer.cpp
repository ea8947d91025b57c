// SPDX-License-Identifier: MIT
//
// Writes the strict `.sph` dialect of docs/file-format.md.
//
// The table is complete: child k of slot n stands in slot n * branch + 1 + k. Only the used slots of one
// level are kept in memory; the gaps between them become unused rows as the level is written. Nine
// significant digits are enough for any float to come back bit for bit.

#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <system_error>

#include <spheretree/sph.hpp>

#include "sph_table.hpp"

namespace spheretree {

namespace {

using Metadata = std::vector<std::pair<std::string, std::string>>;

constexpr std::string_view kUnusedRow = "0 0 0 -1 0\n";
constexpr std::string_view kImportance = " 1\n";  // what every known writer puts there
constexpr int kDigits = std::numeric_limits<float>::max_digits10;
constexpr std::size_t kLongestFloat = 15;  // -1.17549435e-38
constexpr std::size_t kLongestRow = 4 * kLongestFloat + 3 + kImportance.size();

/// A node and where its row stands among the slots of its level.
struct Placed {
  const Node* node;
  std::uint64_t slot;
};

Error invalid(std::string message) {
  return {ErrorCode::InvalidArgument, std::move(message)};
}

void appendFloat(std::string& out, float value) {
  char digits[2 * kLongestFloat];
  const auto [end, code] =
      std::to_chars(digits, digits + sizeof digits, value, std::chars_format::general, kDigits);
  if (code == std::errc{}) out.append(digits, end);
}

/// A point at the origin would read back as an unused slot; the smallest normal radius still covers it.
float writtenRadius(const Sphere& ball) noexcept {
  const bool readsAsUnused = ball.radius == 0 && ball.center == Vec3{};
  return readsAsUnused ? std::numeric_limits<float>::min() : ball.radius;
}

void appendRow(std::string& out, const Sphere& ball) {
  for (const float coordinate : {ball.center.x, ball.center.y, ball.center.z}) {
    appendFloat(out, coordinate);
    out += ' ';
  }
  appendFloat(out, writtenRadius(ball));
  out += kImportance;
}

void appendUnusedRows(std::string& out, std::uint64_t count) {
  for (std::uint64_t i = 0; i < count; ++i) out += kUnusedRow;
}

/// The slots of the level below, in order.
std::vector<Placed> placeChildren(const SphereTree& tree, std::span<const Placed> level,
                                  std::uint64_t branch) {
  std::vector<Placed> below;
  for (const Placed& parent : level) {
    std::uint64_t slot = parent.slot * branch;
    for (const Node& child : tree.children(*parent.node)) below.push_back({&child, slot++});
  }
  return below;
}

void appendTable(std::string& out, const SphereTree& tree, std::uint64_t branch) {
  std::vector<Placed> level{{&tree.root(), 0}};
  std::uint64_t slotsOfLevel = 1;
  for (std::size_t depth = 0; depth < tree.levelCount(); ++depth) {
    std::uint64_t next = 0;  // the first slot that has no row yet
    for (const Placed& placed : level) {
      appendUnusedRows(out, placed.slot - next);
      appendRow(out, placed.node->ball);
      next = placed.slot + 1;
    }
    appendUnusedRows(out, slotsOfLevel - next);
    level = placeChildren(tree, level, branch);
    slotsOfLevel *= branch;
  }
}

bool holdsBreak(std::string_view text) noexcept {
  return text.find_first_of(std::string_view("\n\r\0", 3)) != std::string_view::npos;
}

bool isBlank(char c) noexcept {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

/// Refuses what parseSph could not give back unchanged.
std::optional<Error> flawOf(const Metadata& metadata) {
  for (const auto& [key, value] : metadata) {
    if (key.empty()) return invalid("a metadata key is empty");
    if (holdsBreak(key) || holdsBreak(value)) {
      return invalid("metadata '" + key + "': a key or value holds a line break or a NUL");
    }
    if (key.find(':') != std::string::npos || isBlank(key.front()) || isBlank(key.back())) {
      return invalid("metadata '" + key + "': a key holds a colon or begins or ends with a blank");
    }
  }
  return std::nullopt;
}

}  // namespace

Result<std::string> formatSph(const SphereTree& tree, std::uint32_t branch, const Metadata& metadata) {
  if (branch < 1) return invalid("a branching factor of 0 holds no tree");
  if (tree.maxChildren() > branch) {
    return invalid("a node has " + std::to_string(tree.maxChildren()) +
                   " children, more than the branching factor " + std::to_string(branch));
  }
  const std::optional<std::uint64_t> rows = sphRowCount(tree.levelCount(), branch);
  if (!rows || *rows > kMaxSphRows) {
    return invalid(std::to_string(tree.levelCount()) + " levels of branch " + std::to_string(branch) +
                   " need more than " + std::to_string(kMaxSphRows) + " rows");
  }
  if (std::optional<Error> flaw = flawOf(metadata)) return *std::move(flaw);

  std::string out = std::to_string(tree.levelCount()) + ' ' + std::to_string(branch) + '\n';
  const std::size_t used = tree.nodes().size();
  out.reserve(out.size() + used * kLongestRow + (static_cast<std::size_t>(*rows) - used) * kUnusedRow.size());
  appendTable(out, tree, branch);
  for (const auto& [key, value] : metadata)
    out.append("# ").append(key).append(": ").append(value).append("\n");
  return out;
}

}  // namespace spheretree
