// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include <spheretree/aabb.hpp>

namespace spheretree::tests {

/// The crowded room: unit boxes that move in straight lines between reflecting walls, 60 frames a second.
class Crowd {
 public:
  struct Settings {
    std::size_t count = 1000;
    float speed = 5;  ///< metres per second: the largest along each axis
    float scale = 1;  ///< of the room, which is 100 x 25 x 100
    std::uint32_t seed = 1;
    float height = 25;           ///< of the room before scaling; 1 puts all boxes on the floor
    std::size_t largeEvery = 0;  ///< one box in so many has an edge of 15 instead of 1
  };

  explicit Crowd(const Settings& settings)
      : room_(settings.scale * Vec3{100, settings.height, 100}), random_(settings.seed) {
    for (std::size_t i = 0; i < settings.count; ++i) {
      const float edge = settings.largeEvery != 0 && i % settings.largeEvery == 0 ? 15.0F : 1.0F;
      const Vec3 corner{number() * (room_.x - edge), number() * (room_.y - edge),
                        number() * (room_.z - edge)};
      boxes_.push_back({corner, corner + Vec3{edge, edge, edge}});
      edges_.push_back(edge);
      velocities_.push_back(settings.speed * Vec3{2 * number() - 1, 2 * number() - 1, 2 * number() - 1});
    }
  }

  /// The room that holds `count` boxes as densely as the room itself holds 4000.
  static float scaleForDensity(std::size_t count) {
    return static_cast<float>(std::cbrt(static_cast<double>(count) / 4000));
  }

  void step() {
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      Aabb& box = boxes_[i];
      Vec3& v = velocities_[i];
      const Vec3 size = edges_[i] * Vec3{1, 1, 1};
      advance(box.min.x, box.max.x, v.x, room_.x);
      advance(box.min.y, box.max.y, v.y, room_.y);
      advance(box.min.z, box.max.z, v.z, room_.z);
      box.max = box.min + size;  // rounding must not add up
    }
  }

  [[nodiscard]] const std::vector<Aabb>& boxes() const { return boxes_; }

 private:
  static void advance(float& low, float high, float& speed, float wall) {
    if ((low <= 0 && speed < 0) || (high >= wall && speed > 0)) speed = -speed;
    low += speed / 60;
  }

  float number() { return static_cast<float>(random_() >> 8U) * 0x1p-24F; }

  Vec3 room_;
  std::mt19937 random_;
  std::vector<Aabb> boxes_;
  std::vector<Vec3> velocities_;
  std::vector<float> edges_;
};

}  // namespace spheretree::tests
