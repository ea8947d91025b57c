// SPDX-License-Identifier: MIT
//
// A step is three passes: translate every box with its body, let the broad phase find the pairs, ask the
// shapes of each pair. The boxes are those of the shapes, turned and scaled once, when a pose is set; bodies
// only translate.
//
// With threads the pairs are cut into blocks of fixed size that any thread takes; contacts are put together
// in the order of the blocks, so who took which does not show.

#include <spheretree/collision_world.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <chrono>
#include <cmath>
#include <limits>

#include "box_shapes.hpp"
#include "collision_world_parts.hpp"
#include "simd_paths.hpp"
#include "worker_pool.hpp"

#if SPHERETREE_X86
#include <emmintrin.h>
#endif

namespace spheretree {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kPairsPerBlock = 64;  // a few microseconds of work
constexpr std::size_t kBodiesPerRun = 256;
constexpr std::size_t kPairsAhead = 6;  // of about 100 ns each, a fetch from memory
constexpr std::size_t kContactsPerCall = 16;
/// Relative; more than the rounding of a rotated box and of a translated one.
constexpr float kBoxRounding = 0x1p-20F;

float microsecondsBetween(Clock::time_point start, Clock::time_point end) noexcept {
  return std::chrono::duration<float, std::micro>(end - start).count();
}

Vec3 absolute(Vec3 v) noexcept {
  return {std::abs(v.x), std::abs(v.y), std::abs(v.z)};
}

/// The box of a turned and scaled box, around the translation of the pose.
Aabb turnedBox(const Aabb& box, const Pose& pose) noexcept {
  const Rotation& q = pose.rotation;
  const float norm = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  const Rotation unit{q.x / norm, q.y / norm, q.z / norm, q.w / norm};
  const Vec3 center = rotate(unit, (0.5F * pose.scale) * (box.min + box.max));
  const Vec3 half = (0.5F * pose.scale) * (box.max - box.min);
  const Vec3 x = absolute(rotate(unit, {half.x, 0, 0}));
  const Vec3 y = absolute(rotate(unit, {0, half.y, 0}));
  const Vec3 z = absolute(rotate(unit, {0, 0, half.z}));
  const float rounding = kBoxRounding * (length(center) + length(half));
  const Vec3 size = x + y + z + Vec3{rounding, rounding, rounding};
  return {center - size, center + size};
}

/// places += seconds * velocities, on x86 as runs of floats.
void advance(std::span<Vec3> places, std::span<const Vec3> velocities, float seconds) noexcept {
  std::size_t i = 0;
#if SPHERETREE_X86
  constexpr std::size_t kBodies = 4;  // twelve floats
  const __m128 time = _mm_set1_ps(seconds);
  for (; i + kBodies <= places.size(); i += kBodies) {
    float* const place = &places[i].x;
    const float* const velocity = &velocities[i].x;
    for (int k = 0; k < 12; k += 4) {
      const __m128 way = _mm_mul_ps(time, _mm_loadu_ps(velocity + k));
      _mm_storeu_ps(place + k, _mm_add_ps(_mm_loadu_ps(place + k), way));
    }
  }
#endif
  for (; i < places.size(); ++i) places[i] = places[i] + seconds * velocities[i];
}

/// The box around a body at its place, rounding included.
Aabb movedBox(const Aabb& local, Vec3 place) noexcept {
  const Vec3 rounding = kBoxRounding * absolute(place);
  return {local.min + (place - rounding), local.max + (place + rounding)};
}

/// movedBox() for all bodies. On x86 in two overlapping halves of a box, the same operations.
void translate(std::span<const Aabb> local, std::span<const Vec3> places, std::span<Aabb> boxes) noexcept {
  std::size_t i = 0;
#if SPHERETREE_X86
  static_assert(sizeof(Aabb) == 6 * sizeof(float) && sizeof(Vec3) == 3 * sizeof(float));
  const __m128 sign = _mm_castsi128_ps(_mm_set1_epi32(std::numeric_limits<std::int32_t>::min()));
  const __m128 down = _mm_setr_ps(-kBoxRounding, -kBoxRounding, -kBoxRounding, kBoxRounding);
  const __m128 up = _mm_set1_ps(kBoxRounding);
  // Four floats are read where a place has three: the last body is left to the loop below.
  for (; i + 1 < places.size(); ++i) {
    const __m128 place = _mm_loadu_ps(&places[i].x);
    const __m128 first = _mm_shuffle_ps(place, place, _MM_SHUFFLE(0, 2, 1, 0));  // x y z x
    const __m128 last = _mm_shuffle_ps(place, place, _MM_SHUFFLE(2, 1, 2, 1));   // y z
    const __m128 firstMoved = _mm_add_ps(first, _mm_mul_ps(down, _mm_andnot_ps(sign, first)));
    const __m128 lastMoved = _mm_add_ps(last, _mm_mul_ps(up, _mm_andnot_ps(sign, last)));
    const __m128 lastLocal = _mm_castpd_ps(_mm_load_sd(reinterpret_cast<const double*>(&local[i].max.y)));
    _mm_storeu_ps(&boxes[i].min.x, _mm_add_ps(_mm_loadu_ps(&local[i].min.x), firstMoved));
    _mm_storel_pi(reinterpret_cast<__m64*>(&boxes[i].max.y), _mm_add_ps(lastLocal, lastMoved));
  }
#endif
  for (; i < places.size(); ++i) boxes[i] = movedBox(local[i], places[i]);
}

/// The broad phase's own verdict, with the axis along which the boxes are least in each other.
Contact boxContact(const BodyPair& pair, const Aabb& a, const Aabb& b) noexcept {
  const Vec3 low{std::max(a.min.x, b.min.x), std::max(a.min.y, b.min.y), std::max(a.min.z, b.min.z)};
  const Vec3 high{std::min(a.max.x, b.max.x), std::min(a.max.y, b.max.y), std::min(a.max.z, b.max.z)};
  const Vec3 fromTo = (b.min + b.max) - (a.min + a.max);
  const Vec3 depth{std::min(a.max.x - b.min.x, b.max.x - a.min.x),
                   std::min(a.max.y - b.min.y, b.max.y - a.min.y),
                   std::min(a.max.z - b.min.z, b.max.z - a.min.z)};
  const auto sign = [](float value) { return value < 0 ? -1.0F : 1.0F; };
  Contact contact{pair.a, pair.b, 0.5F * (low + high), {}, 0, 0, 0, true};
  if (depth.x <= depth.y && depth.x <= depth.z) {
    contact.normal = {sign(fromTo.x), 0, 0};
    contact.depth = depth.x;
  } else if (depth.y <= depth.z) {
    contact.normal = {0, sign(fromTo.y), 0};
    contact.depth = depth.y;
  } else {
    contact.normal = {0, 0, sign(fromTo.z)};
    contact.depth = depth.z;
  }
  return contact;
}

Contact treeContact(const BodyPair& pair, const BallContact& balls, float slackBound) noexcept {
  return {pair.a, pair.b, balls.point, balls.normal, balls.depth, slackBound, balls.level, true};
}

}  // namespace

