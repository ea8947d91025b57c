// SPDX-License-Identifier: GPL-3.0-or-later
//
// The Grid builder of G. Bradshaw, "Bounding volume hierarchies for level-of-detail collision handling",
// thesis, Trinity College Dublin, 2002: a regular grid laid over the region in any orientation, each voxel
// that holds something becomes a ball, shrunk to what it covers. Tried: the axes of the mesh, the principal
// axes of the region, random orientations; for each, every number of voxels along the axes that leaves few
// enough of them occupied. What a grid costs is estimated on a few cells, by balls around the boxes of what
// is in each voxel. The best grids are turned and shifted while that helps, and only then get the best balls
// that their voxels can have.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include "builders/even_cells.hpp"
#include "builders/inward.hpp"
#include "builders/reducer.hpp"
#include "medial/min_ball.hpp"
#include "medial/random.hpp"

namespace spheretree::builders {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using medial::Ball;
using medial::CellSet;

double envd(const char* n, double d) { const char* s = getenv(n); return s ? atof(s) : d; }

// A region is mostly hollow: this many more voxels than balls may still leave few enough occupied.
constexpr std::uint32_t kMostVoxelsPerBall = 4;
// Grids that occupy fewer than this share of the balls allowed are not worth a closer look.
constexpr double kLeastUse = 0.5;
// Cells that a grid is judged by.
const std::size_t kSamplesPerBall = std::size_t(envd("GS", 24));
// How many of the best grids are polished.
const std::size_t kFinalists = std::size_t(envd("GF", 3));
const int kPolishRounds = int(envd("GP", 60));
const double kPolishDecay = envd("GD", 0.95);
// Steps that a ball may move to stand off less.
const int kSlideSteps = int(envd("GSL", 4));
const bool kPushEstimate = envd("GPE", 0) > 0;
constexpr double kSlideLength = 0.3;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Grid {
  Matrix3d axes = Matrix3d::Identity();  // rows: the directions of the grid
  std::array<std::uint32_t, 3> count{1, 1, 1};
  Vector3d shift = Vector3d::Zero();  // fraction of a voxel by which the grid starts before the region
};

/// What the balls of a grid stick out.
struct Cost {
  double worst = kInfinity;
  double sum = kInfinity;

  friend bool operator<(const Cost& a, const Cost& b) {
    return std::pair(a.worst, a.sum) < std::pair(b.worst, b.sum);
  }
};

struct Judged {
  Grid grid;
  Cost cost;
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

Vector3d middleOf(const CellSet& cells, std::size_t cell) {
  Vector3d sum = Vector3d::Zero();
  for (const std::uint32_t p : cells.corners(cell)) sum += cells.points()[p];
  return sum / static_cast<double>(cells.corners(cell).size());
}

class GridSearch {
 public:
  explicit GridSearch(const ReduceRequest& request) : request_(request) {
    const CellSet& cells = request.cells;
    for (const std::uint32_t cell : evenCells(cells, kSamplesPerBall * request.maxBalls)) {
      middle_.push_back(middleOf(cells, cell));
      for (const std::uint32_t p : cells.corners(cell)) {
        corner_.push_back(cells.points()[p]);
        cellOf_.push_back(static_cast<std::uint32_t>(middle_.size() - 1));
      }
    }
    turnedCorner_.resize(corner_.size());
    turnedMiddle_.resize(middle_.size());
    voxelOf_.resize(middle_.size());
  }

  std::vector<Ball> run(const GridSettings& settings) {
    medial::Random random(request_.seed);
    std::vector<Matrix3d> orientations{Matrix3d::Identity(), principalAxes(request_.cells.points())};
    for (std::uint32_t i = 0; i < settings.orientations; ++i) orientations.push_back(randomRotation(random));
    for (const Matrix3d& axes : orientations) {
      request_.context.checkCancelled();
      tryOrientation(axes);
    }
    std::vector<Ball> best;
    Cost least;
    for (Judged& finalist : finalists_) {
      request_.context.checkCancelled();
      polish(finalist, random);
      Cost cost;
      std::vector<Ball> balls = fit(finalist.grid, cost);
      if (!(cost < least)) continue;
      least = cost;
      best = std::move(balls);
    }
    return best;
  }

