// SPDX-License-Identifier: GPL-3.0-or-later
//
// STL, text and binary, as 3D Systems' StereoLithography Interface Specification (1989) has them. Binary
// files often begin with the word "solid" too, so the length decides: 84 bytes and 50 more per triangle.

#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "io/mesh_readers.hpp"
#include "io/text_scanner.hpp"

namespace spheretree::io {
namespace {

constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kFirstTriangle = kHeaderBytes + 4;
constexpr std::size_t kTriangleBytes = 50;  // normal, three corners, two bytes of attributes
constexpr std::size_t kCornersOffset = 12;

Error broken(const std::string& why) {
  return {ErrorCode::UnreadableInput, why};
}

/// Little-endian, whatever the machine.
std::uint32_t wordAt(std::string_view bytes, std::size_t offset) {
  std::uint32_t value = 0;
  for (std::size_t k = 4; k-- > 0;) value = (value << 8U) | static_cast<unsigned char>(bytes[offset + k]);
  return value;
}

Result<PolygonSoup> readBinary(std::string_view bytes, std::size_t triangles) {
  PolygonSoup soup;
  soup.meshes = 1;
  for (std::size_t t = 0; t < triangles; ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t offset = kFirstTriangle + t * kTriangleBytes + kCornersOffset + k * 12;
      Eigen::Vector3d point;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const float coordinate = std::bit_cast<float>(wordAt(bytes, offset + axis * 4));
        if (!std::isfinite(coordinate))
          return broken("triangle " + std::to_string(t) + " has a coordinate that is not a finite number");
        point[static_cast<Eigen::Index>(axis)] = static_cast<double>(coordinate);
      }
      soup.corners.push_back(static_cast<std::uint32_t>(soup.points.size()));
      soup.points.push_back(point);
    }
    soup.endPolygon();
  }
  return soup;
}

class TextReader {
 public:
  explicit TextReader(std::string_view text) : scanner_(text) {}

  Result<PolygonSoup> read() {
    while (std::optional<std::string_view> line = scanner_.nextLine()) {
      std::string_view words = *line;
      for (std::string_view word = takeWord(words); !word.empty(); word = takeWord(words)) {
        if (word == "solid" || word == "endsolid") {
          if (inFacet_) return scanner_.error(quoted(word) + " inside a facet");
          inSolid_ = word == "solid";
          newMesh_ = newMesh_ || inSolid_;
          break;  // the rest of the line is a name
        }
        const std::optional<Error> error = facetWord(word, words);
        if (error) return *error;
      }
    }
    if (inFacet_ || inSolid_) return scanner_.error("the file ends before endsolid");
    return std::move(soup_);
  }

 private:
  std::optional<Error> facetWord(std::string_view word, std::string_view& words) {
    if (word == "facet") {
      inFacet_ = true;
    } else if (word == "vertex") {
      if (!inFacet_) return scanner_.error("vertex outside a facet");
      return vertex(words);
    } else if (word == "endfacet") {
      if (!inFacet_) return scanner_.error("endfacet without facet");
      inFacet_ = false;
      soup_.endPolygon();
      if (std::exchange(newMesh_, false)) ++soup_.meshes;
    }
    // What is left is "normal" with its numbers, "outer", "loop", "endloop".
    return std::nullopt;
  }

  std::optional<Error> vertex(std::string_view& words) {
    if (soup_.points.size() >= std::numeric_limits<std::uint32_t>::max())
      return scanner_.error("too many vertices");
    Eigen::Vector3d point;
    for (double& coordinate : point) {
      const std::string_view word = takeWord(words);
      const std::optional<double> number = parseNumber(word);
      if (!number) return scanner_.error("vertex coordinate " + quoted(word) + " is not a finite number");
      coordinate = *number;
    }
    soup_.corners.push_back(static_cast<std::uint32_t>(soup_.points.size()));
    soup_.points.push_back(point);
    return std::nullopt;
  }

  TextScanner scanner_;
  PolygonSoup soup_;
  bool inSolid_ = false;
  bool inFacet_ = false;
  bool newMesh_ = true;
};

}  // namespace

Result<PolygonSoup> readStl(std::string_view bytes) {
  const std::size_t room =
      bytes.size() < kFirstTriangle ? 0 : (bytes.size() - kFirstTriangle) / kTriangleBytes;
  const std::size_t announced = bytes.size() < kFirstTriangle ? 0 : wordAt(bytes, kHeaderBytes);
  if (bytes.size() >= kFirstTriangle && bytes.size() == kFirstTriangle + announced * kTriangleBytes)
    return readBinary(bytes, announced);
  if (!looksBinary(bytes)) {
    std::string_view text = bytes;
    if (takeWord(text) == "solid") return TextReader(bytes).read();
    return broken("is not an STL file: it is text that does not begin with solid");
  }
  if (bytes.size() < kFirstTriangle) return broken("is not an STL file: too short for a binary one");
  if (announced > room) {
    return broken("announces " + std::to_string(announced) + " triangles but has room for " +
                  std::to_string(room) + ": truncated, or not an STL file");
  }
  return readBinary(bytes, announced);  // some writers append data of their own
}

}  // namespace spheretree::io
