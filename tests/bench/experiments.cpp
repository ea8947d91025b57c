// SPDX-License-Identifier: GPL-3.0-or-later
//
// The experiments of the paper that the crowded room comes from, redone: its Figures 4 to 8, the statements
// of its text, and what this project adds. run_experiments.sh builds the trees, runs this program and lets
// plot_experiments.py make pictures and docs/experiments.md of the two tables it writes:
//   experiments.csv        one row per run of the room
//   experiments-parts.csv  experiment, series, objects, quantity, value: what no run of the room alone says
//
// All series of an experiment run one after the other at one number of objects, several times over; of each
// the run with the median collision time counts. Ratios between rows of one number of objects therefore
// survive a busy machine better than the times. Repeats that end in another state end the program with
// code 1.
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cinttypes>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numeric>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <spheretree/grid.hpp>
#include <spheretree/simd.hpp>
#include <spheretree/sweep_and_prune.hpp>
#include <spheretree/version.hpp>

#include "runtime/demo/headless.hpp"
#include "runtime/demo/room.hpp"
#include "runtime/demo/tree_library.hpp"

namespace {

namespace fs = std::filesystem;
using crowded_room::BoxShape;
using crowded_room::HeadlessReport;
using crowded_room::HeadlessSettings;
using crowded_room::Movement;
using crowded_room::PhaseSummary;
using crowded_room::Room;
using crowded_room::RoomSettings;
using crowded_room::TreeLibrary;
using spheretree::Aabb;
using spheretree::BodyPair;
using spheretree::BroadPhaseKind;
using spheretree::NarrowPhase;
using Clock = std::chrono::steady_clock;

constexpr int kDone = 0;
constexpr int kOurFault = 1;
constexpr int kUsage = 2;
constexpr int kUnreadable = 3;

constexpr double kLimit = 1e6 / 60;  // microseconds
/// Capacities are looked for with few frames, to this share of themselves, and then proved with many.
constexpr double kCapacityShare = 0.02;
constexpr double kCapacityStepBack = 0.98;
constexpr std::uint32_t kSearchFrames = 20;
constexpr int kSearchRounds = 8;
constexpr std::uint32_t kFirstCapacity = 2000;
constexpr std::uint32_t kProofFrames = 150;
/// Runs of many objects take fewer frames: about so many objects are moved in all, in at least so many
/// frames.
constexpr std::uint32_t kObjectFrames = 2'000'000;
constexpr std::uint32_t kLeastFrames = 60;

struct Options {
  fs::path trees = "trees";
  fs::path out = ".";
  std::uint32_t frames = 500;
  std::uint32_t repeats = 3;
  std::uint64_t steps = 1'000'000;  // of the endurance run
  std::string machine = "not named";
  std::set<std::string> only;  // empty: all
};

struct Series {
  std::string name;
  RoomSettings settings;
};

class Experiments {
 public:
  Experiments(const Options& options, const TreeLibrary& library)
      : options_(options),
        library_(library),
        runs_(options.out / "experiments.csv"),
        parts_(options.out / "experiments-parts.csv") {}

  bool runAll();

 private:
  bool figure4();
  bool figure5();
  bool figure6();
  bool figure7();
  bool figure8();
  bool scaling();
  bool movements();
  bool thousand();
  bool ownBroadPhase();
  bool ownScaling();
  bool threadsAndEngines();
  bool capacities();
  bool treeQuality();
  bool endurance();

  void writeHeads();
  [[nodiscard]] std::uint32_t framesFor(std::uint32_t objects) const;
  HeadlessReport run(const RoomSettings& settings, std::uint32_t frames) const;
  bool compare(const std::string& experiment, const std::vector<std::uint32_t>& counts,
               const std::vector<Series>& series);
  void write(const std::string& experiment, const std::string& series, const HeadlessReport& report);
  void part(const std::string& experiment, const std::string& series, std::uint32_t objects,
            const std::string& quantity, double value);
  void splitUpdates(const std::string& experiment, std::uint32_t objects, const RoomSettings& settings);
  double costOf(const RoomSettings& settings, std::uint32_t objects) const;
  std::uint32_t roughCapacity(const RoomSettings& settings) const;
  HeadlessReport capacity(const RoomSettings& settings) const;

