// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "medial/ball.hpp"

namespace spheretree::builders {

/// A tree under construction, in double: what every builder returns.
struct BallTree {
  struct Node {
    medial::Ball ball;
    std::uint32_t parent = 0;  ///< index in the level above; 0 for the root
    std::string_view maker{};  ///< name of the catalogue; empty: not a choice among children (root, repeated)
  };

  /// levels[0] is the root alone; children stand in the order of their parents.
  std::vector<std::vector<Node>> levels;
  /// Per level, how many sets of balls each reducer contributed.
  std::vector<std::vector<std::pair<std::string, std::size_t>>> winners;
};

}  // namespace spheretree::builders
