// SPDX-License-Identifier: MIT
//
// One table row per option: name, what it takes, what it is for, what it does. The help is printed from the
// same table. Numbers are read by from_chars to the last character; ranges of the room's settings are the
// room's to check.
#include "options.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <concepts>
#include <string_view>
#include <system_error>
#include <utility>

namespace crowded_room {

using spheretree::Error;
using spheretree::ErrorCode;
using spheretree::Result;

namespace {

/// Takes the word after an option. Empty, or what the word should have been.
using Take = std::string (*)(Options&, std::string_view);

struct Row {
  std::string_view name;
  std::string_view argument;  // empty: none
  std::string_view help;
  Take take;
};

template <class T>
std::string takeNumber(T& target, std::string_view word, const char* what) {
  T value{};
  const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (problem != std::errc{} || end != word.data() + word.size()) return what;
  target = value;
  return {};
}

template <std::unsigned_integral T>
std::string takeCount(T& target, std::string_view word) {
  return takeNumber(target, word, "a whole number from 0");
}

/// A number between two others, in words `what`.
std::string takeReal(float& target, std::string_view word, std::pair<float, float> range, const char* what) {
  float value = 0;
  const bool isNumber = takeNumber(value, word, what).empty();
  if (!isNumber || !(value >= range.first && value <= range.second)) return what;
  target = value;
  return {};
}

std::string takeFromOne(std::uint32_t& target, std::string_view word) {
  std::uint32_t value = 0;
  if (!takeCount(value, word).empty() || value == 0) return "a whole number from 1";
  target = value;
  return {};
}

std::string takePath(std::filesystem::path& target, std::string_view word) {
  if (word.empty()) return "a name";
  target = word;
  return {};
}

template <class T>
struct Named {
  std::string_view name;
  T value;
};

template <class T, std::size_t N>
std::string takeNamed(T& target, std::string_view word, const std::array<Named<T>, N>& names) {
  std::string choices;
  for (const auto& [name, value] : names) {
    if (name == word) {
      target = value;
      return {};
    }
    choices += (choices.empty() ? "" : ", ") + std::string(name);
  }
  return "one of " + choices;
}

std::string takeBroadPhase(Options& options, std::string_view word) {
  const auto kind = spheretree::broadPhaseNamed(word);
  if (kind) {
    options.room.broadPhase = *kind;
    return {};
  }
  std::string choices;
  for (const auto each : spheretree::kBroadPhaseKinds)
    choices += (choices.empty() ? "" : ", ") + std::string(spheretree::nameOf(each));
  return "one of " + choices;
}

std::string takeSize(Options& options, std::string_view word) {
  constexpr int kLargest = 16384;
  const std::size_t cross = word.find('x');
  PixelSize size;
  if (cross == std::string_view::npos || !takeNumber(size.width, word.substr(0, cross), "-").empty() ||
      !takeNumber(size.height, word.substr(cross + 1), "-").empty() || size.width < 1 || size.height < 1 ||
      size.width > kLargest || size.height > kLargest)
    return "WIDTHxHEIGHT in pixels, for example 1280x800";
  options.size = size;
  return {};
}

constexpr std::array<Named<Movement>, 2> kMovements{{{"xz", Movement::PlaneXZ}, {"xyz", Movement::SpaceXYZ}}};
constexpr std::array<Named<spheretree::NarrowPhase>, 2> kNarrow{
    {{"shapes", spheretree::NarrowPhase::Shapes}, {"boxes", spheretree::NarrowPhase::Boxes}}};
constexpr std::array<Named<BoxShape>, 2> kBoxShapes{{{"tree", BoxShape::Tree}, {"exact", BoxShape::Exact}}};
constexpr std::array<Named<Look>, 2> kLooks{{{"mesh", Look::Mesh}, {"balls", Look::Balls}}};
constexpr std::array<Named<BallPaint>, 3> kPaints{
    {{"object", BallPaint::Object}, {"level", BallPaint::Level}, {"overhang", BallPaint::Overhang}}};
constexpr std::array<Named<Shadows>, 2> kShadows{{{"on", Shadows::On}, {"off", Shadows::Off}}};
constexpr std::array<Named<Viewpoint>, 2> kViews{{{"avatar", Viewpoint::Avatar}, {"room", Viewpoint::Room}}};
constexpr std::array<Named<Canvas::Fineness>, 3> kFineness{
    {{"1", Canvas::Fineness::One}, {"2", Canvas::Fineness::Two}, {"4", Canvas::Fineness::Four}}};

using Word = std::string_view;

// A lambda a row; each converts to Take.
constexpr std::array<Row, 31> kRows{{
    {"--objects", "N", "objects in the room [1000]",
     [](Options& o, Word w) { return takeCount(o.room.objects, w); }},
    {"--mix", "SHARE", "share of bunnies, the others are boxes, 0 to 1 [0.5]",
     [](Options& o, Word w) {
       return takeReal(o.room.bunnyShare, w, {0.0F, 1.0F}, "a share from 0 to 1");
     }},
    {"--movement", "xz|xyz", "in the plane or in space [xyz]",
     [](Options& o, Word w) { return takeNamed(o.room.movement, w, kMovements); }},
    {"--speed", "V", "largest speed along an axis, units per second [5]",
     [](Options& o, Word w) {
       return takeReal(o.room.speed, w, {0.001F, 60.0F}, "a number above 0, at most 60");
     }},
    {"--seed", "N", "of places and directions [1]",
     [](Options& o, Word w) { return takeCount(o.room.seed, w); }},
    {"--broad", "NAME", "brute_force, grid, octree, sweep_and_prune, grid_sweep or sweep [sweep]",
     takeBroadPhase},
    {"--narrow", "shapes|boxes", "sphere trees, or the broad phase alone [shapes]",
     [](Options& o, Word w) { return takeNamed(o.room.narrow, w, kNarrow); }},
    {"--levels", "N", "of the sphere trees that collide and are drawn; the root counts [3]",
     [](Options& o, Word w) {
       std::string wrong = takeFromOne(o.room.levels, w);
       o.stage.levels = o.room.levels;
       return wrong;
     }},
    {"--box-shape", "tree|exact", "what a box is to the narrow phase [tree]",
     [](Options& o, Word w) { return takeNamed(o.room.boxShape, w, kBoxShapes); }},
    {"--trees", "DIR", "folder of .sph files, with the .obj files that they were made of",
     [](Options& o, Word w) { return takePath(o.trees, w); }},
    {"--bunny-tree", "NAME", "tree of the bunnies, a file's name without .sph",
     [](Options& o, Word w) {
       o.room.bunnyTree = w;
       return std::string{};
     }},
    {"--box-tree", "NAME", "tree of the boxes",
     [](Options& o, Word w) {
       o.room.boxTree = w;
       return std::string{};
     }},
    {"--threads", "N", "of the narrow phase [1]",
     [](Options& o, Word w) { return takeFromOne(o.room.threads, w); }},
    {"--look", "mesh|balls", "how objects are drawn [mesh]",
     [](Options& o, Word w) { return takeNamed(o.stage.look, w, kLooks); }},
    {"--paint", "object|level|overhang", "what colours the balls [level]",
     [](Options& o, Word w) { return takeNamed(o.stage.paint, w, kPaints); }},
    {"--shadows", "on|off", "[on]",
     [](Options& o, Word w) { return takeNamed(o.stage.shadows, w, kShadows); }},
    {"--view", "avatar|room", "from behind the avatar, or the whole room [avatar]",
     [](Options& o, Word w) { return takeNamed(o.view, w, kViews); }},
    {"--size", "WxH", "of the window or the picture [1280x800]", takeSize},
    {"--headless", "", "run without a window",
     [](Options& o, Word) {
       o.mode = Mode::Headless;
       return std::string{};
     }},
    {"--frames", "N", "steps after which the run ends [500 without a window]",
     [](Options& o, Word w) { return takeFromOne(o.frames.emplace(), w); }},
    {"--report", "FILE", "write what the run measured, as JSON; implies --headless",
     [](Options& o, Word w) {
       o.mode = Mode::Headless;
       return takePath(o.report, w);
     }},
    {"--render", "", "draw every frame off-screen and measure that, too; implies --headless",
     [](Options& o, Word) {
       o.mode = Mode::Headless;
       o.render = true;
       return std::string{};
     }},
    {"--screenshot", "FILE", "write the last frame as PNG; implies --headless",
     [](Options& o, Word w) {
       o.mode = Mode::Headless;
       return takePath(o.screenshot, w);
     }},
    {"--record", "DIR", "write frames as DIR/00000.png and so on; implies --headless",
     [](Options& o, Word w) {
       o.mode = Mode::Headless;
       return takePath(o.record, w);
     }},
    {"--every", "K", "with --record: every K-th step [1]",
     [](Options& o, Word w) { return takeFromOne(o.every, w); }},
    {"--smooth", "1|2|4", "samples along the side of a pixel of a picture [2]",
     [](Options& o, Word w) { return takeNamed(o.fineness, w, kFineness); }},
    {"--panel", "", "show the panel and the stick in pictures, too",
     [](Options& o, Word) {
       o.panel = true;
       return std::string{};
     }},
    {"--tour", "", "let the avatar fly by itself in a run without a window",
     [](Options& o, Word) {
       o.tour = true;
       return std::string{};
     }},
    {"--version", "", "print the version",
     [](Options& o, Word) {
       o.mode = Mode::Version;
       return std::string{};
     }},
    {"--help", "", "print this",
     [](Options& o, Word) {
       o.mode = Mode::Help;
       return std::string{};
     }},
    {"-h", "", "the same",
     [](Options& o, Word) {
       o.mode = Mode::Help;
       return std::string{};
     }},
}};

Error mistake(std::string sentence) {
  return {ErrorCode::InvalidArgument, std::move(sentence)};
}

const Row* rowNamed(std::string_view name) {
  for (const Row& row : kRows) {
    if (row.name == name) return &row;
  }
  return nullptr;
}

}  // namespace

Result<Options> parseOptions(std::span<const char* const> words) {
  Options options;
  for (std::size_t k = 0; k < words.size(); ++k) {
    std::string_view name = words[k];
    const std::size_t equals = name.starts_with("--") ? name.find('=') : std::string_view::npos;
    std::string_view value;
    if (equals != std::string_view::npos) {
      value = name.substr(equals + 1);
      name = name.substr(0, equals);
    }
    const Row* row = rowNamed(name);
    if (row == nullptr) return mistake(std::string(name) + " is no option; --help lists them");
    if (row->argument.empty() && equals != std::string_view::npos)
      return mistake(std::string(name) + " takes no value");
    if (!row->argument.empty() && equals == std::string_view::npos) {
      if (++k == words.size())
        return mistake(std::string(name) + " lacks its value, " + std::string(row->argument));
      value = words[k];
    }
    const std::string wanted = row->take(options, value);
    if (!wanted.empty())
      return mistake(std::string(name) + " is '" + std::string(value) + "', but must be " + wanted);
    if (options.mode == Mode::Help || options.mode == Mode::Version) return options;
  }
  return options;
}

std::string helpText() {
  std::string text =
      "Usage: crowded_room [OPTION...]\n\n"
      "The crowded room: boxes and bunnies that collide by their sphere trees, and an avatar that you fly "
      "with a\n"
      "joystick, the keyboard or the mouse.\n\n";
  constexpr std::size_t kColumn = 30;
  for (const Row& row : kRows) {
    std::string line = "  " + std::string(row.name);
    if (!row.argument.empty()) line += " " + std::string(row.argument);
    line.resize(std::max(kColumn, line.size() + 1), ' ');
    text += line + std::string(row.help) + "\n";
  }
  text +=
      "\nIn the window: W A S D and the arrow keys or the left mouse button on the drawn stick fly, Q and E "
      "sink and\n"
      "rise, the right mouse button turns the view, the wheel zooms, space pauses, N makes one step, M "
      "switches\n"
      "between meshes and balls, 1 to 9 choose the level, C the view, H hides the panel, Esc ends.\n\n"
      "Exit codes: 0 done, 1 our fault, 2 usage, 3 input cannot be read, 6 output cannot be written.\n";
  return text;
}

}  // namespace crowded_room
