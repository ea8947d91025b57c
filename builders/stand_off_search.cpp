// SPDX-License-Identifier: GPL-3.0-or-later
//
// G. Bradshaw, C. O'Sullivan, "Adaptive medial-axis approximation for sphere-tree construction", ACM TOG
// 23(1), 2004, section 5: give every ball the same stand-off, choose the fewest that cover, search the least
// stand-off at which few enough do.
//
// Whether a few balls cover is decided on few cells first, the rows of the cover table, which start as an
// even choice of all cells. A set that holds them is checked against all cells, and the worst cells that it
// misses become rows too: a few dozen per ball are all that matter. From the greedy cover on, the stand-off
// is lowered in steps while swapping candidates still leads to a cover. When it does not, new candidates are
// made around the balls that have to stand off most.
#include "builders/stand_off_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "builders/even_cells.hpp"
#include "builders/mean_swaps.hpp"
#include "builders/set_cover.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;
using medial::Ball;

// Rows per ball to begin with: with fewer, more sets fail the check; with more, every set costs more.
constexpr std::uint32_t kRowsPerBall = 16;
// Halvings of the stand-off after the first at which no start is found; swaps are better at it then.
constexpr int kBisections = 4;
// Candidates are compared at this fraction of the first stand-off, which is up to twice what is needed.
constexpr double kComparedAt = 0.5;
// By how much the stand-off is lowered at a time: at first, and when swaps have failed again and again.
constexpr double kFirstStep = 0.05;
constexpr double kLastStep = 0.008;
constexpr double kStepDecay = 0.7;
// Stand-offs at which no cover was found before the search ends, each followed by new candidates.
constexpr int kRounds = 4;
// Swaps tried at one stand-off. Ten times as many lower the worst overhang by one per cent.
constexpr std::uint32_t kSwapsPerBall = 12;
// How far new candidates are from the ball that they may replace, as a fraction of the stand-off.
constexpr double kFirstMove = 0.3;
constexpr double kMoveDecay = 0.7;
constexpr int kSlideSteps = 5;
// Balls that need at least this fraction of the stand-off get new candidates around them.
constexpr double kBusy = 0.9;
// What single precision can tell, as a fraction of the lengths that it deals with.
constexpr double kRounding = 1e-6;
// Objectives other than the worst overhang may raise it by this factor.
constexpr double kMeanSlack = 1.5;

Eigen::AlignedBox3d boxOf(const medial::CellSet& cells) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& p : cells.points()) box.extend(p);
  return box;
}

}  // namespace

StandOffSearch::StandOffSearch(const ReduceRequest& request)
    : request_(request),
      most_(static_cast<std::uint32_t>(std::min<std::size_t>(request.maxBalls, request.cells.size()))),
      random_(request.seed),
      box_(boxOf(request.cells)),
      size_(box_.diagonal().norm()),
      table_(request.cells, box_.center()),
      blocks_(request.cells, box_.center()),
      standOff_(std::numeric_limits<double>::infinity()) {
  for (const std::uint32_t cell : evenCells(request.cells, std::size_t{kRowsPerBall} * most_))
    table_.addRow(cell);
}

Vector3d StandOffSearch::middleOf(std::uint32_t cell) const {
  const auto corners = request_.cells.corners(cell);
  Vector3d sum = Vector3d::Zero();
  for (const std::uint32_t p : corners) sum += request_.cells.points()[p];
  return sum / static_cast<double>(corners.size());
}

Candidate StandOffSearch::growFrom(std::uint32_t cell) const {
  const medial::Surface& surface = request_.surface;
  const medial::ClosestPoint closest = surface.closestPoint(middleOf(cell));
  // The middle of a piece of the solid knows by itself where the inside is.
  if (closest.distance > kRounding * size_) return pushInward(surface, middleOf(cell));
  const medial::TriangleMesh& mesh = surface.mesh();
  const Vector3d& a = mesh.corner(closest.triangle, 0);
  const Vector3d normal = (mesh.corner(closest.triangle, 1) - a).cross(mesh.corner(closest.triangle, 2) - a);
  return growInward(surface, closest.point, -normal.stableNormalized(), size_ / 2);
}

/// T. Gonzalez 1985: always the best candidate for the row that asks most of the chosen ones. Returns what
/// the rows need.
double StandOffSearch::startFarthestFirst() {
  const std::span<const Candidate> candidates = table_.candidates();
  std::vector<float> least(table_.rows().size(), std::numeric_limits<float>::infinity());
  std::uint32_t next = 0;
  for (std::uint32_t c = 1; c < candidates.size(); ++c) {
    if (candidates[c].depth > candidates[next].depth) next = c;
  }
  chosen_.clear();
  for (;;) {
    chosen_.push_back(next);
    const std::span<const float> reaches = table_.reachesSquared(candidates[next].center);
    const auto depth = static_cast<float>(candidates[next].depth);
    std::uint32_t worst = 0;
    for (std::uint32_t row = 0; row < least.size(); ++row) {
      least[row] = std::min(least[row], std::sqrt(reaches[row]) - depth);
      if (least[row] > least[worst]) worst = row;
    }
    float best = least[worst];
    for (std::uint32_t c = 0; c < candidates.size() && chosen_.size() < most_; ++c) {
      const float standOff = table_.standOffOf(c, worst);
      if (!(standOff < best)) continue;
      best = standOff;
      next = c;
    }
    if (!(best < least[worst])) return static_cast<double>(least[worst]);
  }
}

