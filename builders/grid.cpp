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

// A region is mostly hollow: this many more voxels than balls may still leave few enough occupied.
constexpr std::uint32_t kMostVoxelsPerBall = 4;
// Grids that occupy fewer than this share of the balls allowed are not worth a closer look.
constexpr double kLeastUse = 0.5;
// Cells that a grid is judged by.
constexpr std::size_t kFewPerBall = 16;
// Cells that it is judged by when only a few grids are left.
constexpr std::size_t kManyPerBall = 48;
// How many of the best grids are looked at closely, and how many are polished.
constexpr std::size_t kCandidates = 16;
constexpr std::size_t kFinalists = 2;
constexpr int kPolishRounds = 16;
constexpr double kPolishDecay = 0.95;
constexpr double kPolishStep = 0.5;
// Steps that a ball may move to stand off less, and how long they are: a fraction of the stand-off.
constexpr int kSlideSteps = 5;
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

struct Fitted {
  Candidate center;
  double overhang = kInfinity;
};

/// The ball around some points that sticks out little.
Fitted bestBall(const medial::Surface& surface, std::span<const Vector3d> points) {
  Fitted best;
  best.center = pushInward(surface, medial::minBall(points).center);
  best.overhang = pullOn(best.center, points).need;
  for (const Candidate& place :
       slide(surface, best.center, points, {kSlideLength * best.overhang, kSlideSteps})) {
    const double need = pullOn(place, points).need;
    if (need < best.overhang) best = {place, need};
  }
  return best;
}

/// Cells that stand for all of them while grids are compared.
class Samples {
 public:
  Samples(const CellSet& cells, std::size_t count) {
    for (const std::uint32_t cell : evenCells(cells, count)) {
      middle_.push_back(middleOf(cells, cell));
      for (const std::uint32_t p : cells.corners(cell)) {
        corner_.push_back(cells.points()[p]);
        cellOf_.push_back(static_cast<std::uint32_t>(middle_.size() - 1));
      }
    }
    turned_.resize(corner_.size());
    local_.resize(middle_.size());
    voxelOf_.resize(middle_.size());
  }

  /// Turns the samples into the axes of a grid.
  void turn(const Matrix3d& axes) {
    AlignedBox3d box;
    for (std::size_t i = 0; i < middle_.size(); ++i) {
      local_[i] = axes * middle_[i];
      box.extend(local_[i]);
    }
    axes_ = axes;
    origin_ = box.min();
    for (int k = 0; k < 3; ++k) inverse_[k] = box.sizes()[k] > 0 ? 1 / box.sizes()[k] : 0;
    for (Vector3d& p : local_) p = localOf(p);
    for (std::size_t i = 0; i < corner_.size(); ++i) turned_[i] = axes * corner_[i];
  }

  /// Sorts the samples, turned for it, into the voxels of a grid. Returns how many are occupied; stops
  /// counting at one more than `most`, and then the other results are void.
  std::uint32_t assign(const Grid& grid, std::uint32_t most) {
    for (std::size_t k = 0; k < 3; ++k) {
      // A shifted grid needs one more voxel along the axis.
      size_[k] = grid.count[k] + (grid.shift[static_cast<int>(k)] > 0 ? 1 : 0);
    }
    slot_.assign(std::size_t{size_[0]} * size_[1] * size_[2], 0);
    occupied_ = 0;
    for (std::size_t i = 0; i < local_.size(); ++i) {
      std::uint32_t& slot = slot_[voxelAt(grid, local_[i])];
      if (slot == 0) {
        slot = ++occupied_;
        if (occupied_ > most) return occupied_;
      }
      voxelOf_[i] = slot - 1;
    }
    return occupied_;
  }

  /// About what the balls of the last assign() cost; infinite when that is not less than the limit.
  Cost estimate(const medial::Surface& surface, const Cost& limit) {
    measureVoxels();
    Cost cost{0, 0};
    for (const std::uint32_t v : order_) {
      const double overhang = std::sqrt(squaredRadius_[v]) - surface.depth(axes_.transpose() * center_[v]);
      cost.worst = std::max(cost.worst, overhang);
      cost.sum += overhang;
      if (!(cost < limit)) return {};
    }
    return cost;
  }

