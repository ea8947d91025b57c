// SPDX-License-Identifier: MIT
//
// The collision response of the crowded room: objects do not turn, velocity components change their signs.

#include <spheretree/response.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace spheretree {

namespace {

constexpr std::size_t kContactsAhead = 8;  // of about 20 ns each, a fetch from memory
constexpr float kHalf = 0.5F;              // a unit vector has at least one component of 0.577

/// Negates both when they approach along a normal component that is large enough.
void negate(float& a, float& b, float normal) noexcept {
  if (std::abs(normal) < kHalf || (a - b) * normal <= 0) return;
  a = -a;
  b = -b;
}

void reflect(float& velocity, bool below, float above) noexcept {
  if (below ? velocity < 0 : above > 0 && velocity > 0) velocity = -velocity;
}

}  // namespace

VelocityPair negated(const VelocityPair& velocities, Vec3 normal) noexcept {
  VelocityPair after = velocities;
  negate(after.a.x, after.b.x, normal.x);
  negate(after.a.y, after.b.y, normal.y);
  negate(after.a.z, after.b.z, normal.z);
  return after;
}

void respond(CollisionWorld& world) noexcept {
  const std::span<const Contact> contacts = world.contacts();
  for (std::size_t i = 0; i < contacts.size();) {
    const Contact& first = contacts[i];
    world.expect(contacts[std::min(i + kContactsAhead, contacts.size() - 1)].b);
    Vec3 sum;
    for (; i < contacts.size() && contacts[i].a == first.a && contacts[i].b == first.b; ++i)
      sum = sum + contacts[i].depth * contacts[i].normal;
    const float norm = length(sum);
    const Vec3 normal = norm > 0 ? (1 / norm) * sum : first.normal;
    const VelocityPair after = negated({world.velocity(first.a), world.velocity(first.b)}, normal);
    world.setVelocity(first.a, after.a);
    world.setVelocity(first.b, after.b);
  }
}

void reflectAtWalls(CollisionWorld& world, const Aabb& room) noexcept {
  for (std::uint32_t body = 0; body < world.bodyCount(); ++body) {
    if (!world.present(body)) continue;
    const Aabb& box = world.box(body);
    Vec3 velocity = world.velocity(body);
    reflect(velocity.x, box.min.x < room.min.x, box.max.x - room.max.x);
    reflect(velocity.y, box.min.y < room.min.y, box.max.y - room.max.y);
    reflect(velocity.z, box.min.z < room.min.z, box.max.z - room.max.z);
    world.setVelocity(body, velocity);
  }
}

}  // namespace spheretree
