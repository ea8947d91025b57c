// SPDX-License-Identifier: GPL-3.0-or-later
//
// Alternating minimax refinement with a limit of members. Who gets which member is decided for all at once,
// as an assignment within capacities (capacity_assignment.hpp), by a high power of the stand-off, so that the
// worst decides and the others still count.
#include "builders/grouping.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "builders/capacity_assignment.hpp"
#include "medial/parallel.hpp"

namespace spheretree::builders {
namespace {

constexpr double kPower = 8;
// Groups that a member may choose among, the best first; all when that does not suffice.
constexpr std::size_t kMostChoices = 12;
constexpr std::size_t kSweeps = 30;
// Stand-offs beyond this many times the scale all cost the same.
constexpr double kHopeless = 8;
// A sweep that lowers the energy by less than this fraction is the last.
constexpr double kLastGain = 1e-3;

class EvenGrouping {
 public:
  EvenGrouping(const medial::Surface& surface, std::span<const PointBlock> members,
               std::span<const DepthProbe> centers, std::size_t capacity, const FitEffort& effort,
               const medial::Context& context)
      : surface_(surface), members_(members), capacity_(capacity), effort_(effort), context_(context) {
    for (const DepthProbe& center : centers) groups_.push_back({{center, 0}, {}});
  }

  std::vector<Group> run() {
    measure();
    scale_ = leastScale();
    assign();
    fitAll();
    for (std::size_t sweep = 0; sweep < kSweeps; ++sweep) {
      context_.checkCancelled();
      scale_ = worst();
      const double before = energy();
      const std::vector<Group> old = groups_;
      measure();
      assign();
      fitAll();
      const double now = energy();
      if (now > before) groups_ = old;
      if (!(now < before * (1 - kLastGain))) break;
    }
    std::erase_if(groups_, [](const Group& group) { return group.members.empty(); });
    return std::move(groups_);
  }

 private:
  [[nodiscard]] double cost(double standOff) const {
    return std::pow(std::min(kHopeless, std::max(0.0, standOff) / scale_), kPower);
  }

  [[nodiscard]] double worst() const {
    double worst = std::numeric_limits<double>::min();
    for (const Group& group : groups_) {
      if (!group.members.empty()) worst = std::max(worst, group.fit.standOff());
    }
    return worst;
  }

  [[nodiscard]] double energy() const {
    double sum = 0;
    for (const Group& group : groups_) {
      if (!group.members.empty()) sum += cost(group.fit.standOff());
    }
    return sum;
  }

  /// The worst stand-off if there were no limit.
  [[nodiscard]] double leastScale() const {
    double most = std::numeric_limits<double>::min();
    for (const std::vector<double>& needed : needed_) {
      most = std::max(most, *std::min_element(needed.begin(), needed.end()));
    }
    return most;
  }

  void measure() {
    needed_.resize(members_.size());
    medial::parallelFor(members_.size(), context_, [&](std::size_t m) {
      needed_[m].resize(groups_.size());
      for (std::size_t g = 0; g < groups_.size(); ++g) {
        const DepthProbe& center = groups_[g].fit.center;
        needed_[m][g] = std::sqrt(farthestSquared(members_[m], center.at)) - center.depth;
      }
    });
  }

  [[nodiscard]] std::vector<std::vector<Choice>> choices(std::size_t most) const {
    std::vector<std::vector<Choice>> all(members_.size());
    for (std::size_t m = 0; m < members_.size(); ++m) {
      for (std::uint32_t g = 0; g < groups_.size(); ++g) all[m].push_back({g, cost(needed_[m][g])});
      std::sort(all[m].begin(), all[m].end(), [](const Choice& a, const Choice& b) {
        return a.cost < b.cost || (a.cost == b.cost && a.place < b.place);
      });
      all[m].resize(std::min(all[m].size(), most));
    }
    return all;
  }

  void assign() {
    auto places = assignWithinCapacity(choices(kMostChoices), groups_.size(), capacity_);
    if (!places) places = assignWithinCapacity(choices(groups_.size()), groups_.size(), capacity_);
    for (Group& group : groups_) group.members.clear();
    for (std::uint32_t m = 0; m < members_.size(); ++m) groups_[(*places)[m]].members.push_back(m);
  }

  void fitAll() {
    medial::parallelFor(groups_.size(), context_, [&](std::size_t g) {
      PointBlock points;
      for (const std::uint32_t m : groups_[g].members) points.append(members_[m]);
      if (points.size() > 0) groups_[g].fit = fitBall(surface_, points, groups_[g].fit.center, effort_);
    });
  }

  const medial::Surface& surface_;
  std::span<const PointBlock> members_;
  std::size_t capacity_;
  FitEffort effort_;
  const medial::Context& context_;
  std::vector<Group> groups_;
  std::vector<std::vector<double>> needed_;  // stand-off of each member in each group
  double scale_ = 1;
};

}  // namespace

std::vector<Group> groupEvenly(const medial::Surface& surface, std::span<const PointBlock> members,
                               std::span<const DepthProbe> centers, std::size_t capacity,
                               const FitEffort& effort, const medial::Context& context) {
  return EvenGrouping(surface, members, centers, capacity, effort, context).run();
}

std::vector<std::size_t> farApart(std::span<const Eigen::Vector3d> members, std::size_t first,
                                  std::size_t count) {
  std::vector<std::size_t> chosen;
  std::vector<double> distance(members.size(), std::numeric_limits<double>::infinity());
  for (std::size_t next = first; chosen.size() < std::min(count, members.size());) {
    chosen.push_back(next);
    for (std::size_t i = 0; i < members.size(); ++i) {
      distance[i] = std::min(distance[i], (members[i] - members[next]).squaredNorm());
    }
    next = static_cast<std::size_t>(std::max_element(distance.begin(), distance.end()) - distance.begin());
  }
  return chosen;
}

}  // namespace spheretree::builders
