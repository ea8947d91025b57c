// SPDX-License-Identifier: GPL-3.0-or-later
//
// The Grid builder of G. Bradshaw, "Bounding volume hierarchies for level-of-detail collision handling",
// thesis, Trinity College Dublin, 2002: a regular grid laid over the region in any orientation, each voxel
// that holds something circumscribed with a ball, the ball shrunk to what it covers. Tried: the axes of the
// mesh, the principal axes of the region, random orientations; for each, every number of voxels along the
// axes that leaves few enough of them occupied; then the best one is turned and shifted while that helps.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include "builders/overhang.hpp"
#include "builders/reducer.hpp"
#include "medial/min_ball.hpp"
#include "medial/random.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using medial::Ball;
using medial::CellSet;

// A region is mostly hollow: this many more voxels than balls may still leave few enough occupied.
constexpr std::uint32_t kMostVoxelsPerBall = 4;
// Grids that occupy fewer than this share of the balls allowed are not worth a closer look.
constexpr double kLeastUse = 0.5;
constexpr int kPolishRounds = 24;

struct Grid {
  Matrix3d axes = Matrix3d::Identity();  // rows: the directions of the grid
  std::array<std::uint32_t, 3> count{1, 1, 1};
  Vector3d shift = Vector3d::Zero();  // fraction of a voxel by which the grid starts before the region
};

struct Fitted {
  Grid grid;
  std::vector<Ball> balls;
  double worst = std::numeric_limits<double>::infinity();
  double sum = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool betterThan(const Fitted& other) const {
    return std::pair(worst, sum) < std::pair(other.worst, other.sum);
  }
};

Matrix3d principalAxes(std::span<const Vector3d> points) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& p : points) mean += p / static_cast<double>(points.size());
  Matrix3d covariance = Matrix3d::Zero();
  for (const Vector3d& p : points) covariance += (p - mean) * (p - mean).transpose();
  return Eigen::SelfAdjointEigenSolver<Matrix3d>(covariance).eigenvectors().transpose();
}

/// A point of the unit ball in four dimensions, away from its centre. No sine or cosine on purpose: their
/// last bits differ between machines.
Eigen::Vector4d randomInBall(medial::Random& random) {
  Eigen::Vector4d q;
  do {
    for (int k = 0; k < 4; ++k) q[k] = random.uniform(-1, 1);
  } while (q.squaredNorm() > 1 || q.squaredNorm() < 0.01);
  return q;
}

/// Uniform over all rotations.
Matrix3d randomRotation(medial::Random& random) {
  return Eigen::Quaterniond(randomInBall(random).normalized()).toRotationMatrix();
}

/// A rotation by at most about `angle` radians.
Matrix3d smallRotation(medial::Random& random, double angle) {
  Eigen::Vector4d q = randomInBall(random) * (angle / 2);
  q[3] = 1;  // the real part in Eigen's order
  return Eigen::Quaterniond(q.normalized()).toRotationMatrix();
}

class GridSearch {
 public:
  explicit GridSearch(const ReduceRequest& request)
      : request_(request), stampOf_(request.cells.points().size(), 0) {
    const CellSet& cells = request.cells;
    middle_.reserve(cells.size());
    for (std::size_t cell = 0; cell < cells.size(); ++cell) {
      Vector3d sum = Vector3d::Zero();
      for (const std::uint32_t p : cells.corners(cell)) sum += cells.points()[p];
      middle_.push_back(sum / static_cast<double>(cells.corners(cell).size()));
    }
  }

  std::vector<Ball> run(const GridSettings& settings) {
    medial::Random random(request_.seed);
    std::vector<Matrix3d> orientations{Matrix3d::Identity(), principalAxes(request_.cells.points())};
    for (std::uint32_t i = 0; i < settings.orientations; ++i) orientations.push_back(randomRotation(random));
    for (const Matrix3d& axes : orientations) {
      request_.context.checkCancelled();
      tryOrientation(axes);
    }
    polish(random);
    return best_.balls;
  }

 private:
  void tryOrientation(const Matrix3d& axes) {
    layOut(axes);
    const std::uint32_t most = kMostVoxelsPerBall * request_.maxBalls;
    for (std::uint32_t nx = 1; nx <= most; ++nx) {
      for (std::uint32_t ny = 1; nx * ny <= most; ++ny) {
        for (std::uint32_t nz = 1; nx * ny * nz <= most; ++nz) {
          const Grid grid{axes, {nx, ny, nz}, Vector3d::Zero()};
          const std::uint32_t occupied = assign(grid);
          // More voxels along one axis hardly ever occupy fewer: the first overflow ends the row.
          if (occupied > request_.maxBalls) break;
          const bool single = nx * ny * nz == 1;
          if (!single && occupied < kLeastUse * request_.maxBalls) continue;
          consider(grid, occupied);
        }
      }
    }
  }

