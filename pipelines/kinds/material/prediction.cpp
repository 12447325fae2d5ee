#include "pipelines/kinds/material/prediction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "calibrate/response_prediction.h"
#include "common/core/error.h"
#include "common/core/text.h"
#include "macrosim/body_contacts.h"
#include "pipelines/compare/stage_results.h"
#include "pipelines/kinds/material/scene.h"

namespace softgrain {

namespace {

ResponseCurve response_of(const MacroCurve& c, const std::string& group) {
  ResponseCurve out{group, {}, mean_stresses(c), {}, stress_ratios(c)};
  const std::vector<double>& phi = c.more.at(kSolidFraction);
  for (std::size_t k = 0; k < phi.size(); ++k) {
    out.volume.push_back(phi.front() / phi[k]);
    out.pressure[k] /= c.start.youngs_modulus;
    out.ratio.push_back(0.5 * (c.stress_x[k] + c.stress_y[k]) / c.stress_axial[k]);
  }
  return out;
}

/// A whole test in one stage, with a number at every point.
bool predictable(const MacroCurve& c) {
  if (!c.usable || c.stages.size() != 1 || !c.more.contains(kSolidFraction)) return false;
  const ResponseCurve r = response_of(c, "");
  const auto numbers = [](const std::vector<double>& v) {
    return std::ranges::all_of(v, [](double x) { return std::isfinite(x); });
  };
  return !r.pressure.empty() && *std::min_element(r.pressure.begin(), r.pressure.end()) > 0.0 && numbers(r.ratio) &&
         numbers(r.deviator);
}

/// All of one family under one loading.
struct Group {
  std::vector<const PredictionInput*> inputs;

