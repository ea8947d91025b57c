// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/catalogue.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "builders/level_driver.hpp"
#include "builders/reducer.hpp"

namespace spheretree::builders {
namespace {

using medial::Context;
using medial::Surface;

std::unique_ptr<Reducer> newGrid(const Surface&, const BuildSettings& settings, const Context&) {
  return makeGridReducer(settings.grid);
}
std::unique_ptr<Reducer> newHubbard(const Surface& surface, const BuildSettings& settings,
                                    const Context& context) {
  return makeHubbardReducer(surface, settings.hubbard, context);
}
template <std::unique_ptr<Reducer> (*kMake)()>
std::unique_ptr<Reducer> newPlain(const Surface&, const BuildSettings&, const Context&) {
  return kMake();
}

/// The reducers named in the settings compete for every set; a row with a reducer of its own has no rival.
BallTree buildWith(const std::vector<std::string>& names, const Surface& surface,
                   const BuildSettings& settings, const Context& context) {
  std::vector<NamedReducer> reducers;
  for (const CatalogueEntry& entry : catalogue()) {
    if (entry.makeReducer == nullptr) continue;
    if (std::find(names.begin(), names.end(), entry.name) == names.end()) continue;
    reducers.push_back({entry.name, entry.makeReducer(surface, settings, context)});
  }
  return buildByLevels(surface, settings, reducers, context);
}

BallTree buildAlone(const Surface& surface, const BuildSettings& settings, const Context& context) {
  return buildWith({settings.builder}, surface, settings, context);
}

BallTree buildCombined(const Surface& surface, const BuildSettings& settings, const Context& context) {
  return buildWith(settings.combined.reducers, surface, settings, context);
}

constexpr const char* kAdaptive = "Bradshaw, O'Sullivan, ACM TOG 23(1), 2004, section 5";

constexpr std::array kBuilders{
    CatalogueEntry{"octree", "circumscribed octree cells: the fast, fat baseline",
                   "Bradshaw, O'Sullivan, ACM TOG 23(1), 2004, section 2", &buildOctree, nullptr},
    CatalogueEntry{"grid", "per node the regular grid, turned and sized for the least error",
                   "Bradshaw, thesis, Trinity College Dublin, 2002", &buildAlone, &newGrid},
    CatalogueEntry{"hubbard", "greedy merging of the balls of one static medial axis",
                   "Hubbard, ACM TOG 15(3), 1996", &buildAlone, &newHubbard},
    CatalogueEntry{"spawn", "balls of one stand-off, grown where something is uncovered", kAdaptive,
                   &buildAlone, &newPlain<&makeSpawnReducer>},
    CatalogueEntry{"merge", "greedy merging of the balls of an adaptive medial axis", kAdaptive, &buildAlone,
                   &newPlain<&makeMergeReducer>},
    CatalogueEntry{"burst", "removal of medial balls whose neighbours pay least for it", kAdaptive,
                   &buildAlone, &newPlain<&makeBurstReducer>},
    CatalogueEntry{"expand", "medial balls of the one stand-off with which few enough cover", kAdaptive,
                   &buildAlone, &newPlain<&makeExpandReducer>},
    CatalogueEntry{"combined", "the best of several reducers for every set, refined and linked: the default",
                   kAdaptive, &buildCombined, nullptr},
};

}  // namespace

std::span<const CatalogueEntry> catalogue() {
  return kBuilders;
}

const CatalogueEntry* findBuilder(std::string_view name) {
  for (const CatalogueEntry& entry : kBuilders) {
    if (entry.name == name) return &entry;
  }
  return nullptr;
}

}  // namespace spheretree::builders
