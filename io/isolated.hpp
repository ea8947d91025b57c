// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include <spheretree/result.hpp>

namespace spheretree::io {

/// Runs `work` in a process of its own and returns the bytes that it makes: for code of others that input can
/// break. Its standard error is dropped, and it dies with the caller. `limit` is on the seconds of computing;
/// whole ones, rounded up.
///
/// Errors: those of `work`; UnreadableInput when the process dies or runs out of time, with a reason that
/// begins "the reader of this format"; Internal when there can be no process.
Result<std::string> runIsolated(const std::function<Result<std::string>()>& work, std::chrono::seconds limit);

}  // namespace spheretree::io