  [[nodiscard]] StageKind kind() const { return inputs.front()->curves.front().stages.front().kind; }
  [[nodiscard]] std::vector<StateCurve> states(double largest_span) const {
    std::vector<StateCurve> out;
    for (const PredictionInput* in : inputs)
      for (const MacroCurve& c : in->curves)
        if (takes_part(c) && (largest_span <= 0.0 || in->span <= largest_span))
          out.push_back(state_curve(c, in->material, in->span));
    return out;
  }
  [[nodiscard]] std::vector<ResponseCurve> responses(const StateFit& fit) const {
    std::vector<ResponseCurve> out;
    for (const PredictionInput* in : inputs)
      if (fit.find(in->material) != nullptr)
        for (const MacroCurve& c : in->curves)
          if (predictable(c)) out.push_back(response_of(c, in->material));
    return out;
  }
};

/// Curves of a span that was measured.
std::vector<const MacroCurve*> measured_at(const Group& group, double span) {
  std::vector<const MacroCurve*> out;
  for (const PredictionInput* in : group.inputs)
    if (std::abs(in->span / span - 1.0) < 1e-6)
      for (const MacroCurve& c : in->curves)
        if (predictable(c)) out.push_back(&c);
  return out;
}

std::optional<MeanError> mean_of(const std::vector<double>& values) {
  return values.empty() ? std::nullopt : std::optional(mean_error(values));
}

std::vector<PredictedPoint> points_of(const ResponsePrediction& p, const std::vector<double>& strain,
                                      const std::vector<const MacroCurve*>& measured, double highest) {
  std::vector<ResponseCurve> curves;
  for (const MacroCurve* c : measured)
    if (c->strain.size() == strain.size()) curves.push_back(response_of(*c, ""));
  std::vector<PredictedPoint> out;
  for (std::size_t k = 0; k < strain.size(); ++k) {
    const auto over = [&](auto&& value) {
      std::vector<double> values;
      for (const ResponseCurve& c : curves) values.push_back(value(c));
      return mean_of(values);
    };
    const auto axial = [&](const ResponseCurve& c) { return 3.0 * c.pressure[k] / (1.0 + 2.0 * c.ratio[k]); };
    PredictedPoint point{strain[k], {}, {}, {}, {}, p.pressure[k].value > highest};
    point.pressure = {p.pressure[k], over([&](const ResponseCurve& c) { return c.pressure[k]; })};
    point.axial = {p.axial[k], over(axial)};
    point.lateral = {p.lateral[k], over([&](const ResponseCurve& c) { return c.ratio[k] * axial(c); })};
    point.deviator = {p.deviator[k], over([&](const ResponseCurve& c) { return c.deviator[k]; })};
    out.push_back(point);
  }
  return out;
}

PredictionSummary predict(const Group& group, const StateFit& fit, double span, const EquationSettings& settings,
                          std::uint64_t seed) {
  const PredictionInput& first = *group.inputs.front();
  PredictionSummary s{.family = first.family, .loading = first.loading, .kind = group.kind(), .span = span};
  try {
    const OnsetOptions onset{.largest_span = settings.largest_span, .groups = {}, .exponent = first.exponent};
    const ResponseOptions options{settings.form, first.start_pressure, seed, onset};
    const ResponsePrediction p = predict_response(fit, group.responses(fit), span, options);
    s.usable = p.usable;
    s.message = p.message;
    s.largest_fitted = p.onset.largest_span;
    if (!p.usable) return s;
    s.solid_fraction = p.solid_fraction;
    const auto measured = measured_at(group, span);
    s.samples_measured = static_cast<int>(measured.size());
    std::vector<double> strain;
    for (const PredictionInput* in : group.inputs)
      for (const MacroCurve& c : in->curves)
        if (strain.empty() && predictable(c)) strain = c.strain_z;
    double highest = 0.0;
    for (const StateCurve& c : group.states(settings.largest_span))
      highest = std::max(highest, *std::max_element(c.pressure.begin(), c.pressure.end()));
    s.points = points_of(p, strain, measured, highest);
  } catch (const InputError& e) {
    s.usable = false;
    s.message = e.what();
  }
  return s;
}

std::size_t spans_up_to(const Group& group, double largest_span) {
  std::vector<double> spans;
  for (const PredictionInput* in : group.inputs)
    if (largest_span <= 0.0 || in->span <= largest_span) spans.push_back(in->span);
  std::sort(spans.begin(), spans.end());
  return static_cast<std::size_t>(std::unique(spans.begin(), spans.end()) - spans.begin());
}

}  // namespace

std::vector<PredictionSummary> predict_spans(const std::vector<PredictionInput>& inputs,
                                             const EquationSettings& settings, std::uint64_t seed) {
  std::vector<PredictionSummary> out;
  if (settings.spans.empty()) return out;
  std::map<std::string, std::vector<std::pair<std::string, Group>>> families;  // loadings in the order of the scene
  for (const PredictionInput& in : inputs) {
    if (std::ranges::none_of(in.curves, predictable)) continue;
    auto& loadings = families[in.family];
    auto at = std::ranges::find_if(loadings, [&](const auto& l) { return l.first == in.loading; });
    if (at == loadings.end()) at = loadings.insert(at, {in.loading, {}});
    at->second.inputs.push_back(&in);
  }
  for (const auto& [family, loadings] : families) {
    std::optional<StateFit> first;  // behind loadings that do not compress
    for (const bool compressing : {true, false})
      for (const auto& [name, group] : loadings) {
        const std::vector<StateCurve> states = group.states(settings.largest_span);
        if (states.empty() == compressing || spans_up_to(group, settings.largest_span) < 2) continue;
        StateFit own;
        if (compressing)
          own = fit_equation_of_state(
              states, {.form = settings.form, .replicates = static_cast<int>(settings.replicates), .seed = seed});
        if (compressing && !first) first = own;
        if (!compressing && !first) continue;
        for (const double span : settings.spans)
          out.push_back(predict(group, compressing ? own : *first, span, settings, seed));
      }
  }
  return out;
}

const PredictedPoint& point_near(const PredictionSummary& prediction, double strain) {
  return *std::min_element(prediction.points.begin(), prediction.points.end(),
                           [&](const PredictedPoint& a, const PredictedPoint& b) {
                             return std::abs(a.strain - strain) < std::abs(b.strain - strain);
                           });
}

namespace {

std::string value_text(const char* name, const PredictedValue& v, double scale) {
  std::string text = fmt::format("{} {:.3f} ({:.3f} to {:.3f}", name, scale * v.predicted.value,
                                 scale * v.predicted.low, scale * v.predicted.high);
  text += fmt::format(", {:.0f} % wide)", 100.0 * v.width());
  if (!v.measured) return text;
  const MeanError& m = *v.measured;
  const auto error = m.n > 1 ? std::optional(scale * m.error) : std::nullopt;
  return text + fmt::format(", measured {}: {}",
                            with_error(scale * m.mean, error, {.value = {3, true}, .error = {3, true}}),
                            v.inside() ? "inside" : "outside");
}

}  // namespace

std::string prediction_text(const std::vector<PredictionSummary>& predictions) {
  constexpr double kThousand = 1000.0;
  std::string text;
  for (const PredictionSummary& s : predictions) {
    text += fmt::format("  {}{}, span {:g}: ", s.family, s.loading.empty() ? "" : ", " + s.loading, s.span);
    if (!s.usable) {
      text += "not predicted: " + s.message + "\n";
      continue;
    }
    text += fmt::format("solid fraction {:.4f} ({:.4f} to {:.4f}) at the start; onset by {}\n", s.solid_fraction->value,
                        s.solid_fraction->low, s.solid_fraction->high, s.message);
    std::vector<double> strains;
    for (const double e : {0.02, 0.05, 0.08}) {
      const double nearest = point_near(s, e).strain;
      if (strains.empty() || nearest > strains.back()) strains.push_back(nearest);
    }
    for (const double e : strains) {
      const PredictedPoint& p = point_near(s, e);
      text += fmt::format("    strain {:.3g} %: ", 100.0 * e);
      if (s.kind == StageKind::isotropic)
        text += value_text("1000 p/E", p.pressure, kThousand);
      else if (s.kind == StageKind::shear)
        text += value_text("q/p", p.deviator, 1.0);
      else
        text += value_text("1000 axial/E", p.axial, kThousand) + "; " + value_text("lateral", p.lateral, kThousand);
      text += p.beyond && s.kind != StageKind::shear ? "; beyond the pressures that were fitted\n" : "\n";
    }
  }
  return text.empty() ? text : "predicted from smaller spans:\n" + text;
}

}  // namespace softgrain
