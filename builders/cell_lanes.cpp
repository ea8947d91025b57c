// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/cell_lanes.hpp"

#include <algorithm>

namespace spheretree::builders {

void CellLanes::Triples::add(const std::array<Point32, 3>& corners) {
  for (std::size_t k = 0; k < 3; ++k) {
    x[k].push_back(corners[k].x);
    y[k].push_back(corners[k].y);
    z[k].push_back(corners[k].z);
  }
}

void CellLanes::Triples::farthestSquared(std::size_t first, std::size_t last, const Point32& center,
                                         float* out) const {
  const float* ax = x[0].data() + first;
  const float* bx = x[1].data() + first;
  const float* cx = x[2].data() + first;
  const float* ay = y[0].data() + first;
  const float* by = y[1].data() + first;
  const float* cy = y[2].data() + first;
  const float* az = z[0].data() + first;
  const float* bz = z[1].data() + first;
  const float* cz = z[2].data() + first;
  const Point32 p = center;
  const auto squared = [](float dx, float dy, float dz) { return dx * dx + dy * dy + dz * dz; };
  const std::size_t count = last - first;
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i) {
    const float a = squared(ax[i] - p.x, ay[i] - p.y, az[i] - p.z);
    const float b = squared(bx[i] - p.x, by[i] - p.y, bz[i] - p.z);
    const float c = squared(cx[i] - p.x, cy[i] - p.y, cz[i] - p.z);
    const float ab = a > b ? a : b;
    out[i] = ab > c ? ab : c;
  }
}

void CellLanes::add(std::span<const Point32> corners) {
  const auto cell = static_cast<std::uint32_t>(size());
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    std::array<Point32, 3> triple;
    for (std::size_t k = 0; k < 3; ++k) triple[k] = corners[std::min(i + k, corners.size() - 1)];
    if (i == 0) {
      first_.add(triple);
    } else {
      more_.add(triple);
      cell_.push_back(cell);
    }
  }
}

void CellLanes::farthestSquared(std::size_t first, std::size_t last, const Point32& center,
                                std::vector<float>& out) const {
  out.resize(last - first);
  first_.farthestSquared(first, last, center, out.data());
  const auto from = std::lower_bound(cell_.begin(), cell_.end(), first);
  const auto to = std::lower_bound(from, cell_.end(), last);
  if (from == to) return;
  const auto begin = static_cast<std::size_t>(from - cell_.begin());
  const auto end = static_cast<std::size_t>(to - cell_.begin());
  thread_local std::vector<float> squared;
  squared.resize(end - begin);
  more_.farthestSquared(begin, end, center, squared.data());
  for (std::size_t i = begin; i < end; ++i) {
    float& farthest = out[cell_[i] - first];
    farthest = std::max(farthest, squared[i - begin]);
  }
}

}  // namespace spheretree::builders
