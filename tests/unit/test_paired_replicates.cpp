// Errors of differences of two fits of the equation of state: their intervals hold the truth as often as they say,
// whether packings are in both or not.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "calibrate/equation_of_state_fit.h"
#include "common/core/few_samples.h"
#include "common/core/random.h"
#include "pipelines/kinds/recipe/paired_replicates.h"
#include "pipelines/results/paired_summary.h"

namespace softgrain {
namespace {

constexpr std::size_t kPackings = 4;
constexpr double kScatter = 0.003;

double true_onset(std::size_t packing) { return 0.56 + 0.03 * static_cast<double>(packing); }
std::string name_of(std::size_t packing) { return "packing " + std::to_string(packing); }

/// Samples of all packings: their onsets scatter, and their K a little.
std::vector<StateCurve> drawn_curves(RandomStream& random, int samples) {
  std::vector<StateCurve> out;
  for (std::size_t g = 0; g < kPackings; ++g)
    for (int s = 0; s < samples; ++s) {
      StateCurve c{name_of(g), 2.0 + static_cast<double>(g), {}, {}, {}};
      const double onset = true_onset(g) + kScatter * random.normal();
      const double modulus = 0.05 * std::exp(0.03 * random.normal());
      for (int k = 0; k < 5; ++k) {
        c.pressure.push_back(1e-4 * std::pow(10.0, 0.4 * k));
        c.phi.push_back(state_phi(StateForm::porosity, modulus, 1.6, onset, c.pressure.back()));
      }
      out.push_back(std::move(c));
    }
  return out;
}

const StateFitOptions kOptions{.form = StateForm::porosity, .replicates = 100, .seed = 7};

FittedCurves fitted_to(std::vector<StateCurve> curves) {
  FittedCurves out{std::move(curves), {}};
  out.fit = fit_equation_of_state(out.curves, {.form = StateForm::porosity, .replicates = 40, .seed = 7});
  EXPECT_TRUE(out.fit.usable) << out.fit.message;
  return out;
}

/// A mix: what it is made of its packings.
double mixed(const std::vector<double>& share, const std::vector<double>& numbers) {
  double sum = 0.0;
  for (std::size_t g = 0; g < kPackings; ++g) sum += share[g] * numbers[2 + g];
  return sum;
}
std::vector<double> numbers_of(const StateFit& fit) {
  std::vector<double> out{std::log(fit.modulus.value), fit.exponent.value};
  for (const StateGroup& g : fit.groups) out.push_back(g.onset.value);
  return out;
}

const std::vector<double> kMixA{0.4, 0.3, 0.2, 0.1};
const std::vector<double> kMixB{0.1, 0.3, 0.3, 0.3};

double true_difference() {
  std::vector<double> numbers{0.0, 0.0};
  for (std::size_t g = 0; g < kPackings; ++g) numbers.push_back(true_onset(g));
  return mixed(kMixA, numbers) - mixed(kMixB, numbers);
}

Estimate difference_of(const FittedCurves& a, const FittedCurves& b, const std::set<std::size_t>& in_both) {
  std::map<std::string, std::string> shared;
  for (const std::size_t g : in_both) shared[name_of(g)] = name_of(g);
  const PairedFits fits = replicates_together(a, b, shared, kOptions);
  std::vector<double> differences;
  for (std::size_t r = 0; r < fits.a.replicates.size(); ++r)
    differences.push_back(mixed(kMixA, fits.a.replicates[r]) - mixed(kMixB, fits.b.replicates[r]));
  return with_error_parts(mixed(kMixA, numbers_of(a.fit)) - mixed(kMixB, numbers_of(b.fit)),
                          {{mean_error(differences).deviation, fits.degrees}});
}

struct Coverage {
  double share = 0.0;  ///< of intervals that hold the truth
  double error = 0.0;  ///< mean standard error
};

Coverage coverage(const std::set<std::size_t>& in_both, int samples) {
  constexpr int kTrials = 100;
  Coverage out;
  for (int trial = 0; trial < kTrials; ++trial) {
    RandomStream random(11, RandomPurpose::test, 100 + static_cast<std::uint64_t>(trial));
    const std::vector<StateCurve> of_a = drawn_curves(random, samples);
    std::vector<StateCurve> of_b = drawn_curves(random, samples);
    for (std::size_t k = 0; k < of_b.size(); ++k)
      if (in_both.contains(k / static_cast<std::size_t>(samples))) of_b[k] = of_a[k];
    const Estimate d = difference_of(fitted_to(of_a), fitted_to(of_b), in_both);
    out.share += d.low <= true_difference() && true_difference() <= d.high ? 1.0 / kTrials : 0.0;
    out.error += d.standard_error / kTrials;
  }
  return out;
}

// 100 intervals of 95 %: a deviation of 2.2 %.

TEST(PairedReplicates, IntervalsHoldTheTruthWithPackingsInBothAndWithout) {
  const Coverage none = coverage({}, 3);
  const Coverage some = coverage({0, 2}, 3);
  const Coverage all = coverage({0, 1, 2, 3}, 3);
  for (const Coverage& c : {none, some, all}) {
    EXPECT_GT(c.share, 0.89);
    EXPECT_LT(c.share, 0.995);
  }
  EXPECT_LT(all.error, some.error);
  EXPECT_LT(some.error, none.error);
  EXPECT_LT(all.error, 0.8 * none.error);
}

TEST(PairedReplicates, IntervalsOfTwoSamplesEachHoldTheTruth) {
  const Coverage c = coverage({}, 2);
  EXPECT_GT(c.share, 0.89);
  EXPECT_LT(c.share, 0.995);
}

/// One step of Gauss and Newton stands for a fit: errors of a run alone are those of its own bootstrap.
TEST(PairedReplicates, ScatterAsTheFitSays) {
  RandomStream random(3, RandomPurpose::test, 7);
  const FittedCurves a = fitted_to(drawn_curves(random, 4));
  const PairedFits fits = replicates_together(a, a, {}, {.form = StateForm::porosity, .replicates = 400, .seed = 2});
  EXPECT_EQ(fits.degrees, 2.0 * a.fit.degrees);
  for (std::size_t g = 0; g < kPackings; ++g) {
    std::vector<double> drawn;
    for (const auto& r : fits.a.replicates) drawn.push_back(r[2 + g]);
    EXPECT_NEAR(mean_error(drawn).deviation / a.fit.groups[g].onset.standard_error, 1.0, 0.3) << g;
    EXPECT_NEAR(mean_error(drawn).mean, a.fit.groups[g].onset.value, 0.3 * a.fit.groups[g].onset.standard_error) << g;
  }
}

TEST(PairedReplicates, OfOneRunAreAlike) {
  RandomStream random(3, RandomPurpose::test, 8);
  const FittedCurves a = fitted_to(drawn_curves(random, 2));
  std::map<std::string, std::string> all;
  for (std::size_t g = 0; g < kPackings; ++g) all[name_of(g)] = name_of(g);
  const PairedFits fits = replicates_together(a, a, all, kOptions);
  EXPECT_EQ(fits.a.replicates, fits.b.replicates);
  EXPECT_EQ(fits.degrees, static_cast<double>(a.fit.degrees));
}

/// Of single samples nothing is known, however many there are in the other run.
TEST(PairedReplicates, NeedTwoSamplesInBothRuns) {
  RandomStream random(3, RandomPurpose::test, 9);
  const FittedCurves one = fitted_to(drawn_curves(random, 1));
  const FittedCurves three = fitted_to(drawn_curves(random, 3));
  EXPECT_EQ(replicates_together(one, three, {}, kOptions).degrees, 0.0);
  EXPECT_TRUE(std::isinf(difference_of(one, three, {}).standard_error));
}

}  // namespace
}  // namespace softgrain
