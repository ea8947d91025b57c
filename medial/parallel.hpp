// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>

#include "medial/context.hpp"

namespace spheretree::medial {

/// Runs body(0) ... body(count - 1) on the context's threads. Each call writes its own slot; nothing else
/// may be shared, so the result does not depend on the number of threads. The first exception (by index)
/// is rethrown after all threads have stopped; cancellation is checked before every index.
void parallelFor(std::size_t count, const Context& context, const std::function<void(std::size_t)>& body);

}  // namespace spheretree::medial
