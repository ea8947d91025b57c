// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include <spheretree/broad_phase.hpp>

namespace spheretree {

/// The engines, to choose one by name. `Sweep` is the one to take unless a measurement says otherwise.
enum class BroadPhaseKind : std::uint8_t { BruteForce, Grid, Octree, SweepAndPrune, GridSweep, Sweep };

inline constexpr std::array kBroadPhaseKinds{BroadPhaseKind::BruteForce, BroadPhaseKind::Grid,
                                             BroadPhaseKind::Octree,     BroadPhaseKind::SweepAndPrune,
                                             BroadPhaseKind::GridSweep,  BroadPhaseKind::Sweep};

/// The name of an engine as a user types it: brute_force, grid, octree, sweep_and_prune, grid_sweep, sweep.
[[nodiscard]] std::string_view nameOf(BroadPhaseKind kind) noexcept;

/// The engine of that name, or nothing.
[[nodiscard]] std::optional<BroadPhaseKind> broadPhaseNamed(std::string_view name) noexcept;

/// A new engine with its default settings.
[[nodiscard]] std::unique_ptr<BroadPhase> makeBroadPhase(BroadPhaseKind kind);

}  // namespace spheretree
