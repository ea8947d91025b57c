// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include <spheretree/broad_phase.hpp>

namespace spheretree::bench {

/// Somebody else's broad phase: told where all boxes are, once per frame, it delivers all pairs that overlap.
class Peer {
 public:
  virtual ~Peer() = default;

  /// Moves all boxes and collects the pairs that truly overlap, in any order. This is what is measured.
  virtual void findPairs(std::span<const Aabb> boxes, std::vector<BodyPair>& pairs) = 0;
};

struct PeerKind {
  std::string name;
  std::unique_ptr<Peer> (*make)(std::span<const Aabb> boxes, Vec3 room);
};

/// Each defined where the package is present.
std::vector<PeerKind> bulletPeers();
std::vector<PeerKind> odePeers();
std::vector<PeerKind> fclPeers();

/// Some peers compute boxes of their own from a position and a size; a trace larger, none can miss a pair.
inline constexpr float kPeerMargin = 1e-4F;

/// Keeps a pair that a peer reports, if the boxes overlap.
inline void keep(std::span<const Aabb> boxes, std::uint32_t a, std::uint32_t b,
                 std::vector<BodyPair>& pairs) {
  if (overlap(boxes[a], boxes[b])) pairs.push_back(a < b ? BodyPair{a, b} : BodyPair{b, a});
}

}  // namespace spheretree::bench
