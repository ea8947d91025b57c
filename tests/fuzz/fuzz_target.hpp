// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace spheretree::fuzz {

/// Ends the process with `flaw` on stderr, where libFuzzer and standalone_main.cpp keep the input; nothing
/// happens when it is empty.
void failOn(const std::string& flaw);

/// A temporary file that the next call overwrites, for readers that want a path. `extension` with its dot.
/// The folder is gone when the process ends.
[[nodiscard]] std::string asFile(std::string_view bytes, std::string_view extension);

}  // namespace spheretree::fuzz

/// What libFuzzer calls with every input, and standalone_main.cpp as well. Always returns 0.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
