#include "common/packing/sieve_size.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <string_view>

#include "common/core/error.h"
#include "common/io/csv_file.h"
#include "common/io/scene.h"
#include "common/io/text_file.h"

namespace softgrain {

namespace {

constexpr double kInch = 25.4e-3;  // [m]

/// Openings of ASTM E11 by their numbers [um].
const std::map<std::string, double>& astm_numbers() {
  static const std::map<std::string, double> all{
      {"3 1/2", 5600}, {"4", 4750},  {"5", 4000},  {"6", 3350},  {"7", 2800}, {"8", 2360}, {"10", 2000},
      {"12", 1700},    {"14", 1400}, {"16", 1180}, {"18", 1000}, {"20", 850}, {"25", 710}, {"30", 600},
      {"35", 500},     {"40", 425},  {"45", 355},  {"50", 300},  {"60", 250}, {"70", 212}, {"80", 180},
      {"100", 150},    {"120", 125}, {"140", 106}, {"170", 90},  {"200", 75}, {"230", 63}, {"270", 53},
      {"325", 45},     {"400", 38},  {"450", 32},  {"500", 25},  {"635", 20}};
  return all;
}

/// Openings of the Tyler series by mesh [um].
const std::map<std::string, double>& tyler_mesh() {
  static const std::map<std::string, double> all{
      {"3 1/2", 5600}, {"4", 4750},  {"5", 4000},  {"6", 3350},  {"7", 2800}, {"8", 2360}, {"9", 2000},
      {"10", 1700},    {"12", 1400}, {"14", 1180}, {"16", 1000}, {"20", 850}, {"24", 710}, {"28", 600},
      {"32", 500},     {"35", 425},  {"42", 355},  {"48", 300},  {"60", 250}, {"65", 212}, {"80", 180},
      {"100", 150},    {"115", 125}, {"150", 106}, {"170", 90},  {"200", 75}, {"250", 63}, {"270", 53},
      {"325", 45},     {"400", 38},  {"450", 32},  {"500", 25},  {"635", 20}};
  return all;
}

/// Openings of ASTM E11 by their names in inches [mm].
const std::map<std::string, double>& astm_inches() {
  static const std::map<std::string, double> all{
      {"4", 100},      {"3 1/2", 90},   {"3", 75},    {"2 1/2", 63}, {"2", 50},   {"1 3/4", 45},
      {"1 1/2", 37.5}, {"1 1/4", 31.5}, {"1", 25},    {"7/8", 22.4}, {"3/4", 19}, {"5/8", 16},
      {"1/2", 12.5},   {"7/16", 11.2},  {"3/8", 9.5}, {"5/16", 8},   {"1/4", 6.3}};
  return all;
}

/// Openings of ISO 565 and 3310 between 1 and 10, and in every other decade: R 20 and R 40/3. Besides those that are
/// rounded otherwise from 10 to 100 (13.2 mm; 22, 26, 32 and 36 um), and the names that EN 12620 gives to sieves of
/// 11.2, 12.5, 22.4 and 31.5 mm.
bool is_iso_opening(double opening) {
  constexpr std::array kSeries{1.0,  1.06, 1.12, 1.18, 1.25, 1.4,  1.5,  1.6,  1.7,  1.8, 1.9, 2.0,  2.12, 2.24,
                               2.36, 2.5,  2.65, 2.8,  3.0,  3.15, 3.35, 3.55, 3.75, 3.8, 4.0, 4.25, 4.5,  4.75,
                               5.0,  5.3,  5.6,  6.0,  6.3,  6.7,  7.1,  7.5,  8.0,  8.5, 9.0, 9.5};
  constexpr std::array kOfTens{1.1, 1.2, 1.32, 2.2, 2.6, 3.2, 3.6};
  if (!(opening > 0.0)) return false;
  const double decade = std::pow(10.0, std::floor(std::log10(opening) + 1e-9));
  const auto is_in = [&](const auto& series) {
    return std::ranges::any_of(series, [&](double one) { return std::abs(opening / decade - one) < 1e-6; });
  };
  const bool tens = std::abs(decade - 10.0) < 1e-6 || std::abs(decade - 0.01) < 1e-9;  // mm or um; um in mm
  return is_in(kSeries) || (tens && is_in(kOfTens));
}

bool is_digit_of_size(char c) { return c >= '0' && c <= '9'; }

/// Takes one of the words from the front of the text, which ends there or goes on with no letter.
template <class Words>
bool take_word(std::string& text, const Words& words) {
  for (const char* word : words) {
    const std::string_view w = word;
    if (!text.starts_with(w)) continue;
    const bool letters = std::isalpha(static_cast<unsigned char>(w.back())) != 0;
    if (letters && text.size() > w.size() && std::isalpha(static_cast<unsigned char>(text[w.size()])) != 0) continue;
    text = trimmed(text.substr(w.size()));
    return true;
  }
  return false;
}

/// Length of "12", "0.063", "-2.5", ".5", "1e-3" at the front; 0: none.
std::size_t decimal_length(const std::string& text) {
  const std::size_t sign = text.starts_with('-') || text.starts_with('+') ? 1 : 0;
  double value = 0.0;
  const char* begin = text.data() + sign;
  if (sign == text.size() || (!is_digit_of_size(*begin) && *begin != '.')) return 0;
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  return error == std::errc{} ? static_cast<std::size_t>(end - text.data()) : 0;
}

std::size_t digits_length(const std::string& text, std::size_t at) {
  std::size_t end = at;
  while (end < text.size() && is_digit_of_size(text[end])) ++end;
  return end - at;
}

/// Length of "3/8", "1 1/2", "1-1/2" at the front; 0: none.
std::size_t fraction_length(const std::string& text) {
  const auto simple = [&](std::size_t at) -> std::size_t {
    const std::size_t above = digits_length(text, at);
    if (above == 0 || at + above >= text.size() || text[at + above] != '/') return 0;
    const std::size_t below = digits_length(text, at + above + 1);
    return below == 0 ? 0 : above + 1 + below;
  };
  if (const std::size_t length = simple(0); length > 0) return length;
  const std::size_t whole = digits_length(text, 0);
  if (whole == 0 || whole >= text.size() || (text[whole] != ' ' && text[whole] != '-')) return 0;
  const std::size_t length = simple(whole + 1);
  return length == 0 ? 0 : whole + 1 + length;
}

/// Takes a number or fraction from the front; empty: there is none.
std::string take_number(std::string& text) {
  const std::size_t fraction = fraction_length(text);
  const std::size_t length = fraction > 0 ? fraction : decimal_length(text);
  std::string number = text.substr(0, length);
  if (fraction > 0)
    if (const std::size_t dash = number.find('-'); dash != std::string::npos) number[dash] = ' ';
  text = trimmed(text.substr(length));
  return number;
}

/// Takes a unit that nothing but brackets follow; false: something else does.
bool take_unit(std::string& text, std::string& unit) {
  if (text.empty()) return true;
  std::size_t end = text.find_first_of(" -");
  if (end == std::string::npos) end = text.size();
  unit = sieve_unit(text.substr(0, end));
  if (unit.empty()) return false;
  text = trimmed(text.substr(end));
  return true;
}

SieveSize pan_of(std::string text) {
  SieveSize pan{SieveSize::Kind::pan};
  take_word(text, std::array{"no.", "no", "nr.", "nr", "#"});
  pan.number = take_number(text);
  if (!take_unit(text, pan.unit)) pan.unit.clear();
  return pan;
}

/// "iso 3310-1", "astm e11", "sieve" in front of a size.
void take_standard(std::string& text) {
  constexpr std::array kStandards{"iso",  "din", "en",   "nf",    "bs",   "astm",  "e11",
                                  "e 11", "us",  "u.s.", "sieve", "sieb", "tamis", "test"};
  constexpr std::array kNumbers{"3310-1", "3310-2", "3310", "565", "4188", "4187", ":", "-"};
  while (take_word(text, kStandards))
    while (take_word(text, kNumbers)) {
    }
}

double decimal_of(const std::string& number) { return parse_quantity(number, Unit::none); }

/// Value of "1 1/2", "3/8", "0.375".
double value_of_fraction(const std::string& number) {
  const std::size_t slash = number.find('/');
  if (slash == std::string::npos) return decimal_of(number);
  const std::size_t blank = number.find(' ');
  const std::size_t above = blank == std::string::npos ? 0 : blank + 1;
  const double whole = above == 0 ? 0.0 : decimal_of(number.substr(0, blank));
  return whole + decimal_of(number.substr(above, slash - above)) / decimal_of(number.substr(slash + 1));
}

}  // namespace

std::string sieve_unit(const std::string& word) {
  std::string text = csv::folded(trimmed(word));
  while (!text.empty() && text.back() == '.') text.pop_back();
  static const std::map<std::string, std::string> names{
      {"um", "um"},      {"micron", "um"},     {"microns", "um"},    {"mikron", "um"},      {"mikrometer", "um"},
      {"mic", "um"},     {"micrometer", "um"}, {"micrometre", "um"}, {"micrometres", "um"}, {"micrometers", "um"},
      {"in", "in"},      {"inch", "in"},       {"inches", "in"},     {"zoll", "in"},        {"pouce", "in"},
      {"pouces", "in"},  {"\"", "in"},         {"''", "in"},         {"phi", "phi"},        {"mesh", "mesh"},
      {"mesch", "mesh"}, {"millimeter", "mm"}, {"millimetre", "mm"}, {"millimetres", "mm"}, {"astm", "astm"}};
  if (const auto found = names.find(text); found != names.end()) return found->second;
  for (const char* unit : {"mm", "cm", "m", "nm", "km"})
    if (text == unit) return unit;
  return "";
}

SieveSize sieve_size(const std::string& cell) {
  std::string text = trimmed(csv::folded(cell));
  take_standard(text);
  constexpr std::array kPan{"pan",    "boden",   "siebboden",  "auffangboden", "auffangschale", "bodenschale",
                            "schale", "fond",    "receiver",   "receptacle",   "bottom",        "tray",
                            "rest",   "<",       "unter",      "kleiner",      "below",         "under",
                            "minus",  "passing", "inferieur a"};
  if (take_word(text, kPan)) return pan_of(text);
  if (const std::size_t plus = text.find('+'); text.starts_with('-') && plus != std::string::npos)
    text = text.substr(plus) + "-" + text.substr(1, plus - 1);  // "-500 +250" passes 500 and not 250
  (void)take_word(text, std::array{">", "+", "ueber", "above", "over", "retained on"});
  SieveSize size{SieveSize::Kind::sieve};
  if (take_word(text, std::array{"no.", "no", "nr.", "nr", "num.", "n.", "#"})) size.unit = "astm";
  size.number = take_number(text);
  if (size.number.empty()) return {};
  std::string unit;
  const bool class_of_sizes = size.unit.empty();
  const bool brackets = text.starts_with('(') || text.starts_with('[');  // "No. 4 (4.75 mm)"
  if (!brackets && !text.starts_with('-') && !take_unit(text, unit)) return {};
  if (class_of_sizes && take_word(text, std::array{"-", "bis", "to", "a"})) {
    size.upper = take_number(text);
    if (size.upper.empty() || !take_unit(text, unit)) return {};
  }
  if (!text.empty() && text.front() != '(' && text.front() != '[') return {};
  if (size.unit.empty()) size.unit = unit;
  return size;
}

bool is_sieve_or_mass(std::string cell) {
  std::ranges::replace(cell, ',', '.');
  if (csv::folded(cell).starts_with("test")) return false;
  const SieveSize size = sieve_size(cell);
  if (size.kind == SieveSize::Kind::sieve && !size.unit.empty()) return true;
  try {
    return parse_quantity(cell, Unit::mass) >= 0.0;
  } catch (const InputError&) {
    return false;
  }
}

double sieve_diameter(const std::string& number, const std::string& unit, bool nominal) {
  const bool fraction = number.find('/') != std::string::npos;
  if (unit == kAstmNumbers || unit == kMesh) {
    const auto found = astm_numbers().find(number);
    if (found == astm_numbers().end() && fraction) return sieve_diameter(number, kInches, true);  // 3/8
    if (found == astm_numbers().end())
      throw InputError(fmt::format("No. {} is no sieve of ASTM E11: numbers are 3 1/2, 4 to 8, 10 to 635", number));
    return parse_quantity(fmt::format("{} um", found->second), Unit::length);
  }
  if (unit == kInches) {
    const auto found = astm_inches().find(number);
    if ((fraction || nominal) && found != astm_inches().end())
      return parse_quantity(fmt::format("{} mm", found->second), Unit::length);
    return value_of_fraction(number) * kInch;
  }
  if (unit == kPhi) return 1e-3 * std::exp2(-decimal_of(number));
  if (fraction) throw InputError(fmt::format("{} is a fraction; only inches are given as fractions", number));
  return parse_quantity(number + " " + unit, Unit::length);
}

std::optional<std::string> unit_of_numbers(const std::vector<std::string>& numbers) {
  constexpr double kFinerThanInches = 0.1;  // [in]: finer sieves have no such round openings
  constexpr double kCoarsest = 125.0;       // [mm]
  constexpr double kFinest = 20.0;          // [um]
  std::vector<double> values;
  for (const std::string& number : numbers) {
    if (number.find('/') != std::string::npos) return std::nullopt;
    values.push_back(decimal_of(number));
  }
  if (values.empty() || !std::ranges::all_of(values, is_iso_opening)) return std::nullopt;
  for (const auto* series : {&astm_numbers(), &tyler_mesh()})
    if (std::ranges::all_of(numbers, [&](const std::string& n) { return series->contains(n); })) return std::nullopt;
  const auto [low, high] = std::ranges::minmax(values);
  if (low >= 1e-3 * kFinest && low < kFinerThanInches && high <= kCoarsest) return "mm";
  if (low >= kFinest && high > kCoarsest) return "um";
  return std::nullopt;
}

bool are_astm_numbers(const std::vector<std::string>& numbers) {
  bool same = true;
  for (const std::string& number : numbers) {
    const auto tyler = tyler_mesh().find(number);
    if (tyler == tyler_mesh().end()) return true;
    const auto astm = astm_numbers().find(number);
    same = same && astm != astm_numbers().end() && astm->second == tyler->second;
  }
  return same;
}

}  // namespace softgrain
