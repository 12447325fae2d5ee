#include "pipelines/kinds/recipe/onset_pair.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/core/few_samples.h"
#include "common/core/statistics.h"

namespace softgrain {

namespace {

double rods_in_value(const MixRun& run) {
  const auto& check = run.summary.recipe.check;
  return check ? check->share_of_rods : 0.5;
}

/// How far the check lies above (+) or below (-) the interval of its prediction.
double missed_by(const MixRun& run) {
  const auto& check = run.summary.recipe.check;
  if (!check || !(check->outside > 0.0)) return 0.0;
  return check->measured.value > check->predicted.onset.high ? check->outside : -check->outside;
}

double share_not_finite(const std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const auto finite = std::ranges::count_if(values, [](double v) { return std::isfinite(v); });
  return 1.0 - static_cast<double>(finite) / static_cast<double>(values.size());
}

OnsetWays measured_ways(const StateFit& fit, const StateGroup& group) {
  OnsetWays out;
  out.value.fill(group.onset.value);
  const auto place = 2 + static_cast<std::size_t>(&group - fit.groups.data());
  for (const std::vector<double>& r : fit.replicates)
    for (std::vector<double>& way : out.replicates) way.push_back(r[place]);
  return out;
}

}  // namespace

PairedOnsets::PairedOnsets(const MixRun& a, const MixRun& b)
    : a_(a),
      b_(b),
      shared_(shared_packings(a, b)),
      fits_(replicates_together(fit_again(a), fit_again(b), shared_, state_options(a))),
      forms_a_(a.scene, fits_.a),
      forms_b_(b.scene, fits_.b),
      slope_(neighbour_slope(a.scene, forms_a_.rod_residuals(), b.scene, forms_b_.rod_residuals())) {
  same_ = static_cast<std::size_t>(
      std::ranges::count_if(fits_.b.groups, [&](const StateGroup& g) { return shared_.contains(g.name); }));
}

bool PairedOnsets::shared(const std::string& in_a, const std::string& in_b) const {
  const auto at = shared_.find(in_b);
  return at != shared_.end() && at->second == in_a;
}

bool PairedOnsets::in_both(bool of_a, const std::string& name) const {
  return std::ranges::any_of(shared_, [&](const auto& pair) { return (of_a ? pair.second : pair.first) == name; });
}

double PairedOnsets::moved(std::size_t first, std::size_t count) const {
  return moved_share(softgrain::joined(a_.scene.levels, first, count),
                     softgrain::joined(b_.scene.levels, first, count));
}

OnsetWays PairedOnsets::ways_of(const LevelForms& forms, double share_of_rods, std::size_t first,
                                std::size_t count) const {
  FormReplicates both = forms.by_both_forms(first, count);
  const auto between = [&](double levels, double rods) { return levels + share_of_rods * (rods - levels); };
  OnsetWays out;
  out.value = {both.levels, both.rods, between(both.levels, both.rods)};
  for (std::size_t r = 0; r < both.by_levels.size(); ++r)
    out.replicates[2].push_back(between(both.by_levels[r], both.by_rods[r]));
  out.replicates[0] = std::move(both.by_levels);
  out.replicates[1] = std::move(both.by_rods);
  return out;
}

OnsetPair PairedOnsets::joined(std::size_t first, std::size_t count) const {
  const double of_a = rods_in_value(a_);
  const double of_b = rods_in_value(b_);
  OnsetPair out{ways_of(forms_a_, of_a, first, count), ways_of(forms_b_, of_b, first, count)};
  if (count == 1) return out;
  const double change =
      std::min(slope_.value * moved(first, count), std::hypot(forms_a_.rods_deviation(), forms_b_.rods_deviation()));
  out.model = {0.0, change, 0.5 * (of_a + of_b) * change};
  out.model_degrees = slope_.steps;
  out.widen = std::abs(missed_by(a_) - missed_by(b_));
  return out;
}

std::optional<OnsetPair> PairedOnsets::measured(std::size_t variant_a, std::size_t variant_b) const {
  const StateGroup* of_a = fits_.a.find(a_.variant(variant_a).name);
  const StateGroup* of_b = fits_.b.find(b_.variant(variant_b).name);
  if (of_a == nullptr || of_b == nullptr) return std::nullopt;
  return OnsetPair{measured_ways(fits_.a, *of_a), measured_ways(fits_.b, *of_b)};
}

double PairedOnsets::value(const OnsetPair& pair, bool of_a, const NumberOf& number) const {
  const StateFit& fit = of_a ? fits_.a : fits_.b;
  return number((of_a ? pair.a : pair.b).value[kJoinedWays - 1], fit.modulus.value, fit.exponent.value);
}

std::vector<double> PairedOnsets::replicates_of(const OnsetPair& pair, const NumberOf& of_a, const NumberOf& of_b,
                                                std::size_t way) const {
  const auto drawn = [way](const StateFit& fit, const NumberOf& number, const OnsetWays& ways, std::size_t r) {
    return number(ways.replicates[way][r], std::exp(fit.replicates[r][0]), fit.replicates[r][1]);
  };
  std::vector<double> out;
  for (std::size_t r = 0; r < pair.a.replicates[way].size(); ++r)
    out.push_back(drawn(fits_.a, of_a, pair.a, r) - drawn(fits_.b, of_b, pair.b, r));
  return out;
}

double PairedOnsets::undefined_share(const OnsetPair& pair, const NumberOf& of_a, const NumberOf& of_b) const {
  double most = 0.0;
  for (std::size_t w = 0; w < kJoinedWays; ++w)
    most = std::max(most, share_not_finite(replicates_of(pair, of_a, of_b, w)));
  return most;
}

Estimate PairedOnsets::difference(double difference, const OnsetPair& pair, const NumberOf& of_a, const NumberOf& of_b,
                                  const std::vector<ErrorPart>& more) const {
  const auto at = [](const StateFit& fit, const NumberOf& number, double onset) {
    return number(onset, fit.modulus.value, fit.exponent.value);
  };
  Estimate out{difference, 0.0, difference, difference};
  for (std::size_t w = 0; w < kJoinedWays; ++w) {
    const std::vector<double> scatter = replicates_of(pair, of_a, of_b, w);
    if (share_not_finite(scatter) > kMostUndefined) return {difference, kInfinity, -kInfinity, kInfinity};
    const double b = at(fits_.b, of_b, pair.b.value[w]);
    std::vector<ErrorPart> parts = more;
    parts.push_back({finite_mean(scatter).deviation, fits_.degrees});
    if (pair.model[w] > 0.0)
      parts.push_back({std::abs(at(fits_.b, of_b, pair.b.value[w] + pair.model[w]) - b), pair.model_degrees});
    const double centre = w + 1 == kJoinedWays ? difference : at(fits_.a, of_a, pair.a.value[w]) - b;
    const Estimate way = with_error_parts(centre, parts);
    const double widen = pair.widen > 0.0 ? std::abs(at(fits_.b, of_b, pair.b.value[w] + pair.widen) - b) : 0.0;
    // NaN: where the curve of that onset does not go through the stresses of a modulus.
    if (!std::isfinite(way.standard_error) || !std::isfinite(widen))
      return {difference, kInfinity, -kInfinity, kInfinity};
    out.low = std::min(out.low, way.low - widen);
    out.high = std::max(out.high, way.high + widen);
  }
  out.standard_error = 0.5 * (out.high - out.low) / kNormal95;
  return out;
}

}  // namespace softgrain
