// SPDX-License-Identifier: GPL-3.0-or-later
//
// Manifests of `spheretree batch`. JSON and CSV become the same rows of named cells first; every cell knows
// its place, so that one table of keys (kKeys) checks both and every complaint names file, place and reason.

#include "io/manifest.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "builders/catalogue.hpp"
#include "io/files.hpp"
#include "io/report_parts.hpp"

namespace spheretree::io {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::uint32_t kMostInstances = 1'000'000;  // far beyond any scene: a slip of the finger

/// Ends the reading; the message names the place.
struct Complaint : std::runtime_error {
  using std::runtime_error::runtime_error;
};

[[noreturn]] void complain(const std::string& place, const std::string& why) {
  throw Complaint(place + ": " + why);
}

/// A value with its place. Of several texts when the manifest has a list there.
struct Cell {
  enum class Kind : std::uint8_t { Text, Number, Any };  // CSV does not tell: Any
  std::string key;
  std::string place;
  std::vector<std::string> values;
  Kind kind = Kind::Any;
  bool list = false;
};

struct Row {
  std::string place;
  std::vector<Cell> cells;
};

// --- values ---

std::string quoted(const std::string& text) {
  return "'" + text + "'";
}

const std::string& single(const Cell& cell) {
  if (cell.list || cell.values.size() != 1) complain(cell.place, "must be one value, not a list");
  return cell.values.front();
}

std::string textOf(const Cell& cell) {
  const std::string& text = single(cell);
  if (cell.kind == Cell::Kind::Number) complain(cell.place, "must be a text, not the number " + text);
  if (text.empty()) complain(cell.place, "is empty");
  return text;
}

double toNumber(const Cell& cell, const std::string& text) {
  double value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool number = code == std::errc{} && end == text.data() + text.size() && std::isfinite(value);
  if (!number || cell.kind == Cell::Kind::Text) complain(cell.place, quoted(text) + " is not a number");
  return value;
}

std::uint32_t wholeOf(const Cell& cell, std::uint32_t least, std::uint32_t most) {
  const double value = toNumber(cell, single(cell));
  if (value != std::floor(value) || value < least || value > most) {
    complain(cell.place, quoted(single(cell)) + " is not a whole number in [" + std::to_string(least) + ", " +
                             std::to_string(most) + "]");
  }
  return static_cast<std::uint32_t>(value);
}

double fractionOf(const Cell& cell) {
  const double value = toNumber(cell, single(cell));
  if (value < 0 || value > 1) complain(cell.place, quoted(single(cell)) + " is not a fraction in [0, 1]");
  return value;
}

double positive(const Cell& cell, const std::string& text) {
  const double value = toNumber(cell, text);
  if (value <= 0) complain(cell.place, quoted(text) + " is not a number above 0");
  return value;
}

std::vector<double> positivesOf(const Cell& cell) {
  std::vector<double> numbers;
  for (const std::string& text : cell.values) numbers.push_back(positive(cell, text));
  if (numbers.empty()) complain(cell.place, "is an empty list");
  return numbers;
}

/// The index of the word among `words`, in upper or lower case.
std::size_t choiceOf(const Cell& cell, const std::vector<std::string>& words) {
  const std::string text = lowerCase(textOf(cell));
  const auto at = std::find(words.begin(), words.end(), text);
  if (at != words.end()) return static_cast<std::size_t>(at - words.begin());
  std::string choices;
  for (const std::string& word : words) choices += (choices.empty() ? "" : ", ") + word;
  complain(cell.place, quoted(single(cell)) + " is none of " + choices);
}

template <class Enum, std::size_t N, class Name>
Enum enumOf(const Cell& cell, const std::array<Enum, N>& values, Name name) {
  std::vector<std::string> words;
  for (const Enum value : values) words.push_back(name(value));
  return values.at(choiceOf(cell, words));
}

// --- keys ---

/// An entry while its cells come in.
struct Draft {
  ManifestEntry entry;
  std::optional<std::uint32_t> count;  // of `instances`
  std::vector<double> instances;       // of `instances` as a list
  std::optional<double> scale;
  std::optional<double> tolerance;
};

void setInput(const Cell& cell, Draft& draft) {
  draft.entry.input = textOf(cell);
}

void setOutput(const Cell& cell, Draft& draft) {
  const fs::path path = fs::path(textOf(cell)).lexically_normal();
  const bool climbs = path.is_absolute() || (!path.empty() && *path.begin() == "..");
  if (climbs) complain(cell.place, quoted(single(cell)) + " does not lie in the output folder");
  if (path.extension() != ".sph" || path.stem().empty())
    complain(cell.place, quoted(single(cell)) + " does not end in .sph");
  draft.entry.output = path;
}

void setLevels(const Cell& cell, Draft& draft) {
  draft.entry.settings.levels = wholeOf(cell, 1, builders::SettingLimits::kMostLevels);
}
void setMaxError(const Cell& cell, Draft& draft) {
  draft.entry.settings.maxError = fractionOf(cell);
}
void setBranch(const Cell& cell, Draft& draft) {
  using Limits = builders::SettingLimits;
  draft.entry.settings.branch = wholeOf(cell, Limits::kLeastBranch, Limits::kMostBranch);
}
void setBuilder(const Cell& cell, Draft& draft) {
  std::vector<std::string> names;
  for (const builders::CatalogueEntry& row : builders::catalogue()) names.emplace_back(row.name);
  draft.entry.settings.builder = names[choiceOf(cell, names)];
}
void setQuality(const Cell& cell, Draft& draft) {
  using builders::Quality;
  draft.entry.settings.quality =
      enumOf(cell, std::array{Quality::Fast, Quality::Normal, Quality::Best}, qualityName);
}
void setCover(const Cell& cell, Draft& draft) {
  const std::size_t choice = choiceOf(cell, {"surface", "solid"});
  draft.entry.settings.cover = choice == 0 ? builders::Cover::Surface : builders::Cover::Solid;
}
void setRepair(const Cell& cell, Draft& draft) {
  draft.entry.settings.repair = enumOf(
      cell, std::array{Repair::Off, Repair::Orient, Repair::Fill, Repair::Wrap, Repair::Auto}, repairName);
}
void setScale(const Cell& cell, Draft& draft) {
  draft.scale = positive(cell, single(cell));
}
void setInstances(const Cell& cell, Draft& draft) {
  if (cell.list) {
    draft.instances = positivesOf(cell);
  } else {
    draft.count = wholeOf(cell, 1, kMostInstances);
  }
}
void setTolerance(const Cell& cell, Draft& draft) {
  draft.tolerance = positive(cell, single(cell));
}

struct Key {
  std::string_view name;
  void (*set)(const Cell&, Draft&);
};

constexpr std::array kKeys{
    Key{"input", setInput},        Key{"output", setOutput},       Key{"levels", setLevels},
    Key{"max_error", setMaxError}, Key{"branch", setBranch},       Key{"builder", setBuilder},
    Key{"quality", setQuality},    Key{"cover", setCover},         Key{"repair", setRepair},
    Key{"scale", setScale},        Key{"instances", setInstances}, Key{"tolerance", setTolerance}};

const Key* findKey(std::string_view name) {
  const auto at = std::find_if(kKeys.begin(), kKeys.end(), [&](const Key& key) { return key.name == name; });
  return at == kKeys.end() ? nullptr : &*at;
}

std::string unknownKey(const std::string& name) {
  std::string names;
  for (const Key& key : kKeys) names += (names.empty() ? "" : ", ") + std::string(key.name);
  return "there is no setting " + quoted(name) + "; there are " + names;
}

void settleScene(Draft& draft) {
  ManifestEntry& entry = draft.entry;
  if (!draft.instances.empty() && draft.scale)
    complain(entry.place, "instances lists the scales, so scale must not be given");
  if (draft.tolerance && entry.settings.maxError)
    complain(entry.place, "tolerance and max_error both say how far balls may stick out");
  if (draft.instances.empty() && !draft.count && !draft.scale && !draft.tolerance) return;
  SceneUse use;
  use.scales = draft.instances;
  if (use.scales.empty()) use.scales.assign(draft.count.value_or(1), draft.scale.value_or(1));
  use.tolerance = draft.tolerance;
  entry.scene = std::move(use);
}

ManifestEntry entryOf(const Row& row, const fs::path& folder) {
  Draft draft;
  draft.entry.place = row.place;
  for (const Cell& cell : row.cells) {
    const Key* key = findKey(cell.key);
    if (key == nullptr) complain(row.place, unknownKey(cell.key));
    key->set(cell, draft);
  }
  if (draft.entry.input.empty()) complain(row.place, "has no input");
  if (draft.entry.input.is_relative()) draft.entry.input = folder / draft.entry.input;
  settleScene(draft);
  return std::move(draft.entry);
}

// --- JSON ---

std::string lineAndColumn(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, byte > 0 ? byte - 1 : 0);
  const auto lines = static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
  const std::size_t start = before.rfind('\n');
  const std::size_t column = start == std::string_view::npos ? before.size() : before.size() - start - 1;
  return "line " + std::to_string(lines + 1) + ", column " + std::to_string(column + 1);
}

