// SPDX-License-Identifier: MIT
//
// Time-critical collision handling, after J. Dingliana and C. O'Sullivan, "Graceful degradation of collision
// handling in physically based animation", Computer Graphics Forum 19(3), 2000: refine everything a little
// before anything a lot, the important first.

#include <spheretree/query_scheduler.hpp>

#include <algorithm>
#include <chrono>
#include <limits>

namespace spheretree {

std::size_t QueryScheduler::run(std::span<const ScheduledQuery> queries, const QueryLimits& budget) {
  using Clock = std::chrono::steady_clock;
  const bool timed = budget.microseconds < std::numeric_limits<float>::infinity();
  const Clock::time_point start = timed ? Clock::now() : Clock::time_point{};
  order_.resize(queries.size());
  for (std::size_t i = 0; i < queries.size(); ++i) order_[i] = static_cast<std::uint32_t>(i);
  std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (queries[a].relevance > queries[b].relevance) return true;
    if (queries[b].relevance > queries[a].relevance) return false;
    return a < b;
  });
  QueryLimits left = budget;
  bool spent = budget.sphereTests == 0;
  const auto levels = std::min(budget.deepestLevel, static_cast<std::uint32_t>(kMaxQueryLevels - 1));
  for (std::uint32_t level = std::min(levels, 1U); level <= levels && !spent; ++level) {
    left.deepestLevel = level;
    for (const std::uint32_t i : order_) {
      PairQuery& query = *queries[i].query;
      if (query.complete()) continue;
      const std::uint64_t before = query.sphereTests();
      query.advance(left);
      const std::uint64_t tests = query.sphereTests() - before;
      if (budget.sphereTests != QueryLimits::kUnlimited)
        left.sphereTests -= std::min(left.sphereTests, tests);
      if (timed) {
        const std::chrono::duration<float, std::micro> used = Clock::now() - start;
        left.microseconds = budget.microseconds - used.count();
      }
      spent = left.sphereTests == 0 || left.microseconds <= 0;
      if (spent) break;
    }
  }
  // Those that the last level was not reached for stand where an earlier level left them.
  return static_cast<std::size_t>(std::count_if(queries.begin(), queries.end(), [&](const ScheduledQuery& q) {
    return q.query->answerAt(budget.deepestLevel) == Answer::Undecided;
  }));
}

}  // namespace spheretree
