#include "pipelines/kinds/recipe/mix_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "pipelines/kinds/recipe/law.h"
#include "pipelines/kinds/recipe/onset_pair.h"
#include "pipelines/kinds/recipe/stages.h"

namespace softgrain {

namespace {

constexpr const char* kRatioName = "K0 at the end of the test, predicted";
constexpr const char* kFractionName = "solid fraction at the start";
constexpr const char* kOnsetName = "onset of the whole";

/// Numbers of the stages that both have, with the errors of independent runs; nothing without [[stage]].
std::vector<PairedNumber> stage_numbers(const RecipeOutcome& a, const RecipeOutcome& b) {
  std::vector<PairedNumber> out;
  if (!a.staged || !b.staged) return out;
  const std::size_t stages = std::min(a.staged->stages.size(), b.staged->stages.size());
  for (std::size_t k = 0; k < stages; ++k) {
    const std::vector<StageQuantity> of_a = quantities_of(a.staged->stages[k]);
    const std::vector<StageQuantity> of_b = quantities_of(b.staged->stages[k]);
    for (std::size_t q = 0; q < of_a.size(); ++q)
      if (of_a[q].name == of_b[q].name && std::isfinite(of_a[q].value.value) && std::isfinite(of_b[q].value.value))
        out.push_back(unpaired_number(of_a[q].name, of_a[q].unit, of_a[q].value, of_b[q].value));
  }
  return out;
}

/// A modulus with the relative error that its run gave it between its own stresses.
Estimate with_relative_error(double value, const RecipeCurve& curve) {
  if (!curve.modulus || !std::isfinite(curve.modulus->low)) return {value, kNaN, kNaN, kNaN};
  const SecantModulus& m = *curve.modulus;
  return {value, value / m.value * 0.5 * (m.high - m.low) / kNormal95, value / m.value * m.low,
          value / m.value * m.high};
}

/// A difference with its interval, in the form of the summary.
PairedNumber number_of(const std::string& name, const Estimate& a, const Estimate& b, const Estimate& difference,
                       std::size_t same) {
  PairedNumber out = unpaired_number(name, "", a, b);
  out.error = difference.standard_error;
  out.low = difference.low;
  out.high = difference.high;
  out.pairs = static_cast<std::int64_t>(same);
  return out;
}

/// What both mixes come to.
class RecipePair {
 public:
  RecipePair(const MixRun& a, const MixRun& b) : a_(a), b_(b), onsets_(a, b) {}

  [[nodiscard]] PairedSummary summary() const;

 private:
  [[nodiscard]] std::size_t levels() const { return a_.scene.levels.size(); }
  [[nodiscard]] PairedNumber number(const std::string& name, const Estimate& a, const Estimate& b,
                                    const OnsetPair& pair, const NumberOf& of_a, const NumberOf& of_b,
                                    const std::vector<ErrorPart>& more = {}) const;
  [[nodiscard]] std::vector<ErrorPart> ratio_parts() const;
  [[nodiscard]] bool lateral_shared() const;
  [[nodiscard]] std::array<double, 2> common_stresses(double start) const;
  [[nodiscard]] std::array<double, 2> factor_packings(bool of_a) const;
  [[nodiscard]] WholeLaw law_of(const MixRun& run, const StateFit& own) const;
  [[nodiscard]] std::optional<PairedNumber> modulus_difference(const OnsetPair& whole) const;
  void add_loading(const OnsetPair& whole, PairedSummary& out) const;
  void add_check(std::vector<PairedNumber>& out) const;

