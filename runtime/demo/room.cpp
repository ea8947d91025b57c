// SPDX-License-Identifier: MIT
//
// The response is the paper's: components of the velocities are negated, nothing else. Which ones, it leaves
// half open; these rules make sure that nothing sticks and nothing leaves.
//   * The axis of least interpenetration of the boxes chooses the component; with narrow phase, the mean
//     normal of the overlapping pairs of balls does, weighted by depth: all in which it has half its length.
//   * In these each body that moves towards the other turns back, unless the two part already, faster than
//   the
//     slowest object flies. Which side the other is on is said by the places: normals of balls deep in each
//     other may turn round from step to step, and bodies would dance on the spot.
//   * A body turns at a wall before the step that would take it through. Walls come last, so they win; the
//     other body of a pair at a wall has still turned away from it.
// Every body that touches another therefore moves away from it along some axis at no less than the slowest
// speed, for as long as no third one interferes.
#include "room.hpp"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <memory>
#include <utility>

#include <spheretree/grid_sweep.hpp>

namespace crowded_room {

namespace {

using spheretree::Aabb;
using spheretree::BodyPair;
using spheretree::BroadPhase;
using spheretree::BroadPhaseKind;
using spheretree::CollisionWorld;
using spheretree::Contact;
using spheretree::Done;
using spheretree::Error;
using spheretree::ErrorCode;
using spheretree::QueryTree;
using spheretree::Result;
using spheretree::SphereTree;
using spheretree::Vec3;
using Clock = std::chrono::steady_clock;

constexpr float kStepSeconds = 1.0F / kFrameRate;
constexpr std::uint32_t kMostObjects = 1U << 20U;
constexpr float kLeastEdge = 8;  // several objects, and more than two steps at the greatest speed
constexpr float kLargestEdge = 1e4F;
constexpr float kGreatestSpeed =
    kFrameRate;                             // an object's size per step: faster ones pass through each other
constexpr std::uint32_t kFinestGrid = 256;  // voxels along an axis
constexpr std::uint32_t kMostThreads = 64;
/// Of the greatest speed, on each axis: nothing hovers, and two objects in each other part in a second.
constexpr float kSlowest = 0.2F;
constexpr float kHalf = 0.5F;  // of the length of a normal; its largest component has at least 0.577
/// The runtime enlarges boxes by 2^-20 of the place; the walls keep four times that distance.
constexpr float kWallMargin = 0x1p-18F;
constexpr std::uint32_t kAvatar = 0;
constexpr std::size_t kContactsAhead = 8;  // of some 20 ns each, a fetch from memory

constexpr std::array<float Vec3::*, 3> kAxes{&Vec3::x, &Vec3::y, &Vec3::z};

/// A ball, shared by all rooms.
const QueryTree& avatarTree() {
  static const QueryTree tree = [] {
    const SphereTree::Entry ball{{{0, 0, 0}, Room::kAvatarRadius}, spheretree::kNoParent};
    const float exact = 0;
    return std::move(*QueryTree::create(*SphereTree::create({&ball, 1}), {&exact, 1}));
  }();
  return tree;
}

float share(std::mt19937& random) {
  return static_cast<float>(random() >> 8U) * 0x1p-24F;
}

float signedShare(std::mt19937& random) {
  const float value = 2 * share(random) - 1;
  return std::copysign(kSlowest + (1 - kSlowest) * std::abs(value), value);
}

float onStick(float value) {
  return std::isnan(value) ? 0 : std::clamp(value, -1.0F, 1.0F);
}

/// Bunnies are spread evenly among the objects.
bool isBunny(std::uint32_t object, float bunnyShare) {
  const auto before = [&](double objects) { return std::floor(objects * static_cast<double>(bunnyShare)); };
  return before(object + 1.0) > before(object);
}

std::unique_ptr<BroadPhase> makeEngine(const RoomSettings& settings) {
  if (settings.broadPhase == BroadPhaseKind::Grid) return std::make_unique<spheretree::Grid>(settings.grid);
  if (settings.broadPhase == BroadPhaseKind::GridSweep)
    return std::make_unique<spheretree::GridSweep>(settings.grid);
  return spheretree::makeBroadPhase(settings.broadPhase);
}

spheretree::WorldSettings worldSettings(const RoomSettings& settings) {
  spheretree::WorldSettings world;
  world.narrow = settings.narrow;
  world.contactsPerPair = settings.contactsPerPair;
  world.threads = settings.threads;
  world.budget = settings.budget;
  world.budget.deepestLevel = settings.levels - 1;
  return world;
}

/// The tree of that name, or the usual one when there is no name; nothing for a name that is not known.
const UnitTree* chooseTree(const TreeLibrary& library, const std::string& name, TreeUse use) {
  return name.empty() ? &library.usual(use) : library.find(name);
}

Error wrong(const std::string& setting, const std::string& value, const std::string& mayBe) {
  return {ErrorCode::InvalidArgument, setting + " is " + value + "; it may be " + mayBe};
}

Error wrong(const std::string& setting, float value, const std::string& mayBe) {
  return wrong(setting, std::to_string(value), mayBe);
}

Result<Done> checkNumbers(const RoomSettings& s) {
  if (s.objects > kMostObjects)
    return wrong("objects", std::to_string(s.objects), "at most " + std::to_string(kMostObjects));
  if (!(s.bunnyShare >= 0 && s.bunnyShare <= 1)) return wrong("bunnyShare", s.bunnyShare, "from 0 to 1");
  if (!(s.speed > 0 && s.speed <= kGreatestSpeed))
    return wrong("speed", s.speed, "above 0 and at most " + std::to_string(kFrameRate));
  for (const auto axis : kAxes) {
    if (!(s.size.*axis >= kLeastEdge && s.size.*axis <= kLargestEdge))
      return wrong("an edge of the room", s.size.*axis, "from 8 to 10000");
  }
  if (std::max({s.grid.x, s.grid.y, s.grid.z}) > kFinestGrid)
    return wrong("the grid", std::to_string(std::max({s.grid.x, s.grid.y, s.grid.z})),
                 "at most " + std::to_string(kFinestGrid) + " along each axis");
  if (s.levels == 0 || s.levels > spheretree::kMaxQueryLevels)
    return wrong("levels", std::to_string(s.levels),
                 "from 1 to " + std::to_string(spheretree::kMaxQueryLevels));
  if (s.threads == 0 || s.threads > kMostThreads)
    return wrong("threads", std::to_string(s.threads), "from 1 to " + std::to_string(kMostThreads));
  if (s.contactsPerPair == 0) return wrong("contactsPerPair", "0", "1 or more");
  return Done{};
}

Result<Done> check(const RoomSettings& settings, const TreeLibrary& library) {
  for (const std::string& name : {settings.bunnyTree, settings.boxTree}) {
    if (name.empty() || library.find(name) != nullptr) continue;
    std::string known;
    for (const UnitTree& tree : library.trees()) known += (known.empty() ? "" : ", ") + tree.name;
    return wrong("the tree", name, "one of " + known);
  }
  return checkNumbers(settings);
}

/// Among `axes`, the one along which two boxes are least in each other.
float Vec3::*leastOverlap(const Aabb& a, const Aabb& b, std::span<float Vec3::*const> axes) noexcept {
  const auto depth = [&](float Vec3::*axis) {
    return std::min(a.max.*axis - b.min.*axis, b.max.*axis - a.min.*axis);
  };
  return *std::min_element(axes.begin(), axes.end(),
                           [&](auto one, auto other) { return depth(one) < depth(other); });
}

/// The axes along which objects move.
std::span<float Vec3::*const> axesOf(Movement movement) noexcept {
  static constexpr std::array<float Vec3::*, 2> kPlane{&Vec3::x, &Vec3::z};
  if (movement == Movement::PlaneXZ) return kPlane;
  return kAxes;
}

/// The mean normal of the contacts of one pair, weighted by depth.
Vec3 meanNormal(std::span<const Contact> contacts) noexcept {
  Vec3 sum;
  for (const Contact& contact : contacts) sum = sum + contact.depth * contact.normal;
  const float norm = spheretree::length(sum);
  return norm > 0 ? (1 / norm) * sum : contacts.front().normal;
}

float microsecondsSince(Clock::time_point start) noexcept {
  return std::chrono::duration<float, std::micro>(Clock::now() - start).count();
}

}  // namespace

Room::Room(const RoomSettings& settings, const TreeLibrary& library)
    : settings_(settings),
      library_(&library),
      random_(settings.seed),
      world_(makeEngine(settings), worldSettings(settings)) {
  rebuild(0);
}

Result<Room> Room::create(const RoomSettings& settings, const TreeLibrary& library) {
  if (const Result<Done> checked = check(settings, library); !checked) return checked.error();
  return Room(settings, library);
}

Result<Done> Room::change(const RoomSettings& settings) {
  if (Result<Done> checked = check(settings, *library_); !checked) return checked;
  std::uint32_t kept = std::min(bodyCount(), settings.objects + 1);
  if (settings.seed != settings_.seed) {
    random_.seed(settings.seed);
    draws_.clear();
    steps_ = 0;
    kept = 0;
  }
  settings_ = settings;
  rebuild(kept);
  return Done{};
}

void Room::drawObjects() {
  while (draws_.size() < settings_.objects) {
    State& draw = draws_.emplace_back();
    for (const auto axis : kAxes) draw.place.*axis = share(random_);
    for (const auto axis : kAxes) draw.velocity.*axis = signedShare(random_);
  }
}

/// The velocity that an object started with; its components never change their magnitudes.
Vec3 Room::ownVelocity(std::uint32_t object) const noexcept {
  Vec3 velocity = settings_.speed * draws_[object].velocity;
  if (settings_.movement == Movement::PlaneXZ) velocity.y = 0;
  return velocity;
}

/// Of the bodies so far, the first `bodiesKept` stay what they are; the others begin.
Room::State Room::stateOf(std::uint32_t body, std::uint32_t bodiesKept) const noexcept {
  const bool kept = body < bodiesKept;
  if (body == kAvatar) return kept ? State{place(body), {}} : State{0.5F * settings_.size, {}};
  const State& draw = draws_[body - 1];
  State state{kept ? place(body) : Vec3{}, ownVelocity(body - 1)};
  for (const auto axis : kAxes) {
    if (!kept) state.place.*axis = draw.place.*axis * settings_.size.*axis;
    if (kept && velocity(body).*axis != 0)  // those that rest on an axis have forgotten the direction
      state.velocity.*axis = std::copysign(state.velocity.*axis, velocity(body).*axis);
  }
  return state;
}

void Room::rebuild(std::uint32_t bodiesKept) {
  drawObjects();
  std::vector<State> states;
  states.reserve(bodyCount());
  for (std::uint32_t body = 0; body < bodyCount(); ++body) states.push_back(stateOf(body, bodiesKept));

  bunny_ = chooseTree(*library_, settings_.bunnyTree, TreeUse::Bunny);
  boxTree_ = chooseTree(*library_, settings_.boxTree, TreeUse::Box);
  const bool exact = settings_.boxShape == BoxShape::Exact;
  const Vec3 half{kHalf, kHalf, kHalf};
  const Aabb boxBounds = exact ? Aabb{-half, half} : boxTree_->query.bounds();
  const float margin = kWallMargin * std::max({settings_.size.x, settings_.size.y, settings_.size.z});
  const Vec3 gap{margin, margin, margin};
  ranges_ = {};
  for (const auto& [kind, bounds] :
       {std::pair{ObjectKind::Avatar, avatarTree().bounds()},
        std::pair{ObjectKind::Bunny, bunny_->query.bounds()}, std::pair{ObjectKind::Box, boxBounds}}) {
    ranges_[static_cast<std::size_t>(kind)] = {gap - bounds.min, settings_.size - bounds.max - gap};
  }

  world_ = CollisionWorld(makeEngine(settings_), worldSettings(settings_));
  kinds_.clear();
  for (std::uint32_t body = 0; body < bodyCount(); ++body) {
    const ObjectKind kind = body == kAvatar                           ? ObjectKind::Avatar
                            : isBunny(body - 1, settings_.bunnyShare) ? ObjectKind::Bunny
                                                                      : ObjectKind::Box;
    kinds_.push_back(kind);
    const Range& range = ranges_[static_cast<std::size_t>(kind)];
    spheretree::Pose pose;
    for (const auto axis : kAxes)
      pose.translation.*axis = std::clamp(states[body].place.*axis, range.low.*axis, range.high.*axis);
    if (kind == ObjectKind::Box && exact) {
      world_.addBox(half, pose, states[body].velocity);
    } else {
      const QueryTree& tree = kind == ObjectKind::Avatar  ? avatarTree()
                              : kind == ObjectKind::Bunny ? bunny_->query
                                                          : boxTree_->query;
      world_.addTree(tree, pose, states[body].velocity);
    }
  }
  if (bodiesKept == 0) pushes_.clear();
  impacts_.clear();
  report_ = {};
  turnAtWalls();
}

const UnitTree& Room::treeOf(ObjectKind kind) const noexcept {
  return kind == ObjectKind::Bunny ? *bunny_ : *boxTree_;
}

/// The avatar has no momentum of its own: it goes where the stick points, except into what it touches.
void Room::steer(const StickInput& input) noexcept {
  consumed_ = {input, steps_ + 1};
  Vec3& stick = consumed_.input.stick;
  stick = {onStick(stick.x), onStick(stick.y), onStick(stick.z)};
  Vec3 velocity = kAvatarSpeed * stick;
  const Range& range = ranges_[static_cast<std::size_t>(ObjectKind::Avatar)];
  const Vec3 next = place(kAvatar) + kStepSeconds * velocity;
  for (const auto axis : kAxes) {
    bool stopped = next.*axis < range.low.*axis || next.*axis > range.high.*axis;
    for (const Vec3& push : pushes_)
      stopped = stopped || (std::abs(push.*axis) >= kHalf && push.*axis * velocity.*axis > 0);
    if (stopped) velocity.*axis = 0;
  }
  world_.setVelocity(kAvatar, velocity);
}

Result<Done> Room::step(const StickInput& input) {
  steer(input);
  if (Result<Done> stepped = world_.step(kStepSeconds); !stepped) return stepped;
  ++steps_;
  const Clock::time_point start = Clock::now();
  respond();
  turnAtWalls();
  report_ = {world_.times(), microsecondsSince(start), world_.pairs().size(), world_.contacts().size()};
  return Done{};
}

Result<bool> Room::tick(const StickInput& input) {
  if (flow_ == Flow::Paused && !stepAsked_) return false;
  stepAsked_ = false;
  if (const Result<Done> stepped = step(input); !stepped) return stepped.error();
  return true;
}

void Room::respond() {
  pushes_.clear();
  impacts_.clear();
  const std::span<const Contact> contacts = world_.contacts();
  for (std::size_t begin = 0, end = 0; begin < contacts.size(); begin = end) {
    const Contact& first = contacts[begin];
    world_.expect(contacts[std::min(begin + kContactsAhead, contacts.size() - 1)].b);
    while (end < contacts.size() && contacts[end].a == first.a && contacts[end].b == first.b) ++end;
    const Vec3 normal = meanNormal(contacts.subspan(begin, end - begin));
    if (first.a == kAvatar) hitAvatar(first, normal);
    respondTo({first.a, first.b}, normal);
  }
}

void Room::hitAvatar(const Contact& contact, Vec3 normal) {
  pushes_.push_back(normal);
  const float speed = dot(velocity(kAvatar) - velocity(contact.b), normal);
  if (speed > 0) impacts_.push_back({contact.b, speed, -normal, contact.point});
}

void Room::respondTo(const BodyPair& pair, Vec3 normal) noexcept {
  const std::span<float Vec3::*const> axes = axesOf(settings_.movement);
  float norm = 0;
  for (const auto axis : axes) norm += normal.*axis * normal.*axis;
  norm = std::sqrt(norm);
  if (norm < kHalf) {  // bodies of the plane above each other: the boxes say how they part
    normal = {};
    normal.*leastOverlap(box(pair.a), box(pair.b), axes) = 1;
    norm = 1;
  }
  const Vec3 way = place(pair.b) - place(pair.a);
  Vec3 a = velocity(pair.a);
  Vec3 b = velocity(pair.b);
  for (const auto axis : axes) {
    const float side = way.*axis < 0 ? -1.0F : 1.0F;
    const bool parting = (b.*axis - a.*axis) * side >= kSlowest * settings_.speed;
    if (std::abs(normal.*axis) < kHalf * norm || parting) continue;
    if (a.*axis * side > 0 && pair.a != kAvatar) a.*axis = -a.*axis;
    if (b.*axis * side < 0) b.*axis = -b.*axis;
  }
  world_.setVelocity(pair.a, a);
  world_.setVelocity(pair.b, b);
}

void Room::turnAtWalls() noexcept {
  for (std::uint32_t body = kAvatar + 1; body < bodyCount(); ++body) {
    const Range& range = ranges_[static_cast<std::size_t>(kinds_[body])];
    Vec3 velocity = world_.velocity(body);
    const Vec3 next = place(body) + kStepSeconds * velocity;
    for (const auto axis : kAxes) {
      const bool leaves = next.*axis < range.low.*axis ? velocity.*axis < 0
                                                       : next.*axis > range.high.*axis && velocity.*axis > 0;
      if (leaves) velocity.*axis = -velocity.*axis;
    }
    world_.setVelocity(body, velocity);
  }
}

std::uint64_t Room::stateHash() const noexcept {
  constexpr std::uint64_t kOffset = 0xcbf29ce484222325U;
  constexpr std::uint64_t kPrime = 0x100000001b3U;
  std::uint64_t hash = kOffset;
  const auto add = [&](Vec3 value) {
    for (const auto axis : kAxes) {
      const auto bits = std::bit_cast<std::uint32_t>(value.*axis);
      for (unsigned shift = 0; shift < 32; shift += 8) hash = (hash ^ ((bits >> shift) & 0xffU)) * kPrime;
    }
  };
  for (std::uint32_t body = 0; body < bodyCount(); ++body) {
    add(place(body));
    add(velocity(body));
  }
  return hash;
}

Audit Room::audit() const noexcept {
  Audit audit;
  const Aabb room = walls();
  for (std::uint32_t body = 0; body < bodyCount(); ++body) {
    const Aabb& own = box(body);
    const bool inside = own.min.x >= room.min.x && own.min.y >= room.min.y && own.min.z >= room.min.z &&
                        own.max.x <= room.max.x && own.max.y <= room.max.y && own.max.z <= room.max.z;
    if (!inside) ++audit.outside;
    if (body == kAvatar) continue;
    const Vec3 first = ownVelocity(body - 1);
    const Vec3 now = velocity(body);
    const bool kept = std::abs(now.x) == std::abs(first.x) && std::abs(now.y) == std::abs(first.y) &&
                      std::abs(now.z) == std::abs(first.z);
    if (!kept) ++audit.changedSpeeds;
  }
  return audit;
}

std::string_view nameOf(Movement movement) noexcept {
  return movement == Movement::PlaneXZ ? "xz" : "xyz";
}

std::string_view nameOf(BoxShape shape) noexcept {
  return shape == BoxShape::Tree ? "tree" : "exact";
}

std::string_view nameOf(ObjectKind kind) noexcept {
  return kind == ObjectKind::Avatar ? "avatar" : kind == ObjectKind::Bunny ? "bunny" : "box";
}

}  // namespace crowded_room
