// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/manifest.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test_folder.hpp"

namespace spheretree::io {
namespace {

using testing::ElementsAre;
using testing::StartsWith;

class Manifest : public tests::InFolder {
 protected:
  std::vector<ManifestEntry> entriesOf(const std::string& name, const std::string& text) {
    Result<std::vector<ManifestEntry>> entries = readManifest(put(name, text));
    EXPECT_TRUE(entries.ok()) << (entries.ok() ? "" : entries.error().message);
    return entries.ok() ? std::move(*entries) : std::vector<ManifestEntry>{};
  }

  /// The sentence, without the path of the folder.
  std::string complaintOf(const std::string& name, const std::string& text) {
    const Result<std::vector<ManifestEntry>> entries = readManifest(put(name, text));
    if (entries.ok()) return "accepted";
    EXPECT_EQ(entries.error().code, ErrorCode::InvalidArgument);
    const std::string prefix = folder_.string() + "/";
    EXPECT_THAT(entries.error().message, StartsWith(prefix + name));
    return entries.error().message.substr(prefix.size());
  }
};

TEST_F(Manifest, EverySettingIsRead) {
  const std::vector<ManifestEntry> entries = entriesOf("a.json", R"({"assets": [{
    "input": "chair.obj", "output": "x/./chair.sph", "levels": 5, "max_error": 0.02, "branch": 4,
    "builder": "Octree", "quality": "best", "cover": "solid", "repair": "fill",
    "instances": 3, "scale": 2.5}]})");
  ASSERT_EQ(entries.size(), 1U);
  const ManifestEntry& entry = entries.front();
  EXPECT_EQ(entry.input, in("chair.obj"));
  EXPECT_EQ(entry.output, "x/chair.sph");
  EXPECT_EQ(entry.settings.levels, 5U);
  EXPECT_EQ(entry.settings.maxError, 0.02);
  EXPECT_EQ(entry.settings.branch, 4U);
  EXPECT_EQ(entry.settings.builder, "octree");
  EXPECT_EQ(entry.settings.quality, builders::Quality::Best);
  EXPECT_EQ(entry.settings.cover, builders::Cover::Solid);
  EXPECT_EQ(entry.settings.repair, Repair::Fill);
  ASSERT_TRUE(entry.scene.has_value());
  EXPECT_THAT(entry.scene->scales, ElementsAre(2.5, 2.5, 2.5));
  EXPECT_FALSE(entry.scene->tolerance.has_value());
}

TEST_F(Manifest, CsvSaysTheSameAsJson) {
  const std::vector<ManifestEntry> entries =
      entriesOf("a.csv",
                "\xEF\xBB\xBFinput, levels ,tolerance,instances\r\n\"my, \"\"chair\"\".obj\",5,,\r\n\r\n"
                "/abs/table.obj,,0.5,1 2 0.25\r\n");
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(entries[0].input, in("my, \"chair\".obj"));
  EXPECT_EQ(entries[0].settings.levels, 5U);
  EXPECT_FALSE(entries[0].scene.has_value());
  EXPECT_EQ(entries[1].input, "/abs/table.obj");
  EXPECT_FALSE(entries[1].settings.levels.has_value());
  EXPECT_EQ(entries[1].scene->tolerance, 0.5);
  EXPECT_THAT(entries[1].scene->scales, ElementsAre(1, 2, 0.25));
}

TEST_F(Manifest, DefaultsGoWhereNothingElseIsSaid) {
  const std::vector<ManifestEntry> entries = entriesOf(
      "a.json",
      R"({"defaults": {"levels": 2, "tolerance": 0.1}, "assets": [{"input": "a.obj"}, {"input": "b.obj", "levels": 6}]})");
  EXPECT_EQ(entries[0].settings.levels, 2U);
  EXPECT_EQ(entries[1].settings.levels, 6U);
  EXPECT_EQ(entries[1].scene->tolerance, 0.1);
}

struct Wrong {
  std::string text;
  std::string complaint;
};

