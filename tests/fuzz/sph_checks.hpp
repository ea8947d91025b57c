// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <spheretree/sph.hpp>

namespace spheretree::fuzz {

/// What parseSph promises, and what an error message and the odd warning may cost on top of it.
inline constexpr std::size_t kHeapPerByte = 16;
inline constexpr std::size_t kHeapBeside = 2048;

/// Parses from a heap block of exactly the text's size, so that a sanitizer sees any byte read too many.
Result<SphFile> parseTight(std::string_view text, std::size_t levels);

/// What is wrong with how the codec takes any text at all, empty when nothing is: a sound tree that is
/// written and read back the same, or one clean sentence, and no more memory than promised.
[[nodiscard]] std::string codecFlaw(std::string_view text, std::size_t levels);

/// What is wrong with queries between a tree that was read and itself, in one of many poses, empty when
/// nothing is. Pairs of chains are tried one by one in double precision: small trees only.
[[nodiscard]] std::string queryFlaw(const SphFile& file, std::uint64_t seed);

}  // namespace spheretree::fuzz
