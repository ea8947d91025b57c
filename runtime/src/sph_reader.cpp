// SPDX-License-Identifier: MIT
//
// Reads every `.sph` dialect of docs/file-format.md, and survives anything else.
//
// One pass, one line at a time, and not one byte further than the caller asked for: the rows are
// breadth-first, so the first K levels are a prefix of the text. Nothing is sized by what the header says
// before the bytes that are present have been found able to hold it.

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <system_error>

#include <spheretree/sph.hpp>

#include "sph_table.hpp"

namespace spheretree {

namespace {

constexpr std::size_t kBallNumbers = 4;  // x y z radius; what follows them in a row is not used
constexpr std::size_t kShortestRow = 8;  // "0 0 0 1\n": what a row costs at least, in bytes
constexpr std::size_t kLongestQuote = 24;
constexpr std::string_view kAudioMagic = "NIST_1A";
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr const char* kBinary = "binary content, not the text of a sphere tree";

/// Four numbers; with importance, five; with an auxiliary sphere as well, ten.
bool isRowLength(std::size_t numbers) noexcept {
  return numbers == 4 || numbers == 5 || numbers == 10;
}

bool isBlank(char c) noexcept {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}
bool isDigit(char c) noexcept {
  return c >= '0' && c <= '9';
}
bool isSign(char c) noexcept {
  return c == '-' || c == '+';
}

Error unreadable(std::size_t line, const std::string& reason) {
  return {ErrorCode::UnreadableInput, "line " + std::to_string(line) + ": " + reason};
}

/// A few characters of hostile text, fit for a message.
std::string quote(std::string_view text) {
  const bool cut = text.size() > kLongestQuote;
  std::string quoted = "'";
  for (const char c : text.substr(0, kLongestQuote)) quoted += c >= ' ' && c <= '~' ? c : '?';
  return quoted + (cut ? "...'" : "'");
}

/// Whether a decimal number that float cannot hold is too small rather than too large: where its first
/// significant digit stands decides.
bool isTiny(std::string_view number) noexcept {
  constexpr std::int64_t kFarAway = 1'000'000'000;  // beyond any float, far from overflowing
  const std::size_t mantissaEnd = std::min(number.find_first_of("eE"), number.size());
  const std::string_view mantissa = number.substr(0, mantissaEnd);
  const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
  const std::size_t leading = mantissa.find_first_of("123456789");
  if (leading == std::string_view::npos) return true;
  const std::int64_t place = static_cast<std::int64_t>(point) - static_cast<std::int64_t>(leading);
  if (mantissaEnd == number.size()) return place <= 0;
  std::string_view digits = number.substr(mantissaEnd + 1);
  const bool negative = digits.starts_with('-');
  if (!digits.empty() && isSign(digits.front())) digits.remove_prefix(1);
  std::int64_t exponent = 0;
  for (const char digit : digits) exponent = std::min(kFarAway, exponent * 10 + (digit - '0'));
  return place + (negative ? -exponent : exponent) <= 0;
}

enum class LineKind : std::uint8_t {
  Row,     ///< numbers and nothing else, however many
  Text,    ///< does not begin like a number
  Broken,  ///< begins like a number, but is no row; Scanner::reason() says why
  End      ///< nothing but blank lines is left
};

/// One line that is not blank.
struct Line {
  LineKind kind = LineKind::End;
  std::size_t number = 0;                     ///< counted from 1
  bool closed = false;                        ///< ended by a line break, not by the end of the text
  std::size_t count = 0;                      ///< numbers in a row
  std::array<float, kBallNumbers> numbers{};  ///< the first of them
};

/// Walks over the text line by line. Touches no byte beyond the line that was asked for.
class Scanner {
 public:
  explicit Scanner(std::string_view text) noexcept : at_(text.data()), end_(at_ + text.size()) {}

  [[nodiscard]] std::string_view rest() const noexcept { return {at_, static_cast<std::size_t>(end_ - at_)}; }
  /// The line of rest()'s first byte, counted from 1.
  [[nodiscard]] std::size_t lineNumber() const noexcept { return line_; }
  [[nodiscard]] const std::string& reason() const noexcept { return reason_; }

