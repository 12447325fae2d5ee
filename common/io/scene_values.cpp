// Values of a scene: numbers with units and ranges, counts, flags, words, vectors and lists.
#include <algorithm>
#include <cmath>
#include <span>
#include <sstream>

#include "common/core/error.h"
#include "common/io/scene_impl.h"
#include "common/io/toml.h"

namespace softgrain {

namespace {

using Table = SceneTable::Impl;

std::string plain(double value) {
  std::ostringstream out;
  out.precision(15);
  out << value;
  return out.str();
}

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
  if (text == nullptr) table.reject(key, node, "must be a number" + also(range));
  try {
    return parse_quantity(text->get(), unit);
  } catch (const BadInput& e) {
    table.reject(key, node, e.what() + also(range));
  }
}

double number_of(const Table& table, const std::string& key, const toml::node& node, Unit unit, const Range& range) {
  const double value = raw_number(table, key, node, unit, range);
  if (!std::isfinite(value)) table.reject(key, node, "must be a finite number" + also(range));
  if (!holds(range, value)) table.reject(key, node, describe(range));
  if (unit != Unit::none && value != 0.0 && (std::abs(value) < kLeast || std::abs(value) > kMost))
    table.reject(key, node, "must be 0 or from 1e-30 to 1e30 in SI units, either sign" + also(range));
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
      table.reject(key, node, problem);
    value = static_cast<std::int64_t>(number->get());
  }
  if (value < low || value > high) table.reject(key, node, problem);
  return value;
}

std::string text_of(const Table& table, const std::string& key, const toml::node& node) {
  const auto text = node.as_string();
  if (text == nullptr) table.reject(key, node, "must be a text in quotes");
  return text->get();
}

std::string choice_of(const Table& table, const std::string& key, const toml::node& node,
                      std::span<const char* const> words) {
  std::string value = text_of(table, key, node);
  const std::vector<std::string> known(words.begin(), words.end());
  if (std::find(known.begin(), known.end(), value) != known.end()) return value;
  std::string problem = "must be ";
  for (const std::string& word : known)
    problem += (&word == &known.front() ? "\"" : &word == &known.back() ? " or \"" : ", \"") + word + "\"";
  const std::string near = nearest_word(value, known);
  if (!near.empty()) problem += "; nearest is \"" + near + "\"";
  table.reject(key, node, problem);
}

const toml::array& array_of(const Table& table, const std::string& key, const toml::node& node) {
  const toml::array* array = node.as_array();
  if (array == nullptr) table.reject(key, node, "must be a list in brackets");
  return *array;
}

std::vector<double> numbers_of(const Table& table, const std::string& key, const toml::node& node, Unit unit,
                               const Range& range) {
  std::vector<double> values;
  for (const toml::node& element : array_of(table, key, node))
    values.push_back(number_of(table, key, element, unit, range));
  return values;
}

Vec3 vector_of(const Table& table, const std::string& key, const toml::node& node, Unit unit) {
  const std::vector<double> values = numbers_of(table, key, node, unit, Range::any());
  if (values.size() != 3) table.reject(key, node, "must have three components");
  return {{values[0], values[1], values[2]}};
}

}  // namespace

double SceneTable::number(const std::string& key, Unit unit, const Range& range) const {
  return number_of(*impl_, key, impl_->require(key), unit, range);
}
double SceneTable::number(const std::string& key, Unit unit, const Range& range, double fallback) const {
  const toml::node* node = impl_->find(key);
  return node == nullptr ? fallback : number_of(*impl_, key, *node, unit, range);
}

std::int64_t SceneTable::count(const std::string& key, std::int64_t low, std::int64_t high) const {
  return count_of(*impl_, key, impl_->require(key), low, high);
}
std::int64_t SceneTable::count(const std::string& key, std::int64_t low, std::int64_t high,
                               std::int64_t fallback) const {
  const toml::node* node = impl_->find(key);
  return node == nullptr ? fallback : count_of(*impl_, key, *node, low, high);
}

bool SceneTable::flag(const std::string& key, bool fallback) const {
  const toml::node* node = impl_->find(key);
  if (node == nullptr) return fallback;
  const auto value = node->as_boolean();
  if (value == nullptr) impl_->reject(key, *node, "must be true or false");
  return value->get();
}

std::string SceneTable::text(const std::string& key) const { return text_of(*impl_, key, impl_->require(key)); }
std::string SceneTable::text(const std::string& key, const std::string& fallback) const {
  const toml::node* node = impl_->find(key);
  return node == nullptr ? fallback : text_of(*impl_, key, *node);
}

std::string SceneTable::choice(const std::string& key, std::initializer_list<const char*> words) const {
  return choice_of(*impl_, key, impl_->require(key), {words.begin(), words.size()});
}
std::string SceneTable::choice(const std::string& key, const std::vector<const char*>& words) const {
  return choice_of(*impl_, key, impl_->require(key), words);
}
std::string SceneTable::choice(const std::string& key, std::initializer_list<const char*> words,
                               const std::string& fallback) const {
  const toml::node* node = impl_->find(key);
  return node == nullptr ? fallback : choice_of(*impl_, key, *node, {words.begin(), words.size()});
}

Vec3 SceneTable::vector3(const std::string& key, Unit unit) const {
  return vector_of(*impl_, key, impl_->require(key), unit);
}
Vec3 SceneTable::vector3(const std::string& key, Unit unit, const Vec3& fallback) const {
  const toml::node* node = impl_->find(key);
  return node == nullptr ? fallback : vector_of(*impl_, key, *node, unit);
}

std::vector<double> SceneTable::numbers(const std::string& key, Unit unit, const Range& range) const {
  return numbers_of(*impl_, key, impl_->require(key), unit, range);
}
std::vector<double> SceneTable::numbers(const std::string& key, Unit unit, const Range& range,
                                        const std::vector<double>& fallback) const {
  const toml::node* node = impl_->find(key);
  return node == nullptr ? fallback : numbers_of(*impl_, key, *node, unit, range);
}

std::vector<std::string> SceneTable::texts(const std::string& key) const {
  std::vector<std::string> values;
  const toml::node& node = impl_->require(key);
  for (const toml::node& element : array_of(*impl_, key, node)) values.push_back(text_of(*impl_, key, element));
  return values;
}

std::vector<bool> SceneTable::flags(const std::string& key) const {
  std::vector<bool> values;
  const toml::node& node = impl_->require(key);
  for (const toml::node& element : array_of(*impl_, key, node)) {
    const auto value = element.as_boolean();
    if (value == nullptr) impl_->reject(key, element, "must be true or false");
    values.push_back(value->get());
  }
  return values;
}

}  // namespace softgrain
