// SPDX-License-Identifier: GPL-3.0-or-later
//
// From what a user names to a sorted list of meshes with their outputs.

#include "io/batch_plan.hpp"

#include <fnmatch.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <system_error>
#include <tuple>
#include <utility>

#include "builders/settings_use.hpp"
#include "io/files.hpp"
#include "io/guarded.hpp"
#include "io/manifest.hpp"

namespace spheretree::io {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 9> kMeshEndings{".obj", ".ply", ".stl", ".off", ".gltf",
                                                  ".glb", ".dae", ".3ds", ".fbx"};
// A tolerance decides how deep a tree goes. This is where that ends unless somebody says otherwise: with
// eight children each, 37,449 balls.
constexpr std::uint32_t kSceneLevels = 6;
constexpr const char* kTreeEnding = ".sph";

/// A mesh before its output is settled.
struct Found {
  fs::path input;
  fs::path stem;       // of the output, without any ending
  bool fixed = false;  // a manifest says the output
  std::string place;   // for sentences
  const ManifestEntry* entry = nullptr;
};

using Meshes = std::vector<Found>;

Error missing(const fs::path& path, const std::string& why) {
  return {ErrorCode::UnreadableInput, path.string() + ": " + why};
}

bool isPattern(const std::string& text) {
  return text.find_first_of("*?[") != std::string::npos;
}

bool hasEnding(const fs::path& path, std::span<const std::string> endings) {
  return std::find(endings.begin(), endings.end(), endingOf(path)) != endings.end();
}

/// `._chair.obj`, `.git/..`: not what is meant by a folder of meshes.
bool isHidden(const fs::path& below) {
  return std::any_of(below.begin(), below.end(),
                     [](const fs::path& part) { return part.string().front() == '.'; });
}

/// All files below a folder, sorted. Links to folders are not followed: they could lead in a circle.
Result<std::vector<fs::path>> filesBelow(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code failure;
  fs::recursive_directory_iterator it(folder, failure);
  for (const fs::recursive_directory_iterator end; !failure && it != end; it.increment(failure)) {
    std::error_code ignored;
    if (it->is_regular_file(ignored)) files.push_back(it->path());
  }
  if (failure) return missing(folder, failure.message());
  std::sort(files.begin(), files.end());
  return files;
}

/// The part of a pattern before the first component with a wildcard.
fs::path patternRoot(const fs::path& pattern) {
  fs::path root;
  for (const fs::path& part : pattern) {
    if (isPattern(part.string())) break;
    root /= part;
  }
  return root;
}

/// Components `from` on: `**` stands for any number of folders, in other components * stops at a slash.
bool matches(const std::vector<std::string>& pattern, std::size_t from, const std::vector<std::string>& path,
             std::size_t at) {
  if (from == pattern.size()) return at == path.size();
  if (pattern[from] == "**") {
    for (std::size_t next = at; next <= path.size(); ++next)
      if (matches(pattern, from + 1, path, next)) return true;
    return false;
  }
  return at < path.size() && ::fnmatch(pattern[from].c_str(), path[at].c_str(), FNM_PERIOD) == 0 &&
         matches(pattern, from + 1, path, at + 1);
}

std::vector<std::string> partsOf(const fs::path& path) {
  std::vector<std::string> parts;
  for (const fs::path& part : path) parts.push_back(part.string());
  return parts;
}

fs::path withoutEnding(fs::path path) {
  return path.replace_extension();
}

Result<Meshes> fromPattern(const std::string& pattern) {
  const fs::path root = patternRoot(pattern);
  const Result<std::vector<fs::path>> files = filesBelow(root.empty() ? "." : root);
  if (!files) return files.error();
  Meshes meshes;
  const std::vector<std::string> wanted =
      partsOf(root.empty() ? fs::path(pattern) : fs::path(pattern).lexically_relative(root));
  for (const fs::path& file : *files) {
    const fs::path below = file.lexically_relative(root.empty() ? "." : root);
    if (matches(wanted, 0, partsOf(below), 0))
      meshes.push_back({root / below, withoutEnding(below), false, (root / below).string(), nullptr});
  }
  if (meshes.empty()) return missing(pattern, "no file matches");
  return meshes;
}

/// `under`: where in the output folder the mirrored files go.
Result<Meshes> fromFolder(const fs::path& folder, const fs::path& under,
                          std::span<const std::string> endings) {
  const Result<std::vector<fs::path>> files = filesBelow(folder);
  if (!files) return files.error();
  Meshes meshes;
  for (const fs::path& file : *files) {
    const fs::path below = file.lexically_relative(folder);
    if (isHidden(below) || !hasEnding(file, endings)) continue;
    meshes.push_back({file, under / withoutEnding(below), false, file.string(), nullptr});
  }
  if (meshes.empty()) return missing(folder, "holds no mesh");
  return meshes;
}

Meshes fromManifest(const std::vector<ManifestEntry>& entries, const fs::path& folder) {
  Meshes meshes;
  for (const ManifestEntry& entry : entries) {
    Found found{entry.input.lexically_normal(), {}, entry.output.has_value(), entry.place, &entry};
    const fs::path below = found.input.lexically_relative(folder.empty() ? "." : folder.lexically_normal());
    const bool inside = !below.empty() && *below.begin() != "..";
    found.stem = withoutEnding(entry.output.value_or(inside ? below : found.input.filename()));
    meshes.push_back(std::move(found));
  }
  return meshes;
}

/// Where the last component of a folder's path is its name: not in `.`, `..` or `/`.
fs::path nameOf(const fs::path& folder) {
  std::error_code failure;
  const fs::path whole = fs::weakly_canonical(folder, failure);
  return whole.filename();
}

struct Gathered {
  Meshes meshes;
  std::vector<std::vector<ManifestEntry>> manifests;  // what the meshes point into
};

Result<Gathered> gather(const BatchRequest& request) {
  Gathered all;
  all.manifests.reserve(request.inputs.size());  // pointers into it must stay
  for (const std::string& input : request.inputs) {
    std::error_code failure;
    const fs::path path(input);
    Result<Meshes> found = Meshes{};
    if (fs::is_directory(path, failure)) {
      found = fromFolder(path, request.inputs.size() == 1 ? fs::path() : nameOf(path), request.endings);
    } else if (!fs::exists(path, failure) && isPattern(input)) {
      found = fromPattern(input);
    } else if (endingOf(path) == ".json" || endingOf(path) == ".csv") {
      Result<std::vector<ManifestEntry>> entries = readManifest(path);
      if (!entries) return entries.error();
      all.manifests.push_back(std::move(*entries));
      found = fromManifest(all.manifests.back(), path.parent_path());
    } else if (fs::exists(path, failure)) {
      found = Meshes{{path, withoutEnding(path.filename()), false, input, nullptr}};
    } else {
      found = missing(path, "No such file or directory");
    }
    if (!found) return found.error();
    all.meshes.insert(all.meshes.end(), found->begin(), found->end());
  }
  return all;
}

// --- settings ---

Result<BatchAsset> assetOf(const Found& found, const BatchRequest& request) {
  BatchAsset asset;
  asset.input = found.input;
  asset.output = found.stem.generic_string();
  asset.settings = request.settings;
  asset.repair = request.repair;
  asset.fullLevels = asset.settings.levels;
  if (found.entry == nullptr) return asset;
  const AssetSettings& own = found.entry->settings;
  builders::BuildSettings& settings = asset.settings;
  if (own.builder) settings.builder = *own.builder;
  settings.levels = own.levels.value_or(settings.levels);
  asset.fullLevels = settings.levels;
  settings.maxError = own.maxError.value_or(settings.maxError);
  settings.branch = own.branch.value_or(settings.branch);
  settings.quality = own.quality.value_or(settings.quality);
  settings.cover = own.cover.value_or(settings.cover);
  asset.repair = own.repair.value_or(asset.repair);
  if (found.entry->scene) {
    const SceneUse& scene = *found.entry->scene;
    const double largest = *std::max_element(scene.scales.begin(), scene.scales.end());
    asset.use = InstanceUse{scene.scales.size(), largest};
    if (scene.tolerance) {
      asset.tolerance = *scene.tolerance / largest;
      settings.maxError = 0;
      if (!own.levels && !request.levels) settings.levels = kSceneLevels;
    }
  }
  if (const std::string reason = builders::whyInvalid(settings); !reason.empty())
    return Error{ErrorCode::InvalidArgument, found.place + ": " + reason};
  return asset;
}

bool sameSettings(const builders::BuildSettings& a, const builders::BuildSettings& b) {
  const auto key = [](const builders::BuildSettings& s) {
    return std::tuple(s.builder, s.levels, s.maxError, s.branch, s.quality, s.cover);
  };
  return key(a) == key(b);  // the rest is the command line's, equal for all
}

/// Whether a scene's second entry is more of the first one's instances.
bool sharesTree(const BatchAsset& a, const BatchAsset& b) {
  return a.use && b.use && a.input == b.input && a.output == b.output && a.repair == b.repair &&
         sameSettings(a.settings, b.settings) && (a.tolerance > 0) == (b.tolerance > 0);
}

void addInstances(BatchAsset& asset, const BatchAsset& more) {
  asset.use->count += more.use->count;
  asset.use->largestScale = std::max(asset.use->largestScale, more.use->largestScale);
  asset.tolerance = std::min(asset.tolerance, more.tolerance);
}

// --- outputs ---

/// Both meshes of a pair `chair.obj`, `chair.stl` keep their endings: `chair.obj.sph`.
void settleNames(std::vector<BatchAsset>& assets, const std::vector<Found>& from) {
  std::map<std::string, std::size_t> uses;
  for (const BatchAsset& asset : assets) ++uses[asset.output];
  for (std::size_t k = 0; k < assets.size(); ++k) {
    if (!from[k].fixed && uses[assets[k].output] > 1) assets[k].output += from[k].input.extension().string();
    assets[k].output += kTreeEnding;
  }
}

Result<std::vector<BatchAsset>> withOutputs(const Meshes& meshes, const BatchRequest& request) {
  std::vector<BatchAsset> assets;
  std::vector<Found> from;
  for (const Found& found : meshes) {
    Result<BatchAsset> asset = assetOf(found, request);
    if (!asset) return asset.error();
    const auto shared = std::find_if(assets.begin(), assets.end(),
                                     [&](const BatchAsset& other) { return sharesTree(other, *asset); });
    if (shared != assets.end()) {
      addInstances(*shared, *asset);
      continue;
    }
    assets.push_back(std::move(*asset));
    from.push_back(found);
  }
  settleNames(assets, from);
  std::map<std::string, std::size_t> first;
  for (std::size_t k = 0; k < assets.size(); ++k) {
    const auto [at, added] = first.emplace(assets[k].output, k);
    if (!added) {
      return Error{ErrorCode::InvalidArgument, from[k].place + ": would have the same output " +
                                                   assets[k].output + " as " + from[at->second].place};
    }
  }
  return assets;
}

}  // namespace

std::string BatchAsset::record() const {
  return fs::path(output).replace_extension(".report.json").generic_string();
}

std::string BatchAsset::page() const {
  return fs::path(output).replace_extension(".report.html").generic_string();
}

std::vector<std::string> meshEndings() {
  return {kMeshEndings.begin(), kMeshEndings.end()};
}

Result<BatchPlan> planBatch(const BatchRequest& request) {
  return guarded(ErrorCode::UnreadableInput, "inputs", [&]() -> Result<BatchPlan> {
    const Result<Gathered> found = gather(request);
    if (!found) return found.error();
    Result<std::vector<BatchAsset>> assets = withOutputs(found->meshes, request);
    if (!assets) return assets.error();
    std::sort(assets->begin(), assets->end(),
              [](const BatchAsset& a, const BatchAsset& b) { return a.output < b.output; });
    BatchPlan plan;
    plan.ofAllShards = assets->size();
    const Shard shard = request.shard.value_or(Shard{});
    for (std::size_t k = shard.index - 1; k < assets->size(); k += shard.count)
      plan.assets.push_back(std::move((*assets)[k]));
    return plan;
  });
}

}  // namespace spheretree::io
