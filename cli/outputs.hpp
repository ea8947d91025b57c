// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <spheretree/result.hpp>

#include "io/files.hpp"

namespace spheretree::cli {

/// Asks before a long job whether its outputs could be written. Errors: InvalidArgument when an output is
/// one of the inputs or two outputs are the same file, UnwritableOutput as io::checkWritable.
Result<Done> checkOutputs(std::span<const std::filesystem::path> inputs,
                          std::span<const std::filesystem::path> outputs, io::Overwrite overwrite);

struct Output {
  std::filesystem::path path;
  std::string bytes;
};

/// Writes the files in the order given, each whole or not at all, and stops at the first that fails; the
/// error says which were written before. Interrupts are held meanwhile.
Result<Done> writeOutputs(const std::vector<Output>& outputs, io::Overwrite overwrite);

}  // namespace spheretree::cli