  /// Boxes what is in each voxel and orders the voxels: the largest first, it most likely rules the grid out.
  void measureVoxels() {
    boxes_.assign(occupied_, AlignedBox3d());
    for (std::size_t i = 0; i < turned_.size(); ++i) boxes_[voxelOf_[cellOf_[i]]].extend(turned_[i]);
    center_.resize(occupied_);
    for (std::uint32_t v = 0; v < occupied_; ++v) center_[v] = boxes_[v].center();
    squaredRadius_.assign(occupied_, 0);
    for (std::size_t i = 0; i < turned_.size(); ++i) {
      const std::uint32_t v = voxelOf_[cellOf_[i]];
      squaredRadius_[v] = std::max(squaredRadius_[v], (turned_[i] - center_[v]).squaredNorm());
    }
    order_.resize(occupied_);
    for (std::uint32_t v = 0; v < occupied_; ++v) order_[v] = v;
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
      return squaredRadius_[a] != squaredRadius_[b] ? squaredRadius_[a] > squaredRadius_[b] : a < b;
    });
  }

  /// What the best balls of the last assign() cost, by the samples; infinite when that is not less than the
  /// limit.
  Cost judge(const medial::Surface& surface, const Cost& limit) {
    measureVoxels();
    Cost cost{0, 0};
    for (const std::uint32_t v : order_) {
      points_.clear();
      for (std::size_t i = 0; i < corner_.size(); ++i) {
        if (voxelOf_[cellOf_[i]] == v) points_.push_back(corner_[i]);
      }
      const Fitted ball = bestBall(surface, points_);
      cost.worst = std::max(cost.worst, ball.overhang);
      cost.sum += ball.overhang;
      if (!(cost < limit)) return {};
    }
    return cost;
  }

  /// All cells by the occupied voxels of the last assign(). Cells in any other voxel go to the nearest of
  /// those.
  [[nodiscard]] std::vector<std::vector<std::uint32_t>> share(const Grid& grid, const CellSet& cells) {
    boxes_.assign(occupied_, AlignedBox3d());
    for (std::size_t i = 0; i < middle_.size(); ++i) boxes_[voxelOf_[i]].extend(axes_ * middle_[i]);
    std::vector<std::vector<std::uint32_t>> shares(occupied_);
    for (std::uint32_t cell = 0; cell < cells.size(); ++cell) {
      const Vector3d middle = axes_ * middleOf(cells, cell);
      const std::uint32_t slot = slot_[voxelAt(grid, localOf(middle))];
      shares[slot > 0 ? slot - 1 : nearestBox(middle)].push_back(cell);
    }
    return shares;
  }

 private:
  /// A place of the turned frame in the unit cube that the middles of the samples fill.
  [[nodiscard]] Vector3d localOf(const Vector3d& turned) const {
    return (turned - origin_).cwiseProduct(inverse_).cwiseMax(0).cwiseMin(1);
  }

  /// The voxel that a place of the unit cube is in.
  [[nodiscard]] std::size_t voxelAt(const Grid& grid, const Vector3d& local) const {
    std::size_t voxel = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<int>(k);
      const double x = local[axis] * grid.count[k] + grid.shift[axis];
      // Not negative, so truncation is the floor; the far end belongs to the last voxel.
      voxel = voxel * size_[k] + std::min(static_cast<std::uint32_t>(x), size_[k] - 1);
    }
    return voxel;
  }

  [[nodiscard]] std::size_t nearestBox(const Vector3d& turned) const {
    std::size_t nearest = 0;
    double least = kInfinity;
    for (std::size_t v = 0; v < boxes_.size(); ++v) {
      const double squared = boxes_[v].squaredExteriorDistance(turned);
      if (squared >= least) continue;
      least = squared;
      nearest = v;
    }
    return nearest;
  }

  std::vector<Vector3d> middle_;
  std::vector<Vector3d> corner_;
  std::vector<std::uint32_t> cellOf_;  // by corner
  // After turn(): the middles in their own unit cube, the corners, and that cube.
  Matrix3d axes_ = Matrix3d::Identity();
  std::vector<Vector3d> local_;
  std::vector<Vector3d> turned_;
  Vector3d origin_ = Vector3d::Zero();
  Vector3d inverse_ = Vector3d::Zero();
  // After assign().
  std::array<std::uint32_t, 3> size_{};
  std::vector<std::uint32_t> slot_;     // by voxel: number among the occupied ones from 1 on, or 0
  std::vector<std::uint32_t> voxelOf_;  // by middle: number among the occupied ones from 0 on
  std::uint32_t occupied_ = 0;
  // Scratch, by occupied voxel.
  std::vector<AlignedBox3d> boxes_;
  std::vector<Vector3d> center_;
  std::vector<double> squaredRadius_;
  std::vector<std::uint32_t> order_;
  std::vector<Vector3d> points_;
};

class GridSearch {
 public:
  explicit GridSearch(const ReduceRequest& request)
      : request_(request),
        few_(request.cells, kFewPerBall * request.maxBalls),
        many_(request.cells, kManyPerBall * request.maxBalls) {}

  std::vector<Ball> run(const GridSettings& settings) {
    medial::Random random(request_.seed);
    std::vector<Matrix3d> orientations{Matrix3d::Identity(), principalAxes(request_.cells.points())};
    for (std::uint32_t i = 0; i < settings.orientations; ++i) orientations.push_back(randomRotation(random));
    for (const Matrix3d& axes : orientations) {
      request_.context.checkCancelled();
      tryOrientation(axes);
    }
    lookClosely();
    std::vector<Ball> best;
    Cost least;
    for (Judged& finalist : candidates_) {
      request_.context.checkCancelled();
      polish(finalist, random);
      auto [balls, cost] = fit(finalist.grid);
      if (!(cost < least)) continue;
      least = cost;
      best = std::move(balls);
    }
    return best;
  }

