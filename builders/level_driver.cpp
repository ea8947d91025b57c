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
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "builders/fit_ball.hpp"
#include "builders/grouping.hpp"
#include "builders/pieces.hpp"
#include "builders/refine.hpp"
#include "builders/set_error.hpp"
#include "medial/adaptive_axis.hpp"
#include "medial/cell_set.hpp"
#include "medial/min_ball.hpp"
#include "medial/morton.hpp"
#include "medial/parallel.hpp"
#include "medial/random.hpp"
#include "medial/solid_cells.hpp"
#include "medial/surface_samples.hpp"

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

// No ball sticks out more than the worst.
constexpr double kNever = 2;

// Surface points of the axis that the first region is refined from.
constexpr std::uint32_t kCoarseSamples = 1000;

// A ball that needs this many times the children it may have sticks out, on every level below it, this power
// of it farther: the number of balls that a stand-off takes goes with about its power 1.5 (measured; a smooth
// surface has 1).
constexpr double kStandOffPerLoad = 0.67;
// Powers of stand-off and load in the cost of a ball (patch.cpp); what makes their trade-offs comparable.
constexpr double kPowerRatio = 10.0 / 6.0;
// The first level may stick out so many times the least that any of its sets does, for the sake of the
// others.
constexpr double kNearLeast = 1.05;
// How often, and by how much, loads count less where otherwise the level would stick out too far.
constexpr int kSecondChances = 2;
constexpr double kSecondWeight = 0.2;
// First levels differ in how much a load counts: which is best differs from shape to shape.
constexpr std::array<double, 3> kLoadPressures{2, 1.3, 0.8};
// Leaves are spread over the surface as if there were fewer by this share, so that there is room to move.
constexpr double kSpareLeaves = 0.05;
// Shares of the progress: of the sketch, and of the rest for looking ahead.
constexpr double kSketchShare = 0.1;
constexpr double kLookShare = 0.4;
// Worth more than any stand-off.
constexpr double kDeeper = 1000;

using Axis = std::shared_ptr<const medial::RegionAxis>;

/// What one ball has to cover.
struct Region {
  std::vector<SurfaceCell> surface;
  std::vector<AlignedBox3d> cubes;  // Cover::Solid only; the solid inside them
};

/// A ball of a finished level.
struct Node {
  Fit fit;
  std::uint32_t parent = 0;
  std::string_view maker{};
};

/// A ball of the last level so far, with what the next one is made from.
struct OpenNode {
  Node node;
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

void refineSolid(const Surface& surface, const AlignedBox3d& cube, double size,
                 std::vector<medial::SolidCell>& out) {
  std::vector<Eigen::Vector3d> points = medial::solidPoints(surface, cube, surface.trianglesNear(cube));
  if (points.empty()) return;
  if (cube.sizes().maxCoeff() <= size) {
    out.push_back({cube, std::move(points)});
    return;
  }
  for (const AlignedBox3d& octant : medial::octants(cube)) refineSolid(surface, octant, size, out);
}

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

/// The region in pieces of about a fraction `size` of the balls that are expected to cover it.
std::vector<Piece> piecesOf(const Surface& surface, const Region& region, double surfaceSize,
                            double solidSize) {
  std::vector<Piece> pieces = surfacePieces(region.surface, surfaceSize);
  std::vector<medial::SolidCell> solid;
  for (const AlignedBox3d& cube : region.cubes) refineSolid(surface, cube, solidSize, solid);
  for (medial::SolidCell& cell : solid) {
    Piece piece;
    piece.cube = cell.cube;
    piece.points = std::move(cell.points);
    pieces.push_back(std::move(piece));
  }
  return pieces;
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
        link_(isOn(settings.link)) {}

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
    spreadLeaves();
    buildLookingAhead();
    return tree();
  }

  /// What the children of the root are chosen from.
  medial::MedialAxis rootAxis() {
    makeRoot();
    OpenNode& root = open_.front();
    if (!root.axis) root.axis = coarseAxis();
    const double radius = expectedRadius(root);
    const CellSet set =
        cellSetOf(piecesOf(surface_, root.region, kSurfaceCellSize * radius, kSolidCellSize * radius));
    return axisOf(root, set).axis;
  }

 private:
  using Levels = std::vector<std::vector<Node>>;
  using Winners = std::vector<std::vector<std::pair<std::string, std::size_t>>>;