void addValue(const Json& value, Cell& cell) {
  if (!value.is_string() && !value.is_number())
    complain(cell.place, "must be a number, a text or a list of them");
  cell.kind = value.is_string() ? Cell::Kind::Text : Cell::Kind::Number;
  cell.values.push_back(value.is_string() ? value.get<std::string>() : value.dump());
}

Row rowOf(const Json& object, const std::string& place) {
  if (!object.is_object()) complain(place, "must be an object");
  Row row{place, {}};
  for (const auto& [key, value] : object.items()) {
    Cell cell;
    cell.key = key;
    cell.place = place + "." + key;
    cell.list = value.is_array();
    if (cell.list) {
      for (const Json& part : value) addValue(part, cell);
    } else {
      addValue(value, cell);
    }
    row.cells.push_back(std::move(cell));
  }
  return row;
}

/// What stands in `defaults` goes to every asset that does not say otherwise.
void inherit(const Row& defaults, Row& row) {
  for (const Cell& cell : defaults.cells) {
    const bool own = std::any_of(row.cells.begin(), row.cells.end(),
                                 [&](const Cell& other) { return other.key == cell.key; });
    if (!own) row.cells.push_back(cell);
  }
}

std::vector<Row> rowsOfJson(const std::string& text, const std::string& name) {
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::parse_error& failure) {
    complain(name, lineAndColumn(text, failure.byte) + ": is not JSON");
  } catch (const Json::out_of_range&) {
    complain(name, "has a number that is too large");
  }
  if (!json.is_object() || !json.contains("assets") || !json.at("assets").is_array())
    complain(name, "must be an object with a list 'assets'");
  Row defaults;
  for (const auto& [key, value] : json.items()) {
    if (key == "assets") continue;
    if (key != "defaults") complain(name, "there is no part " + quoted(key) + "; there are assets, defaults");
    defaults = rowOf(value, name + ": defaults");
    for (const Cell& cell : defaults.cells) {
      if (findKey(cell.key) == nullptr) complain(defaults.place, unknownKey(cell.key));
      if (cell.key == "input" || cell.key == "output")
        complain(cell.place, "cannot be the same for all assets");
    }
  }
  std::vector<Row> rows;
  const Json& assets = json.at("assets");
  for (std::size_t k = 0; k < assets.size(); ++k) {
    rows.push_back(rowOf(assets[k], name + ": assets[" + std::to_string(k) + "]"));
    inherit(defaults, rows.back());
  }
  return rows;
}

