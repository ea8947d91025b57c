// SPDX-License-Identifier: GPL-3.0-or-later
//
// Top-down construction as in P. Hubbard 1996 and G. Bradshaw, C. O'Sullivan 2004, with cells instead of
// sample points: a region is a set of convex pieces of the surface (and of the solid), each of which is
// wholly inside one child. Cover of every level, and of every chain from the root, then holds by
// construction.
#include "builders/level_driver.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "builders/ancestry.hpp"
#include "builders/fair_cover.hpp"
#include "builders/fit_ball.hpp"
#include "builders/foresight.hpp"
#include "builders/pieces.hpp"
#include "builders/refine.hpp"
#include "builders/region.hpp"
#include "builders/set_error.hpp"
#include "medial/adaptive_axis.hpp"
#include "medial/cell_set.hpp"
#include "medial/min_ball.hpp"
#include "medial/morton.hpp"
#include "medial/parallel.hpp"
#include "medial/random.hpp"
#include "medial/solid_cells.hpp"

namespace spheretree::builders {
namespace {

using Eigen::AlignedBox3d;
using medial::Ball;
using medial::CellSet;
using medial::Surface;
using medial::SurfaceCell;

// Cells are this much shorter than the balls that are expected to cover them: a whole cell across the seam of
// two balls then costs a few per cent of a radius (docs/error-metrics.md).
constexpr double kSurfaceCellSize = 0.2;
constexpr double kSolidCellSize = 0.35;
// Where seams are cut later, coarser pieces will do.
constexpr double kRefineCellSize = 0.4;
// Where only the density of balls counts.
constexpr double kSpreadCellSize = 0.7;

// A rough set's axis has this much error for every one that was asked for, and balls for every one.
constexpr double kRoughError = 2;
constexpr double kRoughBalls = 0.25;

// Surface points of the axis that the first region is refined from.
constexpr std::uint32_t kCoarseSamples = 1000;

// The first level may stick out so many times the least that any of its sets does, for the sake of the
// others.
constexpr double kNearLeast = 1.05;
// How often, and by how much, loads count less where otherwise the level would stick out too far.
constexpr int kSecondChances = 2;
constexpr double kSecondWeight = 0.2;
// First levels differ in how much a load counts: which is best differs from shape to shape.
constexpr std::array<double, 2> kLoadPressures{2, 1.3};
// First levels with even loads are tried with these times the least overhang of the other first levels.
constexpr std::array<double, 4> kFairLimits{0.95, 0.98, 1.01, 1.04};
// Their balls reach as far as they may, so a cell across a seam costs more than elsewhere.
constexpr double kFairCellSize = 0.25;
// Not above what the reducers reached, in spite of rounding.
constexpr double kJustBelow = 0.9999;
// Shares of the progress: of the sketch, and of the rest for looking ahead.
constexpr double kSketchShare = 0.1;
constexpr double kLookShare = 0.4;
// Worth more than any stand-off.
constexpr double kDeeper = 1000;

using Axis = std::shared_ptr<const medial::RegionAxis>;

/// A ball of the last level so far, with what the next one is made from.
struct OpenNode {
  LevelNode node;
  Region region;
  Axis axis;  // of the region above, which this one's is refined from; null when no reducer wants any
  std::size_t winner = 0;  // the reducer that the ball is from
};

/// What the reducers proposed for one node.
struct Proposal {
  std::vector<LevelBall> balls;  // pieces are numbers in the node's own list
  std::vector<Piece> pieces;
  Axis axis;
  std::size_t winner = 0;
  bool refined = false;
};

/// Hands every piece to the ball that needs to stick out least for it, drops balls that get none and shrinks
/// the others to what they got.
std::vector<LevelBall> shareOut(const Surface& surface, const CellSet& set, const std::vector<Ball>& balls) {
  std::vector<LevelBall> level(balls.size());
  for (std::size_t b = 0; b < balls.size(); ++b) {
    level[b].fit.center = probeDepth(surface, balls[b].center);
    level[b].fit.reach = -1;
  }
  for (std::uint32_t piece = 0; piece < set.size(); ++piece) {
    std::size_t best = 0;
    double bestStandOff = std::numeric_limits<double>::infinity();
    double bestReach = 0;
    for (std::size_t b = 0; b < level.size(); ++b) {
      const DepthProbe& center = level[b].fit.center;
      const double reach = std::sqrt(set.farthestSquared(piece, center.at));
      if (reach - center.depth >= bestStandOff) continue;
      bestStandOff = reach - center.depth;
      bestReach = reach;
      best = b;
    }
    level[best].fit.reach = std::max(level[best].fit.reach, bestReach);
    level[best].pieces.push_back(piece);
  }
  std::erase_if(level, [](const LevelBall& ball) { return ball.pieces.empty(); });
  return level;
}

std::vector<Ball> ballsOf(const std::vector<LevelBall>& level) {
  std::vector<Ball> balls;
  for (const LevelBall& ball : level) balls.push_back({ball.fit.center.at, ball.fit.reach});
  return balls;
}

double worstOf(const std::vector<LevelBall>& level) {
  double worst = 0;
  for (const LevelBall& ball : level) worst = std::max(worst, ball.fit.standOff());
  return worst;
}

class LevelDriver {
 public:
  LevelDriver(const Surface& surface, const BuildSettings& settings, std::span<const NamedReducer> reducers,
              const medial::Context& context)
      : surface_(surface),
        settings_(settings),
        reducers_(reducers),
        context_(context),
        goodEnough_(settings.maxError * surface.diagonal()),
        refine_(isOn(settings.refine)),
        link_(isOn(settings.link)),
        foresight_(surface, settings, context) {}

