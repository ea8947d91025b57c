// SPDX-License-Identifier: GPL-3.0-or-later
#include <spheretree/sph.hpp>

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace spheretree {
namespace {

using namespace std::string_literals;
using namespace std::string_view_literals;

using Parents = std::vector<std::uint32_t>;

constexpr std::uint32_t kRoot = kNoParent;

/// A root and its two children, the same in every dialect.
constexpr std::string_view kFiveNumbers = "2 2\n0 0 0 2 1\n-1 0 0 1.5 1\n1 0 0 1.25 1\n";

/// Parses a copy without a terminator, so that a sanitizer sees any byte read too many.
Result<SphFile> parse(std::string_view text, std::size_t levels = SphLoadLimits{}.levels) {
  const std::unique_ptr<char[]> copy(new char[text.size()]);
  text.copy(copy.get(), text.size());
  return parseSph({copy.get(), text.size()}, {levels});
}

std::string refusalOf(std::string_view text, std::size_t levels = SphLoadLimits{}.levels) {
  const Result<SphFile> file = parse(text, levels);
  if (file) return "accepted";
  EXPECT_EQ(file.error().code, ErrorCode::UnreadableInput);
  return file.error().message;
}

Parents parentsOf(const SphereTree& tree) {
  Parents parents;
  for (const Node& node : tree.nodes()) parents.push_back(node.parent);
  return parents;
}

std::vector<float> xOf(const SphereTree& tree) {
  std::vector<float> xs;
  for (const Node& node : tree.nodes()) xs.push_back(node.ball.center.x);
  return xs;
}

void expectThreeBalls(std::string_view text) {
  const Result<SphFile> file = parse(text);
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->branch, 2U);
  EXPECT_TRUE(file->warnings.empty()) << file->warnings.front();
  const auto nodes = file->tree.nodes();
  ASSERT_EQ(nodes.size(), 3U);
  EXPECT_EQ(nodes[0].ball, (Sphere{{0, 0, 0}, 2}));
  EXPECT_EQ(nodes[1].ball, (Sphere{{-1, 0, 0}, 1.5F}));
  EXPECT_EQ(nodes[2].ball, (Sphere{{1, 0, 0}, 1.25F}));
  EXPECT_EQ(parentsOf(file->tree), (Parents{kRoot, 0, 0}));
}

TEST(SphReader, RowsOfFourFiveAndTenNumbers) {
  expectThreeBalls("2 2\n0 0 0 2\n-1 0 0 1.5\n1 0 0 1.25\n");
  expectThreeBalls(kFiveNumbers);
  expectThreeBalls("2 2\n0 0 0 2 1 9 9 9 9 1\n-1 0 0 1.5 1 9 9 9 9 1\n1 0 0 1.25 1 9 9 9 9 1\n");
  expectThreeBalls("2 2\n0 0 0 2 1\n-1 0 0 1.5 1 9 9 9 9 1\n1 0 0 1.25\n");
}

TEST(SphReader, LayoutOfTheTextDoesNotMatter) {
  expectThreeBalls("2 2\r\n0 0 0 2 1\r\n-1 0 0 1.5 1\r\n1 0 0 1.25 1\r\n");
  expectThreeBalls("2 2\n0 0 0 2 1\n-1 0 0 1.5 1\n1 0 0 1.25 1");
  expectThreeBalls("  2\t2 \n\t 0  0 0 2 1\n   -1 0 0 1.5 1\n1\t0\t0\t1.25\t1 \n");
  expectThreeBalls("\n\n2 2\n\n0 0 0 2 1\n \t\n-1 0 0 1.5 1\r\n\r\n1 0 0 1.25 1\n\n\n  ");
  expectThreeBalls("2 2\n0e0 0.E+5 .0 +2.000000e+00 1\n-1e+00 0 0 15e-1 1\n1 -0 0 0.00125E3 1\n");
  expectThreeBalls("\xEF\xBB\xBF" + std::string(kFiveNumbers));
}

TEST(SphReader, TextOfTheClassicToolkitAfterTheRowsIsIgnored) {
  expectThreeBalls(
      std::string(kFiveNumbers) +
      "\n\nOptions :\n\ttesterLevels\t: 2\n\tbranch\t\t: 8\n\terFact\t\t: 2.000000\n\tverify\t\t: FALSE\n"
      "\n\n\nEvaluation :\n\tLevel 0\n\t\tNum\t: 1\n\t\tWorst\t: 963.648\n\t\tMean\t: 8.790\n");
  expectThreeBalls(std::string(kFiveNumbers) + "Timings\n1 2 3 4 5\n3 levels, nan inf -1e999\n0 0 0 1 1\n");
}

TEST(SphReader, UnusedSlotsAreLeftOutAndTheOthersKeepTheirOrder) {
  // Slots:    0; 1 2 3; children of 1, of 2, of 3. Unused: 2 and all below, 4, 6, 12.
  const Result<SphFile> file = parse(
      "3 3\n10 0 0 9 1\n11 0 0 5 1\n0 0 0 -1.000000 0\n13 0 0 5 1\n"
      "14 0 0 -0.000000 1\n15 0 0 1 1\n0 0 0 0 1\n"
      "0 0 0 -1 0\n0 0 0 -3e30 0\n-0.0 0 0 0.0 0\n"
      "20 0 0 1 1\n21 0 0 1 1\n0 0 0 -1 0\n");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(xOf(file->tree), (std::vector<float>{10, 11, 13, 15, 20, 21}));
  EXPECT_EQ(parentsOf(file->tree), (Parents{kRoot, 0, 0, 1, 2, 2}));
  EXPECT_EQ(file->tree.levelCount(), 3U);
  EXPECT_EQ(file->branch, 3U);
}

TEST(SphReader, APointAwayFromTheOriginIsABall) {
  const Result<SphFile> file = parse("1 8\n1 0 0 0 1\n");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->tree.root().ball, (Sphere{{1, 0, 0}, 0}));
}

