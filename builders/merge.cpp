// SPDX-License-Identifier: GPL-3.0-or-later
//
// G. Bradshaw, C. O'Sullivan, "Adaptive medial-axis approximation for sphere-tree construction", ACM TOG
// 23(1), 2004, section 5: Hubbard's merging on the refined medial axis of the region. Here in two stages:
// while there are many balls a merged one keeps one of the two centres, later it moves to the best place.
#include <utility>

#include "builders/clusters.hpp"
#include "builders/merging.hpp"
#include "builders/reducer.hpp"

namespace spheretree::builders {
namespace {

class MergeReducer final : public Reducer {
 public:
  [[nodiscard]] bool wantsAxis() const override { return true; }

  [[nodiscard]] std::vector<medial::Ball> reduce(const ReduceRequest& request) const override {
    const auto mergeWith = [&](MergedCenter center) {
      return [&request, center](const Units&, std::vector<Cluster> clusters, std::size_t wanted) {
        return mergeClusters(request, std::move(clusters), wanted, center);
      };
    };
    return reduceInStages(request, mergeWith(MergedCenter::Old), mergeWith(MergedCenter::Moved));
  }
};

}  // namespace

std::unique_ptr<Reducer> makeMergeReducer() {
  return std::make_unique<MergeReducer>();
}

}  // namespace spheretree::builders
