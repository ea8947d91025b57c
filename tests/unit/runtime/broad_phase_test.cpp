// SPDX-License-Identifier: GPL-3.0-or-later
#include <spheretree/broad_phases.hpp>
#include <spheretree/brute_force.hpp>
#include <spheretree/grid.hpp>
#include <spheretree/grid_sweep.hpp>
#include <spheretree/octree_broad_phase.hpp>
#include <spheretree/simd.hpp>
#include <spheretree/sweep.hpp>
#include <spheretree/sweep_and_prune.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "counted_heap.hpp"
#include "crowd.hpp"

namespace spheretree {
namespace {

using fuzz::HeapWatch;
using tests::Crowd;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// An engine on one instruction set, with what it found last.
struct Engine {
  std::string name;
  std::unique_ptr<BroadPhase> engine;
  SimdLevel simd = SimdLevel::Avx512;
  std::vector<BodyPair> pairs;

  bool find(std::span<const Aabb> boxes) {
    limitSimd(simd);
    const bool ok = engine->findPairs(boxes, pairs).ok();
    limitSimd(SimdLevel::Avx512);
    return ok;
  }
};

void addSweeps(std::vector<Engine>& engines) {
  const std::pair<const char*, SimdLevel> paths[] = {{"sweep scalar", SimdLevel::Scalar},
                                                     {"sweep sse2", SimdLevel::Sse2},
                                                     {"sweep avx2", SimdLevel::Avx2},
                                                     {"sweep avx512", SimdLevel::Avx512}};
  for (const auto& [name, level] : paths) {
    if (level <= supportedSimd()) engines.push_back({name, std::make_unique<Sweep>(), level, {}});
  }
}

/// One of each kind but brute force, and sweep on every path; the scalar one comes first.
std::vector<Engine> engineOfEachKind() {
  std::vector<Engine> engines;
  addSweeps(engines);
  for (const BroadPhaseKind kind : kBroadPhaseKinds) {
    if (kind == BroadPhaseKind::BruteForce || kind == BroadPhaseKind::Sweep) continue;
    engines.push_back({std::string(nameOf(kind)), makeBroadPhase(kind), SimdLevel::Avx512, {}});
  }
  return engines;
}

/// The same and some in other settings.
std::vector<Engine> allEngines() {
  std::vector<Engine> engines = engineOfEachKind();
  engines.push_back({"grid as in the paper", std::make_unique<Grid>(kPaperGrid), SimdLevel::Avx512, {}});
  engines.push_back({"octree of depth 6", std::make_unique<OctreeBroadPhase>(6), SimdLevel::Avx512, {}});
  return engines;
}

std::vector<BodyPair> pairsByBruteForce(std::span<const Aabb> boxes) {
  std::vector<BodyPair> pairs;
  EXPECT_TRUE(BruteForce().findPairs(boxes, pairs).ok());
  return pairs;
}

/// Not EXPECT_EQ on the lists: a difference among a million pairs must stay readable.
void expectPairs(std::vector<Engine>& engines, std::span<const Aabb> boxes,
                 std::span<const BodyPair> expected) {
  for (Engine& engine : engines) {
    SCOPED_TRACE(engine.name);
    ASSERT_TRUE(engine.find(boxes));
    const auto [found, wanted] =
        std::mismatch(engine.pairs.begin(), engine.pairs.end(), expected.begin(), expected.end());
    ASSERT_TRUE(found == engine.pairs.end() && wanted == expected.end())
        << engine.pairs.size() << " pairs instead of " << expected.size()
        << ", the first that differs is number " << found - engine.pairs.begin();
  }
}

Aabb cubeAt(Vec3 center, float edge = 1) {
  const Vec3 half{edge / 2, edge / 2, edge / 2};
  return {center - half, center + half};
}

class Numbers {
 public:
  explicit Numbers(std::uint32_t seed) : random_(seed) {}
  float operator()(float low, float high) {
    return low + (high - low) * static_cast<float>(random_() >> 8U) * 0x1p-24F;
  }
  std::size_t below(std::size_t limit) { return random_() % limit; }

