// SPDX-License-Identifier: GPL-3.0-or-later
//
// A signal handler may touch lock-free atomics and little else, so the whole state is a few of them.
#include "cli/interrupt.hpp"

#include <unistd.h>
#include <csignal>

#include <atomic>
#include <cassert>

#include "cli/exit_code.hpp"

namespace spheretree::cli {
namespace {

std::atomic<medial::Context*> cancellable{nullptr};
std::atomic<int> held{0};
std::atomic<bool> pending{false};
std::atomic<bool> came{false};  // a signal, while held
static_assert(std::atomic<medial::Context*>::is_always_lock_free && std::atomic<int>::is_always_lock_free &&
              std::atomic<bool>::is_always_lock_free);

[[noreturn]] void leave() {
  ::_exit(static_cast<int>(ExitCode::Cancelled));
}

void onSignal(int) {
  if (held > 0) {
    came = true;
    return;
  }
  const bool repeated = pending.exchange(true);
  medial::Context* const context = cancellable;
  if (context == nullptr || repeated) leave();
  context->cancel();
}

}  // namespace

void catchInterrupts() {
  struct sigaction action {};
  action.sa_handler = onSignal;
  action.sa_flags = SA_RESTART;
  ::sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM}) {
    struct sigaction old {};
    // A shell that starts a program in the background has it ignore SIGINT: so be it.
    if (::sigaction(signal, nullptr, &old) == 0 && old.sa_handler != SIG_IGN)
      ::sigaction(signal, &action, nullptr);
  }
  // A limit on the size of files shall be an error of writing, like a full disk, and no sudden death.
  ::signal(SIGXFSZ, SIG_IGN);
}

CancelOnInterrupt::CancelOnInterrupt(medial::Context& context) noexcept {
  assert(cancellable == nullptr);
  cancellable = &context;
}

CancelOnInterrupt::~CancelOnInterrupt() {
  cancellable = nullptr;
}

HoldInterrupts::HoldInterrupts() noexcept {
  ++held;
}

HoldInterrupts::~HoldInterrupts() {
  --held;
}

PostponeInterrupts::~PostponeInterrupts() {
  if (came) leave();
}

}  // namespace spheretree::cli
