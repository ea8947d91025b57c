// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <spheretree/pair_query.hpp>

namespace spheretree {

/// A query that was restarted for this frame, and how much its answer matters; larger is more relevant.
struct ScheduledQuery {
  PairQuery* query = nullptr;
  float relevance = 0;
};

/// Spreads the budget of one frame over many queries.
///
/// Level by level: every query gets its answer on level 1 before any is refined on level 2, and within a
/// level the most relevant go first (equal ones in the order given). When the budget ends, the more relevant
/// queries are at most one level ahead of the others, and each has the answer and the slackBound() it has
/// come to. Repeatable when the budget is in sphere tests. Keeps its buffer between calls; one thread at a
/// time.
class QueryScheduler {
 public:
  /// Advances the queries until all are decided on level `budget.deepestLevel` or the budget, which is for
  /// all together, is used up. Returns how many are still `Undecided`. O(n log n) beside the queries' own
  /// work.
  std::size_t run(std::span<const ScheduledQuery> queries, const QueryLimits& budget);

 private:
  std::vector<std::uint32_t> order_;
};

}  // namespace spheretree
