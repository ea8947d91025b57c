// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include <spheretree/result.hpp>

namespace spheretree::io {

/// What to do when an output exists already.
enum class Overwrite : std::uint8_t { Refuse, Replace };

/// The whole file. Errors: UnreadableInput, naming the file and the system's reason; Internal when memory is
/// short.
Result<std::string> readFile(const std::filesystem::path& path);

/// Writes the whole file or nothing: a temporary file in the same folder, synced, renamed. A crash leaves
/// the old file or the new one, never half of one. Errors: UnwritableOutput.
Result<Done> writeFileAtomically(const std::filesystem::path& path, std::string_view bytes,
                                 Overwrite overwrite);

/// Fails exactly when writeFileAtomically would refuse before writing: existing file, missing or unwritable
/// folder. Lets a long job fail early.
Result<Done> checkWritable(const std::filesystem::path& path, Overwrite overwrite);

/// Removes the temporary files that killed processes left behind for these targets, and says how many. No
/// other process may be writing them now.
std::size_t removeLeftovers(std::span<const std::filesystem::path> targets);

/// In lower case, for ASCII.
[[nodiscard]] std::string lowerCase(std::string text);

/// The extension of a file with its dot, in lower case.
[[nodiscard]] std::string endingOf(const std::filesystem::path& path);

/// XXH3-128 of the bytes, 32 hex digits.
[[nodiscard]] std::string contentHash(std::string_view bytes);

}  // namespace spheretree::io