  BallTree run() {
    const bool foreseeing =
        refine_ && link_ && settings_.levels > 2 && settings_.objective == Objective::Worst;
    if (!foreseeing || !buildEffort(settings_.quality).sketch) {
      build(settings_.levels);
      return tree();
    }
    sketching_ = true;
    stretch_ = {0, kSketchShare};
    build(settings_.levels - 1);
    sketching_ = false;
    stretch_ = {kSketchShare, 1};
    if (levels_.size() + 1 < settings_.levels || repeated_) {
      build(settings_.levels);  // some of the shape is done with before the leaves
      return tree();
    }
    foresight_.spread(allPieces(kSpreadCellSize), requestFor(settings_.seed));
    buildLookingAhead();
    return tree();
  }

  /// What the children of the root are chosen from.
  medial::MedialAxis rootAxis() {
    makeRoot();
    OpenNode& root = open_.front();
    if (!root.axis) root.axis = coarseAxis();
    return axisOf(root, cellSetOf(piecesOf(root, kSurfaceCellSize))).axis;
  }

 private:
  using Levels = std::vector<std::vector<LevelNode>>;
  using Winners = std::vector<std::vector<std::pair<std::string, std::size_t>>>;

  [[nodiscard]] BallTree tree() {
    BallTree tree;
    for (const std::vector<LevelNode>& level : levels_) {
      tree.levels.emplace_back();
      for (const LevelNode& node : level) {
        tree.levels.back().push_back({{node.fit.center.at, node.fit.reach}, node.parent, node.maker});
      }
    }
    tree.winners = std::move(winners_);
    return tree;
  }

  /// Sum over the levels of the logarithm of the worst stand-off: levels count alike, whatever their size.
  /// More levels are better than fewer.
  static double score(const Levels& levels) {
    double sum = 0;
    for (std::size_t l = 1; l < levels.size(); ++l) {
      double worst = std::numeric_limits<double>::min();
      for (const LevelNode& node : levels[l]) worst = std::max(worst, node.fit.standOff());
      sum += std::log(worst) - kDeeper;
    }
    return sum;
  }

  void build(std::uint32_t levels) {
    begin();
    addLevels(1, levels);
  }

  void begin() {
    levels_.clear();
    winners_.clear();
    open_.clear();
    rivals_.clear();
    nodesSoFar_ = 0;
    makeRoot();
  }

  /// Levels from `depth` on, to fill the stretch of the progress.
  void addLevels(std::uint32_t depth, std::uint32_t levels) {
    const Stretch all = stretch_;
    const double share = (all.to - all.from) / std::max(1U, levels - std::min(depth, levels));
    while (depth < levels) {
      stretch_.to = stretch_.from + share;
      if (!addLevel()) break;
      stretch_.from = stretch_.to;
      ++depth;
    }
    stretch_ = all;
  }

  /// From where to where the progress goes meanwhile.
  struct Stretch {
    double from = 0;
    double to = 1;
  };

  static Stretch part(const Stretch& whole, std::size_t i, std::size_t count) {
    const double length = (whole.to - whole.from) / static_cast<double>(count);
    const double from = whole.from + length * static_cast<double>(i);
    return {from, from + length};
  }

  /// A tree that is not finished.
  struct State {
    Levels levels;
    Winners winners;
    std::vector<OpenNode> open;
    std::vector<Proposal> makers;
    std::uint64_t nodesSoFar = 0;
    double prospect = 0;
  };

  [[nodiscard]] State state() const { return {levels_, winners_, open_, makers_, nodesSoFar_, prospect_}; }

