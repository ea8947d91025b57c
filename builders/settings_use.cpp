// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/settings_use.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "builders/catalogue.hpp"

namespace spheretree::builders {
namespace {

constexpr std::string_view kCombined = "combined";
// Reducer::wantsAxis() of a reducer says the same, but a reducer takes a surface to make.
constexpr std::array<std::string_view, 3> kOnAxis{"merge", "burst", "expand"};

enum class Rows : std::uint8_t { All, Reducers };

std::string namesOf(Rows rows) {
  std::string names;
  for (const CatalogueEntry& entry : catalogue()) {
    if (rows == Rows::Reducers && entry.makeReducer == nullptr) continue;
    names += (names.empty() ? "" : ", ") + std::string(entry.name);
  }
  return names;
}

bool isOn(Toggle toggle, bool automatic) {
  return toggle == Toggle::Auto ? automatic : toggle == Toggle::On;
}

std::string whyNoLink(const BuildSettings& s) {
  if (reducersInUse(s).empty() || s.link != Toggle::On || refines(s)) return {};
  return std::string("link needs refine, which is off") +
         (s.refine == Toggle::Auto ? " for a reducer on its own unless set to on" : "") +
         ": levels are linked by refining them";
}

}  // namespace

std::string whyInvalid(const BuildSettings& s) {
  if (findBuilder(s.builder) == nullptr) {
    return "unknown builder '" + s.builder + "'; there are " + namesOf(Rows::All);
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
  if (!std::isfinite(s.axis.error) || s.axis.error <= 0) {
    return "axis-error must be a fraction of the parent's overhang, above 0";
  }
  if (std::string reason = whyNoReducers(s.combined.reducers); !reason.empty()) return reason;
  return whyNoLink(s);
}

std::string whyNoReducers(std::span<const std::string> names) {
  const std::string choice = "; there are " + namesOf(Rows::Reducers);
  if (names.empty()) return "combined needs at least one reducer" + choice;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const CatalogueEntry* entry = findBuilder(names[k]);
    if (entry == nullptr) return "unknown reducer '" + names[k] + "'" + choice;
    if (entry->makeReducer == nullptr) return "'" + names[k] + "' is no reducer" + choice;
    const auto before = names.first(k);
    if (std::find(before.begin(), before.end(), names[k]) != before.end()) {
      return "the reducer '" + names[k] + "' is named twice";
    }
  }
  return {};
}

std::vector<std::string_view> reducersInUse(const BuildSettings& s) {
  std::vector<std::string_view> names;
  for (const CatalogueEntry& entry : catalogue()) {
    if (entry.makeReducer == nullptr) continue;
    const std::vector<std::string>& several = s.combined.reducers;
    const bool used = s.builder == kCombined
                          ? std::find(several.begin(), several.end(), entry.name) != several.end()
                          : s.builder == entry.name;
    if (used) names.push_back(entry.name);
  }
  return names;
}

bool refines(const BuildSettings& s) {
  return !reducersInUse(s).empty() && isOn(s.refine, s.builder == kCombined);
}

bool links(const BuildSettings& s) {
  return refines(s) && isOn(s.link, s.builder == kCombined);
}

bool usesAxis(const BuildSettings& s) {
  const std::vector<std::string_view> names = reducersInUse(s);
  return std::any_of(names.begin(), names.end(), [](std::string_view name) {
    return std::find(kOnAxis.begin(), kOnAxis.end(), name) != kOnAxis.end();
  });
}

}  // namespace spheretree::builders
