// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>

namespace spheretree::test {

/// A count from the environment, for runs longer than a test's.
inline std::size_t countFrom(const char* variable, std::size_t otherwise) {
  const char* text = std::getenv(variable);  // NOLINT(concurrency-mt-unsafe)
  return text == nullptr ? otherwise : std::strtoul(text, nullptr, 10);
}

/// One line of tests/hard/results/differential.csv.
struct Tally {
  std::string check;
  std::string against;
  std::uint64_t seed = 0;
  std::size_t cases = 0;
  std::size_t comparisons = 0;
  std::size_t contradictions = 0;
  std::string note{};  ///< no comma in it
};

/// Appends the line to the file that SPHERETREE_DIFFERENTIAL_CSV names, if it names one.
inline void publish(const Tally& tally) {
  const char* path = std::getenv("SPHERETREE_DIFFERENTIAL_CSV");  // NOLINT(concurrency-mt-unsafe)
  if (path == nullptr) return;
  std::ofstream file(path, std::ios::app);
  if (file.tellp() == 0) file << "check,against,seed,cases,comparisons,contradictions,note\n";
  file << tally.check << ',' << tally.against << ',' << tally.seed << ',' << tally.cases << ','
       << tally.comparisons << ',' << tally.contradictions << ',' << tally.note << '\n';
}

}  // namespace spheretree::test
