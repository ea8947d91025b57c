// SPDX-License-Identifier: GPL-3.0-or-later
//
// Geomview's Object File Format, text form: https://people.sc.fsu.edu/~jburkardt/data/off/off.html. One
// vertex and one face per line; colours, normals and texture coordinates behind them are skipped.

#include <algorithm>
#include <array>
#include <limits>

#include "io/mesh_readers.hpp"
#include "io/text_scanner.hpp"

namespace spheretree::io {
namespace {

// Those with three coordinates per vertex.
constexpr std::array<std::string_view, 6> kKeywords = {"OFF", "COFF", "NOFF", "CNOFF", "STOFF", "STCNOFF"};

struct Counts {
  std::size_t vertices = 0;
  std::size_t faces = 0;
};

Result<Counts> readHeader(TextScanner& scanner) {
  const Error notOff{ErrorCode::UnreadableInput, "is not a text OFF file: the first word must be OFF"};
  std::optional<std::string_view> line = scanner.nextFullLine('#');
  if (!line) return notOff;
  const std::string_view keyword = takeWord(*line);
  if (std::find(kKeywords.begin(), kKeywords.end(), keyword) == kKeywords.end()) return notOff;
  if (line->find_first_not_of(" \t") == std::string_view::npos) line = scanner.nextFullLine('#');
  if (!line) return scanner.error("the counts of vertices and faces are missing");
  std::array<std::size_t, 2> counts{};
  for (std::size_t& count : counts) {
    const std::string_view word = takeWord(*line);
    const std::optional<long long> number = parseInteger(word);
    if (!number || *number < 0 || *number > std::numeric_limits<std::uint32_t>::max())
      return scanner.error(quoted(word) + " is not a count");
    count = static_cast<std::size_t>(*number);
  }
  return Counts{counts[0], counts[1]};
}

Result<Eigen::Vector3d> readVertex(TextScanner& scanner, std::size_t index, std::size_t count) {
  std::optional<std::string_view> line = scanner.nextFullLine('#');
  if (!line)
    return scanner.error("the file ends after " + std::to_string(index) + " of " + std::to_string(count) +
                         " vertices");
  Eigen::Vector3d point;
  for (double& coordinate : point) {
    const std::string_view word = takeWord(*line);
    const std::optional<double> number = parseNumber(word);
    if (!number) return scanner.error("vertex coordinate " + quoted(word) + " is not a finite number");
    coordinate = *number;
  }
  return point;
}

std::optional<Error> readFace(TextScanner& scanner, PolygonSoup& soup, std::size_t count) {
  std::optional<std::string_view> line = scanner.nextFullLine('#');
  if (!line) {
    return scanner.error("the file ends after " + std::to_string(soup.polygonEnds.size()) + " of " +
                         std::to_string(count) + " faces");
  }
  const std::string_view size = takeWord(*line);
  const std::optional<long long> corners = parseInteger(size);
  if (!corners || *corners < 1) return scanner.error(quoted(size) + " is not a number of corners");
  for (long long k = 0; k < *corners; ++k) {
    const std::string_view word = takeWord(*line);
    const std::optional<long long> index = parseInteger(word);
    if (!index) return scanner.error("face corner " + quoted(word) + " is not a vertex number");
    if (*index < 0 || static_cast<std::size_t>(*index) >= soup.points.size()) {
      return scanner.error("face uses vertex " + std::to_string(*index) + " of " +
                           std::to_string(soup.points.size()) + " (counted from 0)");
    }
    soup.corners.push_back(static_cast<std::uint32_t>(*index));
  }
  soup.endPolygon();
  return std::nullopt;
}

}  // namespace

Result<PolygonSoup> readOff(std::string_view text) {
  if (looksBinary(text))
    return Error{ErrorCode::UnreadableInput, "is not a text OFF file: it holds binary data"};
  TextScanner scanner(text);
  const Result<Counts> counts = readHeader(scanner);
  if (!counts) return counts.error();
  PolygonSoup soup;
  soup.meshes = 1;
  for (std::size_t i = 0; i < counts.value().vertices; ++i) {
    Result<Eigen::Vector3d> point = readVertex(scanner, i, counts.value().vertices);
    if (!point) return point.error();
    soup.points.push_back(*point);
  }
  for (std::size_t i = 0; i < counts.value().faces; ++i) {
    const std::optional<Error> error = readFace(scanner, soup, counts.value().faces);
    if (error) return *error;
  }
  return soup;
}

}  // namespace spheretree::io
