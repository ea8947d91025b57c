// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the nastiest files cost, each in three sizes: bytes, and the time of parsing, of laying out and of one
// query of the tree against itself. Twice the bytes may cost twice the time; only a query without a budget
// may cost four times as much (docs/file-format.md).

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include <spheretree/distance_query.hpp>
#include <spheretree/pair_query.hpp>
#include <spheretree/sph.hpp>

namespace {

using namespace spheretree;
using Clock = std::chrono::steady_clock;

constexpr int kRepeats = 3;

template <class Work>
double milliseconds(const Work& work) {
  double best = 1e300;
  for (int i = 0; i < kRepeats; ++i) {
    const auto start = Clock::now();
    work();
    best = std::min(best, std::chrono::duration<double, std::milli>(Clock::now() - start).count());
  }
  return best;
}

std::string repeated(std::string_view piece, std::size_t count) {
  std::string text;
  text.reserve(piece.size() * count);
  for (std::size_t i = 0; i < count; ++i) text += piece;
  return text;
}

const std::string kTree = "1 8\n0 0 0 1 1\n";

// Files of about `bytes` bytes.

std::string chain(std::size_t bytes) {
  return std::to_string(bytes / 8) + " 1\n" + repeated("1 1 1 1\n", bytes / 8);
}
std::string star(std::size_t bytes) {
  return "2 " + std::to_string(bytes / 8 - 1) + "\n" + repeated("1 1 1 1\n", bytes / 8);
}
std::string carriageReturns(std::size_t bytes) {
  return kTree + repeated(repeated("\r", 1000) + "x\n", bytes / 1002);
}
std::string longNumber(std::size_t bytes) {
  return "1 8\n0." + repeated("0", bytes / 2) + repeated("7", bytes / 2) + " 0 0 1\n";
}
std::string longExponent(std::size_t bytes) {
  return "1 8\n1e-" + repeated("9", bytes) + " 0 0 1\n";
}
std::string keys(std::size_t bytes) {
  return kTree + repeated("#a:\n", bytes / 4);
}
std::string lateNul(std::size_t bytes) {
  return kTree + repeated("\n", bytes) + '\0';
}
std::string shortTable(std::size_t bytes) {
  return std::to_string(bytes / 8) + " 1\n1 1 1 1\n" + repeated("word\n", bytes / 5);
}

/// A complete tree of eight children a node whose balls all overlap but on the last level, where none do:
/// nothing can be pruned before all pairs of leaves were looked at.
std::string worstWalk(std::size_t bytes) {
  std::size_t rows = 1;
  std::size_t levels = 1;
  std::size_t last = 1;
  while ((rows + 8 * last) * 8 <= bytes) {
    last *= 8;
    rows += last;
    ++levels;
  }
  return std::to_string(levels) + " 8\n" + repeated("0 0 0 9\n", rows - last) + repeated("7 0 0 0\n", last);
}

void row(const char* name, const std::string& text) {
  Result<SphFile> file = parseSph(text);
  const double parse = milliseconds([&] { static_cast<void>(parseSph(text).ok()); });
  std::printf("%s,%zu,%.3f", name, text.size(), parse);
  if (!file) {
    std::printf(",,,,refused\n");
    return;
  }
  const double create = milliseconds([&] { static_cast<void>(QueryTree::create(file->tree).ok()); });
  const Result<QueryTree> tree = QueryTree::create(file->tree);
  if (!tree) {
    std::printf(",%.3f,,,not for queries\n", create);
    return;
  }
  // Beside each other by less than the large balls reach.
  Pose beside;
  beside.translation = {0, 1, 0};
  PairQuery query(*tree, *tree);
  const double walk = milliseconds([&] {
    query.restart({}, beside);
    query.advance();
  });
  std::printf(",%.3f,%.3f,%llu,%zu balls\n", create, walk,
              static_cast<unsigned long long>(query.sphereTests()), file->tree.nodes().size());
}

}  // namespace

int main() {
  struct Attack {
    const char* name;
    std::string (*make)(std::size_t bytes);
    std::size_t smallest;
    std::size_t factor;
  };
  constexpr std::size_t kKilobyte = 1000;
  const std::vector<Attack> attacks{{"a chain of levels", &chain, 1000 * kKilobyte, 2},
                                    {"one node with all children", &star, 1000 * kKilobyte, 2},
                                    {"as many children as queries accept", &star, 4096, 2},
                                    {"runs of carriage returns", &carriageReturns, 1000 * kKilobyte, 2},
                                    {"one number of all digits", &longNumber, 1000 * kKilobyte, 2},
                                    {"one exponent of all digits", &longExponent, 1000 * kKilobyte, 2},
                                    {"keys without end", &keys, 1000 * kKilobyte, 2},
                                    {"a NUL at the very end", &lateNul, 1000 * kKilobyte, 2},
                                    {"a short table with text behind", &shortTable, 1000 * kKilobyte, 2},
                                    {"a walk that prunes nothing", &worstWalk, 5 * kKilobyte, 8}};
  std::printf("file,bytes,parse_ms,create_ms,query_ms,sphere_tests,note\n");
  for (const Attack& attack : attacks) {
    std::size_t bytes = attack.smallest;
    for (int size = 0; size < 3; ++size, bytes *= attack.factor) row(attack.name, attack.make(bytes));
  }
  return 0;
}