TEST(SphReader, ALevelWithoutBallsIsNotALevel) {
  const Result<SphFile> file = parse("2 2\n0 0 0 1 1\n0 0 0 -1 0\n0 0 0 -1 0\n");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->tree.levelCount(), 1U);
}

TEST(SphReader, OneLevelAndChains) {
  const Result<SphFile> single = parse("1 4294967295\n1 2 3 4 1\n");
  ASSERT_TRUE(single) << single.error().message;
  EXPECT_EQ(single->tree.nodes().size(), 1U);
  EXPECT_EQ(single->branch, 4294967295U);
  const Result<SphFile> chain = parse("4 1\n0 0 0 4 1\n1 0 0 3 1\n2 0 0 2 1\n3 0 0 1 1\n");
  ASSERT_TRUE(chain) << chain.error().message;
  EXPECT_EQ(parentsOf(chain->tree), (Parents{kRoot, 0, 1, 2}));
  EXPECT_EQ(chain->tree.levelCount(), 4U);
}

TEST(SphReader, NumbersAreTheNearestFloats) {
  const Result<SphFile> file = parse("1 8\n0.1 3.4028235e38 1e-45 1.17549435e-38 1\n");
  ASSERT_TRUE(file) << file.error().message;
  using Float = std::numeric_limits<float>;
  const Sphere expected{{0.1F, Float::max(), Float::denorm_min()}, Float::min()};
  EXPECT_EQ(file->tree.root().ball, expected);
}

TEST(SphReader, NumbersTooSmallForAFloatAreZero) {
  const std::string zeros(60, '0');
  for (const std::string& tiny :
       {"1e-60"s, "-123.4e-70"s, "0." + zeros + "1"s, "1e-99999999999999999999"s, "-0." + zeros + "1e10"s}) {
    const Result<SphFile> file = parse("1 8\n" + tiny + " 0 0 2 1\n");
    ASSERT_TRUE(file) << tiny << ": " << file.error().message;
    EXPECT_EQ(file->tree.root().ball.center.x, 0) << tiny;
    EXPECT_EQ(std::signbit(file->tree.root().ball.center.x), tiny.front() == '-') << tiny;
  }
}

