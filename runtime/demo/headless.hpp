// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include <spheretree/result.hpp>

#include "room.hpp"

namespace crowded_room {

/// A run without a user.
struct HeadlessSettings {
  RoomSettings room;
  std::uint32_t frames = 500;  ///< that are measured; at least 1
  std::uint32_t warmUp = 60;   ///< before them, not measured
  /// Called before every step: how the avatar is flown. Without it the stick rests.
  std::function<StickInput(const Room&)> stick;
  /// Called after every measured frame, for a program that renders them: returns the microseconds that
  /// rendering took. Without it the report has no rendering.
  std::function<float(const Room&)> render;
};

/// One phase over all measured frames, microseconds.
struct PhaseSummary {
  double mean = 0;
  double median = 0;
  double p99 = 0;
};

struct HeadlessReport {
  RoomSettings room;
  std::string bunnyTree;  ///< names of the trees that were worn
  std::string boxTree;
  std::uint32_t frames = 0;
  PhaseSummary update;
  PhaseSummary broad;
  PhaseSummary narrow;
  PhaseSummary collision;  ///< the three together, frame by frame
  PhaseSummary response;
  /// Processor time of the whole step, response included, all threads: what a busy machine disturbs least.
  PhaseSummary processor;
  std::optional<PhaseSummary> render;
  std::optional<PhaseSummary> renderProcessor;  ///< processor time of rendering, all threads
  double pairsPerFrame = 0;
  double contactsPerFrame = 0;
  std::uint64_t stateHash = 0;  ///< after the last frame
  Audit audit;                  ///< after the last frame
  std::uint64_t impacts = 0;    ///< of the avatar

  /// Frames per second if there were nothing but collisions: 1 / mean, as the paper counts, or 1 / median.
  [[nodiscard]] double fpsOfMean() const noexcept { return 1e6 / collision.mean; }
  [[nodiscard]] double fpsOfMedian() const noexcept { return 1e6 / collision.median; }
  /// With collisions, response and rendering; by means. Nothing without rendering.
  [[nodiscard]] std::optional<double> fpsRendered() const noexcept;
};

/// The level of satisfaction that the paper's Table 1 gives to a frame rate: low, good, very good, high.
[[nodiscard]] std::string_view satisfactionAt(double fps) noexcept;

/// Runs a room. Fails as Room::create() and Room::step() do, or with InvalidArgument
/// when there is no frame to measure.
spheretree::Result<HeadlessReport> runHeadless(const HeadlessSettings& settings, const TreeLibrary& library);

/// The report as a JSON object, two spaces a level, with a line feed at its end; docs/crowded-room.md
/// describes the members.
[[nodiscard]] std::string toJson(const HeadlessReport& report);

/// Writes the report so that a reader never sees half a file. Fails with UnwritableOutput, naming file and
/// reason.
spheretree::Result<spheretree::Done> writeReport(const HeadlessReport& report,
                                                 const std::filesystem::path& file);

}  // namespace crowded_room
