#include "pipelines/law/fit_settings.h"

#include <optional>

namespace softgrain {

namespace {

/// Reads an angle in degrees. `plain` is another name of the key, without its unit, in scenes and command lines of
/// earlier versions.
std::optional<double> read_angle(const SceneTable& t, const Key& key, const std::string& plain) {
  if (t.has(plain) && t.has(key.name)) t.throw_error(plain, "is another name of " + key.name + ": give one of them");
  const Key given = t.has(plain) ? Key(plain, "another name of `" + key.name + "`") : key;
  if (!t.has(given.name)) return std::nullopt;
  return t.number(given, Unit::angle_degree, Range::positive());
}

}  // namespace

FitOptions read_fit_settings(const SceneTable& t) {
  FitOptions o;
  o.delta_low =
      t.number({"delta_low", "lower end of the fitted range of Delta"}, Unit::none, Range::not_negative(), o.delta_low);
  if (t.has("delta_high"))
    o.delta_high = t.number({"delta_high", "upper end of the fitted range of Delta", "all"}, Unit::none,
                            Range::above(o.delta_low));
  o.initial_angle_deg =
      read_angle(t, {"initial_angle_deg", "largest angle of the initial slope of the tangential force", "0.05"},
                 "initial_angle")
          .value_or(o.initial_angle_deg);
  o.secant_angle_deg = read_angle(
      t, {"secant_angle_deg", "angle of the secant of the tangential force", "1; soft-soft: 0.5 if measured"},
      "secant_angle");
  o.noise_floor = t.number({"noise_floor", "a mean force below this value, over E Rs^2, counts as zero"}, Unit::none,
                           Range::not_negative(), o.noise_floor);
  o.scatter_floor =
      t.number({"scatter_floor", "least standard deviation in the weight of a point, over that pooled from all points"},
               Unit::none, {0.0, 1.0, true, false}, o.scatter_floor);
  o.min_packings = static_cast<int>(
      t.count({"min_packings", "with fewer packings the law is marked underdetermined"}, 2, 1000000, o.min_packings));
  o.replicates = static_cast<int>(t.count(
      {"replicates", "number of bootstrap replicates (fits to packings drawn with replacement); 0: no intervals"}, 0,
      1000000, o.replicates));
  return o;
}

}  // namespace softgrain