  void goOnFrom(State state) {
    levels_ = std::move(state.levels);
    winners_ = std::move(state.winners);
    open_ = std::move(state.open);
    makers_ = std::move(state.makers);
    nodesSoFar_ = state.nodesSoFar;
    prospect_ = state.prospect;
  }

  /// What a first level promises is a guess. So the second level is tried below several of them, and the
  /// whole tree below the one that then promises most.
  void buildLookingAhead() {
    const BuildEffort effort = buildEffort(settings_.quality);
    begin();
    const State root = state();
    const std::vector<Proposal> proposals = proposeAll();
    const Stretch all = stretch_;
    const double middle = all.from + kLookShare * (all.to - all.from);
    std::optional<Begun> chosen;
    std::size_t tried = 0;
    for (RefinedLevel& first : firstLevels(proposals)) {
      if (tried >= effort.lookedAhead) break;
      stretch_ = part({all.from, middle}, tried, effort.lookedAhead);
      goOnFrom(root);
      nodesSoFar_ = 1;
      std::vector<Proposal> shared = proposals;
      shareAmongParents(std::move(first), shared);
      if (!takeOver(shared)) continue;
      ++tried;
      State level = state();
      addLevels(2, std::min(settings_.levels, 3U));
      if (!chosen || prospect_ < chosen->second.prospect) chosen = Begun{std::move(level), state()};
    }
    State best = root;
    const std::size_t lessons = settings_.levels > 3 ? effort.lessons : 0;
    for (std::size_t lesson = 0; chosen && lesson <= lessons; ++lesson) {
      stretch_ = part({middle, all.to}, lesson, lessons + 1);
      if (lesson > 0 && !mendSecondLevel(*chosen, lesson)) break;
      goOnFrom(chosen->second);
      addLevels(3, settings_.levels);
      if (score(levels_) < score(best.levels)) best = state();
    }
    goOnFrom(std::move(best));
  }

  /// A tree with its first level, and with its second one.
  struct Begun {
    State first;
    State second;
  };

  /// What the levels so far show about the loads of the second one is taken to heart, and that refined once
  /// more; false when there is nothing to learn.
  bool mendSecondLevel(Begun& tree, std::size_t lesson) {
    if (levels_.size() < 4 || tree.second.levels.size() < 3) return false;
    // A first ball that was left without children is gone, and the others have other numbers.
    if (tree.first.levels[1].size() != tree.second.levels[1].size()) return false;
    foresight_.learn(std::span(levels_).first(4));
    goOnFrom(tree.first);
    std::vector<LevelBall> balls;
    for (const LevelNode& node : tree.second.levels[2]) balls.push_back({node.fit, node.parent, {}, 0});
    LevelProblem problem = problemOf(coarsePieces());
    foresight_.weigh(problem, 2, kLoadPressures.front());
    std::vector<Proposal> proposals = tree.second.makers;
    nodesSoFar_ = tree.second.nodesSoFar;
    shareAmongParents(refined(std::move(problem), std::move(balls), requestFor(settings_.seed + lesson)),
                      proposals);
    if (!takeOver(proposals)) return false;
    tree.second = state();
    return true;
  }

  [[nodiscard]] bool isOn(Toggle toggle) const {
    return toggle == Toggle::Auto ? settings_.builder == "combined" : toggle == Toggle::On;
  }

  void makeRoot() {
    const medial::TriangleMesh& mesh = surface_.mesh();
    // Along a space-filling curve, and so for ever: cells next to each other in a list are near in space.
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const Eigen::Vector3d middle = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3;
      order.emplace_back(medial::mortonCode(middle, surface_.bounds()), t);
    }
    std::sort(order.begin(), order.end());
    OpenNode root;
    std::vector<Eigen::Vector3d> points;
    for (const auto& [code, t] : order) {
      root.region.surface.push_back({mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)});
      points.insert(points.end(), root.region.surface.back().begin(), root.region.surface.back().end());
    }
    if (settings_.cover == Cover::Solid) root.region.cubes.push_back(medial::solidRootCube(surface_));
    const Ball ball = medial::minBall(points);
    root.node.fit = {probeDepth(surface_, ball.center), ball.radius};
    if (std::any_of(reducers_.begin(), reducers_.end(),
                    [](const NamedReducer& named) { return named.reducer->wantsAxis(); })) {
      root.axis = coarseAxis();
    }
    levels_.push_back({root.node});
    winners_.emplace_back();
    open_.push_back(std::move(root));
  }

  [[nodiscard]] Axis coarseAxis() const {
    return std::make_shared<const medial::RegionAxis>(medial::coarseAxis(surface_, kCoarseSamples, context_));
  }

