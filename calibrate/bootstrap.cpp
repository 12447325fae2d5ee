#include "calibrate/bootstrap.h"

#include <algorithm>
#include <cmath>

#include "calibrate/joint_fit.h"
#include "common/core/random.h"
#include "common/io/interrupt.h"

namespace softgrain {

namespace {

enum class Outcome { failed, inside, at_bound };

struct Replicate {
  Outcome outcome = Outcome::failed;
  std::array<double, 7> law{};
};

Replicate refit(const BootstrapInput& input, std::uint64_t seed, std::uint64_t index) {
  const std::size_t packings = input.samples[0].packings;
  RandomStream stream(seed, RandomPurpose::bootstrap, index);
  std::vector<int> multiplicity(packings, 0);
  for (std::size_t i = 0; i < packings; ++i) ++multiplicity[stream.below(packings)];
  FitCurves curves = input.curves;
  for (std::size_t j = 0; j < kLawCurves; ++j)
    if (curves[j].present()) curves[j].means = means_of(input.samples[j], multiplicity);
  const JointFit joint = refit_joint(curves, input.delta_limit, input.start);
  Replicate out;
  out.law = joint.parameters.law_parameters();
  const bool finite = std::all_of(out.law.begin(), out.law.end(), [](double x) { return std::isfinite(x); });
  if (!finite || joint.fit.end == FitEnd::failed || joint.fit.rank_deficient) return out;
  const bool bound = joint.delta_at_limit || std::find(joint.exponent_at_bound.begin(), joint.exponent_at_bound.end(),
                                                       true) != joint.exponent_at_bound.end();
  out.outcome = bound ? Outcome::at_bound : Outcome::inside;
  return out;
}

}  // namespace

BootstrapResult bootstrap(const BootstrapInput& input, int replicates, std::uint64_t seed, std::uint64_t stream) {
  std::vector<Replicate> all(static_cast<std::size_t>(replicates));
#pragma omp parallel for schedule(dynamic)
  for (int r = 0; r < replicates; ++r) {
    if (interrupt_requested()) continue;  // an exception must not leave the region
    all[static_cast<std::size_t>(r)] = refit(input, seed, (stream << 32) + static_cast<std::uint64_t>(r));
  }
  stop_if_interrupted("refitting to drawn packings");
  BootstrapResult out;
  for (const Replicate& one : all) {
    if (one.outcome == Outcome::failed) {
      ++out.failed;
      continue;
    }
    if (one.outcome == Outcome::at_bound) ++out.at_bound;
    out.replicates.push_back(one.law);
  }
  return out;
}

std::pair<double, double> interval95(std::vector<double> values) {
  constexpr double kTail = 0.025;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (values.empty()) return {-kInfinity, kInfinity};
  std::sort(values.begin(), values.end());
  const auto quantile = [&](double p) {
    const double at = p * static_cast<double>(values.size() - 1);
    const auto k = static_cast<std::size_t>(at);
    const double next = k + 1 < values.size() ? values[k + 1] : values[k];
    return values[k] + (at - static_cast<double>(k)) * (next - values[k]);
  };
  return {quantile(kTail), quantile(1.0 - kTail)};
}

}  // namespace softgrain
