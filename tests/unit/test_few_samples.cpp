// What few samples leave open, and how estimates are put into words.
#include "common/core/few_samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "common/core/limits.h"
#include "common/data/law_words.h"

namespace softgrain {
namespace {

TEST(FewSamples, WidenByStudentsT) {
  EXPECT_NEAR(student95(1.0), 12.7062, 1e-4);
  EXPECT_NEAR(student95(6.0), 2.446912, 1e-6);
  EXPECT_EQ(student95(0.0), kInfinity);
  EXPECT_NEAR(few_samples_factor(7), std::sqrt(7.0 / 6.0) * 2.446912 / 1.959964, 1e-6);
  EXPECT_NEAR(few_samples_factor(100000), 1.0, 1e-4);
  EXPECT_EQ(few_samples_factor(1), kInfinity);
}

TEST(FewSamples, StudentsTIsAsInTables) {
  EXPECT_NEAR(student95(4.0), 2.776445, 1e-6);
  EXPECT_NEAR(student_quantile(0.995, 4.0), 4.604095, 1e-6);
  EXPECT_NEAR(student_quantile(0.9995, 9.0), 4.780913, 1e-6);
  EXPECT_EQ(student_quantile(0.995, 0.5), kInfinity);
  EXPECT_NEAR(student_over_normal(4.0), 2.776445 / 1.959964, 1e-6);
}

TEST(FewSamples, IntervalsGoByStudentsT) {
  const auto [low, high] = student_interval(2.0, 0.5, 4.0);
  EXPECT_NEAR(low, 2.0 - 0.5 * 2.776445, 1e-6);
  EXPECT_NEAR(high, 2.0 + 0.5 * 2.776445, 1e-6);
  const Estimate free = student_estimate(2.0, 0.5, 4.0);
  EXPECT_EQ(free.value, 2.0);
  EXPECT_EQ(free.standard_error, 0.5);
  EXPECT_EQ(free.low, low);
  EXPECT_EQ(free.high, high);
  const Estimate bounded = student_estimate(2.0, 0.5, 4.0, 1.0, 3.0);
  EXPECT_EQ(bounded.low, 1.0);
  EXPECT_EQ(bounded.high, 3.0);
  const Estimate unknown = student_estimate(2.0, 0.5, 0.0, 1.0, 3.0);
  EXPECT_EQ(unknown.value, 2.0);
  EXPECT_EQ(unknown.standard_error, kInfinity);
  EXPECT_EQ(unknown.low, -kInfinity);
  EXPECT_EQ(unknown.high, kInfinity);
}

TEST(FewSamples, AMeanOfNHasOneDegreeLess) {
  const std::vector<double> five{1.0, 2.0, 3.0, 4.0, 5.0};
  const Estimate e = mean_estimate(mean_error(five), 0.0);
  EXPECT_EQ(e.value, 3.0);
  EXPECT_NEAR(e.standard_error, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(e.low, 3.0 - std::sqrt(0.5) * 2.776445, 1e-6);
  EXPECT_NEAR(e.high, 3.0 + std::sqrt(0.5) * 2.776445, 1e-6);
  EXPECT_EQ(mean_estimate(mean_error(std::vector{2.0})).high, kInfinity);
}

TEST(FewSamples, WidenEachSideAndStayAboveZero) {
  const auto linear = widened(1.0, 0.5, 3.0, 2.0, false);
  EXPECT_EQ(linear, std::make_pair(0.0, 5.0));
  EXPECT_NEAR(widened(0.1, -0.2, 0.3, 2.0, false).first, -0.5, 1e-12);
  const auto positive = widened(1.0, 0.5, 4.0, 2.0, true);
  EXPECT_NEAR(positive.first, 0.25, 1e-12);
  EXPECT_NEAR(positive.second, 16.0, 1e-12);
  EXPECT_EQ(widened(0.1, 0.0, 0.3, 3.0, true).first, 0.0);
  EXPECT_NEAR(widened(0.0, 0.0, 0.2, 3.0, true).second, 0.6, 1e-12);
  EXPECT_EQ(widened(1.0, -kInfinity, kInfinity, 2.0, false), std::make_pair(-kInfinity, kInfinity));
}

TEST(FewSamples, TellZeroApartOrDoNot) {
  EXPECT_FALSE(is_told_from_zero(2, 310.0, 40.6));  // t of one degree: 516
  EXPECT_TRUE(is_told_from_zero(2, 310.0, 20.0));
  EXPECT_FALSE(is_told_from_zero(6, -0.17, 0.5));
  EXPECT_TRUE(is_told_from_zero(6, -0.17, 0.05));
  EXPECT_TRUE(is_told_from_zero(1, 0.1, kNaN));
}

TEST(EstimateWords, SayWhatIsNotDetermined) {
  EXPECT_EQ(interval_text(0.0447, 0.0441, 0.0453), "0.0447 (0.0441 to 0.0453)");
  EXPECT_EQ(interval_text(0.438, -kInfinity, kInfinity), "0.438 (interval not determined)");
  EXPECT_EQ(interval_text(0.438, 0.438, 0.438), "0.438 (interval not determined)");
  EXPECT_EQ(bracket_text({1.0, 0.1, 0.8, 1.2}, 100.0), "100 [80, 120]");
  EXPECT_EQ(bracket_text({132.9, 0.0, 132.9, 132.9}), "132.9 [not determined]");
  // Ends that differ are not the same text.
  EXPECT_EQ(bracket_text({132.90002, 0.0, 132.9, 132.9001}), "132.9 [132.9, 132.9001]");
}

MultiContactLaw law_of(LawForm form, double error, LawStatus status = LawStatus::good) {
  MultiContactLaw law;
  law.form = form;
  law.error_cross = error;
  law.status = status;
  return law;
}

TEST(FormLabel, SaysWhetherErrorsOrASceneChose) {
  LawTableEntry entry;
  entry.laws = {law_of(LawForm::pair, 0.5), law_of(LawForm::isotropic, 0.2), law_of(LawForm::directional, 0.1)};
  entry.best = LawForm::directional;
  EXPECT_EQ(form_label(entry, entry.laws[2]), "directional (best)");
  EXPECT_EQ(form_label(entry, entry.laws[1]), "isotropic");
  entry.best = LawForm::isotropic;
  EXPECT_EQ(form_label(entry, entry.laws[1]), "isotropic (chosen)");
  EXPECT_EQ(form_label(entry, entry.laws[2]), "directional");
  entry.laws[2].status = LawStatus::underdetermined;  // what the data do not determine is not preferred
  EXPECT_EQ(form_label(entry, entry.laws[1]), "isotropic (best)");
}

/// A law of a library was not fitted to loadings, so none could be left out of it.
TEST(UnseenError, IsThatOfTheFitOrOfTheLibrary) {
  LawTableEntry entry;
  MultiContactLaw law = law_of(LawForm::isotropic, 0.178);
  law.error_held_out = kNaN;
  EXPECT_EQ(unseen_error_text(entry, law), "off by 17.8 % leaving one loading of planes out");
  law.error_cross = kNaN;
  EXPECT_EQ(unseen_error_text(entry, law), "fitted to one loading of planes, so that nothing could be left out");
  law.error_held_out = 0.207;
  for (const TableSource source : {TableSource::library, TableSource::press_test}) {
    entry.source = source;
    EXPECT_EQ(unseen_error_text(entry, law),
              "from a library of laws, which are off by 20.7 % on loadings that their fits did not see");
  }
}

}  // namespace
}  // namespace softgrain
