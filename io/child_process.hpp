// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <string>

#include <spheretree/result.hpp>

namespace spheretree::io {

/// How a child process ended.
struct ChildEnd {
  bool finished = false;              ///< `work` returned; `bytes` is what it gave
  bool threw = false;                 ///< `work` ran out of memory or threw
  int signal = 0;                     ///< what killed it, 0 when it, or a library in it, ended the process
  std::string bytes;                  ///< what `work` returned, or what it threw
  std::string complaint;              ///< the last line that it (a library in it) wrote to standard error
  std::uint64_t peakMemoryBytes = 0;  ///< its largest resident set
};

/// Runs a function in a process of its own, so that a crash or a runaway allocation in it is an answer
/// instead of the end of the caller. The child shares no file with the caller, never writes to its
/// terminal, and dies with it.
///
/// The caller must have started no threads (they do not exist in the child), and no parallel loop.
class ChildProcess {
 public:
  /// Starts `work`. `memoryBytes` bounds what it may allocate, 0 does not. Errors: Internal, when the system
  /// gives no process.
  static Result<ChildProcess> start(const std::function<std::string()>& work, std::uint64_t memoryBytes);

  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&& other) noexcept;
  /// Kills what still runs.
  ~ChildProcess();

  /// Becomes readable (end of file) when the child has ended.
  [[nodiscard]] int watch() const noexcept { return watch_; }

  /// Ends it at once; finish() is still to be called.
  void kill() const noexcept;

  /// Waits for the end. Once.
  [[nodiscard]] ChildEnd finish();

 private:
  ChildProcess(pid_t process, int watch, int result, int complaint) noexcept;

  pid_t process_ = 0;  // 0: none, or waited for
  int watch_ = -1;
  int result_ = -1;
  int complaint_ = -1;
};

/// "signal 11 (Segmentation fault)"
[[nodiscard]] std::string signalName(int signal);

}  // namespace spheretree::io
