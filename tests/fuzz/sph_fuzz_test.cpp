// SPDX-License-Identifier: GPL-3.0-or-later
#include <spheretree/sph.hpp>

#include <cstdlib>
#include <new>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "counted_heap.hpp"
#include "mutator.hpp"
#include "sph_checks.hpp"

namespace spheretree {
namespace {

using namespace std::string_literals;
using namespace std::string_view_literals;

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

TEST(SphFuzz, EverySeedIsReadable) {
  for (const std::string& seed : seeds()) {
    const Result<SphFile> file = fuzz::parseTight(seed, SphLoadLimits{}.levels);
    EXPECT_TRUE(file) << file.error().message << "\n" << seed;
  }
}

TEST(SphFuzz, EveryTruncationIsATreeOrACleanError) {
  for (const std::string& seed : seeds()) {
    for (std::size_t length = 0; length <= seed.size(); ++length) {
      for (const std::size_t levels : {std::size_t{1}, std::size_t{2}, SphLoadLimits{}.levels}) {
        ASSERT_EQ(fuzz::codecFlaw(std::string_view(seed).substr(0, length), levels), "")
            << "the first " << length << " bytes, " << levels << " levels of\n"
            << seed;
      }
    }
  }
}

TEST(SphFuzz, ATruncatedTableIsNeverTakenForAWholeOne) {
  const std::string& classic = seeds().front();
  const std::size_t endOfRows = classic.find("\n\n");
  for (std::size_t length = 0; length + 1 < endOfRows; ++length) {
    const Result<SphFile> file =
        fuzz::parseTight(std::string_view(classic).substr(0, length), SphLoadLimits{}.levels);
    const bool insideLastNumber =
        length > classic.rfind(' ', endOfRows) + 1;  // its importance, which nobody uses
    EXPECT_TRUE(!file || !file->warnings.empty() || insideLastNumber) << length << " bytes";
  }
}

/// How many mutations are tried: a quick run's worth, or SPHERETREE_MUTATIONS of them.
std::uint64_t wantedMutations() {
  constexpr std::uint64_t kQuick = 20'000;
  const char* text = std::getenv("SPHERETREE_MUTATIONS");  // NOLINT(concurrency-mt-unsafe)
  return text == nullptr ? kQuick : std::strtoull(text, nullptr, 10);
}

TEST(SphFuzz, MutationsAreTreesOrCleanErrors) {
  constexpr std::uint32_t kSeed = 20240611;
  const std::uint64_t rounds = wantedMutations();
  const auto words = fuzz::nastyWords();
  fuzz::Mutator mutator(seeds(), {words.begin(), words.end()}, kSeed);
  std::uint64_t readable = 0;
  for (std::uint64_t round = 0; round < rounds; ++round) {
    const std::string text = mutator.next();
    const std::size_t levels = mutator.below(3) == 0 ? 1 + mutator.below(3) : SphLoadLimits{}.levels;
    ASSERT_EQ(fuzz::codecFlaw(text, levels), "") << "seed " << kSeed << ", round " << round << "\n" << text;
    const Result<SphFile> file = fuzz::parseTight(text, levels);
    if (!file) continue;
    ++readable;
    ASSERT_EQ(fuzz::queryFlaw(*file, round), "") << "seed " << kSeed << ", round " << round << "\n" << text;
  }
  RecordProperty("mutations", std::to_string(rounds));
  RecordProperty("readable", std::to_string(readable));
  // Neither outcome may starve, or the mutations miss half of the reader.
  EXPECT_GT(readable, rounds / 10);
  EXPECT_LT(readable, rounds / 10 * 9);
}

TEST(SphFuzz, RandomBytesAreRefused) {
  constexpr std::uint32_t kSeed = 99;
  std::mt19937 random(kSeed);
  for (int round = 0; round < 2000; ++round) {
    std::string text(random() % 200, '\0');
    for (char& c : text) c = static_cast<char>(random());
    ASSERT_EQ(fuzz::codecFlaw(text, SphLoadLimits{}.levels), "") << "seed " << kSeed << ", round " << round;
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
  void* const block = ::operator new(123'456);  // a vector that nobody reads may be optimised away
  EXPECT_GE(heap.peak(), 123'456U);
  ::operator delete(block);
}

TEST(SphHeap, LyingHeadersCostNothing) {
  std::string rows;
  for (int i = 0; i < 20; ++i) rows += "1 1 1 1 1\n";
  for (const std::string header :
       {"2000000000 8", "30 8", "10 8", "4 8", "21 8", "64 2", "33 2", "2 4294967295", "2000000000 1",
        "9223372036854775807 1", "99999999999999999999 99999999999999999999", "1 4294967295"}) {
    EXPECT_LE(heapFor(header + "\n" + rows), fuzz::kHeapPerByte * rows.size()) << header;
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
    EXPECT_LE(heapFor(text), fuzz::kHeapPerByte * text.size() + fuzz::kHeapBeside) << text.substr(0, 30);
  }
}

TEST(SphHeap, APrefixCostsWhatAPrefixHolds) {
  std::string text = "7 8\n";
  constexpr std::size_t kRows = (1U << 21U) / 7;  // (8^7 - 1) / 7, rounded down
  for (std::size_t i = 0; i < kRows; ++i) text += "1 1 1 1\n";
  constexpr std::size_t kPrefixBytes = 73 * 8;
  EXPECT_LE(heapFor(text, 3), fuzz::kHeapPerByte * kPrefixBytes + fuzz::kHeapBeside);
}

}  // namespace
}  // namespace spheretree
