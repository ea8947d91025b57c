// SPDX-License-Identifier: GPL-3.0-or-later
//
// G. Bradshaw, C. O'Sullivan, "Adaptive medial-axis approximation for sphere-tree construction", ACM TOG
// 23(1), 2004, section 4: where a ball of the approximate axis sticks out too much, the surface point
// nearest to its centre becomes another site. Here the triangulation holds only the sites that touch balls
// near the region: a ball that would have been stopped by a site far away sticks out too much as well, and
// that very place is then inserted. Afterwards the balls are thinned to those that make a difference, and
// gaps between them are closed.
#include "medial/adaptive_axis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>
#include <span>
#include <tuple>
#include <utility>

#include "medial/candidate_balls.hpp"
#include "medial/delaunay.hpp"
#include "medial/near_points.hpp"
#include "medial/parallel.hpp"

namespace spheretree::medial {
namespace {

using Eigen::Vector3d;

constexpr std::uint32_t kNone = Delaunay::kNone;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// More insertions than this, and kInsertionsPerBall for each wanted ball, are a sign of a goal out of
// reach. A region of 200 balls takes about 60.
constexpr std::uint32_t kMostInsertions = 500;
constexpr std::uint32_t kInsertionsPerBall = 2;  // where the solid is thin, a site gives one ball
// An insertion that makes more balls counts as several: a cospherical mesh is rebuilt by each. Balls, because
// the number of tetrahedra without one hangs on rounding where sites are in a plane.
constexpr std::uint32_t kUsualStar = 32;
// No site is added nearer to another one than this fraction of the diagonal.
constexpr double kSeparation = 1e-6;
// Lengths nearer to each other than this fraction of the diagonal are equal, and what comes first is first:
// the order must not hang on rounding.
constexpr double kStep = 1e-9;
// Cells whose middles are considered when sites are missing everywhere.
constexpr std::size_t kSpreadCells = 1024;
// A ball is left out when another one needs at most this fraction of the goal more stand-off: the centres
// of fine samples crowd, and reducers pay for each. Less while fewer than the wanted balls stay, more while
// more than kMostBalls times as many do.
constexpr double kThin = 0.05;
constexpr int kThinSteps = 4;
constexpr std::size_t kMostBalls = 3;
constexpr std::size_t kUsualBalls = 200;  // when nobody says how many are wanted
// Every cell gets a ball that needs no more stand-off than this fraction of the goal. No set of balls is
// better than the best ball for each single cell, and sets often stick out less than the goal.
constexpr double kGapStandOff = 0.3;
constexpr std::uint32_t kCancelStep = 64;
// Far above the relative rounding of distances, far below that of rough ones.
constexpr double kRounding = 1e-9;

using SiteKey = std::array<std::uint32_t, 4>;

/// The greatest distance of a cell's corner from the middle of the cell.
double largestRadius(const CellSet& cells) {
  double largest = 0;
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    largest = std::max(largest, cells.farthestSquared(cell, middleOf(cells, cell)));
  }
  return std::sqrt(largest);
}

/// What belongs to a region: places near the corners of its cells. Without cells, everything does.
class Reach {
 public:
  explicit Reach(const CellSet* cells)
      : everywhere_(cells == nullptr),
        corners_(everywhere_ ? std::span<const Vector3d>() : cells->points()) {}
  /// Not for several threads at once, unless there are no cells.
  [[nodiscard]] bool within(const Vector3d& place, double distance) {
    return everywhere_ || corners_.anyWithin(place, distance, last_);
  }

 private:
  bool everywhere_;
  std::size_t last_ = 0;  // the corner that was near: it often is near the next place too
  NearPoints corners_;
};

/// The middles of a region's cells that are farthest from the sites.
class Spread {
 public:
  explicit Spread(const CellSet& cells) {
    const std::size_t stride = (cells.size() + kSpreadCells - 1) / kSpreadCells;
    for (std::size_t i = 0; i < cells.size(); i += stride) middles_.push_back({middleOf(cells, i)});
  }

