// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

namespace spheretree::fuzz {

/// Counts what the whole process takes from the heap through operator new, from construction on. One at a
/// time.
class HeapWatch {
 public:
  HeapWatch() noexcept;

  /// Most bytes in use at once since construction, beyond what was in use then.
  [[nodiscard]] std::size_t peak() const noexcept;

 private:
  std::size_t before_;
};

}  // namespace spheretree::fuzz
