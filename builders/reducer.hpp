// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "builders/settings.hpp"
#include "medial/ball.hpp"
#include "medial/cell_set.hpp"
#include "medial/context.hpp"
#include "medial/medial_axis.hpp"
#include "medial/surface.hpp"

namespace spheretree::builders {

/// What becomes of a reducer's balls.
enum class Use : std::uint8_t {
  Final,  ///< they stay as they are
  Start   ///< they are refined: a search may end where refinement goes on
};

/// Cover these cells with few balls.
struct ReduceRequest {
  const medial::Surface& surface;
  const medial::CellSet& cells;
  const medial::MedialAxis& axis;  ///< refined for this region; empty when the reducer does not want one
  std::uint32_t maxBalls;
  double goodEnough;  ///< overhang, mesh units: fewer balls are better than less overhang than this; 0: never
  Objective objective;
  std::uint64_t seed;
  Use use;
  const medial::Context& context;
};

/// A way to cover a region with few balls that stick out little: a pure function of the request.
class Reducer {
 public:
  Reducer() = default;
  Reducer(const Reducer&) = delete;
  Reducer& operator=(const Reducer&) = delete;
  virtual ~Reducer() = default;

  /// Whether requests must carry a medial axis.
  [[nodiscard]] virtual bool wantsAxis() const { return false; }

  /// Between one and maxBalls balls; each cell lies wholly in one of them. Any number of threads at once.
  [[nodiscard]] virtual std::vector<medial::Ball> reduce(const ReduceRequest& request) const = 0;
};

/// Greedy merging of the balls of the region's medial axis, merge.cpp.
[[nodiscard]] std::unique_ptr<Reducer> makeMergeReducer();

/// Removal of the ball whose neighbours pay least for it, burst.cpp.
[[nodiscard]] std::unique_ptr<Reducer> makeBurstReducer();

/// One stand-off for all balls, the least with which few enough cover, expand.cpp.
[[nodiscard]] std::unique_ptr<Reducer> makeExpandReducer();

/// As expand, with balls grown where something is uncovered, spawn.cpp.
[[nodiscard]] std::unique_ptr<Reducer> makeSpawnReducer();

/// Optimised grids, grid.cpp.
[[nodiscard]] std::unique_ptr<Reducer> makeGridReducer(const GridSettings& settings);

/// Greedy merging of the balls of one static medial axis, which is made here, hubbard.cpp.
[[nodiscard]] std::unique_ptr<Reducer> makeHubbardReducer(const medial::Surface& surface,
                                                          const HubbardSettings& settings,
                                                          const medial::Context& context);

}  // namespace spheretree::builders
