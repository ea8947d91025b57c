// SPDX-License-Identifier: GPL-3.0-or-later
#include "mutator.hpp"

#include <algorithm>

namespace spheretree::fuzz {

namespace {

using namespace std::string_view_literals;

constexpr std::string_view kNastyWords[] = {"nan"sv,
                                            "-inf"sv,
                                            "1e999"sv,
                                            "-1e-999"sv,
                                            "-1"sv,
                                            "-0.000000"sv,
                                            "99999999999999999999"sv,
                                            "4294967296"sv,
                                            "2147483647"sv,
                                            "0x10"sv,
                                            "1e"sv,
                                            "."sv,
                                            "-"sv,
                                            "+"sv,
                                            "\0"sv,
                                            "\r"sv,
                                            "\n"sv,
                                            "\n\n"sv,
                                            "# k: v\n"sv,
                                            "#:"sv,
                                            "3.4028236e38"sv,
                                            "1e-45"sv,
                                            "NIST_1A"sv,
                                            "\xFF\xFE"sv,
                                            " "sv,
                                            "0 0 0 -1 0\n"sv,
                                            "1 1 1 1 1\n"sv};

constexpr std::size_t kLongestPiece = 24;  // of what is erased or repeated
constexpr std::size_t kHeaderBytes = 4;

}  // namespace

std::span<const std::string_view> nastyWords() {
  return kNastyWords;
}

std::string Mutator::next() {
  std::string text = seeds_[below(seeds_.size())];
  for (std::size_t changes = 1 + below(4); changes > 0; --changes) change(text);
  return text;
}

void Mutator::change(std::string& text) {
  if (text.empty()) return;
  const std::size_t at = below(text.size());
  const std::size_t length = 1 + below(std::min(kLongestPiece, text.size() - at));
  switch (below(7)) {
    case 0:
      text[at] = static_cast<char>(below(256));
      break;
    case 1:
      text[at] = static_cast<char>(text[at] ^ (1 << below(8)));
      break;
    case 2:
      text.erase(at, length);
      break;
    case 3:
      text.insert(below(text.size()), text.substr(at, length));
      break;
    case 4:
      replaceWord(text, at);
      break;
    case 5:
      replaceWord(text, below(kHeaderBytes));
      break;
    default: {
      const std::string& other = seeds_[below(seeds_.size())];
      text = text.substr(0, at) + other.substr(other.empty() ? 0 : below(other.size()));
    }
  }
}

void Mutator::replaceWord(std::string& text, std::size_t at) {
  constexpr std::string_view kBreaks = " \t\r\n";
  if (at >= text.size()) return;
  const std::size_t before = text.find_last_of(kBreaks, at);
  const std::size_t begin = before == std::string::npos ? 0 : before + 1;
  const std::size_t end = std::min(text.find_first_of(kBreaks, begin), text.size());
  text.replace(begin, end - begin, words_[below(words_.size())]);
}

}  // namespace spheretree::fuzz
