// Values of a scene: numbers with units and ranges, counts, flags, words, vectors and lists.
#include <algorithm>
#include <cmath>
#include <span>
#include <type_traits>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/io/scene_impl.h"
#include "common/io/toml.h"

namespace softgrain {

namespace {

using Table = SceneTable::Impl;

std::string plain(double value) { return rounded_text(value, {15}); }

/// A number with a unit outside this is no quantity of this world, and its powers are no numbers.
constexpr double kLeast = 1e-30;
constexpr double kMost = 1e30;
/// Squares and cubes of a number without a unit stay finite below this.
constexpr double kMostPlain = 1e100;

/// An end of a range. What only allows for rounding beside it is left out, so that a share is "from 0 to 1".
std::string plain_end(double end) {
  constexpr double kSlack = 1e-8;
  if (end < 0.0 && end > -kSlack) return "0";
  const double rounded = std::stod(rounded_text(end, {6}));
  return plain(std::abs(rounded - end) < kSlack * std::abs(end) ? rounded : end);
}

/// "must be above 1", "must be from 0 to 0.5", "must be at least 0 and below 1".
std::string describe(const Range& range) { return "must be " + range_text(range); }

/// ", must be above 0" after another complaint; nothing when all numbers are allowed.
std::string also(const Range& range) {
  return std::isfinite(range.low) || std::isfinite(range.high) ? ", and " + describe(range) : "";
}

/// Number of a node in SI, before its range, which goes into the message: a number, or text with a unit.
double raw_number(const Table& table, const std::string& key, const toml::node& node, Unit unit, const Range& range) {
  if (const auto integer = node.as_integer()) return static_cast<double>(integer->get());
  if (const auto number = node.as_floating_point()) return number->get();
  const auto text = node.as_string();
  if (text == nullptr) table.throw_error(key, node, "must be a number" + also(range));
  try {
    return parse_quantity(text->get(), unit);
  } catch (const InputError& e) {
    table.throw_error(key, node, e.what() + also(range));
  }
}

double number_of(const Table& table, const std::string& key, const toml::node& node, Unit unit, const Range& range) {
  const double value = raw_number(table, key, node, unit, range);
  if (!std::isfinite(value)) table.throw_error(key, node, "must be a finite number" + also(range));
  if (!range.contains(value)) table.throw_error(key, node, describe(range));
  if (unit != Unit::none && value != 0.0 && (std::abs(value) < kLeast || std::abs(value) > kMost))
    table.throw_error(key, node, "must be 0 or from 1e-30 to 1e30 in SI units, either sign" + also(range));
  if (std::abs(value) > kMostPlain) table.throw_error(key, node, "must be at most 1e100, either sign" + also(range));
  return value;
}

/// An integer, also written as 1e4.
std::int64_t count_of(const Table& table, const std::string& key, const toml::node& node, std::int64_t low,
                      std::int64_t high) {
  const bool open = high == std::numeric_limits<std::int64_t>::max();
  const std::string problem =
      open ? "must be a whole number, at least " + std::to_string(low)
           : "must be a whole number from " + std::to_string(low) + " to " + std::to_string(high);
  std::int64_t value = 0;
  if (const auto integer = node.as_integer()) {
    value = integer->get();
  } else {
    const auto number = node.as_floating_point();
    if (number == nullptr || std::trunc(number->get()) != number->get() || std::abs(number->get()) > 0x1p53)
      table.throw_error(key, node, problem);
    value = static_cast<std::int64_t>(number->get());
  }
  if (value < low || value > high) table.throw_error(key, node, problem);
  return value;
}

std::string text_of(const Table& table, const std::string& key, const toml::node& node) {
  const auto text = node.as_string();
  if (text == nullptr) table.throw_error(key, node, "must be a text in quotes");
  return text->get();
}

std::string choice_of(const Table& table, const std::string& key, const toml::node& node,
                      std::span<const char* const> words) {
  std::string value = text_of(table, key, node);
  const std::vector<std::string> known(words.begin(), words.end());
  for (const std::string_view name : {std::string_view(value), current_name(value)})
    if (std::ranges::find(known, name) != known.end()) return std::string(name);
  std::string problem = "must be ";
  for (const std::string& word : known)
    problem += (&word == &known.front() ? "\"" : &word == &known.back() ? " or \"" : ", \"") + word + "\"";
  const std::string near = nearest_word(value, known);
  if (!near.empty()) problem += "; nearest is \"" + near + "\"";
  table.throw_error(key, node, problem);
}

bool is_blank(const std::string& text) { return text.find_first_not_of(" \t\r\n") == std::string::npos; }

bool flag_of(const Table& table, const std::string& key, const toml::node& node) {
  const auto value = node.as_boolean();
  if (value == nullptr) table.throw_error(key, node, "must be true or false");
  return value->get();
}

const toml::array& array_of(const Table& table, const std::string& key, const toml::node& node) {
  const toml::array* array = node.as_array();
  if (array == nullptr) table.throw_error(key, node, "must be a list in brackets");
  return *array;
}

/// What stands in for a number that is not there or not allowed: as little as the range allows.
double allowed_value(const Range& range) {
  if (std::isfinite(range.low)) {
    if (!range.low_open) return range.low;
    return std::isfinite(range.high) ? 0.5 * (range.low + range.high) : range.low + 1.0;
  }
  return std::isfinite(range.high) ? range.high - 1.0 : 0.0;
}

std::vector<double> numbers_of(Table& table, const std::string& key, const toml::node& node, Unit unit,
                               const Range& range) {
  std::vector<double> values;
  for (const toml::node& element : array_of(table, key, node))
    values.push_back(table.value([&] { return number_of(table, key, element, unit, range); }, allowed_value(range)));
  return values;
}

Vec3 vector_of(Table& table, const std::string& key, const toml::node& node, Unit unit) {
  const std::vector<double> values = numbers_of(table, key, node, unit, Range::any());
  if (values.size() != 3) table.throw_error(key, node, "must have three components");
  return {{values[0], values[1], values[2]}};
}

/// The value under a key, by `read(node)`; `fallback` where there is none and null where there must be one.
template <class T, class Read>
T value_of(Table& table, const std::string& key, Read read, const T& substitute,
           std::type_identity_t<const T*> fallback = nullptr, bool word = false) {
  return table.value(
      [&]() -> T {
        if (fallback == nullptr) return read(table.require(key));
        const toml::node* node = table.find(key);
        return node == nullptr ? *fallback : read(*node);
      },
      substitute, word);
}

/// Returns the value, and tells the KeyRecord, where there is one, how the key was asked for.
template <class T>
T noted(const Table& table, const Key& key, AskedKey asked, const T& value) {
  if (KeyRecord::current() != nullptr) table.note_asked(key, std::move(asked));
  return value;
}

double read_number(Table& table, const Key& key, Unit unit, const Range& range, const double* fallback) {
  const double value = value_of(
      table, key.name, [&](const toml::node& n) { return number_of(table, key.name, n, unit, range); },
      fallback == nullptr ? allowed_value(range) : *fallback, fallback);
  return noted(table, key,
               {.form = KeyForm::number, .required = !fallback, .unit = unit, .range = range, .numbers = {value}},
               value);
}

std::int64_t read_count(Table& table, const Key& key, std::int64_t low, std::int64_t high,
                        const std::int64_t* fallback) {
  const std::int64_t value = value_of(
      table, key.name, [&](const toml::node& n) { return count_of(table, key.name, n, low, high); },
      fallback == nullptr ? low : *fallback, fallback);
  return noted(table, key,
               {.form = KeyForm::count,
                .required = !fallback,
                .range = Range::closed(static_cast<double>(low), static_cast<double>(high)),
                .numbers = {static_cast<double>(value)}},
               value);
}

/// A text; one of `words` where there are any.
std::string read_text(Table& table, const Key& key, std::span<const char* const> words, const std::string* fallback) {
  const auto read = [&](const toml::node& n) {
    return words.empty() ? text_of(table, key.name, n) : choice_of(table, key.name, n, words);
  };
  const std::string any = words.empty() ? "" : words.front();
  const std::string value = value_of(table, key.name, read, fallback == nullptr ? any : *fallback, fallback, true);
  return noted(table, key,
               {.form = words.empty() ? KeyForm::text : KeyForm::choice,
                .required = !fallback,
                .texts = {value},
                .words = {words.begin(), words.end()}},
               value);
}

Vec3 read_vector3(Table& table, const Key& key, Unit unit, const Vec3* fallback) {
  const Vec3 value = value_of(
      table, key.name, [&](const toml::node& n) { return vector_of(table, key.name, n, unit); },
      fallback == nullptr ? Vec3{} : *fallback, fallback);
  return noted(
      table, key,
      {.form = KeyForm::vector, .required = !fallback, .unit = unit, .numbers = {value[0], value[1], value[2]}}, value);
}

std::vector<double> read_numbers(Table& table, const Key& key, Unit unit, const Range& range,
                                 const std::vector<double>* fallback) {
  const std::vector<double> values = value_of(
      table, key.name, [&](const toml::node& n) { return numbers_of(table, key.name, n, unit, range); },
      fallback == nullptr ? std::vector<double>() : *fallback, fallback);
  return noted(table, key,
               {.form = KeyForm::numbers, .required = !fallback, .unit = unit, .range = range, .numbers = values},
               values);
}

/// A list of which `of(key, node)` reads one element.
template <class T, class Element>
std::vector<T> read_list(Table& table, const Key& key, Element of) {
  const auto read = [&](const toml::node& node) {
    std::vector<T> values;
    for (const toml::node& element : array_of(table, key.name, node)) values.push_back(of(element));
    return values;
  };
  return value_of(table, key.name, read, std::vector<T>(), nullptr, true);
}

}  // namespace

std::string range_text(const Range& range) {
  const bool low = std::isfinite(range.low);
  const bool high = std::isfinite(range.high);
  if (low && high && !range.low_open && !range.high_open)
    return "from " + plain_end(range.low) + " to " + plain_end(range.high);
  std::string text;
  if (low) text += (range.low_open ? "above " : "at least ") + plain_end(range.low);
  if (low && high) text += " and ";
  if (high) text += (range.high_open ? "below " : "at most ") + plain_end(range.high);
  return text;
}

double SceneTable::number(const Key& key, Unit unit, const Range& range) const {
  return read_number(*impl_, key, unit, range, nullptr);
}
double SceneTable::number(const Key& key, Unit unit, const Range& range, double fallback) const {
  return read_number(*impl_, key, unit, range, &fallback);
}

std::int64_t SceneTable::count(const Key& key, std::int64_t low, std::int64_t high) const {
  return read_count(*impl_, key, low, high, nullptr);
}
std::int64_t SceneTable::count(const Key& key, std::int64_t low, std::int64_t high, std::int64_t fallback) const {
  return read_count(*impl_, key, low, high, &fallback);
}

bool SceneTable::flag(const Key& key, bool fallback) const {
  const bool value = value_of(
      *impl_, key.name, [&](const toml::node& n) { return flag_of(*impl_, key.name, n); }, fallback, &fallback, true);
  return noted(*impl_, key, {.form = KeyForm::flag, .numbers = {value ? 1.0 : 0.0}}, value);
}

std::string SceneTable::text(const Key& key) const { return read_text(*impl_, key, {}, nullptr); }
std::string SceneTable::text(const Key& key, const std::string& fallback) const {
  return read_text(*impl_, key, {}, &fallback);
}

std::string SceneTable::filled_text(const Key& key) const {
  std::string value = text(key);
  if (has(key.name) && is_blank(value)) throw_error(key.name, "must not be empty");
  return value;
}
std::string SceneTable::filled_text(const Key& key, const std::string& fallback) const {
  std::string value = text(key, fallback);
  if (has(key.name) && is_blank(value)) throw_error(key.name, "must not be empty: leave the key out");
  return value;
}

void SceneTable::require_line(const std::string& key, const std::string& name) const {
  if (!is_one_line(name)) add_error(key, "must be one line of text, without control characters");
}
std::string SceneTable::line_text(const Key& key) const {
  std::string value = filled_text(key);
  require_line(key.name, value);
  return value;
}
std::string SceneTable::line_text(const Key& key, const std::string& fallback) const {
  std::string value = filled_text(key, fallback);
  require_line(key.name, value);
  return value;
}

std::string SceneTable::title() const {
  std::string value = text(kTitleKey, "");
  require_line(kTitleKey.name, value);
  return value;
}

std::string SceneTable::choice(const Key& key, std::initializer_list<const char*> words) const {
  return read_text(*impl_, key, {words.begin(), words.size()}, nullptr);
}
std::string SceneTable::choice(const Key& key, const std::vector<const char*>& words) const {
  return read_text(*impl_, key, words, nullptr);
}
std::string SceneTable::choice(const Key& key, std::initializer_list<const char*> words,
                               const std::string& fallback) const {
  return read_text(*impl_, key, {words.begin(), words.size()}, &fallback);
}
std::string SceneTable::choice(const Key& key, const std::vector<const char*>& words,
                               const std::string& fallback) const {
  return read_text(*impl_, key, words, &fallback);
}

Vec3 SceneTable::vector3(const Key& key, Unit unit) const { return read_vector3(*impl_, key, unit, nullptr); }
Vec3 SceneTable::vector3(const Key& key, Unit unit, const Vec3& fallback) const {
  return read_vector3(*impl_, key, unit, &fallback);
}

std::vector<double> SceneTable::numbers(const Key& key, Unit unit, const Range& range) const {
  return read_numbers(*impl_, key, unit, range, nullptr);
}
std::vector<double> SceneTable::numbers(const Key& key, Unit unit, const Range& range,
                                        const std::vector<double>& fallback) const {
  return read_numbers(*impl_, key, unit, range, &fallback);
}

std::vector<std::string> SceneTable::texts(const Key& key) const {
  const std::vector<std::string> values =
      read_list<std::string>(*impl_, key, [&](const toml::node& n) { return text_of(*impl_, key.name, n); });
  return noted(*impl_, key, {.form = KeyForm::texts, .required = true, .texts = values}, values);
}

std::vector<bool> SceneTable::flags(const Key& key) const {
  const std::vector<bool> values =
      read_list<bool>(*impl_, key, [&](const toml::node& n) { return flag_of(*impl_, key.name, n); });
  return noted(*impl_, key, {.form = KeyForm::flags, .required = true, .numbers = {values.begin(), values.end()}},
               values);
}

}  // namespace softgrain