TEST(SphReader, NumbersTooLargeForAFloatAreRefused) {
  const std::string zeros(60, '0');
  for (const std::string& huge : {"1e39"s, "-3.4028236e38"s, "1" + zeros, "1" + zeros + ".5e-3",
                                  "1e99999999999999999999"s, "0.001e60"s}) {
    EXPECT_EQ(refusalOf("1 8\n0 0 " + huge + " 2 1\n"), "line 2: '" + huge.substr(0, 24) +
                                                            (huge.size() > 24 ? "..." : "") +
                                                            "' is too large for single precision");
  }
}

TEST(SphReader, NonFiniteNumbersAreRefusedWhereverTheyStand) {
  for (const std::string word : {"nan", "NaN", "-nan", "inf", "-inf", "+INF", "Infinity", "nan(ind)"}) {
    for (std::size_t column = 0; column < 5; ++column) {
      std::string row;
      for (std::size_t i = 0; i < 5; ++i) row += (i == column ? word : "1") + ' ';
      EXPECT_NE(refusalOf("2 2\n0 0 0 2 1\n" + row + "\n1 0 0 1 1\n").find("line 3: '" + word + "' is not a"),
                std::string::npos)
          << refusalOf("2 2\n0 0 0 2 1\n" + row + "\n1 0 0 1 1\n");
    }
  }
}

TEST(SphReader, ImpossibleHeadersAreRefused) {
  EXPECT_EQ(refusalOf("0 8\n0 0 0 1 1\n"), "line 1: a tree has at least 1 level, not '0'");
  EXPECT_EQ(refusalOf("-3 8\n0 0 0 1 1\n"), "line 1: a tree has at least 1 level, not '-3'");
  EXPECT_EQ(refusalOf("3 0\n0 0 0 1 1\n"), "line 1: the branching factor is at least 1, not '0'");
  EXPECT_EQ(refusalOf("\n3 -8\n0 0 0 1 1\n"), "line 2: the branching factor is at least 1, not '-8'");
  EXPECT_EQ(refusalOf("1 4294967296\n0 0 0 1 1\n"),
            "line 1: the branching factor '4294967296' is out of range");
  EXPECT_EQ(refusalOf("-99999999999999999999 8\n0 0 0 1 1\n"),
            "line 1: a tree has at least 1 level, not '-99999999999999999999'");
}

TEST(SphReader, HeadersThatPromiseMoreRowsThanTheFileHoldsAreRefused) {
  EXPECT_EQ(refusalOf("30 8\n0 0 0 1 1\n"),
            "line 1: the header announces 30 levels of branching factor 8, more rows than can be counted");
  EXPECT_EQ(
      refusalOf("2000000000 8\n0 0 0 1 1\n"),
      "line 1: the header announces 2000000000 levels of branching factor 8, more rows than can be counted");
  EXPECT_EQ(
      refusalOf("99999999999999999999 2\n0 0 0 1 1\n"),
      "line 1: the header announces 9223372036854775807 levels of branching factor 2, more rows than can be "
      "counted");
  EXPECT_EQ(refusalOf("10 8\n0 0 0 1 1\n"),
            "line 1: the header announces 10 levels of branching factor 8: 153391689 rows do not fit in the "
            "10 bytes "
            "that follow, which hold at most 1");
  EXPECT_EQ(refusalOf("2000000000 1\n0 0 0 1 1\n"),
            "line 1: the header announces 2000000000 levels of branching factor 1: 2000000000 rows do not "
            "fit in the "
            "10 bytes that follow, which hold at most 1");
  EXPECT_EQ(refusalOf("2 2000000000\n0 0 0 1 1\n"),
            "line 1: the header announces 2 levels of branching factor 2000000000: 2000000001 rows do not "
            "fit in the "
            "10 bytes that follow, which hold at most 1");
}

