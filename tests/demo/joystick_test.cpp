// SPDX-License-Identifier: GPL-3.0-or-later
//
// A joystick that SDL pretends to have: what it does to the room, and what the room does to it.
#include <SDL.h>

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "pilot.hpp"
#include "room.hpp"
#include "tree_library.hpp"

namespace crowded_room {
namespace {

using spheretree::Vec3;

struct Rumble {
  Uint16 low = 0;
  Uint16 high = 0;
};

/// In the order of attaching; SDL's callback adds to it.
int noteRumble(void* user, Uint16 low, Uint16 high) {
  static_cast<std::vector<Rumble>*>(user)->push_back({low, high});
  return 0;
}

enum class Motors : std::uint8_t { None, Rumble };

/// A plain joystick of two axes.
class PretendedJoystick {
 public:
  explicit PretendedJoystick(Motors motors) {
    SDL_VirtualJoystickDesc desc{};
    desc.version = SDL_VIRTUAL_JOYSTICK_DESC_VERSION;
    desc.type = SDL_JOYSTICK_TYPE_FLIGHT_STICK;
    desc.naxes = 2;
    desc.nbuttons = 2;
    desc.name = "pretended stick";
    desc.userdata = &rumbles_;
    desc.Rumble = motors == Motors::Rumble ? noteRumble : nullptr;
    const int index = SDL_JoystickAttachVirtualEx(&desc);
    if (index >= 0) joystick_ = SDL_JoystickOpen(index);
  }
  ~PretendedJoystick() { pull(); }
  PretendedJoystick(const PretendedJoystick&) = delete;
  PretendedJoystick& operator=(const PretendedJoystick&) = delete;

  [[nodiscard]] bool attached() const { return joystick_ != nullptr; }
  void tilt(float x, float y) {
    SDL_JoystickSetVirtualAxis(joystick_, 0, static_cast<Sint16>(x * 32767));
    SDL_JoystickSetVirtualAxis(joystick_, 1, static_cast<Sint16>(y * 32767));
  }
  void pull() {
    if (joystick_ == nullptr) return;
    const SDL_JoystickID id = SDL_JoystickInstanceID(joystick_);
    for (int index = 0; index < SDL_NumJoysticks(); ++index) {  // which shifts when others are pulled
      if (SDL_JoystickGetDeviceInstanceID(index) == id) SDL_JoystickDetachVirtual(index);
    }
    SDL_JoystickClose(joystick_);
    joystick_ = nullptr;
  }
  [[nodiscard]] const std::vector<Rumble>& rumbles() const { return rumbles_; }

 private:
  SDL_Joystick* joystick_ = nullptr;
  std::vector<Rumble> rumbles_;
};

class Joystick : public ::testing::Test {
 protected:
  Joystick() : library_(TreeLibrary::builtIn()) {}

  void SetUp() override {
    RoomSettings settings;
    settings.objects = 0;
    open(settings);
    camera_.setAngles(0, 0.3F);  // the stick's axes are the room's
  }

  void open(const RoomSettings& settings) {
    auto room = Room::create(settings, library_);
    ASSERT_TRUE(room.ok()) << room.error().message;
    room_.emplace(std::move(*room));
  }

  /// What the loop of the window does, without a window.
  void play(int steps) {
    for (int k = 0; k < steps; ++k) {
      SDL_Event event;
      while (SDL_PollEvent(&event) != 0) pilot_.handle(event);
      const auto stepped = room_->tick(pilot_.input(camera_));
      ASSERT_TRUE(stepped.ok());
      pilot_.feel(*room_, camera_);
    }
  }

  [[nodiscard]] Vec3 avatar() const { return room_->place(0); }

