// SPDX-License-Identifier: MIT
#include <cstdio>
#include <exception>
#include <memory>
#include <span>
#include <string>

#include <spheretree/version.hpp>

#include "film.hpp"
#include "headless.hpp"
#include "options.hpp"
#include "tree_search.hpp"
#include "window.hpp"

namespace {

using namespace crowded_room;
using spheretree::Done;
using spheretree::Error;
using spheretree::ErrorCode;
using spheretree::Result;

int exitCodeOf(ErrorCode code) {
  switch (code) {
    case ErrorCode::InvalidArgument:
      return 2;
    case ErrorCode::UnreadableInput:
    case ErrorCode::UnsuitableMesh:
      return 3;
    case ErrorCode::UnwritableOutput:
      return 6;
    default:
      return 1;
  }
}

int failWith(const Error& error) {
  std::fprintf(stderr, "crowded_room: %s\n", error.message.c_str());
  return exitCodeOf(error.code);
}

void print(const HeadlessReport& report) {
  std::printf(
      "%u objects, %u frames, %s: %.0f microseconds of collision a frame (update %.0f, broad %.0f, narrow "
      "%.0f), %.0f fps: %s\n",
      report.room.objects, report.frames, std::string(nameOf(report.room.broadPhase)).c_str(),
      report.collision.mean, report.update.mean, report.broad.mean, report.narrow.mean, report.fpsOfMean(),
      std::string(satisfactionAt(report.fpsOfMean())).c_str());
  if (report.render)
    std::printf("rendering: %.1f ms a frame, %.1f fps with it\n", report.render->mean / 1000,
                *report.fpsRendered());
}

Result<Done> runWithoutWindow(const Options& options, const TreeLibrary& library) {
  HeadlessSettings settings;
  settings.room = options.room;
  settings.frames = options.frames.value_or(Options::kHeadlessFrames);
  if (options.tour) settings.stick = tour;
  std::unique_ptr<Film> film;
  if (options.render || !options.screenshot.empty() || !options.record.empty()) {
    Result<std::unique_ptr<Film>> made = Film::create(options);
    if (!made) return made.error();
    film = std::move(*made);
    settings.render = [&film](const Room& room) { return film->take(room); };
  }
  Result<HeadlessReport> report = runHeadless(settings, library);
  if (!report) return report.error();
  if (film && film->problem()) return *film->problem();
  if (!options.render) report->render.reset();  // single pictures are no measurement
  print(*report);
  if (options.report.empty()) return Done{};
  return writeReport(*report, options.report);
}

Result<Done> run(const Options& options) {
  const Result<FoundTrees> trees = findTrees(options.trees);
  if (!trees) return trees.error();
  if (!trees->remark.empty()) std::fprintf(stderr, "crowded_room: %s\n", trees->remark.c_str());
  if (options.mode == Mode::Headless) return runWithoutWindow(options, trees->library);
  return runWindow(options, trees->library);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const Result<Options> options =
        parseOptions(std::span<const char* const>(argv, static_cast<std::size_t>(argc)).subspan(1));
    if (!options) return failWith(options.error());
    if (options->mode == Mode::Help) {
      std::fputs(helpText().c_str(), stdout);
      return 0;
    }
    if (options->mode == Mode::Version) {
      std::printf("crowded_room %s\n", SPHERETREE_VERSION);
      return 0;
    }
    const Result<Done> done = run(*options);
    return done ? 0 : failWith(done.error());
  } catch (const std::exception& problem) {
    return failWith({ErrorCode::Internal, problem.what()});
  }
}