  const Options& options_;
  const TreeLibrary& library_;
  std::ofstream runs_;
  std::ofstream parts_;
};

// --- settings ---

RoomSettings boxesOnly(BroadPhaseKind kind, spheretree::GridResolution grid = spheretree::kPaperGrid) {
  RoomSettings settings;
  settings.broadPhase = kind;
  settings.grid = grid;
  settings.narrow = NarrowPhase::Boxes;
  settings.boxShape = BoxShape::Exact;  // boxes of edge 1, as in the paper, not around balls
  return settings;
}

RoomSettings withTrees(const std::string& bunnyTree, std::uint32_t levels, BroadPhaseKind kind) {
  RoomSettings settings;
  settings.broadPhase = kind;
  settings.bunnyTree = bunnyTree;
  settings.boxTree = "box-octree-2";
  settings.levels = levels;
  return settings;
}

RoomSettings sweepAndPrune(const std::string& bunnyTree, std::uint32_t levels) {
  return withTrees(bunnyTree, levels, BroadPhaseKind::SweepAndPrune);
}

/// What this project would take: its own broad phase, boxes as what they are.
RoomSettings own() {
  RoomSettings settings = withTrees("bunny-combined-3", 3, BroadPhaseKind::Sweep);
  settings.boxShape = BoxShape::Exact;
  return settings;
}

/// The same with trees for everything.
RoomSettings ownTrees() {
  RoomSettings settings = withTrees("bunny-combined-3", 3, BroadPhaseKind::Sweep);
  settings.boxTree = "box-combined-3";
  settings.contactsPerPair = 1;
  return settings;
}

std::vector<std::uint32_t> upTo(std::uint32_t last) {
  std::vector<std::uint32_t> counts;
  for (std::uint32_t count = 100; count <= last; count += 100) counts.push_back(count);
  return counts;
}

const std::vector<Series>& fourTrees() {
  static const std::vector<Series> series{{"octree 4 levels", sweepAndPrune("bunny-octree-4", 4)},
                                          {"octree 5 levels", sweepAndPrune("bunny-octree-5", 5)},
                                          {"combined 2 levels", sweepAndPrune("bunny-combined-2", 2)},
                                          {"combined 3 levels", sweepAndPrune("bunny-combined-3", 3)}};
  return series;
}

// --- running and writing ---

[[noreturn]] void give_up(const std::string& why) {
  std::fprintf(stderr, "experiments: %s\n", why.c_str());
  std::exit(kOurFault);
}

std::string text(double value) {
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%.6g", value);
  return buffer;
}

void Experiments::writeHeads() {
  constexpr const char* kSimd[] = {"scalar", "SSE2", "AVX2", "AVX-512"};
#ifdef NDEBUG
  const char* const assertions = "off";
#else
  const char* const assertions = "on";
#endif
  std::ostringstream head;
  head << "# machine: " << options_.machine << ", instructions up to "
       << kSimd[static_cast<std::size_t>(spheretree::activeSimd())] << "\n# build: spheretree "
       << SPHERETREE_VERSION << ", " __VERSION__ ", assertions " << assertions
       << "\n# runs: " << options_.frames << " frames after 60, the median of " << options_.repeats
       << " runs\n";
  runs_ << head.str()
        << "experiment,series,objects,broad_phase,narrow_phase,bunny_tree,box_shape,levels,contacts_per_pair,"
           "movement,threads,frames,update_mean,update_median,broad_mean,broad_median,narrow_mean,narrow_"
           "median,"
           "collision_mean,collision_median,collision_p99,response_median,processor_median,pairs,contacts,"
           "outside,changed_"
           "speeds,"
           "state_hash\n";
  parts_ << head.str() << "experiment,series,objects,quantity,value\n";
}

std::uint32_t Experiments::framesFor(std::uint32_t objects) const {
  return std::min(options_.frames, std::max(kLeastFrames, kObjectFrames / objects));
}

HeadlessReport Experiments::run(const RoomSettings& settings, std::uint32_t frames) const {
  HeadlessSettings headless;
  headless.room = settings;
  headless.frames = frames;
  spheretree::Result<HeadlessReport> report = runHeadless(headless, library_);
  if (!report) give_up(report.error().message);
  return std::move(*report);
}

void Experiments::write(const std::string& experiment, const std::string& series,
                        const HeadlessReport& report) {
  const RoomSettings& room = report.room;
  char hash[20];
  std::snprintf(hash, sizeof hash, "%016" PRIx64, report.stateHash);
  runs_ << experiment << ',' << series << ',' << room.objects << ',' << spheretree::nameOf(room.broadPhase)
        << ',' << (room.narrow == NarrowPhase::Shapes ? "trees" : "none") << ',' << report.bunnyTree << ','
        << nameOf(room.boxShape) << ',' << room.levels << ',' << room.contactsPerPair << ','
        << nameOf(room.movement) << ',' << room.threads << ',' << report.frames;
  for (const PhaseSummary& phase : {report.update, report.broad, report.narrow, report.collision})
    runs_ << ',' << text(phase.mean) << ',' << text(phase.median);
  runs_ << ',' << text(report.collision.p99) << ',' << text(report.response.median) << ','
        << text(report.processor.median) << ',' << text(report.pairsPerFrame) << ','
        << text(report.contactsPerFrame) << ',' << report.audit.outside << ',' << report.audit.changedSpeeds
        << ',' << hash << std::endl;
}

void Experiments::part(const std::string& experiment, const std::string& series, std::uint32_t objects,
                       const std::string& quantity, double value) {
  parts_ << experiment << ',' << series << ',' << objects << ',' << quantity << ',' << text(value)
         << std::endl;
}

bool Experiments::compare(const std::string& experiment, const std::vector<std::uint32_t>& counts,
                          const std::vector<Series>& series) {
  for (const std::uint32_t count : counts) {
    std::vector<std::vector<HeadlessReport>> reports(series.size());
    for (std::uint32_t repeat = 0; repeat < options_.repeats; ++repeat) {
      for (std::size_t i = 0; i < series.size(); ++i) {
        RoomSettings settings = series[i].settings;
        settings.objects = count;
        reports[i].push_back(run(settings, framesFor(count)));
      }
    }
    for (std::size_t i = 0; i < series.size(); ++i) {
      for (const HeadlessReport& report : reports[i]) {
        if (report.stateHash == reports[i][0].stateHash) continue;
        std::fprintf(stderr, "experiments: repeats of %s, %s, %u objects differ\n", experiment.c_str(),
                     series[i].name.c_str(), count);
        return false;
      }
      const auto middle = reports[i].begin() + static_cast<std::ptrdiff_t>(reports[i].size() / 2);
      std::nth_element(reports[i].begin(), middle, reports[i].end(),
                       [](const HeadlessReport& one, const HeadlessReport& other) {
                         return one.collision.median < other.collision.median;
                       });
      write(experiment, series[i].name, *middle);
    }
  }
  return true;
}

// --- the figures ---

bool Experiments::figure4() {
  return compare("figure-4", upTo(500),
                 {{"brute force", boxesOnly(BroadPhaseKind::BruteForce)},
                  {"grid", boxesOnly(BroadPhaseKind::Grid)},
                  {"octree", boxesOnly(BroadPhaseKind::Octree)}});
}

bool Experiments::figure5() {
  return compare("figure-5", upTo(1000),
                 {{"grid", boxesOnly(BroadPhaseKind::Grid)},
                  {"octree", boxesOnly(BroadPhaseKind::Octree)},
                  {"sweep & prune", boxesOnly(BroadPhaseKind::SweepAndPrune)},
                  {"grid with sweep & prune", boxesOnly(BroadPhaseKind::GridSweep)}});
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

double microsecondsOf(const std::function<void()>& work) {
  const Clock::time_point start = Clock::now();
  work();
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

/// The runtime times an engine as a whole. What the paper calls the update of the structure is told apart
/// here, on the boxes of a running room: for Sweep & Prune it is what a call takes longer after a step than
/// once more without one (the exchanges in the three lists); for the grid it is the filing of the boxes
/// alone.
void Experiments::splitUpdates(const std::string& experiment, std::uint32_t objects,
                               const RoomSettings& settings) {
  RoomSettings scene = settings;
  scene.objects = objects;
  spheretree::Result<Room> room = Room::create(scene, library_);
  if (!room) give_up(room.error().message);
  spheretree::SweepAndPrune lists;
  spheretree::Grid grid(spheretree::kPaperGrid);
  spheretree::detail::VoxelFile voxels(spheretree::kPaperGrid);
  std::vector<Aabb> boxes;
  std::vector<std::uint32_t> order(room->bodyCount());
  std::iota(order.begin(), order.end(), 0U);
  std::vector<BodyPair> pairs;
  std::vector<double> moved;
  std::vector<double> again;
  std::vector<double> filed;
  std::vector<double> gridWhole;
  std::vector<double> boxesMoved;
  std::vector<double> narrow;
  for (std::uint32_t frame = 0; frame < options_.frames; ++frame) {
    if (!room->step()) give_up("the room failed");
    boxes.clear();
    for (std::uint32_t body = 0; body < room->bodyCount(); ++body) boxes.push_back(room->box(body));
    moved.push_back(microsecondsOf([&] { static_cast<void>(lists.findPairs(boxes, pairs)); }));
    again.push_back(microsecondsOf([&] { static_cast<void>(lists.findPairs(boxes, pairs)); }));
    gridWhole.push_back(microsecondsOf([&] { static_cast<void>(grid.findPairs(boxes, pairs)); }));
    filed.push_back(microsecondsOf([&] { voxels.file(boxes, order); }));
    boxesMoved.push_back(static_cast<double>(room->report().collision.update));
    narrow.push_back(static_cast<double>(room->report().collision.narrow));
  }
  const double rest = median(again);
  part(experiment, "sweep & prune", objects, "update", std::max(0.0, median(moved) - rest));
  part(experiment, "sweep & prune", objects, "pairs", rest);
  part(experiment, "grid", objects, "update", median(filed));
  part(experiment, "grid", objects, "pairs", std::max(0.0, median(gridWhole) - median(filed)));
  part(experiment, "boxes", objects, "moved", median(boxesMoved));
  part(experiment, "trees", objects, "narrow", median(narrow));
}

bool Experiments::figure6() {
  for (const std::uint32_t count : upTo(1000))
    splitUpdates("figure-6", count, boxesOnly(BroadPhaseKind::SweepAndPrune));
  return true;
}

bool Experiments::figure7() {
  return compare("figure-7", upTo(1000), fourTrees());
}

bool Experiments::figure8() {
  for (const std::uint32_t count : upTo(1000))
    splitUpdates("figure-8", count, sweepAndPrune("bunny-combined-2", 2));
  return true;
}

/// The text of the paper: 2000 and 4000 objects. Many pairs also tell the trees apart.
bool Experiments::scaling() {
  std::vector<Series> series = fourTrees();
  series.push_back({"boxes only", boxesOnly(BroadPhaseKind::SweepAndPrune)});
  return compare("scaling", {500, 1000, 2000, 3000, 4000}, series);
}

bool Experiments::movements() {
  std::vector<Series> series;
  for (const BroadPhaseKind kind :
       {BroadPhaseKind::Grid, BroadPhaseKind::Octree, BroadPhaseKind::SweepAndPrune}) {
    RoomSettings settings = boxesOnly(kind);
    series.push_back({std::string(spheretree::nameOf(kind)) + " xyz", settings});
    settings.movement = Movement::PlaneXZ;
    series.push_back({std::string(spheretree::nameOf(kind)) + " xz", settings});
  }
  return compare("movements", {1000}, series);
}

// --- what this project adds ---

bool Experiments::thousand() {
  RoomSettings oneContact = own();
  oneContact.contactsPerPair = 1;
  return compare("thousand", {1000},
                 {{"sweep + boxes as octrees", withTrees("bunny-combined-3", 3, BroadPhaseKind::Sweep)},
                  {"sweep + exact boxes", own()},
                  {"sweep + exact boxes + one contact a pair", oneContact},
                  {"sweep & prune", sweepAndPrune("bunny-combined-3", 3)}});
}

bool Experiments::ownBroadPhase() {
  std::vector<Series> series;
  for (const BroadPhaseKind kind : {BroadPhaseKind::Sweep, BroadPhaseKind::SweepAndPrune})
    series.push_back({std::string(spheretree::nameOf(kind)), boxesOnly(kind)});
  for (const BroadPhaseKind kind : {BroadPhaseKind::Grid, BroadPhaseKind::GridSweep}) {
    series.push_back({std::string(spheretree::nameOf(kind)) + " 10x4x10", boxesOnly(kind)});
    series.push_back({std::string(spheretree::nameOf(kind)) + " chosen", boxesOnly(kind, {})});
  }
  series.push_back({"octree", boxesOnly(BroadPhaseKind::Octree)});
  return compare("broad-phases", {100, 300, 1000, 3000, 10'000}, series);
}

bool Experiments::ownScaling() {
  RoomSettings oneContact = own();
  oneContact.contactsPerPair = 1;
  return compare("own-scaling", {1000, 3000, 10'000, 30'000, 60'000, 100'000},
                 {{"exact boxes", own()},
                  {"exact boxes + one contact a pair", oneContact},
                  {"boxes as octrees", withTrees("bunny-combined-3", 3, BroadPhaseKind::Sweep)},
                  {"boxes as combined trees", ownTrees()},
                  {"broad phase only", boxesOnly(BroadPhaseKind::Sweep)}});
}

/// The same state whatever finds the pairs and on however many threads.
bool Experiments::threadsAndEngines() {
  std::vector<Series> series;
  for (const BroadPhaseKind kind : spheretree::kBroadPhaseKinds) {
    for (const std::uint32_t threads : {1U, 2U, 7U}) {
      RoomSettings settings = withTrees("bunny-combined-3", 3, kind);
      settings.threads = threads;
      series.push_back({std::string(spheretree::nameOf(kind)) + " x" + std::to_string(threads), settings});
    }
  }
  return compare("same-state", {1000, 2000}, series);
}

/// Processor microseconds of a step.
double Experiments::costOf(const RoomSettings& settings, std::uint32_t objects) const {
  HeadlessSettings headless;
  headless.room = settings;
  headless.room.objects = objects;
  headless.frames = headless.warmUp = kSearchFrames;
  const spheretree::Result<HeadlessReport> report = runHeadless(headless, library_);
  if (!report) give_up(report.error().message);
  return report->processor.median;
}

/// The cost grows about like a power of the objects: between two counts that enclose the limit, the next one
/// to try lies where that power meets it.
std::uint32_t Experiments::roughCapacity(const RoomSettings& settings) const {
  double good = kFirstCapacity;
  double goodCost = costOf(settings, kFirstCapacity);
  double bad = good;
  double badCost = goodCost;
  while (badCost <= kLimit) {
    good = bad;
    goodCost = badCost;
    bad = 2 * good;
    badCost = costOf(settings, static_cast<std::uint32_t>(bad));
  }
  for (int round = 0; round < kSearchRounds && bad > (1 + kCapacityShare) * good; ++round) {
    const double power = std::clamp(std::log(kLimit / goodCost) / std::log(badCost / goodCost), 0.1, 0.9);
    const double count = std::floor(good * std::pow(bad / good, power));
    const double cost = costOf(settings, static_cast<std::uint32_t>(count));
    (cost <= kLimit ? good : bad) = count;
    (cost <= kLimit ? goodCost : badCost) = cost;
  }
  return static_cast<std::uint32_t>(good);
}

/// The most objects for which the median processor time of a step stays below the limit, proved by a run of
/// its own: wall-clock time says nothing about frames that others interrupt.
HeadlessReport Experiments::capacity(const RoomSettings& settings) const {
  RoomSettings scene = settings;
  scene.objects = roughCapacity(settings);
  while (true) {
    HeadlessReport report = run(scene, std::max(kProofFrames, framesFor(scene.objects)));
    if (report.processor.median <= kLimit || scene.objects < 2) return report;
    scene.objects = static_cast<std::uint32_t>(kCapacityStepBack * scene.objects);
  }
}

bool Experiments::capacities() {
  RoomSettings oneContact = own();
  oneContact.contactsPerPair = 1;
  for (const Series& each : std::vector<Series>{
           {"sweep + exact boxes + one contact a pair", oneContact},
           {"sweep + exact boxes", own()},
           {"sweep + boxes as combined trees", ownTrees()},
           {"sweep + boxes as octrees", withTrees("bunny-combined-3", 3, BroadPhaseKind::Sweep)},
           {"sweep & prune + combined 3 levels", sweepAndPrune("bunny-combined-3", 3)}}) {
    write("capacity", each.name, capacity(each.settings));
  }
  return true;
}

bool Experiments::treeQuality() {
  for (const auto& tree : library_.trees()) {
    for (std::size_t level = 0; level < tree.query.levelCount(); ++level) {
      const auto count = static_cast<std::uint32_t>(tree.tree.level(level).size());
      part("trees", tree.name, count, "stand-off of level " + std::to_string(level),
           static_cast<double>(tree.query.standOff(level)));
    }
    part("trees", tree.name, 0, "bytes", static_cast<double>(tree.query.bytes()));
  }
  return true;
}

/// Resident memory of this process in kilobytes, where the system tells.
double residentKilobytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmRSS:", 0) == 0) return std::strtod(line.c_str() + std::strlen("VmRSS:"), nullptr);
  }
  return 0;
}

/// How long pairs have been in contact, step after step.
class Lasting {
 public:
  /// Contacts ascend by pair; those of the avatar do not count, it stays where the user wants it.
  void add(std::span<const spheretree::Contact> contacts) {
    next_.clear();
    std::size_t old = 0;
    for (const spheretree::Contact& contact : contacts) {
      const BodyPair pair{contact.a, contact.b};
      if (pair.a == 0 || (!next_.empty() && next_.back().first == pair)) continue;
      while (old < now_.size() && now_[old].first < pair) ++old;
      const bool before = old < now_.size() && now_[old].first == pair;
      next_.push_back({pair, before ? now_[old].second + 1 : 1U});
      longest_ = std::max(longest_, next_.back().second);
    }
    now_.swap(next_);
  }
  [[nodiscard]] std::uint32_t longest() const { return longest_; }

 private:
  std::vector<std::pair<BodyPair, std::uint32_t>> now_;
  std::vector<std::pair<BodyPair, std::uint32_t>> next_;
  std::uint32_t longest_ = 0;
};

bool Experiments::endurance() {
  RoomSettings settings = withTrees("bunny-combined-3", 3, BroadPhaseKind::Sweep);
  spheretree::Result<Room> room = Room::create(settings, library_);
  if (!room) give_up(room.error().message);
  Lasting lasting;
  double memoryEarly = 0;
  std::uint64_t outside = 0;
  std::uint64_t changed = 0;
  std::uint64_t impacts = 0;
  const Clock::time_point start = Clock::now();
  for (std::uint64_t step = 0; step < options_.steps; ++step) {
    const auto at = static_cast<float>(step % 100'000);
    const spheretree::Vec3 stick{std::sin(0.05F * at), std::sin(0.031F * at), std::cos(0.047F * at)};
    if (!room->step({stick, step, 0})) give_up("the room failed");
    const crowded_room::Audit audit = room->audit();
    outside += audit.outside;
    changed += audit.changedSpeeds;
    impacts += room->impacts().size();
    lasting.add(room->contacts());
    if (step == options_.steps / 100) memoryEarly = residentKilobytes();
  }
  const std::chrono::duration<double> seconds = Clock::now() - start;
  const std::string name = "endurance";
  const auto wide = [](std::uint64_t value) { return static_cast<double>(value); };
  part(name, "sweep", settings.objects, "steps", wide(options_.steps));
  part(name, "sweep", settings.objects, "seconds", seconds.count());
  part(name, "sweep", settings.objects, "bodies outside in any step", wide(outside));
  part(name, "sweep", settings.objects, "speeds changed in any step", wide(changed));
  part(name, "sweep", settings.objects, "longest contact of a pair in steps", lasting.longest());
  part(name, "sweep", settings.objects, "hits of the avatar", wide(impacts));
  part(name, "sweep", settings.objects, "kilobytes after 1 % of the steps", memoryEarly);
  part(name, "sweep", settings.objects, "kilobytes at the end", residentKilobytes());
  return outside == 0 && changed == 0;
}

bool Experiments::runAll() {
  const std::vector<std::pair<std::string, bool (Experiments::*)()>> all{
      {"trees", &Experiments::treeQuality},      {"figure-4", &Experiments::figure4},
      {"figure-5", &Experiments::figure5},       {"figure-6", &Experiments::figure6},
      {"figure-7", &Experiments::figure7},       {"figure-8", &Experiments::figure8},
      {"scaling", &Experiments::scaling},        {"movements", &Experiments::movements},
      {"thousand", &Experiments::thousand},      {"broad-phases", &Experiments::ownBroadPhase},
      {"own-scaling", &Experiments::ownScaling}, {"same-state", &Experiments::threadsAndEngines},
      {"capacity", &Experiments::capacities},    {"endurance", &Experiments::endurance}};
  for (const std::string& name : options_.only) {
    if (std::any_of(all.begin(), all.end(), [&name](const auto& each) { return each.first == name; }))
      continue;
    std::fprintf(stderr, "experiments: there is no experiment '%s'\n", name.c_str());
    return false;
  }
  writeHeads();
  for (const auto& [name, experiment] : all) {
    if (!options_.only.empty() && options_.only.count(name) == 0) continue;
    std::fprintf(stderr, "%s ...\n", name.c_str());
    if (!(this->*experiment)()) return false;
  }
  if (runs_ && parts_) return true;
  std::fprintf(stderr, "experiments: the tables cannot be written to %s\n", options_.out.string().c_str());
  return false;
}

template <class Number>
bool readNumber(const std::string& value, Number& number) {
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  return error == std::errc{} && end == value.data() + value.size() && number > 0;
}

bool parse(const std::string& argument, Options& options) {
  const std::size_t equals = argument.find('=');
  if (equals == std::string::npos) return false;
  const std::string name = argument.substr(0, equals);
  const std::string value = argument.substr(equals + 1);
  if (name == "trees") options.trees = value;
  if (name == "out") options.out = value;
  if (name == "machine") options.machine = value;
  if (name == "only") {
    std::istringstream names(value);
    for (std::string each; std::getline(names, each, ',');) options.only.insert(each);
  }
  if (name == "frames") return readNumber(value, options.frames);
  if (name == "repeats") return readNumber(value, options.repeats);
  if (name == "steps") return readNumber(value, options.steps);
  return name == "trees" || name == "out" || name == "machine" || name == "only";
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    if (parse(argv[i], options)) continue;
    std::fprintf(stderr,
                 "usage: experiments [trees=FOLDER] [out=FOLDER] [frames=N] [repeats=N] [steps=N] "
                 "[machine=NAME] [only=NAME,...]\n");
    return kUsage;
  }
  const spheretree::Result<TreeLibrary> library = TreeLibrary::load(options.trees);
  if (!library) {
    std::fprintf(stderr, "experiments: %s\n", library.error().message.c_str());
    return kUnreadable;
  }
  return Experiments(options, *library).runAll() ? kDone : kOurFault;
}
