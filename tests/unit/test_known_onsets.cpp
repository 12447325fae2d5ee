// Onsets that were measured elsewhere, beside those of a fit.
#include <gtest/gtest.h>

#include <cmath>

#include "calibrate/onset_extrapolation.h"
#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "tests/support/refusal.h"

namespace softgrain {
namespace {

constexpr int kReplicates = 400;

/// Void ratios that fall as span^-0.3 from 0.75 on.
double onset_of(double span) { return 1.0 / (1.0 + 0.75 * std::exp(-0.3 * (std::hypot(std::log(span), 1.0) - 1.0))); }

/// Spans 2, 4 and 6, whose onsets are known to 1e-3 with four degrees of freedom.
StateFit fit_of_three() {
  StateFit fit;
  fit.usable = true;
  fit.degrees = 4;
  for (const double span : {2.0, 4.0, 6.0}) {
    StateGroup group;
    group.name = "span " + std::to_string(span);
    group.span = span;
    group.samples = 3;
    group.onset = {onset_of(span), 1e-3, onset_of(span) - 2e-3, onset_of(span) + 2e-3};
    fit.groups.push_back(group);
  }
  for (int r = 0; r < kReplicates; ++r) {
    const double shift = 1e-3 * std::sin(r);
    fit.replicates.push_back({-3.0, 1.7, onset_of(2.0) + shift, onset_of(4.0) - shift, onset_of(6.0) + shift});
  }
  return fit;
}

TEST(KnownOnsets, StandInTheirPlaceBySpan) {
  const StateFit fit = fit_of_three();
  const StateFit with = with_known_onsets(fit, {{60.0, 0.78, 0.004}, {3.0, 0.62, 0.002}}, 1);
  ASSERT_EQ(with.groups.size(), 5U);
  const std::vector<double> spans{2.0, 3.0, 4.0, 6.0, 60.0};
  for (std::size_t g = 0; g < 5; ++g) EXPECT_EQ(with.groups[g].span, spans[g]);
  EXPECT_EQ(with.groups[1].onset.value, 0.62);
  EXPECT_NEAR(with.groups[4].onset.low, 0.78 - 1.96 * 0.004, 1e-6);
  EXPECT_NEAR(with.groups[4].onset.high, 0.78 + 1.96 * 0.004, 1e-6);
  for (int r = 0; r < kReplicates; ++r) {
    const auto& before = fit.replicates[static_cast<std::size_t>(r)];
    const auto& after = with.replicates[static_cast<std::size_t>(r)];
    ASSERT_EQ(after.size(), 7U);
    EXPECT_EQ(after[0], before[0]);
    EXPECT_EQ(after[2], before[2]);
    EXPECT_EQ(after[4], before[3]);
    EXPECT_EQ(after[5], before[4]);
  }
}

/// As extrapolations draw replicates away from the value, they have the standard error that was given.
TEST(KnownOnsets, ScatterByTheirErrorAndByNothingElse) {
  const StateFit with = with_known_onsets(fit_of_three(), {{60.0, 0.78, 0.004}, {90.0, 0.80, 0.002}}, 1);
  double sum = 0.0;
  double squares = 0.0;
  double both = 0.0;
  const double widen = student_over_normal(with.degrees);
  for (const auto& r : with.replicates) {
    const double first = widen * (r[5] - 0.78) / 0.004;
    sum += first / kReplicates;
    squares += first * first / kReplicates;
    both += first * widen * (r[6] - 0.80) / 0.002 / kReplicates;
  }
  EXPECT_LT(std::abs(sum), 0.15);
  EXPECT_NEAR(squares, 1.0, 0.2);
  EXPECT_LT(std::abs(both), 0.15);
  const StateFit again = with_known_onsets(fit_of_three(), {{60.0, 0.78, 0.004}, {90.0, 0.80, 0.002}}, 1);
  EXPECT_EQ(again.replicates, with.replicates);
  const StateFit other = with_known_onsets(fit_of_three(), {{60.0, 0.78, 0.004}, {90.0, 0.80, 0.002}}, 2);
  EXPECT_NE(other.replicates, with.replicates);
}

TEST(KnownOnsets, ALargeSpanDecidesBetweenFormsAndNarrows) {
  const OnsetExtrapolation alone = extrapolate_onset(fit_of_three(), 1e4);
  const OnsetExtrapolation with =
      extrapolate_onset(with_known_onsets(fit_of_three(), {{100.0, onset_of(100.0), 1e-3}}, 1), 1e4);
  ASSERT_TRUE(alone.usable && with.usable) << with.message;
  EXPECT_EQ(alone.largest_span, 6.0);
  EXPECT_EQ(with.largest_span, 100.0);
  EXPECT_LT(with.onset.high - with.onset.low, 0.5 * (alone.onset.high - alone.onset.low));
  EXPECT_LT(with.onset.low, onset_of(1e4));
  EXPECT_GT(with.onset.high, onset_of(1e4));
}

TEST(KnownOnsets, NoneChangeNothing) {
  const StateFit fit = fit_of_three();
  EXPECT_EQ(with_known_onsets(fit, {}, 1).replicates, fit.replicates);
}

TEST(KnownOnsets, RefuseWhatIsNoOnset) {
  const StateFit fit = fit_of_three();
  for (const KnownOnset& wrong : {KnownOnset{0.5, 0.7, 0.01}, {NAN, 0.7, 0.01}})
    test::expect_refused<InputError>([&] { with_known_onsets(fit, {wrong}, 1); }, "span");
  for (const KnownOnset& wrong : {KnownOnset{60.0, 1.0, 0.01}, {60.0, 0.0, 0.01}, {60.0, NAN, 0.01}})
    test::expect_refused<InputError>([&] { with_known_onsets(fit, {wrong}, 1); }, "between 0 and 1");
  for (const KnownOnset& wrong : {KnownOnset{60.0, 0.7, 0.0}, {60.0, 0.7, INFINITY}})
    test::expect_refused<InputError>([&] { with_known_onsets(fit, {wrong}, 1); }, "standard error");
  test::expect_refused<InputError>([&] { with_known_onsets({}, {{60.0, 0.7, 0.01}}, 1); }, "could not be fitted");
}

}  // namespace
}  // namespace softgrain