  /// The axis of a node's region, which `set` holds in pieces. Requires node.axis.
  [[nodiscard]] medial::RegionAxis axisOf(const OpenNode& node, const CellSet& set) const {
    double error = settings_.axis.error * node.node.fit.standOff();
    double leastBalls = settings_.axis.leastBalls;
    if (isRough()) {
      error *= kRoughError;
      leastBalls *= kRoughBalls;
    }
    return medial::refineAxis(surface_, *node.axis, set, {error, static_cast<std::uint32_t>(leastBalls)},
                              context_);
  }

  /// False when no ball could be improved: then there is no such level.
  bool addLevel() {
    std::vector<Proposal> proposals = proposeAll();
    if (refine_ && link_) refineTogether(proposals);
    return takeOver(proposals);
  }

  std::vector<Proposal> proposeAll() {
    std::vector<Proposal> proposals(open_.size());
    std::atomic<std::size_t> finished{0};
    const auto progress = [&](double done) {
      context_.report("build", stretch_.from + done * (stretch_.to - stretch_.from));
    };
    medial::parallelFor(open_.size(), context_, [&](std::size_t i) {
      const std::uint64_t seed = medial::Random(settings_.seed, nodesSoFar_ + i).next();
      proposals[i] = propose(open_[i], seed);
      if (refine_ && !link_) refineAlone(open_[i], proposals[i], seed);
      const double done = static_cast<double>(++finished) / static_cast<double>(open_.size());
      progress(refine_ && link_ ? done / 2 : done);
    });
    nodesSoFar_ += open_.size();
    return proposals;
  }

  /// Refinement goes on from the sets; the first level, few balls that all else depends on, starts well.
  [[nodiscard]] Use useOfSets() const {
    const bool start = refine_ && link_ && settings_.objective == Objective::Worst;
    return start && (sketching_ || levels_.size() > 1) ? Use::Start : Use::Final;
  }

  /// Whether the sets of this level are no more than a start: one reducer makes each, on coarse pieces.
  [[nodiscard]] bool isRough() const {
    return useOfSets() == Use::Start && levels_.size() > buildEffort(settings_.quality).carefulLevels;
  }

  /// Whether a reducer is asked for the children of a node.
  [[nodiscard]] bool isAsked(std::size_t reducer, const OpenNode& node) const {
    return !isRough() || reducer == node.winner;
  }

  Proposal propose(const OpenNode& node, std::uint64_t seed) {
    Proposal best;
    const double overhang = node.node.fit.standOff();
    if (overhang > goodEnough_) {
      best.pieces = piecesOf(node, isRough() ? kRefineCellSize : kSurfaceCellSize);
      const CellSet set = cellSetOf(best.pieces);
      medial::RegionAxis own;
      if (node.axis) {
        own = axisOf(node, set);
      }
      best.axis = node.axis ? std::make_shared<const medial::RegionAxis>(std::move(own)) : nullptr;
      const medial::MedialAxis none;
      SetError least;
      for (std::size_t r = 0; r < reducers_.size(); ++r) {
        if (!isAsked(r, node)) continue;
        const std::vector<Ball> balls =
            reducers_[r].reducer->reduce({surface_, set, best.axis ? best.axis->axis : none, settings_.branch,
                                          goodEnough_, settings_.objective, seed, useOfSets(), context_});
        std::vector<LevelBall> level = shareOut(surface_, set, balls);
        const SetError error = setError(surface_, ballsOf(level), settings_.objective);
        const bool wins = best.balls.empty() || error < least;
        if (levels_.size() == 1 && r > 0) rivals_.push_back(wins ? best.balls : level);
        if (!wins) continue;
        least = error;
        best.balls = std::move(level);
        best.winner = r;
      }
      best.refined = worstOf(best.balls) < overhang;
    }
    if (!best.refined) repeat(node, best);
    return best;
  }

  /// Good enough, or nothing better was found: the ball stands for itself on the next level.
  void repeat(const OpenNode& node, Proposal& proposal) const {
    constexpr double kWhole = std::numeric_limits<double>::infinity();
    proposal.pieces = builders::piecesOf(surface_, node.region, {kWhole, kWhole});
    LevelBall same;
    same.fit = node.node.fit;
    for (std::uint32_t i = 0; i < proposal.pieces.size(); ++i) same.pieces.push_back(i);
    proposal.balls = {std::move(same)};
    proposal.axis = node.axis;
    proposal.winner = node.winner;
    proposal.refined = false;
  }

