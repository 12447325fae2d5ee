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

/// Where the volume is held q/p is what is predicted; elsewhere the pressure is, which may grow a thousandfold.
double bearing_share(const MacroCurve& c) { return keeps_volume(c.stages.front().kind) ? kBearingShare : 0.0; }

ResponseCurve response_of(const MacroCurve& c, const std::string& group) {
  ResponseCurve out{group, {}, mean_stresses(c), {}, stress_ratios(c, bearing_share(c))};
  const std::vector<double>& phi = c.more.at(kSolidFraction);
  for (std::size_t k = 0; k < phi.size(); ++k) {
    out.volume.push_back(phi.front() / phi[k]);
    out.pressure[k] /= c.start.youngs_modulus;
    out.ratio.push_back(0.5 * (c.stress_x[k] + c.stress_y[k]) / c.stress_axial[k]);
  }
  return out;
}

/// A whole test in one stage, whose axes strain.
bool of_one_stage(const MacroCurve& c) {
  return c.usable && c.stages.size() == 1 && !slides(c.stages.front().way) && c.more.contains(kSolidFraction);
}

/// A whole test in one stage, with a number at every point.
bool predictable(const MacroCurve& c) {
  if (!of_one_stage(c)) return false;
  const ResponseCurve r = response_of(c, "");
  const auto numbers = [](const std::vector<double>& v) {
    return std::ranges::all_of(v, [](double x) { return std::isfinite(x); });
  };
  return !r.pressure.empty() && *std::min_element(r.pressure.begin(), r.pressure.end()) > 0.0 && numbers(r.ratio) &&
         numbers(r.deviator);
}

/// All of one family in one test.
struct Group {
  std::vector<const PredictionInput*> inputs;

  [[nodiscard]] StageKind kind() const {
    return std::ranges::find_if(inputs.front()->curves, predictable)->stages.front().kind;
  }
  [[nodiscard]] std::vector<StateCurve> states(double largest_span) const {
    std::vector<StateCurve> out;
    for (const PredictionInput* in : inputs)
      for (const MacroCurve& c : in->curves)
        if (takes_part(c) && (largest_span <= 0.0 || in->span <= largest_span))
          out.push_back(state_curve(c, in->material, in->span));
    return out;
  }
  [[nodiscard]] bool has_part_in(const StateFit& fit) const {
    return std::ranges::any_of(inputs, [&](const auto* in) { return fit.find(in->material) != nullptr; });
  }
  [[nodiscard]] std::vector<ResponseCurve> responses(const StateFit& fit) const {
    std::vector<ResponseCurve> out;
    for (const PredictionInput* in : inputs)
      if (fit.find(in->material) != nullptr)
        for (const MacroCurve& c : in->curves)
          if (predictable(c)) out.push_back(response_of(c, in->material));
    return out;
  }
  /// Axial strains of the points of responses(), which have all the same: those of a variant that has no part may be
  /// others.
  [[nodiscard]] std::vector<double> strains(const StateFit& fit) const {
    for (const PredictionInput* in : inputs)
      if (fit.find(in->material) != nullptr)
        for (const MacroCurve& c : in->curves)
          if (predictable(c)) return c.strain_z;
    return {};
  }
};

/// The equation of state of one test that compresses, or why there is none.
struct FittedTest {
  StateFit fit{};
  std::string problem{};
  double highest = 0.0;  ///< largest pressure over E that it was fitted to

  FittedTest(const Group& group, const EquationSettings& settings, std::uint64_t seed) {
    const std::vector<StateCurve> states = group.states(settings.largest_span);
    for (const StateCurve& c : states)
      highest = std::max(highest, *std::max_element(c.pressure.begin(), c.pressure.end()));
    try {
      fit = with_known_onsets(
          fit_equation_of_state(
              states, {.form = settings.form, .replicates = static_cast<int>(settings.replicates), .seed = seed}),
          settings.onsets, seed);
    } catch (const InputError& e) {
      problem = e.what();
    }
  }
};

bool same_points(const std::vector<double>& a, const std::vector<double>& b) {
  return std::ranges::equal(a, b, [](double x, double y) { return std::abs(x - y) < 1e-6; });
}

/// Curves of a span that was measured, at these strains.
std::vector<const MacroCurve*> measured_at(const Group& group, double span, const std::vector<double>& strain) {
  std::vector<const MacroCurve*> out;
  for (const PredictionInput* in : group.inputs)
    if (std::abs(in->span / span - 1.0) < 1e-6)
      for (const MacroCurve& c : in->curves)
        if (predictable(c) && same_points(c.strain_z, strain)) out.push_back(&c);
  return out;
}

std::optional<MeanError> mean_of(const std::vector<double>& values) {
  return values.empty() ? std::nullopt : std::optional(mean_error(values));
}

