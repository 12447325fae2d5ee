#include "pipelines/law/fit_settings.h"

namespace softgrain {

FitOptions read_fit_settings(const SceneTable& t) {
  FitOptions o;
  o.delta_low = t.number("delta_low", Unit::none, Range::not_negative(), o.delta_low);
  o.delta_high = t.number("delta_high", Unit::none, Range::positive(), o.delta_high);
  o.initial_angle_deg = t.number("initial_angle", Unit::none, Range::positive(), o.initial_angle_deg);
  o.secant_angle_deg = t.number("secant_angle", Unit::none, Range::positive(), o.secant_angle_deg);
  o.noise_floor = t.number("noise_floor", Unit::none, Range::not_negative(), o.noise_floor);
  o.scatter_floor = t.number("scatter_floor", Unit::none, {0.0, 1.0, true, false}, o.scatter_floor);
  o.min_packings = static_cast<int>(t.count("min_packings", 2, 1000000, o.min_packings));
  o.replicates = static_cast<int>(t.count("replicates", 0, 1000000, o.replicates));
  return o;
}

}  // namespace softgrain
