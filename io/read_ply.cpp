// SPDX-License-Identifier: GPL-3.0-or-later
//
// The Stanford polygon format, G. Turk, "The PLY Polygon File Format" (1994): text and both binary byte
// orders, any number type, polygons as `face` lists or as `tristrips`. Elements and properties of no interest
// are skipped.

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "io/mesh_readers.hpp"
#include "io/text_scanner.hpp"

namespace spheretree::io {
namespace {

enum class Type : std::uint8_t { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float32, Float64 };
enum class Encoding : std::uint8_t { Text, LittleEndian, BigEndian };

struct TypeName {
  std::string_view name;
  Type type;
};
constexpr std::array<TypeName, 16> kTypeNames = {{{"char", Type::Int8},
                                                  {"int8", Type::Int8},
                                                  {"uchar", Type::Uint8},
                                                  {"uint8", Type::Uint8},
                                                  {"short", Type::Int16},
                                                  {"int16", Type::Int16},
                                                  {"ushort", Type::Uint16},
                                                  {"uint16", Type::Uint16},
                                                  {"int", Type::Int32},
                                                  {"int32", Type::Int32},
                                                  {"uint", Type::Uint32},
                                                  {"uint32", Type::Uint32},
                                                  {"float", Type::Float32},
                                                  {"float32", Type::Float32},
                                                  {"double", Type::Float64},
                                                  {"float64", Type::Float64}}};

struct Property {
  std::string_view name;
  std::optional<Type> countType;  ///< set for a list
  Type type = Type::Float32;
};

struct Element {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Encoding encoding = Encoding::Text;
  std::vector<Element> elements;
  std::string_view body;
};

Error broken(const std::string& why) {
  return {ErrorCode::UnreadableInput, why};
}

std::optional<Type> typeNamed(std::string_view name) {
  for (const TypeName& entry : kTypeNames)
    if (entry.name == name) return entry.type;
  return std::nullopt;
}

std::optional<Error> readFormat(TextScanner& scanner, std::string_view words, Header& header) {
  const std::string_view word = takeWord(words);
  if (word == "ascii") {
    header.encoding = Encoding::Text;
  } else if (word == "binary_little_endian") {
    header.encoding = Encoding::LittleEndian;
  } else if (word == "binary_big_endian") {
    header.encoding = Encoding::BigEndian;
  } else {
    return scanner.error("format " + quoted(word) + " is not known");
  }
  return std::nullopt;
}

std::optional<Error> readProperty(TextScanner& scanner, std::string_view words, Header& header) {
  if (header.elements.empty()) return scanner.error("property before any element");
  Property property;
  std::string_view word = takeWord(words);
  if (word == "list") {
    property.countType = typeNamed(takeWord(words));
    if (!property.countType) return scanner.error("the list's count has no known type");
    word = takeWord(words);
  }
  const std::optional<Type> type = typeNamed(word);
  if (!type) return scanner.error("type " + quoted(word) + " is not known");
  property.type = *type;
  property.name = takeWord(words);
  header.elements.back().properties.push_back(property);
  return std::nullopt;
}

std::optional<Error> readElement(TextScanner& scanner, std::string_view words, Header& header) {
  Element element;
  element.name = takeWord(words);
  const std::string_view word = takeWord(words);
  const std::optional<long long> count = parseInteger(word);
  if (!count || *count < 0) return scanner.error(quoted(word) + " is not a count");
  element.count = static_cast<std::uint64_t>(*count);
  header.elements.push_back(std::move(element));
  return std::nullopt;
}

Result<Header> readHeader(std::string_view bytes) {
  TextScanner scanner(bytes);
  std::optional<std::string_view> line = scanner.nextLine();
  if (!line || takeWord(*line) != "ply") return broken("is not a PLY file: it does not begin with ply");
  Header header;
  while ((line = scanner.nextLine())) {
    const std::string_view keyword = takeWord(*line);
    std::optional<Error> error;
    if (keyword == "end_header") {
      header.body = scanner.rest();
      return header;
    }
    if (keyword == "format")
      error = readFormat(scanner, *line, header);
    else if (keyword == "element")
      error = readElement(scanner, *line, header);
    else if (keyword == "property")
      error = readProperty(scanner, *line, header);
    else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty())
      error = scanner.error(quoted(keyword) + " is not a PLY header line");
    if (error) return *error;
  }
  return broken("the PLY header has no end_header");
}

/// Numbers off the body, one after the other, as doubles: every PLY type fits.
class Body {
 public:
  Body(std::string_view bytes, Encoding encoding) : rest_(bytes), encoding_(encoding) {}

  /// Nothing when the file ends, or a word is not a number.
  std::optional<double> next(Type type) {
    if (encoding_ == Encoding::Text) return parseNumberOrNotFinite(takeWord(rest_));
    switch (type) {
      case Type::Int8:
        return number<std::int8_t, std::uint8_t>();
      case Type::Uint8:
        return number<std::uint8_t, std::uint8_t>();
      case Type::Int16:
        return number<std::int16_t, std::uint16_t>();
      case Type::Uint16:
        return number<std::uint16_t, std::uint16_t>();
      case Type::Int32:
        return number<std::int32_t, std::uint32_t>();
      case Type::Uint32:
        return number<std::uint32_t, std::uint32_t>();
      case Type::Float32:
        return number<float, std::uint32_t>();
      case Type::Float64:
        return number<double, std::uint64_t>();
    }
    return std::nullopt;
  }

