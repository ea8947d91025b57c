// SPDX-License-Identifier: GPL-3.0-or-later
#include <spheretree/sph.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "counted_heap.hpp"

namespace spheretree {
namespace {

using namespace std::string_literals;
using namespace std::string_view_literals;

/// What parseSph promises, and what an error message and the odd warning may cost on top of it.
constexpr std::size_t kHeapPerByte = 16;
constexpr std::size_t kHeapBeside = 2048;

/// One small file of each dialect.
const std::vector<std::string>& seeds() {
  static const std::vector<std::string> texts{
      // The classic toolkit: five numbers, six decimals, unused slots, its own text behind the rows.
      "3 2\n-0.020989 -0.021209 -0.062126 0.641599 1.000000\n0.128566 -0.218481 0.082023 0.383227 1.000000\n"
      "-0.132057 -0.135821 0.082999 0.330762 1.000000\n-0.301075 0.097724 0.101292 0.285660 1.000000\n"
      "0.000000 0.000000 0.000000 -1.000000 0.000000\n0.100000 0.000000 0.000000 0.250000 1.000000\n"
      "0.000000 0.000000 0.000000 -0.000000 0.000000\n\n\nOptions :\n\ttesterLevels\t: 2\n\tbranch\t\t: 2\n\n"
      "Evaluation :\n\tLevel 0\n\t\tNum\t: 1\n\t\tWorst\t: 963.648\n",
      // Four numbers, Windows line ends, leading blanks, exponents, no break at the end.
      "2 3\r\n  0 0 0 2.5e+00\r\n\t-1 0 0 1.5E0\r\n  1e-3 0 0 1\r\n 0 0 0 0",
      // Ten numbers, an auxiliary sphere in each row.
      "2 2\n0 0 0 2 1 0 0 0 2.5 1\n-1 0 0 1.5 1 -1 0 0 1.75 1\n1 0 0 1.25 1 1 0 0 1.5 1\n",
      // Our own dialect.
      "3 2\n0 0 0 2 1\n0.100000001 -0 1e+10 1 1\n0 0 0 -1 0\n1.17549435e-38 2 3 0.5 1\n0 0 0 -1 0\n0 0 0 -1 "
      "0\n"
      "0 0 0 -1 0\n# format: 1\n# builder: grid\n# frame: mesh\n",
      // A chain, rows too many, a byte order mark.
      "\xEF\xBB\xBF"
      "3 1\n0 0 0 3 1\n1 0 0 2 1\n2 0 0 1 1\n3 0 0 1 1\n"};
  return texts;
}

/// Parses from a heap block of exactly the text's size, so that a sanitizer sees any byte read too many.
Result<SphFile> parseTight(std::string_view text, std::size_t levels) {
  const std::unique_ptr<char[]> copy(new char[text.size()]);
  text.copy(copy.get(), text.size());
  return parseSph({copy.get(), text.size()}, {levels});
}

bool isOneCleanLine(const std::string& message) {
  return !message.empty() &&
         std::all_of(message.begin(), message.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

void expectSound(const SphereTree& tree) {
  const auto nodes = tree.nodes();
  std::size_t next = 1;  // where the next run of children must begin
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Sphere& ball = nodes[i].ball;
    ASSERT_TRUE(std::isfinite(ball.center.x) && std::isfinite(ball.center.y) && std::isfinite(ball.center.z));
    ASSERT_TRUE(std::isfinite(ball.radius) && ball.radius >= 0);
    for (const Node& child : tree.children(nodes[i])) {
      ASSERT_EQ(&child, &nodes[next++]);
      ASSERT_EQ(child.parent, i);
    }
  }
  ASSERT_EQ(next, nodes.size());
  std::size_t onLevels = 0;
  for (std::size_t depth = 0; depth < tree.levelCount(); ++depth) onLevels += tree.level(depth).size();
  ASSERT_EQ(onLevels, nodes.size());
}

/// Writing what was read, reading that and writing it again must change nothing.
void expectStable(const SphFile& file) {
  const Result<std::string> text = formatSph(file.tree, file.branch);
  ASSERT_TRUE(text) << text.error().message;
  const Result<SphFile> again = parseSph(*text);
  ASSERT_TRUE(again) << again.error().message << "\n" << *text;
  ASSERT_TRUE(again->warnings.empty()) << again->warnings.front();
  ASSERT_EQ(again->tree.nodes().size(), file.tree.nodes().size());
  ASSERT_EQ(*formatSph(again->tree, again->branch), *text);
}

/// Any text at all: a sound tree or a clean sentence, and no more memory than promised.
void expectSurvived(std::string_view text, std::size_t levels) {
  const std::unique_ptr<char[]> copy(new char[text.size()]);
  text.copy(copy.get(), text.size());
  const fuzz::HeapWatch heap;
  const Result<SphFile> file = parseSph({copy.get(), text.size()}, {levels});
  ASSERT_LE(heap.peak(), kHeapPerByte * text.size() + kHeapBeside);
  if (!file) {
    ASSERT_EQ(file.error().code, ErrorCode::UnreadableInput);
    ASSERT_TRUE(isOneCleanLine(file.error().message)) << file.error().message;
    ASSERT_TRUE(file.error().message.starts_with("line ")) << file.error().message;
    return;
  }
  for (const std::string& warning : file->warnings) ASSERT_TRUE(isOneCleanLine(warning)) << warning;
  ASSERT_LE(file->tree.levelCount(), levels);
  ASSERT_LE(file->tree.maxChildren(), file->branch);
  expectSound(file->tree);
  expectStable(*file);
}

TEST(SphFuzz, EverySeedIsReadable) {
  for (const std::string& seed : seeds()) {
    const Result<SphFile> file = parseTight(seed, SphLoadLimits{}.levels);
    EXPECT_TRUE(file) << file.error().message << "\n" << seed;
  }
}

TEST(SphFuzz, EveryTruncationIsATreeOrACleanError) {
  for (const std::string& seed : seeds()) {
    for (std::size_t length = 0; length <= seed.size(); ++length) {
      for (const std::size_t levels : {std::size_t{1}, std::size_t{2}, SphLoadLimits{}.levels}) {
        SCOPED_TRACE("the first " + std::to_string(length) + " bytes, " + std::to_string(levels) +
                     " levels of\n" + seed);
        ASSERT_NO_FATAL_FAILURE(expectSurvived(std::string_view(seed).substr(0, length), levels));
      }
    }
  }
}

TEST(SphFuzz, ATruncatedTableIsNeverTakenForAWholeOne) {
  const std::string& classic = seeds().front();
  const std::size_t endOfRows = classic.find("\n\n");
  for (std::size_t length = 0; length + 1 < endOfRows; ++length) {
    const Result<SphFile> file =
        parseTight(std::string_view(classic).substr(0, length), SphLoadLimits{}.levels);
    const bool insideLastNumber =
        length > classic.rfind(' ', endOfRows) + 1;  // its importance, which nobody uses
    EXPECT_TRUE(!file || !file->warnings.empty() || insideLastNumber) << length << " bytes";
  }
}

/// Words that have broken number readers before.
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

class Mutator {
 public:
  explicit Mutator(std::uint32_t seed) : random_(seed) {}

  std::string next() {
    std::string text = seeds()[below(seeds().size())];
    for (std::size_t changes = 1 + below(4); changes > 0; --changes) change(text);
    return text;
  }
  std::size_t below(std::size_t bound) { return static_cast<std::size_t>(random_()) % bound; }

 private:
  void change(std::string& text) {
    if (text.empty()) return;
    const std::size_t at = below(text.size());
    const std::size_t length = 1 + below(std::min<std::size_t>(24, text.size() - at));
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
        replaceWord(text, below(4));
        break;  // the header
      default: {
        const std::string& other = seeds()[below(seeds().size())];
        text = text.substr(0, at) + other.substr(below(other.size()));
      }
    }
  }
  void replaceWord(std::string& text, std::size_t at) {
    constexpr std::string_view kBreaks = " \t\r\n";
    if (at >= text.size()) return;
    const std::size_t before = text.find_last_of(kBreaks, at);
    const std::size_t begin = before == std::string::npos ? 0 : before + 1;
    const std::size_t end = std::min(text.find_first_of(kBreaks, begin), text.size());
    text.replace(begin, end - begin, kNastyWords[below(std::size(kNastyWords))]);
  }

  std::mt19937 random_;
};

TEST(SphFuzz, TwentyThousandMutationsAreTreesOrCleanErrors) {
  constexpr std::uint32_t kSeed = 20240611;
  constexpr int kRounds = 20'000;
  Mutator mutator(kSeed);
  int readable = 0;
  for (int round = 0; round < kRounds; ++round) {
    const std::string text = mutator.next();
    const std::size_t levels = mutator.below(3) == 0 ? 1 + mutator.below(3) : SphLoadLimits{}.levels;
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", round " + std::to_string(round));
    ASSERT_NO_FATAL_FAILURE(expectSurvived(text, levels)) << text;
    if (parseTight(text, levels)) ++readable;
  }
  // Neither outcome may starve, or the mutations miss half of the reader.
  EXPECT_GT(readable, kRounds / 10);
  EXPECT_LT(readable, kRounds / 10 * 9);
}

TEST(SphFuzz, RandomBytesAreRefused) {
  constexpr std::uint32_t kSeed = 99;
  std::mt19937 random(kSeed);
  for (int round = 0; round < 2000; ++round) {
    std::string text(random() % 200, '\0');
    for (char& c : text) c = static_cast<char>(random());
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", round " + std::to_string(round));
    ASSERT_NO_FATAL_FAILURE(expectSurvived(text, SphLoadLimits{}.levels));
  }
}

