// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/console.hpp"

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <system_error>

namespace spheretree::cli {
namespace {

void toStandardError(std::string_view mark, std::string_view sentence) {
  std::fflush(stdout);
  std::string line = "spheretree: ";
  line.append(mark).append(sentence).append("\n");
  std::fwrite(line.data(), 1, line.size(), stderr);
}

}  // namespace

void print(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
}

ExitCode fail(const Error& error) {
  toStandardError("", error.message);
  return exitCodeOf(error.code);
}

void warn(std::string_view sentence) {
  toStandardError("warning: ", sentence);
}

void remark(std::string_view sentence) {
  toStandardError("", sentence);
}

Result<Done> finishPrinting() {
  errno = 0;
  const bool flushed = std::fflush(stdout) == 0;
  const int code = errno;
  if (flushed && std::ferror(stdout) == 0) return Done{};
  const std::string reason = code != 0 ? std::generic_category().message(code) : "a write failed";
  return Error{ErrorCode::UnwritableOutput, "standard output: " + reason};
}

std::string shortNumber(double value, int digits) {
  std::array<char, 32> text{};
  const auto [end, code] =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, digits);
  static_cast<void>(code);  // 32 characters hold any double with so few digits
  return {text.data(), end};
}

std::string counted(std::size_t count, std::string_view one, std::string_view many) {
  return std::to_string(count) + " " + std::string(count == 1 ? one : many);
}

}  // namespace spheretree::cli
