// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/mean_swaps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spheretree::builders {
namespace {

constexpr int kPasses = 2;
// Changes below this fraction of the sum are noise, and may be undone by the next one.
constexpr double kWorthwhile = 1e-3;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

class MeanSwaps {
 public:
  MeanSwaps(CoverTable& table, std::vector<std::uint32_t> chosen, const MeanGoal& goal)
      : table_(table),
        goal_(goal),
        limit_(static_cast<float>(goal.limit)),
        rows_(table.rows().size()),
        chosen_(std::move(chosen)),
        trial_(rows_),
        need_(chosen_.size()) {
    for (const std::uint32_t c : chosen_) {
      standOffs_.emplace_back(rows_);
      computeStandOffs(c, standOffs_.back());
    }
    first_.resize(rows_);
    second_.resize(rows_);
    for (std::uint32_t row = 0; row < rows_; ++row) rank(row);
  }

  std::vector<std::uint32_t> run(const AcceptCover& accept) {
    table_.setStandOff(goal_.limit);
    for (int pass = 0; pass < kPasses; ++pass) {
      bool changed = false;
      for (std::uint32_t slot = 0; slot < chosen_.size(); ++slot) changed |= improve(slot, accept);
      if (!changed) break;
    }
    return chosen_;
  }

 private:
  struct Choice {
    float standOff = kInfinity;
    std::uint32_t slot = kNone;
  };

  void computeStandOffs(std::uint32_t candidate, std::vector<float>& out) {
    const Candidate& ball = table_.candidates()[candidate];
    const std::span<const float> reaches = table_.reachesSquared(ball.center);
    const auto depth = static_cast<float>(ball.depth);
    for (std::size_t row = 0; row < rows_; ++row) out[row] = std::sqrt(reaches[row]) - depth;
  }

  /// Finds the two slots that ask the least stand-off for a row.
  void rank(std::uint32_t row) {
    Choice first;
    Choice second;
    for (std::uint32_t slot = 0; slot < chosen_.size(); ++slot) {
      const float standOff = standOffs_[slot][row];
      if (standOff < first.standOff) {
        second = first;
        first = {standOff, slot};
      } else if (standOff < second.standOff) {
        second = {standOff, slot};
      }
    }
    first_[row] = first;
    second_[row] = second;
  }

  [[nodiscard]] const Choice& without(std::uint32_t slot, std::uint32_t row) const {
    return first_[row].slot == slot ? second_[row] : first_[row];
  }

  /// What all balls cost when `slot` has these stand-offs.
  double costWith(std::uint32_t slot, std::uint32_t candidate, const std::vector<float>& own) {
    std::fill(need_.begin(), need_.end(), -kInfinity);
    for (std::uint32_t row = 0; row < rows_; ++row) {
      const Choice& rest = without(slot, row);
      const bool mine = own[row] < rest.standOff;
      float& need = need_[mine ? slot : rest.slot];
      need = std::max(need, mine ? own[row] : rest.standOff);
    }
    double cost = 0;
    for (std::uint32_t s = 0; s < need_.size(); ++s) {
      if (need_[s] == -kInfinity) continue;
      const auto overhang = static_cast<double>(std::max(0.0F, need_[s]));
      const double radius = table_.candidates()[s == slot ? candidate : chosen_[s]].depth + overhang;
      cost += goal_.objective == Objective::Volume ? radius * radius * radius : overhang;
    }
    return cost;
  }

  /// The row that no other ball can hold and asks most of the others; kNone when they hold all.
  [[nodiscard]] std::uint32_t hardestWithout(std::uint32_t slot) const {
    std::uint32_t hardest = kNone;
    float most = limit_;
    for (std::uint32_t row = 0; row < rows_; ++row) {
      const float standOff = without(slot, row).standOff;
      if (standOff <= most) continue;
      most = standOff;
      hardest = row;
    }
    return hardest;
  }

  [[nodiscard]] bool holdsWith(std::uint32_t slot, const std::vector<float>& own) const {
    for (std::uint32_t row = 0; row < rows_; ++row) {
      if (own[row] > limit_ && without(slot, row).standOff > limit_) return false;
    }
    return true;
  }

  bool improve(std::uint32_t slot, const AcceptCover& accept) {
    const std::uint32_t hardest = hardestWithout(slot);
    if (hardest == kNone) return false;
    double least = costWith(slot, chosen_[slot], standOffs_[slot]) * (1 - kWorthwhile);
    std::uint32_t best = kNone;
    for (const std::uint32_t candidate : table_.candidatesOf(hardest)) {
      if (candidate == chosen_[slot]) continue;
      computeStandOffs(candidate, trial_);
      if (!holdsWith(slot, trial_)) continue;
      const double cost = costWith(slot, candidate, trial_);
      if (cost >= least) continue;
      least = cost;
      best = candidate;
    }
    if (best == kNone) return false;
    const std::uint32_t before = std::exchange(chosen_[slot], best);
    if (!accept(chosen_)) {
      chosen_[slot] = before;
      return false;
    }
    computeStandOffs(best, standOffs_[slot]);
    for (std::uint32_t row = 0; row < rows_; ++row) {
      const bool ranked = first_[row].slot == slot || second_[row].slot == slot;
      if (ranked || standOffs_[slot][row] < second_[row].standOff) rank(row);
    }
    return true;
  }

  CoverTable& table_;
  MeanGoal goal_;
  float limit_;
  std::size_t rows_;
  std::vector<std::uint32_t> chosen_;          // slot -> candidate
  std::vector<std::vector<float>> standOffs_;  // [slot][row]
  std::vector<Choice> first_;                  // by row
  std::vector<Choice> second_;
  std::vector<float> trial_;
  std::vector<float> need_;  // by slot
};

}  // namespace

std::vector<std::uint32_t> swapForLowerMean(CoverTable& table, std::vector<std::uint32_t> chosen,
                                            const MeanGoal& goal, const AcceptCover& accept) {
  return MeanSwaps(table, std::move(chosen), goal).run(accept);
}

}  // namespace spheretree::builders