void CollisionWorld::setPose(std::uint32_t body, const Pose& pose) {
  const Shape& shape = shapes_[body];
  assert(present(body));
  places_[body] = pose.translation;
  turns_[body] = {pose.rotation, pose.scale};
  const bool straight = pose.rotation.x == 0 && pose.rotation.y == 0 && pose.rotation.z == 0;
  if (shape.tree == nullptr) kinds_[body] = straight ? Kind::StraightBox : Kind::TurnedBox;
  const Aabb own = shape.tree != nullptr ? shape.tree->bounds() : Aabb{-shape.halfEdges, shape.halfEdges};
  local_[body] = turnedBox(own, pose);
  boxes_[body] = movedBox(local_[body], pose.translation);
}

void CollisionWorld::move(float seconds) noexcept {
  // Run by run: places are in the cache when the boxes are made of them.
  for (std::size_t begin = 0; begin < places_.size(); begin += kBodiesPerRun) {
    const std::size_t count = std::min(kBodiesPerRun, places_.size() - begin);
    const std::span<Vec3> places(places_.data() + begin, count);
    advance(places, {velocities_.data() + begin, count}, seconds);
    translate({local_.data() + begin, count}, places, {boxes_.data() + begin, count});
  }
}

Result<Done> CollisionWorld::step(float seconds) {
  const Clock::time_point start = Clock::now();
  move(seconds);
  const Clock::time_point moved = Clock::now();
  contacts_.clear();
  Result<Done> found = broadPhase_->findPairs(boxes_, pairs_);
  const Clock::time_point paired = Clock::now();
  if (found) findContacts();
  const Clock::time_point end = Clock::now();
  times_ = {microsecondsBetween(start, moved), microsecondsBetween(moved, paired),
            microsecondsBetween(paired, end)};
  return found;
}

