// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the child process of an asset does once the mesh is read.
#include "builders/build_tree.hpp"
#include "io/batch_run.hpp"
#include "io/html_pages.hpp"
#include "io/report_parts.hpp"

namespace spheretree::io {
namespace {

using builders::BuildReport;

/// A sentence when the error asked for was not reached.
std::string missedReason(const BuildReport& report, const BatchAsset& asset, double diagonal) {
  if (report.errorBoundMet) return {};
  const double worst = report.levels.back().metrics.overhangWorst.upper;
  if (asset.tolerance > 0) {
    return "the last level sticks out by " + readableNumber(worst) + ", more than the tolerance " +
           readableNumber(asset.tolerance) + " in units of the mesh";
  }
  return "the last level sticks out by " + readableNumber(worst / diagonal) +
         " of the diagonal, more than the maximal error " + readableNumber(report.settings.maxError);
}

}  // namespace

Result<BuiltAsset> buildAsset(const medial::Surface& surface, const Provenance& provenance,
                              const BatchAsset& asset, Pages pages, const medial::Context& context) {
  builders::BuildSettings settings = asset.settings;
  if (asset.tolerance > 0) settings.maxError = asset.tolerance / surface.diagonal();
  const Result<builders::BuildResult> build = builders::buildTree(surface, settings, context);
  if (!build) return build.error();
  Result<std::string> tree = formatTree(*build, provenance);
  if (!tree) return tree.error();
  BuiltAsset built;
  built.tree = std::move(*tree);
  built.report = formatJsonReport(*build, provenance);
  built.missed = missedReason(build->report, asset, surface.diagonal());
  if (pages == Pages::With) {
    Result<std::string> page = formatHtmlReport(*build, provenance, surface, PageTimes::LeftOut);
    if (!page) return page.error();
    built.page = std::move(*page);
  }
  return built;
}

}  // namespace spheretree::io
