// SPDX-License-Identifier: GPL-3.0-or-later
//
// Runs the program on every row of cases.csv, as a process of its own with a time limit, and asks `eval` what
// the tree is worth: a certified tree by the repair rule named, or a refusal with the code and the words
// named. Nothing in between.
//
//   SPHERETREE_HARD=published       all builders and the huge cases, too
//   SPHERETREE_TESTED_PROGRAM=FILE  another program than that of this build
//   SPHERETREE_HARD_RESULTS=FILE    also write what was measured, a row per run (docs/robustness.md)
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/cli/program.hpp"

namespace spheretree::tests {
namespace {

namespace fs = std::filesystem;

constexpr std::array kBuilders{"octree", "grid", "hubbard", "spawn", "merge", "burst", "expand", "combined"};
// Sanitizers and a busy machine stretch every time limit.
constexpr double kPatience = SPHERETREE_HARD_PATIENCE;
// Text of the shared table may not hold more; what is measured may.
constexpr std::size_t kColumns = 9;
constexpr const char* kSettings = "settings.toml";

struct HardCase {
  std::string name, group, file, inTests, published, outcome, detail, what;
  double seconds = 0;
};

struct HardRun {
  HardCase hard;
  std::string builder;
};

void PrintTo(const HardRun& run, std::ostream* out) {
  *out << run.hard.file << " by " << run.builder;
}

std::vector<HardCase> readCases() {
  std::ifstream file(SPHERETREE_HARD_FOLDER "/cases.csv");
  std::vector<HardCase> cases;
  std::string line;
  bool head = true;
  while (std::getline(file, line)) {
    if (line.empty() || line.front() == '#') continue;
    std::vector<std::string> cells;
    std::istringstream text(line);
    for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
    if (cells.size() != kColumns) throw std::runtime_error("cases.csv: not nine columns: " + line);
    if (!head) {
      cases.push_back({cells[0], cells[1], cells[2], cells[3], cells[4], cells[6], cells[7], cells[8],
                       std::stod(cells[5])});
    }
    head = false;
  }
  return cases;
}

bool published() {
  const char* const wish = std::getenv("SPHERETREE_HARD");
  return wish != nullptr && std::string(wish) == "published";
}

std::vector<HardRun> wantedRuns() {
  std::vector<HardRun> runs;
  for (const HardCase& hard : readCases()) {
    const std::string& wish = published() ? hard.published : hard.inTests;
    for (const char* const builder : kBuilders) {
      if (wish == "all" || wish == builder) runs.push_back({hard, builder});
    }
  }
  return runs;
}

/// What became of a run, as the results have it.
struct Outcome {
  std::string state = "failed";  ///< certified, refused, failed
  std::string rule = "-";        ///< of the repair, when there is a tree
  std::string triangles = "-";
  std::string levelErrors = "-";  ///< worst overhang per level, per cent of the diagonal
  std::string message = "-";      ///< why not
};

std::string firstLine(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

/// Commas and quotes would need a reader that knows them.
std::string plain(std::string text) {
  std::replace(text.begin(), text.end(), ',', ';');
  std::replace(text.begin(), text.end(), '"', '\'');
  return text;
}

class HardCases : public ProgramTest, public ::testing::WithParamInterface<HardRun> {
 protected:
  void SetUp() override {
    const fs::path written = fs::path(SPHERETREE_HARD_FOLDER) / "files" / GetParam().hard.file;
    if (fs::exists(written)) {
      fs::copy_file(written, folder_ / GetParam().hard.file);
      return;
    }
    // By another process: the memory of this one would count as that of its children.
    const Finished made = finish(start(SPHERETREE_HARD_INPUTS, {folder_.string(), GetParam().hard.file}));
    ASSERT_EQ(made.exitCode, 0) << made.err;
    ASSERT_TRUE(exists(GetParam().hard.file)) << "neither written by hand nor generated";
  }

  static double timeLimit() { return kPatience * GetParam().hard.seconds; }

  Finished build() {
    const HardRun& hardRun = GetParam();
    // Processors may be busy with others: only computing counts, and waiting for ten times as long.
    const std::chrono::milliseconds limit(static_cast<std::int64_t>(10 * 1000 * timeLimit()));
    // In a file, because not every builder has a quality: on the command line that would be an error.
    write(kSettings, "quality = \"fast\"\nlevels = 3\n");
    return finish(
        start(programPath(), {"build", hardRun.hard.file, "-o", "tree.sph", "--report", "tree.json",
                              "--builder", hardRun.builder, "--config", kSettings, "--threads", "1"}),
        limit);
  }

  Outcome judgeTree() {
    Outcome outcome;
    const nlohmann::json report = nlohmann::json::parse(read("tree.json"));
    outcome.rule = report.at("mesh").at("repair").at("rule");
    outcome.triangles = report.at("mesh").at("triangles").dump();
    outcome.levelErrors.clear();
    for (const nlohmann::json& level : report.at("levels")) {
      const nlohmann::json& worst = level.at("overhang_worst_relative").at("upper");
      if (!worst.is_number()) return failed(outcome, "an error is no number");
      std::array<char, 32> text{};
      std::snprintf(text.data(), text.size(), "%.4g", 100 * worst.get<double>());
      outcome.levelErrors += (outcome.levelErrors.empty() ? "" : " ") + std::string(text.data());
      if (worst > 1) return failed(outcome, "a ball sticks out by more than the diagonal");
    }
    // Somebody else's word: the file as it is, measured anew.
    const Finished eval = run({"eval", GetParam().hard.file, "tree.sph", "--json", "--threads", "1"});
    if (eval.exitCode != 0) return failed(outcome, "eval: " + firstLine(eval.err));
    const nlohmann::json measured = nlohmann::json::parse(eval.out);
    if (!measured.at("certificate").at("surface_chains").at("certified").get<bool>())
      return failed(outcome, "eval does not certify it");
    for (std::size_t k = 0; k < report.at("levels").size(); ++k) {
      if (measured.at("levels").at(k).at("overhang_worst") != report.at("levels").at(k).at("overhang_worst"))
        return failed(outcome, "eval measures another error on level " + std::to_string(k));
    }
    outcome.state = "certified";
    return outcome;
  }

  static Outcome failed(Outcome outcome, const std::string& why) {
    outcome.state = "failed";
    outcome.message = why;
    return outcome;
  }

  Outcome judge(const Finished& finished) {
    Outcome outcome;
    outcome.message = firstLine(finished.err);
    if (finished.outOfTime || finished.cpuSeconds > timeLimit()) return failed(outcome, "out of time");
    if (finished.exitCode == 0) {
      try {
        return judgeTree();
      } catch (const std::exception& failure) {  // a report that is no JSON, or lacks something
        return failed(outcome, failure.what());
      }
    }
    const std::set<int> refusals{3, 4};
    const std::string head = "spheretree: " + GetParam().hard.file + ": ";
    std::vector<std::string> inputs{GetParam().hard.file, kSettings};
    std::sort(inputs.begin(), inputs.end());
    const bool clean = names() == inputs && finished.out.empty();
    const bool oneSentence =
        finished.err.rfind(head, 0) == 0 && firstLine(finished.err).size() + 1 == finished.err.size();
    if (refusals.count(finished.exitCode) == 1 && clean && oneSentence) {
      outcome.state = "refused";
      outcome.message = outcome.message.substr(head.size());
    }
    return outcome;
  }

  static void record(const Outcome& outcome, const Finished& finished) {
    const char* const path = std::getenv("SPHERETREE_HARD_RESULTS");
    if (path == nullptr) return;
    const HardRun& hardRun = GetParam();
    std::ofstream file(path, std::ios::app);
    if (file.tellp() == 0) {
      file << "name,builder,state,rule,exit_code,triangles,cpu_seconds,peak_megabytes,level_errors,message\n";
    }
    std::array<char, 64> measured{};
    std::snprintf(measured.data(), measured.size(), "%.2f,%.0f", finished.cpuSeconds, finished.peakMegabytes);
    file << hardRun.hard.name << ',' << hardRun.builder << ',' << outcome.state << ',' << outcome.rule << ','
         << finished.exitCode << ',' << outcome.triangles << ',' << measured.data() << ','
         << outcome.levelErrors << ',' << plain(outcome.message) << '\n';
  }
};

TEST_P(HardCases, EndAsTheTableSays) {
  const HardCase& hard = GetParam().hard;
  const Finished finished = build();
  const Outcome outcome = judge(finished);
  record(outcome, finished);
  EXPECT_EQ(outcome.state, hard.outcome) << finished.err;
  if (hard.outcome == "certified") {
    EXPECT_EQ(outcome.rule, hard.detail);
  } else {
    const std::string code = hard.detail.substr(0, 1);
    EXPECT_EQ(std::to_string(finished.exitCode), code) << finished.err;
    EXPECT_NE(finished.err.find(hard.detail.substr(2)), std::string::npos) << finished.err;
  }
}

std::string testName(const ::testing::TestParamInfo<HardRun>& info) {
  std::string name = info.param.hard.name + "_by_" + info.param.builder;
  for (char& letter : name)
    if (std::isalnum(static_cast<unsigned char>(letter)) == 0) letter = '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(Table, HardCases, ::testing::ValuesIn(wantedRuns()), testName);

/// The table and the inputs belong together.
TEST(HardCaseTable, NamesEveryInputOnce) {
  std::set<std::string> files;
  std::set<std::string> names;
  for (const HardCase& hard : readCases()) {
    EXPECT_TRUE(files.insert(hard.file).second) << hard.file << " is there twice";
    EXPECT_TRUE(names.insert(hard.name).second) << hard.name << " is there twice";
    EXPECT_TRUE(hard.outcome == "certified" || hard.outcome == "refused") << hard.name;
    EXPECT_GT(hard.seconds, 0) << hard.name;
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(SPHERETREE_HARD_FOLDER "/files"))
    EXPECT_EQ(files.count(entry.path().filename().string()), 1U) << entry.path();
}

}  // namespace
}  // namespace spheretree::tests