 private:
  void tryOrientation(const Matrix3d& axes) {
    turn(axes);
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
          consider({grid, estimate(axes, occupied, limit())});
        }
      }
    }
  }

  /// What a grid must cost less than to be a finalist.
  [[nodiscard]] Cost limit() const { return finalists_.size() < kFinalists ? Cost{} : finalists_.back().cost; }

  void consider(const Judged& judged) {
    if (!(judged.cost < limit()) && finalists_.size() >= kFinalists) return;
    const auto at = std::upper_bound(finalists_.begin(), finalists_.end(), judged,
                                     [](const Judged& a, const Judged& b) { return a.cost < b.cost; });
    finalists_.insert(at, judged);
    if (finalists_.size() > kFinalists) finalists_.pop_back();
  }

  /// Small turns and shifts, smaller and smaller, kept when they help.
  void polish(Judged& best, medial::Random& random) {
    double step = 0.5;
    for (int round = 0; round < kPolishRounds; ++round) {
      Grid grid = best.grid;
      grid.axes = grid.axes * smallRotation(random, step / 2);
      for (int k = 0; k < 3; ++k) {
        grid.shift[k] = std::clamp(grid.shift[k] + step * random.uniform(-1, 1), 0.0, 1.0);
      }
      turn(grid.axes);
      const std::uint32_t occupied = assign(grid);
      if (occupied <= request_.maxBalls) {
        const Cost cost = estimate(grid.axes, occupied, best.cost);
        if (cost < best.cost) {
          best = {grid, cost};
          continue;
        }
      }
      step *= kPolishDecay;
    }
  }

  /// Places the samples in a turned frame.
  void turn(const Matrix3d& axes) {
    box_.setEmpty();
    for (std::size_t i = 0; i < middle_.size(); ++i) {
      turnedMiddle_[i] = axes * middle_[i];
      box_.extend(turnedMiddle_[i]);
    }
    for (std::size_t i = 0; i < corner_.size(); ++i) turnedCorner_[i] = axes * corner_[i];
  }

  /// The voxel, in a grid of `size` voxels, that a place of the turned frame is in.
  [[nodiscard]] std::size_t voxelAt(const Grid& grid, const std::array<std::uint32_t, 3>& size,
                                    const Vector3d& turned) const {
    std::size_t voxel = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<int>(k);
      const double length = box_.max()[axis] - box_.min()[axis];
      const double local = length > 0 ? (turned[axis] - box_.min()[axis]) / length : 0;
      const double x = std::clamp(local, 0.0, 1.0) * grid.count[k] + grid.shift[axis];
      // Not negative, so truncation is the floor; the far end belongs to the last voxel.
      voxel = voxel * size[k] + std::min(static_cast<std::uint32_t>(x), size[k] - 1);
    }
    return voxel;
  }

  static std::array<std::uint32_t, 3> sizeOf(const Grid& grid) {
    std::array<std::uint32_t, 3> size{};  // a shifted grid needs one more voxel along the axis
    for (std::size_t k = 0; k < 3; ++k) {
      size[k] = grid.count[k] + (grid.shift[static_cast<int>(k)] > 0 ? 1 : 0);
    }
    return size;
  }

  /// Numbers the occupied voxels in voxelOf_ (by sample) and returns how many there are. Stops counting, and
  /// leaves voxelOf_ unfinished, one voxel after too many.
  std::uint32_t assign(const Grid& grid) {
    const std::array<std::uint32_t, 3> size = sizeOf(grid);
    slot_.assign(std::size_t{size[0]} * size[1] * size[2], 0);
    std::uint32_t occupied = 0;
    for (std::size_t i = 0; i < turnedMiddle_.size(); ++i) {
      std::uint32_t& slot = slot_[voxelAt(grid, size, turnedMiddle_[i])];
      if (slot == 0) {
        slot = ++occupied;
        if (occupied > request_.maxBalls) return occupied;
      }
      voxelOf_[i] = slot - 1;
    }
    return occupied;
  }

  /// About what the balls of the last assign() cost; infinite when that is not less than the limit.
  Cost estimate(const Matrix3d& axes, std::uint32_t occupied, const Cost& limit) {
    boxes_.assign(occupied, AlignedBox3d());
    for (std::size_t i = 0; i < turnedCorner_.size(); ++i) boxes_[voxelOf_[cellOf_[i]]].extend(turnedCorner_[i]);
    squaredRadius_.assign(occupied, 0);
    center_.resize(occupied);
    for (std::uint32_t v = 0; v < occupied; ++v) center_[v] = boxes_[v].center();
    for (std::size_t i = 0; i < turnedCorner_.size(); ++i) {
      const std::uint32_t v = voxelOf_[cellOf_[i]];
      squaredRadius_[v] = std::max(squaredRadius_[v], (turnedCorner_[i] - center_[v]).squaredNorm());
    }
    // The largest first: it most likely rules the grid out.
    order_.resize(occupied);
    for (std::uint32_t v = 0; v < occupied; ++v) order_[v] = v;
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
      return squaredRadius_[a] != squaredRadius_[b] ? squaredRadius_[a] > squaredRadius_[b] : a < b;
    });
    Cost cost{0, 0};
    for (const std::uint32_t v : order_) {
      const Vector3d center = axes.transpose() * center_[v];
      double overhang;
      if (kPushEstimate) {
        const Candidate c = pushInward(request_.surface, center);
        double far = 0;
        const Vector3d tc = axes * c.center;
        for (std::size_t i = 0; i < turnedCorner_.size(); ++i) if (voxelOf_[cellOf_[i]] == v) far = std::max(far, (turnedCorner_[i] - tc).squaredNorm());
        overhang = std::sqrt(far) - c.depth;
      } else {
        overhang = std::sqrt(squaredRadius_[v]) - request_.surface.depth(center);
      }
      cost.worst = std::max(cost.worst, overhang);
      cost.sum += overhang;
      if (!(cost < limit)) return {};
    }
    return cost;
  }

  /// The best ball for each voxel that a sample is in. Cells in any other voxel go to the nearest of those.
  std::vector<Ball> fit(const Grid& grid, Cost& cost) {
    turn(grid.axes);
    const std::uint32_t occupied = assign(grid);
    boxes_.assign(occupied, AlignedBox3d());
    for (std::size_t i = 0; i < turnedMiddle_.size(); ++i) boxes_[voxelOf_[i]].extend(turnedMiddle_[i]);
    const CellSet& cells = request_.cells;
    const std::array<std::uint32_t, 3> size = sizeOf(grid);
    std::vector<std::vector<std::uint32_t>> corners(occupied);
    for (std::size_t cell = 0; cell < cells.size(); ++cell) {
      const Vector3d middle = grid.axes * middleOf(cells, cell);
      const std::uint32_t slot = slot_[voxelAt(grid, size, middle)];
      std::vector<std::uint32_t>& own = corners[slot > 0 ? slot - 1 : nearestBox(middle)];
      own.insert(own.end(), cells.corners(cell).begin(), cells.corners(cell).end());
    }
    std::vector<Ball> balls;
    cost = {0, 0};
    std::vector<Vector3d> points;
    for (std::vector<std::uint32_t>& own : corners) {
      std::sort(own.begin(), own.end());
      own.erase(std::unique(own.begin(), own.end()), own.end());
      points.clear();
      for (const std::uint32_t p : own) points.push_back(cells.points()[p]);
      const auto [ball, overhang] = bestBall(points);
      balls.push_back(ball);
      cost.worst = std::max(cost.worst, overhang);
      cost.sum += overhang;
    }
    return balls;
  }

  [[nodiscard]] std::size_t nearestBox(const Vector3d& place) const {
    std::size_t nearest = 0;
    double least = kInfinity;
    for (std::size_t v = 0; v < boxes_.size(); ++v) {
      const double squared = boxes_[v].squaredExteriorDistance(place);
      if (squared >= least) continue;
      least = squared;
      nearest = v;
    }
    return nearest;
  }

  std::pair<Ball, double> bestBall(std::span<const Vector3d> points) const {
    const Ball smallest = medial::minBall(points);
    Candidate best = pushInward(request_.surface, smallest.center);
    double need = pullOn(best, points).need;
    for (const Candidate& place : slide(request_.surface, best, points, {kSlideLength * need, kSlideSteps})) {
      const double other = pullOn(place, points).need;
      if (other >= need) continue;
      need = other;
      best = place;
    }
    // Adding the depth to what is left after taking it away may round down.
    constexpr double kUp = 1 + 4 * std::numeric_limits<double>::epsilon();
    return {{best.center, (best.depth + need) * kUp}, need};
  }

  const ReduceRequest& request_;
  // Of the samples, and of their corners.
  std::vector<Vector3d> middle_;
  std::vector<Vector3d> corner_;
  std::vector<std::uint32_t> cellOf_;
  // The same in the frame of the last turn(), and the box of the middles.
  std::vector<Vector3d> turnedMiddle_;
  std::vector<Vector3d> turnedCorner_;
  AlignedBox3d box_;
  // Voxels of the last assign().
  std::vector<std::uint32_t> voxelOf_;
  std::vector<std::uint32_t> slot_;
  // Scratch of estimate(), by voxel.
  std::vector<AlignedBox3d> boxes_;
  std::vector<Vector3d> center_;
  std::vector<double> squaredRadius_;
  std::vector<std::uint32_t> order_;
  std::vector<Judged> finalists_;  // the best grids so far, best first
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
