// SPDX-License-Identifier: MIT
#pragma once

#include <spheretree/aabb.hpp>
#include <spheretree/collision_world.hpp>
#include <spheretree/vec3.hpp>

namespace spheretree {

/// Velocities of two bodies.
struct VelocityPair {
  Vec3 a;
  Vec3 b;
};

/// The response of the crowded room: components of both velocities are negated, nothing else. Those are
/// chosen in which the contact normal (from a to b) has at least half its length, so one or more, and of
/// these the ones in which the bodies approach each other; bodies that part are left alone, or they would
/// stick together.
[[nodiscard]] VelocityPair negated(const VelocityPair& velocities, Vec3 normal) noexcept;

/// Responds to every pair of bodies with contacts of the last step, in order. Without narrow phase the normal
/// is the axis along which the boxes are least in each other; with it, the mean of the normals of the
/// contacts of the pair, weighted by depth. O(contacts).
void respond(CollisionWorld& world) noexcept;

/// Negates the velocity components that lead bodies out of the room whose boxes reach beyond its walls.
/// O(bodies).
void reflectAtWalls(CollisionWorld& world, const Aabb& room) noexcept;

}  // namespace spheretree
