// SPDX-License-Identifier: GPL-3.0-or-later
//
// Writes generated inputs of the corpus of hard cases.
//   make_hard_inputs FOLDER [FILE...]      these, or all; an existing one is replaced
//   make_hard_inputs --list
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/files.hpp"
#include "io/mesh_write.hpp"
#include "tests/hard/hard_inputs.hpp"

namespace {

namespace io = spheretree::io;
using spheretree::test::HardInput;

std::vector<HardInput> allInputs() {
  std::vector<HardInput> all;
  for (const auto& some : {spheretree::test::hardMeshes(), spheretree::test::brokenFiles()})
    all.insert(all.end(), some.begin(), some.end());
  return all;
}

bool write(const std::filesystem::path& folder, const HardInput& input) {
  const auto path = folder / input.file;
  const auto written = input.mesh != nullptr
                           ? io::writeMesh(path, input.mesh(), io::Overwrite::Replace)
                           : io::writeFileAtomically(path, input.bytes(), io::Overwrite::Replace);
  if (!written) std::fprintf(stderr, "make_hard_inputs: %s\n", written.error().message.c_str());
  return written.ok();
}

int run(const std::vector<std::string>& words) {
  const std::vector<HardInput> inputs = allInputs();
  if (words == std::vector<std::string>{"--list"}) {
    for (const HardInput& input : inputs) std::printf("%s\n", std::string(input.file).c_str());
    return 0;
  }
  if (words.empty()) {
    std::fprintf(stderr, "usage: make_hard_inputs FOLDER [FILE...] | --list\n");
    return 2;
  }
  for (const HardInput& input : inputs) {
    const bool wanted =
        words.size() == 1 || std::find(words.begin() + 1, words.end(), input.file) != words.end();
    if (wanted && !write(words.front(), input)) return 1;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run({argv + 1, argv + argc});
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "make_hard_inputs: %s\n", failure.what());
    return 1;
  }
}