/// Peak heap of one parse.
std::size_t heapFor(const std::string& text, std::size_t levels = SphLoadLimits{}.levels) {
  const fuzz::HeapWatch heap;
  const Result<SphFile> file = parseSph(text, {levels});
  return heap.peak();
}

TEST(SphHeap, TheWatchSeesAllocations) {
  const fuzz::HeapWatch heap;
  const std::vector<char> block(123'456);
  EXPECT_GE(heap.peak(), 123'456U);
}

TEST(SphHeap, LyingHeadersCostNothing) {
  std::string rows;
  for (int i = 0; i < 20; ++i) rows += "1 1 1 1 1\n";
  for (const std::string header :
       {"2000000000 8", "30 8", "10 8", "4 8", "21 8", "64 2", "33 2", "2 4294967295", "2000000000 1",
        "9223372036854775807 1", "99999999999999999999 99999999999999999999", "1 4294967295"}) {
    EXPECT_LE(heapFor(header + "\n" + rows), kHeapPerByte * rows.size()) << header;
  }
}

TEST(SphHeap, TheCostliestTextsStayInProportion) {
  constexpr std::size_t kRows = 20'000;
  std::string chain = std::to_string(kRows) + " 1\n";  // every ball a level of its own
  std::string star = "2 " + std::to_string(kRows - 1) + "\n";
  std::string metadata = "1 8\n1 1 1 1\n";
  std::string extraRows = metadata;
  std::string breaks = metadata;
  for (std::size_t i = 0; i < kRows; ++i) {
    chain += "1 1 1 1\n";
    star += "1 1 1 1\n";
    metadata += "#a:\n";
    extraRows += "1 1 1 1\n";
    breaks += "#\n\n";
  }
  for (const std::string& text : {chain, star, metadata, extraRows, breaks}) {
    const Result<SphFile> file = parseSph(text);
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_LE(heapFor(text), kHeapPerByte * text.size() + kHeapBeside) << text.substr(0, 30);
  }
}

TEST(SphHeap, APrefixCostsWhatAPrefixHolds) {
  std::string text = "7 8\n";
  constexpr std::size_t kRows = (1U << 21U) / 7;  // (8^7 - 1) / 7, rounded down
  for (std::size_t i = 0; i < kRows; ++i) text += "1 1 1 1\n";
  constexpr std::size_t kPrefixBytes = 73 * 8;
  EXPECT_LE(heapFor(text, 3), kHeapPerByte * kPrefixBytes + kHeapBeside);
}

}  // namespace
}  // namespace spheretree
