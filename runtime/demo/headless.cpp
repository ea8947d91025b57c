// SPDX-License-Identifier: MIT
#include "headless.hpp"
