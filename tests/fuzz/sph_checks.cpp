// SPDX-License-Identifier: GPL-3.0-or-later
//
// What must hold for any bytes that claim to be a sphere tree. The reference for queries is the definition:
// two trees overlap when a pair of chains does on every level, tried by recursion over all pairs, in double.

#include "sph_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <span>
#include <vector>

#include <spheretree/distance_query.hpp>
#include <spheretree/pair_query.hpp>
#include <spheretree/simd.hpp>

#include "counted_heap.hpp"

namespace spheretree::fuzz {

namespace {

bool isOneCleanLine(const std::string& message) {
  return !message.empty() &&
         std::all_of(message.begin(), message.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

std::string treeFlaw(const SphereTree& tree) {
  const auto nodes = tree.nodes();
  std::size_t next = 1;  // where the next run of children must begin
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Sphere& ball = nodes[i].ball;
    const bool finite = std::isfinite(ball.center.x) && std::isfinite(ball.center.y) &&
                        std::isfinite(ball.center.z) && std::isfinite(ball.radius);
    if (!finite || ball.radius < 0) return "a ball is no ball";
    for (const Node& child : tree.children(nodes[i])) {
      if (&child != &nodes[next++]) return "children do not stand in the order of their parents";
      if (child.parent != i) return "a child names another parent";
    }
  }
  if (next != nodes.size()) return "a node is nobody's child";
  std::size_t onLevels = 0;
  for (std::size_t depth = 0; depth < tree.levelCount(); ++depth) onLevels += tree.level(depth).size();
  return onLevels == nodes.size() ? "" : "levels do not hold every node once";
}

/// Writing what was read, reading that and writing it again must change nothing.
std::string roundTripFlaw(const SphFile& file) {
  const Result<std::string> text = formatSph(file.tree, file.branch);
  if (!text) return "what was read cannot be written: " + text.error().message;
  const Result<SphFile> again = parseSph(*text);
  if (!again) return "what was written cannot be read: " + again.error().message;
  if (!again->warnings.empty()) return "what was written is read with a warning";
  if (again->tree.nodes().size() != file.tree.nodes().size()) return "a round trip changes the count";
  const Result<std::string> twice = formatSph(again->tree, again->branch);
  return twice && twice.value() == *text ? "" : "a second round trip changes the bytes";
}

/// A ball in double.
struct Place {
  std::array<double, 3> center{};
  double radius = 0;
};

/// A pose whose rotation is taken as the unit quaternion that it stands for.
class Motion {
 public:
  explicit Motion(const Pose& pose)
      : scale_(static_cast<double>(pose.scale)),
        shift_{static_cast<double>(pose.translation.x), static_cast<double>(pose.translation.y),
               static_cast<double>(pose.translation.z)} {
    const auto x = static_cast<double>(pose.rotation.x);
    const auto y = static_cast<double>(pose.rotation.y);
    const auto z = static_cast<double>(pose.rotation.z);
    const auto w = static_cast<double>(pose.rotation.w);
    const double k = 2 / (x * x + y * y + z * z + w * w);
    turn_ = {1 - k * (y * y + z * z), k * (x * y - w * z),     k * (x * z + w * y),
             k * (x * y + w * z),     1 - k * (x * x + z * z), k * (y * z - w * x),
             k * (x * z - w * y),     k * (y * z + w * x),     1 - k * (x * x + y * y)};
  }

  [[nodiscard]] Place operator()(const Sphere& ball) const {
    const std::array<double, 3> p{scale_ * static_cast<double>(ball.center.x),
                                  scale_ * static_cast<double>(ball.center.y),
                                  scale_ * static_cast<double>(ball.center.z)};
    Place place;
    for (std::size_t row = 0; row < 3; ++row) {
      place.center[row] =
          turn_[3 * row] * p[0] + turn_[3 * row + 1] * p[1] + turn_[3 * row + 2] * p[2] + shift_[row];
    }
    place.radius = scale_ * static_cast<double>(ball.radius);
    return place;
  }

 private:
  double scale_;
  std::array<double, 3> shift_;
  std::array<double, 9> turn_{};
};

double gapOf(const Place& a, const Place& b) {
  return std::hypot(a.center[0] - b.center[0], a.center[1] - b.center[1], a.center[2] - b.center[2]) -
         a.radius - b.radius;
}

/// Two placed trees: everything that is true of their chains.
class Chains {
 public:
  Chains(const SphereTree& tree, const Pose& poseA, const Pose& poseB) : tree_(tree), a_(poseA), b_(poseB) {
    levels_ = tree.levelCount() - 1;
    nearest_ = descend(tree.root(), tree.root(), levels_, -std::numeric_limits<double>::infinity());
  }

  /// The least, over all pairs of chains, of the largest gap along the pair.
  [[nodiscard]] double nearest() const { return nearest_; }
  [[nodiscard]] bool exhausted() const { return pairs_ > kMostPairs; }

 private:
  static constexpr std::size_t kMostPairs = 20'000;  // of balls; a fuzzer wants many inputs, not large ones

  double descend(const Node& x, const Node& y, std::size_t levelsLeft, double inherited) {
    const double gap = std::max(inherited, gapOf(a_(x.ball), b_(y.ball)));
    if (levelsLeft == 0 || ++pairs_ > kMostPairs) return gap;
    const std::span<const Node> below = x.childCount > 0 ? tree_.children(x) : std::span(&x, 1);
    const std::span<const Node> beside = y.childCount > 0 ? tree_.children(y) : std::span(&y, 1);
    double least = std::numeric_limits<double>::infinity();
    for (const Node& child : below) {
      for (const Node& other : beside) least = std::min(least, descend(child, other, levelsLeft - 1, gap));
    }
    return least;
  }

  const SphereTree& tree_;
  Motion a_;
  Motion b_;
  std::size_t levels_ = 0;
  std::size_t pairs_ = 0;
  double nearest_ = 0;
};

/// Anything that finds its way into a float of a scene.
Pose somePose(std::mt19937_64& random, float size) {
  const auto number = [&random] { return static_cast<float>(random() >> 40U) * 0x1p-23F - 1; };
  Pose pose;
  switch (random() % 4) {
    case 0:
      break;
    case 1:
      pose.translation = {size * number(), size * number(), size * number()};
      break;
    default:
      pose.translation = {2 * size * number(), size * number(), 0};
      pose.rotation = {number(), number(), number(), 1.5F + number()};
      pose.scale = random() % 2 == 0 ? 1 : 1.5F + number();
  }
  return pose;
}

/// No wide instructions while it lives.
class ScalarOnly {
 public:
  ScalarOnly() { limitSimd(SimdLevel::Scalar); }
  ~ScalarOnly() { limitSimd(supportedSimd()); }
  ScalarOnly(const ScalarOnly&) = delete;
  ScalarOnly& operator=(const ScalarOnly&) = delete;
};

/// In small steps and without wide instructions the answer is the same, and the slack only shrinks.
std::string walkFlaw(const QueryTree& tree, const Pose& poseA, const Pose& poseB, Answer answer) {
  const ScalarOnly scalar;
  PairQuery steps(tree, tree);
  steps.restart(poseA, poseB);
  float slack = std::numeric_limits<float>::infinity();
  std::vector<BallContact> pending(8);
  for (int calls = 0; steps.advance({.sphereTests = 64}) == Answer::Undecided; ++calls) {
    if (calls > 100'000) return "a query never ends";
    if (steps.slackBound() > slack) return "more work made the slack larger";
    slack = steps.slackBound();
    static_cast<void>(steps.pendingContacts(pending));
  }
  if (steps.answer() != answer) return "in small steps the answer is another one";
  std::array<BallContact, 4> contacts;
  steps.restart(poseA, poseB);
  const bool some = steps.nextContacts(contacts) > 0;
  // Lengths that squares of floats cannot hold: overlapping with an infinite slack, and no pair to show.
  const bool measurable = steps.slackBound() < std::numeric_limits<float>::infinity();
  if (measurable && some != (answer == Answer::Overlapping)) return "contacts contradict the answer";
  return "";
}

}  // namespace

Result<SphFile> parseTight(std::string_view text, std::size_t levels) {
  const std::unique_ptr<char[]> copy(new char[text.size()]);
  text.copy(copy.get(), text.size());
  return parseSph({copy.get(), text.size()}, {levels});
}

std::string codecFlaw(std::string_view text, std::size_t levels) {
  const std::unique_ptr<char[]> copy(new char[text.size()]);
  text.copy(copy.get(), text.size());
  const HeapWatch heap;
  const Result<SphFile> file = parseSph({copy.get(), text.size()}, {levels});
  const std::size_t peak = heap.peak();
  if (peak > kHeapPerByte * text.size() + kHeapBeside) {
    return std::to_string(peak) + " bytes of memory for " + std::to_string(text.size()) + " bytes of text";
  }
  if (!file) {
    const Error& error = file.error();
    if (error.code != ErrorCode::UnreadableInput)
      return "another error than UnreadableInput: " + error.message;
    if (!isOneCleanLine(error.message)) return "the error is not one clean line";
    return error.message.starts_with("line ") ? "" : "the error names no line: " + error.message;
  }
  for (const std::string& warning : file->warnings) {
    if (!isOneCleanLine(warning)) return "a warning is not one clean line";
  }
  if (file->tree.levelCount() > levels) return "more levels than asked for";
  if (file->tree.maxChildren() > file->branch) return "more children than the branching factor";
  if (std::string flaw = treeFlaw(file->tree); !flaw.empty()) return flaw;
  return roundTripFlaw(*file);
}

std::string queryFlaw(const SphFile& file, std::uint64_t seed) {
  // Refused: too many levels or children, and metadata that says something impossible.
  const Result<QueryTree> certified = QueryTree::create(file.tree, standOffsOf(file));
  static_cast<void>(certified.ok());
  const Result<QueryTree> laid = QueryTree::create(file.tree);
  if (!laid) return laid.error().code == ErrorCode::InvalidArgument ? "" : laid.error().message;
  std::mt19937_64 random(seed);
  const float size = std::min(laid->extent(), std::numeric_limits<float>::max() / 4);
  const Pose poseA = somePose(random, size);
  const Pose poseB = somePose(random, size);
  PairQuery query(*laid, *laid);
  query.restart(poseA, poseB);
  const Answer answer = query.advance();
  if (answer == Answer::Undecided) return "undecided without a limit";
  const DistanceBounds bounds = distanceBetween(*laid, poseA, *laid, poseB);
  if (!(bounds.lower <= bounds.upper)) return "the distance is bounded the wrong way round";
  // The walk compares squares, the distance lengths: they may differ by what both count as rounding.
  const float rounding = 1e-4F * size * (poseA.scale + poseB.scale + 4) + 0x1p-58F;
  if (answer == Answer::Overlapping && bounds.lower > rounding) return "overlapping, and yet a distance";
  const Chains chains(file.tree, poseA, poseB);
  if (chains.exhausted()) return "";
  if (chains.nearest() < 0 && answer == Answer::Disjoint) return "an overlap was missed";
  if (std::max(0.0, chains.nearest()) < static_cast<double>(bounds.lower))
    return "the chains are nearer than the lower bound";
  return walkFlaw(*laid, poseA, poseB, answer);
}

}  // namespace spheretree::fuzz