TEST(SphReader, TheShortestPossibleRowsFit) {
  const Result<SphFile> file = parse("2 2\n1 1 1 1\n1 1 1 1\n1 1 1 1");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->tree.nodes().size(), 3U);
}

TEST(SphReader, EmptyFilesAreRefused) {
  EXPECT_EQ(refusalOf(""), "line 1: the file is empty");
  EXPECT_EQ(refusalOf("\xEF\xBB\xBF"), "line 1: the file is empty");
  EXPECT_EQ(refusalOf("\n \r\n\t"), "line 3: the file is empty");
  EXPECT_EQ(refusalOf("1 8\n\n        \n"), "line 4: the table ends before row 1 of the 1 announced");
  EXPECT_EQ(refusalOf("1 8\nno rows here\n"), "line 2: the table ends before row 1 of the 1 announced");
}

TEST(SphReader, OtherFormatsAreRecognised) {
  EXPECT_EQ(
      refusalOf("NIST_1A\n   1024\nsample_count -i 16000\nend_head\n\0\1\2"sv),
      "line 1: this is NIST SPHERE speech audio, which uses the extension .sph as well, not a sphere tree");
  const std::string hint = " (speech audio and antenna data use the extension .sph as well)";
  const std::string expected =
      "line 1: expected the two whole numbers 'levels branch' of a sphere tree, found ";
  EXPECT_EQ(refusalOf("GRASP spherical wave expansion\n 90 180 10 10\n"),
            expected + "'GRASP spherical wave exp...'" + hint);
  EXPECT_EQ(refusalOf("4.0 8\n0 0 0 1 1\n"), expected + "'4.0 8'" + hint);
  EXPECT_EQ(refusalOf("4 8 1\n0 0 0 1 1\n"), expected + "'4 8 1'" + hint);
  EXPECT_EQ(refusalOf("4\n8\n0 0 0 1 1\n"), expected + "'4'" + hint);
  EXPECT_EQ(refusalOf("2 2\r0 0 0 2 1\r-1 0 0 1 1\r1 0 0 1 1\r"), expected + "'2 2'" + hint);
  EXPECT_EQ(refusalOf("\x89PNG\r\n\x1a\n rest"), expected + "'?PNG'" + hint);
}

TEST(SphReader, BinaryContentIsRefusedWhereverItStands) {
  const std::string binary = ": binary content, not the text of a sphere tree";
  EXPECT_EQ(refusalOf("\x7F"
                      "ELF\2\1\1\0\0\0"sv),
            "line 1" + binary);
  EXPECT_EQ(refusalOf("2\0 \0002\0\n\0"sv), "line 1" + binary);
  EXPECT_EQ(refusalOf("1 8\n0 0 0\0 1 1\n"sv), "line 2" + binary);
  EXPECT_EQ(refusalOf("1 8\n0 0 0 \0 1 1\n"sv), "line 2" + binary);
  EXPECT_EQ(refusalOf("2 2\n0 0 0 2 1\n0 0 0 1 1\n\0\0\0\0\0\0\0\0"sv), "line 4" + binary);
  EXPECT_EQ(refusalOf("1 8\n0 0 0 1 1\nOptions\n\tx: \0\n"sv), "line 4" + binary);
}

