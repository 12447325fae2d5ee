// Comments of tables that name a value.
#include <algorithm>
#include <cctype>
#include <cmath>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/io/csv_file.h"
#include "common/io/text_file.h"

namespace softgrain {

namespace {

constexpr std::size_t kLongestName = 40;

/// Names that a single slip can turn into one another say nothing about each other.
constexpr std::size_t kLeastLetters = 4;

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || (c & 0x80) != 0; }

std::vector<std::string> words_of(const std::string& text, const char* separators = " \t") {
  std::vector<std::string> out;
  for (std::size_t at = text.find_first_not_of(separators); at != std::string::npos;) {
    const std::size_t end = std::min(text.find_first_of(separators, at), text.size());
    out.push_back(text.substr(at, end - at));
    at = text.find_first_not_of(separators, end);
  }
  return out;
}

/// A few words that can be the name of a quantity, no sentence.
bool is_name(const std::string& text, bool with_unit) {
  if (text.empty() || text.size() > kLongestName || !is_letter(text.front())) return false;
  const bool plain = std::ranges::all_of(
      text, [](char c) { return is_letter(c) || is_digit(c) || std::string(" _-/'.").find(c) != std::string::npos; });
  return plain && words_of(text).size() <= (with_unit ? 6U : 3U);
}

/// Length of the number that a word begins with; 0: none.
std::size_t number_length(const std::string& word) {
  std::size_t at = word.find_first_not_of("+-");
  if (at > 1 || at == std::string::npos) return 0;
  const std::size_t digits = at;
  while (at < word.size() && (is_digit(word[at]) || word[at] == '.' || word[at] == ',')) ++at;
  if (std::none_of(word.begin() + static_cast<std::ptrdiff_t>(digits), word.begin() + static_cast<std::ptrdiff_t>(at),
                   is_digit))
    return 0;
  if (std::count(word.begin(), word.begin() + static_cast<std::ptrdiff_t>(at), '.') > 1) return 0;  // a date
  if (at < word.size() && (word[at] == 'e' || word[at] == 'E')) {
    std::size_t end = at + 1;
    if (end < word.size() && (word[end] == '+' || word[end] == '-')) ++end;
    if (end < word.size() && is_digit(word[end])) {
      while (end < word.size() && is_digit(word[end])) ++end;
      at = end;
    }
  }
  return at;
}

bool is_unit_word(const std::string& word) {
  return !word.empty() && word.size() <= 12 &&
         (is_letter(word.front()) || word.front() == '%' || word.starts_with("1/"));
}

/// Numbers, and perhaps a unit behind the last.
bool is_quantity(const std::string& value) {
  const std::vector<std::string> words = words_of(value, " \t,;[]()");
  if (words.empty()) return false;
  for (std::size_t k = 0; k < words.size(); ++k) {
    const std::size_t length = number_length(words[k]);
    if (length == words[k].size()) continue;
    if (k + 1 != words.size()) return false;
    return length > 0 ? is_unit_word(words[k].substr(length)) : k > 0 && is_unit_word(words[k]);
  }
  return true;
}

/// The known name that this one was probably meant to be; empty: none.
std::string near_name(const std::string& key, const std::vector<std::string>& known) {
  std::vector<std::string> long_names;
  for (const std::string& name : known) {
    if (name.size() < kLeastLetters) continue;
    long_names.push_back(name);
    const std::vector<std::string> parts = words_of(key);
    if (std::ranges::find(parts, name) != parts.end()) return name;
    if ((" " + key + " ").find(" " + name + " ") != std::string::npos) return name;
  }
  return key.size() < kLeastLetters ? "" : nearest_word(key, long_names);
}

bool same_text(const std::string& a, const std::string& b) { return csv::lower(a) == csv::lower(b); }

bool same_values(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr double kRounding = 1e-9;
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) {
    return std::abs(x - y) <= kRounding * std::max(std::abs(x), std::abs(y));
  });
}

