// SPDX-License-Identifier: GPL-3.0-or-later
//
// One pass over a mesh file: its hash, which decides whether a batch has seen it, and about how many
// triangles it has, which decides how much memory and how many threads it gets. Where a header says the
// number it is taken from there, in OBJ the faces are counted, elsewhere the bytes decide.

#include "io/asset_scan.hpp"

#include <xxhash.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <memory>
#include <new>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

#include <nlohmann/json.hpp>

#include "io/files.hpp"
#include "io/guarded.hpp"
#include "io/hash_text.hpp"

namespace spheretree::io {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kChunk = std::size_t{1} << 18;
constexpr std::uint64_t kMostGltf = std::uint64_t{1} << 28;  // of JSON that is looked into for buffers
// Bytes a triangle takes, from files of Debian's model packages. Only an order of magnitude is wanted.
constexpr std::uint64_t kBinaryStlHeader = 84;
constexpr std::uint64_t kBinaryStlTriangle = 50;
constexpr std::uint64_t kTextTriangle = 200;      // ASCII STL and other text with normals
constexpr std::uint64_t kShortTextTriangle = 50;  // half a vertex and three indices
constexpr std::uint64_t kBinaryTriangle = 40;

struct FreeState {
  void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
};

/// The first bytes and what was counted on the way.
struct Pass {
  std::string head;
  std::uint64_t bytes = 0;
  std::uint64_t faceLines = 0;
};

/// Feeds the file to the hash.
Result<Pass> pass(const fs::path& path, XXH3_state_t& hash) {
  const auto failed = [&path](const std::string& why) {
    return Error{ErrorCode::UnreadableInput, path.string() + ": " + why};
  };
  std::error_code failure;
  if (fs::is_directory(path, failure)) return failed("is a directory");
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) return failed(std::generic_category().message(errno != 0 ? errno : EIO));
  Pass result;
  std::vector<char> chunk(kChunk);
  char before = '\n';
  while (file) {
    file.read(chunk.data(), static_cast<std::streamsize>(chunk.size()));
    const std::string_view text(chunk.data(), static_cast<std::size_t>(file.gcount()));
    if (text.empty()) break;
    XXH3_128bits_update(&hash, text.data(), text.size());
    if (result.head.empty()) result.head = text;
    for (const char letter : text) {
      if (letter == 'f' && before == '\n') ++result.faceLines;
      before = letter;
    }
    result.bytes += text.size();
  }
  if (file.bad()) return failed("reading it failed");
  return result;
}

/// The first whole number after `word`.
std::optional<std::uint64_t> numberAfter(std::string_view text, std::string_view word) {
  const std::size_t at = text.find(word);
  if (at == std::string_view::npos) return std::nullopt;
  text.remove_prefix(at + word.size());
  const std::size_t digits = text.find_first_not_of(" \t\r\n");
  if (digits == std::string_view::npos) return std::nullopt;
  std::uint64_t number = 0;
  const auto [end, code] = std::from_chars(text.data() + digits, text.data() + text.size(), number);
  static_cast<void>(end);
  return code == std::errc{} ? std::optional(number) : std::nullopt;
}

std::uint64_t stlTriangles(const Pass& pass) {
  if (pass.bytes >= kBinaryStlHeader) {
    std::uint32_t count = 0;
    std::memcpy(&count, pass.head.data() + kBinaryStlHeader - sizeof count, sizeof count);
    if (kBinaryStlHeader + kBinaryStlTriangle * count == pass.bytes) return count;
  }
  return pass.bytes / kTextTriangle;
}

std::uint64_t guessTriangles(const fs::path& path, const Pass& pass) {
  const std::string ending = endingOf(path);
  if (ending == ".obj") return pass.faceLines;
  if (ending == ".stl") return stlTriangles(pass);
  std::optional<std::uint64_t> said;
  if (ending == ".ply") said = numberAfter(pass.head, "element face");
  // A lie in a header must not reserve more than the file's bytes could need.
  if (said) return std::min(*said, pass.bytes);
  if (ending == ".off") return pass.bytes / kShortTextTriangle;
  if (ending == ".dae" || ending == ".gltf") return pass.bytes / kTextTriangle;
  return pass.bytes / kBinaryTriangle;
}

/// The files that a .gltf keeps its numbers in. What is not well-formed is for the reader to complain about.
std::vector<fs::path> buffersOf(const fs::path& path, std::uint64_t bytes) {
  std::vector<fs::path> buffers;
  if (endingOf(path) != ".gltf" || bytes > kMostGltf) return buffers;
  const Result<std::string> text = readFile(path);
  if (!text) return buffers;
  const auto json = nlohmann::json::parse(text.value(), nullptr, false);
  if (!json.is_object() || !json.contains("buffers") || !json.at("buffers").is_array()) return buffers;
  for (const auto& buffer : json.at("buffers")) {
    if (!buffer.is_object() || !buffer.contains("uri") || !buffer.at("uri").is_string()) continue;
    const auto uri = buffer.at("uri").get<std::string>();
    if (uri.rfind("data:", 0) != 0) buffers.push_back(path.parent_path() / uri);
  }
  return buffers;
}

}  // namespace

Result<AssetScan> scanAsset(const fs::path& path) {
  return guarded(ErrorCode::UnreadableInput, path.string(), [&]() -> Result<AssetScan> {
    const std::unique_ptr<XXH3_state_t, FreeState> hash(XXH3_createState());
    if (hash == nullptr) throw std::bad_alloc();
    XXH3_128bits_reset(hash.get());
    const Result<Pass> whole = pass(path, *hash);
    if (!whole) return whole.error();
    AssetScan scan;
    scan.bytes = whole->bytes;
    scan.triangleGuess = guessTriangles(path, whole.value());
    for (const fs::path& buffer : buffersOf(path, scan.bytes)) {
      const Result<Pass> part = pass(buffer, *hash);
      if (part) scan.triangleGuess += part->bytes / kBinaryTriangle;
    }
    scan.contentHash = hashText(XXH3_128bits_digest(hash.get()));
    return scan;
  });
}

}  // namespace spheretree::io
