// SPDX-License-Identifier: GPL-3.0-or-later
//
// What can be said of the HTML pages without a browser; the rest is in tests/cli/report_page_test.py.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "builders/build_tree.hpp"
#include "io/html_pages.hpp"
#include "io/urdf_parts.hpp"

namespace spheretree::io {
namespace {

using testing::HasSubstr;
using testing::Not;

std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size()))
    ++count;
  return count;
}

/// A box as a tree of 1 + 8 balls, with its report.
struct Box {
  Box() : surface(medial::Surface::create(boxMesh({1, 2, 3})).value()), build(make()) {
    provenance.meshPath = "a</script><script>alert(1)</script>.obj";
    provenance.check = checkMesh(surface.mesh());
  }
  builders::BuildResult make() const {
    builders::BuildSettings settings;
    settings.builder = "octree";
    settings.levels = 2;
    return builders::buildTree(surface, settings, medial::Context(1)).value();
  }

  medial::Surface surface;
  builders::BuildResult build;
  Provenance provenance;
};

class HtmlPages : public testing::Test {
 protected:
  void SetUp() override {
    if (!whyNoHtml().empty()) GTEST_SKIP() << whyNoHtml();
  }
};

TEST_F(HtmlPages, NoTextFromOutsideBecomesScript) {
  const Box box;
  const std::string page = formatHtmlReport(box.build, box.provenance, box.surface, PageTimes::Shown).value();
  EXPECT_THAT(page, Not(HasSubstr("alert(1)</script>")));
  EXPECT_THAT(page, HasSubstr("a\\u003c/script>\\u003cscript>alert(1)"));
  EXPECT_EQ(countOf(page, "<script"), countOf(page, "</script>"));
}

TEST_F(HtmlPages, NothingIsLeftToFillIn) {
  const Box box;
  const std::string summary = R"({"tool": {}, "totals": {}, "assets": [], "run": {}})";
  for (const std::string& page :
       {formatHtmlReport(box.build, box.provenance, box.surface, PageTimes::Shown).value(),
        batchPage(summary, {}).value(), comparePage(R"({"rows": []})").value()}) {
    EXPECT_EQ(page.rfind("<!DOCTYPE html>", 0), 0U);
    EXPECT_THAT(page, Not(HasSubstr("{{page.")));
    EXPECT_THAT(page, HasSubstr("default-src 'none'"));
    EXPECT_THAT(page, HasSubstr("Chart.js Contributors"));  // the licence goes with the code
    EXPECT_EQ(page.substr(page.size() - 8), "</html>\n");
  }
}

TEST_F(HtmlPages, WithoutTimesTheSameBuildGivesTheSameBytes) {
  const Box box;
  builders::BuildResult slower = box.build;
  slower.report.threads += 1;
  for (auto& stage : slower.report.stages) stage.seconds += 1;
  const auto page = [&](const builders::BuildResult& build, PageTimes times) {
    return formatHtmlReport(build, box.provenance, box.surface, times).value();
  };
  EXPECT_EQ(page(box.build, PageTimes::LeftOut), page(slower, PageTimes::LeftOut));
  EXPECT_NE(page(box.build, PageTimes::Shown), page(slower, PageTimes::Shown));
  EXPECT_THAT(page(box.build, PageTimes::LeftOut), HasSubstr("\"sphere_tests_per_close_pair\":"));
}

TEST(Thumbnail, HasABallPerNodeOfTheLevelItShows) {
  const Box box;
  const std::string svg = thumbnailSvg(box.build.tree);
  EXPECT_EQ(countOf(svg, "<circle "), box.build.tree.level(1).size());
  EXPECT_EQ(svg, thumbnailSvg(box.build.tree));
  EXPECT_EQ(svg.rfind("<svg ", 0), 0U);
}

TEST(Thumbnail, LeavesOutLevelsThatAreTooFine) {
  std::vector<SphereTree::Entry> entries{{{{0, 0, 0}, 1}, kNoParent}};
  for (int k = 0; k < 500; ++k) entries.push_back({{{0.001F * static_cast<float>(k), 0, 0}, 0.1F}, 0});
  EXPECT_EQ(countOf(thumbnailSvg(SphereTree::create(entries).value()), "<circle "), 1U);
}

}  // namespace
}  // namespace spheretree::io
