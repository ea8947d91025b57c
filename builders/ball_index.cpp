// SPDX-License-Identifier: GPL-3.0-or-later
//
// A binary hierarchy of bounding boxes, split at the median of the centres along the longest side.

#include "builders/ball_index.hpp"

#include <algorithm>

namespace spheretree::builders {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

constexpr std::uint32_t kLeafSize = 4;

}  // namespace

BallIndex::BallIndex(std::span<const medial::Ball> balls) : balls_(balls), order_(balls.size()) {
  for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
  if (balls.empty()) return;
  nodes_.emplace_back();
  build(0, 0, static_cast<std::uint32_t>(balls.size()));
}

void BallIndex::build(std::uint32_t node, std::uint32_t first, std::uint32_t last) {
  AlignedBox3d box;
  AlignedBox3d centers;
  for (std::uint32_t k = first; k < last; ++k) {
    const medial::Ball& ball = balls_[order_[k]];
    box.extend(AlignedBox3d(ball.center.array() - ball.radius, ball.center.array() + ball.radius));
    centers.extend(ball.center);
  }
  nodes_[node].box = box;
  if (last - first <= kLeafSize) {
    nodes_[node].first = first;
    nodes_[node].count = last - first;
    return;
  }
  Eigen::Index axis = 0;
  centers.sizes().maxCoeff(&axis);
  const std::uint32_t middle = first + (last - first) / 2;
  const auto begin = order_.begin();
  std::nth_element(begin + first, begin + middle, begin + last, [&](std::uint32_t a, std::uint32_t b) {
    const double ca = balls_[a].center[axis];
    const double cb = balls_[b].center[axis];
    return ca != cb ? ca < cb : a < b;
  });
  const auto child = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first = child;
  nodes_.resize(nodes_.size() + 2);
  build(child, first, middle);
  build(child + 1, middle, last);
}

std::vector<std::uint32_t> BallIndex::meeting(const AlignedBox3d& box) const {
  std::vector<std::uint32_t> result;
  std::vector<std::uint32_t> open;
  if (!nodes_.empty()) open.push_back(0);
  while (!open.empty()) {
    const Node& node = nodes_[open.back()];
    open.pop_back();
    if (!node.box.intersects(box)) continue;
    if (node.count == 0) {
      open.push_back(node.first);
      open.push_back(node.first + 1);
    }
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
      if (meets(balls_[order_[k]], box)) result.push_back(order_[k]);
    }
  }
  std::sort(result.begin(), result.end());
  return result;
}

BallIndex::Nearest BallIndex::nearest(const Vector3d& point) const {
  Nearest best;
  struct Open {
    std::uint32_t node;
    double distance;
  };
  std::vector<Open> open;
  if (!nodes_.empty()) open.push_back({0, nodes_[0].box.exteriorDistance(point)});
  while (!open.empty()) {
    const auto [at, reached] = open.back();
    open.pop_back();
    if (reached > best.distance) continue;
    const Node& node = nodes_[at];
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
      const medial::Ball& ball = balls_[order_[k]];
      const double distance = (point - ball.center).norm() - ball.radius;
      if (distance < best.distance || (distance == best.distance && order_[k] < best.ball)) {
        best = {order_[k], distance};
      }
    }
    if (node.count != 0) continue;
    Open nearer{node.first, nodes_[node.first].box.exteriorDistance(point)};
    Open farther{node.first + 1, nodes_[node.first + 1].box.exteriorDistance(point)};
    if (farther.distance < nearer.distance) std::swap(nearer, farther);
    open.push_back(farther);
    open.push_back(nearer);
  }
  return best;
}

}  // namespace spheretree::builders