  /// The region of a node in pieces of about a fraction `size` of the balls that are expected to cover it.
  [[nodiscard]] std::vector<Piece> piecesOf(const OpenNode& node, double size) const {
    const double radius = node.node.fit.reach / std::sqrt(static_cast<double>(settings_.branch));
    return builders::piecesOf(surface_, node.region, {size * radius, kSolidCellSize * radius});
  }

  [[nodiscard]] std::vector<Piece> allPieces(double size) const {
    std::vector<Piece> all;
    for (const OpenNode& node : open_) {
      std::vector<Piece> pieces = piecesOf(node, size);
      std::move(pieces.begin(), pieces.end(), std::back_inserter(all));
    }
    return all;
  }

  static CellSet cellSetOf(const std::vector<Piece>& pieces) {
    std::vector<std::span<const Eigen::Vector3d>> cells;
    cells.reserve(pieces.size());
    for (const Piece& piece : pieces) cells.emplace_back(piece.points);
    return CellSet(cells);
  }

  [[nodiscard]] RefineRequest requestFor(std::uint64_t seed) const {
    RefineEffort effort = refineEffort(settings_.quality);
    if (sketching_) effort = sketchEffort();
    if (isRough()) {
      effort.polishFrom = buildEffort(settings_.quality).roughPolishFrom;
      effort.trialsPerBall = buildEffort(settings_.quality).roughTrialsPerBall;
    }
    return {surface_, settings_.objective, goodEnough_, effort, seed, context_};
  }

  void refineAlone(const OpenNode& node, Proposal& proposal, std::uint64_t seed) const {
    if (!proposal.refined) return;
    LevelProblem problem;
    problem.branch = settings_.branch;
    problem.pieces = piecesOf(node, kRefineCellSize);
    problem.allowed.assign(problem.pieces.size(), {0});
    proposal.balls = refineLevel(problem, std::move(proposal.balls), requestFor(seed));
    proposal.pieces = std::move(problem.pieces);
    if (!(worstOf(proposal.balls) < node.node.fit.standOff())) repeat(node, proposal);
  }

  /// A level that was refined, and the pieces that this has cut.
  struct RefinedLevel {
    LevelProblem problem;
    std::vector<LevelBall> balls;
    double prospect = 0;
  };

  [[nodiscard]] RefinedLevel refined(LevelProblem problem, std::vector<LevelBall> balls,
                                     const RefineRequest& request) const {
    RefinedLevel level{std::move(problem), {}, 0};
    level.balls = refineLevel(level.problem, std::move(balls), request);
    level.prospect = foresight_.prospect(level.balls, levels_.size());
    return level;
  }

  /// Whether the level sticks out no more than `limit`, if need be after another chance with loads that count
  /// less, as long as it promises more than `least`.
  [[nodiscard]] bool comesWithin(double limit, RefinedLevel& level, const RefineRequest& request,
                                 double least = std::numeric_limits<double>::infinity()) const {
    for (int less = 0; less < kSecondChances && worstOf(level.balls) > limit; ++less) {
      if (least <= level.prospect) return false;
      level.problem.loadWeight *= kSecondWeight;
      level = refined(std::move(level.problem), std::move(level.balls), request);
    }
    return worstOf(level.balls) <= limit;
  }

  /// The reducers' own sets are what refinement must beat; crowding may be given too much for that.
  [[nodiscard]] RefinedLevel refineGiven(LevelProblem problem, const std::vector<LevelBall>& balls) const {
    const RefineRequest request = requestFor(settings_.seed + nodesSoFar_);
    if (problem.loads.empty()) return refined(std::move(problem), balls, request);
    RefinedLevel level = refined(problem, balls, request);
    if (comesWithin(worstOf(balls), level, request)) return level;
    problem.loads.clear();
    return refined(std::move(problem), balls, request);
  }