void StandOffSearch::startGreedily() {
  double high = startFarthestFirst() + kRounding * size_;
  table_.dropDominated(std::max(kComparedAt * high, request_.goodEnough), chosen_);
  table_.setStandOff(std::max(high, request_.goodEnough));
  if (request_.goodEnough > 0) {
    if (auto cover = greedyCover(table_, request_.goodEnough, most_)) {
      startFrom(std::move(*cover), request_.goodEnough);
      return;
    }
  }
  table_.setStandOff(bisect(high, [&](double standOff) {
    auto cover = greedyCover(table_, standOff, most_);
    if (cover) chosen_ = std::move(*cover);
    return cover.has_value();
  }));
}

double StandOffSearch::bisect(double high, const std::function<bool(double)>& succeeds) {
  const double tiny = kRounding * size_;
  double low = 0;
  for (int halvings = 0; halvings < kBisections && high - low > tiny;) {
    const double middle = (low + high) / 2;
    if (succeeds(middle)) {
      high = middle;
    } else {
      low = middle;
    }
    if (low > 0) ++halvings;
  }
  return high;
}

void StandOffSearch::startFrom(std::vector<std::uint32_t> chosen, double standOff) {
  chosen_ = std::move(chosen);
  table_.setStandOff(standOff);
}

std::vector<Candidate> StandOffSearch::chosenBalls() const {
  std::vector<Candidate> balls;
  for (const std::uint32_t c : chosen_) balls.push_back(table_.candidates()[c]);
  return balls;
}

/// What the rows need of the chosen balls, all of which they hold.
double StandOffSearch::leastForRows() const {
  std::vector<float> least(table_.rows().size(), std::numeric_limits<float>::infinity());
  for (const std::uint32_t c : chosen_) {
    const auto depth = static_cast<float>(table_.candidates()[c].depth);
    for (const CoverTable::Entry& entry : table_.rowsOf(c)) {
      least[entry.row] = std::min(least[entry.row], std::sqrt(entry.reachSquared) - depth);
    }
  }
  return static_cast<double>(*std::max_element(least.begin(), least.end()));
}

/// A candidate for every row that is out of reach: there must be one wherever there is surface.
void StandOffSearch::growWhereNothingReaches() {
  for (std::uint32_t row = 0; row < table_.rows().size(); ++row) {
    if (table_.candidatesOf(row).empty()) table_.addCandidate(growFrom(table_.rows()[row]));
  }
}

/// Swaps until at most `most` balls of this stand-off hold all cells; false, and chosen_ as it may be, when
/// that does not work out.
bool StandOffSearch::coverAll(double standOff, std::uint32_t most) {
  table_.setStandOff(standOff);
  for (;;) {
    request_.context.checkCancelled();
    growWhereNothingReaches();
    auto cover = coverBySwaps(table_, chosen_, {most, kSwapsPerBall * most}, random_, request_.context);
    if (!cover) return false;
    chosen_ = std::move(*cover);
    const std::vector<Candidate> balls = chosenBalls();
    double reach = size_;
    for (const Candidate& ball : balls) reach = std::max(reach, ball.depth);
    // Rounding must not turn a row that is held into a cell that is missed.
    const CellBlocks::Check check = blocks_.check(balls, leastForRows(), standOff + kRounding * reach);
    bool added = false;
    for (const std::uint32_t cell : check.worse) added |= table_.addRow(cell);
    if (added) continue;
    standOff_ = check.worst;
    return true;
  }
}

/// Lowers the stand-off until that fails again and again or `floor` is reached.
void StandOffSearch::descend(double floor) {
  const std::vector<std::uint32_t> start = chosen_;
  while (!coverAll(table_.standOff(), most_)) {
    chosen_ = start;
    // At the stand-off that one ball needs, the first swap ends this.
    constexpr double kRaise = 1.1;
    table_.setStandOff(std::max(kRaise * table_.standOff(), table_.standOff() + (kRaise - 1) * size_));
  }
  double step = kFirstStep;
  double move = kFirstMove;
  int failures = 0;
  while (standOff_ > floor) {
    const std::vector<std::uint32_t> before = chosen_;
    const double was = standOff_;
    const double target = std::max(floor, (1 - step) * standOff_);
    if (coverAll(target, most_)) {
      if (!(standOff_ < was - kRounding * kRounding * size_)) break;
      continue;
    }
    chosen_ = before;
    if (failures == kRounds || request_.use == Use::Start) break;
    ++failures;
    enrich(target, move);
    step = std::max(kLastStep, step * kStepDecay);
    move *= kMoveDecay;
  }
}

