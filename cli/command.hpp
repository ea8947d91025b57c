// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "cli/exit_code.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace spheretree::cli {

/// A subcommand: its parser, and what to do once the arguments are known. `run` may throw; main() turns
/// that into an exit code.
struct Command {
  CLI::App* app = nullptr;  ///< owned by the program's parser
  std::function<ExitCode()> run;
};

// One file each. They add themselves to the program's parser.
Command setupBatch(CLI::App& program);
Command setupBuild(CLI::App& program);
Command setupCompare(CLI::App& program);
Command setupEval(CLI::App& program);
Command setupExport(CLI::App& program);
Command setupInfo(CLI::App& program);
Command setupList(CLI::App& program);
Command setupMesh(CLI::App& program);
Command setupUrdf(CLI::App& program);

}  // namespace spheretree::cli
