// Units of numbers in scenes. Powers of ten are put into the exponent of the number's text, so that "0.7 mm" is exactly
// 0.0007.
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>

#include "common/core/error.h"
#include "common/io/scene.h"

namespace softgrain {

namespace {

/// value in SI = number * 10^power * factor
struct KnownUnit {
  std::string_view name;
  int power = 0;
  double factor = 1.0;
  bool listed = true;  ///< whether messages list the unit; other spellings and rare units are not listed
};

constexpr bool kUnlisted = false;

constexpr double kDegree = std::numbers::pi / 180.0;

constexpr KnownUnit kLength[] = {{"m"}, {"km", 3}, {"cm", -2}, {"mm", -3}, {"um", -6}, {"µm", -6}, {"nm", -9}};
constexpr KnownUnit kMass[] = {{"kg"}, {"t", 3}, {"g", -3}, {"mg", -6}, {"ug", -9}, {"µg", -9, 1.0, kUnlisted}};
constexpr KnownUnit kTime[] = {{"s"},      {"ms", -3},       {"us", -6},      {"µs", -6},
                               {"ns", -9}, {"min", 0, 60.0}, {"h", 0, 3600.0}};
constexpr KnownUnit kFrequency[] = {{"Hz"}, {"1/s"}, {"kHz", 3}, {"MHz", 6}, {"1/min", 0, 1.0 / 60.0}};
constexpr KnownUnit kPressure[] = {{"Pa"},
                                   {"kPa", 3},
                                   {"MPa", 6},
                                   {"GPa", 9},
                                   {"N/m^2"},
                                   {"kN/m^2", 3, 1.0, kUnlisted},
                                   {"MN/m^2", 6, 1.0, kUnlisted},
                                   {"N/mm^2", 6},
                                   {"kN/mm^2", 9, 1.0, kUnlisted},
                                   {"N/cm^2", 4, 1.0, kUnlisted},
                                   {"kN/cm^2", 7, 1.0, kUnlisted},
                                   {"bar", 5},
                                   {"mbar", 2, 1.0, kUnlisted}};
constexpr KnownUnit kDensity[] = {{"kg/m^3"},
                                  {"g/cm^3", 3},
                                  {"t/m^3", 3},
                                  {"Mg/m^3", 3, 1.0, kUnlisted},
                                  {"g/cc", 3, 1.0, kUnlisted},
                                  {"g/ml", 3, 1.0, kUnlisted},
                                  {"kg/l", 3, 1.0, kUnlisted},
                                  {"kg/dm^3", 3, 1.0, kUnlisted}};
constexpr KnownUnit kVelocity[] = {{"m/s"},      {"cm/s", -2}, {"mm/s", -3},
                                   {"um/s", -6}, {"µm/s", -6}, {"km/h", 0, 1.0 / 3.6}};
constexpr KnownUnit kAngularVelocity[] = {
    {"rad/s"}, {"1/s"}, {"deg/s", 0, kDegree}, {"rpm", 0, 2.0 * std::numbers::pi / 60.0}};
constexpr KnownUnit kForce[] = {{"N"}, {"kN", 3}, {"MN", 6}, {"mN", -3}, {"uN", -6}, {"µN", -6}, {"nN", -9}};
constexpr KnownUnit kAcceleration[] = {{"m/s^2"}, {"cm/s^2", -2}, {"mm/s^2", -3}};
constexpr KnownUnit kStiffness[] = {{"N/m"}, {"kN/m", 3}, {"MN/m", 6}, {"GN/m", 9}, {"N/mm", 3}, {"kN/mm", 6}};
constexpr KnownUnit kAngle[] = {
    {"deg"}, {"degree"}, {"degrees"}, {"\u00b0", 0, 1.0, kUnlisted}, {"rad", 0, 1.0 / kDegree}};

std::span<const KnownUnit> known_units(Unit unit) {
  switch (unit) {
    case Unit::none:
      return {};
    case Unit::length:
      return kLength;
    case Unit::mass:
      return kMass;
    case Unit::time:
      return kTime;
    case Unit::frequency:
      return kFrequency;
    case Unit::pressure:
      return kPressure;
    case Unit::density:
      return kDensity;
    case Unit::velocity:
      return kVelocity;
    case Unit::angular_velocity:
      return kAngularVelocity;
    case Unit::force:
      return kForce;
    case Unit::acceleration:
      return kAcceleration;
    case Unit::stiffness:
      return kStiffness;
    case Unit::angle_degree:
      return kAngle;
  }
  return {};
}

std::string_view trim(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

/// Decimal number at the start of `text`: its length, 0 when there is none ("inf" and "nan" are none).
std::size_t number_length(std::string_view text) {
  if (text.find_first_of("0123456789.") > 1) return 0;
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc::invalid_argument ? 0 : static_cast<std::size_t>(end - text.data());
}

/// Name of a unit as the tables above write it: one micro sign, powers as "^2". "kg/m³", "kg/m3" and "kg/m**3" are
/// "kg/m^3".
std::string plain_unit(std::string_view name) {
  std::string out;
  const auto takes = [&](std::string_view from, std::string_view to) {
    if (!name.starts_with(from)) return false;
    out += to;
    name.remove_prefix(from.size());
    return true;
  };
  while (!name.empty()) {
    if (takes("\u03bc", "\u00b5") || takes("\u00b2", "^2") || takes("\u00b3", "^3") || takes("**", "^")) continue;
    const char last = out.empty() ? ' ' : out.back();
    const bool power = (name.front() == '2' || name.front() == '3') && ((last >= 'a' && last <= 'z') || last == 'N');
    if (power) out += '^';
    out += name.front();
    name.remove_prefix(1);
  }
  return out;
}

/// `number` times 10^power, correctly rounded; nothing when it overflows or underflows.
std::optional<double> scaled(std::string_view number, int power) {
  const std::size_t mark = number.find_first_of("eE");
  int exponent = 0;
  if (mark != std::string_view::npos) {
    std::string_view digits = number.substr(mark + 1);
    if (digits.starts_with('+')) digits.remove_prefix(1);
    if (std::from_chars(digits.data(), digits.data() + digits.size(), exponent).ec != std::errc{}) return std::nullopt;
  }
  if (std::abs(exponent) > 10000) return std::nullopt;
  const std::string text = std::string(number.substr(0, mark)) + "e" + std::to_string(exponent + power);
  double value = 0.0;
  if (std::from_chars(text.data(), text.data() + text.size(), value).ec != std::errc{}) return std::nullopt;
  return value;
}

std::string unknown_unit(std::string_view name, Unit unit) {
  if (name.size() > 1 && name[0] == ',' && name[1] >= '0' && name[1] <= '9')
    return "has a comma; write a decimal point, as in 0.5, and nothing between thousands";
  const std::span<const KnownUnit> units = known_units(unit);
  if (units.empty()) return "unit '" + std::string(name) + "' is not allowed, this number has no unit";
  std::string text = "unknown unit '" + std::string(name) + "', known are";
  for (const KnownUnit& u : units)
    if (u.listed) text.append(&u == units.data() ? " " : ", ").append(u.name);
  return text;
}

}  // namespace

std::string si_unit(Unit unit) {
  const auto known = known_units(unit);
  return known.empty() ? "" : std::string(known.front().name);
}

double parse_quantity(const std::string& text, Unit unit) {
  std::string_view rest = trim(text);
  if (rest.starts_with('+')) rest.remove_prefix(1);
  const std::size_t length = number_length(rest);
  if (length == 0) throw InputError("must be a number, or a number with a unit such as \"16 mm\"");
  const std::string_view number = rest.substr(0, length);
  const std::string name = plain_unit(trim(rest.substr(length)));

  KnownUnit found{};
  bool known = name.empty();
  for (const KnownUnit& u : known_units(unit)) {
    if (u.name != name) continue;
    found = u;
    known = true;
  }
  if (!known) throw InputError(unknown_unit(name, unit));
  const std::optional<double> value = scaled(number, found.power);
  if (!value || !std::isfinite(*value * found.factor)) throw InputError("is not representable as a number");
  return *value * found.factor;
}

std::optional<double> quantity_of_any_unit(const std::string& text) {
  for (const Unit unit :
       {Unit::none, Unit::length, Unit::mass, Unit::time, Unit::frequency, Unit::pressure, Unit::density,
        Unit::velocity, Unit::angular_velocity, Unit::force, Unit::acceleration, Unit::stiffness, Unit::angle_degree}) {
    try {
      return parse_quantity(text, unit);
    } catch (const InputError&) {  // another one may know it
    }
  }
  return std::nullopt;
}

}  // namespace softgrain