// --- CSV ---

struct CsvLine {
  std::size_t number = 0;  // where it begins
  std::vector<std::string> cells;
};

/// Comma-separated values as in RFC 4180; lines without any text are left out.
std::vector<CsvLine> linesOfCsv(std::string_view text, const std::string& name) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.substr(0, kByteOrderMark.size()) == kByteOrderMark) text.remove_prefix(kByteOrderMark.size());
  std::vector<CsvLine> lines;
  CsvLine line{1, {""}};
  std::size_t number = 1;
  bool inQuotes = false;
  const auto endLine = [&] {
    if (line.cells.size() > 1 || !line.cells.front().empty()) lines.push_back(line);
    line = {number, {""}};
  };
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char letter = text[k];
    if (letter == '\n') ++number;
    if (inQuotes) {
      const bool doubled = letter == '"' && k + 1 < text.size() && text[k + 1] == '"';
      if (letter == '"' && !doubled) {
        inQuotes = false;
      } else {
        line.cells.back() += letter;
        if (doubled) ++k;
      }
    } else if (letter == '"' && line.cells.back().empty()) {
      inQuotes = true;
    } else if (letter == ',') {
      line.cells.emplace_back();
    } else if (letter == '\n') {
      endLine();
    } else if (letter != '\r') {
      line.cells.back() += letter;
    }
  }
  if (inQuotes) complain(name, "line " + std::to_string(line.number) + ": a quotation mark is never closed");
  endLine();
  return lines;
}

