// SPDX-License-Identifier: MIT
#include "room.hpp"
