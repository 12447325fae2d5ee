// The 95 % band of a fitted law: from the table of the fit, or by linearised propagation of the covariance.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "common/io/hdf5_file.h"
#include "pipelines/report/run_data.h"

namespace softgrain::report {
namespace {

constexpr double kNormal95 = 1.959963984540054;  // 97.5 % quantile of the normal distribution
constexpr std::size_t kParameters = kLawParameterNames.size();

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

/// d F / d (a, b, delta) of a (D^b - delta^b) for D >= delta; zero below.
std::array<double, 3> gradient(const ThresholdPowerLaw& law, double overlap) {
  const double a = law.a.value;
  const double b = law.b.value;
  const double delta = law.delta.value;
  if (overlap < delta || overlap <= 0.0) return {0.0, 0.0, 0.0};
  const double power = std::pow(overlap, b);
  const double threshold = delta > 0.0 ? std::pow(delta, b) : 0.0;
  const double threshold_log = delta > 0.0 ? threshold * std::log(delta) : 0.0;
  const double d_delta = delta > 0.0 ? -a * b * threshold / delta : 0.0;
  return {power - threshold, a * (power * std::log(overlap) - threshold_log), d_delta};
}

double variance(const PairLaw& law, LawPart part, double overlap) {
  const auto places = parameter_places(part);
  const auto slope = gradient(part_of(law, part), overlap);
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j)
      sum += slope[i] * slope[j] * law.covariance[places[i] * kParameters + places[j]];
  }
  return std::max(0.0, sum);
}

std::optional<LawBand> stored_band(const std::string& table, PairKind kind, LawPart part) {
  if (!std::filesystem::exists(table)) return std::nullopt;
  const h5::Group root = h5::open_file(table);
  if (!root.has("band") || !root.open("band").has(to_string(kind))) return std::nullopt;
  const h5::Group group = root.open("band").open(to_string(kind));
  const std::string name = part_name(part);
  if (!group.has("delta") || !group.has(name + "_low") || !group.has(name + "_high")) return std::nullopt;
  LawBand band{group.doubles("delta"), group.doubles(name + "_low"), group.doubles(name + "_high"),
               "bootstrap over packings"};
  if (band.low.size() != band.delta.size() || band.high.size() != band.delta.size()) return std::nullopt;
  return band;
}

}  // namespace

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

std::vector<double> spread(double low, double high, int n) {
  std::vector<double> values;
  for (int i = 0; i < n; ++i) values.push_back(low + (high - low) * i / std::max(1, n - 1));
  return values;
}

std::optional<LawBand> linearised_band(const PairLaw& law, LawPart part, const std::vector<double>& delta) {
  if (law.covariance.size() != kParameters * kParameters) return std::nullopt;
  LawBand band{delta, {}, {}, "linearised from the covariance"};
  bool any = false;
  for (const double overlap : delta) {
    const double half = kNormal95 * std::sqrt(variance(law, part, overlap));
    const double value = part_of(law, part).value(overlap);
    band.low.push_back(std::max(0.0, value - half));
    band.high.push_back(value + half);
    any = any || half > 0.0;
  }
  if (!any) return std::nullopt;
  return band;
}

std::optional<LawBand> law_band(const RunData& run, const PairLaw& law, LawPart part) {
  if (!has_part(law, part)) return std::nullopt;
  if (auto stored = stored_band(run.directory + "/law.h5", law.kind, part)) return stored;
  return linearised_band(law, part, spread(0.0, law.delta_max, 121));
}

}  // namespace softgrain::report
