// SPDX-License-Identifier: MIT
#include "tree_library.hpp"
