// SPDX-License-Identifier: MIT
//
// Bodies that come and go.

#include <cassert>
#include <utility>

#include "collision_world_parts.hpp"
#include "worker_pool.hpp"

namespace spheretree {

CollisionWorld::CollisionWorld(std::unique_ptr<BroadPhase> broadPhase, const WorldSettings& settings)
    : broadPhase_(std::move(broadPhase)), settings_(settings) {
  assert(broadPhase_ != nullptr && settings.threads > 0 && settings.contactsPerPair > 0);
  benches_.resize(settings.threads);
  if (settings.threads > 1) pool_ = std::make_unique<detail::WorkerPool>(settings.threads);
}

CollisionWorld::~CollisionWorld() = default;
CollisionWorld::CollisionWorld(CollisionWorld&&) noexcept = default;
CollisionWorld& CollisionWorld::operator=(CollisionWorld&&) noexcept = default;

std::uint32_t CollisionWorld::add(const Shape& shape, const Pose& pose, Vec3 velocity) {
  std::uint32_t body = bodyCount();
  if (free_.empty()) {
    places_.emplace_back();
    velocities_.emplace_back();
    local_.emplace_back();
    boxes_.emplace_back();
    kinds_.push_back(Kind::Absent);
    shapes_.emplace_back();
    turns_.emplace_back();
    relevances_.emplace_back();
  } else {
    body = free_.back();
    free_.pop_back();
  }
  shapes_[body] = shape;
  kinds_[body] = shape.tree != nullptr ? Kind::Tree : Kind::TurnedBox;
  velocities_[body] = velocity;
  relevances_[body] = 1;
  setPose(body, pose);
  return body;
}

std::uint32_t CollisionWorld::addTree(const QueryTree& tree, const Pose& pose, Vec3 velocity) {
  return add({&tree, {}}, pose, velocity);
}

std::uint32_t CollisionWorld::addBox(Vec3 halfEdges, const Pose& pose, Vec3 velocity) {
  assert(halfEdges.x >= 0 && halfEdges.y >= 0 && halfEdges.z >= 0);
  return add({nullptr, halfEdges}, pose, velocity);
}

void CollisionWorld::remove(std::uint32_t body) {
  assert(body < bodyCount() && present(body));
  kinds_[body] = Kind::Absent;
  shapes_[body] = {};
  velocities_[body] = {};
  local_[body] = kAbsentBox;
  boxes_[body] = kAbsentBox;
  places_[body] = {};
  free_.push_back(body);
}

}  // namespace spheretree
