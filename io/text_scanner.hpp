// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include <spheretree/result.hpp>

namespace spheretree::io {

/// Cuts a text into lines, and lines into words, and counts the lines. Views into the text; no allocation.
class TextScanner {
 public:
  explicit TextScanner(std::string_view text) : rest_(text) {}

  /// The next line without its end (LF, CRLF or CR), nothing at the end of the text.
  std::optional<std::string_view> nextLine() {
    if (rest_.empty()) return std::nullopt;
    const std::size_t end = rest_.find_first_of("\r\n");
    const std::string_view line = rest_.substr(0, end);
    if (end == std::string_view::npos) {
      rest_ = {};
    } else {
      const bool pair = rest_[end] == '\r' && end + 1 < rest_.size() && rest_[end + 1] == '\n';
      rest_.remove_prefix(end + (pair ? 2 : 1));
    }
    ++line_;
    return line;
  }

  /// The next line that holds a word once everything after `comment` is cut off.
  std::optional<std::string_view> nextFullLine(char comment) {
    while (std::optional<std::string_view> line = nextLine()) {
      const std::string_view text = line->substr(0, line->find(comment));
      if (text.find_first_not_of(" \t\v\f") != std::string_view::npos) return text;
    }
    return std::nullopt;
  }

  /// Of the line that was read last; the first one is 1.
  [[nodiscard]] std::size_t lineNumber() const { return line_; }
  [[nodiscard]] std::string_view rest() const { return rest_; }

  [[nodiscard]] Error error(const std::string& what) const {
    return {ErrorCode::UnreadableInput, "line " + std::to_string(line_) + ": " + what};
  }

 private:
  std::string_view rest_;
  std::size_t line_ = 0;
};

/// Takes the first word off `text`; empty when there is none.
inline std::string_view takeWord(std::string_view& text) {
  constexpr std::string_view kBlanks = " \t\v\f\r\n";
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) {
    text = {};
    return {};
  }
  text.remove_prefix(begin);
  const std::size_t end = std::min(text.find_first_of(kBlanks), text.size());
  const std::string_view word = text.substr(0, end);
  text.remove_prefix(end);
  return word;
}

/// The whole word as a whole number, or nothing.
inline std::optional<long long> parseInteger(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  long long value = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (code != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// The whole word as a finite number, correctly rounded, or nothing. Independent of the locale.
inline std::optional<double> parseNumber(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size()) return std::nullopt;
  // Out of range is too large, or too small to tell from zero.
  if (code == std::errc::result_out_of_range && word.find("e-") != std::string_view::npos) return 0.0;
  if (code != std::errc{} || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// A word of the input as it may stand in a message: short and printable.
inline std::string quoted(std::string_view word) {
  constexpr std::size_t kLongest = 40;
  std::string text = "\"";
  for (const char letter : word.substr(0, kLongest)) {
    const bool printable = std::isprint(static_cast<unsigned char>(letter)) != 0;
    text += printable ? letter : '?';
  }
  return text + (word.size() > kLongest ? "...\"" : "\"");
}

/// Text formats hold no zero byte; a file that does is something else.
inline bool looksBinary(std::string_view text) {
  return text.find('\0') != std::string_view::npos;
}

}  // namespace spheretree::io
