// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <spheretree/result.hpp>

namespace spheretree::cli {

/// What the program returns (docs/command-line.md).
enum class ExitCode : int {
  Done = 0,
  OurFault = 1,
  Usage = 2,
  UnreadableInput = 3,
  UnsuitableMesh = 4,
  ErrorBoundMissed = 5,
  UnwritableOutput = 6,
  SomeFailed = 7,  ///< batch: at least one asset has no tree; the others are done
  Cancelled = 130  ///< 128 + SIGINT, as shells count
};

[[nodiscard]] constexpr ExitCode exitCodeOf(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::InvalidArgument:
      return ExitCode::Usage;
    case ErrorCode::UnreadableInput:
      return ExitCode::UnreadableInput;
    case ErrorCode::UnsuitableMesh:
      return ExitCode::UnsuitableMesh;
    case ErrorCode::ErrorBoundMissed:
      return ExitCode::ErrorBoundMissed;
    case ErrorCode::UnwritableOutput:
      return ExitCode::UnwritableOutput;
    case ErrorCode::Cancelled:
      return ExitCode::Cancelled;
    case ErrorCode::Internal:
      break;
  }
  return ExitCode::OurFault;
}

}  // namespace spheretree::cli
