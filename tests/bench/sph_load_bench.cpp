// SPDX-License-Identifier: GPL-3.0-or-later
//
// How long the `.sph` codec takes for a table of a million rows, from memory to memory: one warm-up, then the
// median of several repeats. Each row carries a hash of what was read or written; rows of one dialect that
// differ in it do not measure the same work.

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <spheretree/sph.hpp>

namespace {

using namespace spheretree;

constexpr std::uint32_t kSeed = 1;
constexpr std::uint32_t kBranch = 10;
constexpr std::size_t kLevels = 7;  // 1,111,111 rows
constexpr std::size_t kRepeats = 11;
constexpr std::uint32_t kUnusedShare = 10;  // one child in so many is missing

/// 64-bit FNV-1a.
class Hash {
 public:
  void add(std::uint32_t word) noexcept {
    for (int byte = 0; byte < 4; ++byte) add(static_cast<char>(word >> (8 * byte)));
  }
  void add(std::string_view text) noexcept {
    for (const char c : text) add(c);
  }
  [[nodiscard]] std::uint64_t value() const noexcept { return value_; }

 private:
  void add(char byte) noexcept { value_ = (value_ ^ static_cast<unsigned char>(byte)) * 0x100000001b3U; }

  std::uint64_t value_ = 0xcbf29ce484222325U;
};

std::uint64_t hashOf(const SphereTree& tree) {
  Hash hash;
  for (const Node& node : tree.nodes()) {
    const auto& [center, radius] = node.ball;
    for (const float number : {center.x, center.y, center.z, radius})
      hash.add(std::bit_cast<std::uint32_t>(number));
    hash.add(node.parent);
  }
  return hash.value();
}

std::uint64_t hashOf(std::string_view text) {
  Hash hash;
  hash.add(text);
  return hash.value();
}

/// A tree of random balls with a tenth of its subtrees missing, as real ones have.
SphereTree makeTree() {
  std::mt19937 random(kSeed);
  const auto number = [&] { return static_cast<float>(random()) * 0x1p-31F - 1; };
  const auto ball = [&] { return Sphere{{number(), number(), number()}, std::abs(number()) + 0.01F}; };
  std::vector<SphereTree::Entry> entries{{ball(), kNoParent}};
  std::size_t begin = 0;
  for (std::size_t depth = 1; depth < kLevels; ++depth) {
    const std::size_t end = entries.size();
    for (std::size_t parent = begin; parent < end; ++parent) {
      for (std::uint32_t k = 0; k < kBranch; ++k) {
        const bool first = k == 0;
        if (first || random() % kUnusedShare != 0)
          entries.push_back({ball(), static_cast<std::uint32_t>(parent)});
      }
    }
    begin = end;
  }
  return SphereTree::create(entries).value();
}

/// The same table as the classic toolkit writes it: five numbers with six decimals.
std::string formatClassic(std::string_view strict) {
  const std::size_t header = strict.find('\n') + 1;
  std::string text(strict.substr(0, header));
  const std::string rows(strict.substr(header));
  for (const char* at = rows.c_str(); *at != '\0';) {
    for (int column = 0; column < 5; ++column) {
      char* end = nullptr;
      std::array<char, 64> digits{};
      std::snprintf(digits.data(), digits.size(), "%.6f", std::strtod(at, &end));
      text.append(digits.data()).append(column < 4 ? " " : "\n");
      at = end;
    }
    ++at;  // the line break
  }
  return text;
}

struct Sample {
  std::size_t spheres = 0;
  std::uint64_t hash = 0;
};

/// Runs `work`, whose value is looked at outside the time measured, and prints its row.
template <class Work, class Look>
void measure(const char* name, std::size_t bytes, Work work, Look look) {
  std::vector<double> milliseconds;
  Sample sample = look(work());
  for (std::size_t i = 0; i < kRepeats; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const auto value = work();
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
    milliseconds.push_back(elapsed.count());
    sample = look(value);
  }
  std::sort(milliseconds.begin(), milliseconds.end());
  const double median = milliseconds[kRepeats / 2];
  std::printf("%s,%zu,%zu,%zu,%.3f,%.3f,%016llx\n", name, sample.spheres, bytes, kRepeats, median,
              milliseconds.front(), static_cast<unsigned long long>(sample.hash));
}

}  // namespace

int main() {
  const SphereTree tree = makeTree();
  const std::string strict = formatSph(tree, kBranch).value();
  const std::string classic = formatClassic(strict);
  const auto readTree = [](const Result<SphFile>& file) {
    return file ? Sample{file->tree.nodes().size(), hashOf(file->tree)} : Sample{};
  };
  std::printf("case,spheres,bytes,repeats,median_ms,best_ms,hash\n");
  measure(
      "read-strict", strict.size(), [&] { return parseSph(strict); }, readTree);
  measure(
      "read-classic", classic.size(), [&] { return parseSph(classic); }, readTree);
  measure(
      "read-4-levels", strict.size(), [&] { return parseSph(strict, {4}); }, readTree);
  measure(
      "write-strict", strict.size(), [&] { return formatSph(tree, kBranch); },
      [&](const Result<std::string>& text) {
        return Sample{tree.nodes().size(), hashOf(*text)};
      });
  return 0;
}
