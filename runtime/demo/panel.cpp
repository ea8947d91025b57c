// SPDX-License-Identifier: MIT
#include "panel.hpp"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <string_view>
#include <vector>

#include "headless.hpp"

namespace crowded_room {

using spheretree::BroadPhaseKind;
using spheretree::Done;
using spheretree::NarrowPhase;
using spheretree::Result;

/// What the user may change.
struct Panel::Wishes {
  RoomSettings room;
  StageSettings stage;
  Viewpoint view = Viewpoint::Avatar;
  Flow flow = Flow::Running;
  bool step = false;
};

namespace {

constexpr float kWidth = 330;
constexpr float kMargin = 12;
constexpr float kPlotHeight = 84;
constexpr int kMostObjects = 20000;
constexpr float kItemShare = 0.56F;  // of the width, for the controls; the rest is for their names

struct Phase {
  const char* name;
  float FrameTimes::*time;
  ImU32 color;
};
constexpr std::array<Phase, 4> kPhases{{{"update", &FrameTimes::update, IM_COL32(94, 160, 235, 255)},
                                        {"broad", &FrameTimes::broad, IM_COL32(64, 200, 180, 255)},
                                        {"narrow", &FrameTimes::narrow, IM_COL32(245, 190, 70, 255)},
                                        {"render", &FrameTimes::render, IM_COL32(140, 148, 160, 255)}}};

template <class T, std::size_t N>
void combo(const char* label, T& value, const std::array<const char*, N>& names) {
  int chosen = static_cast<int>(value);
  if (ImGui::Combo(label, &chosen, names.data(), static_cast<int>(N))) value = static_cast<T>(chosen);
}

void comboOfTrees(const char* label, std::string& value, TreeUse use, const Room& room) {
  const UnitTree& worn = room.treeOf(use == TreeUse::Box ? ObjectKind::Box : ObjectKind::Bunny);
  if (!ImGui::BeginCombo(label, worn.name.c_str())) return;
  for (const UnitTree& tree : room.library().trees()) {
    if (ImGui::Selectable(tree.name.c_str(), tree.name == worn.name)) value = tree.name;
  }
  ImGui::EndCombo();
}

void editLevels(const char* label, std::uint32_t& value, const Room& room) {
  const auto deepest = static_cast<int>(std::max(room.treeOf(ObjectKind::Bunny).tree.levelCount(),
                                                 room.treeOf(ObjectKind::Box).tree.levelCount()));
  int levels = static_cast<int>(value);
  if (ImGui::SliderInt(label, &levels, 1, std::max(deepest, 2)))
    value = static_cast<std::uint32_t>(std::max(levels, 1));
}

void editCrowd(RoomSettings& room) {
  int objects = static_cast<int>(room.objects);
  ImGui::SliderInt("objects", &objects, 0, kMostObjects, "%d", ImGuiSliderFlags_Logarithmic);
  room.objects = static_cast<std::uint32_t>(std::clamp(objects, 0, kMostObjects));
  float percent = 100 * room.bunnyShare;
  if (ImGui::SliderFloat("bunnies", &percent, 0, 100, "%.0f %%"))
    room.bunnyShare = std::clamp(percent / 100, 0.0F, 1.0F);
  combo("movement", room.movement, std::array{"in the plane XZ", "in space XYZ"});
  ImGui::SliderFloat("speed", &room.speed, 0.5F, 20, "up to %.1f /s");
}

void editCollision(RoomSettings& settings, const Room& room) {
  std::array<const char*, spheretree::kBroadPhaseKinds.size()> names{};
  std::transform(spheretree::kBroadPhaseKinds.begin(), spheretree::kBroadPhaseKinds.end(), names.begin(),
                 [](BroadPhaseKind kind) { return spheretree::nameOf(kind).data(); });
  combo("broad phase", settings.broadPhase, names);
  combo("narrow phase", settings.narrow, std::array{"none: boxes", "sphere trees"});
  comboOfTrees("bunny tree", settings.bunnyTree, TreeUse::Bunny, room);
  comboOfTrees("box tree", settings.boxTree, TreeUse::Box, room);
  editLevels("levels", settings.levels, room);
}

void editView(StageSettings& stage, Viewpoint& view, const Room& room) {
  combo("objects as", stage.look, std::array{"meshes", "balls of their trees"});
  if (stage.look == Look::Balls) {
    editLevels("levels drawn", stage.levels, room);
    combo("colour by", stage.paint, std::array{"object", "level", "overhang"});
  }
  combo("view", view, std::array{"behind the avatar", "whole room"});
  bool shadows = stage.shadows == Shadows::On;
  if (ImGui::Checkbox("shadows", &shadows)) stage.shadows = shadows ? Shadows::On : Shadows::Off;
}

/// Microseconds at the upper edge of the plot. Collision alone sets it, for rendering would make it a line,
/// and of that not the few frames in which the system did something else.
float topOfPlot(const History& history) {
  constexpr float kUsual = 0.95F;
  constexpr float kAir = 1.6F;
  std::vector<float> times{1};
  for (std::size_t k = 0; k < history.size(); ++k) times.push_back(history[k].collision());
  const auto usual =
      times.begin() + static_cast<std::ptrdiff_t>(kUsual * static_cast<float>(times.size() - 1));
  std::nth_element(times.begin(), usual, times.end());
  return kAir * *usual;
}

/// Time per phase of the last frames, stacked.
void plot(const History& history) {
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const ImVec2 size{ImGui::GetContentRegionAvail().x, kPlotHeight};
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled(corner, {corner.x + size.x, corner.y + size.y}, IM_COL32(16, 20, 26, 255), 4);
  const float top = topOfPlot(history);
  const float perPixel = top / size.y;
  const float bar = size.x / static_cast<float>(History::kFrames);
  for (std::size_t k = 0; k < history.size(); ++k) {
    const float left = corner.x + bar * static_cast<float>(k);
    float foot = corner.y + size.y;
    for (const Phase& phase : kPhases) {
      if (phase.time == &FrameTimes::render) continue;
      const float height = std::min(history[k].*phase.time / perPixel, foot - corner.y);
      list->AddRectFilled({left, foot - height}, {left + bar, foot}, phase.color);
      foot -= height;
    }
  }
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%.0f us", static_cast<double>(top));
  list->AddText({corner.x + 6, corner.y + 4}, IM_COL32(200, 206, 214, 255), text.data());
  ImGui::Dummy(size);
}

void showTimes(const History& history) {
  const FrameTimes mean = history.mean();
  plot(history);
  if (!ImGui::BeginTable("phases", static_cast<int>(kPhases.size()))) return;
  for (const Phase& phase : kPhases) {
    ImGui::TableNextColumn();
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(phase.color), "%s", phase.name);
    const auto time = static_cast<double>(mean.*phase.time);
    constexpr double kMillisecond = 1000;
    if (time < kMillisecond) {
      ImGui::Text("%.0f us", time);
    } else {
      ImGui::Text("%.1f ms", time / kMillisecond);
    }
  }
  ImGui::EndTable();
}

/// A frame rate and the paper's word for it.
void showRate(const char* label, double microseconds) {
  if (microseconds <= 0) return;
  const double fps = 1e6 / microseconds;
  const std::string_view band = satisfactionAt(fps);
  struct Tint {
    std::string_view band;
    ImVec4 color;
  };
  const std::array<Tint, 4> tints{{{"high", {0.40F, 0.85F, 0.50F, 1}},
                                   {"very good", {0.65F, 0.85F, 0.40F, 1}},
                                   {"good", {0.95F, 0.80F, 0.30F, 1}},
                                   {"low", {0.95F, 0.40F, 0.30F, 1}}}};
  const auto tint =
      std::find_if(tints.begin(), tints.end(), [&](const Tint& each) { return each.band == band; });
  ImGui::Text("%s %.*f fps,", label, fps < 10 ? 1 : 0, fps);
  ImGui::SameLine();
  ImGui::TextColored(tint != tints.end() ? tint->color : ImVec4{1, 1, 1, 1}, "%.*s",
                     static_cast<int>(band.size()), band.data());
}

void showResults(const Room& room, const History& history) {
  const FrameTimes mean = history.mean();
  ImGui::Text("%llu pairs, %llu contacts", static_cast<unsigned long long>(room.report().pairs),
              static_cast<unsigned long long>(room.report().contacts));
  showRate("collision:", static_cast<double>(mean.collision()));
  if (mean.render > 0) showRate("with rendering:", static_cast<double>(mean.collision() + mean.render));
  ImGui::TextDisabled("satisfaction: the paper's Table 1");
}

bool differs(const RoomSettings& a, const RoomSettings& b) {
  return a.objects != b.objects || a.bunnyShare != b.bunnyShare || a.movement != b.movement ||
         a.speed != b.speed || a.broadPhase != b.broadPhase || a.narrow != b.narrow ||
         a.bunnyTree != b.bunnyTree || a.boxTree != b.boxTree || a.levels != b.levels;
}

}  // namespace

