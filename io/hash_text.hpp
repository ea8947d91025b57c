// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <xxhash.h>

#include <string>

namespace spheretree::io {

/// 32 hex digits, the most significant first.
[[nodiscard]] std::string hashText(const XXH128_hash_t& hash);

}  // namespace spheretree::io