  const MixRun& a_;
  const MixRun& b_;
  PairedOnsets onsets_;
};

PairedNumber RecipePair::number(const std::string& name, const Estimate& a, const Estimate& b, const OnsetPair& pair,
                                const NumberOf& of_a, const NumberOf& of_b, const std::vector<ErrorPart>& more) const {
  PairedNumber out =
      number_of(name, a, b, onsets_.difference(a.value - b.value, pair, of_a, of_b, more), onsets_.same());
  if (std::isfinite(out.error)) return out;
  if (const double share = onsets_.undefined_share(pair, of_a, of_b); share > kMostUndefined)
    out.unknown = fmt::format("{:.0f} % of the replicates do not go through these stresses", 100.0 * share);
  return out;
}

/// Whether one packing stands for the lateral stress of both.
bool RecipePair::lateral_shared() const {
  return onsets_.shared(a_.variant(lateral_packing(a_.scene, levels())).name,
                        b_.variant(lateral_packing(b_.scene, levels())).name);
}

/// Of the difference of K0: samples of the packings that stand for the whole, and what these may be off by for one mix
/// more than for the other, as K0 changes from mixture to mixture.
std::vector<ErrorPart> RecipePair::ratio_parts() const {
  std::vector<ErrorPart> out;
  const double moved = onsets_.moved(0, levels());
  if (!lateral_shared())
    for (const MixRun* run : {&a_, &b_}) {
      const MeanError samples = mean_error(end_ratios(run->results[lateral_packing(run->scene, levels())]));
      out.push_back({samples.error, static_cast<double>(samples.n) - 1.0});
    }
  if (moved == 0.0) {  // mixtures that differ in nothing are off alike
    out.push_back(kExactPart);
    return out;
  }
  const auto means = [](const MixRun& run) {
    std::vector<double> values;
    for (const VariantResult& r : run.results) values.push_back(mean_error(end_ratios(r)).mean);
    return values;
  };
  const NeighbourSlope slope = neighbour_slope(a_.scene, means(a_), b_.scene, means(b_));
  double change = slope.value * moved;
  const double most =
      std::hypot(a_.summary.recipe.lateral_ratio.standard_error, b_.summary.recipe.lateral_ratio.standard_error);
  if (most < change) change = most;  // NaN where a run does not know it
  out.push_back({change, slope.steps});
  return out;
}

/// Axial stresses over E between which both moduli are.
std::array<double, 2> RecipePair::common_stresses(double start) const {
  const MacroSpec& spec = a_.variant(0).setup.spec;
  if (spec.modulus_stress[1] > 0.0)
    return {spec.modulus_stress[0] / spec.youngs_modulus, spec.modulus_stress[1] / spec.youngs_modulus};
  double to = kInfinity;
  for (const MixRun* run : {&a_, &b_})
    if (const auto& m = run->summary.recipe.curves.front().modulus) to = std::min(to, m->to);
  return {std::max(start, 0.5 * to), to};
}

WholeLaw RecipePair::law_of(const MixRun& run, const StateFit& own) const {
  WholeLaw law;
  law.form = run.scene.material.equation.form;
  law.shape = shape_of(run.scene, run.results, own);
  law.start_pressure = run.variant(0).setup.spec.start_pressure;
  return law;
}

/// The constrained modulus between two stresses that a law has from its onset, K and n.
NumberOf modulus_of(const WholeLaw& law, double strain, std::array<double, 2> stresses) {
  return [=](double onset, double modulus, double exponent) {
    WholeLaw drawn = law;
    drawn.modulus.value = modulus;
    drawn.exponent.value = exponent;
    drawn.onset = {onset, kInfinity, -kInfinity, kInfinity};
    constexpr std::int64_t kSteps = 16;
    std::vector<RecipeCurve> curve{curve_of(drawn, strain, kSteps)};
    (void)set_moduli(curve, stresses);
    return curve.front().modulus ? curve.front().modulus->value : kNaN;
  };
}

/// Law whose lateral stress is larger by a share of the axial one.
WholeLaw with_more_ratio(WholeLaw law, double more) {
  for (double& ratio : law.shape.ratio) ratio += more;
  return law;
}

/// Law whose factor is larger by so many of its deviations among packings.
WholeLaw with_more_factor(WholeLaw law, double deviations) {
  for (std::size_t k = 0; k < law.shape.factor.size(); ++k)
    law.shape.factor[k] += deviations * law.shape.factor_deviation[k];
  return law;
}

/// Packings behind the mean factor of a law (shape_of), and how many of them are not in the other run: those that are
/// in both leave nothing in the difference.
std::array<double, 2> RecipePair::factor_packings(bool of_a) const {
  const MixRun& run = of_a ? a_ : b_;
  std::array<double, 2> out{};
  for (std::size_t v = 0; v < run.results.size(); ++v) {
    if (run.variant(v).same_packings || run.scene.checked == v) continue;
    out[0] += 1.0;
    if (!onsets_.in_both(of_a, run.variant(v).name)) out[1] += 1.0;
  }
  return out;
}

std::optional<PairedNumber> RecipePair::modulus_difference(const OnsetPair& whole) const {
  const RecipeCurve& curve_a = a_.summary.recipe.curves.front();
  const RecipeCurve& curve_b = b_.summary.recipe.curves.front();
  if (curve_a.axial.empty() || curve_b.axial.empty()) return std::nullopt;
  const WholeLaw law_a = law_of(a_, onsets_.fits().a);
  const WholeLaw law_b = law_of(b_, onsets_.fits().b);
  if (law_a.shape.strain.empty() || law_b.shape.strain.empty()) return std::nullopt;
  const auto stresses = common_stresses(std::max(curve_a.axial.front(), curve_b.axial.front()));
  const auto of = [&](const WholeLaw& law, bool is_a) {
    return modulus_of(law, (is_a ? curve_a : curve_b).strain.back(), stresses);
  };
  const auto at = [&](const WholeLaw& law, bool is_a) { return onsets_.value(whole, is_a, of(law, is_a)); };
  const double at_a = at(law_a, true);
  const double at_b = at(law_b, false);
  if (!std::isfinite(at_a) || !std::isfinite(at_b)) return std::nullopt;
  std::vector<ErrorPart> parts;
  for (const ErrorPart& p : ratio_parts())
    parts.push_back(
        p == kExactPart ? p : ErrorPart{std::abs(at(with_more_ratio(law_b, p.error), false) - at_b), p.degrees});
  for (const bool is_a : {true, false}) {
    const auto [all, own] = factor_packings(is_a);
    const double of_mean = std::sqrt(own) / all;
    const double moved = at(with_more_factor(is_a ? law_a : law_b, of_mean), is_a);
    parts.push_back(own == 0.0 ? kExactPart : ErrorPart{std::abs(moved - (is_a ? at_a : at_b)), all - 1.0});
  }
  return number(
      fmt::format("constrained modulus over E, material law, from {:.3g} to {:.3g} E", stresses[0], stresses[1]),
      with_relative_error(at_a, curve_a), with_relative_error(at_b, curve_b), whole, of(law_a, true), of(law_b, false),
      parts);
}

/// The check, measured and predicted, where both resolved as many levels.
void RecipePair::add_check(std::vector<PairedNumber>& out) const {
  const auto& a = a_.summary.recipe.check;
  const auto& b = b_.summary.recipe.check;
  if (!a || !b || !a_.scene.checked || !b_.scene.checked || a_.scene.checked_levels != b_.scene.checked_levels) return;
  const std::string of = fmt::format(" of the {} coarsest levels, ", a->levels);
  const bool same = onsets_.shared(a_.variant(*a_.scene.checked).name, b_.variant(*b_.scene.checked).name);
  if (const auto measured = onsets_.measured(*a_.scene.checked, *b_.scene.checked))
    out.push_back(
        number_of("onset" + of + "all grains", a->measured, b->measured,
                  onsets_.difference(a->measured.value - b->measured.value, *measured, onset_itself, onset_itself, {}),
                  same ? 1 : 0));
  OnsetPair predicted = onsets_.joined(0, a_.scene.checked_levels);
  predicted.widen = 0.0;  // by the check itself
  out.push_back(number("onset" + of + "predicted", a->predicted.onset, b->predicted.onset, predicted, onset_itself,
                       onset_itself));
  const auto ratios_a = end_ratios(a_.results[*a_.scene.checked]);
  const auto ratios_b = end_ratios(b_.results[*b_.scene.checked]);
  const Estimate d = same ? Estimate{} : difference_of_means(ratios_a, ratios_b);
  out.push_back(number_of("K0" + of + "all grains", mean_estimate(mean_error(ratios_a)),
                          mean_estimate(mean_error(ratios_b)), d, same ? 1 : 0));
}

/// Modulus and K0: of stages as of independent runs, since their curves are those of packings and not of one fit.
void RecipePair::add_loading(const OnsetPair& whole, PairedSummary& out) const {
  const RecipeOutcome& a = a_.summary.recipe;
  const RecipeOutcome& b = b_.summary.recipe;
  if (a.staged || b.staged) {
    for (PairedNumber& n : stage_numbers(a, b)) out.numbers.push_back(std::move(n));
    if (out.paired) out.method += "; numbers of stages have the errors of independent runs";
    return;
  }
  if (auto modulus = modulus_difference(whole)) out.numbers.push_back(*modulus);
  const double difference = a.lateral_ratio.value - b.lateral_ratio.value;
  out.numbers.push_back(number_of(kRatioName, a.lateral_ratio, b.lateral_ratio,
                                  with_error_parts(difference, ratio_parts()), lateral_shared() ? 1 : 0));
}

PairedSummary RecipePair::summary() const {
  const RecipeOutcome& a = a_.summary.recipe;
  const RecipeOutcome& b = b_.summary.recipe;
  const OnsetPair whole = onsets_.joined(0, levels());
  const StateForm form = a_.scene.material.equation.form;
  const double p = a_.variant(0).setup.spec.start_pressure;
  const NumberOf fraction = [form, p](double onset, double k, double n) { return state_phi(form, k, n, onset, p); };
  PairedSummary out;
  const std::string moved =
      fmt::format("{:.3g} % of the solid volume have another size", 100.0 * onsets_.moved(0, levels()));
  out.paired = onsets_.same() > 0;
  if (out.paired)
    out.method =
        fmt::format("{} of {} packings are in both, and what they do to both cancels; the others are independent; {}",
                    onsets_.same(), onsets_.packings(), moved);
  else
    out.reason = "no packing is in both; " + moved;
  out.numbers.push_back(number(kFractionName, *a.solid_fraction, *b.solid_fraction, whole, fraction, fraction));
  add_loading(whole, out);
  out.numbers.push_back(number(kOnsetName, *a.onset, *b.onset, whole, onset_itself, onset_itself));
  for (std::size_t k = 1; k < levels(); ++k)
    out.numbers.push_back(number(k + 1 == levels() ? fmt::format("onset of level {} alone", k + 1)
                                                   : fmt::format("onset of levels {} to {}", k + 1, levels()),
                                 a.levels[k].with_finer.onset, b.levels[k].with_finer.onset,
                                 onsets_.joined(k, levels() - k), onset_itself, onset_itself));
  add_check(out.numbers);
  return out;
}

/// What the summaries say, as of independent runs.
PairedSummary independent_summary(const RecipeOutcome& a, const RecipeOutcome& b, const std::string& reason) {
  PairedSummary out;
  out.reason = reason;
  if (a.solid_fraction && b.solid_fraction)
    out.numbers.push_back(unpaired_number(kFractionName, "", *a.solid_fraction, *b.solid_fraction));
  for (PairedNumber& n : stage_numbers(a, b)) out.numbers.push_back(std::move(n));
  const bool staged = a.staged || b.staged;
  const auto modulus = [&](const RecipeOutcome& r) -> const SecantModulus* {
    return staged || r.curves.empty() || !r.curves.front().modulus ? nullptr : &*r.curves.front().modulus;
  };
  if (modulus(a) != nullptr && modulus(b) != nullptr)
    out.numbers.push_back(unpaired_number("constrained modulus over E, material law, each between its own stresses", "",
                                          with_relative_error(modulus(a)->value, a.curves.front()),
                                          with_relative_error(modulus(b)->value, b.curves.front())));
  if (a.onset && b.onset && !staged)
    out.numbers.push_back(unpaired_number(kRatioName, "", a.lateral_ratio, b.lateral_ratio));
  if (a.onset && b.onset) out.numbers.push_back(unpaired_number(kOnsetName, "", *a.onset, *b.onset));
  return out;
}

}  // namespace

PairedSummary recipe_differences(const report::RunData& a, const report::RunData& b,
                                 const std::vector<std::string>& keys) {
  std::string reason;
  try {
    require_one_protocol(keys);
    const MixRun run_a = load_mix(a);
    const MixRun run_b = load_mix(b);
    require_alike(run_a, run_b);
    return RecipePair(run_a, run_b).summary();
  } catch (const InputError& e) {
    reason = e.what();
  } catch (const UnusableResult& e) {
    reason = e.what();
  } catch (const IoError& e) {  // runs that were kept without the files of their packings
    reason = e.what();
  }
  return independent_summary(a.summary_as<RecipeSummary>().recipe, b.summary_as<RecipeSummary>().recipe, reason);
}

}  // namespace softgrain