  /// A whole number, at least `least` and at most 32 bits.
  std::optional<std::int64_t> nextInteger(Type type, std::int64_t least) {
    const std::optional<double> value = next(type);
    if (!value || !(*value >= static_cast<double>(least))) return std::nullopt;
    if (*value > static_cast<double>(std::numeric_limits<std::uint32_t>::max())) return std::nullopt;
    const std::int64_t whole = static_cast<std::int64_t>(*value);
    if (static_cast<double>(whole) != *value) return std::nullopt;
    return whole;
  }

 private:
  /// Normals and qualities of real files are sometimes nan: only coordinates have to be finite.
  static std::optional<double> parseNumberOrNotFinite(std::string_view word) {
    if (const std::optional<double> value = parseNumber(word)) return value;
    double value = 0;
    const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (code != std::errc{} || end != word.data() + word.size()) return std::nullopt;
    return value;
  }

  template <class Number, class Bits>
  std::optional<double> number() {
    if (rest_.size() < sizeof(Bits)) return std::nullopt;
    Bits bits = 0;
    for (std::size_t k = 0; k < sizeof(Bits); ++k) {
      const std::size_t from = encoding_ == Encoding::BigEndian ? k : sizeof(Bits) - 1 - k;
      bits = static_cast<Bits>((static_cast<std::uint64_t>(bits) << 8U) |
                               static_cast<unsigned char>(rest_[from]));
    }
    rest_.remove_prefix(sizeof(Bits));
    return static_cast<double>(std::bit_cast<Number>(bits));
  }

  std::string_view rest_;
  Encoding encoding_;
};

class BodyReader {
 public:
  explicit BodyReader(const Header& header) : header_(header), body_(header.body, header.encoding) {}

  Result<PolygonSoup> read() {
    soup_.meshes = 1;
    for (const Element& element : header_.elements) {
      if (element.properties.empty()) continue;  // nothing in the body, however many are announced
      for (std::uint64_t i = 0; i < element.count; ++i) {
        const std::optional<std::string> problem = readItem(element);
        if (problem) return broken(std::string(element.name) + " " + std::to_string(i) + ": " + *problem);
      }
    }
    for (const std::uint32_t corner : soup_.corners) {
      if (corner >= soup_.points.size()) {
        return broken("a face uses vertex " + std::to_string(corner) + " of " +
                      std::to_string(soup_.points.size()) + " (counted from 0)");
      }
    }
    return std::move(soup_);
  }

 private:
  std::optional<std::string> readItem(const Element& element) {
    const std::string ends = "the file ends here, or a number cannot be read";
    const bool isVertex = element.name == "vertex";
    const bool isFace = element.name == "face";
    const bool isStrip = element.name == "tristrips";
    Eigen::Vector3d point = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    for (const Property& property : element.properties) {
      if (property.countType) {
        const bool isCorners = property.name == "vertex_indices" || property.name == "vertex_index";
        const std::optional<std::int64_t> count = body_.nextInteger(*property.countType, 0);
        if (!count) return ends;
        list_.clear();
        for (std::int64_t k = 0; k < *count; ++k) {
          const bool wanted = isCorners && (isFace || isStrip);
          const std::optional<double> value = body_.next(property.type);
          if (!value) return ends;
          if (wanted) list_.push_back(*value);
        }
        if (isCorners && (isFace || isStrip) && !(isFace ? addFace() : addStrip()))
          return "a corner is not a vertex number";
        continue;
      }
      const std::optional<double> value = body_.next(property.type);
      if (!value) return ends;
      if (property.name == "x") point.x() = *value;
      if (property.name == "y") point.y() = *value;
      if (property.name == "z") point.z() = *value;
    }
    if (!isVertex) return std::nullopt;
    if (!point.allFinite()) return "a coordinate is missing or not a finite number";
    if (soup_.points.size() >= std::numeric_limits<std::uint32_t>::max()) return "too many vertices";
    soup_.points.push_back(point);
    return std::nullopt;
  }

  static std::optional<std::uint32_t> index(double value) {
    if (!(value >= 0) || value > static_cast<double>(std::numeric_limits<std::uint32_t>::max()))
      return std::nullopt;
    const auto whole = static_cast<std::uint32_t>(value);
    if (static_cast<double>(whole) != value) return std::nullopt;
    return whole;
  }

  bool addFace() {
    for (const double value : list_) {
      const std::optional<std::uint32_t> corner = index(value);
      if (!corner) return false;
      soup_.corners.push_back(*corner);
    }
    soup_.endPolygon();
    return true;
  }

  /// Each corner after the second makes a triangle with the two before it, every other one turned; -1 starts
  /// anew.
  bool addStrip() {
    std::size_t length = 0;
    for (std::size_t k = 0; k < list_.size(); ++k) {
      if (list_[k] == -1) {
        length = 0;
        continue;
      }
      if (!index(list_[k])) return false;
      if (++length < 3) continue;
      const bool turned = length % 2 == 0;
      soup_.corners.push_back(*index(list_[turned ? k - 1 : k - 2]));
      soup_.corners.push_back(*index(list_[turned ? k - 2 : k - 1]));
      soup_.corners.push_back(*index(list_[k]));
      soup_.endPolygon();
    }
    return true;
  }

  const Header& header_;
  Body body_;
  PolygonSoup soup_;
  std::vector<double> list_;  // reused, grown as the file really delivers
};

}  // namespace

Result<PolygonSoup> readPly(std::string_view bytes) {
  const Result<Header> header = readHeader(bytes);
  if (!header) return header.error();
  return BodyReader(header.value()).read();
}

}  // namespace spheretree::io
