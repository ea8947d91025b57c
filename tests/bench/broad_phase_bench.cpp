// SPDX-License-Identifier: GPL-3.0-or-later
//
// broad_phase_bench [counts=1000,4000] [speeds=5] [frames=500] [repeats=5] [room=fixed|density]
//                   [scene=room|floor|large] [only=NAME,...] [peers=yes|no]
//
// The crowded room: unit boxes in a room of 100 x 25 x 100 that move in straight lines between reflecting
// walls at 60 frames a second, speeds up to `speeds` along each axis. room=density scales the room so that it
// is as crowded as with 4000 boxes. scene=floor has all boxes at one height, scene=large makes one in a
// hundred 15 wide.
//
// Per frame and engine: the time from "here are all boxes" to "here are all pairs", caches warm from the
// engine's own frame before. Engines take turns of twenty frames, each starting from the same state of the
// room, so that a machine that slows down slows all of them; the first frames of a turn are not measured. The
// pairs of every frame are compared by a hash of the sorted list: `wrong` counts the frames in which a peer
// finds other ones than the first engine; when one of ours does, the program ends. `stream` is the floor:
// reading all boxes once, as a sum. `stream x10` reads them ten times, about as long as `sweep` takes and
// always the same work: its 99th percentile over its median is what the machine itself adds.
//
// Two 99th percentiles: `p99_us` is that of all times, the machine's pauses included. `p99_least_us` tells
// the frames apart: `repeats` engines of a kind, which are told the same frames from the first one on and so
// are in the same state in each of them, take every turn one after the other; of each frame the least of
// their times counts, and of these the percentile over the frames. A frame that costs more than others, by a
// sort, a new layout or a crowd, does so for all of them and shows; a pause of the machine hits one of them.
// The same of `stream x10` tells whether that held. Engines that have taken more than twenty seconds are
// stopped.

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <spheretree/broad_phases.hpp>
#include <spheretree/grid.hpp>
#include <spheretree/grid_sweep.hpp>
#include <spheretree/simd.hpp>
#include <spheretree/sweep.hpp>

#include "broad_phase_peers.hpp"
#include "crowd.hpp"

