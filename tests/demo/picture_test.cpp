// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the program draws, by the colours in its pictures; and what it reports about drawing.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <spheretree/sph.hpp>

#include "offscreen.hpp"
#include "png.hpp"
#include "room.hpp"
#include "tests/cli/program.hpp"

namespace crowded_room {
namespace {

using spheretree::tests::Finished;

/// A box of edge 1 as an octree of that many levels.
std::string octreeSph(int levels) {
  std::vector<spheretree::SphereTree::Entry> entries{{{{0, 0, 0}, std::sqrt(0.75F)}, spheretree::kNoParent}};
  std::size_t first = 0;
  float half = 0.5F;
  for (int level = 1; level < levels; ++level) {
    const std::size_t end = entries.size();
    half /= 2;
    for (std::size_t parent = first; parent < end; ++parent) {
      for (int k = 0; k < 8; ++k) {
        const spheretree::Vec3 at{(k & 1) != 0 ? half : -half, (k & 2) != 0 ? half : -half,
                                  (k & 4) != 0 ? half : -half};
        entries.push_back({{entries[parent].ball.center + at, entries[parent].ball.radius / 2},
                           static_cast<std::uint32_t>(parent)});
      }
    }
    first = end;
  }
  return spheretree::formatSph(*spheretree::SphereTree::create(entries), 8).value();
}

class Pictures : public spheretree::tests::ProgramTest {
 protected:
  void SetUp() override {
    const auto context = Offscreen::create();
    if (!context) GTEST_SKIP() << context.error().message;
    std::filesystem::create_directory(folder_ / "trees");
    write("trees/bunny.sph", octreeSph(3));
    write("trees/bunny.obj", spheretree::tests::boxObj());
  }

  Finished run(std::vector<std::string> words) {
    words.insert(words.end(), {"--trees", "trees", "--size", "320x200", "--smooth", "1"});
    return ProgramTest::run(words);
  }