TEST_F(Manifest, JsonComplaintsNameFilePlaceAndReason) {
  const std::vector<Wrong> all = {
      {"{\"assets\": [\n  {\"input\": \"a.obj\",}]}", "m.json: line 2, column 21: is not JSON"},
      {"{\"assets\": [{\"input\": \"a.obj\", \"scale\": 1e999}]}", "m.json: has a number that is too large"},
      {"[]", "m.json: must be an object with a list 'assets'"},
      {R"({"assets": {}})", "m.json: must be an object with a list 'assets'"},
      {R"({"assets": []})", "m.json: names no asset"},
      {R"({"assets": [], "asets": []})", "m.json: there is no part 'asets'; there are assets, defaults"},
      {R"({"assets": ["a.obj"]})", "m.json: assets[0]: must be an object"},
      {R"({"assets": [{"input": "a.obj"}, {"levels": 3}]})", "m.json: assets[1]: has no input"},
      {R"({"assets": [{"input": 7}]})", "m.json: assets[0].input: must be a text, not the number 7"},
      {R"({"assets": [{"input": ""}]})", "m.json: assets[0].input: is empty"},
      {R"({"assets": [{"input": ["a", "b"]}]})", "m.json: assets[0].input: must be one value, not a list"},
      {R"({"assets": [{"input": "a.obj", "levels": true}]})",
       "m.json: assets[0].levels: must be a number, a text or a list of them"},
      {R"({"assets": [{"input": "a.obj", "levels": 0}]})",
       "m.json: assets[0].levels: '0' is not a whole number in [1, 24]"},
      {R"({"assets": [{"input": "a.obj", "levels": 2.5}]})",
       "m.json: assets[0].levels: '2.5' is not a whole number in [1, 24]"},
      {R"({"assets": [{"input": "a.obj", "levels": "3"}]})", "m.json: assets[0].levels: '3' is not a number"},
      {R"({"assets": [{"input": "a.obj", "branch": 1}]})",
       "m.json: assets[0].branch: '1' is not a whole number in [2, 4096]"},
      {R"({"assets": [{"input": "a.obj", "max_error": 2}]})",
       "m.json: assets[0].max_error: '2' is not a fraction in [0, 1]"},
      {R"({"assets": [{"input": "a.obj", "quality": "good"}]})",
       "m.json: assets[0].quality: 'good' is none of fast, normal, best"},
      {R"({"assets": [{"input": "a.obj", "cover": "all"}]})",
       "m.json: assets[0].cover: 'all' is none of surface, solid"},
      {R"({"assets": [{"input": "a.obj", "repair": "yes"}]})",
       "m.json: assets[0].repair: 'yes' is none of off, orient, fill, wrap, auto"},
      {R"({"assets": [{"input": "a.obj", "output": "../a.sph"}]})",
       "m.json: assets[0].output: '../a.sph' does not lie in the output folder"},
      {R"({"assets": [{"input": "a.obj", "output": "/a.sph"}]})",
       "m.json: assets[0].output: '/a.sph' does not lie in the output folder"},
      {R"({"assets": [{"input": "a.obj", "output": "a.txt"}]})",
       "m.json: assets[0].output: 'a.txt' does not end in .sph"},
      {R"({"assets": [{"input": "a.obj", "scale": 0}]})",
       "m.json: assets[0].scale: '0' is not a number above 0"},
      {R"({"assets": [{"input": "a.obj", "instances": []}]})",
       "m.json: assets[0].instances: is an empty list"},
      {R"({"assets": [{"input": "a.obj", "instances": [1, -2]}]})",
       "m.json: assets[0].instances: '-2' is not a number above 0"},
      {R"({"assets": [{"input": "a.obj", "instances": 0}]})",
       "m.json: assets[0].instances: '0' is not a whole number in [1, 1000000]"},
      {R"({"assets": [{"input": "a.obj", "instances": [1], "scale": 2}]})",
       "m.json: assets[0]: instances lists the scales, so scale must not be given"},
      {R"({"assets": [{"input": "a.obj", "tolerance": 1, "max_error": 0.1}]})",
       "m.json: assets[0]: tolerance and max_error both say how far balls may stick out"},
      {R"({"defaults": {"input": "a.obj"}, "assets": []})",
       "m.json: defaults.input: cannot be the same for all assets"}};
  for (const Wrong& wrong : all) EXPECT_EQ(complaintOf("m.json", wrong.text), wrong.complaint);
  EXPECT_THAT(complaintOf("m.json", R"({"assets": [{"input": "a.obj", "level": 3}]})"),
              StartsWith("m.json: assets[0]: there is no setting 'level'; there are input, output, levels,"));
  EXPECT_THAT(complaintOf("m.json", R"({"assets": [{"input": "a.obj", "builder": "nobody"}]})"),
              StartsWith("m.json: assets[0].builder: 'nobody' is none of octree,"));
  EXPECT_THAT(complaintOf("m.json", R"({"defaults": {"colour": 1}, "assets": []})"),
              StartsWith("m.json: defaults: there is no setting 'colour'"));
}

TEST_F(Manifest, CsvComplaintsNameFilePlaceAndReason) {
  const std::vector<Wrong> all = {
      {"", "m.csv: is empty: the first line must name the columns"},
      {"input\n", "m.csv: names no asset"},
      {"input,input\na.obj,b.obj\n", "m.csv: line 1: the column 'input' stands there twice"},
      {"input,levels\na.obj\n", "m.csv: line 2: has 1 cells, but there are 2 columns"},
      {"input,levels\n,3\n", "m.csv: line 2: has no input"},
      {"input,levels\na.obj,3\nb.obj,many\n", "m.csv: line 3, levels: 'many' is not a number"},
      {"input,levels\n\"a\nb.obj\",3\nc.obj,99\n",
       "m.csv: line 4, levels: '99' is not a whole number in [1, 24]"},
      {"input,instances\na.obj,1 0\n", "m.csv: line 2, instances: '0' is not a number above 0"},
      {"input\n\"a.obj\n", "m.csv: line 2: a quotation mark is never closed"}};
  for (const Wrong& wrong : all) EXPECT_EQ(complaintOf("m.csv", wrong.text), wrong.complaint);
  EXPECT_THAT(complaintOf("m.csv", "input,colour\na.obj,red\n"),
              StartsWith("m.csv: line 1: there is no setting 'colour'"));
}

TEST_F(Manifest, AMissingOneIsUnreadable) {
  const auto entries = readManifest(in("nothing.json"));
  ASSERT_FALSE(entries.ok());
  EXPECT_EQ(entries.error().code, ErrorCode::UnreadableInput);
}

}  // namespace
}  // namespace spheretree::io