void Panel::drawAll(Wishes& wishes, const Room& room, const History& history, const std::string& devices) {
  ImGui::SetNextWindowPos({kMargin, kMargin}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSize({kWidth, 0}, ImGuiCond_FirstUseEver);
  ImGui::Begin("The crowded room", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
  ImGui::PushItemWidth(kItemShare * kWidth);
  editCrowd(wishes.room);
  ImGui::Separator();
  editCollision(wishes.room, room);
  ImGui::Separator();
  editView(wishes.stage, wishes.view, room);
  if (ImGui::Button(wishes.flow == Flow::Running ? "pause" : "go on", {0.3F * kWidth, 0}))
    wishes.flow = wishes.flow == Flow::Running ? Flow::Paused : Flow::Running;
  ImGui::SameLine();
  wishes.step = ImGui::Button("one step", {0.3F * kWidth, 0});
  ImGui::Separator();
  showTimes(history);
  showResults(room, history);
  ImGui::Separator();
  ImGui::PushTextWrapPos(kWidth);
  ImGui::TextUnformatted(devices.c_str());
  if (!refused_.empty()) ImGui::TextColored({1, 0.5F, 0.4F, 1}, "%s", refused_.c_str());
  ImGui::PopTextWrapPos();
  ImGui::PopItemWidth();
  ImGui::End();
}

void Panel::draw(Room& room, StageSettings& stage, Viewpoint& view, const History& history,
                 const std::string& devices) {
  Wishes wishes{room.settings(), stage, view, room.flow()};
  drawAll(wishes, room, history, devices);
  stage = wishes.stage;
  view = wishes.view;
  room.setFlow(wishes.flow);
  if (wishes.step) {
    room.setFlow(Flow::Paused);
    room.askForStep();
  }
  if (!differs(wishes.room, room.settings())) return;
  const std::uint32_t levels = room.settings().levels;
  const Result<Done> changed = room.change(wishes.room);
  refused_ = changed ? std::string{} : changed.error().message;
  if (changed && levels != wishes.room.levels) stage.levels = wishes.room.levels;
}

void Panel::draw(const Room& room, const StageSettings& stage, Viewpoint view, const History& history,
                 const std::string& devices) {
  Wishes wishes{room.settings(), stage, view, room.flow()};
  drawAll(wishes, room, history, devices);
}

}  // namespace crowded_room