  [[nodiscard]] BallTree tree() {
    BallTree tree;
    for (const std::vector<Node>& level : levels_) {
      tree.levels.emplace_back();
      for (const Node& node : level) {
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
      for (const Node& node : levels[l]) worst = std::max(worst, node.fit.standOff());
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
    std::uint64_t nodesSoFar = 0;
    double prospect = 0;
  };

  [[nodiscard]] State state() const { return {levels_, winners_, open_, nodesSoFar_, prospect_}; }

  void goOnFrom(State state) {
    levels_ = std::move(state.levels);
    winners_ = std::move(state.winners);
    open_ = std::move(state.open);
    nodesSoFar_ = state.nodesSoFar;
    prospect_ = state.prospect;
  }

  /// What a first level promises is a guess. So the second level is tried below several of them, and the
  /// whole tree below those that then promise most.
  void buildLookingAhead() {
    const BuildEffort effort = buildEffort(settings_.quality);
    begin();
    const State root = state();
    std::vector<Proposal> proposals = proposeAll();
    std::vector<State> begun;
    const Stretch all = stretch_;
    const double middle = all.from + kLookShare * (all.to - all.from);
    for (RefinedLevel& first : firstLevels(proposals)) {
      if (begun.size() >= effort.lookedAhead) break;
      stretch_ = part({all.from, middle}, begun.size(), effort.lookedAhead);
      goOnFrom(root);
      nodesSoFar_ = 1;
      std::vector<Proposal> shared = proposals;
      shareAmongParents(std::move(first), shared);
      if (!takeOver(shared)) continue;
      addLevels(2, std::min(settings_.levels, 3U));
      begun.push_back(state());
    }
    std::stable_sort(begun.begin(), begun.end(),
                     [](const State& a, const State& b) { return a.prospect < b.prospect; });
    if (begun.size() > effort.passes) begun.resize(effort.passes);
    State best = root;
    for (pass_ = 0; pass_ < begun.size(); ++pass_) {
      stretch_ = part({middle, all.to}, pass_, begun.size());
      goOnFrom(std::move(begun[pass_]));
      addLevels(3, settings_.levels);
      if (score(levels_) < score(best.levels)) best = state();
    }
    goOnFrom(std::move(best));
  }

  /// The leaves as if they needed no parents: shows where balls are needed.
  void spreadLeaves() {
    LevelProblem problem;
    const double slots = std::pow(settings_.branch, static_cast<double>(settings_.levels - 1));
    problem.branch = static_cast<std::uint32_t>(std::max(1.0, slots * (1 - kSpareLeaves)));
    for (const OpenNode& node : open_) {
      const double radius = expectedRadius(node);
      std::vector<Piece> pieces =
          piecesOf(surface_, node.region, kSpreadCellSize * radius, kSolidCellSize * radius);
      std::move(pieces.begin(), pieces.end(), std::back_inserter(problem.pieces));
    }
    problem.allowed.assign(problem.pieces.size(), {0});
    std::vector<LevelBall> balls = farApartBalls(problem);
    RefineRequest request = requestFor(settings_.seed);
    request.effort = spreadEffort(settings_.quality);
    balls = refineLevel(problem, std::move(balls), request);
    for (const LevelBall& ball : balls) {
      leaves_.push_back(ball.fit);
      leafPoints_.emplace_back();
      for (const std::uint32_t piece : ball.pieces) {
        for (const Eigen::Vector3d& p : problem.pieces[piece].points) leafPoints_.back().push(p);
      }
    }
  }

  /// As many balls as the problem may have, touching the surface at places far from each other.
  [[nodiscard]] std::vector<LevelBall> farApartBalls(const LevelProblem& problem) const {
    std::vector<Eigen::Vector3d> places;
    for (const Piece& piece : problem.pieces) places.push_back(piece.points.front());
    const std::vector<std::size_t> chosen = farApart(places, 0, problem.branch);
    std::vector<LevelBall> balls(chosen.size());
    medial::parallelFor(chosen.size(), context_, [&](std::size_t i) {
      const medial::ClosestPoint on = surface_.closestPoint(places[chosen[i]]);
      balls[i].fit.center =
          probeDepth(surface_, medial::tangentBall(surface_, {on.point, on.triangle}).center);
    });
    return balls;
  }

  /// How many children on the level below `depth` each piece will need: as many as leaves were spread there,
  /// in the proportion of the levels' sizes.
  void foresee(std::size_t depth, LevelProblem& problem, double pressure) const {
    if (leaves_.empty() || depth + 1 >= settings_.levels) return;
    const std::size_t n = problem.pieces.size();
    std::vector<std::uint32_t> nearest(n, 0);
    std::vector<double> area(n, 0);
    constexpr std::size_t kBlock = 256;
    medial::parallelFor((n + kBlock - 1) / kBlock, context_, [&](std::size_t block) {
      for (std::size_t i = block * kBlock; i < std::min(n, (block + 1) * kBlock); ++i) {
        area[i] = areaOf(problem.pieces[i]);
        const Eigen::Vector3d& p = problem.pieces[i].points.front();
        double least = std::numeric_limits<double>::infinity();
        for (std::uint32_t k = 0; k < leaves_.size(); ++k) {
          const DepthProbe& center = leaves_[k].center;
          const double limit = least + center.depth;
          if (limit < 0 || (p - center.at).squaredNorm() >= limit * limit) continue;
          least = (p - center.at).norm() - center.depth;
          nearest[i] = k;
        }
      }
    });
    std::vector<double> areaOfLeaf(leaves_.size(), 0);
    for (std::size_t i = 0; i < n; ++i) areaOfLeaf[nearest[i]] += area[i];
    const double levelsBelow = static_cast<double>(settings_.levels - 1 - depth);
    const double share =
        std::pow(settings_.branch, static_cast<double>(depth + 1)) / static_cast<double>(leaves_.size());
    problem.loads.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      problem.loads[i] = areaOfLeaf[nearest[i]] > 0 ? share * area[i] / areaOfLeaf[nearest[i]] : 0;
    }
    problem.fairLoad = settings_.branch;
    problem.loadWeight = kStandOffPerLoad * levelsBelow * kPowerRatio * pressure;
  }

  /// What a level will lead to: the sum over it and the levels below of the logarithm of the worst stand-off.
  [[nodiscard]] double prospect(const std::vector<LevelBall>& balls, std::size_t depth) const {
    double load = 1;
    for (const LevelBall& ball : balls) load = std::max(load, ball.load / settings_.branch);
    const double levelsBelow = static_cast<double>(settings_.levels - 1 - depth);
    return std::log(worstOf(balls)) + kStandOffPerLoad * levelsBelow * std::log(load);
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
      const double radius = expectedRadius(node);
      const double size = isRough() ? kRefineCellSize : kSurfaceCellSize;
      best.pieces = piecesOf(surface_, node.region, size * radius, kSolidCellSize * radius);
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
    proposal.pieces = piecesOf(surface_, node.region, std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::infinity());
    LevelBall same;
    same.fit = node.node.fit;
    for (std::uint32_t i = 0; i < proposal.pieces.size(); ++i) same.pieces.push_back(i);
    proposal.balls = {std::move(same)};
    proposal.axis = node.axis;
    proposal.winner = node.winner;
    proposal.refined = false;
  }

  [[nodiscard]] double expectedRadius(const OpenNode& node) const {
    return node.node.fit.reach / std::sqrt(static_cast<double>(settings_.branch));
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
    if (isRough() && !buildEffort(settings_.quality).polishesRough) effort.polishFrom = kNever;
    return {surface_, settings_.objective, goodEnough_, effort, seed, context_};
  }

  void refineAlone(const OpenNode& node, Proposal& proposal, std::uint64_t seed) const {
    if (!proposal.refined) return;
    LevelProblem problem;
    problem.branch = settings_.branch;
    problem.pieces = coarsePieces(node);
    problem.allowed.assign(problem.pieces.size(), {0});
    proposal.balls = refineLevel(problem, std::move(proposal.balls), requestFor(seed));
    proposal.pieces = std::move(problem.pieces);
    if (!(worstOf(proposal.balls) < node.node.fit.standOff())) repeat(node, proposal);
  }

  /// Who may answer for a piece: the tree so far, and how far the balls of each level may stick out.
  struct Reach {
    std::vector<std::vector<std::uint32_t>> children;  // of all nodes, level after level
    std::vector<double> caps;
  };

  /// The nodes of the last level whose ball, grown to the stand-off of the worst of its level, holds the
  /// piece, and whose ancestors do as well.
  [[nodiscard]] std::vector<std::uint32_t> holders(const Piece& piece, const Reach& reach) const {
    std::vector<std::uint32_t> now{0};
    std::size_t base = 1;  // number of the first node of the level in the numbering of `children`
    std::size_t above = 0;
    for (std::size_t l = 1; l < levels_.size(); ++l) {
      std::vector<std::uint32_t> next;
      for (const std::uint32_t n : now) {
        for (const std::uint32_t child : reach.children[above + n]) {
          const Fit& fit = levels_[l][child].fit;
          const double radius = std::max(fit.reach, fit.center.depth + reach.caps[l]);
          const bool holds = std::all_of(piece.points.begin(), piece.points.end(), [&](const auto& p) {
            return (p - fit.center.at).squaredNorm() <= radius * radius;
          });
          if (holds) next.push_back(child);
        }
      }
      above = base;
      base += levels_[l].size();
      now = std::move(next);
    }
    return now;
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
    level.prospect = prospect(level.balls, levels_.size());
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
  [[nodiscard]] RefinedLevel refineGiven(const LevelProblem& problem,
                                         const std::vector<LevelBall>& balls) const {
    const RefineRequest request = requestFor(settings_.seed + nodesSoFar_ + pass_);
    RefinedLevel level = refined(problem, balls, request);
    if (problem.loads.empty() || comesWithin(worstOf(balls), level, request)) return level;
    LevelProblem plain = problem;
    plain.loads.clear();
    return refined(std::move(plain), balls, request);
  }

  /// First levels that all stick out little, those that promise most for all levels together first.
  [[nodiscard]] std::vector<RefinedLevel> firstLevels(const std::vector<Proposal>& proposals) {
    const std::vector<LevelBall> balls = proposals.front().balls;
    const LevelProblem problem = problemOf(coarsePieces());
    RefineRequest request = requestFor(settings_.seed + 1);
    request.effort = refineEffort(Quality::Normal);
    std::vector<std::vector<LevelBall>> starts{balls};
    for (std::vector<LevelBall>& other : otherStarts(balls)) starts.push_back(std::move(other));
    std::vector<RefinedLevel> all;
    for (std::size_t k = 0; k < buildEffort(settings_.quality).pressures; ++k) {
      LevelProblem pressed = problem;
      foresee(1, pressed, kLoadPressures[k]);
      for (const std::vector<LevelBall>& start : starts) all.push_back(refined(pressed, start, request));
    }
    const auto promising = [](const RefinedLevel& a, const RefinedLevel& b) {
      return a.prospect < b.prospect;
    };
    std::stable_sort(all.begin(), all.end(), promising);
    double limit = worstOf(balls);
    for (const RefinedLevel& level : all) limit = std::min(limit, kNearLeast * worstOf(level.balls));
    const std::size_t wanted = buildEffort(settings_.quality).lookedAhead;
    std::vector<RefinedLevel> good;
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

  /// Other sets for the first level: those of the reducers that lost, and some that share the leaves evenly.
  [[nodiscard]] std::vector<std::vector<LevelBall>> otherStarts(const std::vector<LevelBall>& given) {
    std::vector<std::vector<LevelBall>> starts = std::move(rivals_);
    const std::size_t capacity = (leaves_.size() + settings_.branch - 1) / settings_.branch;
    for (std::size_t k = 0; k < buildEffort(settings_.quality).starts; ++k) {
      std::vector<DepthProbe> centers;
      if (k == 0) {
        for (const LevelBall& ball : given) centers.push_back(ball.fit.center);
      } else {
        std::vector<Eigen::Vector3d> places;
        for (const Fit& leaf : leaves_) places.push_back(leaf.center.at);
        const std::size_t first = medial::Random(settings_.seed, k).next() % leaves_.size();
        for (const std::size_t i : farApart(places, first, settings_.branch))
          centers.push_back(leaves_[i].center);
      }
      if (centers.size() * capacity < leaves_.size()) continue;
      starts.emplace_back();
      for (const Group& group : groupEvenly(surface_, leafPoints_, centers, capacity,
                                            refineEffort(settings_.quality).fit, context_)) {
        starts.back().push_back({group.fit, 0, {}, 0});
      }
    }
    return starts;
  }

  [[nodiscard]] Reach reachOfLevels() const {
    Reach reach;
    for (std::size_t l = 0; l + 1 < levels_.size(); ++l) {
      const std::size_t first = reach.children.size();
      reach.children.resize(first + levels_[l].size());
      for (std::uint32_t n = 0; n < levels_[l + 1].size(); ++n) {
        reach.children[first + levels_[l + 1][n].parent].push_back(n);
      }
    }
    // Room up to the worst of the level costs nothing where the worst is what counts.
    const bool room = settings_.objective == Objective::Worst;
    reach.caps.assign(levels_.size(), room ? 0 : -std::numeric_limits<double>::infinity());
    for (std::size_t l = 1; room && l < levels_.size(); ++l) {
      for (const Node& node : levels_[l]) reach.caps[l] = std::max(reach.caps[l], node.fit.standOff());
    }
    return reach;
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
    const auto reach = std::make_shared<const Reach>(reachOfLevels());
    problem.allowed.resize(problem.pieces.size());
    medial::parallelFor(problem.pieces.size(), context_, [&](std::size_t i) {
      std::vector<std::uint32_t>& allowed = problem.allowed[i];
      allowed = holders(problem.pieces[i], *reach);
      const auto at = std::lower_bound(allowed.begin(), allowed.end(), home[i]);
      if (at == allowed.end() || *at != home[i]) allowed.insert(at, home[i]);
    });
    if (problem.parents > 1) {
      problem.allowedPart = [this, reach](const Piece& part, const std::vector<std::uint32_t>& whole) {
        const std::vector<std::uint32_t> result = holders(part, *reach);
        std::vector<std::uint32_t> both;
        std::set_union(result.begin(), result.end(), whole.begin(), whole.end(), std::back_inserter(both));
        return both;
      };
    }
    return problem;
  }

  /// The region of a node in pieces that seams can be cut into later.
  [[nodiscard]] std::vector<Piece> coarsePieces(const OpenNode& node) const {
    const double radius = expectedRadius(node);
    return piecesOf(surface_, node.region, kRefineCellSize * radius, kSolidCellSize * radius);
  }

  [[nodiscard]] std::vector<std::vector<Piece>> coarsePieces() const {
    std::vector<std::vector<Piece>> pieces;
    for (const OpenNode& node : open_) pieces.push_back(coarsePieces(node));
    return pieces;
  }

  /// The same, of which rough sets have most already.
  [[nodiscard]] std::vector<std::vector<Piece>> roughPieces(const std::vector<Proposal>& proposals) const {
    std::vector<std::vector<Piece>> pieces;
    for (std::size_t i = 0; i < proposals.size(); ++i) {
      pieces.push_back(proposals[i].refined ? proposals[i].pieces : coarsePieces(open_[i]));
    }
    return pieces;
  }

  /// With the pieces that the reducers had, nothing can be lost.
  [[nodiscard]] RefinedLevel finePieces(const std::vector<Proposal>& proposals) const {
    std::vector<std::vector<Piece>> pieces;
    for (const Proposal& proposal : proposals) pieces.push_back(proposal.pieces);
    LevelProblem problem = problemOf(std::move(pieces));
    foresee(levels_.size(), problem, kLoadPressures.front());
    return refineGiven(problem, ballsOfAll(proposals));
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
    foresee(levels_.size(), problem, kLoadPressures.front());
    RefinedLevel level = refineGiven(problem, given);
    if (!sketching_ && worstOf(level.balls) > worstOf(given)) level = finePieces(proposals);
    shareAmongParents(std::move(level), proposals);
  }

  /// Replaces what the reducers proposed by the refined level.
  void shareAmongParents(RefinedLevel level, std::vector<Proposal>& proposals) {
    prospect_ = level.prospect;
    for (Proposal& proposal : proposals) {
      proposal.balls.clear();
      proposal.pieces.clear();
    }
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
      std::vector<Node>& above = levels_[l];
      std::vector<Node>& below = levels_[l + 1];
      std::vector<PointBlock> joined(above.size());
      for (std::size_t i = 0; i < below.size(); ++i) {
        joined[below[i].parent].append(points[i]);
      }
      std::vector<std::uint32_t> number(above.size(), 0);
      std::vector<Node> kept;
      points.clear();
      for (std::size_t i = 0; i < above.size(); ++i) {
        number[i] = static_cast<std::uint32_t>(kept.size());
        if (joined[i].size() == 0) continue;
        kept.push_back(above[i]);
        points.push_back(std::move(joined[i]));
      }
      for (Node& node : below) node.parent = number[node.parent];
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
  bool sketching_ = false;   // a first, rough tree, to learn where the balls will be needed
  bool repeated_ = false;    // somewhere the sketch stood a ball for itself on the next level
  std::vector<Fit> leaves_;  // spread without parents
  std::vector<PointBlock> leafPoints_;
  std::vector<std::vector<LevelBall>> rivals_;  // all sets proposed for the root
  std::size_t pass_ = 0;
  Stretch stretch_;
  double prospect_ = 0;  // of the last level
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
