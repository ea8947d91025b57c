// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace spheretree {

/// Instruction sets that the queries have a path for. Results are the same, bit for bit, on all of them.
/// A query without a path of its own for a level takes the next lower one it has: compare with >=.
enum class SimdLevel : std::uint8_t { Scalar, Sse2, Avx2, Avx512 };

/// The best path that this processor can run.
[[nodiscard]] SimdLevel supportedSimd() noexcept;

/// The path that queries take: the best supported one, unless limitSimd() said otherwise.
[[nodiscard]] SimdLevel activeSimd() noexcept;

/// Takes no better path than `level` from now on, in the whole process: for tests and for measuring.
void limitSimd(SimdLevel level) noexcept;

}  // namespace spheretree
