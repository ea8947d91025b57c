// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <exception>
#include <new>
#include <string>
#include <utility>

#include <spheretree/result.hpp>

namespace spheretree::io {

/// Runs `body`, which returns a Result, and turns what it throws into an Error: the border where exceptions
/// of this layer and of the libraries below it end. `subject` is a file's name or what was being done. A lack
/// of memory is no fault of the input: Internal.
template <class Body>
auto guarded(ErrorCode code, const std::string& subject, Body&& body) -> decltype(body()) {
  try {
    return std::forward<Body>(body)();
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::Internal, subject + ": not enough memory"};
  } catch (const std::exception& failure) {
    return Error{code, subject + ": " + failure.what()};
  }
}

}  // namespace spheretree::io
