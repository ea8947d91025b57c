// SPDX-License-Identifier: GPL-3.0-or-later
//
// Random cases for as long as one likes. Every case follows from its seed alone; one that fails is printed
// with it and can be run again.
//
//   soak --soak MINUTES [--seed FIRST] [--csv FILE]    cases FIRST, FIRST + 1, ...
//   soak --cases N [--seed FIRST] [--csv FILE]
//
// Exit codes: 0 nothing found, 1 something found, 2 usage.

#include <charconv>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "case_checks.hpp"
#include "random_case.hpp"

namespace {

using namespace spheretree::soak;
using Clock = std::chrono::steady_clock;

struct Options {
  double minutes = std::numeric_limits<double>::infinity();
  std::uint64_t cases = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t seed = 1;
  std::string csv;
};

template <class Number>
bool readNumber(std::string_view word, Number& number) {
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), number);
  return code == std::errc{} && end == word.data() + word.size();
}

std::optional<Options> parse(int count, char** words) {
  Options options;
  bool bounded = false;
  for (int i = 1; i + 1 < count; i += 2) {
    const std::string_view name = words[i];
    const std::string_view value = words[i + 1];
    bool good = false;
    if (name == "--soak") good = bounded = readNumber(value, options.minutes);
    if (name == "--cases") good = bounded = readNumber(value, options.cases);
    if (name == "--seed") good = readNumber(value, options.seed);
    if (name == "--csv") {
      options.csv = value;
      good = !value.empty();
    }
    if (!good) return std::nullopt;
  }
  if (count % 2 == 0 || !bounded) return std::nullopt;
  return options;
}

struct Tally {
  std::uint64_t cases = 0;
  std::uint64_t trees = 0;
  std::uint64_t refused = 0;
  std::uint64_t failed = 0;
  std::uint64_t poses = 0;
  std::uint64_t meetings = 0;
  std::uint64_t brackets = 0;
  std::uint64_t undecided = 0;
  double slowest = 0;  ///< seconds
  std::uint64_t slowestSeed = 0;
};

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void runCase(std::uint64_t seed, Tally& tally) {
  const auto start = Clock::now();
  const Case given = makeCase(seed);
  const Verdict verdict = check(given);
  ++tally.cases;
  tally.poses += verdict.poses;
  tally.meetings += verdict.meetings;
  tally.brackets += verdict.brackets;
  tally.undecided += verdict.undecided;
  if (!verdict.refusal.empty()) ++tally.refused;
  if (!verdict.flaw.empty()) {
    ++tally.failed;
    std::printf("FAILED seed %llu: %s\n  %s\n", static_cast<unsigned long long>(seed), verdict.flaw.c_str(),
                given.what.c_str());
    std::fflush(stdout);
  }
  tally.trees += verdict.refusal.empty() && verdict.flaw.empty() ? 1U : 0U;
  if (const double seconds = secondsSince(start); seconds > tally.slowest) {
    tally.slowest = seconds;
    tally.slowestSeed = seed;
  }
}

/// Of this process: on a busy machine much less than what the clock says.
double cpuMinutes() {
  return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC) / 60;
}

/// The whole file anew: a run that is killed leaves the figures so far.
void writeCsv(const Options& options, const Tally& tally, double minutes) {
  if (options.csv.empty()) return;
  std::ofstream file(options.csv);
  file << "first_seed,minutes,cpu_minutes,cases,trees_checked,refused_by_name,failed,overhang_brackets,pose_"
          "pairs,"
          "pose_pairs_meeting,chain_proofs_not_repeated,slowest_s,slowest_seed\n"
       << options.seed << ',' << minutes << ',' << cpuMinutes() << ',' << tally.cases << ',' << tally.trees
       << ',' << tally.refused << ',' << tally.failed << ',' << tally.brackets << ',' << tally.poses << ','
       << tally.meetings << ',' << tally.undecided << ',' << tally.slowest << ',' << tally.slowestSeed
       << '\n';
}

}  // namespace

int main(int count, char** words) {
  const std::optional<Options> options = parse(count, words);
  if (!options) {
    std::fprintf(stderr, "usage: %s --soak MINUTES | --cases N [--seed FIRST] [--csv FILE]\n", words[0]);
    return 2;
  }
  constexpr double kSecondsBetweenNotes = 60;
  const auto start = Clock::now();
  double noted = 0;
  Tally tally;
  while (tally.cases < options->cases && secondsSince(start) < 60 * options->minutes) {
    runCase(options->seed + tally.cases, tally);
    if (secondsSince(start) - noted > kSecondsBetweenNotes) {
      noted = secondsSince(start);
      writeCsv(*options, tally, noted / 60);
    }
  }
  writeCsv(*options, tally, secondsSince(start) / 60);
  std::printf(
      "seeds %llu to %llu: %llu cases, %llu trees checked, %llu refused by name, %llu failed; slowest seed "
      "%llu, %.1f s\n",
      static_cast<unsigned long long>(options->seed),
      static_cast<unsigned long long>(options->seed + tally.cases - 1),
      static_cast<unsigned long long>(tally.cases), static_cast<unsigned long long>(tally.trees),
      static_cast<unsigned long long>(tally.refused), static_cast<unsigned long long>(tally.failed),
      static_cast<unsigned long long>(tally.slowestSeed), tally.slowest);
  return tally.failed == 0 ? 0 : 1;
}
