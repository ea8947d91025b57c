// SPDX-License-Identifier: GPL-3.0-or-later
//
// spheretree list: the builders there are.
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "builders/catalogue.hpp"
#include "builders/settings.hpp"
#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/text_table.hpp"

namespace spheretree::cli {
namespace {

struct ListOptions {
  bool json = false;
};

std::string asJson() {
  auto builders = nlohmann::ordered_json::array();
  for (const builders::CatalogueEntry& entry : builders::catalogue()) {
    builders.push_back({{"name", entry.name},
                        {"summary", entry.summary},
                        {"reference", entry.reference},
                        {"default", entry.name == builders::BuildSettings{}.builder}});
  }
  return builders.dump(2) + "\n";
}

std::string asTable() {
  using Align = TextTable::Align;
  TextTable table({{"builder", Align::Left}, {"what it does", Align::Left}, {"reference", Align::Left}});
  for (const builders::CatalogueEntry& entry : builders::catalogue())
    table.add({std::string(entry.name), std::string(entry.summary), std::string(entry.reference)});
  return table.text();
}

}  // namespace

Command setupList(CLI::App& program) {
  const auto options = std::make_shared<ListOptions>();
  CLI::App* app = program.add_subcommand("list", "Name the builders, with a line and a reference each");
  app->add_flag("--json", options->json, "Print JSON");
  return {app, [options] {
            print(options->json ? asJson() : asTable());
            return ExitCode::Done;
          }};
}

}  // namespace spheretree::cli