  /// Each point is handed out once; `step`: lengths nearer to each other than this are equal.
  [[nodiscard]] std::optional<Vector3d> takeFarthest(std::span<const SurfaceSample> sites, double step) {
    for (; sitesSeen_ < sites.size(); ++sitesSeen_) {
      for (Middle& middle : middles_) {
        middle.distance = std::min(middle.distance, (middle.place - sites[sitesSeen_].point).norm());
      }
    }
    Middle* farthest = nullptr;
    double limit = 0;
    for (Middle& middle : middles_) {
      if (middle.distance <= limit) continue;
      farthest = &middle;
      limit = middle.distance + step;
    }
    if (farthest == nullptr) return std::nullopt;
    farthest->distance = 0;
    return farthest->place;
  }

 private:
  struct Middle {
    Vector3d place;
    double distance = kInfinity;  // to the sites seen
  };
  std::vector<Middle> middles_;
  std::size_t sitesSeen_ = 0;
};

class Refiner {
 public:
  /// `cells` may be null: then everything belongs to the region.
  Refiner(const Surface& surface, const CellSet* cells, const AxisGoal& goal, const Context& context)
      : surface_(surface),
        frame_(surface),
        context_(context),
        cells_(cells),
        reach_(cells),
        leastBalls_(goal.leastBalls),
        separation_(kSeparation * surface.diagonal()),
        step_(kStep * surface.diagonal()),
        overhang_(std::max(goal.overhang, separation_)),
        slack_(cells == nullptr ? overhang_ : std::max(overhang_, largestRadius(*cells))),
        mostInsertions_(kMostInsertions + kInsertionsPerBall * goal.leastBalls),
        mostBalls_(kMostBalls * std::max<std::size_t>(kUsualBalls, goal.leastBalls)) {}

  RegionAxis unrefined(std::vector<SurfaceSample> sites) {
    triangulate(std::move(sites));
    return finish();
  }

  RegionAxis refined(const RegionAxis& parent) {
    parent_ = &parent;
    triangulate(inheritedSites());
    Spread spread(*cells_);
    for (;;) {
      reduceOverhang();
      const std::size_t balls = countBalls();
      if (balls >= leastBalls_ || !addSpreadSites(spread, leastBalls_ - balls)) break;
    }
    return finish();
  }

 private:
  struct Candidate {
    MedialBall ball;  // depth 0: there is none, or none near the region
    ClosestPoint nearest;
  };

  struct Task {
    std::int64_t overhang;  // in steps
    SiteKey key;
    std::uint32_t tetrahedron;
    /// std::priority_queue serves the greatest: the largest overhang, then the earliest sites.
    bool operator<(const Task& other) const {
      return std::tie(overhang, other.key) < std::tie(other.overhang, key);
    }
  };

  // Sites and tetrahedra
  // -------------------------------------------------------------------------------------

  /// The parent's sites that touch balls near the region, that lie in it, and a few around everything, so
  /// that the region is inside the hull.
  std::vector<SurfaceSample> inheritedSites() {
    const std::vector<SurfaceSample>& all = parent_->sites;
    std::vector<bool> wanted(all.size(), false);
    for (const AxisTetrahedron& tetrahedron : parent_->tetrahedra) {
      const Ball& ball = tetrahedron.ball.ball;
      if (!reach_.within(ball.center, ball.radius + slack_)) continue;
      for (const std::uint32_t site : tetrahedron.sites) wanted[site] = true;
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!wanted[i]) wanted[i] = reach_.within(all[i].point, slack_);
    }
    markExtremes(all, wanted);
    std::vector<SurfaceSample> sites;
    for (std::uint32_t i = 0; i < all.size(); ++i) {
      if (!wanted[i]) continue;
      sites.push_back(all[i]);
      parentSite_.push_back(i);
    }
    return sites;
  }

  static void markExtremes(const std::vector<SurfaceSample>& sites, std::vector<bool>& wanted) {
    static const std::array<Vector3d, 7> kDirections{Vector3d{1, 0, 0}, {0, 1, 0},  {0, 0, 1}, {1, 1, 1},
                                                     {-1, 1, 1},        {1, -1, 1}, {1, 1, -1}};
    if (sites.empty()) return;
    for (const Vector3d& direction : kDirections) {
      std::size_t low = 0;
      std::size_t high = 0;
      for (std::size_t i = 1; i < sites.size(); ++i) {
        const double along = direction.dot(sites[i].point);
        if (along < direction.dot(sites[low].point)) low = i;
        if (along > direction.dot(sites[high].point)) high = i;
      }
      wanted[low] = true;
      wanted[high] = true;
    }
  }

