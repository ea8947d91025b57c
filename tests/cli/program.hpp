// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace spheretree::tests {

/// How a run of the program ended.
struct Finished {
  int exitCode = -1;  ///< -1: it died of a signal
  std::string out;
  std::string err;
  bool outOfTime = false;    ///< it was killed because it took too long
  double cpuSeconds = 0;     ///< of all its threads, in user and in kernel mode
  double peakMegabytes = 0;  ///< of resident memory, in units of 1e6 bytes
};

/// Runs the program in a fresh folder of its own, which goes away with the test.
class ProgramTest : public ::testing::Test {
 protected:
  ProgramTest();
  ~ProgramTest() override;

  /// Starts the program and waits for it. Relative names are relative to the folder, or to `where` in it.
  Finished run(const std::vector<std::string>& arguments, const std::string& where = ".");

  /// Starts any program; `finish` waits for it, or kills it when that takes longer than `limit`. Standard
  /// output goes to a file outside the folder unless `output` names another one.
  pid_t start(const std::string& program, const std::vector<std::string>& arguments,
              const std::string& where = ".", const std::string& output = {});
  Finished finish(pid_t process, std::optional<std::chrono::milliseconds> limit = std::nullopt);

  void write(const std::string& name, const std::string& text) const;
  [[nodiscard]] std::string read(const std::string& name) const;
  [[nodiscard]] bool exists(const std::string& name) const;
  /// The names in the folder, sorted, hidden ones included.
  [[nodiscard]] std::vector<std::string> names() const;

  std::filesystem::path folder_;

 private:
  std::filesystem::path capture_;
};

/// The program under test: the one of this build, or the one that SPHERETREE_TESTED_PROGRAM names.
[[nodiscard]] std::string programPath();

/// A closed box of 12 triangles with side 1 around `center`.
[[nodiscard]] std::string boxObj(double x = 0, double y = 0, double z = 0);
/// The same without its top.
[[nodiscard]] std::string openBoxObj();
/// A tree of 1 + 8 balls around the box at the origin, in the shape of the classic toolkit: few decimals,
/// options and an evaluation after the rows.
[[nodiscard]] std::string classicBoxTree();

}  // namespace spheretree::tests
