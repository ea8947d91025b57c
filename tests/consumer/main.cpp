// SPDX-License-Identifier: GPL-3.0-or-later
//
// Uses a part of each piece of the library and says so in its exit code.
#include <cstdio>
#include <memory>

#include <spheretree/collision_world.hpp>
#include <spheretree/distance_query.hpp>
#include <spheretree/sph.hpp>
#include <spheretree/sweep.hpp>
#include <spheretree/version.hpp>

int main() {
  using namespace spheretree;
  const Result<SphFile> file = parseSph("2 2\n0 0 0 2 1\n-1 0 0 1 1\n1 0 0 1 1\n");
  if (!file) return 1;
  const Result<QueryTree> tree = QueryTree::create(file->tree);
  if (!tree) return 2;
  const Pose away{{}, {5, 0, 0}, 1};
  const DistanceBounds bounds = distanceBetween(tree.value(), {}, tree.value(), away);
  if (bounds.lower < 0.9F || bounds.lower > 1) return 3;  // balls end at 2 and begin at 3
  CollisionWorld world(std::make_unique<Sweep>(), {.threads = 2});
  world.addTree(tree.value(), {});
  world.addTree(tree.value(), away, {-2, 0, 0});
  if (!world.step(0) || !world.contacts().empty()) return 4;
  if (!world.step(1) || world.contacts().size() != 1) return 5;
  std::printf("spheretree %s\n", SPHERETREE_VERSION);
  return 0;
}
