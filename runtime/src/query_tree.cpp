// SPDX-License-Identifier: MIT
//
// Lays a sphere tree out in blocks of eight balls, structure of arrays, breadth-first.
//
// The children of a node take ceil(n / 8) neighbouring blocks. Only blocks above the last level have links to
// the families below; a ball without children links to its own lane, so that a search may go down in step on
// both sides without asking who has children.

#include <spheretree/query_tree.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <system_error>

namespace spheretree {

namespace {

constexpr std::uint32_t kMaxFamilyBlocks = 256;  // a family's length is stored in a byte
constexpr std::uint32_t kMaxBlocks = 1U << 24U;  // what a link has room for
constexpr float kRounding = 0x1p-22F;            // more than that of a length, relative
constexpr float kRoundUp = 1 + kRounding;
constexpr double kPrintedDigits = 1 + 2e-5;  // two numbers of six digits are multiplied

Error invalid(std::string message) {
  return {ErrorCode::InvalidArgument, std::move(message)};
}

std::uint32_t blocksFor(std::uint32_t children) noexcept {
  return (children + kBlockLanes - 1) / kBlockLanes;
}

Aabb intersectionOf(const Aabb& a, const Aabb& b) noexcept {
  return {{std::max(a.min.x, b.min.x), std::max(a.min.y, b.min.y), std::max(a.min.z, b.min.z)},
          {std::min(a.max.x, b.max.x), std::min(a.max.y, b.max.y), std::min(a.max.z, b.max.z)}};
}

void include(Aabb& box, const Aabb& other) noexcept {
  box = {
      {std::min(box.min.x, other.min.x), std::min(box.min.y, other.min.y), std::min(box.min.z, other.min.z)},
      {std::max(box.max.x, other.max.x), std::max(box.max.y, other.max.y), std::max(box.max.z, other.max.z)}};
}

/// The box of a level, together with the balls above it that have no children.
void include(Aabb& box, const SphereTree& tree, std::size_t level) noexcept {
  for (const Node& node : tree.level(level)) include(box, boundsOf(node.ball));
  for (std::size_t above = 0; above < level; ++above) {
    for (const Node& node : tree.level(above)) {
      if (node.childCount == 0) include(box, boundsOf(node.ball));
    }
  }
}

/// The number behind `prefix` in `text`, or nothing.
bool readNumber(std::string_view text, double& value) noexcept {
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  return code == std::errc{} && std::isfinite(value) && value >= 0;
}

}  // namespace

class QueryTreeBuilder {
 public:
  QueryTreeBuilder(const SphereTree& tree, std::span<const float> standOff) noexcept
      : tree_(tree), given_(standOff) {}

  Result<QueryTree> build();

 private:
  [[nodiscard]] const char* flaw() const noexcept;
  void placeFamily(std::span<const Node> family);
  void placeLevels();
  void setStandOffs() noexcept;
  void setBounds() noexcept;

