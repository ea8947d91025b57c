// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "runtime/demo/room.hpp"

namespace crowded_room::test {

/// Three balls on each other, two levels, as bunnies; the built-in box as boxes.
inline const TreeLibrary& library() {
  static const TreeLibrary trees = [] {
    TreeLibrary made = TreeLibrary::builtIn();
    using Entry = spheretree::SphereTree::Entry;
    const std::vector<Entry> entries{{{{0, 0, 0}, 0.7F}},
                                     {{{0, -0.3F, 0}, 0.3F}, 0},
                                     {{{0.1F, 0.1F, 0}, 0.25F}, 0},
                                     {{{0.2F, 0.4F, 0.1F}, 0.15F}, 0}};
    const auto added = made.add("snowman", {std::move(*spheretree::SphereTree::create(entries)), 3, {}, {}});
    EXPECT_TRUE(added.ok());
    return made;
  }();
  return trees;
}

inline Room makeRoom(const RoomSettings& settings) {
  spheretree::Result<Room> room = Room::create(settings, library());
  EXPECT_TRUE(room.ok()) << room.error().message;
  return std::move(*room);
}

}  // namespace crowded_room::test
