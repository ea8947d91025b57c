// SPDX-License-Identifier: MIT
//
// Trees come in the units of their meshes and the objects of the room are about 1 x 1 x 1. The scale is taken
// from the diagonal of the mesh where the file states it, so that all trees of one mesh make objects of one
// size, however far their balls stick out: a mesh with the diagonal of the unit cube has the size of one.
#include "tree_library.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <optional>
#include <system_error>
#include <utility>

namespace crowded_room {

namespace {

namespace fs = std::filesystem;
using spheretree::Aabb;
using spheretree::Done;
using spheretree::Error;
using spheretree::ErrorCode;
using spheretree::QueryTree;
using spheretree::Result;
using spheretree::SphereTree;
using spheretree::SphFile;
using spheretree::Vec3;

constexpr std::string_view kExtension = ".sph";
constexpr std::string_view kBoxPrefix = "box";
constexpr std::string_view kBuiltIn = "box-built-in";
/// Balls of useful trees reach less than an object's size beyond it; the room counts on it.
constexpr float kLargestSize = 4;
/// Of the distance from the origin: where single precision ends, there is nothing left to scale.
constexpr float kNoSize = 0x1p-18F;
/// Added to radii of unit size: several times what scaling a ball can lose.
constexpr float kRounding = 0x1p-20F;

Error unreadable(const fs::path& path, const std::string& why) {
  return {ErrorCode::UnreadableInput, path.string() + ": " + why};
}

std::optional<double> meshDiagonal(const SphFile& file) {
  for (const auto& [key, value] : file.metadata) {
    if (key != "mesh-diagonal") continue;
    double diagonal = 0;
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), diagonal);
    if (error == std::errc{} && std::isfinite(diagonal) && diagonal > 0) return diagonal;
  }
  return std::nullopt;
}

float unitScale(const SphFile& file, const Aabb& bounds) {
  if (const std::optional<double> diagonal = meshDiagonal(file))
    return static_cast<float>(std::numbers::sqrt3 / *diagonal);
  const Vec3 size = bounds.max - bounds.min;
  return 1 / std::max({size.x, size.y, size.z});
}

Result<UnitTree> unitTree(const std::string& name, const SphFile& file) {
  std::vector<float> standOff = spheretree::standOffsOf(file);
  const Result<QueryTree> raw = QueryTree::create(file.tree, standOff);
  if (!raw) return raw.error();
  const Vec3 center = 0.5F * (raw->bounds().min + raw->bounds().max);
  const float scale = unitScale(file, raw->bounds());
  if (!std::isfinite(scale) || scale * kNoSize * raw->extent() > 1)
    return Error{ErrorCode::InvalidArgument, "the tree has no size that could be scaled to 1"};
  std::vector<SphereTree::Entry> entries;
  for (const spheretree::Node& node : file.tree.nodes())
    entries.push_back(
        {{scale * (node.ball.center - center), scale * node.ball.radius + kRounding}, node.parent});
  Result<SphereTree> tree = SphereTree::create(entries);
  if (!tree) return tree.error();
  for (float& each : standOff) each = scale * each + 2 * kRounding;
  Result<QueryTree> query = QueryTree::create(*tree, standOff);
  if (!query) return query.error();
  const Vec3 size = query->bounds().max - query->bounds().min;
  if (std::max({size.x, size.y, size.z}) > kLargestSize)
    return Error{ErrorCode::InvalidArgument, "its balls reach far beyond the mesh that it names"};
  const TreeUse use = name.starts_with(kBoxPrefix) ? TreeUse::Box : TreeUse::Bunny;
  return UnitTree{name, use, {}, std::move(*tree), std::move(*query), center, scale};
}

Result<SphFile> readTree(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream) return unreadable(path, "cannot be read");
  Result<SphFile> file = spheretree::parseSph(text);
  if (!file) return unreadable(path, file.error().message);
  return file;
}

