// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <spheretree/aabb.hpp>
#include <spheretree/broad_phase.hpp>
#include <spheretree/pair_query.hpp>
#include <spheretree/pose.hpp>
#include <spheretree/query_scheduler.hpp>
#include <spheretree/query_tree.hpp>
#include <spheretree/result.hpp>

namespace spheretree {

/// What decides whether two bodies touch.
enum class NarrowPhase : std::uint8_t {
  Boxes,  ///< their axis-aligned boxes do; the broad phase alone
  Shapes  ///< their trees, or boxes as they are turned
};

struct WorldSettings {
  NarrowPhase narrow = NarrowPhase::Shapes;
  /// Overlapping pairs of balls reported for one pair of bodies, at least 1. The first costs least: a query
  /// stops there.
  std::uint32_t contactsPerPair = 1;
  /// Threads of the narrow phase, at least 1. Contacts are the same for any number.
  std::uint32_t threads = 1;
  /// For all pairs of trees of a frame together. With a budget of tests or of time the pairs are refined
  /// level by level, the most relevant first, on one thread, and each has one contact, decided or not. The
  /// deepest level holds with and without.
  QueryLimits budget = {};
};

/// Two bodies that touch, as far as the narrow phase has looked.
struct Contact {
  std::uint32_t a = 0;  ///< numbers of the bodies, a < b
  std::uint32_t b = 0;
  Vec3 point;               ///< world coordinates
  Vec3 normal;              ///< unit, from a towards b
  float depth = 0;          ///< of the balls or boxes in each other, world units
  float slackBound = 0;     ///< the solids are at most this far apart; 0 (but for rounding) between boxes
  std::uint32_t level = 0;  ///< of the balls; 0 between boxes
  bool decided = true;      ///< false: the budget ended above the level asked for
};

/// Wall-clock time of the last step, microseconds.
struct StepTimes {
  float update = 0;
  float broad = 0;
  float narrow = 0;

  [[nodiscard]] float total() const noexcept { return update + broad + narrow; }
};

namespace detail {
class WorkerPool;
}

/// Moving bodies, and who touches whom: update, broad phase and narrow phase in one step.
///
/// Bodies are numbered from 0; the number of a removed body is given to a later one. A body is a tree or a
/// box with a pose and a linear velocity; it does not turn by itself. Memory grows with the scene; once it
/// has its size, a step takes nothing from the heap. The world may be used by one thread at a time.
class CollisionWorld {
 public:
  CollisionWorld(std::unique_ptr<BroadPhase> broadPhase, const WorldSettings& settings = {});
  ~CollisionWorld();
  CollisionWorld(CollisionWorld&&) noexcept;
  CollisionWorld& operator=(CollisionWorld&&) noexcept;

  /// Adds a body with the shape of a tree, which must outlive it. Poses as for PairQuery.
  std::uint32_t addTree(const QueryTree& tree, const Pose& pose, Vec3 velocity = {});
  /// Adds a box around the origin of its pose; half edges in body units, not negative.
  std::uint32_t addBox(Vec3 halfEdges, const Pose& pose, Vec3 velocity = {});
  /// Takes a body out. Its number must be in use.
  void remove(std::uint32_t body);

  /// Numbers in use or free; all below this.
  [[nodiscard]] std::uint32_t bodyCount() const noexcept { return static_cast<std::uint32_t>(kinds_.size()); }
  [[nodiscard]] bool present(std::uint32_t body) const noexcept { return kinds_[body] != Kind::Absent; }

  [[nodiscard]] Pose pose(std::uint32_t body) const noexcept {
    return {turns_[body].rotation, places_[body], turns_[body].scale};
  }
  void setPose(std::uint32_t body, const Pose& pose);
  [[nodiscard]] Vec3 velocity(std::uint32_t body) const noexcept { return velocities_[body]; }
  /// World units per second.
  void setVelocity(std::uint32_t body, Vec3 velocity) noexcept { velocities_[body] = velocity; }
  /// How much the contacts of a body matter when there is a budget; 1 to begin with. A pair counts as much as
  /// the more relevant of the two.
  void setRelevance(std::uint32_t body, float relevance) noexcept { relevances_[body] = relevance; }

  /// A hint for loops over contacts: place and velocity of the body will be asked for in a moment. Bodies of
  /// a large world lie far apart in memory.
  void expect(std::uint32_t body) const noexcept;

  /// The box that the broad phase sees: holds the body, rounding included. As of the last step or setPose.
  [[nodiscard]] const Aabb& box(std::uint32_t body) const noexcept { return boxes_[body]; }

  /// Moves every body by its velocity and finds the contacts. Fails with InvalidArgument, naming the body,
  /// when a pose is not finite any more; there are then no pairs and no contacts.
  Result<Done> step(float seconds);

  /// Pairs of bodies whose boxes overlap, ascending.
  [[nodiscard]] std::span<const BodyPair> pairs() const noexcept { return pairs_; }
  /// Ordered like the pairs.
  [[nodiscard]] std::span<const Contact> contacts() const noexcept { return contacts_; }
  [[nodiscard]] const StepTimes& times() const noexcept { return times_; }

 private:
  enum class Kind : std::uint8_t { Absent, StraightBox, TurnedBox, Tree };
  struct Shape {
    const QueryTree* tree = nullptr;  // without one, a box
    Vec3 halfEdges;
  };
  struct Turn {
    Rotation rotation;
    float scale = 1;
  };
  struct Block;  // a run of pairs and where its contacts are
  struct Bench;  // what one thread works with

  std::uint32_t add(const Shape& shape, const Pose& pose, Vec3 velocity);
  void move(float seconds) noexcept;
  void findContacts();
  void findContactsInBlocks();
  void findContactsInBudget();
  void collideRun(std::span<const BodyPair> pairs, Bench& bench, std::vector<Contact>& out) const;
  void collide(const BodyPair& pair, Bench& bench, std::vector<Contact>& out) const;
  void collideMixed(const BodyPair& pair, std::vector<Contact>& out) const;
  void collideTrees(const BodyPair& pair, Bench& bench, std::vector<Contact>& out) const;

  std::unique_ptr<BroadPhase> broadPhase_;
  WorldSettings settings_;
  // What a frame streams through stands apart from what only the narrow phase asks for.
  std::vector<Vec3> places_;
  std::vector<Vec3> velocities_;
  std::vector<Aabb> local_;  // around the translation, rotated and scaled
  std::vector<Aabb> boxes_;
  std::vector<Kind> kinds_;
  std::vector<Shape> shapes_;
  std::vector<Turn> turns_;
  std::vector<float> relevances_;
  std::vector<std::uint32_t> free_;
  std::vector<BodyPair> pairs_;
  std::vector<Contact> contacts_;
  std::vector<Block> blocks_;
  std::vector<Bench> benches_;
  std::vector<PairQuery> queries_;  // with a budget, one per pair of trees
  std::vector<ScheduledQuery> scheduled_;
  QueryScheduler scheduler_;
  std::unique_ptr<detail::WorkerPool> pool_;
  StepTimes times_;
};

inline void CollisionWorld::expect(std::uint32_t body) const noexcept {
#if defined(__GNUC__)
  __builtin_prefetch(&places_[body]);
  __builtin_prefetch(&velocities_[body]);
#else
  static_cast<void>(body);
#endif
}

}  // namespace spheretree