/// Where numbers begin that follow a name without a sign between: "Rs [mm] 16"; npos: no such text.
std::size_t bare_value(const std::string& text) {
  for (std::size_t at = text.find_first_of(" \t])"); at != std::string::npos;
       at = text.find_first_of(" \t])", at + 1)) {
    const std::size_t next = text.find_first_not_of(" \t", at + 1);
    if (next == std::string::npos || number_length(text.substr(next)) == 0) continue;
    const bool value = is_quantity(text.substr(next));
    return value ? next : std::string::npos;
  }
  return std::string::npos;
}

}  // namespace

void CsvFile::read_comment(const std::string& line, int number) {
  std::string words = trimmed(line.substr(std::min(line.find_first_not_of('#'), line.size())));
  const std::size_t last = words.find_last_not_of(";,\t ");  // a spreadsheet fills up all lines
  words.resize(last == std::string::npos ? 0 : last + 1);
  const std::size_t equals = words.find('=');
  if (equals != std::string::npos)
    if (const std::size_t colon = words.rfind(':', equals);
        colon != std::string::npos && is_name(trimmed(words.substr(colon + 1, equals - colon - 1)), true))
      words = trimmed(words.substr(colon + 1));  // "material: E = 0.5 MPa"
  const std::vector<std::string> parts = words_of(words, ",;");
  const bool several = equals != std::string::npos && std::ranges::all_of(parts, [](const std::string& p) {
                         return p.find_first_of("=:") != std::string::npos;
                       });
  if (!several) return read_setting(words, number);
  for (const std::string& part : parts) read_setting(trimmed(part), number);  // "Rs = 16 mm, E = 0.5 MPa"
}

void CsvFile::read_setting(const std::string& text, int number) {
  std::size_t mark = text.find('=');
  const bool equals = mark != std::string::npos;
  if (!equals) mark = text.find(':');
  CsvSetting s;
  s.equals = equals;
  s.line = number;
  s.bare = mark == std::string::npos;
  if (s.bare) mark = bare_value(text);
  if (mark == std::string::npos) return;
  s.title = trimmed(text.substr(0, mark));
  s.value = csv::unquoted(trimmed(text.substr(s.bare ? mark : mark + 1)));
  const CsvColumn named = csv::column_of(s.title);
  s.unit = named.unit;
  const std::string name = named.unit.empty() ? s.title : trimmed(s.title.substr(0, s.title.find_first_of("[(")));
  if (!is_name(name, !s.unit.empty()) && (!equals || name.empty()))
    return;  // with "=" it may say a value none the less
  s.key = csv::plain_name(name);
  settings_.push_back(std::move(s));
}

std::vector<CsvSetting> CsvFile::all_of(const CsvNames& names) const {
  std::vector<CsvSetting> found;
  for (const CsvSetting& s : settings_)
    if (std::ranges::find(names, s.key) != names.end()) found.push_back(s);
  return found;
}

std::optional<CsvSetting> CsvFile::setting(const CsvNames& names) const {
  const std::vector<CsvSetting> found = all_of(names);
  return found.empty() ? std::nullopt : std::optional(found.front());
}

std::optional<CsvSetting> CsvFile::word(const CsvNames& names) const {
  const std::vector<CsvSetting> found = all_of(names);
  if (found.empty()) return std::nullopt;
  for (const CsvSetting& s : found)
    if (!same_text(s.value, found.front().value))
      throw InputError(where(s.line) + ": " + s.title + " = " + s.value + ": line " +
                       std::to_string(found.front().line) + " says " + found.front().value +
                       "; what a comment says holds for the whole file, so leave one of them out");
  return found.front();
}

