// SPDX-License-Identifier: GPL-3.0-or-later
//
// world_bench TREE.sph [FRAMES]: whole frames of a CollisionWorld with the sweep.
//
// The crowded room: 100 x 25 x 100, objects about one unit large, velocities of up to 5 units per second on
// each axis, 60 frames per second, reflecting walls, no response among bodies, fixed seed. 4000 copies of the
// tree; and boxes at the same density, the room growing in its plane. One row per scene: medians over the
// frames of what CollisionWorld::times() says, the 99th percentile of the total, the time to read all boxes
// once in the same run, and a hash of the contacts of all frames.

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <spheretree/collision_world.hpp>
#include <spheretree/response.hpp>
#include <spheretree/sph.hpp>
#include <spheretree/sweep.hpp>

namespace {

using namespace spheretree;

constexpr std::uint32_t kSeed = 1;
constexpr std::size_t kDefaultFrames = 500;
constexpr int kWarmUp = 60;
constexpr float kSpeed = 5;
constexpr float kFrame = 1.0F / 60;
constexpr std::size_t kRoomBodies = 4000;  // of the room with its own size

class Random {
 public:
  float uniform(float low, float high) {
    return low + (high - low) * (static_cast<float>(engine_() >> 8U) * 0x1p-24F);
  }

 private:
  std::mt19937 engine_{kSeed};
};

struct Scene {
  const char* name = "";
  std::size_t bodies = 0;
  bool trees = false;
  WorldSettings settings;
};

float median(std::vector<float> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

CollisionWorld makeWorld(const Scene& scene, const QueryTree& tree, const Aabb& room) {
  CollisionWorld world(std::make_unique<Sweep>(), scene.settings);
  const Vec3 size = tree.bounds().max - tree.bounds().min;
  const float scale = 1 / std::max({size.x, size.y, size.z});
  Random random;
  for (std::size_t i = 0; i < scene.bodies; ++i) {
    Pose pose;
    pose.translation = {random.uniform(room.min.x + 1, room.max.x - 1),
                        random.uniform(room.min.y + 1, room.max.y - 1),
                        random.uniform(room.min.z + 1, room.max.z - 1)};
    const float vx = random.uniform(-kSpeed, kSpeed);
    const float vy = random.uniform(-kSpeed, kSpeed);
    const Vec3 velocity{vx, vy, random.uniform(-kSpeed, kSpeed)};
    if (scene.trees) {
      pose.scale = scale;
      world.addTree(tree, pose, velocity);
    } else {
      world.addBox({0.5F, 0.5F, 0.5F}, pose, velocity);
    }
  }
  return world;
}

/// Reading all boxes once: what no broad phase that looks at its input can beat.
float streamingTime(const CollisionWorld& world) {
  std::vector<float> times;
  std::vector<Aabb> boxes;
  for (std::uint32_t body = 0; body < world.bodyCount(); ++body) boxes.push_back(world.box(body));
  volatile float sink = 0;
  for (int pass = 0; pass < 21; ++pass) {
    const auto start = std::chrono::steady_clock::now();
    float sums[6] = {};
    for (const Aabb& box : boxes) {
      sums[0] += box.min.x;
      sums[1] += box.min.y;
      sums[2] += box.min.z;
      sums[3] += box.max.x;
      sums[4] += box.max.y;
      sums[5] += box.max.z;
    }
    sink = sums[0] + sums[1] + sums[2] + sums[3] + sums[4] + sums[5];
    times.push_back(
        std::chrono::duration<float, std::micro>(std::chrono::steady_clock::now() - start).count());
  }
  static_cast<void>(sink);
  return median(times);
}

void bench(const Scene& scene, const QueryTree& tree, std::size_t frames) {
  const float grow = std::sqrt(static_cast<float>(std::max(scene.bodies, kRoomBodies)) / kRoomBodies);
  const Aabb room{{0, 0, 0}, {100 * grow, 25, 100 * grow}};
  CollisionWorld world = makeWorld(scene, tree, room);
  std::vector<float> update;
  std::vector<float> broad;
  std::vector<float> narrow;
  std::vector<float> total;
  std::size_t pairs = 0;
  std::size_t contacts = 0;
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (int frame = -kWarmUp; frame < static_cast<int>(frames); ++frame) {
    if (!world.step(kFrame)) return;
    reflectAtWalls(world, room);
    if (frame < 0) continue;
    update.push_back(world.times().update);
    broad.push_back(world.times().broad);
    narrow.push_back(world.times().narrow);
    total.push_back(world.times().total());
    pairs += world.pairs().size();
    contacts += world.contacts().size();
    for (const Contact& contact : world.contacts()) {
      for (const std::uint32_t word : {contact.a, contact.b, std::bit_cast<std::uint32_t>(contact.point.x)})
        hash = (hash ^ word) * 0x100000001b3U;
    }
  }
  const float streaming = streamingTime(world);
  const float middle = median(total);
  std::sort(total.begin(), total.end());
  const auto perFrame = [&](std::size_t count) {
    return static_cast<double>(count) / static_cast<double>(frames);
  };
  const auto wide = [](float value) { return static_cast<double>(value); };
  std::printf("%s,%zu,%u,%.1f,%.1f,%.1f,%.1f,%.1f,%.2f,%.1f,%.1f,%.1f,%016llx\n", scene.name, scene.bodies,
              scene.settings.threads, wide(median(update)), wide(median(broad)), wide(median(narrow)),
              wide(middle), wide(total[total.size() * 99 / 100]), wide(streaming), wide(middle / streaming),
              perFrame(pairs), perFrame(contacts), static_cast<unsigned long long>(hash));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: world_bench TREE.sph [FRAMES]\n");
    return 2;
  }
  std::ifstream stream(argv[1], std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  const Result<SphFile> file = parseSph(text);
  if (!file) {
    std::fprintf(stderr, "%s: %s\n", argv[1], file.error().message.c_str());
    return 3;
  }
  const Result<QueryTree> tree = QueryTree::create(file->tree, standOffsOf(*file));
  if (!tree) return 3;
  const std::size_t frames = argc > 2 ? std::max(1UL, std::strtoul(argv[2], nullptr, 10)) : kDefaultFrames;
  std::printf(
      "scene,bodies,threads,update_us,broad_us,narrow_us,total_us,p99_us,streaming_us,per_streaming,pairs,"
      "contacts,hash\n");
  WorldSettings twoThreads;
  twoThreads.threads = 2;
  WorldSettings manyContacts;
  manyContacts.contactsPerPair = 8;
  for (const Scene& scene :
       {Scene{"trees", kRoomBodies, true, {}}, Scene{"trees-8-contacts", kRoomBodies, true, manyContacts},
        Scene{"trees", kRoomBodies, true, twoThreads}, Scene{"boxes", kRoomBodies, false, {}},
        Scene{"boxes", 100'000, false, {}}})
    bench(scene, tree.value(), frames);
  return 0;
}
