// SPDX-License-Identifier: GPL-3.0-or-later
//
// Successive shortest augmenting paths (R. Busacker, P. Gowen 1961) on the graph of places: an edge from one
// place to another is the cheapest item that may move. Items come one by one; each pushes others on along the
// cheapest way to a place with room, so the assignment so far is always optimal.
#include "builders/capacity_assignment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace spheretree::builders {
namespace {

// Costs in whole numbers: rounding could make a circle of moves look like a gain, for ever.
constexpr double kLargestCost = 1099511627776.0;  // 2^40
constexpr std::int64_t kFar = std::numeric_limits<std::int64_t>::max();
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

class Assignment {
 public:
  Assignment(std::span<const std::vector<Choice>> choices, std::size_t places, std::size_t capacity)
      : choices_(choices.size()),
        capacity_(capacity),
        place_(choices.size(), kNone),
        cost_(choices.size(), 0),
        items_(places) {
    double most = std::numeric_limits<double>::min();
    for (const std::vector<Choice>& list : choices) {
      for (const Choice& choice : list) most = std::max(most, choice.cost);
    }
    for (std::size_t i = 0; i < choices.size(); ++i) {
      for (const Choice& choice : choices[i]) {
        choices_[i].push_back({choice.place, std::llround(choice.cost / most * kLargestCost)});
      }
    }
  }

  bool run() {
    for (std::uint32_t item = 0; item < choices_.size(); ++item) {
      if (!insert(item)) return false;
    }
    return true;
  }

  [[nodiscard]] std::vector<std::uint32_t> result() && { return std::move(place_); }

 private:
  struct WholeChoice {
    std::uint32_t place = 0;
    std::int64_t cost = 0;
  };

  /// How a place is reached: by which item, from where (the item's place before).
  struct Label {
    std::int64_t distance = kFar;
    std::uint32_t item = kNone;
    bool queued = false;
  };

  bool insert(std::uint32_t item) {
    labels_.assign(items_.size(), {});
    queue_.clear();
    for (const WholeChoice& choice : choices_[item]) reach(choice.place, choice.cost, item);
    for (std::size_t head = 0; head < queue_.size(); ++head) {
      const std::uint32_t at = queue_[head];
      labels_[at].queued = false;
      if (items_[at].size() < capacity_) continue;  // a way that could end here need not go on
      const std::int64_t distance = labels_[at].distance;
      for (const std::uint32_t other : items_[at]) {
        for (const WholeChoice& choice : choices_[other]) {
          if (choice.place != at) reach(choice.place, distance + choice.cost - cost_[other], other);
        }
      }
    }
    std::uint32_t end = kNone;
    for (std::uint32_t p = 0; p < items_.size(); ++p) {
      if (items_[p].size() >= capacity_ || labels_[p].item == kNone) continue;
      if (end == kNone || labels_[p].distance < labels_[end].distance) end = p;
    }
    if (end == kNone) return false;
    for (std::uint32_t to = end;;) {
      const std::uint32_t moving = labels_[to].item;
      const std::uint32_t from = place_[moving];
      if (from != kNone) std::erase(items_[from], moving);
      put(moving, to);
      if (from == kNone) return true;
      to = from;
    }
  }

  void reach(std::uint32_t place, std::int64_t distance, std::uint32_t item) {
    Label& label = labels_[place];
    if (distance >= label.distance) return;
    label.distance = distance;
    label.item = item;
    if (label.queued) return;
    label.queued = true;
    queue_.push_back(place);
  }

  void put(std::uint32_t item, std::uint32_t place) {
    place_[item] = place;
    items_[place].push_back(item);
    for (const WholeChoice& choice : choices_[item]) {
      if (choice.place == place) cost_[item] = choice.cost;
    }
  }

  std::vector<std::vector<WholeChoice>> choices_;
  std::size_t capacity_;
  std::vector<std::uint32_t> place_;  // of each item
  std::vector<std::int64_t> cost_;    // of each item where it is
  std::vector<std::vector<std::uint32_t>> items_;
  std::vector<Label> labels_;
  std::vector<std::uint32_t> queue_;
};

}  // namespace

std::optional<std::vector<std::uint32_t>> assignWithinCapacity(std::span<const std::vector<Choice>> choices,
                                                               std::size_t places, std::size_t capacity) {
  Assignment assignment(choices, places, capacity);
  if (!assignment.run()) return std::nullopt;
  return std::move(assignment).result();
}

}  // namespace spheretree::builders