std::vector<PredictedPoint> points_of(const ResponsePrediction& p, const std::vector<double>& strain,
                                      const std::vector<const MacroCurve*>& measured, double highest) {
  std::vector<ResponseCurve> curves;
  for (const MacroCurve* c : measured) curves.push_back(response_of(*c, ""));
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

PredictionSummary predict(const Group& group, const FittedTest& fitted, double span, const EquationSettings& settings,
                          std::uint64_t seed) {
  const PredictionInput& first = *group.inputs.front();
  PredictionSummary s{
      .family = first.family + first.test, .loading = first.loading, .kind = group.kind(), .span = span};
  const StateFit& fit = fitted.fit;
  try {
    if (!fitted.problem.empty()) throw InputError(fitted.problem);
    if (!group.has_part_in(fit))
      throw InputError("no equation of state: these packings are in no test that compresses");
    const OnsetOptions onset{.groups = {}, .exponent = first.exponent};  // the fit has no others
    const ResponseOptions options{settings.form, first.start_pressure, seed, onset};
    const ResponsePrediction p = predict_response(fit, group.responses(fit), span, options);
    s.usable = p.usable;
    s.message = p.message;
    s.largest_fitted = p.onset.largest_span;
    if (!p.usable) return s;
    s.solid_fraction = p.solid_fraction;
    const std::vector<double> strain = group.strains(fit);
    if (strain.size() != p.pressure.size()) throw InputError("responses: their points have no strains");
    const auto measured = measured_at(group, span, strain);
    s.samples_measured = static_cast<int>(measured.size());
    s.points = points_of(p, strain, measured, fitted.highest);
  } catch (const InputError& e) {
    s.usable = false;
    s.message = e.what();
  }
  return s;
}

/// The first fit that knows packings of a test that does not compress them, else the first; null: there is none.
const FittedTest* fit_behind(const Group& group, const std::vector<FittedTest>& fitted) {
  const auto at = std::ranges::find_if(fitted, [&](const FittedTest& f) { return group.has_part_in(f.fit); });
  if (at != fitted.end()) return &*at;
  return fitted.empty() ? nullptr : fitted.data();
}

/// Number of spans to extrapolate from.
std::size_t spans_known(const Group& group, const EquationSettings& settings) {
  std::vector<double> spans;
  for (const PredictionInput* in : group.inputs)
    if (settings.largest_span <= 0.0 || in->span <= settings.largest_span) spans.push_back(in->span);
  if (spans.empty()) return 0;
  for (const KnownOnset& known : settings.onsets) spans.push_back(known.span);
  std::sort(spans.begin(), spans.end());
  return static_cast<std::size_t>(std::unique(spans.begin(), spans.end()) - spans.begin());
}

}  // namespace

std::vector<PredictionSummary> predict_spans(const std::vector<PredictionInput>& inputs,
                                             const EquationSettings& settings, std::uint64_t seed) {
  std::vector<PredictionSummary> out;
  if (settings.spans.empty()) return out;
  std::map<std::string, std::vector<Group>> families;  // tests in the order of the scene
  for (const PredictionInput& in : inputs) {
    if (std::ranges::none_of(in.curves, predictable)) continue;
    std::vector<Group>& tests = families[in.family];
    const auto at = std::ranges::find_if(tests, [&](const Group& g) {
      return g.inputs.front()->loading == in.loading && g.inputs.front()->test == in.test;
    });
    (at == tests.end() ? tests.emplace_back() : *at).inputs.push_back(&in);
  }
  for (const auto& [family, tests] : families) {
    std::vector<FittedTest> fitted;
    for (const bool compressing : {true, false})
      for (const Group& group : tests) {
        const bool compresses = !group.states(settings.largest_span).empty();
        if (compresses != compressing || spans_known(group, settings) < 2) continue;
        if (compressing) fitted.emplace_back(group, settings, seed);
        const FittedTest* const by = compressing ? &fitted.back() : fit_behind(group, fitted);
        if (by == nullptr) continue;
        for (const double span : settings.spans) out.push_back(predict(group, *by, span, settings, seed));
      }
  }
  return out;
}

std::vector<std::string> prediction_remarks(const std::vector<PredictionInput>& inputs,
                                            const std::vector<PredictionSummary>& predictions,
                                            const EquationSettings& settings) {
  std::vector<std::string> out;
  if (settings.spans.empty()) return out;
  bool any = false;
  for (const PredictionInput& in : inputs) {
    const auto tested = std::ranges::count_if(in.curves, of_one_stage);
    const auto left_out = tested - std::ranges::count_if(in.curves, predictable);
    any = any || left_out < tested;
    if (left_out > 0)
      out.push_back(fmt::format(
          "{}{}: {} of {} samples {} no part in predictions of spans (equation.spans): their stress "
          "vanishes or changes sign at a point",
          in.material, in.loading.empty() ? "" : ", " + in.loading, left_out, tested, left_out == 1 ? "has" : "have"));
  }
  if (predictions.empty())
    out.push_back(
        any ? "no span was predicted (equation.spans): variants of two spans (up to largest_span) that differ "
              "in nothing else and are compressed are needed"
            : "no span was predicted (equation.spans): no sample has a test of one stage with a stress at "
              "every point");
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
      else if (keeps_volume(s.kind))
        text += value_text("q/p", p.deviator, 1.0);
      else
        text += value_text("1000 axial/E", p.axial, kThousand) + "; " + value_text("lateral", p.lateral, kThousand);
      text += p.beyond && !keeps_volume(s.kind) ? "; beyond the pressures that were fitted\n" : "\n";
    }
  }
  return text.empty() ? text : "predicted from smaller spans:\n" + text;
}

}  // namespace softgrain
