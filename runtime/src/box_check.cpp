// SPDX-License-Identifier: MIT

#include "box_check.hpp"

#include <string>

namespace spheretree::detail {

Error faultAt(std::size_t index) {
  return {ErrorCode::InvalidArgument,
          "box " + std::to_string(index) + " is not finite, or its minimum exceeds its maximum"};
}

Error tooManyBoxes() {
  return {ErrorCode::InvalidArgument, "a broad phase takes at most 2^30 boxes"};
}

}  // namespace spheretree::detail
