// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bytes -> `.sph` codec -> QueryTree -> queries. Levels wanted and poses follow from the bytes.

#include <limits>
#include <string_view>

#include "fuzz_target.hpp"
#include "sph_checks.hpp"

namespace {

/// FNV-1a: any change of the input changes the poses.
std::uint64_t hashOf(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3U;
  return hash;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace spheretree;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::uint64_t hash = hashOf(text);
  const std::size_t levels = hash % 4 == 0 ? 1 + hash / 4 % 3 : SphLoadLimits{}.levels;
  fuzz::failOn(fuzz::codecFlaw(text, levels));
  if (const Result<SphFile> file = fuzz::parseTight(text, levels)) {
    fuzz::failOn(fuzz::queryFlaw(*file, hash));
  }
  return 0;
}
