// SPDX-License-Identifier: GPL-3.0-or-later
//
// Writes the generated models as OBJ files, or lists them.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>

#include "io/mesh_write.hpp"
#include "models/shapes.hpp"

namespace {

namespace io = spheretree::io;
namespace models = spheretree::models;

// The same codes as the main program's (docs/command-line.md).
constexpr int kDone = 0;
constexpr int kOurFault = 1;
constexpr int kUsage = 2;
constexpr int kUnwritable = 6;

struct Options {
  std::filesystem::path folder;
  std::vector<std::string> only;
  bool list = false;
  bool force = false;
};

void printList() {
  for (const models::Model& model : models::allModels()) {
    const std::string name(model.name);
    const std::string group(models::nameOf(model.group));
    const std::string note(model.note);
    std::printf("%-15s %5zu  %-15s %s\n", name.c_str(), model.make().triangles.size(), group.c_str(),
                note.c_str());
  }
}

bool wanted(const models::Model& model, const Options& options) {
  return options.only.empty() ||
         std::find(options.only.begin(), options.only.end(), model.name) != options.only.end();
}

int writeModels(const Options& options) {
  std::error_code failure;
  std::filesystem::create_directories(options.folder, failure);
  if (failure) {
    std::fprintf(stderr, "make_models: cannot make the folder %s: %s\n", options.folder.c_str(),
                 failure.message().c_str());
    return kUnwritable;
  }
  const auto overwrite = options.force ? io::Overwrite::Replace : io::Overwrite::Refuse;
  for (const models::Model& model : models::allModels()) {
    if (!wanted(model, options)) continue;
    const std::filesystem::path path = options.folder / (std::string(model.name) + ".obj");
    if (const auto written = io::writeMesh(path, model.make(), overwrite); !written) {
      std::fprintf(stderr, "make_models: %s\n", written.error().message.c_str());
      return kUnwritable;
    }
    std::printf("%s\n", path.c_str());
  }
  return kDone;
}

int run(int argc, char** argv) {
  std::vector<std::string> names;
  for (const models::Model& model : models::allModels()) names.emplace_back(model.name);

  Options options;
  CLI::App app("Writes the generated test models as OBJ files");
  const auto* folder = app.add_option("-o,--output", options.folder, "Folder to write into, made if missing");
  app.add_option("--only", options.only, "Write this model only; may be given several times")
      ->check(CLI::IsMember(names));
  app.add_flag("--list", options.list, "Print name, triangles, group and purpose of every model");
  app.add_flag("--force", options.force, "Replace files that exist");
  try {
    app.parse(argc, argv);
    if (!options.list && folder->empty()) throw CLI::RequiredError("--output or --list");
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kUsage;
  }
  if (options.list) printList();
  return folder->empty() ? kDone : writeModels(options);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_models: %s\n", error.what());
    return kOurFault;
  }
}
