// The threshold fit on known answers, and what it says when the data do not determine a law.
#include "calibrate/threshold_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "calibrate/threshold_model.h"
#include "common/core/error.h"
#include "pipelines/law/law_fit.h"
#include "tests/support/synthetic_law.h"

namespace {

using namespace softgrain;
using test::KnownLaw;
using test::synthetic;
using test::SyntheticOptions;

FitOptions few_replicates(int n = 60) {
  FitOptions options;
  options.replicates = n;
  return options;
}

bool mentions(const PairLaw& law, const std::string& text) { return law.reason.find(text) != std::string::npos; }

TEST(ThresholdFit, ResultStartsAsNotRun) {
  EXPECT_EQ(FitReport{}.law.status, LawStatus::not_run);
  const auto report = fit_pair_law(synthetic({}), PairKind::soft_soft, few_replicates());
  EXPECT_EQ(report.law.status, LawStatus::not_run);
  EXPECT_FALSE(report.law.reason.empty());
}

TEST(ThresholdFit, ExactDataAreRecoveredToNineDigits) {
  const SyntheticOptions o;
  const auto report = fit_pair_law(synthetic(o), PairKind::soft_solid, few_replicates());
  const PairLaw& law = report.law;
  EXPECT_EQ(law.status, LawStatus::good) << law.reason << report.fit_message;
  EXPECT_NEAR(law.normal.a.value / o.normal.a, 1.0, 1e-9);
  EXPECT_NEAR(law.normal.b.value / o.normal.b, 1.0, 1e-9);
  EXPECT_NEAR(law.normal.delta.value / o.normal.delta, 1.0, 1e-9);
  EXPECT_NEAR(law.normal.c.value, -o.normal.a * std::pow(o.normal.delta, o.normal.b), 1e-11);
  EXPECT_TRUE(law.has_tangential_initial && law.has_tangential_secant);
  EXPECT_NEAR(law.tangential_initial.a.value / o.a_initial, 1.0, 1e-8);
  EXPECT_NEAR(law.tangential_initial.b.value / o.b_initial, 1.0, 1e-8);
  EXPECT_NEAR(law.tangential_secant.a.value / (o.secant_share * o.a_initial), 1.0, 1e-8);
  EXPECT_EQ(law.tangential_secant.delta.value, law.normal.delta.value);
  EXPECT_EQ(law.packings, 8);
  EXPECT_EQ(law.points, 3 * 80);
  EXPECT_NEAR(law.max_overlap, 0.25, 1e-12);
}

TEST(ThresholdFit, TableHoldsMeansAndDeviations) {
  SyntheticOptions o;
  o.packings = 2;
  auto data = synthetic(o);
  data.runs[1].normal.back().force *= 3.0;
  const auto table = fit_pair_law(data, PairKind::soft_solid, few_replicates(0)).law.table;
  ASSERT_EQ(table.delta.size(), o.deltas.size());
  const double f = o.normal.value(0.25);
  EXPECT_NEAR(table.force_mean.back(), 2.0 * f, 1e-12);
  EXPECT_NEAR(table.force_deviation.back(), std::sqrt(2.0) * f, 1e-12);
  EXPECT_EQ(table.force_mean.front(), 0.0);
  EXPECT_EQ(table.kt_initial_mean.size(), o.deltas.size());
  EXPECT_NEAR(table.kt_secant_mean.back() / table.kt_initial_mean.back(), o.secant_share, 1e-12);
}

/// kt of two soft particles is the secant at half a degree where that was measured, else at one degree; on a plane at
/// one; or what is said. The law says which.
TEST(ThresholdFit, TheLawSaysTheAngleOfItsSecant) {
  SyntheticOptions o;
  o.kind = PairKind::soft_soft;
  auto data = synthetic(o);
  EXPECT_EQ(fit_pair_law(data, PairKind::soft_soft, few_replicates(0)).law.secant_angle_deg, 1.0);
  for (PackingRun& run : data.runs) {
    auto points = run.tangential;
    for (TangentialPoint& p : points) {
      p.angle_deg *= 0.5;
      p.force_parallel *= 0.8;
      if (std::abs(p.angle_deg) == 0.5) run.tangential.push_back(p);
    }
  }
  const PairLaw half = fit_pair_law(data, PairKind::soft_soft, few_replicates(0)).law;
  EXPECT_EQ(half.secant_angle_deg, 0.5);
  EXPECT_NEAR(half.tangential_secant.a.value / (1.6 * o.secant_share * o.a_initial), 1.0, 1e-6);
  FitOptions said = few_replicates(0);
  said.secant_angle_deg = 1.0;
  EXPECT_EQ(fit_pair_law(data, PairKind::soft_soft, said).law.secant_angle_deg, 1.0);
  for (PackingRun& run : data.runs) run.kind = PairKind::soft_solid;
  EXPECT_EQ(fit_pair_law(data, PairKind::soft_solid, few_replicates(0)).law.secant_angle_deg, 1.0);
}

/// The kink may sit in any interval, or on a measured Delta: no start can miss it.
class KinkPosition : public ::testing::TestWithParam<double> {};
TEST_P(KinkPosition, IsFound) {
  SyntheticOptions o;
  o.normal.delta = GetParam();
  const auto report = fit_pair_law(synthetic(o), PairKind::soft_solid, few_replicates(0));
  EXPECT_NEAR(report.law.normal.delta.value, o.normal.delta, 1e-8) << report.fit_message;
  EXPECT_NEAR(report.law.normal.b.value, o.normal.b, 1e-6);
}
INSTANTIATE_TEST_SUITE_P(ThresholdFit, KinkPosition,
                         ::testing::Values(0.01, 0.03, 0.05, 0.0625, 0.0999, 0.1, 0.14, 0.16, 0.18, 0.199));

TEST(ThresholdFit, WalkFromAFarStartReachesTheSameThreshold) {
  const auto data = synthetic({});
  RunList runs;
  for (const auto& run : data.runs) runs.push_back(&run);
  FitCurves curves;
  curves[0].means = means_of(normal_samples(runs, data.spec, {}));
  curves[0].sigma = floored_deviations(curves[0].means, 0.02);
  const JointFit best = fit_joint(curves, 0.2);
  for (const double far : {0.001, 0.12, 0.19}) {
    JointParameters from = best.parameters;
    from.delta = far;
    from.exponent[0] = 1.0;
    EXPECT_NEAR(refit_joint(curves, 0.2, from).parameters.delta, 0.065, 1e-8) << far;
  }
}

/// DanWood (NIST StRD) is a pure power law: the limit delta = 0 of ours. Same certified digits.
TEST(ThresholdFit, ZeroThresholdIsThePowerLawOfDanWood) {
  std::ifstream file(std::string(SOFTGRAIN_REFERENCE_DIR) + "/nist/DanWood.dat");
  std::vector<std::pair<double, double>> xy;
  std::string line;
  for (int k = 1; std::getline(file, line); ++k) {
    double x = 0.0;
    double y = 0.0;
    if (k > 60 && std::istringstream(line) >> y >> x) xy.emplace_back(x, y);
  }
  ASSERT_EQ(xy.size(), 6U);
  FitCurves curves;
  for (const auto& [x, y] : xy) {
    curves[0].means.delta.push_back(x);
    curves[0].means.mean.push_back(y);
    curves[0].means.count.push_back(1.0);
    curves[0].sigma.push_back(1.0);
  }
  const JointFit fit = fit_joint(curves, 0.0);  // a free threshold would find another law with a lower S
  const auto p = fit.parameters.law_parameters();
  EXPECT_EQ(fit.fit.end, FitEnd::converged) << fit.fit.message;
  EXPECT_NEAR(p[0] / 7.6886226176e-01, 1.0, 1e-9);
  EXPECT_NEAR(p[1] / 3.8604055871, 1.0, 1e-9);
  EXPECT_NEAR(fit.fit.residual_sum_of_squares / 4.3173084083e-03, 1.0, 1e-9);
}

TEST(ThresholdFit, DataWithoutThresholdSayThatDeltaIsAtItsBound) {
  SyntheticOptions o;
  o.normal.delta = 0.0;
  const auto law = fit_pair_law(synthetic(o), PairKind::soft_solid, few_replicates()).law;
  EXPECT_EQ(law.status, LawStatus::underdetermined);
  EXPECT_TRUE(mentions(law, "no threshold")) << law.reason;
  EXPECT_NEAR(law.normal.b.value, o.normal.b, 1e-4);
  EXPECT_NEAR(law.normal.delta.value, 0.0, 2e-3);
}

TEST(ThresholdFit, NoCrossing) {
  SyntheticOptions o;
  o.normal.delta = 0.3;
  const auto law = fit_pair_law(synthetic(o), PairKind::soft_solid, few_replicates()).law;
  EXPECT_EQ(law.status, LawStatus::no_threshold_crossing);
  EXPECT_TRUE(mentions(law, "no mean force above the noise floor 1.0e-06 E Rs^2 up to Delta = ")) << law.reason;
  EXPECT_EQ(law.normal.a.value, 0.0);
}

/// Forces far above the noise floor, of one packing alone.
TEST(ThresholdFit, ScatterIsSaidWhereItHidesTheForces) {
  auto data = synthetic({});
  for (auto& run : data.runs)
    for (auto& p : run.normal) p.force = run.packing == 3 ? 10.0 * p.delta : 0.0;
  const auto law = fit_pair_law(data, PairKind::soft_solid, few_replicates()).law;
  EXPECT_EQ(law.status, LawStatus::no_threshold_crossing);
  EXPECT_TRUE(mentions(law, "no mean force stays above two standard errors")) << law.reason;
  EXPECT_FALSE(mentions(law, "noise floor")) << law.reason;
}

TEST(ThresholdFit, ForcesLostInScatterAreNoCrossing) {
  auto data = synthetic({});
  for (auto& run : data.runs)
    for (auto& p : run.normal) p.force = run.packing == 3 ? 0.01 * p.delta : 0.0;
  EXPECT_EQ(fit_pair_law(data, PairKind::soft_solid, few_replicates()).law.status, LawStatus::no_threshold_crossing);
}

TEST(ThresholdFit, OnePackingIsUnderdetermined) {
  SyntheticOptions o;
  o.packings = 1;
  const auto law = fit_pair_law(synthetic(o), PairKind::soft_solid, few_replicates()).law;
  EXPECT_EQ(law.status, LawStatus::underdetermined);
  EXPECT_TRUE(mentions(law, "1 packing, 5 needed")) << law.reason;
  EXPECT_EQ(law.chi2_per_dof, 0.0);                      // one packing has no scatter to judge by
  EXPECT_NEAR(law.normal.b.value, o.normal.b, 1e-6);     // the best values are still there
  EXPECT_TRUE(std::isinf(law.normal.b.standard_error));  // but no invented error
  EXPECT_TRUE(std::isinf(law.normal.b.high));
}

TEST(ThresholdFit, TwoPointsAreUnderdetermined) {
  SyntheticOptions o;
  o.deltas = {0.05, 0.20, 0.25};
  o.a_initial = 0.0;
  o.factor_scatter = 0.1;
  const auto report = fit_pair_law(synthetic(o), PairKind::soft_solid, few_replicates());
  EXPECT_EQ(report.law.status, LawStatus::underdetermined);
  EXPECT_TRUE(mentions(report.law, "2 points clearly above zero, 3 needed")) << report.law.reason;
  EXPECT_TRUE(mentions(report.law, "rank-deficient")) << report.law.reason;
  EXPECT_TRUE(std::isinf(report.law.normal.a.standard_error));
}

TEST(ThresholdFit, FlatTangentialCurveDoesNotSpoilTheNormalLaw) {
  SyntheticOptions o;
  o.a_initial = 1e-12;
  const auto law = fit_pair_law(synthetic(o), PairKind::soft_solid, few_replicates()).law;
  EXPECT_EQ(law.status, LawStatus::underdetermined);
  EXPECT_TRUE(mentions(law, "initial tangential stiffness: 0 points")) << law.reason;
  EXPECT_NEAR(law.normal.b.value, o.normal.b, 1e-6);
}

TEST(ThresholdFit, UnconvergedPointsAreLeftOutAndCounted) {
  auto data = synthetic({});
  for (const std::size_t i : {1U, 4U}) {
    data.runs[i].normal[7].force *= 50.0;
    data.runs[i].normal[7].converged = false;
    data.runs[i].tangential[3].force_parallel *= 50.0;
    data.runs[i].tangential[3].converged = false;
  }
  const auto report = fit_pair_law(data, PairKind::soft_solid, few_replicates());
  EXPECT_EQ(report.law.status, LawStatus::good) << report.law.reason;
  EXPECT_NEAR(report.law.normal.b.value, 2.799, 1e-8);
  EXPECT_EQ(report.normal_left_out, 2);
  EXPECT_EQ(report.tangential_left_out, 2);
  for (auto& run : data.runs)
    for (auto& p : run.normal) p.converged = false;
  EXPECT_EQ(fit_pair_law(data, PairKind::soft_solid, few_replicates()).law.status, LawStatus::underdetermined);
}

TEST(ThresholdFit, RelaxationsAreNotMixed) {
  auto data = synthetic({});
  data.runs[0].relaxation = "published";
  EXPECT_THROW(fit_pair_law(data, PairKind::soft_solid), InputError);
  FitOptions options = few_replicates();
  options.relaxation = "damped";
  EXPECT_EQ(fit_pair_law(data, PairKind::soft_solid, options).law.packings, 7);
  options.relaxation = "other";
  EXPECT_THROW(fit_pair_law(data, PairKind::soft_solid, options), InputError);
}

TEST(ThresholdFit, BadOptionsAreRefused) {
  FitOptions options;
  options.scatter_floor = 0.0;
  EXPECT_THROW(fit_pair_law(synthetic({}), PairKind::soft_solid, options), InputError);
  options = {};
  options.delta_low = 0.3;
  options.delta_high = 0.2;
  EXPECT_THROW(fit_pair_law(synthetic({}), PairKind::soft_solid, options), InputError);
}

TEST(ThresholdFit, EveryOptionChangesTheAnswer) {
  SyntheticOptions o;
  o.factor_scatter = 0.15;
  o.point_scatter = 0.1;
  const auto data = synthetic(o);
  const FitOptions base = few_replicates();
  const PairLaw law = fit_pair_law(data, PairKind::soft_solid, base).law;
  const auto differs = [&](FitOptions options) {
    const PairLaw other = fit_pair_law(data, PairKind::soft_solid, options).law;
    return other.normal.b.value != law.normal.b.value || other.normal.b.low != law.normal.b.low ||
           other.status != law.status || other.tangential_initial.b.value != law.tangential_initial.b.value ||
           other.has_tangential_secant != law.has_tangential_secant;
  };
  EXPECT_FALSE(differs(base));
  FitOptions options = base;
  options.delta_low = 0.09;
  EXPECT_TRUE(differs(options));
  options = base;
  options.delta_high = 0.21;
  EXPECT_TRUE(differs(options));
  options = base;
  options.initial_angle_deg = 1.0;
  EXPECT_TRUE(differs(options));
  options = base;
  options.secant_angle_deg = 0.7;
  EXPECT_TRUE(differs(options));
  options = base;
  options.noise_floor = 1.0;
  EXPECT_TRUE(differs(options));
  options = base;
  options.scatter_floor = 0.5;
  EXPECT_TRUE(differs(options));
  options = base;
  options.min_packings = 20;
  EXPECT_TRUE(differs(options));
  options = base;
  options.replicates = 80;
  EXPECT_TRUE(differs(options));
  options = base;
  options.seed = 7;
  EXPECT_TRUE(differs(options));
}

TEST(ThresholdFit, SameSeedSameReplicatesWhateverTheUnits) {
  SyntheticOptions o;
  o.factor_scatter = 0.15;
  auto data = synthetic(o);
  const auto one = fit_pair_law(data, PairKind::soft_solid, few_replicates());
  data.spec.youngs_modulus *= 256.0;
  for (auto& run : data.runs) {
    for (auto& p : run.normal) p.force *= 256.0;
    for (auto& p : run.tangential) p.force_parallel *= 256.0;
  }
  const auto two = fit_pair_law(data, PairKind::soft_solid, few_replicates());
  EXPECT_EQ(one.replicates, two.replicates);
  EXPECT_EQ(one.law.normal.b.value, two.law.normal.b.value);
}

TEST(ThresholdFit, BandHoldsTheLawAndVanishesBelowThreshold) {
  SyntheticOptions o;
  o.factor_scatter = 0.15;
  o.packings = 16;
  const auto report = fit_pair_law(synthetic(o), PairKind::soft_solid, few_replicates(200));
  const std::vector<double> at{0.01, 0.1, 0.2};
  const auto band = law_band(report, LawCurve::normal, at);
  ASSERT_EQ(band.size(), 3U);
  EXPECT_EQ(band[0].value, 0.0);
  EXPECT_EQ(band[0].high, 0.0);
  for (const Band& b : band) {
    EXPECT_LE(b.low, b.value);
    EXPECT_GE(b.high, b.value);
  }
  EXPECT_NEAR(band[2].value,
              report.law.normal.a.value * std::pow(0.2, report.law.normal.b.value) + report.law.normal.c.value, 1e-12);
  // 15 % scatter over 16 packings: about +-7.5 % at 95 %.
  EXPECT_NEAR((band[2].high - band[2].low) / band[2].value, 0.15, 0.05);
}

TEST(ThresholdFit, CalibrateCoversEveryPairKindPresent) {
  auto data = synthetic({});
  SyntheticOptions o;
  o.kind = PairKind::soft_soft;
  o.normal.delta = 0.4;
  const auto soft = synthetic(o);
  data.runs.insert(data.runs.end(), soft.runs.begin(), soft.runs.end());
  std::vector<FitReport> reports;
  const LawCard card = calibrate(data, few_replicates(), &reports);
  ASSERT_EQ(card.pairs.size(), 2U);
  ASSERT_EQ(reports.size(), 2U);
  EXPECT_EQ(card.pairs[0].status, LawStatus::good);
  EXPECT_EQ(card.pairs[1].status, LawStatus::no_threshold_crossing);
  EXPECT_EQ(card.relaxation, "damped");
  EXPECT_THROW(calibrate(Measurements{}), InputError);
}

FitOptions settings_of(const std::string& text) {
  const Scene scene = Scene::parse(text, "settings.toml");
  const FitOptions options = read_fit_settings(scene.root());
  scene.root().finish();
  return options;
}

TEST(FitSettings, AnglesHaveTheirUnitInTheirNameAndAreReadWithoutItToo) {
  const FitOptions said = settings_of("initial_angle_deg = 0.1\nsecant_angle_deg = 2.0");
  EXPECT_EQ(said.initial_angle_deg, 0.1);
  EXPECT_EQ(said.secant_angle_deg, 2.0);
  const FitOptions earlier = settings_of("initial_angle = 0.2\nsecant_angle = 3.0");
  EXPECT_EQ(earlier.initial_angle_deg, 0.2);
  EXPECT_EQ(earlier.secant_angle_deg, 3.0);
  EXPECT_EQ(settings_of("").initial_angle_deg, FitOptions{}.initial_angle_deg);
  EXPECT_THROW(settings_of("initial_angle = 0.1\ninitial_angle_deg = 0.1"), InputError);
  EXPECT_THROW(settings_of("secant_angle_deg = 0.0"), InputError);
}

}  // namespace