  const SphereTree& tree_;
  std::span<const float> given_;
  QueryTree out_;
};

const char* QueryTreeBuilder::flaw() const noexcept {
  if (tree_.levelCount() > kMaxQueryLevels) return "the tree has more levels than queries accept; load fewer";
  if (blocksFor(tree_.maxChildren()) > kMaxFamilyBlocks)
    return "a node has more children than queries accept";
  if (given_.empty()) return nullptr;
  if (given_.size() != tree_.levelCount()) return "there must be one stand-off for each level of the tree";
  const bool usable = std::all_of(given_.begin(), given_.end(),
                                  [](float value) { return std::isfinite(value) && value >= 0; });
  return usable ? nullptr : "a stand-off is negative or not a finite number";
}

void QueryTreeBuilder::placeFamily(std::span<const Node> family) {
  const std::uint32_t count = blocksFor(static_cast<std::uint32_t>(family.size()));
  for (std::size_t i = 0; i < count; ++i) {
    const std::span<const Node> part =
        family.subspan(i * kBlockLanes, std::min<std::size_t>(kBlockLanes, family.size() - i * kBlockLanes));
    BallBlock block;
    for (std::size_t lane = 0; lane < part.size(); ++lane) {
      const Sphere& ball = part[lane].ball;
      block.x[lane] = ball.center.x;
      block.y[lane] = ball.center.y;
      block.z[lane] = ball.center.z;
      block.radius[lane] = ball.radius;
    }
    out_.blocks_.push_back(block);
    out_.lanes_.push_back(static_cast<std::uint8_t>((1U << part.size()) - 1U));
    out_.further_.push_back(static_cast<std::uint8_t>(count - 1 - i));
  }
}

/// Blocks level by level. The families of a level are placed in the order of their parents, so a walk over
/// the parents knows where each begins.
void QueryTreeBuilder::placeLevels() {
  const std::size_t levels = tree_.levelCount();
  if (levels == 1) placeFamily(tree_.level(0));
  for (std::size_t level = 0; level + 1 < levels; ++level) {
    for (const Node& node : tree_.level(level)) {
      if (node.childCount > 0) placeFamily(tree_.children(node));
    }
    if (level + 2 < levels) out_.innerBlocks_ = static_cast<std::uint32_t>(out_.blocks_.size());
  }
  out_.rootLink_ = std::uint32_t{out_.lanes_.front()};  // of block 0
  out_.links_.resize(std::size_t{out_.innerBlocks_} * kBlockLanes);
  std::uint32_t block = 0;
  std::uint32_t nextFamily = blocksFor(tree_.root().childCount);
  for (std::size_t level = 0; level + 2 < levels; ++level) {
    for (const Node& parent : tree_.level(level)) {
      const std::span<const Node> family = tree_.children(parent);
      for (std::size_t i = 0; i < family.size(); ++i) {
        const std::uint32_t at = block + static_cast<std::uint32_t>(i) / kBlockLanes;
        const std::uint32_t lane = static_cast<std::uint32_t>(i) % kBlockLanes;
        std::uint32_t link = (at << QueryTree::kLaneBits) | (1U << lane);
        if (family[i].childCount > 0) {
          link = (nextFamily << QueryTree::kLaneBits) | out_.lanes_[nextFamily];
          nextFamily += blocksFor(family[i].childCount);
        }
        out_.links_[at * kBlockLanes + lane] = link;
      }
      block += blocksFor(parent.childCount);
    }
  }
}

void QueryTreeBuilder::setStandOffs() noexcept {
  float childless = 0;  // what the balls above that have no children may stick out
  for (std::size_t level = 0; level < tree_.levelCount(); ++level) {
    float largest = 0;
    float childlessHere = 0;
    for (const Node& node : tree_.level(level)) {
      largest = std::max(largest, node.ball.radius);
      if (node.childCount == 0) childlessHere = std::max(childlessHere, node.ball.radius);
    }
    const float ofLevel = given_.empty() ? 2 * largest : given_[level];
    out_.standOff_[level] = std::max(ofLevel, childless) * kRoundUp;
    childless = std::max(childless, std::min(ofLevel, 2 * childlessHere));
  }
}

void QueryTreeBuilder::setBounds() noexcept {
  out_.bounds_ = boundsOf(out_.root_);
  for (const Node& node : tree_.nodes()) {
    out_.extent_ = std::max(out_.extent_, (length(node.ball.center) + node.ball.radius) * kRoundUp);
  }
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (std::size_t level = 1; level < tree_.levelCount(); ++level) {
    Aabb box{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
    include(box, tree_, level);
    const Aabb both = intersectionOf(out_.bounds_, box);
    const bool usable = both.min.x <= both.max.x && both.min.y <= both.max.y && both.min.z <= both.max.z;
    if (usable) out_.bounds_ = both;  // levels of a tree that covers something always meet
  }
  const float rounding = out_.extent_ * kRounding;
  const Vec3 outwards{rounding, rounding, rounding};
  out_.bounds_ = {out_.bounds_.min - outwards, out_.bounds_.max + outwards};
}

Result<QueryTree> QueryTreeBuilder::build() {
  if (const char* reason = flaw()) return invalid(reason);
  std::uint64_t blocks = 1;
  for (const Node& node : tree_.nodes()) blocks += blocksFor(node.childCount);
  if (blocks >= kMaxBlocks) return invalid("the tree has more balls than queries accept; load fewer levels");
  out_.root_ = tree_.root().ball;
  out_.levelCount_ = static_cast<std::uint32_t>(tree_.levelCount());
  const std::size_t exact = std::max<std::size_t>(1, static_cast<std::size_t>(blocks) - 1);
  out_.blocks_.reserve(exact);
  out_.lanes_.reserve(exact);
  out_.further_.reserve(exact);
  placeLevels();
  setStandOffs();
  setBounds();
  return std::move(out_);
}

Result<QueryTree> QueryTree::create(const SphereTree& tree, std::span<const float> standOff) {
  return QueryTreeBuilder(tree, standOff).build();
}

std::size_t QueryTree::bytes() const noexcept {
  return sizeof *this + blocks_.capacity() * sizeof(BallBlock) + links_.capacity() * sizeof(std::uint32_t) +
         lanes_.capacity() + further_.capacity();
}

std::vector<float> standOffsOf(const SphFile& file) {
  constexpr std::string_view kLevel = "level-";
  constexpr std::string_view kOverhang = "overhang-worst=[";
  double diagonal = -1;
  double wrap = 0;
  std::vector<double> relative(file.tree.levelCount(), -1);
  for (const auto& [key, value] : file.metadata) {
    if (key == "mesh-diagonal" && !readNumber(value, diagonal)) return {};
    if (key == "wrap-stand-off" && !readNumber(value, wrap)) return {};
    if (!key.starts_with(kLevel)) continue;
    std::size_t level = 0;
    const auto [end, code] = std::from_chars(key.data() + kLevel.size(), key.data() + key.size(), level);
    if (code != std::errc{} || end != key.data() + key.size()) continue;
    const std::size_t bracket = value.find(kOverhang);
    const std::size_t comma = value.find(',', bracket == std::string::npos ? value.size() : bracket);
    if (level >= relative.size() || comma == std::string::npos) continue;
    if (!readNumber(std::string_view(value).substr(comma + 1), relative[level])) return {};
  }
  std::vector<float> standOff;
  for (const double level : relative) {
    if (level < 0 || diagonal < 0) return {};
    standOff.push_back(static_cast<float>((level + wrap) * diagonal * kPrintedDigits) * kRoundUp);
  }
  return standOff;
}

}  // namespace spheretree