void CollisionWorld::findContacts() {
  const QueryLimits& budget = settings_.budget;
  const bool limited = budget.sphereTests != QueryLimits::kUnlimited ||
                       budget.microseconds < std::numeric_limits<float>::infinity();
  if (settings_.narrow == NarrowPhase::Shapes && limited) {
    findContactsInBudget();
  } else if (pool_ != nullptr && pairs_.size() > kPairsPerBlock) {
    findContactsInBlocks();
  } else {
    collideRun(pairs_, benches_[0], contacts_);
  }
}

/// The bodies of a pair lie anywhere in memory: they are called for a few pairs ahead.
void CollisionWorld::collideRun(std::span<const BodyPair> pairs, Bench& bench,
                                std::vector<Contact>& out) const {
  for (std::size_t i = 0; i < pairs.size(); ++i) {
#if defined(__GNUC__)
    const BodyPair& ahead = pairs[std::min(i + kPairsAhead, pairs.size() - 1)];
    __builtin_prefetch(&boxes_[ahead.b]);
    __builtin_prefetch(&places_[ahead.b]);
    __builtin_prefetch(&turns_[ahead.b]);
    __builtin_prefetch(&shapes_[ahead.b]);
#endif
    collide(pairs[i], bench, out);
  }
}

void CollisionWorld::collide(const BodyPair& pair, Bench& bench, std::vector<Contact>& out) const {
  const Kind a = kinds_[pair.a];
  const Kind b = kinds_[pair.b];
  const bool straight = a == Kind::StraightBox && b == Kind::StraightBox;
  if (straight || settings_.narrow == NarrowPhase::Boxes) {
    out.push_back(boxContact(pair, boxes_[pair.a], boxes_[pair.b]));
  } else if (a == Kind::Tree && b == Kind::Tree) {
    collideTrees(pair, bench, out);
  } else {
    collideMixed(pair, out);
  }
}

void CollisionWorld::collideMixed(const BodyPair& pair, std::vector<Contact>& out) const {
  const Shape& a = shapes_[pair.a];
  const Shape& b = shapes_[pair.b];
  const Pose poseA = pose(pair.a);
  const Pose poseB = pose(pair.b);
  detail::ShapeContact touched;
  const std::uint32_t level = settings_.budget.deepestLevel;
  float slack = 0;
  if (a.tree == nullptr && b.tree == nullptr) {
    if (!touch(detail::PosedBox{a.halfEdges, poseA}, detail::PosedBox{b.halfEdges, poseB}, touched)) return;
  } else {
    const bool boxFirst = a.tree == nullptr;
    const detail::PosedBox box{boxFirst ? a.halfEdges : b.halfEdges, boxFirst ? poseA : poseB};
    const detail::PosedTree tree{boxFirst ? *b.tree : *a.tree, boxFirst ? poseB : poseA};
    if (!touch(box, tree, level, touched)) return;
    if (!boxFirst) touched.normal = -touched.normal;
    float standOff = tree.tree.standOff(0);
    for (std::uint32_t k = 1; k <= touched.level; ++k) standOff = std::min(standOff, tree.tree.standOff(k));
    slack = tree.pose.scale * standOff + touched.rounding;
  }
  out.push_back({pair.a, pair.b, touched.point, touched.normal, touched.depth, slack, touched.level, true});
}

