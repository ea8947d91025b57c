// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/scene_budget.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include <spheretree/query_tree.hpp>
#include <spheretree/sph.hpp>

#include "io/files.hpp"
#include "io/tree_files.hpp"

namespace spheretree::io {
namespace {

// Mean over bunny, cow, fandisk, knot and gear, 2000 close poses each, as `spheretree compare` measures them
// (docs/batch.md has them one by one).
constexpr std::array kTests{1.0, 56.0, 133.0, 197.0};
constexpr double kTestsGrowth = 1.5;  // per level beyond the table: the ratio of its last two
// Of a row of numbers in a `.sph`: that of the bunny's.
constexpr double kBytesPerRow = 53;
// A complete tree up to this size is laid out to see what it takes; larger ones take as much per ball.
constexpr double kMostLaidOut = 100'000;

/// A tree with all its children and balls that do not matter.
SphereTree completeTree(std::size_t levels, std::uint32_t branch) {
  std::vector<SphereTree::Entry> entries{{{{0, 0, 0}, 1}, kNoParent}};
  std::size_t begin = 0;
  for (std::size_t depth = 1; depth < levels; ++depth) {
    const std::size_t end = entries.size();
    for (std::size_t parent = begin; parent < end; ++parent) {
      for (std::uint32_t k = 0; k < branch; ++k)
        entries.push_back({{{0, 0, 0}, 1}, static_cast<std::uint32_t>(parent)});
    }
    begin = end;
  }
  Result<SphereTree> tree = SphereTree::create(entries);
  return std::move(*tree);
}

double ballsOf(std::size_t levels, std::uint32_t branch) {
  double balls = 0;
  for (std::size_t depth = 0; depth < levels; ++depth) balls += std::pow(branch, static_cast<double>(depth));
  return balls;
}

std::uint64_t whole(double value) {
  constexpr double kMost = 1e18;  // fits, and nobody has it
  return static_cast<std::uint64_t>(std::min(value, kMost));
}

std::uint64_t layoutBytes(std::size_t levels, std::uint32_t branch) {
  std::size_t laidOut = levels;
  while (laidOut > 2 && ballsOf(laidOut, branch) > kMostLaidOut) --laidOut;
  const Result<QueryTree> tree = QueryTree::create(completeTree(laidOut, branch));
  if (!tree) return 0;  // more children than queries accept
  return whole(static_cast<double>(tree->bytes()) * ballsOf(levels, branch) / ballsOf(laidOut, branch));
}

}  // namespace

double predictedTests(std::size_t levels) {
  if (levels == 0) return 0;
  if (levels <= kTests.size()) return kTests[levels - 1];
  return kTests.back() * std::pow(kTestsGrowth, static_cast<double>(levels - kTests.size()));
}

Result<TreeBudget> budgetOf(const std::filesystem::path& path) {
  const Result<std::string> text = readFile(path);
  if (!text) return text.error();
  const Result<SphFile> file = parseSph(*text);
  if (!file) return Error{file.error().code, path.string() + ": " + file.error().message};
  const Result<QueryTree> query = QueryTree::create(file->tree);
  TreeBudget budget;
  budget.levels = file->tree.levelCount();
  budget.spheres = file->tree.nodes().size();
  budget.fileBytes = text->size();
  budget.runtimeBytes = query ? query->bytes() : 0;
  budget.sphereTests = predictedTests(budget.levels);
  return budget;
}

TreeBudget fullBudget(std::size_t levels, std::uint32_t branch) {
  const double balls = ballsOf(levels, branch);
  return {levels, whole(balls), whole(balls * kBytesPerRow), layoutBytes(levels, branch),
          predictedTests(levels)};
}

}  // namespace spheretree::io
