// SPDX-License-Identifier: GPL-3.0-or-later
//
// The renderer against pictures that are known by hand.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "canvas.hpp"
#include "offscreen.hpp"
#include "renderer.hpp"

namespace crowded_room {
namespace {

using spheretree::Vec3;

constexpr PixelSize kSize{200, 120};
constexpr float kDistance = 8;

class Rendering : public ::testing::Test {
 protected:
  void SetUp() override {
    auto context = Offscreen::create();
    if (!context) GTEST_SKIP() << context.error().message;
    context_ = std::move(*context);
    auto canvas = Canvas::create(kSize, Canvas::Fineness::One);
    ASSERT_TRUE(canvas.ok()) << canvas.error().message;
    canvas_ = std::move(*canvas);
    auto renderer = Renderer::create();
    ASSERT_TRUE(renderer.ok()) << renderer.error().message;
    renderer_ = std::move(*renderer);
    // Along -z, towards the middle of a room whose walls are far away.
    camera_.setAngles(0, 0);
    camera_.setDistance(kDistance);
    camera_.follow(kMiddle);
  }

  Image draw(const std::vector<Renderer::Group>& groups, Shadows shadows = Shadows::Off) {
    renderer_->draw({camera_, {100, 100, 100}, {-50, 0, 0}, 1, shadows, groups}, canvas_->fine(),
                    canvas_->fineSize());
    canvas_->average();
    return canvas_->read();
  }

