// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <spheretree/aabb.hpp>
#include <spheretree/broad_phases.hpp>
#include <spheretree/collision_world.hpp>
#include <spheretree/grid.hpp>
#include <spheretree/pair_query.hpp>
#include <spheretree/result.hpp>
#include <spheretree/vec3.hpp>

#include "tree_library.hpp"

namespace crowded_room {

/// Frames per second of the simulation: a step lasts 1 / kFrameRate seconds.
inline constexpr int kFrameRate = 60;

enum class Movement : std::uint8_t {
  PlaneXZ,  ///< every object stays at its height
  SpaceXYZ
};

/// What a box is to the narrow phase.
enum class BoxShape : std::uint8_t {
  Tree,  ///< a sphere tree, as in the paper
  Exact  ///< the box itself
};

enum class ObjectKind : std::uint8_t { Avatar, Bunny, Box };

/// Everything that a run depends on, besides the trees and the stick.
struct RoomSettings {
  std::uint32_t seed = 1;
  std::uint32_t objects = 1000;  ///< besides the avatar; at most 2^20
  float bunnyShare = 0.5F;       ///< of the objects, 0 to 1; the others are boxes
  Movement movement = Movement::SpaceXYZ;
  float speed = 5;  ///< the largest along each axis, units per second; above 0, at most 60
  spheretree::Vec3 size{100, 25, 100};  ///< of the room; at least 8 along each axis, at most 10^4

  spheretree::BroadPhaseKind broadPhase = spheretree::BroadPhaseKind::Sweep;
  /// Of the two engines with a grid; zeros choose by the scene; at most 256 along each axis.
  spheretree::GridResolution grid = spheretree::kPaperGrid;
  spheretree::NarrowPhase narrow = spheretree::NarrowPhase::Shapes;
  BoxShape boxShape = BoxShape::Tree;
  std::string bunnyTree;      ///< name in the library; empty: its usual one
  std::string boxTree;        ///< the same for boxes
  std::uint32_t levels = 3;   ///< of the trees, the root counts; at least 1; shallower trees are used whole
  std::uint32_t threads = 1;  ///< of the narrow phase, 1 to 64
  std::uint32_t contactsPerPair = 4;  ///< at least 1; more say better which components to negate
  /// For the narrow phase of a step; `deepestLevel` is set from `levels`. A budget in microseconds makes runs
  /// differ; one in sphere tests does not.
  spheretree::QueryLimits budget = {};
};

/// The stick as the user holds it.
struct StickInput {
  spheretree::Vec3 stick;              ///< -1 to 1 along the axes of the room; taken to that range, NaN is 0
  std::uint64_t sequence = 0;          ///< the user's own counting, handed back
  std::int64_t stampMicroseconds = 0;  ///< when it was read, on the user's own clock, handed back
};

/// The stick as the simulation saw it.
struct ConsumedInput {
  StickInput input;        ///< with the stick taken to its range
  std::uint64_t step = 0;  ///< the number of the step that it moved the avatar in; the first is 1
};

/// The avatar was hit, in the last step.
struct Impact {
  std::uint32_t body = 0;   ///< that it met; an object
  float speed = 0;          ///< at which the two approached along the normal, units per second; above 0
  spheretree::Vec3 normal;  ///< unit, from the body towards the avatar: where the avatar is pushed
  spheretree::Vec3 point;   ///< in the room
};

/// What the last step took and found. Times in microseconds of wall clock.
struct StepReport {
  spheretree::StepTimes collision;  ///< structure update, broad phase, narrow phase
  float response = 0;               ///< velocities negated and walls, not part of the collision time
  std::uint64_t pairs = 0;          ///< of bodies whose boxes overlap
  std::uint64_t contacts = 0;       ///< all of them, several per pair
};

/// What must never happen, counted over all objects as they are now.
struct Audit {
  std::uint32_t outside = 0;        ///< boxes that reach beyond a wall
  std::uint32_t changedSpeeds = 0;  ///< objects with a velocity component of another magnitude than at first
};

enum class Flow : std::uint8_t { Running, Paused };

/// The crowded room of the paper: boxes and bunnies that fly straight, never turn, and negate components of
/// their velocities when they meet each other or a wall; and an avatar that the user flies.
///
/// Body 0 is the avatar (a ball), bodies 1 to objects are the objects. The same settings, trees and sticks
/// give the same state, bit for bit, for any broad phase and any number of threads. One thread at a time.
class Room {
 public:
  /// A room before its first step. `library` must live as long as the room. Fails with InvalidArgument,
  /// naming the setting, its value and what it may be.
  static spheretree::Result<Room> create(const RoomSettings& settings, const TreeLibrary& library);

  /// Takes new settings at once; objects that remain keep place and direction of flight, those that are new
  /// fly in anywhere. Fails as create() does and then changes nothing. Another seed starts afresh.
  spheretree::Result<spheretree::Done> change(const RoomSettings& settings);

  /// One step of 1 / kFrameRate seconds: moves everything, finds the contacts, responds. Does not look at
  /// flow(). Fails only when the runtime does.
  spheretree::Result<spheretree::Done> step(const StickInput& input = {});

