// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the world does to a program at work: disks that are full, folders that refuse, inputs and outputs that
// others touch meanwhile, signals at any moment, too little memory. Each ends with its code and one sentence,
// leaves earlier outputs as they were, and never half of one.
#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <string>
#include <thread>
#include <vector>

#include "cli/exit_code.hpp"
#include "tests/cli/program.hpp"

namespace spheretree::tests {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

// Large enough for files of a kilobyte and more.
const Names kBuild{"build",     "box.obj", "-o",       "a.sph", "--report", "a.json",
                   "--quality", "fast",    "--levels", "3",     "--force"};

// Takes seconds, so that there is time to do something to it.
const Names kLongBuild{"build", "box.obj",  "-o", "out/a.sph", "--builder",
                       "grid",  "--levels", "4",  "--branch",  "12"};

class Faults : public ProgramTest {
 protected:
  void SetUp() override { write("box.obj", boxObj()); }

  Finished shell(const std::string& script) { return finish(start("/bin/sh", {"-c", script})); }

  /// The command as a shell takes it.
  static std::string words(const Names& arguments) {
    std::string text = "'" + programPath() + "'";
    for (const std::string& argument : arguments) text += " '" + argument + "'";
    return text;
  }

  static void expectOneSentence(const Finished& finished) {
    EXPECT_EQ(finished.err.rfind("spheretree: ", 0), 0U) << finished.err;
    EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
  }

  void expectEarlierOutputs() const {
    EXPECT_EQ(read("a.sph"), "earlier tree");
    EXPECT_EQ(read("a.json"), "earlier report");
    EXPECT_EQ(names(), (Names{"a.json", "a.sph", "box.obj"}));
  }

  void writeEarlierOutputs() const {
    write("a.sph", "earlier tree");
    write("a.json", "earlier report");
  }

