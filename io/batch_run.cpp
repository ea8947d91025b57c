// SPDX-License-Identifier: GPL-3.0-or-later
//
// The batch itself. One thread, one loop: start what fits, wait for the next child to end, put its outputs
// into place. Only this process writes files, so a crash of a child leaves nothing behind.
//
// * Order: by triangles, the largest first, so that no large asset is left for the end; ties by output.
// * Threads: one for every kTrianglesPerThread triangles, at least one, at most what is free. When fewer
//   assets are left than jobs allowed, they share what is free.
// * Memory: an asset reserves kReserve times its estimate, or an even share of the limit where that is more
//   and free, and cannot allocate more than it reserved (RLIMIT_DATA). What runs at the same time never
//   reserves more than the limit. An asset that did not get along with its share has another try at the end,
//   alone, with everything.

#include "io/batch_run.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "io/asset_scan.hpp"
#include "io/child_process.hpp"

namespace spheretree::io {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Json = nlohmann::json;

// Peak resident memory of builds at all qualities: docs/batch.md has the measurements.
constexpr std::uint64_t kBaseMemory = std::uint64_t{64} << 20;
constexpr std::uint64_t kMemoryPerTriangle = 4'000;
constexpr std::uint64_t kReserve = 2;  // of the estimate: it may be wrong by that
// Reserved besides, for stacks and the allocator's pools, which are mapped but not touched.
constexpr std::uint64_t kReservePerThread = std::uint64_t{80} << 20;
constexpr std::uint64_t kTrianglesPerThread = 20'000;
constexpr double kBaseWork = 500;  // triangles that take as long as starting, reading and finishing an asset
constexpr int kTick = 100;         // milliseconds between looks at the clock, for timeouts and the bar

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::uint64_t memoryEstimateOf(std::uint64_t triangles) {
  return kBaseMemory + kMemoryPerTriangle * triangles;
}

std::uint64_t freeMemory() {
  const Result<std::string> text = readFile("/proc/meminfo");
  constexpr std::string_view kKey = "MemAvailable:";
  constexpr std::uint64_t kKibibyte = 1024;
  const std::size_t at = text ? text->find(kKey) : std::string::npos;
  if (at != std::string::npos)
    return std::strtoull(text->c_str() + at + kKey.size(), nullptr, 10) * kKibibyte;
  const long pages = ::sysconf(_SC_PHYS_PAGES);
  return static_cast<std::uint64_t>(std::max(pages, 0L)) *
         static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

/// The zeros filled in.
BatchLimits decided(BatchLimits limits) {
  limits.threads = medial::Context(limits.threads).threads();
  if (limits.jobs == 0) limits.jobs = limits.threads;
  limits.jobs = std::min(limits.jobs, limits.threads);  // each takes at least one
  constexpr std::uint64_t kShare = 4;
  constexpr std::uint64_t kOf = 5;
  if (limits.memoryBytes == 0) limits.memoryBytes = freeMemory() / kOf * kShare;
  return limits;
}

// --- what is there already ---

/// An asset that has to be built, and what is known of it.
struct Job {
  std::size_t place = 0;  // in the plan
  std::string fingerprint;
  std::uint64_t triangles = 0;
  bool alone = false;  // a second try, with all the memory
};

/// Either settled already, or a job.
struct Look {
  std::optional<Job> job;
  AssetRecord record;
  AssetAction action = AssetAction::None;
  std::uint64_t triangles = 0;
};

bool isThere(const fs::path& path) {
  std::error_code failure;
  return fs::exists(fs::symlink_status(path, failure));
}

/// A trouble that is the surroundings' may be gone by now.
bool worthAnotherTry(const AssetRecord& record, const BatchLimits& limits) {
  switch (record.trouble) {
    case Trouble::UnwritableOutput:
    case Trouble::OutOfMemory:
      return true;
    case Trouble::TimedOut:
      return limits.timeoutSeconds <= 0 || limits.timeoutSeconds > record.patience;
    default:
      return false;
  }
}

/// Whether the outputs are those that this record vouches for.
bool isWhole(const BatchAsset& asset, const AssetRecord& record, const BatchOptions& options) {
  const fs::path tree = options.folder / asset.output;
  if (record.treeFileHash.empty()) return record.state == AssetState::Failed && !isThere(tree);
  const Result<std::string> bytes = readFile(tree);
  if (!bytes || contentHash(*bytes) != record.treeFileHash) return false;
  return options.pages == Pages::Without || isThere(options.folder / asset.page());
}

Look failed(Look look, const BatchAsset& asset, const std::string& fingerprint, Trouble trouble,
            const std::string& reason) {
  look.action = AssetAction::Built;
  look.record = recordOfFailure(asset, fingerprint, trouble, reason);
  return look;
}

Look lookAt(std::size_t place, const BatchAsset& asset, const BatchOptions& options) {
  Look look;
  const Result<AssetScan> scan = scanAsset(asset.input);
  // Nothing is written about it: the file may be back tomorrow, and its tree still right.
  if (!scan) return failed(look, asset, {}, Trouble::UnreadableInput, scan.error().message);
  look.triangles = scan->triangleGuess;
  const std::string fingerprint = fingerprintOf(asset, scan->contentHash);
  const fs::path record = options.folder / asset.record();
  if (options.overwrite == Overwrite::Refuse) {
    const Result<AssetRecord> before = readRecord(record);
    if (before && before->fingerprint == fingerprint && isWhole(asset, *before, options) &&
        !worthAnotherTry(*before, options.limits)) {
      look.record = *before;
      look.action = AssetAction::Skipped;
      return look;
    }
    for (const fs::path& path : {record, options.folder / asset.output}) {
      if (!before && isThere(path)) {
        return failed(look, asset, fingerprint, Trouble::UnwritableOutput,
                      path.string() + ": exists already, not written by a batch; --force replaces it");
      }
    }
  }
  look.job = Job{place, fingerprint, scan->triangleGuess, false};
  return look;
}

// --- a child's answer ---

std::string packed(const Result<BuiltAsset>& built) {
  Json json;
  if (built) {
    json = {{"tree", Json::binary({built->tree.begin(), built->tree.end()})},
            {"report", built->report},
            {"page", built->page},
            {"missed", built->missed}};
  } else {
    json = {{"code", static_cast<int>(built.error().code)},
            // A library may quote bytes of the file.
            {"error", Json::binary({built.error().message.begin(), built.error().message.end()})}};
  }
  const std::vector<std::uint8_t> bytes = Json::to_cbor(json);
  return {bytes.begin(), bytes.end()};
}

std::string textOf(const Json& binary) {
  return {binary.get_binary().begin(), binary.get_binary().end()};
}

Result<BuiltAsset> unpacked(const std::string& bytes) {
  const Json json = Json::from_cbor(bytes);
  if (json.contains("code"))
    return Error{static_cast<ErrorCode>(json.at("code").get<int>()), textOf(json.at("error"))};
  return BuiltAsset{textOf(json.at("tree")), json.at("report").get<std::string>(),
                    json.at("page").get<std::string>(), json.at("missed").get<std::string>()};
}

struct Problem {
  Trouble trouble = Trouble::None;
  std::string reason;
};

Trouble troubleOf(ErrorCode code) {
  switch (code) {
    case ErrorCode::UnreadableInput:
      return Trouble::UnreadableInput;
    case ErrorCode::UnsuitableMesh:
      return Trouble::UnsuitableMesh;
    case ErrorCode::UnwritableOutput:
      return Trouble::UnwritableOutput;
    default:
      return Trouble::Internal;
  }
}

bool saysNoMemory(const std::string& words) {
  const std::string text = lowerCase(words);
  // The last is OpenMP's way to say it: there is no room for another stack.
  for (const char* sign : {"out of memory", "not enough memory", "bad_alloc", "thread creation failed"})
    if (text.find(sign) != std::string::npos) return true;
  return false;
}

/// What the end of a child says when it is not a built asset.
Problem problemOf(const ChildEnd& end, const BatchAsset& asset, const Result<BuiltAsset>* built) {
  const std::string name = asset.input.string() + ": ";
  const Problem noMemory{Trouble::OutOfMemory,
                         name + "does not fit into the memory that --memory-limit leaves"};
  if (built != nullptr) {
    const Error& error = built->error();
    if (saysNoMemory(error.message)) return noMemory;
    const bool named = error.message.rfind(asset.input.string(), 0) == 0;
    return {troubleOf(error.code), (named ? "" : name) + error.message};
  }
  if (end.threw) {
    if (saysNoMemory(end.bytes)) return noMemory;
    return {Trouble::Internal, name + "unexpected: " + end.bytes};
  }
  if (end.signal == SIGKILL)
    return {Trouble::OutOfMemory, name + "was killed, most likely because the machine ran out of memory"};
  if ((end.signal == 0 || end.signal == SIGABRT) && saysNoMemory(end.complaint)) return noMemory;
  if (end.signal == 0) return {Trouble::Crashed, name + "a library ended the build: " + end.complaint};
  // An address in the text would differ from run to run; only an assertion's words are worth repeating.
  const std::string words = end.signal == SIGABRT && !end.complaint.empty() ? ": " + end.complaint : "";
  return {Trouble::Crashed, name + "the build crashed with " + signalName(end.signal) + words};
}

// --- the loop ---

struct Running {
  Job job;
  ChildProcess child;
  Clock::time_point start;
  unsigned threads = 1;
  std::uint64_t reserved = 0;
  bool timedOut = false;
};

class Batch {
 public:
  Batch(const BatchPlan& plan, const BatchOptions& options, const BuildAsset& build,
        const BatchObserver& observer, BatchJournal& journal, const medial::Context& context)
      : plan_(plan),
        options_(options),
        build_(build),
        observer_(observer),
        journal_(journal),
        context_(context) {
    options_.limits = decided(options_.limits);
    result_.limits = options_.limits;
    result_.outcomes.resize(plan.assets.size());
    progress_.assets = plan.assets.size();
  }

  Result<BatchResult> run() {
    start_ = Clock::now();
    tidyUp();
    lookAtAll();
    progress_.seconds = 0;
    const Clock::time_point building = Clock::now();
    while ((!waiting_.empty() && !result_.stoppedEarly) || !running_.empty()) {
      if (context_.cancelled()) return Error{ErrorCode::Cancelled, "cancelled; what was finished stays"};
      startWhatFits();
      waitForOne();
      progress_.seconds = secondsSince(building);
      harvest();
      if (observer_.waiting) observer_.waiting(progress_);
    }
    if (context_.cancelled()) return Error{ErrorCode::Cancelled, "cancelled; what was finished stays"};
    result_.seconds = secondsSince(start_);
    return std::move(result_);
  }

 private:
  const BatchAsset& assetOf(const Job& job) const { return plan_.assets[job.place]; }
  static double workOf(const Job& job) { return kBaseWork + static_cast<double>(job.triangles); }

  void tidyUp() {
    std::vector<fs::path> targets = options_.summaries;
    for (const BatchAsset& asset : plan_.assets) {
      for (const std::string& name : {asset.output, asset.record(), asset.page()})
        targets.push_back(options_.folder / name);
    }
    removeLeftovers(targets);
  }

  void lookAtAll() {
    for (std::size_t k = 0; k < plan_.assets.size() && !result_.stoppedEarly; ++k) {
      if (context_.cancelled()) return;
      Look look = lookAt(k, plan_.assets[k], options_);
      AssetOutcome& outcome = result_.outcomes[k];
      outcome.memoryEstimate = memoryEstimateOf(look.triangles);
      if (look.job) {
        progress_.work += workOf(*look.job);
        waiting_.push_back(std::move(*look.job));
        continue;
      }
      outcome.action = look.action;
      outcome.record = std::move(look.record);
      if (look.action == AssetAction::Skipped) {
        ++progress_.skipped;
        outcome.cost = costBefore(plan_.assets[k].output);
      }
      settled(k);
    }
    std::stable_sort(waiting_.begin(), waiting_.end(),
                     [](const Job& a, const Job& b) { return a.triangles > b.triangles; });
  }

  std::optional<BuildCost> costBefore(const std::string& output) const {
    const auto at = journal_.costs().find(output);
    return at == journal_.costs().end() ? std::nullopt : std::optional(at->second);
  }

  void startWhatFits() {
    while (!waiting_.empty() && running_.size() < options_.limits.jobs && !result_.stoppedEarly) {
      const Job& next = waiting_.front();
      unsigned busy = 0;
      std::uint64_t reserved = 0;
      for (const Running& running : running_) {
        busy += running.threads;
        reserved += running.reserved;
      }
      const std::uint64_t limit = options_.limits.memoryBytes;
      if (busy >= options_.limits.threads) return;
      const unsigned threads = threadsFor(next, options_.limits.threads - busy);
      const std::uint64_t wanted = kReserve * memoryEstimateOf(next.triangles) + kReservePerThread * threads;
      const std::uint64_t needed = next.alone ? limit : std::min(limit, wanted);
      // What needs all of it runs alone.
      if (!running_.empty() && reserved + needed > limit) return;
      // An even share costs nobody anything, and a mesh may need far more than its triangles tell: a needle's
      // second try alone would keep the others waiting.
      const std::uint64_t share = std::min(limit / options_.limits.jobs, limit - std::min(limit, reserved));
      launch(threads, std::max(needed, share));
    }
  }

  unsigned threadsFor(const Job& job, unsigned idle) const {
    const std::uint64_t wanted = (job.triangles + kTrianglesPerThread - 1) / kTrianglesPerThread;
    auto threads = static_cast<unsigned>(std::clamp<std::uint64_t>(wanted, 1, idle));
    if (waiting_.size() < options_.limits.jobs)
      threads = std::max(threads, idle / static_cast<unsigned>(waiting_.size()));
    return threads;
  }

  void launch(unsigned threads, std::uint64_t reserve) {
    Job job = std::move(waiting_.front());
    waiting_.pop_front();
    const BatchAsset& asset = assetOf(job);
    Result<ChildProcess> child = ChildProcess::start([&] { return packed(build_(asset, threads)); }, reserve);
    if (!child) {
      fail(job, {Trouble::OutOfMemory, asset.input.string() + ": " + child.error().message}, {});
      return;
    }
    running_.push_back({std::move(job), std::move(*child), Clock::now(), threads, reserve, false});
  }

  void waitForOne() {
    std::vector<pollfd> watches;
    for (const Running& running : running_) watches.push_back({running.child.watch(), POLLIN, 0});
    if (!watches.empty()) ::poll(watches.data(), watches.size(), kTick);
    std::vector<Running> still;
    for (std::size_t k = 0; k < running_.size(); ++k) {
      Running& running = running_[k];
      const bool late =
          options_.limits.timeoutSeconds > 0 && secondsSince(running.start) > options_.limits.timeoutSeconds;
      if (watches[k].revents == 0 && late) {
        running.timedOut = true;
        running.child.kill();
      }
      (watches[k].revents != 0 || running.timedOut ? ended_ : still).push_back(std::move(running));
    }
    running_ = std::move(still);
  }

  void harvest() {
    for (Running& running : std::exchange(ended_, {})) {
      const BuildCost clock{secondsSince(running.start), 0, running.threads};
      const ChildEnd end = running.child.finish();
      settle(running, end, {clock.seconds, end.peakMemoryBytes, clock.threads});
    }
  }

  void settle(Running& running, const ChildEnd& end, const BuildCost& cost) {
    Job& job = running.job;
    const BatchAsset& asset = assetOf(job);
    if (running.timedOut) {
      const double patience = options_.limits.timeoutSeconds;
      fail(job,
           {Trouble::TimedOut, asset.input.string() + ": took longer than the " + Json(patience).dump() +
                                   " seconds of --timeout"},
           cost);
      return;
    }
    std::optional<Result<BuiltAsset>> built;
    if (end.finished) built = unpacked(end.bytes);
    if (built && built->ok()) {
      finish(job, built->value(), cost);
      return;
    }
    const Problem problem = problemOf(end, asset, built ? &*built : nullptr);
    if (problem.trouble == Trouble::OutOfMemory && !job.alone &&
        running.reserved < options_.limits.memoryBytes) {
      job.alone = true;
      waiting_.push_back(std::move(job));
      return;
    }
    fail(job, problem, cost);
  }

  void finish(const Job& job, const BuiltAsset& built, const BuildCost& cost) {
    const BatchAsset& asset = assetOf(job);
    AssetRecord record = recordOfTree(asset, job.fingerprint, built.report, built.tree, built.missed);
    const Result<Done> written = writeAll(asset, record, built);
    if (!written) {
      fail(job, {Trouble::UnwritableOutput, written.error().message}, cost);
      return;
    }
    AssetOutcome& outcome = result_.outcomes[job.place];
    outcome.record = std::move(record);
    conclude(job, cost);
  }

  /// The record first: see batch_record.cpp.
  Result<Done> writeAll(const BatchAsset& asset, const AssetRecord& record, const BuiltAsset& built) const {
    const fs::path folder = options_.folder;
    if (const Result<Done> made = makeFolder(asset); !made) return made;
    Result<Done> done = writeFileAtomically(folder / asset.record(), record.json, Overwrite::Replace);
    if (done && !built.page.empty())
      done = writeFileAtomically(folder / asset.page(), built.page, Overwrite::Replace);
    if (done) done = writeFileAtomically(folder / asset.output, built.tree, Overwrite::Replace);
    return done;
  }

  Result<Done> makeFolder(const BatchAsset& asset) const {
    const fs::path folder = (options_.folder / asset.output).parent_path();
    std::error_code failure;
    fs::create_directories(folder, failure);
    if (failure) return Error{ErrorCode::UnwritableOutput, folder.string() + ": " + failure.message()};
    return Done{};
  }

  /// The tree of what the mesh was before goes first: a tree whose record says that there is none would stay.
  void writeFailure(const BatchAsset& asset, const AssetRecord& record) const {
    if (!makeFolder(asset)) return;
    std::error_code failure;
    fs::remove(options_.folder / asset.output, failure);
    fs::remove(options_.folder / asset.page(), failure);
    const Result<Done> written =
        writeFileAtomically(options_.folder / asset.record(), record.json, Overwrite::Replace);
    static_cast<void>(written.ok());  // the summary has the reason, and the next run will try again
  }

  void fail(const Job& job, const Problem& problem, const BuildCost& cost) {
    const BatchAsset& asset = assetOf(job);
    const double patience = problem.trouble == Trouble::TimedOut ? options_.limits.timeoutSeconds : 0;
    AssetOutcome& outcome = result_.outcomes[job.place];
    outcome.record = recordOfFailure(asset, job.fingerprint, problem.trouble, problem.reason, patience);
    if (problem.trouble != Trouble::UnwritableOutput) writeFailure(asset, outcome.record);
    conclude(job, cost);
  }

  void conclude(const Job& job, const BuildCost& cost) {
    AssetOutcome& outcome = result_.outcomes[job.place];
    outcome.action = AssetAction::Built;
    outcome.cost = cost;
    journal_.add(assetOf(job).output, cost);
    progress_.workDone += workOf(job);
    settled(job.place);
  }

  void settled(std::size_t place) {
    const AssetOutcome& outcome = result_.outcomes[place];
    ++progress_.settled;
    const bool bad = outcome.record.state == AssetState::Failed;
    progress_.failed += bad ? 1U : 0U;
    if (observer_.settled) observer_.settled(plan_.assets[place], outcome, progress_);
    if (bad && options_.onFailure == OnFailure::FailFast) {
      result_.stoppedEarly = true;
      running_.clear();  // ends them
      ended_.clear();
    }
  }

  const BatchPlan& plan_;
  BatchOptions options_;
  const BuildAsset& build_;
  const BatchObserver& observer_;
  BatchJournal& journal_;
  const medial::Context& context_;
  BatchResult result_;
  BatchProgress progress_;
  std::deque<Job> waiting_;
  std::vector<Running> running_;
  std::vector<Running> ended_;
  Clock::time_point start_;
};

}  // namespace

std::vector<AssetForecast> forecastBatch(const BatchPlan& plan, const BatchOptions& options) {
  std::vector<AssetForecast> forecasts;
  for (std::size_t k = 0; k < plan.assets.size(); ++k) {
    const Look look = lookAt(k, plan.assets[k], options);
    AssetForecast forecast;
    forecast.action = look.job ? AssetAction::Built : look.action;
    forecast.reason = look.record.reason;
    forecast.triangleGuess = look.triangles;
    forecast.memoryEstimate = memoryEstimateOf(look.triangles);
    forecasts.push_back(std::move(forecast));
  }
  return forecasts;
}

Result<BatchResult> runBatch(const BatchPlan& plan, const BatchOptions& options, const BuildAsset& build,
                             const BatchObserver& observer, BatchJournal& journal,
                             const medial::Context& context) {
  return Batch(plan, options, build, observer, journal, context).run();
}

}  // namespace spheretree::io