TEST(SphReader, DamagedRowsAreRefused) {
  EXPECT_EQ(refusalOf("2 2\n0 0 0 2 1\n0 0 zero 1 1\n1 0 0 1 1\n"), "line 3: 'zero' is not a number");
  EXPECT_EQ(refusalOf("2 2\n0 0 0 2 1\n0,5 0 0 1 1\n1 0 0 1 1\n"), "line 3: '0,5' is not a number");
  EXPECT_EQ(refusalOf("2 2\n0 0 0 2 1\n1e 0 0 1 1\n1 0 0 1 1\n"), "line 3: '1e' is not a number");
  EXPECT_EQ(refusalOf("2 2\n0 0 0 2 1\n-1.#IND 0 0 1 1\n1 0 0 1 1\n"), "line 3: '-1.#IND' is not a number");
  EXPECT_EQ(refusalOf("2 2\n0 0 0 2 1\n+-1 0 0 1 1\n1 0 0 1 1\n"),
            "line 3: not a row of numbers, yet rows follow on line 4");
}

TEST(SphReader, RowsOfAnotherLengthAreRefused) {
  EXPECT_EQ(refusalOf("2 2\n0 0 0 2 1\n0 0 0\n1 0 0 1 1\n"),
            "line 3: row 2 of the 3 announced has 3 numbers, not 4, 5 or 10");
  EXPECT_EQ(refusalOf("2 2\n0 0 0 2 1\n0 0 0 1 1 1\n1 0 0 1 1\n"),
            "line 3: row 2 of the 3 announced has 6 numbers, not 4, 5 or 10");
  EXPECT_EQ(refusalOf("2 2\n0 0 0 2 1\n0 0 0 1 1 0 0 0 1 1 1\n1 0 0 1 1\n"),
            "line 3: row 2 of the 3 announced has 11 numbers, not 4, 5 or 10");
}

TEST(SphReader, ABallBelowAnUnusedSlotIsRefused) {
  EXPECT_EQ(refusalOf("3 2\n0 0 0 9 1\n1 0 0 1 1\n0 0 0 -1 0\n"
                      "1 0 0 1 1\n1 0 0 1 1\n1 0 0 1 1\n0 0 0 -1 0\n"),
            "line 7: the used row 6 hangs below the unused row 3");
  EXPECT_EQ(refusalOf("2 2\n0 0 0 -1 1\n0 0 0 -1 1\n0 0 0 -1 0\n"), "line 2: the root is an unused slot");
  EXPECT_EQ(refusalOf("1 2\n0 0 0 0 1\n"), "line 2: the root is an unused slot");
}

TEST(SphReader, RowsMissingAtTheEndCountAsUnused) {
  const std::string rows = "3 2\n0.000000 0 0 9 1\n1.000000 0 0 1 1\n2.000000 0 0 1 1\n3.000000 0 0 1 1\n";
  for (const std::string tail : {"", "\n\n", "Options :\n\tbranch\t: 2\n", "# builder: grid\n"}) {
    const Result<SphFile> file = parse(rows + tail);
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(xOf(file->tree), (std::vector<float>{0, 1, 2, 3}));
    ASSERT_EQ(file->warnings.size(), 1U);
    EXPECT_NE(file->warnings[0].find(
                  "the header announces 7 rows, the file holds 4; the missing 3 are taken as unused"),
              std::string::npos)
        << file->warnings[0];
  }
}

TEST(SphReader, AFileCutInsideARowIsRefusedWithTheCounts) {
  const std::string rows = "3 2\n0.000000 0.000000 0.000000 9 1\n1.000000 0 0 1 1\n2.000000 0 0 1 1\n";
  const std::string expected = "line 5: the text ends in the middle of row 4 of the 7 announced";
  EXPECT_EQ(refusalOf(rows + "3.000000 0 0 1 1"), expected);
  EXPECT_EQ(refusalOf(rows + "3.000000 0 0 1"), expected);
  EXPECT_EQ(refusalOf(rows + "3"), expected);
  EXPECT_EQ(refusalOf(rows + "-"), "line 5: '-' is not a number");
  EXPECT_EQ(refusalOf("2 2\n0 0 0 2 1\n1 0 0 1 1\n2 0 0 1"),
            "line 4: the text ends in the middle of row 3 of the 3 announced");
}