  /// First levels that all stick out little, those that promise most for all levels together first.
  [[nodiscard]] std::vector<RefinedLevel> firstLevels(const std::vector<Proposal>& proposals) {
    const std::vector<LevelBall> balls = proposals.front().balls;
    const LevelProblem problem = problemOf(coarsePieces());
    RefineRequest request = requestFor(settings_.seed + 1);
    request.effort = refineEffort(Quality::Normal);
    std::vector<std::vector<LevelBall>> starts{balls};
    std::move(rivals_.begin(), rivals_.end(), std::back_inserter(starts));
    for (std::vector<LevelBall>& even : foresight_.evenSets(balls, buildEffort(settings_.quality).starts)) {
      starts.push_back(std::move(even));
    }
    std::vector<LevelProblem> pressed(buildEffort(settings_.quality).pressures, problem);
    for (std::size_t k = 0; k < pressed.size(); ++k) foresight_.weigh(pressed[k], 1, kLoadPressures[k]);
    std::vector<RefinedLevel> all(pressed.size() * starts.size());
    // Few balls leave threads idle, so levels go side by side.
    medial::parallelFor(all.size(), context_, [&](std::size_t i) {
      all[i] = refined(pressed[i / starts.size()], starts[i % starts.size()], request);
    });
    const auto promising = [](const RefinedLevel& a, const RefinedLevel& b) {
      return a.prospect < b.prospect;
    };
    std::stable_sort(all.begin(), all.end(), promising);
    double limit = worstOf(balls);
    for (const RefinedLevel& level : all) limit = std::min(limit, kNearLeast * worstOf(level.balls));
    const std::size_t wanted = buildEffort(settings_.quality).lookedAhead;
    std::vector<RefinedLevel> good = fairLevels(all, balls);
    std::stable_sort(good.begin(), good.end(), promising);
    if (good.size() >= wanted) return good;
    for (RefinedLevel& level : all) {
      const double least =
          good.size() < wanted ? std::numeric_limits<double>::infinity() : good[wanted - 1].prospect;
      if (!comesWithin(limit, level, request, least)) continue;
      good.push_back(std::move(level));
      std::stable_sort(good.begin(), good.end(), promising);
    }
    if (good.empty()) {
      good.push_back(refined(problem, balls, request));
      if (worstOf(good.front().balls) > worstOf(balls)) good.front() = finePieces(proposals);
    }
    return good;
  }

  /// First levels with even loads that stick out about as much as the least of the others, and no more than
  /// `given`; none where there are more balls than can be looked at. All in pieces that stay whole.
  [[nodiscard]] std::vector<RefinedLevel> fairLevels(const std::vector<RefinedLevel>& others,
                                                     const std::vector<LevelBall>& given) const {
    const BuildEffort effort = buildEffort(settings_.quality);
    const std::vector<DepthProbe> places = foresight_.places();
    if (effort.fairSteps == 0 || settings_.branch > kMostFairBalls || places.empty()) return {};
    const auto flattest = std::min_element(others.begin(), others.end(), [](const auto& a, const auto& b) {
      return worstOf(a.balls) < worstOf(b.balls);
    });
    std::vector<std::vector<DepthProbe>> starts;
    for (const std::vector<LevelBall>* balls : {&others.front().balls, &flattest->balls, &given}) {
      if (starts.size() == effort.fairStarts) break;
      std::vector<DepthProbe>& start = starts.emplace_back();
      for (const LevelBall& ball : *balls) start.push_back(ball.fit.center);
      while (start.size() < settings_.branch) start.push_back(places[start.size() % places.size()]);
    }
    const double most = kJustBelow * worstOf(given);
    std::vector<double> limits;
    for (const double times : kFairLimits) {
      limits.push_back(std::min(most, times * worstOf(flattest->balls)));
      if (limits.back() == most) break;
    }
    LevelProblem problem = problemOf({piecesOf(open_.front(), kFairCellSize)});
    foresight_.weigh(problem, 1, 1);
    std::vector<RefinedLevel> levels(limits.size() * starts.size());
    medial::parallelFor(levels.size(), context_, [&](std::size_t i) {
      const FairCoverRequest request{
          surface_,         problem.pieces,    problem.loads, places, limits[i % limits.size()],
          effort.fairSteps, settings_.seed + i};
      const FairCover cover = fairCover(request, starts[i / limits.size()]);
      if (!cover.complete) return;
      levels[i].problem = problem;
      levels[i].balls = heldBalls(problem, cover.centers, shareFairly(request, cover));
      levels[i].prospect = foresight_.prospect(worstOf(levels[i].balls), cover.load, 1);
    });
    std::erase_if(levels, [](const RefinedLevel& level) { return level.balls.empty(); });
    return levels;
  }

  /// Balls around the pieces that they own.
  static std::vector<LevelBall> heldBalls(const LevelProblem& problem, const std::vector<DepthProbe>& centers,
                                          const std::vector<std::uint32_t>& owner) {
    std::vector<LevelBall> balls(centers.size());
    for (std::size_t b = 0; b < balls.size(); ++b) balls[b].fit.center = centers[b];
    for (std::uint32_t p = 0; p < owner.size(); ++p) {
      LevelBall& ball = balls[owner[p]];
      ball.pieces.push_back(p);
      ball.load += problem.loads[p];
      ball.fit.reach =
          std::max(ball.fit.reach, std::sqrt(farthestSquared(problem.pieces[p], ball.fit.center.at)));
    }
    std::erase_if(balls, [](const LevelBall& ball) { return ball.pieces.empty(); });
    return balls;
  }

