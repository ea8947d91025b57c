// SPDX-License-Identifier: GPL-3.0-or-later
//
// Greedy: V. Chvátal, "A greedy heuristic for the set-covering problem", 1979, with gains that are computed
// anew only when they might still be the largest (M. Minoux 1978). Swaps: C. Gao, T. Weise, J. Li, "A
// weighting-based local search heuristic algorithm for the set covering problem", 2014: of the chosen
// candidates the one that would be missed least goes, for a row that nothing holds the one comes that helps
// most, and rows weigh the more the longer they are left out, which moves the search on where it would go
// round in circles.
#include "builders/set_cover.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace spheretree::builders {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

class SwapSearch {
 public:
  explicit SwapSearch(const CoverTable& table)
      : table_(table), leftOut_(table.candidates().size(), 0), rows_(table.rows().size()) {
    for (std::uint32_t row = 0; row < rows_.size(); ++row) uncover(row);
  }

  std::optional<std::vector<std::uint32_t>> run(const std::vector<std::uint32_t>& start,
                                                const SwapSettings& settings, medial::Random& random,
                                                const medial::Context& context) {
    if (!table_.coverable()) return std::nullopt;
    fill(start, settings.most);
    constexpr std::uint32_t kBetweenChecks = 256;
    for (std::uint32_t step = 1; step <= settings.steps && !uncovered_.empty(); ++step) {
      if (step % kBetweenChecks == 0) context.checkCancelled();
      std::uint32_t out = kNone;
      std::uint32_t slot = used_;
      if (used_ < chosen_.size()) {
        ++used_;
      } else {
        slot = leastMissed(step);
        out = chosen_[slot];
        take(slot);
        leftOut_[out] = step;
      }
      put(slot, mostHelpful(uncovered_[random.next() % uncovered_.size()], out));
      since_[slot] = step;
      for (const std::uint32_t row : uncovered_) ++rows_[row].weight;
    }
    if (!uncovered_.empty()) return std::nullopt;
    chosen_.resize(used_);
    return chosen_;
  }

 private:
  struct Row {
    std::uint32_t held = 0;     // by how many of the chosen balls
    std::uint32_t holders = 0;  // exclusive or of their slots: the slot when there is one
    std::uint32_t weight = 1;
    std::uint32_t place = 0;  // in uncovered_
  };

  /// Takes over the start, less the ones that are missed least when there are too many.
  void fill(const std::vector<std::uint32_t>& start, std::uint32_t most) {
    const std::size_t slots = std::max<std::size_t>(start.size(), most);
    chosen_.assign(slots, kNone);
    loss_.assign(slots, 0);
    since_.assign(slots, 0);
    for (const std::uint32_t candidate : start) put(used_++, candidate);
    while (used_ > most) {
      const std::uint32_t slot = leastMissed(0);
      const std::uint32_t last = chosen_[--used_];
      take(slot);
      if (slot != used_) {
        take(used_);
        put(slot, last);
      }
      chosen_.pop_back();
      loss_.pop_back();
      since_.pop_back();
    }
  }

  /// The slot whose ball alone holds least, by weight; the one filled last stays.
  std::uint32_t leastMissed(std::uint32_t step) const {
    std::uint32_t best = kNone;
    for (std::uint32_t slot = 0; slot < chosen_.size(); ++slot) {
      if (since_[slot] + 1 == step && step > 1 && chosen_.size() > 1) continue;
      if (best == kNone || std::pair(loss_[slot], since_[slot]) < std::pair(loss_[best], since_[best]))
        best = slot;
    }
    return best;
  }

  /// The candidate for a row that adds most weight; of equals the one that was thrown out longest ago.
  std::uint32_t mostHelpful(std::uint32_t row, std::uint32_t tabu) const {
    std::uint32_t best = kNone;
    std::uint32_t bestGain = 0;
    for (const std::uint32_t candidate : table_.candidatesOf(row)) {
      if (candidate == tabu && table_.candidatesOf(row).size() > 1) continue;
      std::uint32_t gain = 0;
      for (const CoverTable::Entry& entry : table_.rowsOf(candidate)) {
        const Row& other = rows_[entry.row];
        gain += other.held == 0 ? other.weight : 0;
      }
      const bool better = gain > bestGain || (gain == bestGain && leftOut_[candidate] < leftOut_[best]);
      if (best == kNone || better) {
        best = candidate;
        bestGain = gain;
      }
    }
    return best;
  }

