// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/level_table.hpp"

#include <array>
#include <cstddef>
#include <cstdio>
#include <utility>
#include <vector>

#include "cli/console.hpp"
#include "cli/text_table.hpp"

namespace spheretree::cli {
namespace {

constexpr int kLengthDigits = 4;
constexpr int kShareDigits = 3;

std::string fixed(double value, int decimals) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

std::string percentOf(double length, double diagonal) {
  return fixed(100 * length / diagonal, 2);
}

/// "yes" only when proved; otherwise what may be missing.
std::string coverText(bool certified, double uncovered) {
  return certified ? "yes" : "not " + shortNumber(100 * uncovered, kShareDigits) + " %";
}

}  // namespace

std::string levelTable(std::span<const builders::LevelMetrics* const> levels, double diagonal,
                       std::span<const std::string> setsWon) {
  std::vector<TextTable::Column> columns{{"level"},        {"spheres"},         {"worst %"},
                                         {"mean %"},       {"worst"},           {"mean"},
                                         {"volume ratio"}, {"surface covered"}, {"solid covered"}};
  if (!setsWon.empty()) columns.push_back({"sets won", TextTable::Align::Left});
  TextTable table(std::move(columns));
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const builders::LevelMetrics& m = *levels[k];
    std::vector<std::string> cells{std::to_string(k),
                                   std::to_string(m.spheres),
                                   percentOf(m.overhangWorst.upper, diagonal),
                                   percentOf(m.overhangMean, diagonal),
                                   shortNumber(m.overhangWorst.upper, kLengthDigits),
                                   shortNumber(m.overhangMean, kLengthDigits),
                                   fixed(m.volumeRatio, 3),
                                   coverText(m.surface.certified, m.surface.uncovered.upper),
                                   coverText(m.solid.certified, m.solid.uncovered.upper)};
    if (!setsWon.empty()) cells.push_back(setsWon[k]);
    table.add(std::move(cells));
  }
  return "overhang: in % of the diagonal, then in mesh units\n" + table.text();
}

}  // namespace spheretree::cli