  static constexpr Vec3 kMiddle{50, 50, 50};
  Camera camera_;
  std::optional<Offscreen> context_;
  std::optional<Canvas> canvas_;
  std::optional<Renderer> renderer_;
};

bool isRed(const std::uint8_t* p) {
  return p[0] > 2 * p[1] && p[0] > 2 * p[2];
}
bool isGreen(const std::uint8_t* p) {
  return p[1] > 2 * p[0] && p[1] > 2 * p[2];
}

template <class Is>
int count(const Image& image, Is is) {
  int found = 0;
  for (int y = 0; y < image.size.height; ++y) {
    for (int x = 0; x < image.size.width; ++x) found += is(image.pixel(x, y)) ? 1 : 0;
  }
  return found;
}

constexpr Color kRed{220, 10, 10, 255};
constexpr Color kGreen{10, 200, 10, 255};

TEST_F(Rendering, ABallIsAsLargeAsItsConeOfSight) {
  for (const float radius : {0.5F, 2.0F, 3.5F}) {
    Renderer::Model model;
    const std::vector<PaintedBall> balls{{{{0, 0, 0}, radius}, kRed}};
    model.setBalls(balls);
    const std::vector<Instance> instances{{kMiddle, 1, {}, 0}};
    const Image empty = draw({});
    const Image image = draw({{&model, Look::Balls, instances}});
    int covered = 0;
    for (std::size_t k = 0; k < image.rgb.size(); k += 3)
      covered += std::equal(&image.rgb[k], &image.rgb[k] + 3, &empty.rgb[k]) ? 0 : 1;
    // Its outline is seen under the angle whose sine is radius over distance.
    const float tangent = radius / std::sqrt(kDistance * kDistance - radius * radius);
    const float pixels = 0.5F * static_cast<float>(kSize.height) * tangent / camera_.slope();
    const float area = std::numbers::pi_v<float> * pixels * pixels;
    EXPECT_NEAR(static_cast<float>(covered), area, 0.02F * area + 6) << radius;
  }
}

TEST_F(Rendering, BallsMeetInTheirCommonCircle) {
  Renderer::Model model;
  const std::vector<PaintedBall> balls{{{{-0.6F, 0, 0}, 1}, kRed}, {{{0.6F, 0, 0}, 1}, kGreen}};
  model.setBalls(balls);
  const std::vector<Instance> instances{{kMiddle, 1, {}, 0}};
  const Image image = draw({{&model, Look::Balls, instances}});
  const int middle = kSize.width / 2;
  const int y = kSize.height / 2;
  EXPECT_TRUE(isRed(image.pixel(middle - 3, y)));
  EXPECT_TRUE(isGreen(image.pixel(middle + 3, y)));
}

TEST_F(Rendering, ABallStandsBehindWhatIsBeforeIt) {
  Renderer::Model ball;
  const std::vector<PaintedBall> balls{{{{0, 0, 0}, 1}, kRed}};
  ball.setBalls(balls);
  Renderer::Model box;
  box.setMesh(boxMesh());
  const std::vector<Instance> at{{kMiddle, 1, {}, 0}};
  // Half the ball is in front of a large box whose front face goes through its centre.
  const std::vector<Instance> behind{{kMiddle - Vec3{0, 0, 2}, 4, kGreen, 0}};
  const Image half = draw({{&ball, Look::Balls, at}, {&box, Look::Mesh, behind}});
  EXPECT_TRUE(isRed(half.pixel(kSize.width / 2, kSize.height / 2)));
  EXPECT_GT(count(half, isGreen), 0);
  const std::vector<Instance> before{{kMiddle, 4, kGreen, 0}};
  const Image hidden = draw({{&ball, Look::Balls, at}, {&box, Look::Mesh, before}});
  EXPECT_EQ(count(hidden, isRed), 0);
}

TEST_F(Rendering, InstancesStandWhereTheyAreAndKeepTheirColours) {
  Renderer::Model box;
  box.setMesh(boxMesh());
  const std::vector<Instance> two{{kMiddle - Vec3{2, 0, 0}, 1, kRed, 0},
                                  {kMiddle + Vec3{2, 0, 0}, 1, kGreen, 0}};
  const Image image = draw({{&box, Look::Mesh, two}});
  const float step = 0.5F * static_cast<float>(kSize.height) * 2 / kDistance / camera_.slope();
  const int side = static_cast<int>(std::lround(step));
  EXPECT_TRUE(isRed(image.pixel(kSize.width / 2 - side, kSize.height / 2)));
  EXPECT_TRUE(isGreen(image.pixel(kSize.width / 2 + side, kSize.height / 2)));
  EXPECT_FALSE(isRed(image.pixel(kSize.width / 2, kSize.height / 2)));
}

TEST_F(Rendering, AGlowingObjectHasTheColourOfACollision) {
  Renderer::Model box;
  box.setMesh(boxMesh());
  const std::vector<Instance> glowing{{kMiddle, 2, kGreen, 1}};
  const Image image = draw({{&box, Look::Mesh, glowing}});
  const std::uint8_t* p = image.pixel(kSize.width / 2, kSize.height / 2);
  EXPECT_GT(p[0], 200);
  EXPECT_GT(p[0], 2 * p[1]);
  EXPECT_GT(p[1], p[2]) << "orange, not red";
}

TEST_F(Rendering, AnObjectThrowsAShadowOnTheFloor) {
  camera_.follow({50, 2, 50});
  camera_.setAngles(0, 1.2F);
  camera_.setDistance(20);
  Renderer::Model box;
  box.setMesh(boxMesh());
  const std::vector<Instance> floating{{{50, 4, 50}, 3, kGreen, 0}};
  const std::vector<Renderer::Group> groups{{&box, Look::Mesh, floating}};
  const Image without = draw(groups, Shadows::Off);
  const Image with = draw(groups, Shadows::On);
  int darker = 0;
  for (std::size_t k = 0; k < with.rgb.size(); k += 3) darker += with.rgb[k] + 15 < without.rgb[k] ? 1 : 0;
  EXPECT_GT(darker, 100);
  EXPECT_LT(darker, kSize.width * kSize.height / 4);
}

TEST_F(Rendering, AveragingKeepsTheMeanOfTheSamples) {
  auto fine = Canvas::create({4, 2}, Canvas::Fineness::Four);
  ASSERT_TRUE(fine.ok());
  EXPECT_EQ(fine->fineSize(), (PixelSize{16, 8}));
  glBindFramebuffer(GL_FRAMEBUFFER, fine->fine());
  glEnable(GL_SCISSOR_TEST);
  for (int x = 0; x < 16; ++x) {  // every fourth column white
    glScissor(x, 0, 1, 8);
    const float value = x % 4 == 0 ? 1 : 0;
    glClearColor(value, value, value, 1);
    glClear(GL_COLOR_BUFFER_BIT);
  }
  glDisable(GL_SCISSOR_TEST);
  fine->average();
  const Image image = fine->read();
  for (const std::uint8_t byte : image.rgb) EXPECT_NEAR(byte, 255.0 / 4, 2);
}

}  // namespace
}  // namespace crowded_room