  void triangulate(std::vector<SurfaceSample> sites) {
    sites_ = std::move(sites);
    points_.reserve(sites_.size());
    for (const SurfaceSample& site : sites_) points_.push_back(frame_.forward(site.point));
    delaunay_.emplace(points_);
    candidates_.resize(delaunay_->size());
    const auto count = static_cast<std::uint32_t>(delaunay_->size());
    if (cells_ == nullptr) {
      // The one axis of everything is made alone; those of the regions share the threads.
      parallelFor((count + kCancelStep - 1) / kCancelStep, context_, [&](std::size_t block) {
        const auto first = static_cast<std::uint32_t>(block) * kCancelStep;
        for (std::uint32_t i = first; i < std::min(count, first + kCancelStep); ++i) measure(i);
      });
    }
    for (std::uint32_t i = 0; i < count; ++i) {
      if (i % kCancelStep == 0) context_.checkCancelled();
      if (cells_ != nullptr) measure(i);
      enlist(i);
    }
  }

  SiteKey keyOf(std::uint32_t tetrahedron) const {
    SiteKey key = delaunay_->corners(tetrahedron);
    std::sort(key.begin(), key.end());
    return key;
  }

  /// Finds the ball of a tetrahedron if it has one near the region. Writes its own candidate only.
  void measure(std::uint32_t tetrahedron) {
    const SiteKey key = keyOf(tetrahedron);
    Candidate& candidate = candidates_[tetrahedron];
    if (const AxisTetrahedron* known = findInParent(key); known != nullptr) {
      candidate = {known->ball, known->nearest};
      return;
    }
    const std::optional<Ball> ball =
        circumscribedBall({points_[key[0]], points_[key[1]], points_[key[2]], points_[key[3]]});
    if (!ball) return;
    const Vector3d center = frame_.backward(ball->center);
    const double radius = frame_.scale * ball->radius;
    if (!surface_.bounds().contains(center) || !reach_.within(center, radius + slack_)) return;
    if (!surface_.inside(center)) return;
    ClosestPoint nearest = surface_.roughlyClosestPoint(center);
    // Sites are on the surface, so the surface cannot be farther than the nearest of them.
    const SurfaceSample& site = sites_[key[0]];
    const double toSite = (site.point - center).norm();
    if (toSite < nearest.distance * (1 - kRounding)) nearest = {site.point, toSite, site.triangle};
    if (!(nearest.distance > 0) || nearest.distance > radius * (1 + kCircumsphere)) return;
    candidate = {{{center, radius}, nearest.distance}, nearest};
  }

  const AxisTetrahedron* findInParent(const SiteKey& key) const {
    if (key.back() >= parentSite_.size()) return nullptr;
    const SiteKey wanted{parentSite_[key[0]], parentSite_[key[1]], parentSite_[key[2]], parentSite_[key[3]]};
    const auto& known = parent_->tetrahedra;
    const auto found = std::lower_bound(
        known.begin(), known.end(), wanted,
        [](const AxisTetrahedron& tetrahedron, const SiteKey& k) { return tetrahedron.sites < k; });
    return found != known.end() && found->sites == wanted ? &*found : nullptr;
  }

  /// Notes a ball of the region, and whether it sticks out too much.
  void enlist(std::uint32_t tetrahedron) {
    const MedialBall& ball = candidates_[tetrahedron].ball;
    if (!(ball.depth > 0) || !reach_.within(ball.ball.center, ball.depth + slack_)) return;
    inRegion_.push_back(tetrahedron);
    const double overhang = ball.ball.radius - ball.depth;
    if (overhang <= overhang_) return;
    queue_.push({std::llround(overhang / step_), keyOf(tetrahedron), tetrahedron});
  }

  // Refinement
  // -----------------------------------------------------------------------------------------------

