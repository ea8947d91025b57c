// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/build_tree.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "builders/catalogue.hpp"
#include "builders/finalize.hpp"
#include "builders/level_driver.hpp"
#include "builders/settings_use.hpp"
#include "medial/canonical_frame.hpp"

namespace spheretree::builders {
namespace {

/// Wall-clock seconds of consecutive stages, for the report only.
class Stopwatch {
 public:
  explicit Stopwatch(std::vector<StageTime>& stages) : stages_(stages), last_(Clock::now()) {}
  void lap(const char* stage) {
    const auto now = Clock::now();
    stages_.push_back({stage, std::chrono::duration<double>(now - last_).count()});
    last_ = now;
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::vector<StageTime>& stages_;
  Clock::time_point last_;
};

// With coarser steps the balls of every level are about as large as the mesh, and the tree says nothing.
constexpr double kCoarsestStep = 0.25;

double reachOf(const medial::Surface& surface) {
  return std::max(surface.bounds().min().cwiseAbs().maxCoeff(), surface.bounds().max().cwiseAbs().maxCoeff());
}

/// As BuildReport::coordinateStep.
double coordinateStep(const medial::Surface& surface) {
  const double reach = reachOf(surface);
  if (reach >= static_cast<double>(std::numeric_limits<float>::max()))
    return std::numeric_limits<double>::infinity();
  const auto here = static_cast<float>(reach);
  const float next = std::nextafter(here, std::numeric_limits<float>::infinity());
  return (static_cast<double>(next) - static_cast<double>(here)) / surface.diagonal();
}

/// A sentence saying why balls in single precision cannot stand for the surface; empty when they can.
std::string whyNotInFloats(const medial::Surface& surface, double step) {
  const double diagonal = surface.diagonal();
  std::array<char, 256> text{};
  if (reachOf(surface) + diagonal >= static_cast<double>(std::numeric_limits<float>::max())) {
    std::snprintf(
        text.data(), text.size(),
        "the mesh reaches out to %.3g, and the balls of a tree are in single precision, which ends at 3.4e38",
        reachOf(surface));
  } else if (step > kCoarsestStep) {
    std::snprintf(
        text.data(), text.size(),
        "the mesh is %.3g across, but so placed that the single precision of a tree has steps of %.3g there; "
        "%s",
        diagonal, step * diagonal, reachOf(surface) > diagonal ? "move it to the origin" : "scale it up");
  }
  return text.data();
}

/// Builders see every mesh in the frame of its own shape: size, place and attitude of the input then matter
/// no more than rounding does.
struct Canonical {
  Canonical(const medial::Surface& surface, const BuildSettings& given)
      : frame(medial::canonicalFrame(surface.mesh())), solid(moved(surface, frame)), settings(given) {
    // A fraction of the input's diagonal stays the same length; the diagonal depends on the attitude.
    settings.maxError *= surface.diagonal() / (frame.scale * solid.diagonal());
  }

  static medial::Surface moved(const medial::Surface& surface, const medial::CanonicalFrame& frame) {
    // Rounding that differs from place to place would tip decisions. Detail too fine for it stays as it is.
    Result<medial::Surface> solid =
        medial::Surface::create(medial::toFrame(surface.mesh(), frame, medial::Places::Snapped));
    if (!solid)
      solid = medial::Surface::create(medial::toFrame(surface.mesh(), frame, medial::Places::Exact));
    if (!solid) {
      throw std::runtime_error("the mesh does not survive normalisation: " + solid.error().message);
    }
    return std::move(*solid);
  }

  [[nodiscard]] medial::Ball backward(const medial::Ball& ball) const {
    return {frame.backward(ball.center), ball.radius * frame.scale};
  }

