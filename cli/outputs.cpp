// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/outputs.hpp"

#include <algorithm>
#include <system_error>

#include "cli/interrupt.hpp"

namespace spheretree::cli {
namespace {

namespace fs = std::filesystem;

/// True when writing one would write the other. Devices (`/dev/stdout` twice) are nobody's loss.
bool sameFile(const fs::path& a, const fs::path& b) {
  std::error_code failure;
  if (fs::exists(a, failure) && fs::exists(b, failure)) {
    return fs::is_regular_file(a, failure) && fs::equivalent(a, b, failure);
  }
  const fs::path first = fs::weakly_canonical(fs::absolute(a, failure), failure);
  return !first.empty() && first == fs::weakly_canonical(fs::absolute(b, failure), failure);
}

}  // namespace

Result<Done> checkOutputs(std::span<const fs::path> inputs, std::span<const fs::path> outputs,
                          io::Overwrite overwrite) {
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const fs::path& output = outputs[k];
    const auto clashes = [&](const fs::path& other) { return sameFile(other, output); };
    if (std::any_of(inputs.begin(), inputs.end(), clashes)) {
      return Error{ErrorCode::InvalidArgument,
                   output.string() + ": is an input, and an input is never replaced"};
    }
    const auto before = outputs.first(k);
    if (std::any_of(before.begin(), before.end(), clashes)) {
      return Error{ErrorCode::InvalidArgument, output.string() + ": two outputs cannot be the same file"};
    }
  }
  const PostponeInterrupts whole;  // a file is made to see whether that is possible, and taken away again
  for (const fs::path& output : outputs) {
    const Result<Done> writable = io::checkWritable(output, overwrite);
    if (writable) continue;
    Error error = writable.error();
    std::error_code failure;
    if (overwrite == io::Overwrite::Refuse && fs::is_regular_file(output, failure))
      error.message += "; --force replaces it";
    return error;
  }
  return Done{};
}

Result<Done> writeOutputs(const std::vector<Output>& outputs, io::Overwrite overwrite) {
  const HoldInterrupts hold;
  std::string written;
  for (const Output& output : outputs) {
    const Result<Done> done = io::writeFileAtomically(output.path, output.bytes, overwrite);
    if (!done) {
      const std::string kept = written.empty() ? "" : " (written before that: " + written + ")";
      return Error{done.error().code, done.error().message + kept};
    }
    written += (written.empty() ? "" : ", ") + output.path.string();
  }
  return Done{};
}

}  // namespace spheretree::cli