TEST(SphReader, ADamagedRowDoesNotPassForTheEndOfTheTable) {
  EXPECT_EQ(refusalOf("2 3\n0 0 0 2 1\nx1 0 0 1 1\n2 0 0 1 1\n3 0 0 1 1\n"),
            "line 3: not a row of numbers, yet rows follow on line 4");
}

TEST(SphReader, RowsTooManyAreIgnoredWithAWarning) {
  const Result<SphFile> file =
      parse(std::string(kFiveNumbers) + "\n5 0 0 1 1\n6 0 0 1 1\nEvaluation :\n1 2 3 4 5\n");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->tree.nodes().size(), 3U);
  ASSERT_EQ(file->warnings.size(), 1U);
  EXPECT_EQ(file->warnings[0],
            "line 6: the header announces 3 rows, the file holds 5; the last 2 are ignored");
}

TEST(SphReader, MetadataKeepsItsOrder) {
  const Result<SphFile> file =
      parse(std::string(kFiveNumbers) +
            "# format: 1\n#units:mm\n# plain comment\n  # note: a: b  \nOptions : 3\n#: x\n"
            "# note:\r\n# note: again");
  ASSERT_TRUE(file) << file.error().message;
  const std::vector<std::pair<std::string, std::string>> expected{
      {"format", "1"}, {"units", "mm"}, {"note", "a: b  "}, {"note", ""}, {"note", "again"}};
  EXPECT_EQ(file->metadata, expected);
}

TEST(SphReader, LoadingKLevelsReadsOnlyThatPrefix) {
  const std::string prefix = "3 2\n0 0 0 9 1\n1 0 0 1 1\n2 0 0 1 1\n";
  const std::string rest = "3 0 0 1 1\n4 0 0 1 1\n5 0 0 1 1\n6 0 0 1 1\n";
  const std::string garbage = "nan \0\xFF 1e999 0 0\n# key: value\n"s + std::string(100, '\0');
  for (const std::string& behind : {rest, garbage, ""s}) {
    const Result<SphFile> file = parse(prefix + behind, 2);
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(xOf(file->tree), (std::vector<float>{0, 1, 2}));
    EXPECT_EQ(file->tree.levelCount(), 2U);
    EXPECT_EQ(file->branch, 2U);
    EXPECT_TRUE(file->metadata.empty());
    EXPECT_TRUE(file->warnings.empty());
  }
  ASSERT_TRUE(parse(prefix, 1));
  EXPECT_EQ(parse(prefix, 1)->tree.nodes().size(), 1U);
  EXPECT_NE(refusalOf(prefix + garbage, 3), "accepted");
  EXPECT_NE(refusalOf(prefix, 3), "accepted");
}

TEST(SphReader, AsManyLevelsAsThereAreIsTheWholeFile) {
  const std::string text = std::string(kFiveNumbers) + "# builder: grid\n";
  for (const std::size_t levels : {std::size_t{2}, std::size_t{3}, SphLoadLimits{}.levels}) {
    const Result<SphFile> file = parse(text, levels);
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(file->tree.levelCount(), 2U);
    EXPECT_EQ(file->metadata.size(), 1U);
  }
}

TEST(SphReader, APrefixMayBeCutAnywhereBehindItsRows) {
  const std::string prefix = "3 2\n0 0 0 9 1\n1 0 0 1 1\n2 0 0 1 1\n";
  const Result<SphFile> cut = parse(prefix + "3 0 0", 2);
  ASSERT_TRUE(cut) << cut.error().message;
  EXPECT_EQ(refusalOf(prefix.substr(0, prefix.size() - 4), 2),
            "line 4: the text ends in the middle of row 3 of the 3 announced");
}

TEST(SphReader, NoLevelsAtAllIsAWrongWish) {
  const Result<SphFile> file = parse(kFiveNumbers, 0);
  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().code, ErrorCode::InvalidArgument);
}

}  // namespace
}  // namespace spheretree