  medial::CanonicalFrame frame;
  medial::Surface solid;
  BuildSettings settings;
};

BallTree buildInCanonicalFrame(const medial::Surface& surface, const BuildSettings& settings,
                               const medial::Context& context) {
  const Canonical canonical(surface, settings);
  BallTree tree = findBuilder(settings.builder)->build(canonical.solid, canonical.settings, context);
  for (std::vector<BallTree::Node>& level : tree.levels) {
    for (BallTree::Node& node : level) node.ball = canonical.backward(node.ball);
  }
  return tree;
}

Result<medial::MedialAxis> axisInMeshFrame(const medial::Surface& surface, const BuildSettings& settings,
                                           const medial::Context& context) {
  if (std::string reason = whyInvalid(settings); !reason.empty()) {
    return Error{ErrorCode::InvalidArgument, std::move(reason)};
  }
  const Canonical canonical(surface, settings);
  medial::MedialAxis axis = rootAxis(canonical.solid, canonical.settings, context);
  for (medial::MedialBall& ball : axis.balls) {
    ball = {canonical.backward(ball.ball), ball.depth * canonical.frame.scale};
  }
  return axis;
}

Result<BuildResult> build(const medial::Surface& surface, const BuildSettings& settings,
                          const medial::Context& context) {
  if (std::string reason = whyInvalid(settings); !reason.empty()) {
    return Error{ErrorCode::InvalidArgument, std::move(reason)};
  }
  BuildReport report;
  report.coordinateStep = coordinateStep(surface);
  if (std::string reason = whyNotInFloats(surface, report.coordinateStep); !reason.empty()) {
    return Error{ErrorCode::UnsuitableMesh, std::move(reason)};
  }
  report.settings = settings;
  report.threads = context.threads();
  Stopwatch watch(report.stages);

  const BallTree balls = buildInCanonicalFrame(surface, settings, context);
  Result<SphereTree> tree = finalize(balls);
  if (!tree) return Error{ErrorCode::Internal, "the builder made no valid tree: " + tree.error().message};
  watch.lap("build");

  context.report("certify", 0);
  report.surfaceChains = proveSurfaceChains(surface, *tree, context);
  if (report.surfaceChains.certified && settings.cover == Cover::Solid) {
    report.solidChains = proveSolidChains(surface, *tree, context);
  }
  const bool certified =
      report.surfaceChains.certified && (settings.cover == Cover::Surface || report.solidChains.certified);
  if (!certified) {
    const ChainProof& failed = report.surfaceChains.certified ? report.solidChains : report.surfaceChains;
    return Error{ErrorCode::Internal, "cover could not be proved on level " +
                                          std::to_string(failed.failedLevel) + " near triangle " +
                                          std::to_string(failed.failedTriangle)};
  }
  watch.lap("certify");

  for (std::size_t depth = 0; depth < tree->levelCount(); ++depth) {
    context.report("measure", static_cast<double>(depth) / static_cast<double>(tree->levelCount()));
    report.levels.push_back(
        {measureLevel(surface, ballsOf(tree->level(depth)), context), balls.winners[depth], {}});
    for (const BallTree::Node& node : balls.levels[depth]) report.levels.back().makers.push_back(node.maker);
  }
  if (report.solidChains.certified) {
    // A chain through every level for every point of the solid: each level covers it.
    for (LevelReport& level : report.levels) {
      level.metrics.solid.certified = true;
      level.metrics.solid.uncovered = {};
    }
  }
  watch.lap("measure");
  if (settings.maxError > 0) {
    report.errorBoundMet =
        report.levels.back().metrics.overhangWorst.upper <= settings.maxError * surface.diagonal();
  }
  return BuildResult{std::move(*tree), std::move(report)};
}

/// Turns what a builder throws into an error.
template <class Value, class Work>
Result<Value> guarded(const Work& work) {
  try {
    return work();
  } catch (const medial::CancelledError&) {
    return Error{ErrorCode::Cancelled, "cancelled"};
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::Internal, "out of memory"};
  } catch (const std::exception& e) {
    return Error{ErrorCode::Internal, e.what()};
  }
}

}  // namespace

Result<BuildResult> buildTree(const medial::Surface& surface, const BuildSettings& settings,
                              const medial::Context& context) {
  return guarded<BuildResult>([&] { return build(surface, settings, context); });
}

Result<medial::MedialAxis> rootMedialAxis(const medial::Surface& surface, const BuildSettings& settings,
                                          const medial::Context& context) {
  return guarded<medial::MedialAxis>([&] { return axisInMeshFrame(surface, settings, context); });
}

}  // namespace spheretree::builders
