// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <spheretree/result.hpp>
#include <spheretree/sphere_tree.hpp>

#include "builders/report.hpp"
#include "io/tree_files.hpp"
#include "medial/surface.hpp"
#include "medial/triangle_mesh.hpp"

namespace spheretree::io {

// Reports to look at (docs/reports.md): single HTML files that load nothing from anywhere. Scripts and style
// are part of the program (io/html/, and two libraries of Debian packages), numbers come in as the JSON
// reports that scripts read.

/// An empty string, or the sentence that says which packages the program was built without: then no page can
/// be made, and every function below that returns a Result fails with it (InvalidArgument).
[[nodiscard]] std::string whyNoHtml();

/// One level as it is drawn: what an answer at that depth is made from.
struct LevelView {
  std::vector<std::size_t> nodes;         ///< places in SphereTree::nodes()
  std::span<const double> overhang;       ///< of each, mesh units
  std::span<const std::string_view> won;  ///< which reducer's set each belongs to; empty: nobody knows
};

/// What the interactive view shows. Borrows everything for the call.
struct TreeView {
  const medial::TriangleMesh& mesh;  ///< in the frame of the tree
  const SphereTree& tree;
  std::vector<LevelView> levels;
};

/// Whether a page shows what a clock says. Without, the same build gives the same bytes: its plot of speed
/// counts sphere tests.
enum class PageTimes : std::uint8_t { Shown, LeftOut };

/// The page of one tree. `reportJson` is the JSON report of `build` or `eval`.
Result<std::string> treePage(const std::string& reportJson, const TreeView& view, PageTimes times);

/// The page of a build.
Result<std::string> formatHtmlReport(const builders::BuildResult& build, const Provenance& provenance,
                                     const medial::Surface& surface, PageTimes times);

/// A small picture of the balls of the deepest level that a small picture can show as an `<svg>` element:
/// shaded discs seen from above the front, far ones first. Deterministic, a few kilobytes, needs no package.
[[nodiscard]] std::string thumbnailSvg(const SphereTree& tree);

/// The page of a batch: a table that can be sorted, with links to the reports of the assets.
/// `summaryJson` is the JSON summary (docs/batch.md); `thumbnails` holds one `<svg>` per entry of its
/// `assets`, in their order, each possibly empty; none at all is allowed too.
Result<std::string> batchPage(std::string_view summaryJson, std::span<const std::string> thumbnails);

/// The page of a comparison: `compareJson` is the JSON of `spheretree compare` (docs/compare.md).
Result<std::string> comparePage(std::string_view compareJson);

}  // namespace spheretree::io
