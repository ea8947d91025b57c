// SPDX-License-Identifier: GPL-3.0-or-later
#include "broad_phase_peers.hpp"

#include <cstdint>

#include <ode/ode.h>

namespace spheretree::bench {

namespace {

class OdePeer final : public Peer {
 public:
  explicit OdePeer(std::span<const Aabb> boxes) {
    dInitODE();
    space_ = dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XZY);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const Vec3 size = boxes[i].max - boxes[i].min;
      const dReal margin = static_cast<dReal>(kPeerMargin);
      dGeomID geom = dCreateBox(space_, static_cast<dReal>(size.x) + margin,
                                static_cast<dReal>(size.y) + margin, static_cast<dReal>(size.z) + margin);
      dGeomSetData(geom, reinterpret_cast<void*>(static_cast<std::uintptr_t>(i)));
      geoms_.push_back(geom);
    }
  }
  ~OdePeer() override {
    dSpaceDestroy(space_);
    dCloseODE();
  }

  void findPairs(std::span<const Aabb> boxes, std::vector<BodyPair>& pairs) override {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const Vec3 center = 0.5F * (boxes[i].min + boxes[i].max);
      dGeomSetPosition(geoms_[i], static_cast<dReal>(center.x), static_cast<dReal>(center.y),
                       static_cast<dReal>(center.z));
    }
    boxes_ = boxes;
    pairs.clear();
    pairs_ = &pairs;
    dSpaceCollide(space_, this, &OdePeer::onPair);
  }

 private:
  static std::uint32_t numberOf(dGeomID geom) {
    return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(dGeomGetData(geom)));
  }
  static void onPair(void* self, dGeomID a, dGeomID b) {
    auto* const peer = static_cast<OdePeer*>(self);
    keep(peer->boxes_, numberOf(a), numberOf(b), *peer->pairs_);
  }

  dSpaceID space_ = nullptr;
  std::vector<dGeomID> geoms_;
  std::span<const Aabb> boxes_;
  std::vector<BodyPair>* pairs_ = nullptr;
};

std::unique_ptr<Peer> makeSweepAndPrune(std::span<const Aabb> boxes, Vec3) {
  return std::make_unique<OdePeer>(boxes);
}

}  // namespace

std::vector<PeerKind> odePeers() {
  return {{"ode sweep_and_prune", makeSweepAndPrune}};
}

}  // namespace spheretree::bench
