// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include <spheretree/collision_world.hpp>
#include <spheretree/pair_query.hpp>

namespace spheretree {

struct CollisionWorld::Block {
  std::uint32_t bench = 0;
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};

struct CollisionWorld::Bench {
  PairQuery query;
  std::vector<Contact> contacts;
};

}  // namespace spheretree
