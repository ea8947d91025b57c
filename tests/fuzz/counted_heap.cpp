// SPDX-License-Identifier: GPL-3.0-or-later
//
// Replaces every form of operator new without alignment by malloc with a tally. Each block carries its size
// in front of it, so releasing it can be counted without asking the C library.

#include "counted_heap.hpp"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <new>

namespace spheretree::fuzz {

namespace {

constexpr std::size_t kPrefix = __STDCPP_DEFAULT_NEW_ALIGNMENT__;

std::atomic<std::size_t> inUse{0};
std::atomic<std::size_t> highest{0};

void* take(std::size_t size) noexcept {
  if (size > static_cast<std::size_t>(-1) - kPrefix) return nullptr;
  void* block = std::malloc(size + kPrefix);
  if (block == nullptr) return nullptr;
  *static_cast<std::size_t*>(block) = size;
  const std::size_t now = inUse += size;
  std::size_t seen = highest;
  while (now > seen && !highest.compare_exchange_weak(seen, now)) {
  }
  return static_cast<char*>(block) + kPrefix;
}

void* takeOrEnd(std::size_t size) {
  void* memory = take(size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

void release(void* memory) noexcept {
  if (memory == nullptr) return;
  void* block = static_cast<char*>(memory) - kPrefix;
  inUse -= *static_cast<std::size_t*>(block);
  std::free(block);
}

}  // namespace

HeapWatch::HeapWatch() noexcept : before_(inUse) {
  highest = before_;
}

std::size_t HeapWatch::peak() const noexcept {
  return highest - before_;
}

}  // namespace spheretree::fuzz

void* operator new(std::size_t size) {
  return spheretree::fuzz::takeOrEnd(size);
}
void* operator new[](std::size_t size) {
  return spheretree::fuzz::takeOrEnd(size);
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return spheretree::fuzz::take(size);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return spheretree::fuzz::take(size);
}
void operator delete(void* memory) noexcept {
  spheretree::fuzz::release(memory);
}
void operator delete[](void* memory) noexcept {
  spheretree::fuzz::release(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  spheretree::fuzz::release(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  spheretree::fuzz::release(memory);
}
void operator delete(void* memory, const std::nothrow_t&) noexcept {
  spheretree::fuzz::release(memory);
}
void operator delete[](void* memory, const std::nothrow_t&) noexcept {
  spheretree::fuzz::release(memory);
}
