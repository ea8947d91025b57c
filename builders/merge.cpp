// SPDX-License-Identifier: GPL-3.0-or-later
//
// G. Bradshaw, C. O'Sullivan, "Adaptive medial-axis approximation for sphere-tree construction", ACM TOG
// 23(1), 2004, section 5: Hubbard's merging, on the refined medial axis of the region. While there are many
// balls a merged one keeps one of the two centres; the last ones walk to where they stick out least.
#include <utility>

#include "builders/merging.hpp"
#include "builders/reducer.hpp"
#include "builders/stages.hpp"

namespace spheretree::builders {
namespace {

class MergeReducer final : public Reducer {
 public:
  [[nodiscard]] bool wantsAxis() const override { return true; }

  [[nodiscard]] std::vector<medial::Ball> reduce(const ReduceRequest& request) const override {
    const auto mergeBy = [&](const MergeRules& rules) -> ReduceTo {
      return [&request, rules](const Units&, std::vector<Cluster> clusters, std::size_t wanted) {
        return mergeClusters(request, std::move(clusters), wanted, rules);
      };
    };
    return reduceInStages(request, mergeBy({MergedCenter::Old, {0, 0}}),
                          mergeBy({MergedCenter::Between, kFollow}));
  }
};

}  // namespace

std::unique_ptr<Reducer> makeMergeReducer() {
  return std::make_unique<MergeReducer>();
}

}  // namespace spheretree::builders
