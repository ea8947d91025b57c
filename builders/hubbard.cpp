// SPDX-License-Identifier: GPL-3.0-or-later
//
// P. Hubbard, "Approximating polyhedra with spheres for time-critical collision detection", ACM TOG 15(3),
// 1996: the balls of one static medial axis are merged pairwise, cheapest pair first, until few enough are
// left.
#include <utility>

#include "builders/clusters.hpp"
#include "builders/merging.hpp"
#include "builders/reducer.hpp"
#include "medial/medial_axis.hpp"

namespace spheretree::builders {
namespace {

class HubbardReducer final : public Reducer {
 public:
  explicit HubbardReducer(medial::MedialAxis axis) : axis_(std::move(axis)) {}

  [[nodiscard]] std::vector<medial::Ball> reduce(const ReduceRequest& request) const override {
    const Units units(request.cells, 0);
    return ballsOf(mergeClusters(request, medialClusters(request, units, axis_, 1), request.maxBalls,
                                 MergedCenter::Any));
  }

 private:
  medial::MedialAxis axis_;
};

}  // namespace

std::unique_ptr<Reducer> makeHubbardReducer(const medial::Surface& surface, const HubbardSettings& settings,
                                            const medial::Context& context) {
  return std::make_unique<HubbardReducer>(medial::staticMedialAxis(surface, {settings.samples}, context));
}

}  // namespace spheretree::builders