namespace {

using namespace spheretree;
using spheretree::bench::Peer;
using spheretree::bench::PeerKind;
using spheretree::tests::Crowd;

constexpr std::size_t kTurn = 20;               // frames that an engine runs before the next one does
constexpr std::size_t kWarmUp = 3;              // of them, not measured
constexpr std::size_t kFewFrames = 34;          // enough for those that take too long
constexpr double kPatience = 20e6;              // microseconds per row before that rule applies
constexpr std::size_t kMostBruteForce = 20000;  // boxes

struct Options {
  std::vector<std::size_t> counts{1000, 4000};
  std::vector<float> speeds{5};
  bool density = false;
  std::string scene = "room";
  std::size_t frames = 500;
  int repeats = 5;
  std::vector<std::string> only;
  bool peers = true;
};

/// An engine of ours, a peer, or neither, which is the floor.
struct Engine {
  std::unique_ptr<BroadPhase> own;
  std::unique_ptr<Peer> peer;
};

/// One row of the table.
struct Row {
  std::string name;
  std::vector<Engine> engines;  // of a kind, in the same state
  SimdLevel simd = SimdLevel::Avx512;
  int reads = 1;              // of all boxes, by the floor
  std::vector<double> times;  // of all engines
  std::vector<double> least;  // per frame, of all engines
  double total = 0;
  std::size_t wrong = 0;  // frames with other pairs than the first engine's
};

double now() {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// Reads all boxes once.
[[gnu::noinline]] float stream(const std::vector<Aabb>& boxes) {
  Vec3 low;
  Vec3 high;
  for (const Aabb& box : boxes) {
    low = low + box.min;
    high = high + box.max;
  }
  return dot(low, high);
}

std::vector<PeerKind> allPeers() {
  std::vector<PeerKind> peers;
  const auto add = [&](std::vector<PeerKind> more) {
    for (PeerKind& peer : more) peers.push_back(std::move(peer));
  };
  static_cast<void>(add);
#ifdef SPHERETREE_HAVE_ODE
  add(bench::odePeers());
#endif
#ifdef SPHERETREE_HAVE_BULLET
  add(bench::bulletPeers());
#endif
#ifdef SPHERETREE_HAVE_FCL
  add(bench::fclPeers());
#endif
  return peers;
}

std::vector<Row> rowsFor(const Options& options, const std::vector<Aabb>& boxes, Vec3 room) {
  std::vector<Row> rows;
  const auto add = [&](std::string name, SimdLevel simd, auto make) -> Row& {
    Row& row = rows.emplace_back();
    row.name = std::move(name);
    row.simd = simd;
    for (int k = 0; k < options.repeats; ++k) row.engines.push_back(make());
    return row;
  };
  add("stream", SimdLevel::Scalar, [] { return Engine{}; });
  add("stream x10", SimdLevel::Scalar, [] { return Engine{}; }).reads = 10;
  const auto wanted = [&](std::string_view name) {
    return options.only.empty() ||
           std::find(options.only.begin(), options.only.end(), name) != options.only.end();
  };
  const auto addOwn = [&](const char* name, SimdLevel simd, auto make) {
    if (wanted(name) && simd <= supportedSimd())
      add(name, simd, [&] { return Engine{std::unique_ptr<BroadPhase>(make()), nullptr}; });
  };
  const auto sweep = [] { return std::make_unique<Sweep>(); };
  addOwn("sweep avx512", SimdLevel::Avx512, sweep);
  addOwn("sweep avx2", SimdLevel::Avx2, sweep);
  addOwn("sweep sse2", SimdLevel::Sse2, sweep);
  addOwn("sweep scalar", SimdLevel::Scalar, sweep);
  addOwn("sweep_and_prune", SimdLevel::Scalar, [] { return makeBroadPhase(BroadPhaseKind::SweepAndPrune); });
  addOwn("grid", SimdLevel::Scalar, [] { return std::make_unique<Grid>(); });
  addOwn("grid 10x4x10", SimdLevel::Scalar, [] { return std::make_unique<Grid>(kPaperGrid); });
  addOwn("grid_sweep", SimdLevel::Scalar, [] { return std::make_unique<GridSweep>(); });
  addOwn("grid_sweep 10x4x10", SimdLevel::Scalar, [] { return std::make_unique<GridSweep>(kPaperGrid); });
  addOwn("octree", SimdLevel::Scalar, [] { return makeBroadPhase(BroadPhaseKind::Octree); });
  if (boxes.size() <= kMostBruteForce) {
    addOwn("brute_force", SimdLevel::Scalar, [] { return makeBroadPhase(BroadPhaseKind::BruteForce); });
  }
  if (!options.peers) return rows;
  for (const PeerKind& peer : allPeers()) {
    if (wanted(peer.name))
      add(peer.name, SimdLevel::Avx512, [&] { return Engine{nullptr, peer.make(boxes, room)}; });
  }
  return rows;
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
}

std::uint64_t hashOf(const std::vector<BodyPair>& pairs) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const BodyPair& pair : pairs) hash = (hash ^ (std::uint64_t{pair.a} << 32U | pair.b)) * 0x100000001b3U;
  return hash;
}

/// Runs one engine for one frame and returns how long that took.
double runFrame(const Engine& engine, int reads, const std::vector<Aabb>& boxes,
                std::vector<BodyPair>& pairs) {
  volatile float sink = 0;
  const double begin = now();
  if (engine.own) {
    if (!engine.own->findPairs(boxes, pairs).ok()) std::abort();
  } else if (engine.peer) {
    engine.peer->findPairs(boxes, pairs);
  } else {
    for (int k = 0; k < reads; ++k) sink = stream(boxes);
  }
  const double time = now() - begin;
  static_cast<void>(sink);
  return time;
}

/// What the first engine found in the frames of this turn.
struct Turn {
  std::vector<std::uint64_t> hashes;
  std::size_t pairs = 0;
};

/// Notes or checks what an engine found in a frame of the turn. False when it found other pairs than the
/// first one.
bool check(Turn& turn, std::size_t frame, std::vector<BodyPair>& pairs) {
  if (frame < turn.hashes.size()) return turn.hashes[frame] == hashOf(pairs);
  turn.hashes.push_back(hashOf(pairs));
  turn.pairs += pairs.size();
  return true;
}

/// Runs one engine of a row for the frames of one turn. False when one of ours finds other pairs than the
/// first one.
bool runEngine(Row& row, const Engine& engine, Crowd crowd, Turn& turn, std::span<double> least) {
  std::vector<BodyPair> pairs;
  for (std::size_t frame = 0; frame < kTurn; ++frame) {
    crowd.step();
    const double time = runFrame(engine, row.reads, crowd.boxes(), pairs);
    row.total += time;
    if (frame >= kWarmUp) row.times.push_back(time);
    least[frame] = std::min(least[frame], time);
    if (!engine.own && !engine.peer) continue;
    if (engine.peer) {
      std::sort(pairs.begin(), pairs.end());
      pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    }
    if (check(turn, frame, pairs)) continue;
    ++row.wrong;
    if (engine.own) return false;
  }
  return true;
}