  /// The level as one problem; `pieces` are those of each open node.
  [[nodiscard]] LevelProblem problemOf(std::vector<std::vector<Piece>> pieces) const {
    LevelProblem problem;
    problem.branch = settings_.branch;
    problem.parents = open_.size();
    std::vector<std::uint32_t> home;  // of each piece
    for (std::uint32_t i = 0; i < open_.size(); ++i) {
      home.insert(home.end(), pieces[i].size(), i);
      std::move(pieces[i].begin(), pieces[i].end(), std::back_inserter(problem.pieces));
    }
    const auto ancestry = std::make_shared<const Ancestry>(levels_, settings_.objective);
    problem.allowed.resize(problem.pieces.size());
    medial::parallelFor(problem.pieces.size(), context_, [&](std::size_t i) {
      std::vector<std::uint32_t>& allowed = problem.allowed[i];
      allowed = ancestry->holders(problem.pieces[i]);
      const auto at = std::lower_bound(allowed.begin(), allowed.end(), home[i]);
      if (at == allowed.end() || *at != home[i]) allowed.insert(at, home[i]);
    });
    if (problem.parents > 1) {
      problem.allowedPart = [ancestry](const Piece& part, const std::vector<std::uint32_t>& whole) {
        const std::vector<std::uint32_t> result = ancestry->holders(part);
        std::vector<std::uint32_t> both;
        std::set_union(result.begin(), result.end(), whole.begin(), whole.end(), std::back_inserter(both));
        return both;
      };
    }
    return problem;
  }

  /// The regions of all open nodes in pieces that seams can be cut into later.
  [[nodiscard]] std::vector<std::vector<Piece>> coarsePieces() const {
    std::vector<std::vector<Piece>> pieces(open_.size());
    medial::parallelFor(open_.size(), context_,
                        [&](std::size_t i) { pieces[i] = piecesOf(open_[i], kRefineCellSize); });
    return pieces;
  }

  /// The same, of which rough sets have most already; takes them out of the proposals.
  [[nodiscard]] std::vector<std::vector<Piece>> roughPieces(std::vector<Proposal>& proposals) const {
    std::vector<std::vector<Piece>> pieces(proposals.size());
    medial::parallelFor(proposals.size(), context_, [&](std::size_t i) {
      pieces[i] = proposals[i].refined ? std::move(proposals[i].pieces) : piecesOf(open_[i], kRefineCellSize);
    });
    return pieces;
  }

  /// With the pieces that the reducers had, nothing can be lost.
  [[nodiscard]] RefinedLevel finePieces(const std::vector<Proposal>& proposals) const {
    std::vector<std::vector<Piece>> pieces;
    for (const Proposal& proposal : proposals) pieces.push_back(proposal.pieces);
    LevelProblem problem = problemOf(std::move(pieces));
    foresight_.weigh(problem, levels_.size(), kLoadPressures.front());
    return refineGiven(std::move(problem), ballsOfAll(proposals));
  }

  static std::vector<LevelBall> ballsOfAll(const std::vector<Proposal>& proposals) {
    std::vector<LevelBall> balls;
    for (std::uint32_t i = 0; i < proposals.size(); ++i) {
      for (const LevelBall& ball : proposals[i].balls) {
        balls.push_back(ball);
        balls.back().parent = i;
      }
    }
    return balls;
  }

  void refineTogether(std::vector<Proposal>& proposals) {
    const std::vector<LevelBall> given = ballsOfAll(proposals);
    LevelProblem problem = problemOf(isRough() ? roughPieces(proposals) : coarsePieces());
    foresight_.weigh(problem, levels_.size(), kLoadPressures.front());
    RefinedLevel level = refineGiven(std::move(problem), given);
    const bool worse = worstOf(level.balls) > worstOf(given);
    if (worse && !isRough() && !sketching_) level = finePieces(proposals);
    shareAmongParents(std::move(level), proposals);
  }

  /// Replaces what the reducers proposed by the refined level.
  void shareAmongParents(RefinedLevel level, std::vector<Proposal>& proposals) {
    prospect_ = level.prospect;
    for (Proposal& proposal : proposals) {
      proposal.balls.clear();
      proposal.pieces.clear();
    }
    makers_ = proposals;
    for (LevelBall& ball : level.balls) {
      Proposal& proposal = proposals[ball.parent];
      for (std::uint32_t& piece : ball.pieces) {
        proposal.pieces.push_back(std::move(level.problem.pieces[piece]));
        piece = static_cast<std::uint32_t>(proposal.pieces.size() - 1);
      }
      proposal.balls.push_back(std::move(ball));
    }
  }

