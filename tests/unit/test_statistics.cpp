// Statistics: against the long form, against certified values of NIST's StRD (univariate summary statistics), and where
// they are not defined.
#include "common/core/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "common/core/error.h"
#include "common/core/random.h"

namespace {

using namespace softgrain;
using Values = std::vector<double>;

/// Alternating `low`, `high` after `first`: NumAcc2 to NumAcc4 of StRD, 1001 numbers each.
Values alternating(double first, double low, double high) {
  Values values{first};
  for (int k = 0; k < 500; ++k) values.insert(values.end(), {low, high});
  return values;
}

double digits(double value, double certified) { return -std::log10(std::abs(value / certified - 1.0) + 1e-16); }

TEST(Statistics, CertifiedMeansAndDeviationsOfNist) {
  struct Case {
    Values values;
    double mean, deviation, least_digits;
  };
  for (const Case& c :
       {Case{{10000001, 10000003, 10000002}, 10000002.0, 1.0, 15}, Case{alternating(1.2, 1.1, 1.3), 1.2, 0.1, 13},
        Case{alternating(1000000.2, 1000000.1, 1000000.3), 1000000.2, 0.1, 9},
        Case{alternating(10000000.2, 10000000.1, 10000000.3), 10000000.2, 0.1, 8}}) {
    const MeanError m = mean_error(c.values);
    EXPECT_EQ(m.n, c.values.size());
    EXPECT_GE(digits(m.mean, c.mean), 15.0) << c.mean;
    EXPECT_GE(digits(m.deviation, c.deviation), c.least_digits) << c.mean;
    EXPECT_DOUBLE_EQ(m.error, m.deviation / std::sqrt(static_cast<double>(m.n)));
  }
}

TEST(Statistics, TheLongFormIsTheSame) {
  RandomStream random(3, RandomPurpose::test, 0);
  for (const std::size_t n : {2U, 3U, 10U, 1000U}) {
    Values values;
    for (std::size_t k = 0; k < n; ++k) values.push_back(5.0 + random.uniform());
    double sum = 0.0;
    for (const double v : values) sum += v;
    const double mean = sum / static_cast<double>(n);
    double squares = 0.0;
    for (const double v : values) squares += (v - mean) * (v - mean);
    const MeanError m = mean_error(values);
    EXPECT_NEAR(m.mean / mean, 1.0, 1e-13);
    EXPECT_NEAR(m.deviation / std::sqrt(squares / (static_cast<double>(n) - 1.0)), 1.0, 1e-13);
  }
}

TEST(Statistics, AFiniteMeanLeavesOutTheRest) {
  const double infinity = std::numeric_limits<double>::infinity();
  const MeanError m = finite_mean(Values{1.0, std::nan(""), 3.0, infinity});
  EXPECT_EQ(m.n, 2U);
  EXPECT_EQ(m.mean, 2.0);
  EXPECT_DOUBLE_EQ(m.error, 1.0);
  EXPECT_EQ(finite_mean(Values{infinity}).n, 0U);
  struct Part {
    double value;
  };
  const std::vector<Part> parts{{1.0}, {std::nan("")}, {5.0}};
  EXPECT_EQ(finite_mean(parts, &Part::value).mean, 3.0);
  EXPECT_EQ(finite_mean(parts, [](const Part& p) { return 2.0 * p.value; }).mean, 6.0);
}

TEST(Statistics, RepetitionsCountAsTheValuesWrittenOut) {
  const MeanError written = mean_error(Values{1.0, 1.0, 1.0, 4.0, 6.0, 6.0});
  Tally sample;
  sample.add(1.0, 3.0);
  sample.add(1e9, 0.0);
  sample.add(4.0);
  sample.add(6.0, 2.0);
  const MeanError m = sample.statistics();
  EXPECT_EQ(m.n, written.n);
  EXPECT_NEAR(m.mean, written.mean, 1e-14);
  EXPECT_NEAR(m.deviation, written.deviation, 1e-14);
  EXPECT_NEAR(m.error, written.error, 1e-14);
  EXPECT_EQ(sample.mean(), m.mean);
}

TEST(Statistics, WithoutValuesOrScatterNothingIsKnown) {
  const MeanError one = mean_error(Values{2.0});
  EXPECT_EQ(one.mean, 2.0);
  EXPECT_TRUE(std::isnan(one.deviation) && std::isnan(one.error));
  EXPECT_TRUE(one.deviation_or_zero() == 0.0 && one.error_or_zero() == 0.0);
  EXPECT_TRUE(std::isnan(mean_error(Values{}).mean));
  EXPECT_TRUE(std::isnan(Tally{}.mean()));
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

TEST(Statistics, QuantilesAreLinearBetweenOrderStatistics) {
  const Values values{30.0, 10.0, 20.0};
  EXPECT_DOUBLE_EQ(quantile(values, 0.5), 20.0);
  EXPECT_DOUBLE_EQ(quantile(values, 0.375), 15.0);  // 0.375 (n + 1) = 1.5
  EXPECT_DOUBLE_EQ(quantile(values, 0.01), 10.0);
  EXPECT_DOUBLE_EQ(quantile(values, 0.99), 30.0);
  EXPECT_DOUBLE_EQ(quantile({7.0}, 0.3), 7.0);
}

TEST(Statistics, JackknifeOfARatio) {
  EXPECT_NEAR(paired_ratio(Values{2, 4, 6}, Values{1, 2, 3}).ratio, 2.0, 1e-14);
  EXPECT_NEAR(paired_ratio(Values{2, 4, 6}, Values{1, 2, 3}).error, 0.0, 1e-14);
  // with a constant reference the jackknife error is the standard error of the mean, over the reference
  const Values a{1.0, 2.0, 6.0};
  EXPECT_NEAR(paired_ratio(a, Values{2, 2, 2}).error, 0.5 * mean_error(a).error, 1e-14);
  EXPECT_THROW(paired_ratio(a, Values{1, 2}), InputError);
}

}  // namespace
