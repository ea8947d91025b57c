// SPDX-License-Identifier: GPL-3.0-or-later
//
// P. Hubbard, "Approximating polyhedra with spheres for time-critical collision detection", ACM TOG 15(3),
// 1996: the balls of one static medial axis are merged pairwise, cheapest pair first, until few enough are
// left. Here a ball stands for the cells that it needs to stick out least for; merging two balls makes a ball
// around the cells of both, and the cost of a merge is the overhang of that ball.
#include <utility>

#include "builders/clusters.hpp"
#include "builders/merging.hpp"
#include "builders/reducer.hpp"
#include "builders/units.hpp"
#include "medial/medial_axis.hpp"

namespace spheretree::builders {
namespace {

class HubbardReducer final : public Reducer {
 public:
  HubbardReducer(const medial::Surface& surface, const HubbardSettings& settings,
                 const medial::Context& context)
      : axis_(medial::staticMedialAxis(surface, {settings.samples}, context)) {}

  [[nodiscard]] std::vector<medial::Ball> reduce(const ReduceRequest& request) const override {
    const Units cells(request.cells, 0);
    return ballsOf(mergeClusters(request, medialClusters(request, cells, axis_, 1), request.maxBalls,
                                 {MergedCenter::Enclosing, {0, 0}}));
  }

 private:
  medial::MedialAxis axis_;
};

}  // namespace

std::unique_ptr<Reducer> makeHubbardReducer(const medial::Surface& surface, const HubbardSettings& settings,
                                            const medial::Context& context) {
  return std::make_unique<HubbardReducer>(surface, settings, context);
}

}  // namespace spheretree::builders
