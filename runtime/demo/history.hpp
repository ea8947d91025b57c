// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace crowded_room {

/// What one frame took, microseconds.
struct FrameTimes {
  float update = 0;
  float broad = 0;
  float narrow = 0;
  float render = 0;

  [[nodiscard]] float collision() const noexcept { return update + broad + narrow; }
};

/// The last frames, oldest first.
class History {
 public:
  static constexpr std::size_t kFrames = 240;

  void add(const FrameTimes& times) noexcept {
    times_[next_ % kFrames] = times;
    ++next_;
  }
  [[nodiscard]] std::size_t size() const noexcept { return next_ < kFrames ? next_ : kFrames; }
  [[nodiscard]] const FrameTimes& operator[](std::size_t k) const noexcept {
    return times_[(next_ - size() + k) % kFrames];
  }
  /// Of all frames kept; zeros before the first.
  [[nodiscard]] FrameTimes mean() const noexcept {
    FrameTimes sum;
    for (std::size_t k = 0; k < size(); ++k) {
      const FrameTimes& one = (*this)[k];
      sum = {sum.update + one.update, sum.broad + one.broad, sum.narrow + one.narrow,
             sum.render + one.render};
    }
    const float share = size() > 0 ? 1 / static_cast<float>(size()) : 0;
    return {share * sum.update, share * sum.broad, share * sum.narrow, share * sum.render};
  }

 private:
  std::array<FrameTimes, kFrames> times_{};
  std::size_t next_ = 0;
};

}  // namespace crowded_room
