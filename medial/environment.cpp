// SPDX-License-Identifier: GPL-3.0-or-later
#include "medial/environment.hpp"

#if defined(__linux__)
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <system_error>
#endif

namespace spheretree::medial {

#if defined(__linux__)

void tuneEnvironment(char** argv) {
  if (std::getenv("OMP_WAIT_POLICY") != nullptr) return;
  constexpr int kKeep = 0;  // what is set already
  if (setenv("OMP_WAIT_POLICY", "passive", kKeep) != 0) return;
  static_cast<void>(setenv("GLIBC_TUNABLES",
                           "glibc.malloc.hugetlb=1:glibc.malloc.mmap_threshold=1073741824"
                           ":glibc.malloc.trim_threshold=1073741824",
                           kKeep));
  // By its own path, so that it keeps its name.
  std::error_code failure;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", failure);
  if (!failure) static_cast<void>(execv(self.c_str(), argv));
}

#else

void tuneEnvironment(char** /*argv*/) {}

#endif

}  // namespace spheretree::medial
