// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace spheretree::io {

/// A file of io/html/ or of a JavaScript library, as it was when the program was built: the templates name
/// it `{{name}}`. Empty for a name that does not exist, and for libraries that were missing.
[[nodiscard]] std::string_view htmlAsset(std::string_view name);

}  // namespace spheretree::io
