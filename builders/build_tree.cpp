// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/build_tree.hpp"

#include <chrono>
#include <cmath>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "builders/catalogue.hpp"
#include "builders/finalize.hpp"
#include "medial/canonical_frame.hpp"

namespace spheretree::builders {
namespace {

/// A sentence saying what is wrong with the settings; empty when nothing is.
std::string whyInvalid(const BuildSettings& s) {
  if (findBuilder(s.builder) == nullptr) {
    std::string names;
    for (const CatalogueEntry& entry : catalogue())
      names += (names.empty() ? "" : ", ") + std::string(entry.name);
    return "unknown builder '" + s.builder + "'; there are " + names;
  }
  if (s.branch < SettingLimits::kLeastBranch || s.branch > SettingLimits::kMostBranch) {
    return "branch must be between " + std::to_string(SettingLimits::kLeastBranch) + " and " +
           std::to_string(SettingLimits::kMostBranch) + ", not " + std::to_string(s.branch);
  }
  if (s.levels < 1 || s.levels > SettingLimits::kMostLevels) {
    return "levels must be between 1 and " + std::to_string(SettingLimits::kMostLevels) + ", not " +
           std::to_string(s.levels);
  }
  if (!std::isfinite(s.maxError) || s.maxError < 0) {
    return "max-error must be a fraction of the diagonal, 0 or more";
  }
  if (s.hubbard.samples < SettingLimits::kLeastSamples) {
    return "samples must be at least " + std::to_string(SettingLimits::kLeastSamples);
  }
  return {};
}

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

/// Builders see every mesh in the frame of its own shape: size, place and attitude of the input then matter
/// no more than rounding does.
BallTree buildInCanonicalFrame(const medial::Surface& surface, const BuildSettings& settings,
                               const medial::Context& context) {
  const medial::CanonicalFrame frame = medial::canonicalFrame(surface.mesh());
  Result<medial::Surface> moved = medial::Surface::create(medial::toFrame(surface.mesh(), frame));
  if (!moved) throw std::runtime_error("the mesh does not survive normalisation: " + moved.error().message);
  BuildSettings local = settings;
  // A fraction of the input's diagonal stays the same length; the diagonal depends on the attitude.
  local.maxError *= surface.diagonal() / (frame.scale * moved->diagonal());
  BallTree tree = findBuilder(settings.builder)->build(*moved, local, context);
  for (std::vector<BallTree::Node>& level : tree.levels) {
    for (BallTree::Node& node : level) {
      node.ball = {frame.backward(node.ball.center), node.ball.radius * frame.scale};
    }
  }
  return tree;
}

Result<BuildResult> build(const medial::Surface& surface, const BuildSettings& settings,
                          const medial::Context& context) {
  if (std::string reason = whyInvalid(settings); !reason.empty()) {
    return Error{ErrorCode::InvalidArgument, std::move(reason)};
  }
  BuildReport report;
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
        {measureLevel(surface, ballsOf(tree->level(depth)), context), balls.winners[depth]});
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

}  // namespace

Result<BuildResult> buildTree(const medial::Surface& surface, const BuildSettings& settings,
                              const medial::Context& context) {
  try {
    return build(surface, settings, context);
  } catch (const medial::CancelledError&) {
    return Error{ErrorCode::Cancelled, "cancelled"};
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::Internal, "out of memory"};
  } catch (const std::exception& e) {
    return Error{ErrorCode::Internal, e.what()};
  }
}

}  // namespace spheretree::builders
