#include "common/data/law_band.h"

#include <algorithm>
#include <cmath>

#include "common/core/few_samples.h"
#include "common/core/statistics.h"

namespace softgrain {

namespace {

constexpr std::size_t kParameters = kLawParameterNames.size();

using Gradient = std::array<double, 3>;  ///< derivatives with respect to a, b and delta

/// Places of (a, b, delta) of a part in kLawParameterNames; delta is shared.
std::array<std::size_t, 3> parameter_places(LawPart part) {
  switch (part) {
    case LawPart::normal:
      return {0, 1, 2};
    case LawPart::tangential_initial:
      return {3, 4, 2};
    default:
      return {5, 6, 2};
  }
}

bool below_threshold(const ThresholdPowerLaw& law, double overlap) {
  return overlap < law.delta.value || overlap <= 0.0;
}

/// Gradient of a (D^b - delta^b) for D >= delta; zero below.
Gradient value_gradient(const ThresholdPowerLaw& law, double overlap) {
  const double a = law.a.value;
  const double b = law.b.value;
  const double delta = law.delta.value;
  if (below_threshold(law, overlap)) return {0.0, 0.0, 0.0};
  const double power = std::pow(overlap, b);
  const double threshold = delta > 0.0 ? std::pow(delta, b) : 0.0;
  const double threshold_log = delta > 0.0 ? threshold * std::log(delta) : 0.0;
  const double d_delta = delta > 0.0 ? -a * b * threshold / delta : 0.0;
  return {power - threshold, a * (power * std::log(overlap) - threshold_log), d_delta};
}

/// Gradient of a b D^(b-1) for D >= delta; zero below.
Gradient slope_gradient(const ThresholdPowerLaw& law, double overlap) {
  if (below_threshold(law, overlap)) return {0.0, 0.0, 0.0};
  const double a = law.a.value;
  const double b = law.b.value;
  const double power = std::pow(overlap, b - 1.0);
  return {b * power, a * power * (1.0 + b * std::log(overlap)), 0.0};
}

bool has_covariance(const PairLaw& law) { return law.covariance.size() == kParameters * kParameters; }

double variance(const PairLaw& law, LawPart part, const Gradient& slope) {
  const auto places = parameter_places(part);
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j)
      sum += slope[i] * slope[j] * law.covariance[places[i] * kParameters + places[j]];
  }
  return std::max(0.0, sum);
}

bool part_has_covariance(const PairLaw& law, LawPart part) {
  if (!has_covariance(law)) return false;
  const auto places = parameter_places(part);
  return std::any_of(places.begin(), places.end(),
                     [&](std::size_t k) { return law.covariance[k * kParameters + k] > 0.0; });
}

/// Half-width of a 95 % interval. Over packings it follows Student's t: 2.45 standard errors with seven packings.
/// Residuals of single curves are many, so they follow the normal distribution.
double half_width(const PairLaw& law, double variance) {
  const bool over_packings = law.band_origin != kFromResiduals && law.packings > 1;
  return (over_packings ? student95(law.packings - 1) : kNormal95) * std::sqrt(variance);
}

LawInterval around(double value, double half) { return {std::max(0.0, value - half), value + half, kFromCovariance}; }

constexpr double kRounding = 1e-12;  ///< half-width over the value; a narrower interval is one of rounding

/// Empty where the width is that of rounding: what never scattered says nothing of how far off it may be.
std::optional<LawInterval> unless_nothing(double value, double half) {
  if (value > 0.0 && !(half > kRounding * value)) return std::nullopt;
  return around(value, half);
}

/// Linear between the points of the band; empty outside.
std::optional<LawInterval> inside(const LawBand& band, double delta) {
  if (band.delta.size() < 2 || delta < band.delta.front() || delta > band.delta.back()) return std::nullopt;
  const auto after = std::upper_bound(band.delta.begin() + 1, band.delta.end() - 1, delta);
  const auto k = static_cast<std::size_t>(after - band.delta.begin());
  const double share = (delta - band.delta[k - 1]) / (band.delta[k] - band.delta[k - 1]);
  const auto between = [&](const std::vector<double>& y) { return y[k - 1] + share * (y[k] - y[k - 1]); };
  return LawInterval{between(band.low), between(band.high), band.origin};
}

}  // namespace

const char* part_name(LawPart part) {
  switch (part) {
    case LawPart::normal:
      return "normal";
    case LawPart::tangential_initial:
      return "tangential_initial";
    default:
      return "tangential_secant";
  }
}

const ThresholdPowerLaw& part_of(const PairLaw& law, LawPart part) {
  switch (part) {
    case LawPart::normal:
      return law.normal;
    case LawPart::tangential_initial:
      return law.tangential_initial;
    default:
      return law.tangential_secant;
  }
}

bool has_part(const PairLaw& law, LawPart part) {
  const bool measured = part == LawPart::normal ||
                        (part == LawPart::tangential_initial ? law.has_tangential_initial : law.has_tangential_secant);
  return measured && part_of(law, part).b.value > 0.0;  // a law that could not be fitted has no exponent
}

std::optional<LawBand> stored_band(const PairLaw& law, LawPart part) {
  for (const LawBandRows& rows : law.bands)
    if (rows.law == part_name(part)) return LawBand{law.band_delta, rows.low, rows.high, law.band_origin};
  return std::nullopt;
}

std::optional<LawBand> linearised_band(const PairLaw& law, LawPart part, const std::vector<double>& delta) {
  if (!has_covariance(law)) return std::nullopt;
  LawBand band{delta, {}, {}, kFromCovariance};
  bool any = false;
  const ThresholdPowerLaw& fitted = part_of(law, part);
  for (const double overlap : delta) {
    const double half = half_width(law, variance(law, part, value_gradient(fitted, overlap)));
    const LawInterval at = around(fitted.value(overlap), half);
    band.low.push_back(at.low);
    band.high.push_back(at.high);
    any = any || half > kRounding * at.high;
  }
  if (!any) return std::nullopt;
  return band;
}

std::optional<LawInterval> value_interval(const PairLaw& law, LawPart part, double delta) {
  if (const auto band = stored_band(law, part))
    if (const auto at = inside(*band, delta)) return at;
  if (!part_has_covariance(law, part)) return std::nullopt;
  const ThresholdPowerLaw& fitted = part_of(law, part);
  return unless_nothing(fitted.value(delta), half_width(law, variance(law, part, value_gradient(fitted, delta))));
}

std::optional<LawInterval> slope_interval(const PairLaw& law, LawPart part, double delta) {
  if (!part_has_covariance(law, part)) return std::nullopt;
  const ThresholdPowerLaw& fitted = part_of(law, part);
  return unless_nothing(fitted.derivative(delta), half_width(law, variance(law, part, slope_gradient(fitted, delta))));
}

}  // namespace softgrain
