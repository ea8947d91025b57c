// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace crowded_room {

/// Width and height in pixels.
struct PixelSize {
  int width = 0;
  int height = 0;

  friend constexpr bool operator==(const PixelSize&, const PixelSize&) = default;
};

/// Red, green, blue, 8 bits each (sRGB), row by row from the top.
struct Image {
  PixelSize size;
  std::vector<std::uint8_t> rgb;

  [[nodiscard]] const std::uint8_t* pixel(int x, int y) const noexcept {
    return rgb.data() + 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
                             static_cast<std::size_t>(x));
  }
};

}  // namespace crowded_room
