// SPDX-License-Identifier: MIT
#pragma once

#include <cassert>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>

namespace spheretree {

/// Why an operation at the border of the library (a file, a mesh, a user's wish) did not succeed.
enum class ErrorCode : std::uint8_t {
  InvalidArgument,   ///< a setting out of its range, or two settings that contradict each other
  UnreadableInput,   ///< the file is missing, truncated, of another format, or says something impossible
  UnsuitableMesh,    ///< the mesh was read but cannot be turned into a tree by the rule asked for
  ErrorBoundMissed,  ///< everything was built, but the wanted error was not reached
  UnwritableOutput,  ///< the output exists, or its folder refuses it
  Cancelled,         ///< the caller asked to stop
  Internal           ///< our fault
};

/// A reason and one clear sentence for the user: file, place, what is wrong. No trailing newline.
struct Error {
  ErrorCode code = ErrorCode::Internal;
  std::string message;
};

/// Either a value or an Error, never neither. Reading the one that is not there is a programming error.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

  [[nodiscard]] bool ok() const noexcept { return state_.index() == 0; }
  explicit operator bool() const noexcept { return ok(); }

  [[nodiscard]] T& value() & noexcept {
    assert(ok());
    return *std::get_if<0>(&state_);
  }
  [[nodiscard]] const T& value() const& noexcept {
    assert(ok());
    return *std::get_if<0>(&state_);
  }
  [[nodiscard]] T&& value() && noexcept {
    assert(ok());
    return std::move(*std::get_if<0>(&state_));
  }
  [[nodiscard]] const Error& error() const noexcept {
    assert(!ok());
    return *std::get_if<1>(&state_);
  }

  T& operator*() & noexcept { return value(); }
  const T& operator*() const& noexcept { return value(); }
  T* operator->() noexcept { return &value(); }
  const T* operator->() const noexcept { return &value(); }

 private:
  std::variant<T, Error> state_;
};

/// The value of an operation that either happened or did not.
struct Done {};

}  // namespace spheretree
