// SPDX-License-Identifier: MIT
#include "overlay.hpp"

#include <imgui.h>
#include <backends/imgui_impl_opengl3.h>
#if __has_include(<backends/imgui_impl_sdl2.h>)
#include <backends/imgui_impl_sdl2.h>
#else
#include <backends/imgui_impl_sdl.h>  // its name before Dear ImGui 1.89.3
#endif

#include "gl.hpp"

namespace crowded_room {
namespace {

constexpr const char* kShaderVersion = "#version 330 core";
constexpr float kFrameSeconds = 1.0F / 60;

void dressUp() {
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 8;
  style.FrameRounding = 4;
  style.GrabRounding = 4;
  style.WindowBorderSize = 0;
  style.WindowPadding = {12, 10};
  style.Colors[ImGuiCol_WindowBg] = {0.09F, 0.11F, 0.14F, 0.86F};
  style.Colors[ImGuiCol_TitleBg] = {0.09F, 0.11F, 0.14F, 0.95F};
  style.Colors[ImGuiCol_TitleBgActive] = {0.14F, 0.18F, 0.24F, 0.95F};
}

}  // namespace

Overlay::Overlay(SDL_Window* window) : window_(window) {
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // nothing is written that nobody asked for
  dressUp();
  if (window_ != nullptr) ImGui_ImplSDL2_InitForOpenGL(window_, SDL_GL_GetCurrentContext());
  ImGui_ImplOpenGL3_Init(kShaderVersion);
}

Overlay::~Overlay() {
  ImGui_ImplOpenGL3_Shutdown();
  if (window_ != nullptr) ImGui_ImplSDL2_Shutdown();
  ImGui::DestroyContext();
}

bool Overlay::handle(const SDL_Event& event) {
  if (window_ != nullptr) ImGui_ImplSDL2_ProcessEvent(&event);
  const ImGuiIO& io = ImGui::GetIO();
  switch (event.type) {
    case SDL_MOUSEBUTTONDOWN:
    case SDL_MOUSEWHEEL:
      return io.WantCaptureMouse;
    case SDL_KEYDOWN:
      return io.WantTextInput;
    default:
      return false;
  }
}

void Overlay::begin(PixelSize size) {
  ImGui_ImplOpenGL3_NewFrame();
  if (window_ != nullptr) {
    ImGui_ImplSDL2_NewFrame();
  } else {
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = {static_cast<float>(size.width), static_cast<float>(size.height)};
    io.DeltaTime = kFrameSeconds;
  }
  ImGui::NewFrame();
}

void Overlay::end() {
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

}  // namespace crowded_room
