// SPDX-License-Identifier: GPL-3.0-or-later
#include <spheretree/sph.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace spheretree {
namespace {

using namespace std::string_literals;

using Entry = SphereTree::Entry;
using Metadata = std::vector<std::pair<std::string, std::string>>;

SphereTree makeTree(const std::vector<Entry>& entries) {
  Result<SphereTree> tree = SphereTree::create(entries);
  EXPECT_TRUE(tree) << tree.error().message;
  return std::move(tree).value();
}

std::vector<std::uint32_t> bitsOf(const Sphere& ball) {
  return {std::bit_cast<std::uint32_t>(ball.center.x), std::bit_cast<std::uint32_t>(ball.center.y),
          std::bit_cast<std::uint32_t>(ball.center.z), std::bit_cast<std::uint32_t>(ball.radius)};
}

/// Any finite float with the same chance, denormals and negative zero included.
float anyFloat(std::mt19937& random) {
  for (;;) {
    const float value = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    if (std::isfinite(value)) return value;
  }
}

/// A random tree with at most `branch` children a node and balls all over the range of float.
SphereTree randomTree(std::mt19937& random, std::uint32_t branch, std::size_t levels) {
  const auto ball = [&] {
    return Sphere{{anyFloat(random), anyFloat(random), anyFloat(random)}, std::abs(anyFloat(random))};
  };
  std::vector<Entry> entries{{ball(), kNoParent}};
  std::size_t begin = 0;
  for (std::size_t depth = 1; depth < levels; ++depth) {
    const std::size_t end = entries.size();
    for (std::size_t parent = begin; parent < end; ++parent) {
      const auto children = static_cast<std::uint32_t>(random() % (branch + 1));
      for (std::uint32_t k = 0; k < children; ++k)
        entries.push_back({ball(), static_cast<std::uint32_t>(parent)});
    }
    begin = end;
  }
  return makeTree(entries);
}

std::string refusalOf(const Result<std::string>& text) {
  if (text) return "accepted";
  EXPECT_EQ(text.error().code, ErrorCode::InvalidArgument);
  return text.error().message;
}

TEST(SphWriter, WritesTheStrictDialect) {
  const SphereTree tree = makeTree({{{{0.1F, -0.0F, 1e10F}, 2}, kNoParent},
                                    {{{1, 2, 3}, 1}, 0},
                                    {{{4, 5, 6}, 1}, 0},
                                    {{{7, 8, 9}, 0.5F}, 2}});
  const Result<std::string> text = formatSph(tree, 3, {{"format", "1"}, {"note", ""}});
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_EQ(*text,
            "3 3\n"
            "0.100000001 -0 1e+10 2 1\n"
            "1 2 3 1 1\n4 5 6 1 1\n0 0 0 -1 0\n"
            "0 0 0 -1 0\n0 0 0 -1 0\n0 0 0 -1 0\n"
            "7 8 9 0.5 1\n0 0 0 -1 0\n0 0 0 -1 0\n"
            "0 0 0 -1 0\n0 0 0 -1 0\n0 0 0 -1 0\n"
            "# format: 1\n# note: \n");
}

TEST(SphWriter, WhatIsWrittenReadsBackBitForBit) {
  constexpr std::uint32_t kSeed = 7;
  std::mt19937 random(kSeed);
  for (int round = 0; round < 200; ++round) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", round " + std::to_string(round));
    const auto branch = static_cast<std::uint32_t>(1 + random() % 8);
    const SphereTree tree = randomTree(random, branch, 1 + random() % 4);
    const Result<std::string> text = formatSph(tree, branch, {{"round", std::to_string(round)}});
    ASSERT_TRUE(text) << text.error().message;
    const Result<SphFile> file = parseSph(*text);
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_TRUE(file->warnings.empty());
    EXPECT_EQ(file->branch, branch);
    ASSERT_EQ(file->tree.nodes().size(), tree.nodes().size());
    ASSERT_EQ(file->tree.levelCount(), tree.levelCount());
    for (std::size_t i = 0; i < tree.nodes().size(); ++i) {
      ASSERT_EQ(bitsOf(file->tree.nodes()[i].ball), bitsOf(tree.nodes()[i].ball)) << "node " << i;
      ASSERT_EQ(file->tree.nodes()[i].parent, tree.nodes()[i].parent) << "node " << i;
    }
    const Result<std::string> again = formatSph(file->tree, file->branch, file->metadata);
    ASSERT_TRUE(again) << again.error().message;
    ASSERT_EQ(*again, *text);
  }
}

