// SPDX-License-Identifier: GPL-3.0-or-later
#include "broad_phase_peers.hpp"

#include <cstdint>

#include <fcl/broadphase/broadphase_SaP.h>
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>

namespace spheretree::bench {

namespace {

class FclPeer final : public Peer {
 public:
  using Manager = fcl::BroadPhaseCollisionManager<float>;

  FclPeer(std::unique_ptr<Manager> manager, std::span<const Aabb> boxes) : manager_(std::move(manager)) {
    std::vector<fcl::CollisionObject<float>*> all;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const Vec3 size = boxes[i].max - boxes[i].min + Vec3{kPeerMargin, kPeerMargin, kPeerMargin};
      auto shape = std::make_shared<fcl::Box<float>>(size.x, size.y, size.z);
      objects_.push_back(std::make_unique<fcl::CollisionObject<float>>(shape));
      objects_.back()->setUserData(reinterpret_cast<void*>(static_cast<std::uintptr_t>(i)));
      all.push_back(objects_.back().get());
    }
    place(boxes);
    manager_->registerObjects(all);
    manager_->setup();
  }

  void findPairs(std::span<const Aabb> boxes, std::vector<BodyPair>& pairs) override {
    place(boxes);
    manager_->update();
    boxes_ = boxes;
    pairs.clear();
    pairs_ = &pairs;
    manager_->collide(this, &FclPeer::onPair);
  }

 private:
  void place(std::span<const Aabb> boxes) {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const Vec3 center = 0.5F * (boxes[i].min + boxes[i].max);
      objects_[i]->setTranslation({center.x, center.y, center.z});
      objects_[i]->computeAABB();
    }
  }
  static std::uint32_t numberOf(const fcl::CollisionObject<float>* object) {
    return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(object->getUserData()));
  }
  static bool onPair(fcl::CollisionObject<float>* a, fcl::CollisionObject<float>* b, void* self) {
    auto* const peer = static_cast<FclPeer*>(self);
    keep(peer->boxes_, numberOf(a), numberOf(b), *peer->pairs_);
    return false;  // go on
  }

  std::unique_ptr<Manager> manager_;
  std::vector<std::unique_ptr<fcl::CollisionObject<float>>> objects_;
  std::span<const Aabb> boxes_;
  std::vector<BodyPair>* pairs_ = nullptr;
};

template <class Manager>
std::unique_ptr<Peer> make(std::span<const Aabb> boxes, Vec3) {
  return std::make_unique<FclPeer>(std::make_unique<Manager>(), boxes);
}

}  // namespace

std::vector<PeerKind> fclPeers() {
  return {{"fcl tree", make<fcl::DynamicAABBTreeCollisionManager<float>>},
          {"fcl sap", make<fcl::SaPCollisionManager<float>>}};
}

}  // namespace spheretree::bench
