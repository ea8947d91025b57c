// SPDX-License-Identifier: GPL-3.0-or-later
//
// Replaces the forms of operator new that all others are defined by.

#include "heap_calls.hpp"

#include <atomic>
#include <cstdlib>
#include <new>

namespace spheretree::test {

namespace {

std::atomic<std::size_t> calls{0};

void* take(std::size_t size, std::size_t alignment) {
  ++calls;
  // aligned_alloc wants whole multiples of the alignment.
  void* memory = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

std::size_t heapCalls() noexcept {
  return calls;
}

}  // namespace spheretree::test

void* operator new(std::size_t size) {
  return spheretree::test::take(size, __STDCPP_DEFAULT_NEW_ALIGNMENT__);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return spheretree::test::take(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}
