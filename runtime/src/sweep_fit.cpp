// SPDX-License-Identifier: MIT
//
// How Sweep chooses axes, strips and cells: from a sample of the boxes, now and then.

#include <spheretree/sweep.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "box_check.hpp"
#include "sweep_kernels.hpp"

namespace spheretree {

namespace {

using namespace detail;

constexpr std::size_t kMaxSample = 128;  // boxes looked at to choose a layout: some 10 us
constexpr double kTrimmed = 0.02;  // share of the sample ignored at either end: a few far boxes must not
                                   // stretch the cells
constexpr double kMargin = 0.06;   // room added to what the sample spans, as a share of it

// More strips mean fewer tests along them, and more boxes that reach into a second strip, each of which costs
// as much as about 30 tests. The optimum is flat; measured.
constexpr double kTestsPerCrossing = 30;
constexpr double kMostCrossings = 0.5;  // per box, expected

// Points overlap nothing, and boxes that all overlap, everything; some number keeps quotients finite.
constexpr double kLeastShare = 1e-9;
constexpr double kMostShare = 1e9;

/// What a sample of boxes says about one axis, in world units.
struct AxisUse {
  double low = 0;
  double high = 0;
  double share = 1;  // of the others that a box overlaps along this axis, expected, when evenly spread

  AxisUse() = default;
  AxisUse(std::span<float> mins, std::span<float> maxs) noexcept;
};

AxisUse::AxisUse(std::span<float> mins, std::span<float> maxs) noexcept {
  double extent = 0;
  for (std::size_t i = 0; i < mins.size(); ++i)
    extent += static_cast<double>(maxs[i]) - static_cast<double>(mins[i]);
  extent /= static_cast<double>(mins.size());
  const auto trimmed = static_cast<std::ptrdiff_t>(kTrimmed * static_cast<double>(mins.size()));
  std::nth_element(mins.begin(), mins.begin() + trimmed, mins.end());
  std::nth_element(maxs.begin(), maxs.end() - 1 - trimmed, maxs.end());
  low = static_cast<double>(*(mins.begin() + trimmed));
  high = std::max(static_cast<double>(*(maxs.end() - 1 - trimmed)), low);
  const double span = high - low;
  share = span > extent ? std::max(extent / (span - extent), kLeastShare) : kMostShare;
  low -= kMargin * span;
  high += kMargin * span;
}

/// From world units to compact steps; finite and positive for every pair of finite limits.
float stepsPerUnit(const AxisUse& axis) noexcept {
  constexpr double kLeastSpan = 1e-30;  // keeps the quotient a finite float
  const double span = std::max({axis.high - axis.low, kLeastSpan, 1e-6 * std::abs(axis.low)});
  return static_cast<float>(kMaxCoordinate / span);
}

}  // namespace

void Sweep::fit(std::span<const Aabb> boxes) noexcept {
  std::array<std::array<float, kMaxSample>, 3> mins;
  std::array<std::array<float, kMaxSample>, 3> maxs;
  std::size_t sampled = 0;
  const std::size_t stride = std::max<std::size_t>(1, (boxes.size() + kMaxSample - 1) / kMaxSample);
  for (std::size_t i = 0; i < boxes.size(); i += stride) {
    const Aabb& box = boxes[i];
    if (!isWellFormed(box)) continue;
    mins[0][sampled] = box.min.x;
    mins[1][sampled] = box.min.y;
    mins[2][sampled] = box.min.z;
    maxs[0][sampled] = box.max.x;
    maxs[1][sampled] = box.max.y;
    maxs[2][sampled] = box.max.z;
    ++sampled;
  }
  fittedCount_ = boxes.size();
  callsSinceFit_ = 0;
  layout_ = {};
  if (sampled == 0) return;

  std::array<AxisUse, 3> axes;
  for (std::size_t k = 0; k < 3; ++k) {
    axes[k] = AxisUse(std::span(mins[k]).first(sampled), std::span(maxs[k]).first(sampled));
    layout_.origin[k] = static_cast<float>(axes[k].low);
    layout_.scale[k] = stepsPerUnit(axes[k]);
  }
  std::array<unsigned, 3> byUse{0, 1, 2};
  for (const std::size_t k : {0U, 1U, 0U}) {
    if (axes[byUse[k + 1]].share < axes[byUse[k]].share) std::swap(byUse[k], byUse[k + 1]);
  }
  layout_.sweepAxis = byUse[0];
  layout_.stripAxis = byUse[1];

  const auto count = static_cast<double>(boxes.size());
  const double along = count * std::min(axes[byUse[0]].share, 1.0);  // boxes met per box without strips
  const double across = axes[byUse[1]].share;
  const double strips = std::min({std::sqrt(along / (kTestsPerCrossing * across)), kMostCrossings / across,
                                  count / static_cast<double>(kLeastBoxesPerStrip)});
  layout_.strips = static_cast<std::uint32_t>(std::clamp(strips, 1.0, static_cast<double>(kMaxStrips)));
  layout_.cells = std::clamp(static_cast<std::uint32_t>(boxes.size() / kBoxesPerCell) / layout_.strips, 1U,
                             kMaxCoordinate);
}

}  // namespace spheretree