  void skipBlankLines() noexcept;
  /// Reads the next line that is not blank. Stands at its beginning after Text, inside it after Broken.
  Line readLine();
  /// The bytes up to the next line break, without it, and moves on to the line after.
  std::string_view takeLine() noexcept;

 private:
  [[nodiscard]] bool atLineEnd() const noexcept;
  bool skipLineEnd() noexcept;
  void skipBlanks() noexcept {
    while (at_ != end_ && isBlank(*at_)) ++at_;
  }
  [[nodiscard]] std::string_view token() const noexcept;
  [[nodiscard]] bool atNumber() const noexcept;
  std::optional<float> readNumber();

  const char* at_;
  const char* end_;
  std::size_t line_ = 1;
  std::string reason_;
};

bool Scanner::atLineEnd() const noexcept {
  const char* p = at_;
  while (p != end_ && *p == '\r') ++p;
  return p == end_ || *p == '\n';
}

/// Call at a line end only. False at the end of the text.
bool Scanner::skipLineEnd() noexcept {
  while (at_ != end_ && *at_ == '\r') ++at_;
  if (at_ == end_) return false;
  ++at_;
  ++line_;
  return true;
}

void Scanner::skipBlankLines() noexcept {
  const char* lineStart = at_;
  for (;;) {
    skipBlanks();
    if (!atLineEnd()) break;
    if (!skipLineEnd()) return;
    lineStart = at_;
  }
  at_ = lineStart;
}

std::string_view Scanner::takeLine() noexcept {
  const std::string_view left = rest();
  const std::size_t length = std::min(left.find('\n'), left.size());
  std::string_view line = left.substr(0, length);
  at_ += length;
  if (at_ != end_) {
    ++at_;
    ++line_;
  }
  while (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

/// The word that begins here, as much of it as a message quotes.
std::string_view Scanner::token() const noexcept {
  const std::string_view word = rest().substr(0, kLongestQuote + 1);
  return word.substr(0, std::min(word.find_first_of(std::string_view(" \t\v\f\r\n\0", 7)), word.size()));
}

/// Whether a word is meant as a number. Words such as "-----", "Info" or "..." are not.
bool Scanner::atNumber() const noexcept {
  const std::string_view next = rest().substr(0, 2);
  if (isDigit(next.front()) || (next.size() > 1 && isSign(next[0]) && isDigit(next[1]))) return true;
  std::string_view word = token();
  const bool last = word.size() == rest().size();  // maybe a number that was cut off
  if (!word.empty() && isSign(word.front())) {
    word.remove_prefix(1);
    if (word.empty()) return last;
  }
  if (word.empty()) return false;
  if (word.front() == '.') return word.size() == 1 ? last : isDigit(word[1]);
  std::string lower;
  for (const char c : word) lower += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return lower == "nan" || lower == "inf" || lower == "infinity" || lower.starts_with("nan(");
}

std::optional<float> Scanner::readNumber() {
  const char* first = at_;
  if (isDigit(*first) && (end_ - first == 1 || isBlank(first[1]) || first[1] == '\n')) {
    ++at_;  // a single digit: every importance and all of an unused row in our own dialect
    return static_cast<float>(*first - '0');
  }
  if (*first == '+' && first + 1 != end_ && !isSign(first[1])) ++first;
  float value = 0;
  const auto [last, code] = std::from_chars(first, end_, value);
  const bool whole = last == end_ || isBlank(*last) || *last == '\n' || *last == '\r';
  if (code == std::errc::invalid_argument || !whole) {
    const std::size_t length = token().size();
    const bool binary = length < rest().size() && rest()[length] == '\0';
    reason_ = binary ? kBinary : quote(token()) + " is not a number";
    return std::nullopt;
  }
  if (code == std::errc::result_out_of_range) {
    const bool tiny = isTiny({first, static_cast<std::size_t>(last - first)});
    if (!tiny) {
      reason_ = quote(token()) + " is too large for single precision";
      return std::nullopt;
    }
    value = *first == '-' ? -0.0F : 0.0F;
  }
  if (!std::isfinite(value)) {
    reason_ = quote(token()) + " is not a finite number";
    return std::nullopt;
  }
  at_ = last;
  return value;
}

Line Scanner::readLine() {
  Line line;
  skipBlankLines();
  skipBlanks();
  line.number = line_;
  if (at_ == end_) return line;
  if (!atNumber()) {
    line.kind = LineKind::Text;
    return line;
  }
  while (!atLineEnd()) {
    const std::optional<float> number = readNumber();
    if (!number) {
      line.kind = LineKind::Broken;
      return line;
    }
    if (line.count < kBallNumbers) line.numbers[line.count] = *number;
    ++line.count;
    skipBlanks();
  }
  line.closed = skipLineEnd();
  line.kind = LineKind::Row;
  return line;
}

/// What the first line announces.
struct Header {
  std::uint64_t levels = 0;
  std::uint32_t branch = 0;
  std::size_t line = 1;
};

/// Why the text does not begin with a header, as helpful as its first bytes allow.
std::string describeForeign(std::string_view text) {
  constexpr std::size_t kSniffed = 1024;
  if (text.substr(0, kSniffed).find('\0') != std::string_view::npos) return kBinary;
  const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
  return "expected the two whole numbers 'levels branch' of a sphere tree, found " + quote(line) +
         " (speech audio and antenna data use the extension .sph as well)";
}

/// A whole number of any size, clamped to 64 bits; nothing for any other word.
std::optional<std::int64_t> parseWhole(std::string_view word) noexcept {
  if (word.starts_with('+') && word.size() > 1 && isDigit(word[1])) word.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (code == std::errc::invalid_argument || end != word.data() + word.size()) return std::nullopt;
  if (code == std::errc{}) return value;
  using Limits = std::numeric_limits<std::int64_t>;
  return word.starts_with('-') ? Limits::min() : Limits::max();
}

/// The words of a line, at most three: one more than a header has.
std::vector<std::string_view> firstWords(std::string_view line) {
  std::vector<std::string_view> words;
  while (words.size() < 3) {
    while (!line.empty() && isBlank(line.front())) line.remove_prefix(1);
    if (line.empty()) break;
    const std::size_t length = std::min(line.find_first_of(" \t\v\f"), line.size());
    words.push_back(line.substr(0, length));
    line.remove_prefix(length);
  }
  return words;
}

Result<Header> readHeader(Scanner& scanner) {
  scanner.skipBlankLines();
  Header header;
  header.line = scanner.lineNumber();
  const std::string_view text = scanner.rest();
  if (text.empty()) return unreadable(header.line, "the file is empty");
  if (text.starts_with(kAudioMagic)) {
    return unreadable(header.line,
                      "this is NIST SPHERE speech audio, which uses the extension .sph as well, "
                      "not a sphere tree");
  }
  const std::vector<std::string_view> words = firstWords(scanner.takeLine());
  if (words.size() != 2) return unreadable(header.line, describeForeign(text));
  const std::optional<std::int64_t> levels = parseWhole(words[0]);
  const std::optional<std::int64_t> branch = parseWhole(words[1]);
  if (!levels || !branch) return unreadable(header.line, describeForeign(text));
  if (*levels < 1) return unreadable(header.line, "a tree has at least 1 level, not " + quote(words[0]));
  if (*branch < 1) {
    return unreadable(header.line, "the branching factor is at least 1, not " + quote(words[1]));
  }
  if (*branch > std::numeric_limits<std::uint32_t>::max()) {
    return unreadable(header.line, "the branching factor " + quote(words[1]) + " is out of range");
  }
  header.levels = static_cast<std::uint64_t>(*levels);
  header.branch = static_cast<std::uint32_t>(*branch);
  return header;
}

/// The rows of the wanted levels, if the header can be honest about them.
Result<std::size_t> wantedRows(const Header& header, std::uint64_t wantedLevels, std::size_t bytesLeft) {
  const std::string announced = "the header announces " + std::to_string(header.levels) +
                                " levels of branching factor " + std::to_string(header.branch);
  if (!sphRowCount(header.levels, header.branch)) {
    return unreadable(header.line, announced + ", more rows than can be counted");
  }
  const std::uint64_t rows = *sphRowCount(wantedLevels, header.branch);
  const std::uint64_t possible =
      (std::uint64_t{bytesLeft} + 1) / kShortestRow;  // the last break may be missing
  if (rows > possible) {
    return unreadable(header.line, announced + ": " + std::to_string(rows) + " rows do not fit in the " +
                                       std::to_string(bytesLeft) + " bytes that follow, which hold at most " +
                                       std::to_string(possible));
  }
  if (rows >= kNoParent) return unreadable(header.line, announced + ", more rows than a tree can index");
  return static_cast<std::size_t>(rows);
}

/// The used slots of a table, in file order, ready for SphereTree::create.
class Table {
 public:
  Table(std::size_t rows, std::uint32_t branch) : branch_(branch), parents_((rows - 1) / branch) {
    entries_.reserve(rows);
    nodeOfSlot_.reserve(parents_);
  }

  /// Takes the next slot. False when its ball hangs below an unused one, or is an unused root.
  bool add(const Sphere& ball) {
    const std::size_t slot = slots_++;
    const bool unused = std::signbit(ball.radius) || (ball.radius == 0 && ball.center == Vec3{});
    if (slot < parents_) {
      nodeOfSlot_.push_back(unused ? kNoParent : static_cast<std::uint32_t>(entries_.size()));
    }
    if (unused) return slot > 0;
    const std::uint32_t parent = slot == 0 ? kNoParent : nodeOfSlot_[parentOf(slot)];
    if (slot > 0 && parent == kNoParent) return false;
    entries_.push_back({ball, parent});
    return true;
  }

  /// Slots taken so far.
  [[nodiscard]] std::size_t slots() const noexcept { return slots_; }
  [[nodiscard]] std::size_t parentOf(std::size_t slot) const noexcept { return (slot - 1) / branch_; }
  [[nodiscard]] std::span<const SphereTree::Entry> entries() const noexcept { return entries_; }

 private:
  std::uint32_t branch_;
  std::size_t parents_;  // slots that have children in the table
  std::size_t slots_ = 0;
  std::vector<SphereTree::Entry> entries_;
  std::vector<std::uint32_t> nodeOfSlot_;  // of the parents
};

/// Reads rows until the table is full, or ends early where it may: between two rows.
Result<Table> readTable(Scanner& scanner, const Header& header, std::size_t rows) {
  Table table(rows, header.branch);
  const auto position = [&] {
    return "row " + std::to_string(table.slots() + 1) + " of the " + std::to_string(rows) + " announced";
  };
  std::size_t previousCount = 0;
  while (table.slots() < rows) {
    const Line line = scanner.readLine();
    if (line.kind == LineKind::Broken) return unreadable(line.number, scanner.reason());
    if (line.kind != LineKind::Row) {
      if (table.slots() > 0) break;
      return unreadable(line.number, "the table ends before " + position());
    }
    const bool last = table.slots() + 1 == rows;
    if (!line.closed && (!last || line.count < previousCount || !isRowLength(line.count))) {
      return unreadable(line.number, "the text ends in the middle of " + position());
    }
    if (!isRowLength(line.count)) {
      return unreadable(line.number,
                        position() + " has " + std::to_string(line.count) + " numbers, not 4, 5 or 10");
    }
    const auto& [x, y, z, radius] = line.numbers;
    if (!table.add({{x, y, z}, radius})) {
      const std::size_t slot = table.slots() - 1;
      if (slot == 0) return unreadable(line.number, "the root is an unused slot");
      return unreadable(line.number, "the used row " + std::to_string(slot + 1) +
                                         " hangs below the unused row " +
                                         std::to_string(table.parentOf(slot) + 1));
    }
    previousCount = line.count;
  }
  return table;
}

/// Splits `# key: value`. Nothing for any other line, plain comments included. The value is kept to the
/// letter.
std::optional<std::pair<std::string_view, std::string_view>> splitMetadata(std::string_view line) noexcept {
  while (!line.empty() && isBlank(line.front())) line.remove_prefix(1);
  if (!line.starts_with('#')) return std::nullopt;
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos) return std::nullopt;
  std::string_view key = line.substr(1, colon - 1);
  while (!key.empty() && isBlank(key.front())) key.remove_prefix(1);
  while (!key.empty() && isBlank(key.back())) key.remove_suffix(1);
  if (key.empty()) return std::nullopt;
  std::string_view value = line.substr(colon + 1);
  if (value.starts_with(' ')) value.remove_prefix(1);
  return std::pair{key, value};
}

/// Counted before anything is kept: growing a list of strings would cost more than the text justifies.
std::size_t countMetadata(std::string_view text) noexcept {
  std::size_t count = 0;
  for (Scanner lines(text); !lines.rest().empty();) {
    if (splitMetadata(lines.takeLine())) ++count;
  }
  return count;
}

bool isRow(std::string_view line) {
  const Line read = Scanner(line).readLine();
  return read.kind == LineKind::Row && isRowLength(read.count);
}

/// What follows the table, as far as it concerns us.
struct Trailer {
  std::vector<std::pair<std::string, std::string>> metadata;
  std::size_t extraRows = 0;  ///< rows that follow the table at once
  std::size_t firstExtraLine = 0;
};

/// Looks through everything behind the table. Rows behind a table that ended too early mean that the line
/// where it ended was a damaged row, not the end: refused, for the tree would lose its tail unnoticed.
Result<Trailer> readTrailer(Scanner& scanner, bool tableIsShort) {
  const std::string_view text = scanner.rest();
  if (const std::size_t at = text.find('\0'); at != std::string_view::npos) {
    const auto breaks = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    return unreadable(scanner.lineNumber() + static_cast<std::size_t>(breaks), kBinary);
  }
  Trailer trailer;
  trailer.metadata.reserve(countMetadata(text));
  const std::size_t endOfTable = scanner.lineNumber();
  bool behindText = tableIsShort;
  for (scanner.skipBlankLines(); !scanner.rest().empty(); scanner.skipBlankLines()) {
    const std::size_t lineNumber = scanner.lineNumber();
    const std::string_view line = scanner.takeLine();
    if (const auto pair = splitMetadata(line)) trailer.metadata.emplace_back(pair->first, pair->second);
    if (behindText && !tableIsShort) continue;
    if (!isRow(line)) {
      behindText = true;
      continue;
    }
    if (tableIsShort) {
      return unreadable(endOfTable,
                        "not a row of numbers, yet rows follow on line " + std::to_string(lineNumber));
    }
    if (trailer.extraRows++ == 0) trailer.firstExtraLine = lineNumber;
  }
  return trailer;
}

}  // namespace

Result<SphFile> parseSph(std::string_view text, SphLoadLimits limits) {
  if (limits.levels < 1) return Error{ErrorCode::InvalidArgument, "a tree cannot be loaded without its root"};
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  Scanner scanner(text);
  const Result<Header> header = readHeader(scanner);
  if (!header) return header.error();
  const bool wholeFile = limits.levels >= header->levels;
  const std::uint64_t levels = wholeFile ? header->levels : limits.levels;
  const Result<std::size_t> rows = wantedRows(*header, levels, scanner.rest().size());
  if (!rows) return rows.error();
  const Result<Table> table = readTable(scanner, *header, *rows);
  if (!table) return table.error();
  Result<SphereTree> tree = SphereTree::create(table->entries());
  if (!tree) return Error{ErrorCode::Internal, tree.error().message};

  SphFile file{std::move(tree).value(), header->branch, {}, {}};
  const std::size_t missing = *rows - table->slots();
  if (!wholeFile && missing == 0) return file;
  const std::size_t endOfTable = scanner.lineNumber();
  Result<Trailer> trailer = readTrailer(scanner, missing > 0);
  if (!trailer) return trailer.error();
  if (wholeFile) file.metadata = std::move(trailer->metadata);
  if (missing > 0) {
    file.warnings.push_back("line " + std::to_string(endOfTable) + ": the header announces " +
                            std::to_string(*rows) + " rows, the file holds " +
                            std::to_string(table->slots()) + "; the missing " + std::to_string(missing) +
                            " are taken as unused");
  }
  if (trailer->extraRows > 0) {
    file.warnings.push_back("line " + std::to_string(trailer->firstExtraLine) + ": the header announces " +
                            std::to_string(*rows) + " rows, the file holds " +
                            std::to_string(*rows + trailer->extraRows) + "; the last " +
                            std::to_string(trailer->extraRows) + " are ignored");
  }
  return file;
}

}  // namespace spheretree
