#include "pipelines/kinds/macro/first_point.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/core/statistics.h"
#include "common/core/text.h"
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
           "own tolerance: a smaller preparation_tolerance or a larger start_pressure";
  if (c.twin())
    return "the preparation presses whole bodies, the twin begins with grains that do not yet touch behind their "
           "shells";
  return "the preparation presses bodies as hard grains, the test begins with the law, by which soft particles bear "
         "nothing before their threshold";
}

/// Engines that begin too low for the same reason.
struct Below {
  std::string reason;
  double asked = 0.0;  ///< [Pa]
  std::string engines;
  std::string stresses;
};

}  // namespace

std::vector<std::string> first_point_remarks(const MacroSpec& spec, const std::vector<MacroCurve>& curves) {
  constexpr double kFarBelow = 0.5;
  std::vector<Below> below;
  for (const NamedCurves& one : by_engine(curves)) {
    Tally stress;
    for (const MacroCurve& c : one.curves)
      if (!c.stress_axial.empty()) stress.add(first_mean_stress(c));
    const MacroCurve& c = one.curves.front();
    const double asked = spec.start_pressure * c.start.youngs_modulus;
    const double mean = stress.mean();
    if (!(mean < kFarBelow * asked)) continue;
    const std::string reason = why(c);
    auto at = std::ranges::find_if(below, [&](const Below& b) { return b.reason == reason; });
    if (at == below.end()) at = below.insert(below.end(), {reason, asked, "", ""});
    append_part(at->engines, "'" + c.engine + "'", ", ");
    append_part(at->stresses, rounded_text(mean, {3}), ", ");
  }
  std::vector<std::string> out;
  for (const Below& b : below)
    out.push_back(fmt::format("the first point of {} bears {} Pa, below start_pressure E = {:.3g} Pa: {}", b.engines,
                              b.stresses, b.asked, b.reason));
  return out;
}

}  // namespace softgrain