  TreeLibrary library_;
  std::optional<Room> room_;
  Camera camera_;
  Pilot pilot_;
};

TEST_F(Joystick, FliesTheAvatar) {
  PretendedJoystick stick(Motors::None);
  ASSERT_TRUE(stick.attached()) << SDL_GetError();
  const Vec3 start = avatar();
  stick.tilt(1, 0);
  play(30);
  EXPECT_GT(avatar().x, start.x + 4) << "half a second to the right";
  EXPECT_NEAR(avatar().z, start.z, 1e-3F);
  const Vec3 turned = avatar();
  stick.tilt(0, -1);
  play(30);
  EXPECT_LT(avatar().z, turned.z - 4) << "forward is away from the user";
  EXPECT_GT(room_->consumed().input.sequence, 0U);
  EXPECT_GT(pilot_.latency().toSimulation, 0);
}

TEST_F(Joystick, RestsWhenItsNoiseIsSmall) {
  PretendedJoystick stick(Motors::None);
  const Vec3 start = avatar();
  stick.tilt(0.1F, -0.08F);
  play(60);
  EXPECT_EQ(avatar(), start);
}

TEST_F(Joystick, KicksWhenTheAvatarFliesIntoTheCrowd) {
  RoomSettings crowd;
  crowd.objects = 6000;
  crowd.size = {60, 20, 60};
  open(crowd);
  PretendedJoystick stick(Motors::Rumble);
  stick.tilt(0.8F, -0.5F);
  play(200);
  EXPECT_GT(pilot_.touch().hits(), 3U);
  ASSERT_FALSE(stick.rumbles().empty()) << "the joystick must feel them";
  EXPECT_EQ(pilot_.gamepad().force().kind(), ForceKind::Rumble);
  for (const Rumble& rumble : stick.rumbles()) {
    if (rumble.low == 0 && rumble.high == 0) continue;  // the end of a kick
    EXPECT_GT(rumble.low, 0.2 * 65535);
    EXPECT_LT(rumble.high, rumble.low);
  }
}

TEST_F(Joystick, IsStillWhenNothingIsHit) {
  PretendedJoystick stick(Motors::Rumble);
  stick.tilt(1, 1);
  play(120);
  EXPECT_EQ(pilot_.touch().hits(), 0U);
  EXPECT_TRUE(stick.rumbles().empty());
}

TEST_F(Joystick, CanBePulledAndPluggedInAgain) {
  play(1);
  EXPECT_NE(pilot_.gamepad().status().find("no joystick"), std::string::npos);
  {
    PretendedJoystick stick(Motors::None);
    stick.tilt(1, 0);
    play(10);
    EXPECT_TRUE(pilot_.gamepad().present());
    EXPECT_NE(pilot_.gamepad().status().find("pretended stick, no force feedback"), std::string::npos)
        << pilot_.gamepad().status();
    EXPECT_TRUE(pilot_.news().has_value());
    EXPECT_FALSE(pilot_.news().has_value()) << "it is said once";
    stick.pull();
    play(2);
  }
  EXPECT_FALSE(pilot_.gamepad().present());
  EXPECT_NE(pilot_.gamepad().status().find("was pulled"), std::string::npos) << pilot_.gamepad().status();
  const Vec3 left = avatar();
  play(30);
  EXPECT_EQ(avatar(), left) << "a stick that is gone tilts nothing";
  PretendedJoystick other(Motors::None);
  other.tilt(-1, 0);
  play(10);
  EXPECT_TRUE(pilot_.gamepad().present());
  EXPECT_LT(avatar().x, left.x);
}

TEST_F(Joystick, TheSecondOneTakesOver) {
  PretendedJoystick first(Motors::None);
  PretendedJoystick second(Motors::None);
  first.tilt(1, 0);
  second.tilt(-1, 0);
  play(10);
  const float right = avatar().x;
  EXPECT_GT(right, 0.5F * room_->settings().size.x);
  first.pull();
  play(10);
  EXPECT_LT(avatar().x, right);
}

TEST_F(Joystick, TheKeyboardNeedsNone) {
  const Vec3 start = avatar();
  SDL_Event key{};
  key.type = SDL_KEYDOWN;
  key.key.keysym.scancode = SDL_SCANCODE_W;
  pilot_.handle(key);
  play(30);
  EXPECT_LT(avatar().z, start.z - 4);
  pilot_.releaseKeys();
  const Vec3 stopped = avatar();
  play(10);
  EXPECT_EQ(avatar(), stopped);
  EXPECT_EQ(pilot_.stick().hand(), Hand::Keyboard);
}

TEST_F(Joystick, TheMouseNeedsNone) {
  const Vec3 start = avatar();
  pilot_.drag({-1, 0, 0});
  play(30);
  EXPECT_LT(avatar().x, start.x - 4);
}

}  // namespace
}  // namespace crowded_room
