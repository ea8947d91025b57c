// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <spheretree/sphere_tree.hpp>

#include "medial/ball.hpp"

namespace spheretree::builders {

/// Chains of balls through a tree, for the proofs that a top-down search loses nothing.
///
/// A chain starts at the root, goes from node to child and ends at a node without children. Such a node
/// stands for itself on all deeper levels, so every chain reaches the last level. A convex piece is proved
/// when one chain of balls holds it whole.
class Chains {
 public:
  explicit Chains(const SphereTree& tree);

  /// A node that may hold part of a piece, and all of whose ancestors may.
  struct Link {
    std::uint32_t node = 0;
    std::uint32_t parent = 0;  ///< position in the same list; the root's own for the root
    std::uint32_t level = 0;
  };

  /// All nodes that matter inside the box, breadth-first.
  [[nodiscard]] std::vector<Link> linksIn(const Eigen::AlignedBox3d& box) const;
  /// Those of `links` that matter inside a smaller box.
  [[nodiscard]] std::vector<Link> narrowed(std::span<const Link> links, const Eigen::AlignedBox3d& box) const;

  enum class Verdict : std::uint8_t {
    Proved,   ///< one chain holds all points
    Refuted,  ///< some point is in no chain at all
    Open      ///< every point has a chain, but not all the same one
  };
  struct Judgement {
    Verdict verdict = Verdict::Proved;
    std::uint32_t level = 0;  ///< where the chains end, unless proved
  };

  /// Judges the convex hull of the points, which must lie in the box that the links are for.
  [[nodiscard]] Judgement judge(std::span<const Link> links, std::span<const Eigen::Vector3d> points) const;

 private:
  [[nodiscard]] Judgement follow(std::span<const Link> links, std::span<const Eigen::Vector3d> points) const;

  std::span<const Node> nodes_;
  std::vector<medial::Ball> balls_;
};

}  // namespace spheretree::builders
