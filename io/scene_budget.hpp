// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include <spheretree/result.hpp>

#include "io/batch_plan.hpp"

namespace spheretree::io {

/// What a tree costs whoever uses it.
struct TreeBudget {
  std::size_t levels = 0;
  std::uint64_t spheres = 0;
  std::uint64_t fileBytes = 0;
  std::uint64_t runtimeBytes = 0;  ///< of a QueryTree
  double sphereTests = 0;          ///< predicted, per close pair
};

/// Sphere tests that a query of two close trees with so many levels takes on average. A model: measured on
/// six meshes with eight children per ball (docs/batch.md), continued by the last ratio.
[[nodiscard]] double predictedTests(std::size_t levels);

/// Of a tree that was written. Errors: UnreadableInput.
Result<TreeBudget> budgetOf(const std::filesystem::path& tree);

/// Of a tree of that many levels in which every ball has all its children.
[[nodiscard]] TreeBudget fullBudget(std::size_t levels, std::uint32_t branch);

}  // namespace spheretree::io
