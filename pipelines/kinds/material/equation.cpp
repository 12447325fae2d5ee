#include "pipelines/kinds/material/equation.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "calibrate/response_prediction.h"
#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/statistics.h"
#include "common/core/text.h"
#include "macrosim/body_contacts.h"
#include "pipelines/kinds/material/scene.h"

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

/// phi_J of all samples of a span, with K and n of `fit`.
std::optional<Estimate> measured_onset(const StateFit& fit, StateForm form, const std::vector<StateCurve>& curves,
                                       double span) {
  std::vector<double> onsets;
  for (const StateCurve& c : curves)
    if (std::abs(c.span / span - 1.0) < 1e-6)
      onsets.push_back(fitted_onset(form, fit.modulus.value, fit.exponent.value, c));
  if (onsets.empty()) return std::nullopt;
  return mean_estimate(mean_error(onsets), 0.0, 1.0);
}

/// Larger spans take no part, in K and n neither.
StateFit fit_family(const std::vector<StateCurve>& curves, const EquationSettings& settings, std::uint64_t seed) {
  std::vector<StateCurve> some;
  for (const StateCurve& c : curves)
    if (settings.largest_span <= 0.0 || c.span <= settings.largest_span) some.push_back(c);
  return fit_equation_of_state(
      some, {.form = settings.form, .replicates = static_cast<int>(settings.replicates), .seed = seed});
}

/// Extrapolated onsets of a family of variants that differ in the span alone. `curves` are theirs.
std::vector<ExtrapolationSummary> extrapolate(const std::string& family, const std::vector<StateCurve>& curves,
                                              double exponent, const EquationSettings& settings, std::uint64_t seed) {
  std::vector<ExtrapolationSummary> out;
  StateFit fit;
  std::optional<StateFit> with_onsets;  // the fit and what was measured elsewhere, the same for every span
  for (const double span : settings.spans) {
    ExtrapolationSummary s{family, span, settings.largest_span, false, "", {}, {}, {}};
    try {
      if (fit.groups.empty()) fit = fit_family(curves, settings, seed);
      if (fit.usable) s.measured = measured_onset(fit, settings.form, curves, span);
      if (!with_onsets) with_onsets = with_known_onsets(fit, settings.onsets, seed);
      const OnsetExtrapolation e = extrapolate_onset(*with_onsets, span, {.groups = {}, .exponent = exponent});
      s.usable = e.usable;
      s.message = e.message;
      s.largest_fitted = e.largest_span;
      if (e.usable) s.onset = e.onset;
      for (const OnsetFormFit& f : e.forms)
        if (!f.parameters.empty()) s.forms.push_back({to_string(f.form), f.usable, f.message, f.parameters, f.onset});
    } catch (const InputError& e) {
      s.message = e.what();
    }
    out.push_back(std::move(s));
  }
  return out;
}

KnownOnset read_onset(const SceneTable& t) {
  constexpr Range kBetween{0.0, 1.0, true, true};
  KnownOnset out;
  out.span = t.number({"span", "largest over smallest radius"}, Unit::none, kSizeRatios);
  out.value = t.number({"value", "solid fraction phi_J at which pressure begins"}, Unit::none, kBetween);
  out.standard_error = t.number({"standard_error", "its standard error"}, Unit::none, kBetween);
  return out;
}

}  // namespace

EquationSettings read_equation(const SceneTable& t) {
  EquationSettings s;
  s.form = t.choice<StateForm>({"form", "form of the equation of state"}, s.form);
  s.largest_span = t.number({"largest_span", "largest span of the variants that extrapolations use", "all"}, Unit::none,
                            Range::above(1.0), s.largest_span);
  s.spans = t.numbers({"spans", "spans for which the onset of pressure is extrapolated from the variants", "none"},
                      Unit::none, kSizeRatios, s.spans);
  s.replicates = t.count({"replicates", "bootstrap replicates of the fit"}, 40, 100000, s.replicates);
  for (const SceneTable& one :
       t.tables({"onset",
                 "onset of pressure of a span that was measured elsewhere, for extrapolations beside the variants"}))
    s.onsets.push_back(read_onset(one));
  return s;
}

StateCurve state_curve(const MacroCurve& c, const std::string& group, double span) {
  StateCurve out{group, span, {}, {}, {}};
  const auto phi = c.more.find(kSolidFraction);
  if (phi == c.more.end() || c.stages.empty()) return out;
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

std::vector<std::string> extrapolation_warnings(const EquationSummary& s) {
  std::map<std::pair<std::string, std::string>, std::vector<std::string>> spans;  // by family and reason
  for (const ExtrapolationSummary& e : s.extrapolations)
    if (!e.usable) spans[{e.family, e.message}].push_back(fmt::format("{:g}", e.span));
  std::vector<std::string> out;
  for (const auto& [of, missing] : spans)
    out.push_back(
        fmt::format("phi_J of {} is not extrapolated to span {}: {}{}", of.first, join_text(missing), of.second,
                    s.known.empty() ? "" : "; are the onsets in [[equation.onset]] of this material and preparation?"));
  return out;
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
  } catch (const InputError& e) {
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
  s.known = settings.onsets;
  if (!fit.usable) return out;
  std::map<std::string, std::vector<EquationInput>> families;
  for (const EquationInput& v : variants) families[v.family].push_back(v);
  for (const auto& [family, members] : families) {
    const std::vector<StateCurve> own = curves_of_all(members);
    std::set<double> spans;
    for (const StateCurve& c : own) spans.insert(c.span);
    for (const KnownOnset& known : settings.onsets) spans.insert(known.span);
    if (spans.size() < 2) continue;
    for (ExtrapolationSummary& e : extrapolate(family, own, members.front().exponent, settings, seed))
      s.extrapolations.push_back(std::move(e));
  }
  return out;
}

}  // namespace softgrain