  bool takeOver(std::vector<Proposal>& proposals) {
    std::vector<std::size_t> wins(reducers_.size(), 0);
    bool refined = false;
    std::vector<OpenNode> next;
    levels_.emplace_back();
    for (std::uint32_t i = 0; i < proposals.size(); ++i) {
      Proposal& proposal = proposals[i];
      if (sketching_ && !proposal.refined) repeated_ = true;
      if (proposal.refined) {
        ++wins[proposal.winner];
        refined = true;
      }
      for (LevelBall& ball : proposal.balls) {
        OpenNode child;
        child.node = {ball.fit, i, proposal.refined ? reducers_[proposal.winner].name : std::string_view()};
        child.axis = proposal.axis;
        child.winner = proposal.winner;
        for (const std::uint32_t piece : ball.pieces) {
          Piece& p = proposal.pieces[piece];
          if (p.triangles.empty()) {
            child.region.cubes.push_back(p.cube);
          } else {
            std::move(p.triangles.begin(), p.triangles.end(), std::back_inserter(child.region.surface));
          }
        }
        levels_.back().push_back(child.node);
        next.push_back(std::move(child));
      }
    }
    if (!refined) {
      levels_.pop_back();
      return false;
    }
    winners_.emplace_back();
    for (std::size_t r = 0; r < reducers_.size(); ++r) {
      if (wins[r] > 0) winners_.back().emplace_back(std::string(reducers_[r].name), wins[r]);
    }
    open_ = std::move(next);
    if (link_ && refine_) settleAncestors();
    return true;
  }

  /// Linking hands pieces across the borders of the levels above: balls left without children go, the others
  /// are fitted to what they have now.
  void settleAncestors() {
    std::vector<PointBlock> points(open_.size());
    for (std::size_t i = 0; i < open_.size(); ++i) {
      for (const SurfaceCell& cell : open_[i].region.surface) {
        for (const Eigen::Vector3d& p : cell) points[i].push(p);
      }
      for (const AlignedBox3d& cube : open_[i].region.cubes) {
        for (const Eigen::Vector3d& p : medial::solidPoints(surface_, cube, surface_.trianglesNear(cube))) {
          points[i].push(p);
        }
      }
    }
    for (std::size_t l = levels_.size() - 1; l-- > 1;) {
      std::vector<LevelNode>& above = levels_[l];
      std::vector<LevelNode>& below = levels_[l + 1];
      std::vector<PointBlock> joined(above.size());
      for (std::size_t i = 0; i < below.size(); ++i) {
        joined[below[i].parent].append(points[i]);
      }
      std::vector<std::uint32_t> number(above.size(), 0);
      std::vector<LevelNode> kept;
      points.clear();
      for (std::size_t i = 0; i < above.size(); ++i) {
        number[i] = static_cast<std::uint32_t>(kept.size());
        if (joined[i].size() == 0) continue;
        kept.push_back(above[i]);
        points.push_back(std::move(joined[i]));
      }
      for (LevelNode& node : below) node.parent = number[node.parent];
      above = std::move(kept);
      medial::parallelFor(above.size(), context_, [&](std::size_t i) {
        above[i].fit = fitBall(surface_, points[i], above[i].fit.center, refineEffort(settings_.quality).fit);
      });
    }
    for (std::size_t i = 0; i < open_.size(); ++i) open_[i].node = levels_.back()[i];
  }

  const Surface& surface_;
  const BuildSettings& settings_;
  std::span<const NamedReducer> reducers_;
  const medial::Context& context_;
  double goodEnough_;  // mesh units
  bool refine_;
  bool link_;
  bool sketching_ = false;  // a first, rough tree, to learn where the balls will be needed
  bool repeated_ = false;   // somewhere the sketch stood a ball for itself on the next level
  Foresight foresight_;
  std::vector<std::vector<LevelBall>> rivals_;  // all sets proposed for the root
  Stretch stretch_;
  double prospect_ = 0;           // of the last level
  std::vector<Proposal> makers_;  // of the last level: who proposed its sets, without these
  Levels levels_;
  std::vector<OpenNode> open_;  // the last of levels_
  Winners winners_;
  std::uint64_t nodesSoFar_ = 0;
};

}  // namespace

BallTree buildByLevels(const Surface& surface, const BuildSettings& settings,
                       std::span<const NamedReducer> reducers, const medial::Context& context) {
  return LevelDriver(surface, settings, reducers, context).run();
}

medial::MedialAxis rootAxis(const Surface& surface, const BuildSettings& settings,
                            const medial::Context& context) {
  return LevelDriver(surface, settings, {}, context).rootAxis();
}

}  // namespace spheretree::builders
