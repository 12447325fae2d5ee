#include "pipelines/kinds/material/equation.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "common/core/error.h"
#include "macrosim/grain_record.h"
#include "pipelines/kinds/material/results.h"

namespace softgrain {

namespace {

bool compresses(const StageRecord& stage) {
  return stage.kind == StageKind::oedometric || stage.kind == StageKind::isotropic ||
         stage.kind == StageKind::consolidation;
}

std::vector<StateCurve> curves_of_all(const std::vector<EquationInput>& variants) {
  std::vector<StateCurve> out;
  for (const EquationInput& v : variants)
    for (const MacroCurve& c : v.curves)
      if (takes_part(c)) out.push_back(state_curve(c, v.name, v.span));
  return out;
}

/// Variants of one family that were fitted.
std::vector<std::string> members(const std::vector<EquationInput>& variants, const std::string& family,
                                 const StateFit& fit) {
  std::vector<std::string> names;
  for (const EquationInput& v : variants)
    if (v.family == family &&
        std::any_of(fit.groups.begin(), fit.groups.end(), [&](const StateGroup& g) { return g.name == v.name; }))
      names.push_back(v.name);
  return names;
}

ExtrapolationSummary extrapolate(const StateFit& fit, const std::vector<std::string>& groups, const std::string& family,
                                 double span, const EquationSettings& settings) {
  ExtrapolationSummary s{family, span, settings.largest_span, false, "", {}, {}};
  for (const StateGroup& g : fit.groups)
    if (std::abs(g.span / span - 1.0) < 1e-6 && std::find(groups.begin(), groups.end(), g.name) != groups.end())
      s.measured = g.onset;
  try {
    const OnsetExtrapolation e =
        extrapolate_onset(fit, span, {.largest_span = settings.largest_span, .groups = groups});
    s.usable = e.usable;
    s.message = e.message;
    s.largest_fitted = e.largest_span;
    if (e.usable) s.onset = e.onset;
  } catch (const BadInput& e) {
    s.message = e.what();
  }
  return s;
}

}  // namespace

EquationSettings read_equation(const SceneTable& t) {
  EquationSettings s;
  s.form = t.choice<StateForm>("form", s.form);
  s.largest_span = t.number("largest_span", Unit::none, Range::above(1.0), s.largest_span);
  s.spans = t.numbers("spans", Unit::none, Range::above(1.0), s.spans);
  s.replicates = t.count("replicates", 40, 100000, s.replicates);
  return s;
}

StateCurve state_curve(const MacroCurve& c, const std::string& group, double span) {
  StateCurve out{group, span, {}, {}, {}};
  const auto phi = c.more.find(kSolidFraction);
  if (phi == c.more.end()) return out;
  const std::vector<double> p = mean_stresses(c);
  for (std::size_t k = 0; k < phi->second.size(); ++k) {
    const bool goes_on = out.phi.empty() || phi->second[k] > out.phi.back();
    if (!goes_on || !compresses(c.stages[static_cast<std::size_t>(c.stage[k])])) break;
    out.phi.push_back(phi->second[k]);
    out.pressure.push_back(p[k] / c.start.youngs_modulus);
  }
  return out;
}

bool takes_part(const MacroCurve& c) {
  constexpr std::size_t kLeast = 4;
  return c.usable && state_curve(c, "", 1.0).phi.size() >= kLeast;
}

std::optional<EquationResult> equation_of(const std::vector<EquationInput>& variants, const EquationSettings& settings,
                                          std::uint64_t seed) {
  const std::vector<StateCurve> curves = curves_of_all(variants);
  if (curves.empty()) return std::nullopt;
  EquationResult out;
  EquationSummary& s = out.summary;
  StateFit& fit = out.fit;
  s.form = settings.form;
  try {
    fit = fit_equation_of_state(
        curves, {.form = settings.form, .replicates = static_cast<int>(settings.replicates), .seed = seed});
  } catch (const BadInput& e) {
    s.message = e.what();
    return out;
  }
  s.usable = fit.usable;
  s.message = fit.message;
  s.modulus = fit.modulus;
  s.exponent = fit.exponent;
  s.pressure_deviation = fit.pressure_deviation;
  s.modulus_scatter = fit.modulus_scatter;
  s.collapse_probability = fit.collapse_probability;
  for (const StateGroup& g : fit.groups) s.onsets.push_back({g.name, g.span, g.samples, g.onset, g.own_modulus});
  if (!fit.usable) return out;
  std::set<std::string> families;
  for (const EquationInput& v : variants) families.insert(v.family);
  for (const std::string& family : families) {
    const std::vector<std::string> groups = members(variants, family, fit);
    if (groups.size() < 2) continue;
    for (const double span : settings.spans)
      s.extrapolations.push_back(extrapolate(fit, groups, family, span, settings));
  }
  return out;
}

}  // namespace softgrain
