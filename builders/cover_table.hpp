// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "builders/cell_lanes.hpp"
#include "builders/inward.hpp"
#include "medial/cell_set.hpp"

namespace spheretree::builders {

/// Which ball of one stand-off holds which cell: candidate centres against the cells that were entered.
///
/// Both may be added at any time. The ball of a candidate has radius depth + stand-off; the table lists what
/// such balls hold at the stand-off that was set last. Its size is that of the lists.
class CoverTable {
 public:
  /// A candidate (in the list of a row) or a row (in the list of a candidate), with what the two need.
  struct Entry {
    std::uint32_t row;
    float reachSquared;  ///< to the farthest corner of the row's cell
  };

  /// Coordinates are kept relative to `middle`, which should be that of the region.
  CoverTable(const medial::CellSet& cells, const Eigen::Vector3d& middle);

  /// The number of the candidate.
  std::uint32_t addCandidate(const Candidate& candidate);
  /// Enters a cell unless it was entered before; whether it was not.
  bool addRow(std::uint32_t cell);

  [[nodiscard]] std::span<const Candidate> candidates() const noexcept { return candidates_; }
  [[nodiscard]] std::span<const std::uint32_t> rows() const noexcept { return rows_; }  ///< their cells
  [[nodiscard]] double standOff() const noexcept { return standOff_; }

  /// Sets the stand-off. Lowering it costs a pass over the lists, raising it as much as making them.
  void setStandOff(double standOff);

  [[nodiscard]] std::span<const Entry> rowsOf(std::uint32_t candidate) const { return rowsOf_[candidate]; }
  [[nodiscard]] std::span<const std::uint32_t> candidatesOf(std::uint32_t row) const {
    return candidatesOf_[row];
  }
  /// Whether every row is in the ball of some candidate.
  [[nodiscard]] bool coverable() const;

  /// (depth + standOff)^2 of a candidate's ball; negative when there is no such ball.
  [[nodiscard]] float squaredRadius(std::uint32_t candidate, double standOff) const;
  /// What each row needs: squared distances from a centre to the farthest corners, valid until the next call.
  [[nodiscard]] std::span<const float> reachesSquared(const Eigen::Vector3d& center);
  /// The stand-off at which a candidate's ball holds a row.
  [[nodiscard]] float standOffOf(std::uint32_t candidate, std::uint32_t row) const;

  /// Forgets every candidate whose rows at this stand-off are among those of another one, but for the ones
  /// to keep, and renumbers the rest; these get their new numbers.
  void dropDominated(double standOff, std::vector<std::uint32_t>& keep);

 private:
  void enter(std::uint32_t candidate, std::uint32_t row, float reachSquared) {
    rowsOf_[candidate].push_back({row, reachSquared});
    candidatesOf_[row].push_back(candidate);
  }
  void listRows(std::uint32_t candidate);
  void keepOnly(const std::vector<std::uint32_t>& kept);

  const medial::CellSet& cells_;
  Eigen::Vector3d middle_;
  std::vector<Candidate> candidates_;
  std::vector<Point32> centers_;
  std::vector<std::uint32_t> rows_;
  std::vector<bool> entered_;  // by cell
  CellLanes lanes_;            // by row
  std::vector<std::vector<Entry>> rowsOf_;
  std::vector<std::vector<std::uint32_t>> candidatesOf_;
  double standOff_ = -std::numeric_limits<double>::infinity();
  std::vector<float> reaches_;
};

}  // namespace spheretree::builders
