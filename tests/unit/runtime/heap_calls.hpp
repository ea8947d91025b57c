// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

namespace spheretree::test {

/// How often the whole process has asked operator new, in any form, for memory.
[[nodiscard]] std::size_t heapCalls() noexcept;

}  // namespace spheretree::test
