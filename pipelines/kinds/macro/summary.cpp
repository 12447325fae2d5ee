// Numbers and curves by which macro runs, and resolved materials, are set beside others.
#include "pipelines/kinds/macro/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <optional>

#include "common/core/statistics.h"
#include "common/core/text.h"
#include "pipelines/compare/compare.h"
#include "pipelines/compare/stage_results.h"

namespace softgrain {

namespace {

std::string called(const std::string& what, const std::string& name) {
  return name.empty() ? what : what + " (" + name + ")";
}

void add_mean(std::vector<RunValue>& out, const std::string& name, const std::string& unit, const MeanError& m) {
  if (m.n > 0) out.push_back({name, unit, m.mean, m.error});
}

MeanError mean_at_end(const std::vector<MacroCurve>& curves, const std::function<double(const MacroCurve&)>& value) {
  std::vector<double> values;
  for (const MacroCurve& c : curves) {
    if (!c.usable || c.strain.empty()) continue;
    if (const double v = value(c); std::isfinite(v)) values.push_back(v);
  }
  return mean_error(values);
}

void add_stage_values(std::vector<RunValue>& out, const NamedCurves& one) {
  const auto stages =
      one.curves.empty() ? std::vector<StageMeans>{} : stage_means(one.curves, one.curves.front().engine);
  const auto add_known = [&](const std::string& what, const char* unit, const std::optional<MeanError>& m) {
    if (m) add_mean(out, called(what, one.name), unit, *m);
  };
  for (const StageMeans& s : stages) {
    const std::string where = stages.size() > 1 ? ", " + s.record.name : "";
    if (s.record.kind != StageKind::hold) {
      const std::string modulus = to_string(modulus_of(s.record.way)) + " modulus";
      add_known(modulus + ", " + modulus_interval(s) + where, "Pa", s.modulus);
      if (stages.size() > 1) add_known(modulus + " at the begin" + where, "Pa", s.modulus_begin);
    }
    add_known("largest q/p" + where, "", s.ratio_peak);
    add_known("largest shear over normal stress" + where, "", s.friction_peak);
  }
}

/// Nothing of a column that was not recorded at every point.
bool recorded(const MacroCurve& c, const std::vector<double>& column) {
  return !column.empty() && column.size() == c.strain.size();
}

/// (sigma_x + sigma_y + sigma_z)/3 of the first point; of curves that do not have these the axial stress.
double first_mean_stress(const MacroCurve& c) {
  if (c.stress_x.empty() || c.stress_y.empty()) return c.stress_axial.front();
  return (c.stress_x.front() + c.stress_y.front() + c.stress_axial.front()) / 3.0;
}

const char* why(const MacroSpec& spec, const MacroCurve& c) {
  if (c.soft == 0 && spec.protocol.friction > spec.friction)
    return "the preparation had more friction than the test, which the packing does not hold without: a compaction_mu "
           "of mu at most";
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

/// Axial or shear stress of a part of a test, mean over the samples that have all its points; without points where none
/// has any.
RunCurve mean_stress_curve(const NamedCurves& one, StrainPart part,
                           std::vector<double> MacroCurve::*column = &MacroCurve::stress_axial) {
  std::vector<std::array<std::vector<double>, 2>> samples;
  std::size_t points = 0;
  for (const MacroCurve& c : one.curves) {
    const std::vector<double>& strain = strain_of_part(c, part);
    if (!c.usable || !recorded(c, c.*column) || strain.size() != c.strain.size()) continue;
    const std::vector<std::size_t> taken = points_of_stages(c, part);
    samples.push_back({values_at(strain, taken), values_at(c.*column, taken)});
    points = std::max(points, taken.size());
  }
  std::erase_if(samples, [&](const auto& s) { return s[0].size() != points; });
  const MacroTest test = one.curves.empty() ? MacroTest::oedometric : one.curves.front().test;
  const bool axial = column == &MacroCurve::stress_axial;
  RunCurve out{
      std::string(axial ? "Axial" : "Shear") + " stress" + (part == StrainPart::shear ? ", stages that slide" : ""),
      strain_label(part, test),
      axial ? "axial stress" : "shear stress",
      "Pa",
      one.name,
      {},
      {}};
  for (std::size_t k = 0; k < points; ++k) {
    double strain = 0.0;
    double stress = 0.0;
    for (const auto& s : samples) {
      strain += 100.0 * s[0][k];
      stress += s[1][k];
    }
    out.x.push_back(strain / static_cast<double>(samples.size()));
    out.y.push_back(stress / static_cast<double>(samples.size()));
  }
  return out;
}

}  // namespace

std::vector<NamedCurves> by_engine(const std::vector<MacroCurve>& curves) {
  std::vector<NamedCurves> out;
  for (const MacroCurve& c : curves) {
    auto at = std::find_if(out.begin(), out.end(), [&](const NamedCurves& one) { return one.name == c.engine; });
    if (at == out.end()) at = out.insert(out.end(), {c.engine, {}});
    at->curves.push_back(c);
  }
  if (out.size() == 1) out.front().name.clear();
  return out;
}

std::vector<RunValue> stress_values(const std::vector<NamedCurves>& all) {
  std::vector<RunValue> out;
  for (const NamedCurves& one : all)
    add_mean(out, called("axial stress at the end", one.name), "Pa",
             mean_at_end(one.curves, [](const MacroCurve& c) { return c.stress_axial.back(); }));
  for (const NamedCurves& one : all)
    add_mean(out, called("lateral over axial stress at the end", one.name), "",
             mean_at_end(one.curves, [](const MacroCurve& c) {
               return recorded(c, c.stress_lateral) && c.stress_axial.back() != 0.0
                          ? c.stress_lateral.back() / c.stress_axial.back()
                          : kNaN;
             }));
  for (const NamedCurves& one : all) add_stage_values(out, one);
  return out;
}

std::vector<RunCurve> stress_curves(const std::vector<NamedCurves>& all) {
  std::vector<RunCurve> out;
  for (const NamedCurves& one : all)
    for (const StrainPart part : strain_parts(one.curves.empty() ? MacroTest::oedometric : one.curves.front().test)) {
      RunCurve curve = mean_stress_curve(one, part);
      if (!curve.x.empty()) out.push_back(std::move(curve));
      if (part != StrainPart::shear) continue;
      curve = mean_stress_curve(one, part, &MacroCurve::stress_xz);
      curve.in_terminal = true;  // the axial stress may be imposed there
      if (!curve.x.empty()) out.push_back(std::move(curve));
    }
  return out;
}

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
    const std::string reason = why(spec, c);
    auto at = std::ranges::find(below, reason, &Below::reason);
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