/// The `.sph` files of a folder by name; none when there is no such folder.
std::vector<fs::path> treeFiles(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code ignored;  // a folder that cannot be listed has no trees for us
  for (fs::directory_iterator it(folder, ignored), end; it != end; it.increment(ignored)) {
    if (it->path().extension() == kExtension && it->is_regular_file(ignored)) files.push_back(it->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// A cube of edge 1 as its octree of two levels.
SphFile builtInBox() {
  constexpr float kQuarter = 0.25F;
  const float radius = std::numbers::sqrt3_v<float> / 2;
  std::vector<SphereTree::Entry> entries{{{{0, 0, 0}, radius}}};
  for (const float x : {-kQuarter, kQuarter}) {
    for (const float y : {-kQuarter, kQuarter}) {
      for (const float z : {-kQuarter, kQuarter}) entries.push_back({{{x, y, z}, radius / 2}, 0});
    }
  }
  constexpr std::uint32_t kBranch = 8;
  const std::string diagonal = std::to_string(std::numbers::sqrt3);
  return {std::move(*SphereTree::create(entries)), kBranch, {{"mesh-diagonal", diagonal}}, {}};
}

}  // namespace

Result<TreeLibrary> TreeLibrary::load(const fs::path& folder) {
  const std::vector<fs::path> files = treeFiles(folder);
  if (files.empty()) return Error{ErrorCode::UnreadableInput, howToMakeTrees(folder)};
  TreeLibrary library;
  for (const fs::path& path : files) {
    const Result<SphFile> file = readTree(path);
    if (!file) return file.error();
    const std::string name = path.stem().string();
    const Result<Done> added = library.add(name, *file);
    if (!added) return unreadable(path, added.error().message);
    library.placeOf(name)->file = path;
  }
  if (library.usual(TreeUse::Box).use != TreeUse::Box) {
    const Result<Done> added = library.add(std::string(kBuiltIn), builtInBox());
    if (!added) return added.error();
  }
  return library;
}

Result<TreeLibrary> TreeLibrary::loadFirst(std::span<const fs::path> folders) {
  for (const fs::path& folder : folders) {
    if (!treeFiles(folder).empty()) return load(folder);
  }
  return load(folders.empty() ? fs::path("trees") : folders.front());
}

TreeLibrary TreeLibrary::builtIn() {
  TreeLibrary library;
  library.trees_.push_back(std::move(*unitTree(std::string(kBuiltIn), builtInBox())));
  return library;
}

Result<Done> TreeLibrary::add(const std::string& name, const SphFile& file) {
  Result<UnitTree> tree = unitTree(name, file);
  if (!tree) return tree.error();
  const auto place = placeOf(name);
  if (place != trees_.end() && place->name == name) {
    *place = std::move(*tree);
  } else {
    trees_.insert(place, std::move(*tree));
  }
  return Done{};
}

std::vector<UnitTree>::iterator TreeLibrary::placeOf(std::string_view name) {
  return std::lower_bound(trees_.begin(), trees_.end(), name,
                          [](const UnitTree& tree, std::string_view sought) { return tree.name < sought; });
}

const UnitTree* TreeLibrary::find(std::string_view name) const noexcept {
  const auto isNamed = [&](const UnitTree& tree) { return tree.name == name; };
  const auto found = std::find_if(trees_.begin(), trees_.end(), isNamed);
  return found == trees_.end() ? nullptr : &*found;
}

const UnitTree& TreeLibrary::usual(TreeUse use) const noexcept {
  const auto isUsed = [&](const UnitTree& tree) { return tree.use == use; };
  const auto found = std::find_if(trees_.begin(), trees_.end(), isUsed);
  return found == trees_.end() ? trees_.front() : *found;
}

std::string howToMakeTrees(const fs::path& folder) {
  const std::string path = folder.string();
  return path + ": no sphere trees there; make them with `spheretree build bunny.obj -o " + path +
         "/bunny.sph` and `spheretree build box.obj -o " + path + "/box.sph`";
}

}  // namespace crowded_room