  void put(std::uint32_t slot, std::uint32_t candidate) {
    chosen_[slot] = candidate;
    loss_[slot] = 0;
    for (const CoverTable::Entry& entry : table_.rowsOf(candidate)) {
      Row& row = rows_[entry.row];
      if (row.held == 0) {
        cover(entry.row);
        loss_[slot] += row.weight;
      } else if (row.held == 1) {
        loss_[row.holders] -= row.weight;
      }
      ++row.held;
      row.holders ^= slot;
    }
  }

  void take(std::uint32_t slot) {
    for (const CoverTable::Entry& entry : table_.rowsOf(chosen_[slot])) {
      Row& row = rows_[entry.row];
      --row.held;
      row.holders ^= slot;
      if (row.held == 0) {
        uncover(entry.row);
      } else if (row.held == 1) {
        loss_[row.holders] += row.weight;
      }
    }
    loss_[slot] = 0;
  }

  void uncover(std::uint32_t row) {
    rows_[row].place = static_cast<std::uint32_t>(uncovered_.size());
    uncovered_.push_back(row);
  }
  void cover(std::uint32_t row) {
    const std::uint32_t last = uncovered_.back();
    uncovered_[rows_[row].place] = last;
    rows_[last].place = rows_[row].place;
    uncovered_.pop_back();
  }

  const CoverTable& table_;
  std::vector<std::uint32_t> chosen_;   // slot -> candidate
  std::vector<std::uint32_t> loss_;     // slot -> weight of the rows that it alone holds
  std::vector<std::uint32_t> since_;    // slot -> the step that filled it
  std::vector<std::uint32_t> leftOut_;  // candidate -> the step that last threw it out
  std::vector<Row> rows_;
  std::vector<std::uint32_t> uncovered_;
  std::uint32_t used_ = 0;
};

}  // namespace

std::optional<std::vector<std::uint32_t>> greedyCover(const CoverTable& table, double standOff,
                                                      std::uint32_t most) {
  const auto candidates = static_cast<std::uint32_t>(table.candidates().size());
  std::vector<bool> held(table.rows().size(), false);
  std::vector<float> limit(candidates);
  const auto gainOf = [&](std::uint32_t c) {
    std::uint32_t gain = 0;
    for (const CoverTable::Entry& entry : table.rowsOf(c)) {
      gain += entry.reachSquared <= limit[c] && !held[entry.row] ? 1U : 0U;
    }
    return gain;
  };
  // The largest gain, then the lowest number, is on top; gains only fall.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> heap;
  for (std::uint32_t c = 0; c < candidates; ++c) {
    limit[c] = table.squaredRadius(c, standOff);
    heap.emplace_back(gainOf(c), ~c);
  }
  std::make_heap(heap.begin(), heap.end());
  std::vector<std::uint32_t> chosen;
  std::size_t left = held.size();
  while (left > 0) {
    if (heap.empty() || chosen.size() == most) return std::nullopt;
    std::pop_heap(heap.begin(), heap.end());
    const std::uint32_t c = ~heap.back().second;
    const std::uint32_t gain = gainOf(c);
    if (gain < heap.back().first) {
      heap.back().first = gain;
      std::push_heap(heap.begin(), heap.end());
      continue;
    }
    heap.pop_back();
    if (gain == 0) return std::nullopt;
    chosen.push_back(c);
    for (const CoverTable::Entry& entry : table.rowsOf(c)) {
      if (entry.reachSquared <= limit[c]) held[entry.row] = true;
    }
    left -= gain;
  }
  return chosen;
}

std::optional<std::vector<std::uint32_t>> coverBySwaps(const CoverTable& table,
                                                       const std::vector<std::uint32_t>& start,
                                                       const SwapSettings& settings, medial::Random& random,
                                                       const medial::Context& context) {
  return SwapSearch(table).run(start, settings, random, context);
}

}  // namespace spheretree::builders
