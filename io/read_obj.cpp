// SPDX-License-Identifier: GPL-3.0-or-later
//
// Wavefront OBJ, "Object Files", appendix B1 of the Advanced Visualizer manual. Only `v` and `f` matter here;
// every other statement is skipped, as are texture and normal numbers.

#include <limits>
#include <utility>

#include "io/mesh_readers.hpp"
#include "io/text_scanner.hpp"

namespace spheretree::io {
namespace {

class ObjReader {
 public:
  explicit ObjReader(std::string_view text) : scanner_(text) {}

  Result<PolygonSoup> read() {
    while (std::optional<std::string_view> line = scanner_.nextLine()) {
      const std::optional<Error> error = statement(joined(*line));
      if (error) return *error;
    }
    if (largestIndex_ >= 0 && static_cast<std::size_t>(largestIndex_) >= soup_.points.size()) {
      return Error{ErrorCode::UnreadableInput, "line " + std::to_string(largestLine_) +
                                                   ": face uses vertex " + std::to_string(largestIndex_ + 1) +
                                                   " of " + std::to_string(soup_.points.size())};
    }
    return std::move(soup_);
  }

 private:
  /// The line with what a backslash at its end continues it by.
  std::string_view joined(std::string_view line) {
    if (!line.ends_with('\\')) return line;
    joined_.clear();
    while (line.ends_with('\\')) {
      joined_.append(line.substr(0, line.size() - 1)).push_back(' ');
      line = scanner_.nextLine().value_or(std::string_view{});
    }
    joined_.append(line);
    return joined_;
  }

  std::optional<Error> statement(std::string_view line) {
    const std::string_view keyword = takeWord(line);
    if (keyword == "v") return vertex(line);
    if (keyword == "f" || keyword == "fo") return face(line);
    if (keyword == "o" || keyword == "g") newMesh_ = true;
    return std::nullopt;
  }

  std::optional<Error> vertex(std::string_view line) {
    if (soup_.points.size() >= std::numeric_limits<std::uint32_t>::max())
      return scanner_.error("too many vertices");
    Eigen::Vector3d point;
    for (double& coordinate : point) {
      const std::string_view word = takeWord(line);
      const std::optional<double> number = parseNumber(word);
      if (!number) return scanner_.error("vertex coordinate " + quoted(word) + " is not a finite number");
      coordinate = *number;
    }
    soup_.points.push_back(point);
    return std::nullopt;
  }

  std::optional<Error> face(std::string_view line) {
    for (std::string_view word = takeWord(line); !word.empty() && word.front() != '#';
         word = takeWord(line)) {
      const std::optional<long long> number = parseInteger(word.substr(0, word.find('/')));
      if (!number || *number == 0)
        return scanner_.error("face corner " + quoted(word) + " is not a vertex number");
      // Negative numbers count back from the vertex read last.
      const long long count = static_cast<long long>(soup_.points.size());
      const long long index = *number > 0 ? *number - 1 : count + *number;
      if (index < 0 || index > std::numeric_limits<std::uint32_t>::max())
        return scanner_.error("face uses vertex " + std::to_string(*number) + " of " + std::to_string(count));
      if (index > largestIndex_) {
        largestIndex_ = index;
        largestLine_ = scanner_.lineNumber();
      }
      soup_.corners.push_back(static_cast<std::uint32_t>(index));
    }
    soup_.endPolygon();
    if (std::exchange(newMesh_, false)) ++soup_.meshes;
    return std::nullopt;
  }

  TextScanner scanner_;
  PolygonSoup soup_;
  std::string joined_;
  bool newMesh_ = true;
  long long largestIndex_ = -1;  // a face may come before its vertices, so the range is checked at the end
  std::size_t largestLine_ = 0;
};

}  // namespace

Result<PolygonSoup> readObj(std::string_view text) {
  if (looksBinary(text)) return Error{ErrorCode::UnreadableInput, "is not an OBJ file: it holds binary data"};
  return ObjReader(text).read();
}

}  // namespace spheretree::io