  /// Starts the long build and waits until it has taken in its mesh.
  pid_t startLongBuild() {
    fs::create_directory(folder_ / "out");
    const pid_t process = start(programPath(), kLongBuild);
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    EXPECT_FALSE(exists("out/a.sph")) << "too quick for this test";
    return process;
  }
};

TEST_F(Faults, AFullDiskLeavesEarlierOutputs) {
  // A disk of its own with room for the input and little else, in a name space that ends with the shell.
  const std::string mount = "mount -t tmpfs -o size=16k none disk";
  fs::create_directory(folder_ / "disk");
  if (shell("unshare -m sh -c '" + mount + "'").exitCode != 0)
    GTEST_SKIP() << "no file system may be mounted here";
  write("script.sh", mount + " && cp box.obj disk && cd disk && printf 'earlier tree' >a.sph && " +
                         words(kBuild) +
                         "; code=$?; printf 'after: '; cat a.sph; ls -A | tr '\\n' ' '; exit $code");
  const Finished finished = shell("exec unshare -m sh script.sh");
  EXPECT_EQ(finished.exitCode, 6) << finished.err;
  expectOneSentence(finished);
  EXPECT_NE(finished.err.find("No space left"), std::string::npos) << finished.err;
  // The tree fits, the report after it does not, and the sentence says what was written.
  EXPECT_EQ(finished.out.rfind("after: ", 0), 0U) << finished.out;
  EXPECT_EQ(finished.out.find(".tmp"), std::string::npos) << finished.out;
}

TEST_F(Faults, ALimitOnTheSizeOfFilesIsLikeAFullDisk) {
  writeEarlierOutputs();
  const Finished finished =
      shell("ulimit -f 1; exec " + words(kBuild));  // 512 or 1024 bytes, as the shell likes
  EXPECT_EQ(finished.exitCode, 6) << finished.err;
  EXPECT_EQ(finished.out, "");
  expectOneSentence(finished);
  EXPECT_NE(finished.err.find("a.sph: "), std::string::npos) << finished.err;
  expectEarlierOutputs();
}

TEST_F(Faults, AFolderThatRefusesIsFoundBeforeTheWork) {
  fs::create_directory(folder_ / "closed");
  fs::permissions(folder_ / "closed", fs::perms::owner_read | fs::perms::owner_exec);
  // Nothing refuses an administrator but the systems that are no disks.
  const std::string output = ::geteuid() == 0 ? "/proc/a.sph" : "closed/a.sph";
  const Finished finished = run({"build", "box.obj", "-o", output, "--builder", "grid", "--levels", "8"});
  fs::permissions(folder_ / "closed", fs::perms::owner_all);
  EXPECT_EQ(finished.exitCode, 6);
  EXPECT_EQ(finished.out, "");
  expectOneSentence(finished);
  EXPECT_NE(finished.err.find(output), std::string::npos) << finished.err;
}

TEST_F(Faults, AReadOnlyDiskIsFoundBeforeTheWork) {
  fs::create_directory(folder_ / "disk");
  const std::string mount = "mount -t tmpfs -o ro none disk";
  if (shell("unshare -m sh -c '" + mount + "'").exitCode != 0)
    GTEST_SKIP() << "no file system may be mounted here";
  write("script.sh",
        mount + " && exec " +
            words({"build", "box.obj", "-o", "disk/a.sph", "--builder", "grid", "--levels", "8"}));
  const Finished finished = shell("exec unshare -m sh script.sh");
  EXPECT_EQ(finished.exitCode, 6);
  expectOneSentence(finished);
  EXPECT_NE(finished.err.find("Read-only file system"), std::string::npos) << finished.err;
}

TEST_F(Faults, AReadOnlyOutputIsReplacedByForceOnly) {
  write("a.sph", "earlier tree");
  fs::permissions(folder_ / "a.sph", fs::perms::owner_read);
  Names polite = kBuild;
  polite.pop_back();
  EXPECT_EQ(run(polite).exitCode, 6);
  EXPECT_EQ(read("a.sph"), "earlier tree");
  EXPECT_EQ(names(), (Names{"a.sph", "box.obj"}));
  EXPECT_EQ(run(kBuild).exitCode, 0);
  EXPECT_NE(read("a.sph"), "earlier tree");
  EXPECT_EQ(fs::status(folder_ / "a.sph").permissions(), fs::perms::owner_read);
}

TEST_F(Faults, AnInputRemovedDuringTheRunIsNotMissed) {
  const pid_t process = startLongBuild();
  fs::remove(folder_ / "box.obj");
  const Finished finished = finish(process);
  EXPECT_EQ(finished.exitCode, 0) << finished.err;
  EXPECT_TRUE(exists("out/a.sph"));
}

TEST_F(Faults, AnOutputFolderRemovedDuringTheRunIsCodeSix) {
  const pid_t process = startLongBuild();
  fs::remove(folder_ / "out");
  const Finished finished = finish(process);
  EXPECT_EQ(finished.exitCode, 6);
  EXPECT_EQ(finished.out, "");
  expectOneSentence(finished);
  EXPECT_NE(finished.err.find("out/a.sph"), std::string::npos) << finished.err;
  EXPECT_EQ(names(), Names{"box.obj"});
}

TEST_F(Faults, AnOutputThatSomebodyElseMadeMeanwhileStays) {
  const pid_t process = startLongBuild();
  write("out/a.sph", "somebody else's");
  const Finished finished = finish(process);
  EXPECT_EQ(finished.exitCode, 6);
  expectOneSentence(finished);
  EXPECT_NE(finished.err.find("exists already"), std::string::npos) << finished.err;
  EXPECT_EQ(read("out/a.sph"), "somebody else's");
}

class Signals : public Faults, public ::testing::WithParamInterface<int> {};

/// Whether the outputs are whole: both new, and no temporary file beside them.
TEST_P(Signals, AtAnyMomentLeaveAllOrNothing) {
  std::size_t cancelled = 0;
  // From before the program has caught anything to after its end: about half a second.
  for (const int milliseconds : {0, 1, 2, 5, 10, 20, 50, 100, 150, 200, 250, 300, 400, 600}) {
    SCOPED_TRACE(std::to_string(milliseconds) + " ms");
    writeEarlierOutputs();
    const pid_t process = start(programPath(), kBuild);
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    ::kill(process, GetParam());
    const Finished finished = finish(process);
    EXPECT_EQ(names(), (Names{"a.json", "a.sph", "box.obj"}));
    if (finished.exitCode == 0) {
      EXPECT_EQ(read("a.sph").substr(0, 4), "3 8\n") << "not written";
      EXPECT_EQ(read("a.json").back(), '\n');
      continue;
    }
    // -1: the signal came before the program could catch it, which on a busy machine may be late.
    EXPECT_TRUE(finished.exitCode == 130 || finished.exitCode == -1) << finished.exitCode << finished.err;
    if (finished.exitCode == 130) ++cancelled;
    expectEarlierOutputs();
  }
  EXPECT_GT(cancelled, 0U);
}

TEST_P(Signals, ASecondOneEndsItAtOnce) {
  const pid_t process = startLongBuild();
  ::kill(process, GetParam());
  ::kill(process, GetParam());
  EXPECT_EQ(finish(process, std::chrono::seconds(10)).exitCode, 130);
  EXPECT_TRUE(fs::is_empty(folder_ / "out"));
}

INSTANTIATE_TEST_SUITE_P(IntAndTerm, Signals, ::testing::Values(SIGINT, SIGTERM));

TEST_F(Faults, TooLittleMemoryIsSaidWhereverItRunsOut) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer reserves more memory than any limit";
#else
  std::size_t failures = 0;
  std::size_t successes = 0;
  // In kB of address space. Below the first the loader fails, which is not ours to report.
  for (const int limit : {40000, 44000, 48000, 52000, 56000, 60000, 64000, 72000, 80000, 100000, 200000}) {
    SCOPED_TRACE(std::to_string(limit) + " kB");
    const std::string limited = "ulimit -v " + std::to_string(limit) + "; exec ";
    if (shell(limited + words({"list"})).exitCode != 0) continue;
    writeEarlierOutputs();
    const Finished finished = shell(limited + words(kBuild) + " --threads 1");
    if (finished.exitCode == 0) {
      ++successes;
      EXPECT_NE(read("a.sph"), "earlier tree");
      continue;
    }
    ++failures;
    EXPECT_EQ(finished.exitCode, 1) << finished.err;
    expectOneSentence(finished);
    EXPECT_NE(finished.err.find("memory"), std::string::npos) << finished.err;
    expectEarlierOutputs();
  }
  EXPECT_GT(failures, 0U);
  EXPECT_GT(successes, 0U);
#endif
}

}  // namespace
}  // namespace spheretree::tests
