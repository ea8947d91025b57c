// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the program promises whatever the subcommand: exit codes, one sentence per mistake, untouched files.
#include <sys/types.h>
#include <unistd.h>
#include <csignal>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "cli/exit_code.hpp"
#include "tests/cli/program.hpp"

namespace spheretree::tests {
namespace {

using Names = std::vector<std::string>;

class Usage : public ProgramTest {};
class Cancel : public ProgramTest, public ::testing::WithParamInterface<int> {
 public:
  Finished interrupted(const std::vector<std::string>& arguments) {
    const pid_t process = start(programPath(), arguments);
    std::this_thread::sleep_for(std::chrono::milliseconds(1000));
    ::kill(process, GetParam());
    return finish(process);
  }
};

TEST_F(Usage, HelpNamesEverySubcommandAndExitCode) {
  const Finished help = run({"--help"});
  EXPECT_EQ(help.exitCode, 0);
  EXPECT_EQ(help.err, "");
  for (const char* word : {"build", "eval", "info", "list", "mesh", "130 cancelled", "--version"})
    EXPECT_NE(help.out.find(word), std::string::npos) << word;
}

TEST_F(Usage, ThreadsSleepWhileTheyWaitUnlessToldOtherwise) {
  ::setenv("OMP_DISPLAY_ENV", "true", 1);
  const Finished own = run({"list"});
  ::setenv("OMP_WAIT_POLICY", "active", 1);
  const Finished told = run({"list"});
  ::unsetenv("OMP_WAIT_POLICY");
  ::unsetenv("OMP_DISPLAY_ENV");
  EXPECT_EQ(own.exitCode, 0);
  // Before and after the program starts itself anew, the runtime library says what it found.
  EXPECT_NE(own.err.find("OMP_WAIT_POLICY = 'PASSIVE'", own.err.find("END")), std::string::npos) << own.err;
  EXPECT_NE(told.err.find("OMP_WAIT_POLICY = 'ACTIVE'"), std::string::npos) << told.err;
  EXPECT_EQ(own.out, told.out);
}

TEST_F(Usage, HelpOfASubcommandShowsDefaults) {
  const Finished help = run({"build", "--help"});
  EXPECT_EQ(help.exitCode, 0);
  for (const char* word :
       {"[2, 4096]=8", "[1, 24]=4", "=combined", "surface|solid=surface", "fast|normal|best=normal",
        "worst|mean|volume=worst", "--refine auto|on|off=auto", "--link auto|on|off=auto",
        "NAME,..=", "above 0=0.5", "[0, 1000000]=200", "=auto", "=2000"})
    EXPECT_NE(help.out.find(word), std::string::npos) << word;
}

/// Every match of the first group.
std::vector<std::string> found(const std::string& text, const std::string& pattern) {
  const std::regex expression(pattern);
  std::vector<std::string> all;
  for (auto at = std::sregex_iterator(text.begin(), text.end(), expression); at != std::sregex_iterator();
       ++at)
    all.push_back((*at)[1]);
  return all;
}

/// The part of the book between the heading of a subcommand and the next one.
std::string chapter(const std::string& book, const std::string& subcommand) {
  const std::size_t begin = book.find("\n## " + subcommand + "\n");
  if (begin == std::string::npos) return {};
  return book.substr(begin, book.find("\n## ", begin + 1) - begin);
}

TEST_F(Usage, TheBookHasEveryOptionAndItsDefault) {
  std::ifstream file(SPHERETREE_BOOK);
  const std::string book((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  for (const char* subcommand :
       {"build", "batch", "compare", "eval", "export", "info", "list", "mesh", "urdf"}) {
    SCOPED_TRACE(subcommand);
    const std::string text = chapter(book, subcommand);
    // What batch and compare share with build is said there.
    const bool shares = text.find("settings of [`build`](#build)") != std::string::npos;
    const std::string all = text + (shares ? chapter(book, "build") : "");
    const std::string help = run({subcommand, "--help"}).out;
    const std::vector<std::string> options = found(help, "\\n  (?:-[a-z],)?(--[a-z-]+)");
    ASSERT_FALSE(options.empty());
    for (const std::string& option : options) {
      if (option == "--help") continue;
      EXPECT_NE(all.find(option), std::string::npos) << option;
    }
    for (const std::string& option : found(text, "`(--[a-z-]+)"))
      EXPECT_NE(help.find(option), std::string::npos) << option << " is in the book only";
    for (const std::string& option : options) {
      const std::vector<std::string> value = found(help, option + " [^=\n]*=(\\S+)");
      if (value.empty()) continue;
      EXPECT_FALSE(found(all, "(`" + option + "[^\n]*` \\| `" + value[0] + "` \\|)").empty())
          << option << " has the default " << value[0];
    }
  }
}

TEST_F(Usage, VersionIsOneLine) {
  const Finished version = run({"--version"});
  EXPECT_EQ(version.exitCode, 0);
  EXPECT_EQ(version.out, "spheretree " SPHERETREE_TESTED_VERSION "\n");
}

TEST_F(Usage, MistakesAreCodeTwoAndTouchNothing) {
  write("box.obj", boxObj());
  write("tree.sph", classicBoxTree());
  const Names before = names();
  const std::vector<std::vector<std::string>> mistakes = {
      {},
      {"frobnicate"},
      {"build"},
      {"build", "box.obj"},
      {"build", "box.obj", "-o"},
      {"build", "box.obj", "-o", "a.sph", "--frobnicate"},
      {"build", "box.obj", "-o", "a.sph", "--branch", "1"},
      {"build", "box.obj", "-o", "a.sph", "--branch", "8.5"},
      {"build", "box.obj", "-o", "a.sph", "--levels", "0"},
      {"build", "box.obj", "-o", "a.sph", "--levels", "-1"},
      {"build", "box.obj", "-o", "a.sph", "--levels", "3", "--levels", "4"},
      {"build", "box.obj", "-o", "a.sph", "--max-error", "nan"},
      {"build", "box.obj", "-o", "a.sph", "--max-error", "-0.1"},
      {"build", "box.obj", "-o", "a.sph", "--builder", "nobody"},
      {"build", "box.obj", "-o", "a.sph", "--cover", "fluid"},
      {"build", "box.obj", "-o", "a.sph", "--repair", "please"},
      {"build", "box.obj", "-o", "a.sph", "--seed", "-1"},
      {"build", "box.obj", "-o", "a.sph", "-q", "-v"},
      {"build", "box.obj", "-o", "a.sph", "--builder", "octree", "--samples", "100"},
      {"build", "box.obj", "-o", "a.sph", "--builder", "octree", "--orientations", "3"},
      {"build", "box.obj", "-o", "a.sph", "--samples", "100"},
      {"build", "box.obj", "-o", "a.sph", "--quality", "great"},
      {"build", "box.obj", "-o", "a.sph", "--objective", "0"},
      {"build", "box.obj", "-o", "a.sph", "--axis-balls", "-1"},
      {"build", "box.obj", "-o", "a.sph", "--reducers"},
      {"build", "box.obj", "-o", "a.sph", "--report", "a.pdf"},
      {"build", "box.obj", "-o", "a.sph", "--report", "a"},
      {"build", "box.obj", "-o", "box.obj"},
      {"build", "box.obj", "-o", "./box.obj", "--force"},
      {"build", "box.obj", "-o", "a.json", "--report", "a.json"},
      {"build", "box.obj", "other.obj", "-o", "a.sph"},
      {"eval", "box.obj"},
      {"eval", "box.obj", "tree.sph", "--frame", "moon"},
      {"eval", "box.obj", "tree.sph", "--max-error", "2"},
      {"info"},
      {"info", "tree.sph", "--level", "2"},
      {"list", "box.obj"},
      {"mesh", "box.obj", "--simplify", "10"},
      {"mesh", "box.obj", "-o", "b.obj", "--simplify", "3"},
      {"mesh", "box.obj", "-o", "b.xyz"},
  };
  for (const auto& mistake : mistakes) {
    std::string line;
    for (const std::string& word : mistake) line += " " + word;
    SCOPED_TRACE("spheretree" + line);
    const Finished finished = run(mistake);
    EXPECT_EQ(finished.exitCode, 2);
    EXPECT_EQ(finished.out, "");
    EXPECT_EQ(finished.err.rfind("spheretree: ", 0), 0U) << finished.err;
    EXPECT_EQ(names(), before);
  }
}

TEST_F(Usage, SettingsThatDoNotFitAreRefusedInOneSentence) {
  write("box.obj", boxObj());
  const std::string reducers = "; there are grid, hubbard, spawn, merge, burst, expand";
  const std::vector<std::pair<std::vector<std::string>, std::string>> mistakes = {
      {{"--reducers", "merge,nobody"}, "--reducers: unknown reducer 'nobody'" + reducers},
      {{"--reducers", "merge,octree"}, "--reducers: 'octree' is no reducer" + reducers},
      {{"--reducers", ""}, "--reducers: unknown reducer ''" + reducers},
      {{"--reducers", "merge,grid,Merge"}, "--reducers: the reducer 'merge' is named twice"},
      {{"--link", "on", "--refine", "off"},
       "link needs refine, which is off: levels are linked by refining them"},
      {{"--builder", "merge", "--link", "on"},
       "link needs refine, which is off for a reducer on its own unless set to on: levels are linked by "
       "refining them"},
      {{"--builder", "octree", "--refine", "on"}, "--refine: belongs to builders with reducers, not octree"},
      {{"--builder", "octree", "--quality", "best"},
       "--quality: belongs to builders with reducers, not octree"},
      {{"--builder", "merge", "--reducers", "merge"}, "--reducers: belongs to combined, not merge"},
      {{"--builder", "grid", "--axis-error", "0.3"},
       "--axis-error: belongs to merge, burst and expand, not grid"},
      {{"--reducers", "grid,hubbard", "--axis-balls", "9"},
       "--axis-balls: belongs to merge, burst and expand, not combined of grid,hubbard"},
      {{"--reducers", "merge", "--samples", "100"}, "--samples: belongs to hubbard, not combined of merge"},
      {{"--axis-error", "0"}, "--axis-error: '0' is not a number above 0"},
      {{"--axis-error", "inf"}, "--axis-error: 'inf' is not a number above 0"}};
  for (const auto& [settings, sentence] : mistakes) {
    SCOPED_TRACE(sentence);
    std::vector<std::string> arguments{"build", "box.obj", "-o", "a.sph"};
    arguments.insert(arguments.end(), settings.begin(), settings.end());
    const Finished finished = run(arguments);
    EXPECT_EQ(finished.exitCode, 2);
    EXPECT_EQ(finished.out, "");
    EXPECT_EQ(finished.err, "spheretree: " + sentence + "\nspheretree: see spheretree build --help\n");
    EXPECT_EQ(names(), Names{"box.obj"});
  }
}

TEST_F(Usage, AReportOfAnotherKindNamesTheEndingsThereAre) {
  const Finished finished = run({"build", "box.obj", "-o", "a.sph", "--report", "a.pdf"});
  EXPECT_NE(finished.err.find(".json, .csv or .html"), std::string::npos) << finished.err;
}

TEST_F(Usage, UnreadableInputIsCodeThree) {
  write("box.obj", boxObj());
  write("empty.obj", "");
  write("noise.sph", "NIST_1A\n   1024\n");
  write("short.sph", "2 2\n0 0 0 1 1\n0 0 zero 1 1\n");
  const Names before = names();
  const std::vector<std::vector<std::string>> commands = {
      {"build", "missing.obj", "-o", "a.sph"},
      {"build", "empty.obj", "-o", "a.sph"},
      {"build", "box.obj", "-o", "a.sph", "--config", "no"},
      {"eval", "box.obj", "missing.sph"},
      {"eval", "missing.obj", "short.sph"},
      {"info", "noise.sph"},
      {"info", "short.sph"},
      {"info", "."},
      {"mesh", "missing.obj"},
      {"mesh", "empty.obj", "-o", "a.obj"}};
  for (const auto& command : commands) {
    SCOPED_TRACE(command[0] + " " + command[1]);
    const Finished finished = run(command);
    EXPECT_EQ(finished.exitCode, 3);
    EXPECT_EQ(finished.out, "");
    EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
    EXPECT_EQ(names(), before);
  }
}

TEST_F(Usage, AnUnsuitableMeshIsCodeFour) {
  write("open.obj", openBoxObj());
  const Finished off = run({"build", "open.obj", "-o", "a.sph", "--repair", "off"});
  EXPECT_EQ(off.exitCode, 4);
  EXPECT_EQ(off.err.rfind("spheretree: open.obj: ", 0), 0U) << off.err;
  EXPECT_EQ(run({"build", "open.obj", "-o", "a.sph", "--repair", "orient"}).exitCode, 4);
  EXPECT_EQ(run({"mesh", "open.obj", "-o", "b.obj", "--repair", "off"}).exitCode, 4);
  EXPECT_EQ(names(), Names{"open.obj"});
}

TEST_F(Usage, AnUnwritableOutputIsCodeSix) {
  write("box.obj", boxObj());
  write("a.sph", "precious");
  const Names before = names();
  for (const char* output : {"a.sph", "nowhere/a.sph", "."}) {
    SCOPED_TRACE(output);
    const Finished finished = run({"build", "box.obj", "-o", output});
    EXPECT_EQ(finished.exitCode, 6);
    EXPECT_EQ(finished.out, "");
  }
  EXPECT_EQ(run({"build", "box.obj", "-o", "new.sph", "--report", "nowhere/a.json"}).exitCode, 6);
  EXPECT_EQ(read("a.sph"), "precious");
  EXPECT_EQ(names(), before);
}

TEST_F(Usage, AFullDiskBehindStandardOutputIsCodeSix) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const Finished finished = finish(start(programPath(), {"list"}, ".", "/dev/full"));
  EXPECT_EQ(finished.exitCode, 6);
  EXPECT_NE(finished.err.find("standard output"), std::string::npos) << finished.err;
}

TEST_F(Usage, RunningOutOfMemoryIsOurFault) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer reserves more memory than any limit";
#else
  write("box.obj", boxObj());
  // Ten million samples need more than these 400 MB (in kB, as the shell counts).
  const std::string command = "ulimit -v 400000; exec '" + programPath() +
                              "' build box.obj -o a.sph --builder hubbard --samples 10000000 --threads 1";
  const Finished finished = finish(start("/bin/sh", {"-c", command}));
  EXPECT_EQ(finished.exitCode, 1) << finished.err;
  EXPECT_NE(finished.err.find("memory"), std::string::npos) << finished.err;
  EXPECT_EQ(names(), Names{"box.obj"});
#endif
}

TEST(ExitCodes, AreWhatTheBookSays) {
  using cli::exitCodeOf;
  const auto number = [](ErrorCode code) { return static_cast<int>(exitCodeOf(code)); };
  EXPECT_EQ(number(ErrorCode::Internal), 1);
  EXPECT_EQ(number(ErrorCode::InvalidArgument), 2);
  EXPECT_EQ(number(ErrorCode::UnreadableInput), 3);
  EXPECT_EQ(number(ErrorCode::UnsuitableMesh), 4);
  EXPECT_EQ(number(ErrorCode::ErrorBoundMissed), 5);
  EXPECT_EQ(number(ErrorCode::UnwritableOutput), 6);
  EXPECT_EQ(number(ErrorCode::Cancelled), 130);
}

TEST_P(Cancel, ABuildLeavesNothingBehind) {
  write("box.obj", boxObj());
  // Minutes, if nobody stops them: two million leaves, a few levels with all that can be done for them, and
  // one set of many balls.
  const std::vector<std::vector<std::string>> builds = {
      {"--builder", "grid", "--levels", "8"},
      {"--quality", "best", "--levels", "6"},
      {"--quality", "best", "--levels", "2", "--branch", "512", "--axis-balls", "5000"}};
  for (const std::vector<std::string>& build : builds) {
    SCOPED_TRACE(build[1] + " " + build[3]);
    std::vector<std::string> arguments{"build", "box.obj", "-o", "a.sph", "--report", "a.json"};
    arguments.insert(arguments.end(), build.begin(), build.end());
    const auto start = std::chrono::steady_clock::now();
    const Finished finished = interrupted(arguments);
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
    EXPECT_EQ(finished.exitCode, 130) << finished.err;
    EXPECT_EQ(finished.out, "");
    EXPECT_EQ(names(), Names{"box.obj"});
    // One second goes by before the signal. Far above what a step may take, also under a sanitizer.
    EXPECT_LT(spent.count(), 20);
  }
}

INSTANTIATE_TEST_SUITE_P(Signals, Cancel, ::testing::Values(SIGINT, SIGTERM));

}  // namespace
}  // namespace spheretree::tests