std::vector<double> CsvFile::values_of(const CsvSetting& s, Unit unit, std::size_t count) const {
  const auto complain = [&](const std::string& problem) {
    throw InputError(where(s.line) + ": " + s.title + " = " + s.value + ": " + problem);
  };
  // Where the table itself has decimal commas, a comma between digits is one.
  std::string text = s.value;
  if (separator_ != ',' && words_of(text).size() >= count) std::replace(text.begin(), text.end(), ',', '.');
  std::vector<std::string> words = words_of(text, count > 1 ? " \t,;[]()" : " \t");
  std::string own;  // unit behind the numbers
  if (!words.empty() && number_length(words.back()) < words.back().size()) {
    const std::size_t length = number_length(words.back());
    own = words.back().substr(length);
    words.back().resize(length);
    if (length == 0) words.pop_back();
  }
  if (words.size() != count)
    complain(count == 1 ? "must be a number, or a number with a unit such as \"16 mm\""
                        : "must be " + std::to_string(count) + " numbers");
  std::vector<double> out;
  try {
    if (!own.empty() && !s.unit.empty() && parse_quantity("1 " + own, unit) != parse_quantity("1 " + s.unit, unit))
      complain("the name says the unit " + s.unit + ", the value " + own + ": give one");
    const std::string& given = own.empty() ? s.unit : own;
    const bool percent = unit == Unit::none && is_percent(given);
    for (const std::string& word : words)
      out.push_back(parse_quantity(percent || given.empty() || (unit == Unit::none && (given == "1" || given == "-"))
                                       ? word
                                       : word + " " + given,
                                   unit) /
                    (percent ? 100.0 : 1.0));
  } catch (const InputError& e) {
    const std::string what = e.what();
    if (what.starts_with(path_)) throw;
    complain(what);
  }
  return out;
}

std::optional<std::vector<double>> CsvFile::quantities(const CsvNames& names, Unit unit, std::size_t count) const {
  const std::vector<CsvSetting> found = all_of(names);
  if (found.empty()) return std::nullopt;
  const std::vector<double> first = values_of(found.front(), unit, count);
  for (const CsvSetting& s : found)
    if (!same_values(values_of(s, unit, count), first))
      throw InputError(where(s.line) + ": " + s.title + " = " + s.value + ": contradicts line " +
                       std::to_string(found.front().line) + ", " + found.front().title + " = " + found.front().value +
                       "; what a comment says holds for the whole file: leave one out, or write a file for each");
  return first;
}

std::optional<double> CsvFile::quantity(const CsvNames& names, Unit unit, const Range& range) const {
  const auto values = quantities(names, unit, 1);
  if (!values) return std::nullopt;
  const double value = values->front();
  if (value >= range.low && value <= range.high && !(range.low_open && value == range.low) &&
      !(range.high_open && value == range.high))
    return value;
  const CsvSetting s = *setting(names);
  std::string allowed =
      std::string("must be ") + (range.low_open ? "above " : "at least ") + rounded_text(range.low, {6});
  if (std::isfinite(range.high))
    allowed += std::string(" and ") + (range.high_open ? "below " : "at most ") + rounded_text(range.high, {6});
  throw InputError(where(s.line) + ": " + s.title + " = " + s.value + ": " + allowed);
}

void CsvFile::require_known_comments(const std::vector<CsvNames>& known, const std::string& what) const {
  std::vector<std::string> names;
  for (const CsvNames& one : known) names.insert(names.end(), one.begin(), one.end());
  const std::string first_names = join_text(known, ", ", [](const CsvNames& one) { return one.front(); });
  for (const CsvSetting& s : settings_) {
    if (std::ranges::find(names, s.key) != names.end()) continue;
    const std::string near = near_name(s.key, names);
    const bool number = is_quantity(s.value);
    if (s.bare && s.unit.empty()) continue;
    const bool says_value = number && (s.equals || !s.unit.empty());
    const bool slip = near.size() <= s.key.size() + 1 && s.key.size() <= near.size() + 1;  // of a word: "knid"
    if (!says_value && (near.empty() || !(number || (s.equals && slip)))) continue;
    const std::string meant = near.empty() ? nearest_word(s.key, names) : near;
    throw InputError(where(s.line) + ": comment \"" + s.title +
                     (s.bare     ? " "
                      : s.equals ? " = "
                                 : ": ") +
                     s.value + "\" is not understood" + (meant.empty() ? "" : "; nearest is \"" + meant + "\"") +
                     ": comments of " + what + (names.empty() ? " say no values" : " may say " + first_names) +
                     "; write anything else as text without \"=\"");
  }
}

}  // namespace softgrain
