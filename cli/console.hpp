// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <spheretree/result.hpp>

#include "cli/exit_code.hpp"

namespace spheretree::cli {

enum class Verbosity : std::uint8_t { Quiet, Normal, Verbose };

/// Results: standard output, exactly as given.
void print(std::string_view text);

/// Says on standard error why the program ends, and gives the code to end with. What was printed before
/// appears before it.
[[nodiscard]] ExitCode fail(const Error& error);

/// As fail(), for something that the user can live with.
void warn(std::string_view sentence);

/// A remark on standard error.
void remark(std::string_view sentence);

/// Makes sure that everything printed has arrived. Errors: UnwritableOutput (a full disk behind `>`).
Result<Done> finishPrinting();

/// The shortest text with `digits` significant digits, no trailing zeros.
[[nodiscard]] std::string shortNumber(double value, int digits = 5);

/// A number of things: "1 sphere", "8 spheres".
[[nodiscard]] std::string counted(std::size_t count, std::string_view one, std::string_view many);

}  // namespace spheretree::cli
