// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/catalogue.hpp"

#include <array>

#include "builders/level_driver.hpp"
#include "builders/reducer.hpp"

namespace spheretree::builders {
namespace {

BallTree buildGrid(const medial::Surface& surface, const BuildSettings& settings,
                   const medial::Context& context) {
  return buildByLevels(surface, settings, "grid", *makeGridReducer(settings.grid), context);
}

BallTree buildHubbard(const medial::Surface& surface, const BuildSettings& settings,
                      const medial::Context& context) {
  return buildByLevels(surface, settings, "hubbard", *makeHubbardReducer(surface, settings.hubbard, context),
                       context);
}

constexpr std::array kBuilders{
    CatalogueEntry{"octree", "circumscribed octree cells: the fast, fat baseline",
                   "Bradshaw, O'Sullivan, ACM TOG 23(1), 2004, section 2", &buildOctree},
    CatalogueEntry{"grid", "per node the regular grid, turned and sized for the least error",
                   "Bradshaw, thesis, Trinity College Dublin, 2002", &buildGrid},
    CatalogueEntry{"hubbard", "greedy merging of the balls of one static medial axis",
                   "Hubbard, ACM TOG 15(3), 1996", &buildHubbard},
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