  /// The last frame of a run with those options.
  Image shot(std::vector<std::string> words) {
    words.insert(words.end(), {"--screenshot", "shot.png"});
    const Finished finished = run(words);
    EXPECT_EQ(finished.exitCode, 0) << finished.err;
    const auto image = readPng(folder_ / "shot.png");
    EXPECT_TRUE(image.ok()) << image.error().message;
    if (!image) return {{1, 1}, {0, 0, 0}};
    EXPECT_EQ(image->size, (PixelSize{320, 200}));
    return *image;
  }
};

using IsIt = bool (*)(int r, int g, int b);
bool isBox(int r, int g, int b) {
  return b > r + 60 && g > r;
}
bool isHot(int r, int g, int b) {
  return r > 190 && g > 40 && g < 140 && b < 90;
}
bool isAvatar(int r, int g, int b) {
  return r > g + 60 && b > g + 25 && r > 80;
}

int count(const Image& image, IsIt is) {
  int found = 0;
  for (std::size_t k = 0; k < image.rgb.size(); k += 3)
    found += is(image.rgb[k], image.rgb[k + 1], image.rgb[k + 2]) ? 1 : 0;
  return found;
}

int colours(const Image& image) {
  std::set<int> seen;
  for (std::size_t k = 0; k < image.rgb.size(); k += 3)
    seen.insert((image.rgb[k] << 16) + (image.rgb[k + 1] << 8) + image.rgb[k + 2]);
  return static_cast<int>(seen.size());
}

int differing(const Image& a, const Image& b) {
  int pixels = 0;
  for (std::size_t k = 0; k < std::min(a.rgb.size(), b.rgb.size()); k += 3) {
    constexpr int kVisible = 24;
    int most = 0;
    for (std::size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(a.rgb[k + c] - b.rgb[k + c]));
    pixels += most > kVisible ? 1 : 0;
  }
  return pixels;
}

TEST_F(Pictures, ShowTheCrowd) {
  const Image crowd = shot({"--objects", "600", "--mix", "0", "--frames", "2"});
  const Image empty = shot({"--objects", "0", "--frames", "2"});
  EXPECT_GT(colours(crowd), 500) << "light and shade";
  EXPECT_GT(count(crowd, isBox), 1500);
  EXPECT_EQ(count(empty, isBox), 0);
}

TEST_F(Pictures, ShowTheAvatarInTheMiddle) {
  const Image image = shot({"--objects", "0", "--frames", "1"});
  const float pixels = 100 * (Room::kAvatarRadius / 17) / 0.5F;  // distance and slope of the camera behind it
  const float area = std::numbers::pi_v<float> * pixels * pixels;
  EXPECT_NEAR(static_cast<float>(count(image, isAvatar)), area, 0.25F * area);
  const std::uint8_t* middle = image.pixel(160, 100);
  EXPECT_TRUE(isAvatar(middle[0], middle[1], middle[2]));
}

TEST_F(Pictures, ShowTheLevelsOfTheTrees) {
  const std::vector<std::string> crowd{"--objects", "400", "--mix", "1", "--frames", "1", "--look", "balls"};
  const auto atLevels = [&](const char* levels) {
    std::vector<std::string> words = crowd;
    words.insert(words.end(), {"--paint", "object", "--levels", levels});
    return shot(words);
  };
  const Image coarse = atLevels("1");
  const Image fine = atLevels("3");
  EXPECT_GT(differing(coarse, fine), 2000) << "one ball an object, or 64";
  std::vector<std::string> meshes = crowd;
  meshes.insert(meshes.end(), {"--look", "mesh"});
  EXPECT_LT(differing(shot(meshes), fine), differing(shot(meshes), coarse))
      << "finer balls are closer to the mesh";
}

TEST_F(Pictures, PaintBallsByLevelOrOverhang) {
  const auto painted = [&](const char* paint) {
    return shot({"--objects", "400", "--mix", "1", "--frames", "1", "--look", "balls", "--paint", paint});
  };
  const Image object = painted("object");
  const Image level = painted("level");
  const Image overhang = painted("overhang");
  EXPECT_GT(differing(object, level), 2000);
  EXPECT_GT(differing(level, overhang), 2000);
}

TEST_F(Pictures, CollidingObjectsFlash) {
  const Image crowded = shot({"--objects", "8000", "--frames", "2", "--view", "room"});
  const Image alone = shot({"--objects", "1", "--frames", "2", "--view", "room"});
  EXPECT_GT(count(crowded, isHot), 60);
  EXPECT_EQ(count(alone, isHot), 0);
}

TEST_F(Pictures, ThePanelIsShownOnRequest) {
  const Image without = shot({"--objects", "0", "--frames", "1"});
  const Image with = shot({"--objects", "0", "--frames", "1", "--panel"});
  EXPECT_GT(differing(without, with), 320 * 200 / 5);
}

TEST_F(Pictures, TheSameRunGivesTheSamePicture) {
  const std::vector<std::string> words{"--objects", "200", "--frames", "20", "--tour"};
  EXPECT_EQ(shot(words).rgb, shot(words).rgb);
}

TEST_F(Pictures, TheTourFliesTheAvatar) {
  const Image rest = shot({"--objects", "0", "--frames", "60", "--view", "room"});
  const Image tour = shot({"--objects", "0", "--frames", "60", "--view", "room", "--tour"});
  EXPECT_GT(differing(rest, tour), 10);
}

TEST_F(Pictures, AreRecordedEveryFewSteps) {
  const Finished finished = run({"--objects", "50", "--frames", "6", "--every", "2", "--record", "film"});
  ASSERT_EQ(finished.exitCode, 0) << finished.err;
  for (const char* name : {"film/00000.png", "film/00001.png", "film/00002.png"})
    EXPECT_TRUE(exists(name)) << name;
  EXPECT_FALSE(exists("film/00003.png"));
  EXPECT_NE(read("film/00000.png"), read("film/00002.png"));
}

TEST_F(Pictures, TheReportSeparatesRenderingFromCollision) {
  ASSERT_EQ(run({"--objects", "100", "--frames", "3", "--render", "--report", "with.json"}).exitCode, 0);
  ASSERT_EQ(run({"--objects", "100", "--frames", "3", "--report", "without.json"}).exitCode, 0);
  const auto with = nlohmann::json::parse(read("with.json"));
  const auto without = nlohmann::json::parse(read("without.json"));
  EXPECT_GT(with["microseconds"]["render"]["mean"].get<double>(), 0) << with.dump(1);
  EXPECT_FALSE(without["microseconds"].contains("render"));
  EXPECT_EQ(with["state_hash"], without["state_hash"]) << "looking changes nothing";
}

TEST_F(Pictures, ABrokenMeshFileIsNamed) {
  write("trees/bunny.obj", "v 1 2\n");
  const Finished finished = run({"--objects", "10", "--frames", "1", "--screenshot", "shot.png"});
  EXPECT_EQ(finished.exitCode, 3);
  EXPECT_NE(finished.err.find("bunny.obj: line 1"), std::string::npos) << finished.err;
  EXPECT_FALSE(exists("shot.png"));
}

TEST_F(Pictures, AFolderThatIsNotThereIsNamed) {
  const Finished finished = run({"--objects", "10", "--frames", "1", "--screenshot", "missing/shot.png"});
  EXPECT_EQ(finished.exitCode, 6);
  EXPECT_NE(finished.err.find("missing/shot.png"), std::string::npos) << finished.err;
}

// SDL's driver without a screen runs the very loop of the window.
TEST_F(Pictures, TheWindowPlaysItsFrames) {
  // SDL unloads the graphics driver, which leaves memory behind that nobody can tell from ours.
  constexpr const char* kOwnLeaks = "ASAN_OPTIONS=detect_leaks=0";
  const Finished finished = finish(
      start("/usr/bin/env", {"SDL_VIDEODRIVER=offscreen", kOwnLeaks, spheretree::tests::programPath(),
                             "--trees", "trees", "--size", "320x200", "--objects", "50", "--frames", "4"}));
  if (finished.err.find("no window can be opened") != std::string::npos) GTEST_SKIP() << finished.err;
  EXPECT_EQ(finished.exitCode, 0) << finished.err;
  EXPECT_NE(finished.err.find("keyboard and mouse fly"), std::string::npos) << finished.err;
}

}  // namespace
}  // namespace crowded_room
