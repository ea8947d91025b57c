// SPDX-License-Identifier: GPL-3.0-or-later
//
// The program: parses the arguments, runs one subcommand, and is the only place where an exit code leaves.
#include <array>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <spheretree/version.hpp>

#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/interrupt.hpp"
#include "medial/context.hpp"
#include "medial/environment.hpp"

namespace spheretree::cli {
namespace {

constexpr const char* kExitCodes =
    "Exit codes: 0 done, 1 our fault, 2 usage, 3 input cannot be read, 4 mesh not suitable,\n"
    "5 built but --max-error missed, 6 output cannot be written, 7 an asset of a batch failed, 130 "
    "cancelled.\n"
    "Results go to standard output, everything else to standard error.";

constexpr std::size_t kOptionColumn = 44;  // where the help's descriptions begin

ExitCode run(const std::vector<Command>& commands) {
  for (const Command& command : commands) {
    if (command.app->parsed()) return command.run();
  }
  return ExitCode::Usage;  // the parser requires a subcommand
}

/// `--help` and `--version` end parsing like mistakes do, but are none.
ExitCode endOfParsing(const CLI::App& program, const CLI::ParseError& why) {
  if (why.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
    program.exit(why);
    return ExitCode::Done;
  }
  const bool unreadable = dynamic_cast<const CLI::FileError*>(&why) != nullptr;
  const ExitCode code =
      fail({unreadable ? ErrorCode::UnreadableInput : ErrorCode::InvalidArgument, why.what()});
  if (unreadable) return code;
  const auto chosen = program.get_subcommands();
  const std::string name = chosen.empty() ? "" : " " + chosen.front()->get_name();
  remark("see spheretree" + name + " --help");
  return code;
}

ExitCode parseAndRun(int argc, char** argv) {
  CLI::App program("Turns triangle meshes into sphere trees, and measures them", "spheretree");
  program.set_version_flag("--version", "spheretree " SPHERETREE_VERSION, "Print the version and end");
  program.require_subcommand(1);
  program.footer(kExitCodes);
  program.get_formatter()->column_width(kOptionColumn);
  const std::vector<Command> commands = {setupBuild(program),   setupBatch(program),  setupEval(program),
                                         setupCompare(program), setupExport(program), setupInfo(program),
                                         setupList(program),    setupMesh(program),   setupUrdf(program)};
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& why) {
    return endOfParsing(program, why);
  }
  return run(commands);
}

ExitCode guarded(int argc, char** argv) {
  try {
    return parseAndRun(argc, argv);
  } catch (const medial::CancelledError&) {
    return fail({ErrorCode::Cancelled, "cancelled"});
  } catch (const std::bad_alloc&) {
    return fail({ErrorCode::Internal, "out of memory"});
  } catch (const std::exception& failure) {
    return fail({ErrorCode::Internal, std::string("unexpected: ") + failure.what()});
  }
}

}  // namespace
}  // namespace spheretree::cli

int main(int argc, char** argv) {
  namespace cli = spheretree::cli;
  spheretree::medial::tuneEnvironment(argv);
  cli::catchInterrupts();
  cli::ExitCode code = cli::guarded(argc, argv);
  const auto printed = cli::finishPrinting();
  if (!printed && code == cli::ExitCode::Done) code = cli::fail(printed.error());
  return static_cast<int>(code);
}