 private:
  void tryOrientation(const Matrix3d& axes) {
    few_.turn(axes);
    const std::uint32_t most = kMostVoxelsPerBall * request_.maxBalls;
    for (std::uint32_t nx = 1; nx <= most; ++nx) {
      for (std::uint32_t ny = 1; nx * ny <= most; ++ny) {
        for (std::uint32_t nz = 1; nx * ny * nz <= most; ++nz) {
          const Grid grid{axes, {nx, ny, nz}, Vector3d::Zero()};
          const std::uint32_t occupied = few_.assign(grid, request_.maxBalls);
          // More voxels along one axis hardly ever occupy fewer: the first overflow ends the row.
          if (occupied > request_.maxBalls) break;
          const bool single = nx * ny * nz == 1;
          if (!single && occupied < kLeastUse * request_.maxBalls) continue;
          const bool full = candidates_.size() == kCandidates;
          const Cost limit = full ? candidates_.back().cost : Cost{};
          insert(candidates_, {grid, few_.estimate(request_.surface, limit)}, kCandidates);
        }
      }
    }
  }

  /// Leaves the candidates that are best by many samples and real balls.
  void lookClosely() {
    std::vector<Judged> finalists;
    for (const Judged& candidate : candidates_) {
      const Cost limit = finalists.size() == kFinalists ? finalists.back().cost : Cost{};
      insert(finalists, {candidate.grid, judge(candidate.grid, limit)}, kFinalists);
    }
    candidates_ = std::move(finalists);
  }

  /// Keeps the best few, best first.
  static void insert(std::vector<Judged>& list, const Judged& judged, std::size_t most) {
    const auto at = std::upper_bound(list.begin(), list.end(), judged,
                                     [](const Judged& a, const Judged& b) { return a.cost < b.cost; });
    list.insert(at, judged);
    if (list.size() > most) list.pop_back();
  }

  /// What a grid costs when one looks closely; infinite when it has too many balls or costs no less than the
  /// limit.
  Cost judge(const Grid& grid, const Cost& limit) {
    many_.turn(grid.axes);
    if (many_.assign(grid, request_.maxBalls) > request_.maxBalls) return {};
    return many_.judge(request_.surface, limit);
  }

  /// Small turns and shifts, smaller and smaller, kept when they help.
  void polish(Judged& best, medial::Random& random) {
    double step = kPolishStep;
    for (int round = 0; round < kPolishRounds; ++round) {
      Grid grid = best.grid;
      grid.axes = grid.axes * smallRotation(random, step / 2);
      for (int k = 0; k < 3; ++k) {
        grid.shift[k] = std::clamp(grid.shift[k] + step * random.uniform(-1, 1), 0.0, 1.0);
      }
      const Cost cost = judge(grid, best.cost);
      if (cost < best.cost) {
        best = {grid, cost};
      } else {
        step *= kPolishDecay;
      }
    }
  }

  /// The best balls that the voxels can have, by all cells.
  std::pair<std::vector<Ball>, Cost> fit(const Grid& grid) {
    many_.turn(grid.axes);
    Samples* samples = &many_;
    if (many_.assign(grid, request_.maxBalls) > request_.maxBalls) {
      // Few saw fewer voxels.
      few_.turn(grid.axes);
      few_.assign(grid, request_.maxBalls);
      samples = &few_;
    }
    const CellSet& cells = request_.cells;
    std::vector<Ball> balls;
    Cost cost{0, 0};
    std::vector<std::uint32_t> corners;
    std::vector<Vector3d> points;
    for (const std::vector<std::uint32_t>& share : samples->share(grid, cells)) {
      corners.clear();
      for (const std::uint32_t cell : share) {
        corners.insert(corners.end(), cells.corners(cell).begin(), cells.corners(cell).end());
      }
      std::sort(corners.begin(), corners.end());
      corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
      points.clear();
      for (const std::uint32_t p : corners) points.push_back(cells.points()[p]);
      const Fitted ball = bestBall(request_.surface, points);
      // Adding the depth to what is left after taking it away may round down.
      constexpr double kUp = 1 + 4 * std::numeric_limits<double>::epsilon();
      balls.push_back({ball.center.center, (ball.center.depth + ball.overhang) * kUp});
      cost.worst = std::max(cost.worst, ball.overhang);
      cost.sum += ball.overhang;
    }
    return {std::move(balls), cost};
  }

  const ReduceRequest& request_;
  Samples few_;
  Samples many_;
  std::vector<Judged> candidates_;  // the best grids so far, best first
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
