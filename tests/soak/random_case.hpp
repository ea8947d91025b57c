// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "builders/settings.hpp"
#include "medial/triangle_mesh.hpp"

namespace spheretree::soak {

/// One random case: everything in it follows from its seed, on every machine.
struct Case {
  std::uint64_t seed = 0;
  std::string what;  ///< one line: shape, changes, settings
  medial::TriangleMesh mesh;
  bool mended = false;  ///< parts were cut away: repair comes first
  builders::BuildSettings settings;
};

[[nodiscard]] Case makeCase(std::uint64_t seed);

}  // namespace spheretree::soak
