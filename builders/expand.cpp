// SPDX-License-Identifier: GPL-3.0-or-later
//
// The Expand reducer of G. Bradshaw, C. O'Sullivan, "Adaptive medial-axis approximation for sphere-tree
// construction", ACM TOG 23(1), 2004, section 5: the balls of the region's medial axis all get the same
// stand-off, and the least one is searched at which few enough of them cover the region.
#include <cstddef>
#include <vector>

#include "builders/reducer.hpp"
#include "builders/stand_off_search.hpp"

namespace spheretree::builders {
namespace {

using medial::Ball;

// An axis with fewer balls than this per ball allowed is helped out by balls grown from the surface: thin
// parts may have none at all.
constexpr std::size_t kLeastChoice = 8;

class ExpandReducer final : public Reducer {
 public:
  [[nodiscard]] bool wantsAxis() const override { return true; }

  [[nodiscard]] std::vector<Ball> reduce(const ReduceRequest& request) const override {
    StandOffSearch search(request);
    CoverTable& table = search.table();
    for (const medial::MedialBall& ball : request.axis.balls) {
      table.addCandidate({ball.ball.center, ball.depth});
    }
    request.context.checkCancelled();
    if (table.candidates().size() < kLeastChoice * request.maxBalls) {
      for (const std::uint32_t cell : table.rows()) table.addCandidate(search.growFrom(cell));
    }
    search.startGreedily();
    return search.finish();
  }
};

}  // namespace

std::unique_ptr<Reducer> makeExpandReducer() {
  return std::make_unique<ExpandReducer>();
}

}  // namespace spheretree::builders