  /// Small turns and shifts of the best grid, smaller and smaller, kept when they help.
  void polish(medial::Random& random) {
    double step = 0.5;
    for (int round = 0; round < kPolishRounds; ++round) {
      request_.context.checkCancelled();
      Grid grid = best_.grid;
      grid.axes = grid.axes * smallRotation(random, step / 2);
      for (int k = 0; k < 3; ++k) {
        grid.shift[k] = std::clamp(grid.shift[k] + step * random.uniform(-1, 1), 0.0, 1.0);
      }
      layOut(grid.axes);
      const std::uint32_t occupied = assign(grid);
      if (occupied > request_.maxBalls || !consider(grid, occupied)) step *= 0.9;
    }
  }

  /// Places the cells in a turned frame whose unit cube is the region's bounding box.
  void layOut(const Matrix3d& axes) {
    Eigen::AlignedBox3d box;
    std::vector<Vector3d> turned(middle_.size());
    for (std::size_t i = 0; i < middle_.size(); ++i) {
      turned[i] = axes * middle_[i];
      box.extend(turned[i]);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<int>(k);
      const double size = box.sizes()[axis];
      local_[k].resize(middle_.size());
      for (std::size_t i = 0; i < middle_.size(); ++i) {
        local_[k][i] = size > 0 ? (turned[i][axis] - box.min()[axis]) / size : 0;
      }
    }
  }

  /// Numbers the occupied voxels in voxelOf_ (by cell) and returns how many there are. Stops counting, and
  /// leaves voxelOf_ unfinished, one voxel after too many.
  std::uint32_t assign(const Grid& grid) {
    std::array<std::uint32_t, 3> size{};  // a shifted grid needs one more voxel along the axis
    for (std::size_t k = 0; k < 3; ++k)
      size[k] = grid.count[k] + (grid.shift[static_cast<int>(k)] > 0 ? 1 : 0);
    slot_.assign(std::size_t{size[0]} * size[1] * size[2], 0);
    voxelOf_.resize(middle_.size());
    std::uint32_t occupied = 0;
    for (std::size_t i = 0; i < middle_.size(); ++i) {
      std::array<std::uint32_t, 3> at{};
      for (std::size_t k = 0; k < 3; ++k) {
        // Coordinates are in [0, 1], so truncation is the floor; the far end belongs to the last voxel.
        const double x = local_[k][i] * grid.count[k] + grid.shift[static_cast<int>(k)];
        at[k] = std::min(static_cast<std::uint32_t>(x), size[k] - 1);
      }
      std::uint32_t& slot = slot_[(std::size_t{at[0]} * size[1] + at[1]) * size[2] + at[2]];
      if (slot == 0) {
        slot = ++occupied;
        if (occupied > request_.maxBalls) return occupied;
      }
      voxelOf_[i] = slot - 1;
    }
    return occupied;
  }

  /// Fits a ball to each occupied voxel of the last assign(); keeps the grid when it is the best so far.
  bool consider(const Grid& grid, std::uint32_t occupied) {
    const CellSet& cells = request_.cells;
    std::vector<std::vector<std::uint32_t>> own(occupied);
    for (std::uint32_t cell = 0; cell < cells.size(); ++cell) own[voxelOf_[cell]].push_back(cell);
    Fitted fitted;
    fitted.grid = grid;
    fitted.worst = 0;
    fitted.sum = 0;
    std::vector<Vector3d> points;
    for (const std::vector<std::uint32_t>& voxel : own) {
      points.clear();
      ++stamp_;
      for (const std::uint32_t cell : voxel) {
        for (const std::uint32_t p : cells.corners(cell)) {
          if (stampOf_[p] != stamp_) points.push_back(cells.points()[p]);
          stampOf_[p] = stamp_;
        }
      }
      const Ball ball = medial::minBall(points);
      const double overhang = quickOverhang(request_.surface, ball);
      fitted.worst = std::max(fitted.worst, overhang);
      fitted.sum += overhang;
      if (fitted.worst > best_.worst) return false;
      fitted.balls.push_back(ball);
    }
    if (!fitted.betterThan(best_)) return false;
    best_ = std::move(fitted);
    return true;
  }

  const ReduceRequest& request_;
  std::vector<Vector3d> middle_;
  std::array<std::vector<double>, 3> local_;
  std::vector<std::uint32_t> voxelOf_;
  std::vector<std::uint32_t> slot_;
  std::vector<std::uint32_t> stampOf_;  // point -> the voxel that listed it last
  std::uint32_t stamp_ = 0;
  Fitted best_;
};

class GridReducer final : public Reducer {
 public:
  explicit GridReducer(const GridSettings& settings) : settings_(settings) {}

  [[nodiscard]] std::vector<Ball> reduce(const ReduceRequest& request) const override {
    return GridSearch(request).run(settings_);
  }

 private:
  GridSettings settings_;
};

}  // namespace

std::unique_ptr<Reducer> makeGridReducer(const GridSettings& settings) {
  return std::make_unique<GridReducer>(settings);
}

}  // namespace spheretree::builders