/// Does without ball after ball while the others can hold all cells at this stand-off.
void StandOffSearch::takeFewest(double standOff) {
  double move = kFirstMove;
  int failures = 0;
  while (chosen_.size() > 1) {
    const std::vector<std::uint32_t> before = chosen_;
    const double was = standOff_;
    if (coverAll(standOff, static_cast<std::uint32_t>(chosen_.size() - 1))) continue;
    chosen_ = before;
    standOff_ = was;
    if (failures == kRounds) break;
    ++failures;
    enrich(standOff, move);
    move *= kMoveDecay;
  }
}

StandOffSearch::Shares StandOffSearch::shares() {
  const std::size_t rows = table_.rows().size();
  Shares shares{std::vector<float>(rows, std::numeric_limits<float>::infinity()),
                std::vector<std::uint32_t>(rows, 0)};
  for (std::uint32_t b = 0; b < chosen_.size(); ++b) {
    const Candidate& ball = table_.candidates()[chosen_[b]];
    const std::span<const float> reaches = table_.reachesSquared(ball.center);
    const auto depth = static_cast<float>(ball.depth);
    for (std::size_t row = 0; row < rows; ++row) {
      const float standOff = std::sqrt(reaches[row]) - depth;
      if (standOff >= shares.least[row]) continue;
      shares.least[row] = standOff;
      shares.owner[row] = b;
    }
  }
  return shares;
}

/// New candidates near the balls that need much, and where a row needs more than the stand-off.
void StandOffSearch::enrich(double standOff, double move) {
  const Shares shares = this->shares();
  std::vector<std::vector<std::uint32_t>> rowsOf(chosen_.size());
  for (std::uint32_t row = 0; row < shares.owner.size(); ++row) rowsOf[shares.owner[row]].push_back(row);
  constexpr double kLeastMove = 1e-3;  // of the region, for a stand-off near zero
  const double length = move * std::max(standOff, kLeastMove * size_);
  for (std::uint32_t ball = 0; ball < rowsOf.size(); ++ball) {
    const std::vector<std::uint32_t>& rows = rowsOf[ball];
    if (rows.empty()) continue;
    const auto lessNeeded = [&](auto a, auto b) { return shares.least[a] < shares.least[b]; };
    const std::uint32_t worst = *std::max_element(rows.begin(), rows.end(), lessNeeded);
    const auto need = static_cast<double>(shares.least[worst]);
    if (need < kBusy * standOff) continue;
    const Candidate center = table_.candidates()[chosen_[ball]];
    for (const Candidate& place : slide(request_.surface, center, cornersOf(rows), {length, kSlideSteps})) {
      table_.addCandidate(place);
    }
    const std::uint32_t cell = table_.rows()[worst];
    jump(center, cornersOf({&worst, 1}), length);
    if (need <= standOff) continue;
    table_.addCandidate(pushInward(request_.surface, (center.center + middleOf(cell)) / 2));
    table_.addCandidate(growFrom(cell));
  }
}

std::vector<Vector3d> StandOffSearch::cornersOf(std::span<const std::uint32_t> rows) const {
  std::vector<std::uint32_t> corners;
  for (const std::uint32_t row : rows) {
    const auto own = request_.cells.corners(table_.rows()[row]);
    corners.insert(corners.end(), own.begin(), own.end());
  }
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  std::vector<Vector3d> points;
  for (const std::uint32_t p : corners) points.push_back(request_.cells.points()[p]);
  return points;
}

/// A candidate at a random place nearer to these points.
void StandOffSearch::jump(const Candidate& ball, std::span<const Vector3d> points, double length) {
  Vector3d turn;
  do {
    for (int k = 0; k < 3; ++k) turn[k] = random_.uniform(-1, 1);
  } while (turn.squaredNorm() > 1);
  const Vector3d place = ball.center + length * (pullOn(ball, points).direction + turn);
  table_.addCandidate(pushInward(request_.surface, place, &ball));
}

void StandOffSearch::lowerMean(double limit) {
  chosen_ = swapForLowerMean(table_, std::move(chosen_), {limit, request_.objective},
                             [&](std::span<const std::uint32_t> chosen) {
                               std::vector<Candidate> balls;
                               for (const std::uint32_t c : chosen) balls.push_back(table_.candidates()[c]);
                               return blocks_.check(balls, limit, limit).worse.empty();
                             });
}

std::vector<Ball> StandOffSearch::finish() {
  descend(std::max(0.0, request_.goodEnough));
  const bool enough = request_.goodEnough > 0 && standOff_ <= request_.goodEnough;
  if (enough) takeFewest(request_.goodEnough);
  if (request_.use == Use::Final) {
    const double slack = request_.objective == Objective::Worst ? 1 + kRounding : kMeanSlack;
    lowerMean(enough ? request_.goodEnough : slack * std::max(0.0, standOff_));
  }
  const std::vector<Candidate> balls = chosenBalls();
  const double standOff = blocks_.standOff(balls);
  // Adding the depth to what is left after taking it away may round down.
  constexpr double kUp = 1 + 4 * std::numeric_limits<double>::epsilon();
  std::vector<Ball> result;
  for (const Candidate& ball : balls) result.push_back({ball.center, (ball.depth + standOff) * kUp});
  return result;
}

}  // namespace spheretree::builders
