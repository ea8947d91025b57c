// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which chains of a tree hold a convex piece. A node holds the piece "in chain" when it holds all its points
// and its parent does so in chain; one pass over the nodes, parents first, decides.

#include "builders/chains.hpp"

#include <algorithm>

#include "builders/ball_index.hpp"
#include "builders/holds.hpp"
#include "builders/metrics.hpp"

namespace spheretree::builders {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

Chains::Chains(const SphereTree& tree) : nodes_(tree.nodes()), balls_(ballsOf(tree.nodes())) {}

std::vector<Chains::Link> Chains::linksIn(const AlignedBox3d& box) const {
  std::vector<Link> links;
  if (meets(balls_[0], box)) links.push_back({0, 0, 0});
  for (std::uint32_t at = 0; at < links.size(); ++at) {
    const Link link = links[at];
    const Node& node = nodes_[link.node];
    for (std::uint32_t child = node.firstChild; child < node.firstChild + node.childCount; ++child) {
      if (meets(balls_[child], box)) links.push_back({child, at, link.level + 1});
    }
  }
  return links;
}

std::vector<Chains::Link> Chains::narrowed(std::span<const Link> links, const AlignedBox3d& box) const {
  constexpr std::uint32_t kGone = 0xffffffffU;
  std::vector<Link> kept;
  std::vector<std::uint32_t> place(links.size(), kGone);
  kept.reserve(links.size());
  for (std::uint32_t at = 0; at < links.size(); ++at) {
    const Link& link = links[at];
    const bool parentKept = link.parent == at || place[link.parent] != kGone;
    if (!parentKept || !meets(balls_[link.node], box)) continue;
    place[at] = static_cast<std::uint32_t>(kept.size());
    kept.push_back({link.node, link.parent == at ? place[at] : place[link.parent], link.level});
  }
  return kept;
}

/// Proved, or Open with the first level that no chain reaches.
Chains::Judgement Chains::follow(std::span<const Link> links, std::span<const Vector3d> points) const {
  Judgement result{Verdict::Open, 0};
  std::vector<char> inChain(links.size(), 0);
  for (std::uint32_t at = 0; at < links.size(); ++at) {
    const Link& link = links[at];
    if (link.parent != at && inChain[link.parent] == 0) continue;
    const medial::Ball& ball = balls_[link.node];
    if (!std::all_of(points.begin(), points.end(), [&](const Vector3d& p) { return holds(ball, p); }))
      continue;
    if (nodes_[link.node].childCount == 0) return {Verdict::Proved, 0};
    inChain[at] = 1;
    result.level = std::max(result.level, link.level + 1);
  }
  return result;
}

Chains::Judgement Chains::judge(std::span<const Link> links, std::span<const Vector3d> points) const {
  const Judgement whole = follow(links, points);
  if (whole.verdict == Verdict::Proved) return whole;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Judgement alone = follow(links, points.subspan(k, 1));
    if (alone.verdict != Verdict::Proved) return {Verdict::Refuted, alone.level};
  }
  return whole;
}

}  // namespace spheretree::builders
