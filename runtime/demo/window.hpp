// SPDX-License-Identifier: MIT
#pragma once

#include <spheretree/result.hpp>

#include "options.hpp"
#include "tree_library.hpp"

namespace crowded_room {

/// Opens the window and plays until the user ends it or the frames asked for are over. Fails with
/// InvalidArgument when no window with OpenGL 3.3 can be opened, and as Room and Stage do.
spheretree::Result<spheretree::Done> runWindow(const Options& options, const TreeLibrary& library);

}  // namespace crowded_room