 private:
  std::mt19937 random_;
};

TEST(BroadPhases, NamesLeadBackToTheirEngines) {
  for (const BroadPhaseKind kind : kBroadPhaseKinds) EXPECT_EQ(broadPhaseNamed(nameOf(kind)), kind);
  EXPECT_EQ(broadPhaseNamed("Sweep"), std::nullopt);
}

TEST(BroadPhases, NothingAndOneBoxMakeNoPair) {
  std::vector<Engine> engines = allEngines();
  const Aabb one = cubeAt({3, 4, 5});
  expectPairs(engines, {}, {});
  expectPairs(engines, {&one, 1}, {});
  expectPairs(engines, {&kAbsentBox, 1}, {});
}

TEST(BroadPhases, AWallOfBricksTouchesItsNeighboursOnly) {
  // A brick of an n x n x n wall touches up to 26 others: (3n - 2)^3 ordered pairs with itself in all.
  constexpr std::size_t n = 6;
  std::vector<Aabb> bricks;
  for (std::size_t k = 0; k < n * n * n; ++k) {
    bricks.push_back(
        cubeAt({static_cast<float>(k % n), static_cast<float>(k / n % n), static_cast<float>(k / n / n)}));
  }
  const std::vector<BodyPair> pairs = pairsByBruteForce(bricks);
  EXPECT_EQ(pairs.size(), (16 * 16 * 16 - n * n * n) / 2);
  std::vector<Engine> engines = allEngines();
  expectPairs(engines, bricks, pairs);
}

TEST(BroadPhases, ARowThatTouchesAndARowThatJustDoesNot) {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<Aabb> touching;
    std::vector<Aabb> apart;
    for (int k = 0; k < 500; ++k) {
      const auto at = static_cast<float>(k);
      const float next = std::nextafter(at + 1, 0.0F);
      Aabb box{{0, 0, 0}, {1, 1, 1}};
      (axis == 0 ? box.min.x : axis == 1 ? box.min.y : box.min.z) = at;
      (axis == 0 ? box.max.x : axis == 1 ? box.max.y : box.max.z) = at + 1;
      touching.push_back(box);
      (axis == 0 ? box.max.x : axis == 1 ? box.max.y : box.max.z) = next;
      apart.push_back(box);
    }
    std::vector<BodyPair> neighbours;
    for (std::uint32_t k = 0; k + 1 < touching.size(); ++k) neighbours.push_back({k, k + 1});
    std::vector<Engine> engines = allEngines();
    expectPairs(engines, touching, neighbours);
    expectPairs(engines, apart, {});
  }
}

TEST(BroadPhases, BoxesInOnePlaceAllMeet) {
  const std::vector<Aabb> boxes(300, cubeAt({7, 7, 7}));
  std::vector<Engine> engines = allEngines();
  expectPairs(engines, boxes, pairsByBruteForce(boxes));
  EXPECT_EQ(engines.front().pairs.size(), 300U * 299 / 2);
}

using Scene = std::vector<Aabb>;

Scene scatter(std::size_t count, std::uint32_t seed, const std::function<Aabb(Numbers&)>& make) {
  Numbers numbers(seed);
  Scene scene;
  for (std::size_t i = 0; i < count; ++i) scene.push_back(make(numbers));
  return scene;
}

/// Scenes that sweeps, grids and trees have been abandoned over.
std::vector<std::pair<std::string, Scene>> hardScenes() {
  std::vector<std::pair<std::string, Scene>> scenes;
  const auto add = [&](const char* name, std::size_t count, const std::function<Aabb(Numbers&)>& make) {
    scenes.emplace_back(name, scatter(count, static_cast<std::uint32_t>(scenes.size()) + 1, make));
  };
  add("a line along x", 700, [](Numbers& n) { return cubeAt({n(0, 300), 0, 0}); });
  add("a line along y", 700, [](Numbers& n) { return cubeAt({5, n(0, 300), 5}); });
  add("a line along z", 700, [](Numbers& n) { return cubeAt({-5, -5, n(0, 300)}); });
  add("a diagonal", 700, [](Numbers& n) {
    const float t = n(-200, 200);
    return cubeAt({t, t, t});
  });
  add("a floor", 700, [](Numbers& n) { return cubeAt({n(0, 40), 0, n(0, 40)}); });
  add("points", 400, [](Numbers& n) { return cubeAt({n(0, 1), n(0, 1), n(0, 1)}, 0); });
  add("points on a lattice", 700, [](Numbers& n) {
    return cubeAt({std::floor(n(0, 9)), std::floor(n(0, 9)), std::floor(n(0, 9))}, 0);
  });
  add("a lattice that touches", 700, [](Numbers& n) {
    return cubeAt({std::floor(n(0, 30)), std::floor(n(0, 30)), std::floor(n(0, 30))});
  });
  add("large among small", 700, [](Numbers& n) {
    const float edge = n.below(20) == 0 ? n(5, 90) : n(0.1F, 1);
    return cubeAt({n(0, 100), n(0, 25), n(0, 100)}, edge);
  });
  add("slabs in all directions", 300, [](Numbers& n) {
    const Vec3 center{n(0, 100), n(0, 100), n(0, 100)};
    Vec3 half{0.1F, 0.1F, 0.1F};
    const std::size_t thin = n.below(3);
    if (thin != 0) half.x = 30;
    if (thin != 1) half.y = 30;
    if (thin != 2) half.z = 30;
    return Aabb{center - half, center + half};
  });
  add("two clusters far apart", 700, [](Numbers& n) {
    const float at = n.below(2) == 0 ? -1e6F : 1e6F;
    return cubeAt({at + n(0, 20), n(0, 20), at + n(0, 20)});
  });
  add("a crowd and one far away", 700, [](Numbers& n) {
    if (n.below(300) == 0) return cubeAt({1e30F, -1e30F, 3e38F});
    return cubeAt({n(0, 40), n(0, 20), n(0, 40)});
  });
  add("all there is", 300, [](Numbers& n) {
    constexpr float kMost = std::numeric_limits<float>::max();
    if (n.below(50) == 0) return Aabb{{-kMost, -kMost, -kMost}, {kMost, kMost, kMost}};
    return cubeAt({n(-1, 1) * 1e38F, n(-1, 1) * 1e38F, n(-1, 1) * 1e38F}, n(0, 1) * 1e38F);
  });
  add("the smallest numbers", 300, [](Numbers& n) {
    return cubeAt({n(-1, 1) * 1e-40F, n(-1, 1) * 1e-40F, n(-1, 1) * 1e-40F}, n(0, 1) * 1e-41F);
  });
  add("both zeros", 100, [](Numbers& n) {
    const float zero = n.below(2) == 0 ? 0.0F : -0.0F;
    return n.below(2) == 0 ? Aabb{{zero, zero, zero}, {1, 1, 1}} : Aabb{{-1, -1, -1}, {zero, zero, zero}};
  });
  add("half of them absent", 700, [](Numbers& n) {
    return n.below(2) == 0 ? kAbsentBox : cubeAt({n(0, 30), n(0, 10), n(0, 30)});
  });
  add("few", 20, [](Numbers& n) { return cubeAt({n(0, 3), n(0, 3), n(0, 3)}); });
  return scenes;
}

TEST(BroadPhases, HardScenesByANewEngineEach) {
  for (const auto& [name, scene] : hardScenes()) {
    SCOPED_TRACE(name);
    std::vector<Engine> engines = allEngines();
    expectPairs(engines, scene, pairsByBruteForce(scene));
  }
}

TEST(BroadPhases, HardScenesOneAfterTheOtherByTheSameEngines) {
  std::vector<Engine> engines = allEngines();
  for (int round = 0; round < 2; ++round) {
    for (const auto& [name, scene] : hardScenes()) {
      SCOPED_TRACE(name);
      const std::vector<BodyPair> expected = pairsByBruteForce(scene);
      expectPairs(engines, scene, expected);
      expectPairs(engines, scene, expected);  // and now that it is known
    }
  }
}

TEST(BroadPhases, HardScenesInMotion) {
  for (auto& [name, scene] : hardScenes()) {
    SCOPED_TRACE(name);
    std::vector<Engine> engines = allEngines();
    Numbers numbers(99);
    for (int frame = 0; frame < 12; ++frame) {
      for (Aabb& box : scene) {
        if (box == kAbsentBox || std::abs(box.min.x) > 1e6F || std::abs(box.min.z) > 1e6F) continue;
        const Vec3 shift{numbers(-0.2F, 0.2F), numbers(-0.2F, 0.2F), numbers(-0.2F, 0.2F)};
        box = {box.min + shift, box.max + shift};
      }
      expectPairs(engines, scene, pairsByBruteForce(scene));
    }
  }
}

/// Bodies come, go, grow, shrink and jump; the list of them gets longer and shorter.
void disturb(Scene& scene, Numbers& numbers) {
  const auto place = [&] { return Vec3{numbers(0, 40), numbers(0, 20), numbers(0, 40)}; };
  for (int event = 0; event < 20; ++event) {
    const std::size_t body = numbers.below(scene.size());
    switch (numbers.below(6)) {
      case 0:
        scene[body] = kAbsentBox;
        break;
      case 1:
        scene[body] = cubeAt(place());
        break;
      case 2:
        scene[body] = cubeAt(place(), numbers(0.1F, 15));
        break;
      case 3:
        scene.push_back(cubeAt(place(), 2));
        break;
      case 4:
        if (scene.size() > 200) scene.pop_back();
        break;
      default:
        scene.push_back(kAbsentBox);
    }
  }
  switch (numbers.below(40)) {
    case 0:
      scene.resize(numbers.below(600) + 1, cubeAt(place()));
      break;
    case 1:
      for (Aabb& box : scene) box = cubeAt(place());
      break;
    default:
      break;
  }
}

TEST(BroadPhases, BodiesComeGoGrowAndJump) {
  constexpr std::uint32_t kSeed = 4;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  Numbers numbers(kSeed);
  Scene scene = scatter(400, kSeed, [](Numbers& n) { return cubeAt({n(0, 40), n(0, 20), n(0, 40)}); });
  std::vector<Engine> engines = allEngines();
  for (int frame = 0; frame < 300; ++frame) {
    SCOPED_TRACE("frame " + std::to_string(frame));
    disturb(scene, numbers);
    expectPairs(engines, scene, pairsByBruteForce(scene));
    if (HasFatalFailure()) return;
  }
}

/// Compares all engines with the first one in every frame, and that one with brute force every so often.
void runRoom(std::size_t count, float speed, int frames, int judgedEvery) {
  SCOPED_TRACE(std::to_string(count) + " boxes at " + std::to_string(speed) + " m/s");
  Crowd crowd({count, speed, 1, 1});
  std::vector<Engine> engines = engineOfEachKind();
  for (int frame = 0; frame < frames; ++frame) {
    SCOPED_TRACE("frame " + std::to_string(frame));
    crowd.step();
    Engine& first = engines.front();
    ASSERT_TRUE(first.find(crowd.boxes()));
    if (frame % judgedEvery == 0) {
      ASSERT_EQ(first.pairs, pairsByBruteForce(crowd.boxes()));
    }
    const std::vector<BodyPair> expected = first.pairs;
    expectPairs(engines, crowd.boxes(), expected);
    if (testing::Test::HasFatalFailure()) return;
  }
}

TEST(BroadPhases, TheRoomWith100) {
  runRoom(100, 5, 500, 1);
}

TEST(BroadPhases, TheRoomWith1000) {
  runRoom(1000, 5, 500, 5);
}

TEST(BroadPhases, TheRoomWith4000NearlyStill) {
  runRoom(4000, 0.05F, 100, 40);
}

TEST(BroadPhases, TheRoomWith10000) {
  runRoom(10000, 5, 500, 200);
}

TEST(BroadPhases, MalformedBoxesAreRefusedAndDoNoHarm) {
  std::vector<std::pair<Vec3, Vec3>> bad;
  for (const float wrong : {kNan, -kNan, kInfinity, -kInfinity}) {
    bad.push_back({{wrong, 0, 0}, {1, 1, 1}});
    bad.push_back({{0, wrong, 0}, {1, 1, 1}});
    bad.push_back({{0, 0, wrong}, {1, 1, 1}});
    bad.push_back({{0, 0, 0}, {wrong, 1, 1}});
    bad.push_back({{0, 0, 0}, {1, wrong, 1}});
    bad.push_back({{0, 0, 0}, {1, 1, wrong}});
    bad.push_back({{wrong, wrong, wrong}, {wrong, wrong, wrong}});
  }
  bad.push_back({{2, 0, 0}, {1, 1, 1}});
  bad.push_back({{0, 2, 0}, {1, 1, 1}});
  bad.push_back({{0, 0, 2}, {1, 1, 1}});
  bad.push_back({{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, 0}});

  Crowd crowd({200, 5, 0.3F, 1});
  std::vector<Engine> engines = allEngines();
  engines.push_back({"brute force", std::make_unique<BruteForce>(), SimdLevel::Avx512, {}});
  const std::vector<BodyPair> expected = pairsByBruteForce(crowd.boxes());
  ASSERT_GT(expected.size(), 10U);
  for (Engine& engine : engines) {
    SCOPED_TRACE(engine.name);
    for (const auto& [min, max] : bad) {
      for (const std::size_t place : {0U, 5U, 100U, 199U}) {
        Scene scene = crowd.boxes();
        scene[place] = {min, max};
        const Result<Done> result = engine.engine->findPairs(scene, engine.pairs);
        ASSERT_FALSE(result.ok());
        EXPECT_EQ(result.error().code, ErrorCode::InvalidArgument);
        EXPECT_NE(result.error().message.find("box " + std::to_string(place)), std::string::npos);
        EXPECT_TRUE(engine.pairs.empty());
      }
      ASSERT_TRUE(engine.find(crowd.boxes()));
      EXPECT_EQ(engine.pairs, expected);
    }
  }
}

TEST(BroadPhases, NothingIsTakenFromTheHeapOnceTheSceneIsKnown) {
  std::vector<Engine> engines = allEngines();
  for (const float speed : {5.0F, 0.05F}) {
    Crowd crowd({2000, speed, 1, 1});
    for (Engine& engine : engines) engine.pairs.reserve(1000);
    for (int frame = 0; frame < 60; ++frame) {
      crowd.step();
      for (Engine& engine : engines) ASSERT_TRUE(engine.find(crowd.boxes()));
    }
    for (int frame = 0; frame < 100; ++frame) {
      crowd.step();
      for (Engine& engine : engines) {
        const HeapWatch watch;
        const bool ok = engine.find(crowd.boxes());
        const std::size_t taken = watch.peak();
        ASSERT_TRUE(ok);
        ASSERT_EQ(taken, 0U) << engine.name << ", frame " << frame;
      }
    }
  }
}

TEST(Sweep, TakesAtMost40BytesPerBox) {
  for (const std::size_t count : {1000U, 4000U, 10000U, 100000U}) {
    Crowd crowd({count, 5, count > 10000 ? Crowd::scaleForDensity(count) : 1, 1});
    std::vector<BodyPair> pairs;
    pairs.reserve(2 * count);
    const HeapWatch watch;
    Sweep sweep;
    for (int frame = 0; frame < 5; ++frame) {
      crowd.step();
      ASSERT_TRUE(sweep.findPairs(crowd.boxes(), pairs).ok());
    }
    // What it keeps for its pairs is as large as the caller's list of them.
    const std::size_t forPairs = pairs.capacity() * sizeof(BodyPair);
    EXPECT_LE(watch.peak(), 40 * count + forPairs) << count;
  }
}

}  // namespace
}  // namespace spheretree
