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

/// "must be above 1", "must be from 0 to 0.5", "must be at least 0 and below 1".
std::string describe(const Range& range) {
  const bool low = std::isfinite(range.low);
  const bool high = std::isfinite(range.high);
  if (low && high && !range.low_open && !range.high_open)
    return "must be from " + plain(range.low) + " to " + plain(range.high);
  std::string text = "must be ";
  if (low) text += (range.low_open ? "above " : "at least ") + plain(range.low);
  if (low && high) text += " and ";
  if (high) text += (range.high_open ? "below " : "at most ") + plain(range.high);
  return text;
}

bool holds(const Range& range, double value) {
  return (range.low_open ? value > range.low : value >= range.low) &&
         (range.high_open ? value < range.high : value <= range.high);
}

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
  if (!holds(range, value)) table.throw_error(key, node, describe(range));
  if (unit != Unit::none && value != 0.0 && (std::abs(value) < kLeast || std::abs(value) > kMost))
    table.throw_error(key, node, "must be 0 or from 1e-30 to 1e30 in SI units, either sign" + also(range));
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

/// The value, once who takes keys down knows of it.
double noted(const Table& table, const std::string& key, Unit unit, const Range& range, double value) {
  table.note_asked(key, {.form = KeyForm::number, .unit = unit, .range = range, .numbers = {value}});
  return value;
}

std::int64_t noted(const Table& table, const std::string& key, std::int64_t low, std::int64_t high,
                   std::int64_t value) {
  table.note_asked(key, {.form = KeyForm::count,
                         .range = Range::closed(static_cast<double>(low), static_cast<double>(high)),
                         .numbers = {static_cast<double>(value)}});
  return value;
}

std::string noted(const Table& table, const std::string& key, std::vector<std::string> words, std::string value) {
  table.note_asked(key, {.form = words.empty() ? KeyForm::text : KeyForm::choice, .texts = {value}, .words = words});
  return value;
}

Vec3 noted(const Table& table, const std::string& key, Unit unit, const Vec3& value) {
  table.note_asked(key, {.form = KeyForm::vector, .unit = unit, .numbers = {value[0], value[1], value[2]}});
  return value;
}

std::vector<double> noted(const Table& table, const std::string& key, Unit unit, const Range& range,
                          std::vector<double> values) {
  table.note_asked(key, {.form = KeyForm::numbers, .unit = unit, .range = range, .numbers = values});
  return values;
}

}  // namespace

double SceneTable::number(const std::string& key, Unit unit, const Range& range) const {
  return noted(*impl_, key, unit, range,
               value_of(
                   *impl_, key, [&](const toml::node& n) { return number_of(*impl_, key, n, unit, range); },
                   allowed_value(range)));
}
double SceneTable::number(const std::string& key, Unit unit, const Range& range, double fallback) const {
  return noted(*impl_, key, unit, range,
               value_of(
                   *impl_, key, [&](const toml::node& n) { return number_of(*impl_, key, n, unit, range); }, fallback,
                   &fallback));
}

std::int64_t SceneTable::count(const std::string& key, std::int64_t low, std::int64_t high) const {
  return noted(*impl_, key, low, high,
               value_of(
                   *impl_, key, [&](const toml::node& n) { return count_of(*impl_, key, n, low, high); }, low));
}
std::int64_t SceneTable::count(const std::string& key, std::int64_t low, std::int64_t high,
                               std::int64_t fallback) const {
  return noted(
      *impl_, key, low, high,
      value_of(
          *impl_, key, [&](const toml::node& n) { return count_of(*impl_, key, n, low, high); }, fallback, &fallback));
}

bool SceneTable::flag(const std::string& key, bool fallback) const {
  const bool value = value_of(
      *impl_, key, [&](const toml::node& n) { return flag_of(*impl_, key, n); }, fallback, &fallback, true);
  impl_->note_asked(key, {.form = KeyForm::flag, .numbers = {value ? 1.0 : 0.0}});
  return value;
}

std::string SceneTable::text(const std::string& key) const {
  return noted(
      *impl_, key, std::vector<std::string>(),
      value_of(
          *impl_, key, [&](const toml::node& n) { return text_of(*impl_, key, n); }, std::string(), nullptr, true));
}
std::string SceneTable::text(const std::string& key, const std::string& fallback) const {
  return noted(
      *impl_, key, std::vector<std::string>(),
      value_of(
          *impl_, key, [&](const toml::node& n) { return text_of(*impl_, key, n); }, fallback, &fallback, true));
}

std::string SceneTable::choice(const std::string& key, std::initializer_list<const char*> words) const {
  return choice(key, std::vector<const char*>(words));
}
std::string SceneTable::choice(const std::string& key, const std::vector<const char*>& words) const {
  return noted(*impl_, key, std::vector<std::string>(words.begin(), words.end()),
               value_of(
                   *impl_, key, [&](const toml::node& n) { return choice_of(*impl_, key, n, words); },
                   std::string(words.front()), nullptr, true));
}
std::string SceneTable::choice(const std::string& key, std::initializer_list<const char*> words,
                               const std::string& fallback) const {
  return noted(*impl_, key, std::vector<std::string>(words.begin(), words.end()),
               value_of(
                   *impl_, key,
                   [&](const toml::node& n) {
                     return choice_of(*impl_, key, n, {words.begin(), words.size()});
                   },
                   fallback, &fallback, true));
}

Vec3 SceneTable::vector3(const std::string& key, Unit unit) const {
  return noted(*impl_, key, unit,
               value_of(
                   *impl_, key, [&](const toml::node& n) { return vector_of(*impl_, key, n, unit); }, Vec3{}));
}
Vec3 SceneTable::vector3(const std::string& key, Unit unit, const Vec3& fallback) const {
  return noted(
      *impl_, key, unit,
      value_of(
          *impl_, key, [&](const toml::node& n) { return vector_of(*impl_, key, n, unit); }, fallback, &fallback));
}

std::vector<double> SceneTable::numbers(const std::string& key, Unit unit, const Range& range) const {
  return noted(*impl_, key, unit, range,
               value_of(
                   *impl_, key, [&](const toml::node& n) { return numbers_of(*impl_, key, n, unit, range); },
                   std::vector<double>()));
}
std::vector<double> SceneTable::numbers(const std::string& key, Unit unit, const Range& range,
                                        const std::vector<double>& fallback) const {
  return noted(*impl_, key, unit, range,
               value_of(
                   *impl_, key, [&](const toml::node& n) { return numbers_of(*impl_, key, n, unit, range); }, fallback,
                   &fallback));
}

std::vector<std::string> SceneTable::texts(const std::string& key) const {
  const auto read = [&](const toml::node& node) {
    std::vector<std::string> values;
    for (const toml::node& element : array_of(*impl_, key, node)) values.push_back(text_of(*impl_, key, element));
    return values;
  };
  const std::vector<std::string> values = value_of(*impl_, key, read, std::vector<std::string>(), nullptr, true);
  impl_->note_asked(key, {.form = KeyForm::texts, .texts = values});
  return values;
}

std::vector<bool> SceneTable::flags(const std::string& key) const {
  const auto read = [&](const toml::node& node) {
    std::vector<bool> values;
    for (const toml::node& element : array_of(*impl_, key, node)) values.push_back(flag_of(*impl_, key, element));
    return values;
  };
  const std::vector<bool> values = value_of(*impl_, key, read, std::vector<bool>(), nullptr, true);
  impl_->note_asked(key, {.form = KeyForm::flags, .numbers = std::vector<double>(values.begin(), values.end())});
  return values;
}

}  // namespace softgrain
