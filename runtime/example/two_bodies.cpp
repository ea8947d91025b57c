// SPDX-License-Identifier: MIT
//
// two_bodies TREE.sph: two copies of a solid fly at each other until they touch.
#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>

#include <spheretree/collision_world.hpp>
#include <spheretree/response.hpp>
#include <spheretree/sph.hpp>
#include <spheretree/sweep.hpp>

int main(int argc, char** argv) {
  std::ifstream file(argc > 1 ? argv[1] : "");
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const auto sph = spheretree::parseSph(text);
  if (!sph) {
    std::fprintf(stderr, "%s\n", sph.error().message.c_str());
    return 1;
  }
  const auto tree = spheretree::QueryTree::create(sph.value().tree, spheretree::standOffsOf(sph.value()));
  if (!tree) return 1;

  spheretree::CollisionWorld world(std::make_unique<spheretree::Sweep>());
  const float far = 2 * tree.value().extent();
  world.addTree(tree.value(), {{}, {-far, 0, 0}, 1}, {far / 2, 0, 0});
  world.addTree(tree.value(), {{}, {far, 0, 0}, 1}, {-far / 2, 0, 0});
  for (int frame = 0; frame < 300; ++frame) {
    if (!world.step(1.0F / 60)) return 1;
    for (const spheretree::Contact& contact : world.contacts()) {
      std::printf("frame %d: contact at (%g %g %g), the solids are at most %g apart\n", frame,
                  static_cast<double>(contact.point.x), static_cast<double>(contact.point.y),
                  static_cast<double>(contact.point.z), static_cast<double>(contact.slackBound));
    }
    if (!world.contacts().empty()) return 0;
    spheretree::respond(world);
  }
  return 1;
}