/// The same for all engines of a row, one after the other.
bool runTurn(Row& row, const Crowd& crowd, Turn& turn) {
  limitSimd(row.simd);
  std::array<double, kTurn> least;
  least.fill(std::numeric_limits<double>::infinity());
  for (const Engine& engine : row.engines) {
    if (!runEngine(row, engine, crowd, turn, least)) return false;
  }
  row.least.insert(row.least.end(), least.begin() + kWarmUp, least.end());
  return true;
}

bool measure(const Options& options, std::size_t count, float speed) {
  const float scale = options.density ? Crowd::scaleForDensity(count) : 1;
  Crowd::Settings settings{count, speed, scale};
  if (options.scene == "floor") settings.height = 1 / scale;
  if (options.scene == "large") settings.largeEvery = 100;
  Crowd crowd(settings);
  std::vector<Row> rows = rowsFor(options, crowd.boxes(), scale * Vec3{100, 25, 100});
  std::size_t pairs = 0;
  const std::size_t turns = (options.frames + kTurn - 1) / kTurn;
  for (std::size_t k = 0; k < turns; ++k) {
    Turn turn;
    for (Row& row : rows) {
      if (row.total > kPatience && row.least.size() >= kFewFrames) continue;
      if (!runTurn(row, crowd, turn)) {
        std::fprintf(stderr, "%s finds other pairs\n", row.name.c_str());
        return false;
      }
    }
    pairs += turn.pairs;
    for (std::size_t frame = 0; frame < kTurn; ++frame) crowd.step();
  }
  const double floor = quantile(rows.front().times, 0.5);
  const double best = rows.size() < 3 ? floor : quantile(rows[2].times, 0.5);
  for (const Row& row : rows) {
    const double median = quantile(row.times, 0.5);
    std::printf("%s,%s,%g,%zu,%s,%zu,%.1f,%.2f,%.2f,%.2f,%.2f,%.2f,%zu\n", options.scene.c_str(),
                options.density ? "density" : "fixed", static_cast<double>(speed), count, row.name.c_str(),
                row.least.size(), static_cast<double>(pairs) / static_cast<double>(turns * kTurn), median,
                quantile(row.times, 0.99), quantile(row.least, 0.99), median / floor, median / best,
                row.wrong);
  }
  std::fflush(stdout);
  return true;
}

std::vector<std::string> split(std::string_view list) {
  std::vector<std::string> parts;
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    parts.emplace_back(list.substr(0, comma));
    list.remove_prefix(std::min(comma + 1, list.size()));
  }
  return parts;
}

bool parse(Options& options, std::string_view argument) {
  const std::size_t equals = argument.find('=');
  if (equals == std::string_view::npos) return false;
  const std::string_view key = argument.substr(0, equals);
  const std::string value(argument.substr(equals + 1));
  if (key == "counts") {
    options.counts.clear();
    for (const std::string& part : split(value)) options.counts.push_back(std::stoul(part));
  } else if (key == "speeds") {
    options.speeds.clear();
    for (const std::string& part : split(value)) options.speeds.push_back(std::stof(part));
  } else if (key == "room") {
    options.density = value == "density";
  } else if (key == "scene") {
    options.scene = value;
    return value == "room" || value == "floor" || value == "large";
  } else if (key == "frames") {
    options.frames = std::stoul(value);
  } else if (key == "repeats") {
    options.repeats = std::stoi(value);
    return options.repeats > 0;
  } else if (key == "only") {
    options.only = split(value);
  } else if (key == "peers") {
    options.peers = value != "no";
  } else {
    return false;
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  for (int k = 1; k < argc; ++k) {
    if (!parse(options, argv[k])) {
      std::fprintf(stderr, "unknown option %s\n", argv[k]);
      return 2;
    }
  }
  std::printf(
      "scene,room,speed,boxes,engine,frames,pairs,median_us,p99_us,p99_least_us,per_stream,per_sweep,"
      "wrong\n");
  for (const float speed : options.speeds) {
    for (const std::size_t count : options.counts) {
      if (!measure(options, count, speed)) return 1;
    }
  }
  return 0;
}
