// SPDX-License-Identifier: GPL-3.0-or-later
#include "broad_phase_peers.hpp"

#include <BulletCollision/BroadphaseCollision/btAxisSweep3.h>
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>

namespace spheretree::bench {

namespace {

btVector3 vectorOf(Vec3 v) {
  return {v.x, v.y, v.z};
}

class BulletPeer final : public Peer {
 public:
  BulletPeer(std::unique_ptr<btBroadphaseInterface> engine, std::span<const Aabb> boxes)
      : dispatcher_(&configuration_), engine_(std::move(engine)) {
    numbers_.resize(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      numbers_[i] = static_cast<std::uint32_t>(i);
      proxies_.push_back(engine_->createProxy(
          vectorOf(boxes[i].min), vectorOf(boxes[i].max), BOX_SHAPE_PROXYTYPE, &numbers_[i],
          btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::AllFilter, &dispatcher_));
    }
  }
  ~BulletPeer() override {
    for (btBroadphaseProxy* proxy : proxies_) engine_->destroyProxy(proxy, &dispatcher_);
  }

  void findPairs(std::span<const Aabb> boxes, std::vector<BodyPair>& pairs) override {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      engine_->setAabb(proxies_[i], vectorOf(boxes[i].min), vectorOf(boxes[i].max), &dispatcher_);
    }
    engine_->calculateOverlappingPairs(&dispatcher_);
    btOverlappingPairCache* const cache = engine_->getOverlappingPairCache();
    const btBroadphasePair* const found = cache->getOverlappingPairArrayPtr();
    pairs.clear();
    for (int k = 0; k < cache->getNumOverlappingPairs(); ++k) {
      keep(boxes, numberOf(found[k].m_pProxy0), numberOf(found[k].m_pProxy1), pairs);
    }
  }

 private:
  static std::uint32_t numberOf(const btBroadphaseProxy* proxy) {
    return *static_cast<const std::uint32_t*>(proxy->m_clientObject);
  }

  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  std::unique_ptr<btBroadphaseInterface> engine_;
  std::vector<std::uint32_t> numbers_;
  std::vector<btBroadphaseProxy*> proxies_;
};

std::unique_ptr<Peer> makeDbvt(std::span<const Aabb> boxes, Vec3) {
  auto engine = std::make_unique<btDbvtBroadphase>();
  engine->m_deferedcollide = true;
  return std::make_unique<BulletPeer>(std::move(engine), boxes);
}

/// Its other setting: pairs are looked for as boxes leave their enlarged ones.
std::unique_ptr<Peer> makeEagerDbvt(std::span<const Aabb> boxes, Vec3) {
  return std::make_unique<BulletPeer>(std::make_unique<btDbvtBroadphase>(), boxes);
}

std::unique_ptr<Peer> makeAxisSweep(std::span<const Aabb> boxes, Vec3 room) {
  const btVector3 margin(2, 2, 2);
  auto engine = std::make_unique<bt32BitAxisSweep3>(-margin, vectorOf(room) + margin,
                                                    static_cast<unsigned>(boxes.size()) + 2);
  return std::make_unique<BulletPeer>(std::move(engine), boxes);
}

}  // namespace

std::vector<PeerKind> bulletPeers() {
  return {
      {"bullet dbvt", makeDbvt}, {"bullet dbvt eager", makeEagerDbvt}, {"bullet axis_sweep", makeAxisSweep}};
}

}  // namespace spheretree::bench
