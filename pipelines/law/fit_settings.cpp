#include "pipelines/law/fit_settings.h"

#include <optional>

namespace softgrain {

namespace {

/// Reads an angle in degrees. `plain` is another name of the key, without its unit, in scenes and command lines of
/// earlier versions.
std::optional<double> read_angle(const SceneTable& t, const std::string& key, const std::string& plain) {
  if (t.has(plain) && t.has(key)) t.throw_error(plain, "is another name of " + key + ": give one of them");
  const std::string& given = t.has(plain) ? plain : key;
  if (!t.has(given)) return std::nullopt;
  return t.number(given, Unit::angle_degree, Range::positive());
}

}  // namespace

FitOptions read_fit_settings(const SceneTable& t) {
  FitOptions o;
  o.delta_low = t.number("delta_low", Unit::none, Range::not_negative(), o.delta_low);
  if (t.has("delta_high")) o.delta_high = t.number("delta_high", Unit::none, Range::above(o.delta_low));
  o.initial_angle_deg = read_angle(t, "initial_angle_deg", "initial_angle").value_or(o.initial_angle_deg);
  o.secant_angle_deg = read_angle(t, "secant_angle_deg", "secant_angle");
  o.noise_floor = t.number("noise_floor", Unit::none, Range::not_negative(), o.noise_floor);
  o.scatter_floor = t.number("scatter_floor", Unit::none, {0.0, 1.0, true, false}, o.scatter_floor);
  o.min_packings = static_cast<int>(t.count("min_packings", 2, 1000000, o.min_packings));
  o.replicates = static_cast<int>(t.count("replicates", 0, 1000000, o.replicates));
  return o;
}

}  // namespace softgrain
