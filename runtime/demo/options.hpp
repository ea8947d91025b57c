// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include <spheretree/result.hpp>

#include "canvas.hpp"
#include "image.hpp"
#include "room.hpp"
#include "stage.hpp"

namespace crowded_room {

/// What stands before the eye at the start.
enum class Viewpoint : std::uint8_t {
  Avatar,  ///< behind the avatar, which is followed
  Room     ///< the whole room, from outside
};

enum class Mode : std::uint8_t { Window, Headless, Help, Version };

/// Everything that the command line can say; the members' values are the defaults.
struct Options {
  Mode mode = Mode::Window;
  RoomSettings room;
  std::filesystem::path trees;  ///< empty: looked for, see treeFolders()
  StageSettings stage;
  Viewpoint view = Viewpoint::Avatar;
  PixelSize size{1280, 800};
  Canvas::Fineness fineness = Canvas::Fineness::Two;

  std::optional<std::uint32_t> frames;  ///< after which a run ends; a window's otherwise never
  /// Of a run without a window that was not told.
  static constexpr std::uint32_t kHeadlessFrames = 500;
  std::filesystem::path report;
  bool render = false;  ///< draw every frame off-screen and measure it
  std::filesystem::path screenshot;
  std::filesystem::path record;  ///< folder for numbered pictures
  std::uint32_t every = 1;       ///< steps from picture to picture
  bool panel = false;            ///< in pictures, too
  bool tour = false;             ///< the avatar flies by itself; without a window
};

/// Reads the words after the program's name. Fails with InvalidArgument and one sentence. `--screenshot`,
/// `--record`, `--render` and `--report` imply a run without a window.
spheretree::Result<Options> parseOptions(std::span<const char* const> words);

/// What `--help` prints.
[[nodiscard]] std::string helpText();

}  // namespace crowded_room
