// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/cover_table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;

constexpr double kNothing = -std::numeric_limits<double>::infinity();
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// Sets of rows, one bit each, and where their first word with a bit is.
class RowSets {
 public:
  RowSets(std::size_t sets, std::size_t rows)
      : words_((rows + 63) / 64), bits_(words_ * sets, 0), size_(sets, 0), firstWord_(sets, words_) {}

  void insert(std::size_t set, std::uint32_t row) {
    bits_[words_ * set + row / 64] |= std::uint64_t{1} << (row % 64);
    firstWord_[set] = std::min<std::size_t>(firstWord_[set], row / 64);
    ++size_[set];
  }
  [[nodiscard]] std::uint32_t sizeOf(std::size_t set) const { return size_[set]; }
  [[nodiscard]] bool isSubset(std::size_t set, std::size_t of) const {
    const std::uint64_t* a = bits_.data() + words_ * set;
    const std::uint64_t* b = bits_.data() + words_ * of;
    for (std::size_t w = firstWord_[set]; w < words_; ++w) {
      if ((a[w] & ~b[w]) != 0) return false;
    }
    return true;
  }

 private:
  std::size_t words_;
  std::vector<std::uint64_t> bits_;
  std::vector<std::uint32_t> size_;
  std::vector<std::size_t> firstWord_;
};

}  // namespace

CoverTable::CoverTable(const medial::CellSet& cells, const Vector3d& middle)
    : cells_(cells), middle_(middle), entered_(cells.size(), false) {}

std::uint32_t CoverTable::addCandidate(const Candidate& candidate) {
  const auto number = static_cast<std::uint32_t>(candidates_.size());
  candidates_.push_back(candidate);
  centers_.push_back(toPoint32(candidate.center - middle_));
  rowsOf_.emplace_back();
  listRows(number);
  return number;
}

void CoverTable::listRows(std::uint32_t candidate) {
  if (standOff_ == kNothing) return;
  lanes_.farthestSquared(0, rows_.size(), centers_[candidate], reaches_);
  const float limit = squaredRadius(candidate, standOff_);
  for (std::uint32_t row = 0; row < rows_.size(); ++row) {
    if (reaches_[row] <= limit) enter(candidate, row, reaches_[row]);
  }
}

bool CoverTable::addRow(std::uint32_t cell) {
  if (entered_[cell]) return false;
  entered_[cell] = true;
  const auto row = static_cast<std::uint32_t>(rows_.size());
  rows_.push_back(cell);
  std::vector<Point32> corners;
  for (const std::uint32_t p : cells_.corners(cell)) {
    corners.push_back(toPoint32(cells_.points()[p] - middle_));
  }
  lanes_.add(corners);
  candidatesOf_.emplace_back();
  for (std::uint32_t c = 0; c < candidates_.size() && standOff_ != kNothing; ++c) {
    float farthest = 0;
    for (const Point32& p : corners) {
      const float dx = p.x - centers_[c].x;
      const float dy = p.y - centers_[c].y;
      const float dz = p.z - centers_[c].z;
      farthest = std::max(farthest, dx * dx + dy * dy + dz * dz);
    }
    if (farthest <= squaredRadius(c, standOff_)) enter(c, row, farthest);
  }
  return true;
}

void CoverTable::setStandOff(double standOff) {
  if (standOff == standOff_) return;
  const bool lower = standOff < standOff_;
  standOff_ = standOff;
  for (std::vector<std::uint32_t>& list : candidatesOf_) list.clear();
  for (std::uint32_t c = 0; c < candidates_.size(); ++c) {
    if (lower) {
      const float limit = squaredRadius(c, standOff);
      std::erase_if(rowsOf_[c], [limit](const Entry& entry) { return !(entry.reachSquared <= limit); });
      for (const Entry& entry : rowsOf_[c]) candidatesOf_[entry.row].push_back(c);
    } else {
      rowsOf_[c].clear();
      listRows(c);
    }
  }
}

bool CoverTable::coverable() const {
  return std::none_of(candidatesOf_.begin(), candidatesOf_.end(),
                      [](const std::vector<std::uint32_t>& list) { return list.empty(); });
}

float CoverTable::squaredRadius(std::uint32_t candidate, double standOff) const {
  const double radius = candidates_[candidate].depth + standOff;
  return radius >= 0 ? static_cast<float>(radius * radius) : -1.0F;
}

std::span<const float> CoverTable::reachesSquared(const Vector3d& center) {
  lanes_.farthestSquared(0, rows_.size(), toPoint32(center - middle_), reaches_);
  return reaches_;
}

float CoverTable::standOffOf(std::uint32_t candidate, std::uint32_t row) const {
  const double squared = cells_.farthestSquared(rows_[row], candidates_[candidate].center);
  return static_cast<float>(std::sqrt(squared) - candidates_[candidate].depth);
}

void CoverTable::dropDominated(double standOff, std::vector<std::uint32_t>& keep) {
  RowSets sets(candidates_.size(), rows_.size());
  for (std::uint32_t c = 0; c < candidates_.size(); ++c) {
    const float limit = squaredRadius(c, standOff);
    lanes_.farthestSquared(0, rows_.size(), centers_[c], reaches_);
    for (std::uint32_t row = 0; row < rows_.size(); ++row) {
      if (reaches_[row] <= limit) sets.insert(c, row);
    }
  }
  // A set is among those of a larger one or of an equal one with a lower number.
  std::vector<std::uint32_t> order(candidates_.size());
  for (std::uint32_t c = 0; c < order.size(); ++c) order[c] = c;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return sets.sizeOf(a) > sets.sizeOf(b); });
  std::vector<std::uint32_t> kept;
  for (const std::uint32_t c : order) {
    const bool dominated = std::any_of(kept.begin(), kept.end(), [&](auto k) { return sets.isSubset(c, k); });
    if (!dominated && sets.sizeOf(c) > 0) kept.push_back(c);
  }
  kept.insert(kept.end(), keep.begin(), keep.end());
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  keepOnly(kept);
  for (std::uint32_t& c : keep) {
    c = static_cast<std::uint32_t>(std::lower_bound(kept.begin(), kept.end(), c) - kept.begin());
  }
}

void CoverTable::keepOnly(const std::vector<std::uint32_t>& kept) {
  std::vector<std::uint32_t> number(candidates_.size(), kNone);
  for (std::uint32_t i = 0; i < kept.size(); ++i) {
    number[kept[i]] = i;
    if (i == kept[i]) continue;
    candidates_[i] = candidates_[kept[i]];
    centers_[i] = centers_[kept[i]];
    rowsOf_[i] = std::move(rowsOf_[kept[i]]);
  }
  candidates_.resize(kept.size());
  centers_.resize(kept.size());
  rowsOf_.resize(kept.size());
  for (std::vector<std::uint32_t>& list : candidatesOf_) {
    std::erase_if(list, [&](std::uint32_t c) { return number[c] == kNone; });
    for (std::uint32_t& c : list) c = number[c];
  }
}

}  // namespace spheretree::builders
