// SPDX-License-Identifier: GPL-3.0-or-later
//
// Drives a fuzz target where libFuzzer is not to be had: every file of the corpus, then mutations of them,
// the same ones each time.
//
//   TARGET [--mutations N] [--seed S] [--longest BYTES] FILE_OR_FOLDER...
//
// An input that ends the process is left in `crash-TARGET` in the current folder.

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include "fuzz_target.hpp"
#include "mutator.hpp"

namespace {

using spheretree::fuzz::Mutator;

struct Options {
  std::uint64_t mutations = 1000;
  std::uint64_t seed = 1;
  std::uint64_t longest = 8192;
  std::vector<std::filesystem::path> inputs;
};

std::optional<Options> parse(int count, char** words) {
  Options options;
  for (int i = 1; i < count; ++i) {
    const std::string_view word = words[i];
    if (!word.starts_with("--")) {
      options.inputs.emplace_back(word);
      continue;
    }
    std::uint64_t* number = word == "--mutations" ? &options.mutations
                            : word == "--seed"    ? &options.seed
                            : word == "--longest" ? &options.longest
                                                  : nullptr;
    if (number == nullptr || ++i == count) return std::nullopt;
    const std::string_view value = words[i];
    const auto [end, code] = std::from_chars(value.data(), value.data() + value.size(), *number);
    if (code != std::errc{} || end != value.data() + value.size()) return std::nullopt;
  }
  if (options.inputs.empty()) return std::nullopt;
  return options;
}

/// Files by name, folders one level deep, in an order that no file system decides.
std::vector<std::string> readAll(const std::vector<std::filesystem::path>& inputs) {
  std::vector<std::filesystem::path> files;
  for (const std::filesystem::path& input : inputs) {
    if (!std::filesystem::is_directory(input)) {
      files.push_back(input);
      continue;
    }
    for (const auto& entry : std::filesystem::directory_iterator(input)) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<std::string> texts;
  for (const std::filesystem::path& file : files) {
    std::ifstream stream(file, std::ios::binary);
    texts.emplace_back(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
    if (!stream) {
      std::fprintf(stderr, "%s cannot be read\n", file.c_str());
      std::exit(2);
    }
  }
  return texts;
}

// What the signal handler needs.
std::string crashName;  // NOLINT(cert-err58-cpp)
const std::string* current = nullptr;

void keepInput(int signal) {
  if (current != nullptr) {
    const int file = open(crashName.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0644);
    if (file >= 0 && write(file, current->data(), current->size()) >= 0) close(file);
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void run(const std::string& input) {
  current = &input;
  // A block of exactly this size: a sanitizer sees any byte read too many.
  const std::vector<std::uint8_t> bytes(input.begin(), input.end());
  LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  current = nullptr;
}

}  // namespace

int main(int count, char** words) {
  const std::optional<Options> options = parse(count, words);
  if (!options) {
    std::fprintf(stderr, "usage: %s [--mutations N] [--seed S] [--longest BYTES] FILE_OR_FOLDER...\n",
                 words[0]);
    return 2;
  }
  crashName = "crash-" + std::filesystem::path(words[0]).filename().string();
  for (const int signal : {SIGABRT, SIGSEGV, SIGFPE, SIGBUS, SIGILL}) std::signal(signal, keepInput);
  const std::vector<std::string> corpus = readAll(options->inputs);
  if (corpus.empty()) {
    std::fprintf(stderr, "the corpus is empty\n");
    return 2;
  }
  for (const std::string& input : corpus) run(input);
  const auto nasty = spheretree::fuzz::nastyWords();
  Mutator mutator(corpus, {nasty.begin(), nasty.end()}, static_cast<std::uint32_t>(options->seed));
  for (std::uint64_t round = 0; round < options->mutations; ++round) {
    std::string input = mutator.next();
    input.resize(std::min<std::size_t>(input.size(), options->longest));
    run(input);
  }
  std::printf("seed %llu: %zu inputs of the corpus and %llu mutations, no flaw\n",
              static_cast<unsigned long long>(options->seed), corpus.size(),
              static_cast<unsigned long long>(options->mutations));
  return 0;
}
