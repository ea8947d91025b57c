// SPDX-License-Identifier: MIT

#include <spheretree/broad_phases.hpp>

#include <spheretree/brute_force.hpp>
#include <spheretree/grid.hpp>
#include <spheretree/grid_sweep.hpp>
#include <spheretree/octree_broad_phase.hpp>
#include <spheretree/sweep.hpp>
#include <spheretree/sweep_and_prune.hpp>

namespace spheretree {

std::string_view nameOf(BroadPhaseKind kind) noexcept {
  switch (kind) {
    case BroadPhaseKind::BruteForce:
      return "brute_force";
    case BroadPhaseKind::Grid:
      return "grid";
    case BroadPhaseKind::Octree:
      return "octree";
    case BroadPhaseKind::SweepAndPrune:
      return "sweep_and_prune";
    case BroadPhaseKind::GridSweep:
      return "grid_sweep";
    case BroadPhaseKind::Sweep:
      break;
  }
  return "sweep";
}

std::optional<BroadPhaseKind> broadPhaseNamed(std::string_view name) noexcept {
  for (const BroadPhaseKind kind : kBroadPhaseKinds) {
    if (nameOf(kind) == name) return kind;
  }
  return std::nullopt;
}

std::unique_ptr<BroadPhase> makeBroadPhase(BroadPhaseKind kind) {
  switch (kind) {
    case BroadPhaseKind::BruteForce:
      return std::make_unique<BruteForce>();
    case BroadPhaseKind::Grid:
      return std::make_unique<Grid>();
    case BroadPhaseKind::Octree:
      return std::make_unique<OctreeBroadPhase>();
    case BroadPhaseKind::SweepAndPrune:
      return std::make_unique<SweepAndPrune>();
    case BroadPhaseKind::GridSweep:
      return std::make_unique<GridSweep>();
    case BroadPhaseKind::Sweep:
      break;
  }
  return std::make_unique<Sweep>();
}

}  // namespace spheretree