void CollisionWorld::collideTrees(const BodyPair& pair, Bench& bench, std::vector<Contact>& out) const {
  PairQuery& query = bench.query;
  const QueryLimits limits{.deepestLevel = settings_.budget.deepestLevel};
  query.setTrees(*shapes_[pair.a].tree, *shapes_[pair.b].tree);
  query.restart(pose(pair.a), pose(pair.b));
  if (settings_.contactsPerPair == 1) {
    if (query.advance(limits) == Answer::Overlapping)
      out.push_back(treeContact(pair, query.contact(), query.slackBound()));
    return;
  }
  std::array<BallContact, kContactsPerCall> some;
  std::size_t left = settings_.contactsPerPair;
  while (left > 0 && !query.complete()) {
    const std::span<BallContact> room(some.data(), std::min(left, some.size()));
    const std::size_t count = query.nextContacts(room, limits);
    for (std::size_t i = 0; i < count; ++i) out.push_back(treeContact(pair, some[i], query.slackBound()));
    left -= count;
  }
}

void CollisionWorld::findContactsInBlocks() {
  struct Job {
    CollisionWorld& world;
    std::atomic<std::size_t> next{0};
  };
  blocks_.resize((pairs_.size() + kPairsPerBlock - 1) / kPairsPerBlock);
  for (Bench& bench : benches_) bench.contacts.clear();
  Job job{*this};
  pool_->run(
      [](void* context, std::uint32_t worker) {
        Job& mine = *static_cast<Job*>(context);
        CollisionWorld& world = mine.world;
        Bench& bench = world.benches_[worker];
        for (std::size_t i = mine.next++; i < world.blocks_.size(); i = mine.next++) {
          const std::size_t end = std::min(world.pairs_.size(), (i + 1) * kPairsPerBlock);
          const auto begin = static_cast<std::uint32_t>(bench.contacts.size());
          const std::size_t first = i * kPairsPerBlock;
          world.collideRun(std::span(world.pairs_).subspan(first, end - first), bench, bench.contacts);
          world.blocks_[i] = {worker, begin, static_cast<std::uint32_t>(bench.contacts.size())};
        }
      },
      &job);
  for (const Block& block : blocks_) {
    const auto from = benches_[block.bench].contacts.begin();
    contacts_.insert(contacts_.end(), from + static_cast<std::ptrdiff_t>(block.begin),
                     from + static_cast<std::ptrdiff_t>(block.end));
  }
  // A thread may happen to take all blocks of the next frame.
  for (Bench& bench : benches_) bench.contacts.reserve(contacts_.capacity());
}

void CollisionWorld::findContactsInBudget() {
  const auto areTrees = [&](const BodyPair& pair) {
    return kinds_[pair.a] == Kind::Tree && kinds_[pair.b] == Kind::Tree;
  };
  const auto count = static_cast<std::size_t>(std::count_if(pairs_.begin(), pairs_.end(), areTrees));
  if (queries_.size() < count) queries_.resize(count);
  scheduled_.clear();
  for (const BodyPair& pair : pairs_) {
    if (!areTrees(pair)) continue;
    PairQuery& query = queries_[scheduled_.size()];
    query.setTrees(*shapes_[pair.a].tree, *shapes_[pair.b].tree);
    query.restart(pose(pair.a), pose(pair.b));
    scheduled_.push_back({&query, std::max(relevances_[pair.a], relevances_[pair.b])});
  }
  scheduler_.run(scheduled_, settings_.budget);
  std::size_t next = 0;
  for (const BodyPair& pair : pairs_) {
    if (!areTrees(pair)) {
      collide(pair, benches_[0], contacts_);
      continue;
    }
    const PairQuery& query = *scheduled_[next++].query;
    const Answer answer = query.answerAt(settings_.budget.deepestLevel);
    if (answer == Answer::Disjoint) continue;
    contacts_.push_back(treeContact(pair, query.contact(), query.slackBound()));
    contacts_.back().decided = answer == Answer::Overlapping;
  }
}

}  // namespace spheretree
