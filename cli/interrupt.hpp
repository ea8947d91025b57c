// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "medial/context.hpp"

namespace spheretree::cli {

/// From now on SIGINT and SIGTERM end the program with ExitCode::Cancelled: at once where nothing is at
/// stake, otherwise as the two classes below say.
void catchInterrupts();

/// While it lives, the first signal cancels the context and the second one ends the program. One at a time.
class CancelOnInterrupt {
 public:
  explicit CancelOnInterrupt(medial::Context& context) noexcept;
  CancelOnInterrupt(const CancelOnInterrupt&) = delete;
  CancelOnInterrupt& operator=(const CancelOnInterrupt&) = delete;
  ~CancelOnInterrupt();
};

/// While it lives, signals come too late: the work is done, its files are being written and are whole in a
/// moment.
class HoldInterrupts {
 public:
  HoldInterrupts() noexcept;
  HoldInterrupts(const HoldInterrupts&) = delete;
  HoldInterrupts& operator=(const HoldInterrupts&) = delete;
  ~HoldInterrupts();
};

/// While it lives, signals wait; one that came ends the program with its end. For a short step before the
/// work that must not be left half done.
class PostponeInterrupts {
 public:
  PostponeInterrupts() noexcept = default;
  PostponeInterrupts(const PostponeInterrupts&) = delete;
  PostponeInterrupts& operator=(const PostponeInterrupts&) = delete;
  ~PostponeInterrupts();

 private:
  HoldInterrupts hold_;
};

}  // namespace spheretree::cli
