// SPDX-License-Identifier: GPL-3.0-or-later
//
// builder x model x level: spheres, errors, seconds of the build alone (median of three), threads, tree hash.
//   build_bench [MESH...]        generated models when no mesh is named
#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "builders/build_tree.hpp"
#include "builders/catalogue.hpp"
#include "io/mesh_import.hpp"
#include "io/tree_files.hpp"
#include "models/shapes.hpp"

namespace {

using namespace spheretree;

constexpr std::size_t kRepeats = 3;

void bench(const std::string& name, const medial::Surface& surface, const std::string& builder,
           unsigned threads) {
  builders::BuildSettings settings;
  settings.builder = builder;
  const medial::Context context(threads);
  std::vector<double> seconds;
  for (std::size_t repeat = 0; repeat < kRepeats; ++repeat) {
    const auto built = builders::buildTree(surface, settings, context);
    if (!built) {
      std::fprintf(stderr, "build_bench: %s: %s\n", name.c_str(), built.error().message.c_str());
      return;
    }
    seconds.push_back(built->report.stages.front().seconds);
    if (repeat + 1 < kRepeats) continue;
    std::sort(seconds.begin(), seconds.end());
    for (std::size_t depth = 0; depth < built->report.levels.size(); ++depth) {
      const builders::LevelMetrics& m = built->report.levels[depth].metrics;
      std::printf("%s,%zu,%s,%zu,%zu,%.5f,%.5f,%.4f,%s,%.3f,%u,%s\n", name.c_str(),
                  surface.mesh().triangles.size(), builder.c_str(), depth, m.spheres,
                  m.overhangWorst.upper / surface.diagonal(), m.overhangMean / surface.diagonal(),
                  m.volumeRatio, m.surface.certified ? "yes" : "no", seconds[kRepeats / 2], threads,
                  io::treeHash(built->tree).c_str());
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::pair<std::string, medial::TriangleMesh>> meshes;
  for (int i = 1; i < argc; ++i) {
    auto imported = io::importMesh(argv[i]);
    if (!imported) {
      std::fprintf(stderr, "build_bench: %s\n", imported.error().message.c_str());
      return 3;
    }
    meshes.emplace_back(std::filesystem::path(argv[i]).stem().string(), std::move(imported->mesh));
  }
  if (meshes.empty()) {
    for (const models::Model& model : models::allModels()) {
      if (model.name == "knot" || model.name == "gear") meshes.emplace_back(model.name, model.make());
    }
  }
  std::puts(
      "model,triangles,builder,level,spheres,worst,mean,volume ratio,covered,build seconds,threads,tree "
      "hash");
  for (const auto& [name, mesh] : meshes) {
    const auto surface = medial::Surface::create(mesh);
    if (!surface) {
      std::fprintf(stderr, "build_bench: %s: %s\n", name.c_str(), surface.error().message.c_str());
      return 4;
    }
    for (const builders::CatalogueEntry& builder : builders::catalogue()) {
      for (const unsigned threads : {1U, 2U}) bench(name, *surface, std::string(builder.name), threads);
    }
  }
}