std::string trimmed(const std::string& text) {
  constexpr const char* kBlanks = " \t";
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

/// A cell of `instances` may list scales, with blanks between them.
Cell cellOfCsv(const std::string& key, const std::string& place, const std::string& text) {
  Cell cell{key, place, {text}, Cell::Kind::Any, false};
  if (key != "instances" || text.find(' ') == std::string::npos) return cell;
  cell.list = true;
  cell.values.clear();
  std::string word;
  for (const char letter : text + " ") {
    if (letter != ' ') {
      word += letter;
    } else if (!word.empty()) {
      cell.values.push_back(std::exchange(word, {}));
    }
  }
  return cell;
}

std::vector<Row> rowsOfCsv(const std::string& text, const std::string& name) {
  const std::vector<CsvLine> lines = linesOfCsv(text, name);
  if (lines.empty()) complain(name, "is empty: the first line must name the columns");
  std::vector<std::string> columns;
  for (const std::string& cell : lines.front().cells) {
    const std::string column = trimmed(cell);
    const std::string place = name + ": line " + std::to_string(lines.front().number);
    if (findKey(column) == nullptr) complain(place, unknownKey(column));
    if (std::find(columns.begin(), columns.end(), column) != columns.end())
      complain(place, "the column " + quoted(column) + " stands there twice");
    columns.push_back(column);
  }
  std::vector<Row> rows;
  for (std::size_t k = 1; k < lines.size(); ++k) {
    Row row{name + ": line " + std::to_string(lines[k].number), {}};
    if (lines[k].cells.size() != columns.size()) {
      complain(row.place, "has " + std::to_string(lines[k].cells.size()) + " cells, but there are " +
                              std::to_string(columns.size()) + " columns");
    }
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const std::string value = trimmed(lines[k].cells[c]);
      if (!value.empty()) row.cells.push_back(cellOfCsv(columns[c], row.place + ", " + columns[c], value));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

Result<std::vector<ManifestEntry>> readManifest(const fs::path& path) {
  const Result<std::string> text = readFile(path);
  if (!text) return text.error();
  try {
    const std::string name = path.string();
    const std::vector<Row> rows = endingOf(path) == ".csv" ? rowsOfCsv(*text, name) : rowsOfJson(*text, name);
    std::vector<ManifestEntry> entries;
    for (const Row& row : rows) entries.push_back(entryOf(row, path.parent_path()));
    if (entries.empty()) complain(name, "names no asset");
    return entries;
  } catch (const Complaint& complaint) {
    return Error{ErrorCode::InvalidArgument, complaint.what()};
  }
}

}  // namespace spheretree::io