  /// Adds a site. `near`: as for Delaunay::insert.
  void insert(const SurfaceSample& site, std::uint32_t near) {
    const auto index = static_cast<std::uint32_t>(sites_.size());
    const Vector3d point = frame_.forward(site.point);
    const Delaunay::Change change = delaunay_->insert(point, index, near);
    ++insertions_;
    context_.checkCancelled();
    if (change.created.empty()) return;
    sites_.push_back(site);
    points_.push_back(point);
    candidates_.resize(delaunay_->size());
    std::uint32_t balls = 0;
    for (const std::uint32_t tetrahedron : change.created) {
      measure(tetrahedron);
      enlist(tetrahedron);
      balls += candidates_[tetrahedron].ball.depth > 0 ? 1U : 0U;
    }
    insertions_ += balls / kUsualStar;
  }

  /// Inserts until no ball of the region sticks out more than wanted. The nearest point of such a ball is
  /// farther than that from every site, so no two sites come near each other and the loop ends.
  void reduceOverhang() {
    while (!queue_.empty() && insertions_ < mostInsertions_) {
      const std::uint32_t worst = queue_.top().tetrahedron;
      queue_.pop();
      if (!delaunay_->alive(worst)) continue;
      const ClosestPoint& nearest = candidates_[worst].nearest;
      insert({nearest.point, nearest.triangle}, worst);
    }
  }

  /// Sites where the region's cells are farthest from any. False when nothing could be inserted.
  bool addSpreadSites(Spread& spread, std::size_t missingBalls) {
    const std::uint32_t before = insertions_;
    const std::size_t wanted = missingBalls / 2 + 1;
    for (std::size_t i = 0; i < wanted && insertions_ < mostInsertions_; ++i) {
      const std::optional<Vector3d> middle = spread.takeFarthest(sites_, step_);
      if (!middle) break;
      // Those of solid cells are not on the surface.
      const ClosestPoint nearest = surface_.closestPoint(*middle);
      if (distanceToSites(nearest.point) <= separation_) continue;
      insert({nearest.point, nearest.triangle}, kNone);
    }
    return insertions_ > before;
  }

  double distanceToSites(const Vector3d& place) const {
    double least = kInfinity;
    for (const SurfaceSample& site : sites_) least = std::min(least, (site.point - place).squaredNorm());
    return std::sqrt(least);
  }

  // Result
  // ---------------------------------------------------------------------------------------------------

  void forgetDead() {
    std::erase_if(inRegion_, [&](std::uint32_t tetrahedron) { return !delaunay_->alive(tetrahedron); });
    placeOf_.assign(delaunay_->size(), kNone);
    for (std::uint32_t i = 0; i < inRegion_.size(); ++i) placeOf_[inRegion_[i]] = i;
  }

  /// Place in inRegion_ of the tetrahedron across a facet, or kNone.
  std::uint32_t neighbour(std::uint32_t place, std::size_t corner) const {
    const std::uint32_t across = delaunay_->neighbour(inRegion_[place], corner);
    return across == kNone ? kNone : placeOf_[across];
  }

