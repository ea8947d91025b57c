// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <spheretree/query_tree.hpp>
#include <spheretree/result.hpp>
#include <spheretree/sphere_tree.hpp>
#include <spheretree/vec3.hpp>

namespace crowded_room {

/// Which objects of the room a tree is made for.
enum class TreeUse : unsigned char { Bunny, Box };

/// A sphere tree in room units: about 1 x 1 x 1 around the origin.
struct UnitTree {
  std::string name;  ///< the name of its file without `.sph`
  TreeUse use = TreeUse::Bunny;
  std::filesystem::path file;  ///< empty when built in
  spheretree::SphereTree tree;
  spheretree::QueryTree query;
  /// A point p of the mesh stands at scale * (p - center).
  spheretree::Vec3 center;
  float scale = 1;
};

/// The trees that the objects of the room may wear. Immutable; a Room points into it, so it must live longer.
class TreeLibrary {
 public:
  /// All `.sph` files of a folder, in the order of their names; a name that begins with `box` is for boxes,
  /// any other for bunnies. Where none is for boxes, the built-in one is added. Fails with UnreadableInput,
  /// naming the folder or the file and the reason; when the folder is missing or holds no tree, the sentence
  /// says how to make them.
  static spheretree::Result<TreeLibrary> load(const std::filesystem::path& folder);

  /// The first of the folders that exists and holds a `.sph` file, loaded; what load() says otherwise.
  static spheretree::Result<TreeLibrary> loadFirst(std::span<const std::filesystem::path> folders);

  /// Without any file: a box of 1 + 8 balls, `box-built-in`, which the bunnies wear, too.
  static TreeLibrary builtIn();

  /// Adds a tree under a name, scaled to the unit size, or replaces the one of that name. Fails as
  /// QueryTree::create() does. Not while a Room uses the library.
  spheretree::Result<spheretree::Done> add(const std::string& name, const spheretree::SphFile& file);

  [[nodiscard]] std::span<const UnitTree> trees() const noexcept { return trees_; }
  /// The tree of that name; nothing when there is none.
  [[nodiscard]] const UnitTree* find(std::string_view name) const noexcept;
  /// The tree that a kind of object wears unless told otherwise: the first of its use, else the first of all.
  [[nodiscard]] const UnitTree& usual(TreeUse use) const noexcept;

 private:
  TreeLibrary() = default;
  /// Where a tree of that name is or belongs.
  [[nodiscard]] std::vector<UnitTree>::iterator placeOf(std::string_view name);

  std::vector<UnitTree> trees_;  // never empty; ordered by name
};

/// One sentence: how to make a folder of trees with the toolkit.
[[nodiscard]] std::string howToMakeTrees(const std::filesystem::path& folder);

}  // namespace crowded_room
