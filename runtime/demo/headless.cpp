// SPDX-License-Identifier: MIT
#include "headless.hpp"

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <limits>
#include <numeric>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include <spheretree/simd.hpp>

namespace crowded_room {

namespace {

namespace fs = std::filesystem;
using spheretree::Done;
using spheretree::Error;
using spheretree::ErrorCode;
using spheretree::Result;
using spheretree::SimdLevel;

constexpr float kMicrosecondsPerTick = 1e6F / static_cast<float>(CLOCKS_PER_SEC);
constexpr double kIdealRate = 60;  // frames per second that the paper names as the target still to be reached

/// The bands of the paper's Table 1, from the top; its gaps between whole numbers are closed downwards.
struct Band {
  double above;
  std::string_view name;
};
constexpr std::array<Band, 3> kBands{{{40, "high"}, {26, "very good"}, {10, "good"}}};

/// The times of every measured frame.
struct Recording {
  std::vector<float> update;
  std::vector<float> broad;
  std::vector<float> narrow;
  std::vector<float> collision;
  std::vector<float> response;
  std::vector<float> processor;
  std::vector<float> render;
  std::vector<float> renderProcessor;

  void add(const StepReport& step) {
    update.push_back(step.collision.update);
    broad.push_back(step.collision.broad);
    narrow.push_back(step.collision.narrow);
    collision.push_back(step.collision.total());
    response.push_back(step.response);
  }
};

/// Of the processor's time.
float microsecondsBetween(std::clock_t start, std::clock_t end) {
  return kMicrosecondsPerTick * static_cast<float>(end - start);
}

PhaseSummary summaryOf(std::vector<float> times) {
  std::sort(times.begin(), times.end());
  const std::size_t count = times.size();
  const double sum = std::accumulate(times.begin(), times.end(), 0.0);
  const auto wide = [](float value) { return static_cast<double>(value); };
  return {sum / static_cast<double>(count), wide(times[count / 2]), wide(times[count * 99 / 100])};
}

std::string_view nameOf(SimdLevel level) {
  constexpr std::array<std::string_view, 4> kNames{"scalar", "sse2", "avx2", "avx512"};
  return kNames[static_cast<std::size_t>(level)];
}

std::string inQuotes(std::string_view text) {
  std::string out = "\"";
  for (const char each : text) {
    if (each == '"' || each == '\\') out += '\\';
    if (static_cast<unsigned char>(each) < 0x20) continue;  // no name of ours has one
    out += each;
  }
  return out + '"';
}

std::string number(double value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

std::string hexadecimal(std::uint64_t value) {
  std::array<char, 20> text{};
  std::snprintf(text.data(), text.size(), "%016" PRIx64, value);
  return text.data();
}

/// Members of an object in the making, two spaces a level.
class JsonObject {
 public:
  explicit JsonObject(std::size_t depth = 0) : indent_(2 * depth + 2, ' ') {}

  void add(std::string_view name, const std::string& value) {
    text_ += (text_.empty() ? "\n" : ",\n") + indent_ + inQuotes(name) + ": " + value;
  }
  [[nodiscard]] std::string text() const { return std::string("{") + text_ + "\n" + indent_.substr(2) + "}"; }

 private:
  std::string indent_;
  std::string text_;
};

std::string json(const PhaseSummary& phase) {
  return std::string("{\"mean\": ") + number(phase.mean) + ", \"median\": " + number(phase.median) +
         ", \"p99\": " + number(phase.p99) + "}";
}

std::string jsonVector(std::array<double, 3> vector) {
  return std::string("[") + number(vector[0]) + ", " + number(vector[1]) + ", " + number(vector[2]) + "]";
}

/// Absent budgets are null.
std::string json(const spheretree::QueryLimits& budget) {
  const bool tests = budget.sphereTests != spheretree::QueryLimits::kUnlimited;
  const bool time = budget.microseconds < std::numeric_limits<float>::infinity();
  return std::string("{\"sphere_tests\": ") + (tests ? std::to_string(budget.sphereTests) : "null") +
         ", \"microseconds\": " + (time ? number(static_cast<double>(budget.microseconds)) : "null") + "}";
}

std::string settingsJson(const HeadlessReport& report) {
  const RoomSettings& room = report.room;
  const auto wide = [](float value) { return static_cast<double>(value); };
  const bool shapes = room.narrow == spheretree::NarrowPhase::Shapes;
  JsonObject out(1);
  out.add("seed", std::to_string(room.seed));
  out.add("objects", std::to_string(room.objects));
  out.add("bunny_share", number(wide(room.bunnyShare)));
  out.add("movement", inQuotes(nameOf(room.movement)));
  out.add("speed", number(wide(room.speed)));
  out.add("room", jsonVector({wide(room.size.x), wide(room.size.y), wide(room.size.z)}));
  out.add("broad_phase", inQuotes(spheretree::nameOf(room.broadPhase)));
  out.add("grid", jsonVector({static_cast<double>(room.grid.x), static_cast<double>(room.grid.y),
                              static_cast<double>(room.grid.z)}));
  out.add("narrow_phase", inQuotes(shapes ? "trees" : "none"));
  out.add("box_shape", inQuotes(nameOf(room.boxShape)));
  out.add("bunny_tree", inQuotes(report.bunnyTree));
  out.add("box_tree", inQuotes(report.boxTree));
  out.add("levels", std::to_string(room.levels));
  out.add("threads", std::to_string(room.threads));
  out.add("contacts_per_pair", std::to_string(room.contactsPerPair));
  out.add("budget", json(room.budget));
  out.add("simd", inQuotes(nameOf(spheretree::activeSimd())));
  return out.text();
}

std::string timesJson(const HeadlessReport& report) {
  JsonObject out(1);
  out.add("update", json(report.update));
  out.add("broad", json(report.broad));
  out.add("narrow", json(report.narrow));
  out.add("collision", json(report.collision));
  out.add("response", json(report.response));
  out.add("step_processor_time", json(report.processor));
  if (report.render) out.add("render", json(*report.render));
  if (report.renderProcessor) out.add("render_processor_time", json(*report.renderProcessor));
  return out.text();
}

std::string ratesJson(const HeadlessReport& report) {
  JsonObject out(1);
  out.add("collision_by_mean", number(report.fpsOfMean()));
  out.add("collision_by_median", number(report.fpsOfMedian()));
  out.add("of_60_by_mean", number(report.fpsOfMean() / kIdealRate));
  out.add("of_60_by_median", number(report.fpsOfMedian() / kIdealRate));
  out.add("satisfaction", inQuotes(satisfactionAt(report.fpsOfMean())));
  if (report.fpsRendered()) {
    out.add("rendered", number(*report.fpsRendered()));
    out.add("rendered_satisfaction", inQuotes(satisfactionAt(*report.fpsRendered())));
  }
  return out.text();
}

std::string auditJson(const Audit& audit) {
  JsonObject out(1);
  out.add("outside", std::to_string(audit.outside));
  out.add("changed_speeds", std::to_string(audit.changedSpeeds));
  return out.text();
}

Error unwritable(const fs::path& file, const std::string& why) {
  return {ErrorCode::UnwritableOutput, file.string() + ": " + why};
}

}  // namespace

std::optional<double> HeadlessReport::fpsRendered() const noexcept {
  if (!render) return std::nullopt;
  return 1e6 / (collision.mean + response.mean + render->mean);
}

std::string_view satisfactionAt(double fps) noexcept {
  for (const Band& band : kBands) {
    if (band.above == kBands.front().above ? fps > band.above : fps >= band.above) return band.name;
  }
  return "low";
}

Result<HeadlessReport> runHeadless(const HeadlessSettings& settings, const TreeLibrary& library) {
  if (settings.frames == 0) return Error{ErrorCode::InvalidArgument, "frames is 0; it may be 1 or more"};
  Result<Room> room = Room::create(settings.room, library);
  if (!room) return room.error();
  HeadlessReport report;
  report.room = settings.room;
  report.frames = settings.frames;
  report.bunnyTree = room->treeOf(ObjectKind::Bunny).name;
  report.boxTree = room->treeOf(ObjectKind::Box).name;
  Recording recording;
  std::uint64_t pairs = 0;
  std::uint64_t contacts = 0;
  for (std::uint64_t frame = 0; frame < std::uint64_t{settings.warmUp} + settings.frames; ++frame) {
    const StickInput input = settings.stick ? settings.stick(*room) : StickInput{};
    const std::clock_t start = std::clock();
    if (const Result<Done> stepped = room->step(input); !stepped) return stepped.error();
    const std::clock_t end = std::clock();
    if (frame < settings.warmUp) continue;
    recording.processor.push_back(microsecondsBetween(start, end));
    recording.add(room->report());
    pairs += room->report().pairs;
    contacts += room->report().contacts;
    report.impacts += room->impacts().size();
    if (!settings.render) continue;
    const std::clock_t renderStart = std::clock();
    recording.render.push_back(settings.render(*room));
    recording.renderProcessor.push_back(microsecondsBetween(renderStart, std::clock()));
  }
  report.update = summaryOf(recording.update);
  report.broad = summaryOf(recording.broad);
  report.narrow = summaryOf(recording.narrow);
  report.collision = summaryOf(recording.collision);
  report.response = summaryOf(recording.response);
  report.processor = summaryOf(recording.processor);
  if (settings.render) {
    report.render = summaryOf(recording.render);
    report.renderProcessor = summaryOf(recording.renderProcessor);
  }
  report.pairsPerFrame = static_cast<double>(pairs) / settings.frames;
  report.contactsPerFrame = static_cast<double>(contacts) / settings.frames;
  report.stateHash = room->stateHash();
  report.audit = room->audit();
  return report;
}

std::string toJson(const HeadlessReport& report) {
  JsonObject out;
  out.add("format", inQuotes("crowded_room 1"));
  out.add("settings", settingsJson(report));
  out.add("frames", std::to_string(report.frames));
  out.add("microseconds", timesJson(report));
  out.add("fps", ratesJson(report));
  out.add("pairs_per_frame", number(report.pairsPerFrame));
  out.add("contacts_per_frame", number(report.contactsPerFrame));
  out.add("impacts", std::to_string(report.impacts));
  out.add("state_hash", inQuotes(hexadecimal(report.stateHash)));
  out.add("audit", auditJson(report.audit));
  return out.text() + "\n";
}

Result<Done> writeReport(const HeadlessReport& report, const fs::path& file) {
  std::error_code error;
  if (fs::is_directory(file, error)) return unwritable(file, "is a folder");
  const bool replaceable = !fs::exists(file, error) || fs::is_regular_file(file, error);
  fs::path part = file;
  if (replaceable) part += ".part";
  {
    std::ofstream stream(part, std::ios::binary | std::ios::trunc);
    stream << toJson(report);
    stream.flush();
    if (!stream) {
      if (replaceable) fs::remove(part, error);
      return unwritable(file, "cannot be written");
    }
  }
  if (replaceable) fs::rename(part, file, error);
  if (error) return unwritable(file, error.message());
  return Done{};
}

}  // namespace crowded_room