TEST(SphWriter, APointAtTheOriginIsNotLost) {
  const SphereTree tree =
      makeTree({{{{0, -0.0F, 0}, 0}, kNoParent}, {{{0, 0, 0}, 0}, 0}, {{{1, 0, 0}, 0}, 0}});
  const Result<std::string> text = formatSph(tree, 2);
  ASSERT_TRUE(text) << text.error().message;
  const Result<SphFile> file = parseSph(*text);
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_EQ(file->tree.nodes().size(), 3U);
  EXPECT_EQ(file->tree.nodes()[1].ball, (Sphere{{0, 0, 0}, std::numeric_limits<float>::min()}));
  EXPECT_EQ(file->tree.nodes()[2].ball, (Sphere{{1, 0, 0}, 0}));
  EXPECT_EQ(*formatSph(file->tree, 2), *text);
}

TEST(SphWriter, MetadataReadsBackToTheLetter) {
  const Metadata metadata{
      {"mesh", " with: colon, blanks and # "}, {"mesh", "again"}, {"#odd key", "\xC3\xA4\t"}, {"e", ""}};
  const Result<std::string> text = formatSph(makeTree({{{{0, 0, 0}, 1}, kNoParent}}), 8, metadata);
  ASSERT_TRUE(text) << text.error().message;
  const Result<SphFile> file = parseSph(*text);
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->metadata, metadata);
}

TEST(SphWriter, RefusesMetadataThatCouldNotBeReadBack) {
  const SphereTree tree = makeTree({{{{0, 0, 0}, 1}, kNoParent}});
  const auto refusal = [&](const std::string& key, const std::string& value) {
    return refusalOf(formatSph(tree, 8, {{key, value}}));
  };
  const std::string lineBreak = ": a key or value holds a line break or a NUL";
  EXPECT_EQ(refusal("k", "a\nb"), "metadata 'k'" + lineBreak);
  EXPECT_EQ(refusal("k", "a\r"), "metadata 'k'" + lineBreak);
  EXPECT_EQ(refusal("k", "a\0b"s), "metadata 'k'" + lineBreak);
  EXPECT_NE(refusal("a\nb", "v").find(lineBreak), std::string::npos);
  EXPECT_EQ(refusal("", "v"), "a metadata key is empty");
  const std::string badKey = ": a key holds a colon or begins or ends with a blank";
  EXPECT_EQ(refusal("a:b", "v"), "metadata 'a:b'" + badKey);
  EXPECT_EQ(refusal(" a", "v"), "metadata ' a'" + badKey);
  EXPECT_EQ(refusal("a\t", "v"), "metadata 'a\t'" + badKey);
}

TEST(SphWriter, RefusesABranchingFactorThatIsTooSmall) {
  const SphereTree tree = makeTree({{{{0, 0, 0}, 2}, kNoParent}, {{{0, 0, 0}, 1}, 0}, {{{0, 0, 0}, 1}, 0}});
  EXPECT_EQ(refusalOf(formatSph(tree, 1)), "a node has 2 children, more than the branching factor 1");
  EXPECT_EQ(refusalOf(formatSph(tree, 0)), "a branching factor of 0 holds no tree");
  EXPECT_EQ(refusalOf(formatSph(tree, 2)), "accepted");
}

TEST(SphWriter, RefusesATableThatIsTooLarge) {
  std::vector<Entry> chain{{{{0, 0, 0}, 1}, kNoParent}};
  for (std::uint32_t i = 0; i < 99; ++i) chain.push_back({{{0, 0, 0}, 1}, i});
  EXPECT_EQ(refusalOf(formatSph(makeTree(chain), 1)), "accepted");
  EXPECT_EQ(refusalOf(formatSph(makeTree(chain), 8)), "100 levels of branch 8 need more than 100000000 rows");
  chain.resize(2);
  EXPECT_EQ(refusalOf(formatSph(makeTree(chain), 4'000'000'000U)),
            "2 levels of branch 4000000000 need more than 100000000 rows");
}

}  // namespace
}  // namespace spheretree
