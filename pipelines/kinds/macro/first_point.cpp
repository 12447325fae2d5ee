#include "pipelines/kinds/macro/first_point.h"

#include <fmt/format.h>

#include "common/core/statistics.h"
#include "pipelines/kinds/macro/values.h"

namespace softgrain {

namespace {

/// (sigma_x + sigma_y + sigma_z)/3 of the first point; of curves that do not have these the axial stress.
double first_mean_stress(const MacroCurve& c) {
  if (c.stress_x.empty() || c.stress_y.empty()) return c.stress_axial.front();
  return (c.stress_x.front() + c.stress_y.front() + c.stress_axial.front()) / 3.0;
}

const char* why(const MacroCurve& c) {
  if (c.soft == 0)
    return "the preparation stops at preparation_tolerance, and contacts open when the test relaxes the packing to its "
           "own "
           "tolerance: a smaller preparation_tolerance or a larger start_pressure";
  if (c.twin())
    return "the preparation presses whole bodies, the twin begins with grains that do not yet touch behind their "
           "shells";
  return "the preparation presses bodies as hard grains, the test begins with the law, by which soft particles bear "
         "nothing before their threshold";
}

}  // namespace

std::vector<std::string> first_point_remarks(const MacroSpec& spec, const std::vector<MacroCurve>& curves) {
  constexpr double kFarBelow = 0.5;
  std::vector<std::string> out;
  for (const NamedCurves& one : by_engine(curves)) {
    Tally stress;
    for (const MacroCurve& c : one.curves)
      if (!c.stress_axial.empty()) stress.add(first_mean_stress(c));
    const MacroCurve& c = one.curves.front();
    const double asked = spec.start_pressure * c.start.youngs_modulus;
    const double mean = stress.mean();
    if (!(mean < kFarBelow * asked)) continue;
    out.push_back(fmt::format("the first point of '{}' bears {:.3g} Pa, below start_pressure E = {:.3g} Pa: {}",
                              c.engine, mean, asked, why(c)));
  }
  return out;
}

}  // namespace softgrain
