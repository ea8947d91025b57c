// SPDX-License-Identifier: MIT
#include "stick_view.hpp"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace crowded_room {

using spheretree::Vec3;

namespace {

constexpr float kRadius = 62;  // pixels, of the stick's range
constexpr float kMargin = 12;
constexpr float kWidth = 236;
constexpr float kBarWidth = 12;
constexpr ImU32 kRim = IM_COL32(120, 130, 145, 255);
constexpr ImU32 kQuiet = IM_COL32(120, 130, 145, 110);
constexpr ImU32 kHeld = IM_COL32(220, 226, 234, 255);
constexpr ImU32 kConsumed = IM_COL32(236, 28, 140, 255);
constexpr ImU32 kKickColor = IM_COL32(255, 120, 30, 255);

struct Dial {
  ImDrawList* list;
  ImVec2 middle;

  [[nodiscard]] ImVec2 at(Vec3 tilt) const {
    return {middle.x + kRadius * tilt.x, middle.y + kRadius * tilt.z};
  }
};

void drawPlane(const Dial& dial, Vec3 raw, Vec3 consumed) {
  dial.list->AddCircleFilled(dial.middle, kRadius, IM_COL32(16, 20, 26, 255), 64);
  dial.list->AddCircle(dial.middle, kRadius, kRim, 64, 1.5F);
  dial.list->AddCircle(dial.middle, kRadius * Stick::kDeadZone, kQuiet, 32);
  dial.list->AddLine({dial.middle.x - kRadius, dial.middle.y}, {dial.middle.x + kRadius, dial.middle.y},
                     kQuiet);
  dial.list->AddLine({dial.middle.x, dial.middle.y - kRadius}, {dial.middle.x, dial.middle.y + kRadius},
                     kQuiet);
  dial.list->AddLine(dial.middle, dial.at(consumed), kConsumed, 3);
  dial.list->AddCircleFilled(dial.at(consumed), 8, kConsumed, 24);
  dial.list->AddCircle(dial.at(raw), 11, kHeld, 24, 1.5F);
}

void drawHeight(const Dial& dial, float consumed) {
  const float left = dial.middle.x + kRadius + 18;
  const float half = kRadius - 4;
  dial.list->AddRectFilled({left, dial.middle.y - half}, {left + kBarWidth, dial.middle.y + half},
                           IM_COL32(16, 20, 26, 255), 4);
  const float end = dial.middle.y - half * consumed;
  dial.list->AddRectFilled({left, std::min(dial.middle.y, end)},
                           {left + kBarWidth, std::max(dial.middle.y, end)}, kConsumed, 3);
  dial.list->AddLine({left, dial.middle.y}, {left + kBarWidth, dial.middle.y}, kRim);
}

/// From the rim to the inside, where the avatar is pushed.
void drawKick(const Dial& dial, const Kick& kick) {
  constexpr float kFaintest = 0.03F;
  const float flat = std::hypot(kick.push.x, kick.push.z);
  if (kick.strength < kFaintest || flat <= 0) return;
  const ImVec2 along{kick.push.x / flat, kick.push.z / flat};
  const ImVec2 from{dial.middle.x - kRadius * along.x, dial.middle.y - kRadius * along.y};
  const float reach = kRadius * (0.3F + kick.strength);
  const ImVec2 tip{from.x + reach * along.x, from.y + reach * along.y};
  const ImVec2 neck{tip.x - 14 * along.x, tip.y - 14 * along.y};
  const auto alpha = static_cast<ImU32>(std::clamp(120 + 400 * kick.strength, 0.0F, 255.0F));
  const ImU32 color = (kKickColor & ~IM_COL32_A_MASK) | (alpha << IM_COL32_A_SHIFT);
  dial.list->AddLine(from, neck, color, 5);
  dial.list->AddTriangleFilled(tip, {neck.x - 9 * along.y, neck.y + 9 * along.x},
                               {neck.x + 9 * along.y, neck.y - 9 * along.x}, color);
}

const char* nameOf(Hand hand) {
  constexpr std::array<const char*, 3> kNames{"keyboard", "mouse", "joystick"};
  return kNames[static_cast<std::size_t>(hand)];
}

}  // namespace

std::optional<Vec3> drawStick(const StickShown& shown, PixelSize size) {
  ImGui::SetNextWindowPos(
      {static_cast<float>(size.width) - kMargin, static_cast<float>(size.height) - kMargin}, ImGuiCond_Always,
      {1, 1});
  ImGui::SetNextWindowSize({kWidth, 0});
  ImGui::Begin("stick", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                   ImGuiWindowFlags_AlwaysAutoResize);
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const ImVec2 area{2 * kRadius + 18 + kBarWidth, 2 * kRadius + 4};
  const float indent = 0.5F * (ImGui::GetContentRegionAvail().x - area.x);
  const Dial dial{ImGui::GetWindowDrawList(), {corner.x + indent + kRadius, corner.y + kRadius + 2}};
  ImGui::SetCursorPosX(ImGui::GetCursorPosX() + indent);
  ImGui::InvisibleButton("hand", area);
  std::optional<Vec3> dragged;
  if (ImGui::IsItemActive()) {
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    dragged = Vec3{(mouse.x - dial.middle.x) / kRadius, 0, (mouse.y - dial.middle.y) / kRadius};
  }
  drawPlane(dial, shown.raw, shown.consumed);
  drawHeight(dial, shown.consumed.y);
  drawKick(dial, shown.kick);
  const bool resting = dot(shown.raw, shown.raw) == 0;
  ImGui::Text("%s", resting ? "at rest" : nameOf(shown.hand));
  ImGui::SameLine(0.5F * kWidth);
  ImGui::Text("hits %llu", static_cast<unsigned long long>(shown.hits));
  if (shown.latency.toFrame > 0) {
    ImGui::Text("input to simulation %.1f ms", static_cast<double>(shown.latency.toSimulation));
    ImGui::Text("input to frame      %.1f ms", static_cast<double>(shown.latency.toFrame));
  }
  ImGui::End();
  return dragged;
}

}  // namespace crowded_room