  /// What a frame of an interactive program calls: step() when running or when a single step was asked for,
  /// and whether there was one.
  spheretree::Result<bool> tick(const StickInput& input);
  void setFlow(Flow flow) noexcept { flow_ = flow; }
  [[nodiscard]] Flow flow() const noexcept { return flow_; }
  /// Lets the next tick() make one step though paused.
  void askForStep() noexcept { stepAsked_ = true; }

  [[nodiscard]] const RoomSettings& settings() const noexcept { return settings_; }
  [[nodiscard]] const TreeLibrary& library() const noexcept { return *library_; }
  /// From the corner (0, 0, 0) to the size.
  [[nodiscard]] spheretree::Aabb walls() const noexcept { return {{0, 0, 0}, settings_.size}; }
  [[nodiscard]] std::uint64_t stepsMade() const noexcept { return steps_; }

  /// The avatar and the objects.
  [[nodiscard]] std::uint32_t bodyCount() const noexcept { return settings_.objects + 1; }
  [[nodiscard]] ObjectKind kind(std::uint32_t body) const noexcept { return kinds_[body]; }
  /// The tree that objects of a kind wear: what to draw, and for Exact boxes too. Not for the avatar.
  [[nodiscard]] const UnitTree& treeOf(ObjectKind kind) const noexcept;
  /// Bodies are centred at their place, with scale 1 and no rotation.
  [[nodiscard]] spheretree::Vec3 place(std::uint32_t body) const noexcept {
    return world_.pose(body).translation;
  }
  [[nodiscard]] spheretree::Vec3 velocity(std::uint32_t body) const noexcept { return world_.velocity(body); }
  /// The box that the broad phase sees.
  [[nodiscard]] const spheretree::Aabb& box(std::uint32_t body) const noexcept { return world_.box(body); }
  /// Radius of the avatar's ball.
  static constexpr float kAvatarRadius = 0.75F;
  /// Of the avatar at full stick, units per second.
  static constexpr float kAvatarSpeed = 12;

  /// Of the last step, ordered by body; several may belong to one pair.
  [[nodiscard]] std::span<const spheretree::Contact> contacts() const noexcept { return world_.contacts(); }
  /// Bodies of the last step whose boxes overlap.
  [[nodiscard]] std::span<const spheretree::BodyPair> pairs() const noexcept { return world_.pairs(); }
  /// Hits of the avatar in the last step, one per body at most, in the order of bodies.
  [[nodiscard]] std::span<const Impact> impacts() const noexcept { return impacts_; }
  /// The input that the last step consumed.
  [[nodiscard]] const ConsumedInput& consumed() const noexcept { return consumed_; }
  [[nodiscard]] const StepReport& report() const noexcept { return report_; }

  /// FNV-1a, 64 bits, over the bits of places and velocities of all bodies in order. O(bodies).
  [[nodiscard]] std::uint64_t stateHash() const noexcept;
  [[nodiscard]] Audit audit() const noexcept;

 private:
  /// Where the place of a body may be, so that its box stays between the walls.
  struct Range {
    spheretree::Vec3 low;
    spheretree::Vec3 high;
  };
  struct State {
    spheretree::Vec3 place;
    spheretree::Vec3 velocity;
  };

  Room(const RoomSettings& settings, const TreeLibrary& library);

  void drawObjects();
  [[nodiscard]] spheretree::Vec3 ownVelocity(std::uint32_t object) const noexcept;
  [[nodiscard]] State stateOf(std::uint32_t body, std::uint32_t bodiesKept) const noexcept;
  void rebuild(std::uint32_t bodiesKept);
  void steer(const StickInput& input) noexcept;
  void respond();
  void respondTo(const spheretree::BodyPair& pair, spheretree::Vec3 normal) noexcept;
  void hitAvatar(const spheretree::Contact& contact, spheretree::Vec3 normal);
  void turnAtWalls() noexcept;

  RoomSettings settings_;
  const TreeLibrary* library_;
  const UnitTree* bunny_ = nullptr;
  const UnitTree* boxTree_ = nullptr;
  std::mt19937 random_;
  std::vector<State> draws_;  // of all objects that there have been, in shares of the room and of the speed
  std::vector<ObjectKind> kinds_;
  std::array<Range, 3> ranges_{};  // by kind
  spheretree::CollisionWorld world_;
  std::vector<spheretree::Vec3> pushes_;  // normals of the avatar's contacts, from it to the others
  std::vector<Impact> impacts_;
  ConsumedInput consumed_;
  StepReport report_;
  std::uint64_t steps_ = 0;
  Flow flow_ = Flow::Running;
  bool stepAsked_ = false;
};

[[nodiscard]] std::string_view nameOf(Movement movement) noexcept;  ///< xz, xyz
[[nodiscard]] std::string_view nameOf(BoxShape shape) noexcept;     ///< tree, exact
[[nodiscard]] std::string_view nameOf(ObjectKind kind) noexcept;    ///< avatar, bunny, box

}  // namespace crowded_room
