// SPDX-License-Identifier: MIT

#include <spheretree/simd.hpp>

#include <algorithm>
#include <atomic>

#include "simd_paths.hpp"

namespace spheretree {

namespace {

SimdLevel detect() noexcept {
#if SPHERETREE_X86
  __builtin_cpu_init();
  const bool avx2 =
      __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
  const bool avx512 = __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") &&
                      __builtin_cpu_supports("avx512dq");
  if (avx2 && avx512) return SimdLevel::Avx512;
  return avx2 ? SimdLevel::Avx2 : SimdLevel::Sse2;
#else
  return SimdLevel::Scalar;
#endif
}

std::atomic<SimdLevel> wanted{SimdLevel::Avx512};

}  // namespace

SimdLevel supportedSimd() noexcept {
  static const SimdLevel level = detect();
  return level;
}

SimdLevel activeSimd() noexcept {
  return std::min(supportedSimd(), wanted.load(std::memory_order_relaxed));
}

void limitSimd(SimdLevel level) noexcept {
  wanted.store(level, std::memory_order_relaxed);
}

}  // namespace spheretree