  /// The number of the circumcentre of each tetrahedron of the region: cospherical ones share one. Numbers
  /// ascend with first places.
  std::vector<std::uint32_t> numberCenters() const {
    std::vector<std::uint32_t> leader(inRegion_.size());
    for (std::uint32_t i = 0; i < leader.size(); ++i) leader[i] = i;
    const auto find = [&](std::uint32_t i) {
      while (leader[i] != i) i = leader[i] = leader[leader[i]];
      return i;
    };
    const auto centerOf = [&](std::uint32_t place) -> const Vector3d& {
      return candidates_[inRegion_[place]].ball.ball.center;
    };
    const double tolerance = kSameCenter * surface_.diagonal();
    for (std::uint32_t i = 0; i < leader.size(); ++i) {
      for (std::size_t k = 0; k < 4; ++k) {
        const std::uint32_t j = neighbour(i, k);
        if (j == kNone || j >= i || (centerOf(i) - centerOf(j)).norm() > tolerance) continue;
        const std::uint32_t a = find(i);
        const std::uint32_t b = find(j);
        leader[std::max(a, b)] = std::min(a, b);
      }
    }
    std::vector<std::uint32_t> number(leader.size());
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < leader.size(); ++i) number[i] = find(i) == i ? count++ : number[find(i)];
    return number;
  }

  /// Balls for the sites of the region that touch none: the solid is thinner there than the sites are
  /// dense. A site on a convex edge has no ball that is worth it.
  std::vector<MedialBall> tangentBalls() {
    std::vector<bool> served(sites_.size(), false);
    for (std::uint32_t i = 0; i < candidates_.size(); ++i) {
      if (!delaunay_->alive(i) || !(candidates_[i].ball.depth > 0)) continue;
      for (const std::uint32_t site : delaunay_->corners(i)) served[site] = true;
    }
    tangent_.resize(sites_.size());
    std::vector<MedialBall> balls;
    for (std::uint32_t i = 0; i < sites_.size(); ++i) {
      if (served[i] || !reach_.within(sites_[i].point, slack_)) continue;
      if (!tangent_[i]) tangent_[i] = tangentBall(surface_, sites_[i]);
      if (tangent_[i]->radius > separation_) balls.push_back({*tangent_[i], tangent_[i]->radius});
    }
    return balls;
  }

  std::size_t countBalls() {
    forgetDead();
    const std::vector<std::uint32_t> number = numberCenters();
    const std::size_t centers = number.empty() ? 0 : *std::max_element(number.begin(), number.end()) + 1U;
    return centers + tangentBalls().size();
  }

  /// Puts the tetrahedra of the region in the order of their sites, however they came about.
  std::vector<AxisTetrahedron> orderTetrahedra() {
    forgetDead();
    std::vector<std::pair<SiteKey, std::uint32_t>> order;
    order.reserve(inRegion_.size());
    for (const std::uint32_t tetrahedron : inRegion_) order.emplace_back(keyOf(tetrahedron), tetrahedron);
    std::sort(order.begin(), order.end());
    std::vector<AxisTetrahedron> tetrahedra;
    tetrahedra.reserve(order.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) {
      const auto& [key, tetrahedron] = order[i];
      inRegion_[i] = tetrahedron;
      placeOf_[tetrahedron] = i;
      tetrahedra.push_back({key, candidates_[tetrahedron].ball, candidates_[tetrahedron].nearest});
    }
    return tetrahedra;
  }

  RegionAxis finish() {
    std::vector<AxisTetrahedron> tetrahedra = orderTetrahedra();
    const std::vector<std::uint32_t> center = numberCenters();
    std::vector<MedialBall> balls;
    for (std::uint32_t i = 0; i < center.size(); ++i) {
      if (center[i] == balls.size()) balls.push_back(tetrahedra[i].ball);
    }
    const std::size_t centers = balls.size();
    const std::vector<MedialBall> tangent = tangentBalls();
    balls.insert(balls.end(), tangent.begin(), tangent.end());

    MedialAxis axis;
    std::vector<std::uint32_t> number = standIns(balls);  // first in `balls`, then in `axis`
    std::size_t keptCenters = 0;
    for (std::uint32_t i = 0; i < balls.size(); ++i) keptCenters += i < centers && number[i] == i ? 1U : 0U;
    axis.balls = keepStandIns(balls, number);
    for (std::uint32_t i = 0; i < center.size(); ++i) {
      for (std::size_t k = 0; k < 4; ++k) {
        const std::uint32_t j = neighbour(i, k);
        if (j == kNone || j >= i) continue;
        const auto [a, b] = std::minmax(number[center[i]], number[center[j]]);
        if (a != b) axis.neighbours.push_back({a, b});
      }
    }
    const std::vector<MedialBall> gaps = closingBalls(axis.balls);
    axis.balls.insert(axis.balls.end(), gaps.begin(), gaps.end());
    const auto links = linkNearest(axis.balls, keptCenters, step_);
    axis.neighbours.insert(axis.neighbours.end(), links.begin(), links.end());
    std::sort(axis.neighbours.begin(), axis.neighbours.end());
    axis.neighbours.erase(std::unique(axis.neighbours.begin(), axis.neighbours.end()), axis.neighbours.end());
    return {std::move(sites_), std::move(tetrahedra), std::move(axis)};
  }

  /// The balls that stand for themselves; `standIn` becomes the number among them of each ball's stand-in.
  static std::vector<MedialBall> keepStandIns(std::span<const MedialBall> balls,
                                              std::vector<std::uint32_t>& standIn) {
    std::vector<MedialBall> kept;
    std::vector<std::uint32_t> number(balls.size());
    for (std::uint32_t i = 0; i < balls.size(); ++i) {
      if (standIn[i] != i) continue;
      number[i] = static_cast<std::uint32_t>(kept.size());
      kept.push_back(balls[i]);
    }
    for (std::uint32_t& n : standIn) n = number[n];
    return kept;
  }

  /// Which balls stay, and which of them stand for the others.
  std::vector<std::uint32_t> standIns(std::span<const MedialBall> balls) const {
    std::vector<std::uint32_t> all(balls.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    if (cells_ == nullptr || balls.size() <= leastBalls_) return all;
    double tolerance = kThin * overhang_;
    if (auto thinned = thinOut(balls, tolerance, step_, mostBalls_)) {
      for (int i = 0; i < kThinSteps && keptBy(*thinned) < leastBalls_; ++i) {
        tolerance /= 2;
        thinned = thinOut(balls, tolerance, step_, balls.size());
      }
      return keptBy(*thinned) < leastBalls_ ? all : *thinned;
    }
    std::optional<std::vector<std::uint32_t>> fewest;
    while (!fewest) fewest = thinOut(balls, tolerance *= 2, step_, mostBalls_);
    // Between this tolerance and half of it: as many as may be.
    double factor = std::sqrt(0.5);
    for (int i = 0; i < kThinSteps; ++i) {
      if (auto thinned = thinOut(balls, factor * tolerance, step_, mostBalls_)) {
        fewest = std::move(thinned);
        tolerance *= factor;
      }
      factor = std::sqrt(factor);
    }
    return *fewest;
  }

  static std::size_t keptBy(const std::vector<std::uint32_t>& standIn) {
    std::size_t kept = 0;
    for (std::uint32_t i = 0; i < standIn.size(); ++i) kept += standIn[i] == i ? 1U : 0U;
    return kept;
  }

  /// Balls for the cells that lie in no ball of small stand-off; of a larger one when there would be many.
  std::vector<MedialBall> closingBalls(std::span<const MedialBall> balls) const {
    if (cells_ == nullptr) return {};
    // Beyond the radius of the cells each cell is closed, whatever the number.
    double standOff = kGapStandOff * overhang_;
    while (standOff < slack_) {
      const std::size_t most = std::max<std::size_t>(kUsualBalls, leastBalls_);
      if (auto gaps = gapBalls(surface_, *cells_, balls, standOff, most, context_)) return std::move(*gaps);
      standOff *= 2;
    }
    return *gapBalls(surface_, *cells_, balls, slack_, cells_->size(), context_);
  }

  const Surface& surface_;
  UnitFrame frame_;
  const Context& context_;
  const CellSet* cells_;
  Reach reach_;
  std::uint32_t leastBalls_;
  double separation_;  // mesh units, as the following
  double step_;
  double overhang_;  // wanted
  double slack_;     // growth of a ball that may be useful
  std::uint32_t mostInsertions_;
  std::size_t mostBalls_;
  const RegionAxis* parent_ = nullptr;
  std::vector<std::uint32_t> parentSite_;  // of the first sites, ascending
  std::vector<SurfaceSample> sites_;
  std::vector<Vector3d> points_;  // the sites in frame_
  std::optional<Delaunay> delaunay_;
  std::vector<Candidate> candidates_;         // by tetrahedron
  std::vector<std::uint32_t> inRegion_;       // tetrahedra with balls of the region, dead ones among them
  std::vector<std::uint32_t> placeOf_;        // by tetrahedron, in inRegion_
  std::vector<std::optional<Ball>> tangent_;  // by site, where it was asked for
  std::priority_queue<Task> queue_;
  std::uint32_t insertions_ = 0;
};

}  // namespace

RegionAxis coarseAxis(const Surface& surface, std::uint32_t samples, const Context& context) {
  return Refiner(surface, nullptr, {}, context).unrefined(sampleSurface(surface, samples));
}

RegionAxis refineAxis(const Surface& surface, const RegionAxis& parent, const CellSet& cells,
                      const AxisGoal& goal, const Context& context) {
  return Refiner(surface, &cells, goal, context).refined(parent);
}

}  // namespace spheretree::medial
