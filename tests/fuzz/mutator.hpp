// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace spheretree::fuzz {

/// Words that have broken readers of numbers and of text before.
[[nodiscard]] std::span<const std::string_view> nastyWords();

/// Turns seeds into inputs that are nearly right: the same sequence on every machine.
class Mutator {
 public:
  /// `seeds` must not be empty. Words of the first line, the header, are replaced as often as all others
  /// together; `words` are what they are replaced by.
  Mutator(std::vector<std::string> seeds, std::vector<std::string_view> words, std::uint32_t seed)
      : seeds_(std::move(seeds)), words_(std::move(words)), random_(seed) {}

  /// A seed with one to four changes.
  std::string next();
  /// A number in [0, bound).
  std::size_t below(std::size_t bound) { return static_cast<std::size_t>(random_()) % bound; }

 private:
  void change(std::string& text);
  void replaceWord(std::string& text, std::size_t at);

  std::vector<std::string> seeds_;
  std::vector<std::string_view> words_;
  std::mt19937 random_;
};

}  // namespace spheretree::fuzz
