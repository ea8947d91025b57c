// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace crowded_room::shaders {

/// GLSL 3.30 sources of one program.
struct Sources {
  std::string vertex;
  std::string fragment;
};

[[nodiscard]] Sources mesh();         ///< triangles, lit
[[nodiscard]] Sources meshShadow();   ///< triangles, depth alone
[[nodiscard]] Sources balls();        ///< balls cast as rays in the fragment shader, lit
[[nodiscard]] Sources ballsShadow();  ///< the same, depth alone
[[nodiscard]] Sources room();         ///< floor and walls, lit

}  // namespace crowded_room::shaders
