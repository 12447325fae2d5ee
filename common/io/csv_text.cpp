// Texts of tables that people and spreadsheets of several countries write: letters with accents, decimal marks.
#include <algorithm>
#include <cctype>
#include <utility>

#include "common/core/error.h"
#include "common/io/csv_file.h"

namespace softgrain::csv {

namespace {

bool is_digit_at(const std::string& text, std::size_t at) {
  return at < text.size() && std::isdigit(static_cast<unsigned char>(text[at])) != 0;
}

std::size_t digits_from(const std::string& text, std::size_t at) {
  std::size_t end = at;
  while (is_digit_at(text, end)) ++end;
  return end - at;
}

/// "1.250", "12.345.678" of this mark: groups of three digits behind one to three others, the first not 0.
bool in_thousands(const std::string& number, char mark) {
  std::size_t at = digits_from(number, 0);
  if (at == 0 || at > 3 || number[0] == '0' || at == number.size()) return false;
  for (; at < number.size(); at += 4)
    if (number[at] != mark || digits_from(number, at + 1) != 3) return false;
  return true;
}

/// Length of a blank or an apostrophe between thousands at `at`; 0: none.
std::size_t thousands_gap(const std::string& text, std::size_t begin, std::size_t at) {
  const std::size_t length = text.compare(at, 3, "\u2019") == 0 ? 3 : text[at] == ' ' || text[at] == '\'' ? 1 : 0;
  if (length == 0 || digits_from(text, at + length) != 3) return 0;
  const std::size_t after = at + length + 3;
  if (after < text.size() && text[after] == '/') return 0;  // "1 125/1000"
  const bool digits =
      std::all_of(text.begin() + static_cast<std::ptrdiff_t>(begin), text.begin() + static_cast<std::ptrdiff_t>(at),
                  [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; });
  return digits && at - begin <= 3 && text[begin] != '0' ? length : 0;
}

/// A number with its marks, without gaps between thousands, and where it ends in the text.
std::pair<std::string, std::size_t> number_at(const std::string& text, std::size_t begin) {
  std::string number;
  std::size_t group = begin;
  for (std::size_t at = begin; at < text.size();) {
    const bool mark = (text[at] == '.' || text[at] == ',') && is_digit_at(text, at + 1);
    if (is_digit_at(text, at) || mark) {
      number += text[at++];
      continue;
    }
    const std::size_t gap = thousands_gap(text, group, at);
    if (gap == 0) return {number, at};
    number += text.substr(at + gap, 3);
    at += gap + 3;
    group = at - 3;
  }
  return {number, text.size()};
}

/// Calls each(number) for every number of the text; puts together what it gives and the rest.
template <class Each>
std::string with_numbers(const std::string& text, Each each) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const bool begins = is_digit_at(text, at) || ((text[at] == '.' || text[at] == ',') && is_digit_at(text, at + 1));
    if (!begins) {
      out += text[at++];
      continue;
    }
    const auto [number, end] = number_at(text, at);
    out += each(number);
    at = end;
  }
  return out;
}

std::string without(std::string text, char mark) {
  std::erase(text, mark);
  return text;
}

/// "1,250E+03": no thousands are separated in such numbers.
bool has_exponent(const std::string& cell) {
  for (std::size_t at = 1; at + 1 < cell.size(); ++at)
    if ((cell[at] == 'e' || cell[at] == 'E') && is_digit_at(cell, at - 1) &&
        is_digit_at(cell, cell[at + 1] == '+' || cell[at + 1] == '-' ? at + 2 : at + 1))
      return true;
  return false;
}

std::string with_point(std::string text) {
  std::ranges::replace(text, ',', '.');
  return text;
}

}  // namespace

std::string two_readings(const std::string& number) {
  return "\"" + number + "\" may be " + with_point(number) + " or " + without(number, ',') +
         ": write it without the comma";
}

namespace {

/// Of a number that has both marks: the last one is the decimal mark if the other separates thousands.
std::string plain_of_both(const std::string& number) {
  const char decimal = number.find_last_of(',') > number.find_last_of('.') ? ',' : '.';
  const std::size_t at = number.find_last_of(decimal);
  const std::string whole = number.substr(0, at);
  const char other = decimal == ',' ? '.' : ',';
  if (!in_thousands(whole, other)) return number;  // whoever reads the number refuses it
  return without(whole, other) + "." + number.substr(at + 1);
}

std::string plain_number(const std::string& number, const DecimalMarks& marks) {
  const auto commas = std::ranges::count(number, ',');
  const auto points = std::ranges::count(number, '.');
  if (commas > 0 && points > 0) return plain_of_both(number);
  if (commas + points == 0) return number;
  const char mark = commas > 0 ? ',' : '.';
  const bool thousands = in_thousands(number, mark);
  if (commas + points > 1) return thousands ? without(number, mark) : number;
  const bool other_shown = mark == ',' ? marks.point : marks.comma;
  const bool this_shown = mark == ',' ? marks.comma : marks.point;
  if (thousands && other_shown && !this_shown) return without(number, mark);
  if (thousands && mark == ',' && marks.comma_may_separate_thousands && !this_shown)
    throw InputError(two_readings(number));
  return with_point(number);
}

}  // namespace

std::string folded(std::string text) {
  constexpr std::pair<const char*, const char*> kLetters[] = {
      {"ä", "ae"},       {"Ä", "ae"},      {"ö", "oe"},     {"Ö", "oe"},     {"ü", "ue"},     {"Ü", "ue"},
      {"ß", "ss"},       {"é", "e"},       {"É", "e"},      {"è", "e"},      {"È", "e"},      {"ê", "e"},
      {"Ê", "e"},        {"à", "a"},       {"À", "a"},      {"â", "a"},      {"ç", "c"},      {"î", "i"},
      {"ô", "o"},        {"û", "u"},       {"\u00b5", "u"}, {"\u03bc", "u"}, {"Φ", "phi"},    {"φ", "phi"},
      {"\u03d5", "phi"}, {"Σ", "sum"},     {"Ø", "d"},      {"ø", "d"},      {"°", "o"},      {"º", "o"},
      {"½", " 1/2"},     {"¼", " 1/4"},    {"¾", " 3/4"},   {"⅜", " 3/8"},   {"⅝", " 5/8"},   {"⅞", " 7/8"},
      {"″", "\""},       {"\u201d", "\""}, {"\u2013", "-"}, {"\u2014", "-"}, {"\u2264", "<"}, {"\u2265", ">"}};
  for (const auto& [from, to] : kLetters)
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at))
      text.replace(at, std::string(from).size(), to);
  return lower(text);
}

DecimalMarks decimal_marks(const std::vector<std::string>& cells, char separator) {
  DecimalMarks marks;
  marks.comma_may_separate_thousands = separator != ';';
  for (const std::string& cell : cells)
    (void)with_numbers(cell, [&](const std::string& number) {
      const std::size_t last = number.find_last_of(".,");
      if (last == std::string::npos) return number;
      const bool both = number.find(number[last] == ',' ? '.' : ',') != std::string::npos;
      if (both || has_exponent(cell) || !in_thousands(number, number[last]))
        (number[last] == ',' ? marks.comma : marks.point) = true;
      return number;
    });
  return marks;
}

std::string plain_numbers(const std::string& cell, const DecimalMarks& marks) {
  return with_numbers(cell, [&](const std::string& number) { return plain_number(number, marks); });
}

}  // namespace softgrain::csv
