// Texts of several parts, numbers with their errors, and ends of intervals, character for character.
#include "common/core/text.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "common/core/limits.h"
#include "common/data/law_words.h"

namespace softgrain {
namespace {

using Texts = std::vector<std::string>;

std::string write(double value, int digits) { return rounded_text(value, {digits}); }

TEST(JoinText, PutsASeparatorBetweenPartsOnly) {
  EXPECT_EQ(join_text(Texts{"a", "b", "c"}), "a, b, c");
  EXPECT_EQ(join_text(Texts{"a"}, "; "), "a");
  EXPECT_EQ(join_text(Texts{}), "");
  EXPECT_EQ(join_text(Texts{"", "b"}), ", b") << "an empty part is a part";
  EXPECT_EQ(join_text(std::array{3, 20}, " x "), "3 x 20");
}

TEST(JoinText, TakesAFunctionOrAMember) {
  struct Named {
    std::string name;
  };
  EXPECT_EQ(join_text(std::vector<Named>{{"a"}, {"b"}}, " and ", &Named::name), "a and b");
  EXPECT_EQ(join_text(std::vector{1.0, 2.5}, ",", [](double x) { return rounded_text(2.0 * x); }), "2,5");
}

TEST(AppendPart, StartsWithoutASeparator) {
  std::string text;
  append_part(text, "a");
  EXPECT_EQ(text, "a");
  append_part(text, "b");
  append_part(text, "c", ", ");
  EXPECT_EQ(text, "a; b, c");
  append_part(text, "");
  EXPECT_EQ(text, "a; b, c; ");
}

TEST(Counted, IsOneOrMany) {
  EXPECT_EQ(counted(1, "sample"), "1 sample");
  EXPECT_EQ(counted(0, "sample"), "0 samples");
  EXPECT_EQ(counted(2, "sample"), "2 samples");
  EXPECT_EQ(counted(1, "body", "bodies"), "1 body");
  EXPECT_EQ(counted(3, "body", "bodies"), "3 bodies");
}

TEST(OneLine, HasNoControlCharacters) {
  for (const char* text : {"", "Sand 0/2, \xc3\xa9tude", "\xc2\xb5", "\xc2\xa0"}) {
    EXPECT_TRUE(is_one_line(text)) << text;
    EXPECT_EQ(on_one_line(text), text);
  }
  // The last: U+009B in UTF-8, which terminals take like the escape character and "[".
  for (const char* text : {"a\nb", "a\tb",
                           "a\x1b"
                           "b",
                           "a\x7f"
                           "b",
                           "a\xc2\x9b"
                           "b"}) {
    EXPECT_FALSE(is_one_line(text));
    EXPECT_EQ(on_one_line(text), "a b");
  }
}

TEST(WithoutTrailingZeros, KeepsZerosBeforeThePoint) {
  EXPECT_EQ(without_trailing_zeros("0.250000"), "0.25");
  EXPECT_EQ(without_trailing_zeros("10.00"), "10");
  EXPECT_EQ(without_trailing_zeros("100"), "100");
  EXPECT_EQ(without_trailing_zeros("-0.00"), "-0");
}

TEST(RoundedText, CountsDigitsOrDecimals) {
  EXPECT_EQ(rounded_text(0.71051), "0.7105");
  EXPECT_EQ(rounded_text(123456.0, {2}), "1.2e+05");
  EXPECT_EQ(rounded_text(0.71051, {2, true}), "0.71");
  EXPECT_EQ(rounded_text(1.25, {1, true, true}), "+1.2");
  EXPECT_EQ(rounded_text(1.25, {2, false, true}), "+1.2");
  EXPECT_EQ(rounded_text(-1.5, {2, false, true}), "-1.5");
  EXPECT_EQ(rounded_text(kInfinity, {3}), "inf");
  EXPECT_EQ(rounded_text(kInfinity, {3}, "undefined"), "undefined");
  EXPECT_EQ(rounded_text(kNaN, {3}, ""), "");
  EXPECT_EQ(rounded_text(2.0, {3}, "undefined"), "2");
}

TEST(PercentText, IsOfAShare) {
  EXPECT_EQ(percent_text(0.1254), "12.5 %");
  EXPECT_EQ(percent_text(0.1254, {6}), "12.54 %");
  EXPECT_EQ(percent_text(0.1254, {1, true, true}), "+12.5 %");
  EXPECT_EQ(percent_text(kNaN, {1, true}, "-"), "-");
}

TEST(WithError, HasAnErrorWhereThereIsOne) {
  EXPECT_EQ(with_error(0.71051, 0.00112), "0.7105 +- 0.0011");
  EXPECT_EQ(with_error(0.71051, std::nullopt), "0.7105");
  EXPECT_EQ(with_error(0.71051, if_finite(kNaN)), "0.7105");
  EXPECT_EQ(with_error(0.71051, if_finite(0.25)), "0.7105 +- 0.25");
  EXPECT_EQ(with_error(12.34, 0.46, {.value = {1, true}, .error = {1, true}, .between = " ± "}), "12.3 ± 0.5");
  EXPECT_EQ(with_error(kNaN, 0.46, {.undefined = "-"}), "-");
  EXPECT_EQ(with_error(kNaN, std::nullopt), "nan");
}

TEST(WithError, OfOneSampleHasNone) {
  EXPECT_EQ(with_error(mean_error(std::vector{1.0, 2.0, 3.0})), "2 +- 0.58");
  EXPECT_EQ(with_error(mean_error(std::vector{2.0})), "2");
}

TEST(EndsText, SaysWhatIsNotKnown) {
  EXPECT_EQ(ends_text(0.0441, 0.0453, {write}), "0.0441 .. 0.0453");
  EXPECT_EQ(ends_text(0.04412, 0.04531, {write, 3, " to "}), "0.0441 to 0.0453");
  EXPECT_EQ(ends_text(-kInfinity, kInfinity, {write}), "not determined");
  EXPECT_EQ(ends_text(0.5, 0.5, {write}), "not determined");
  EXPECT_EQ(ends_text(0.5, 0.5, {.number = write, .may_be_equal = true}), "0.5 .. 0.5");
  EXPECT_EQ(ends_text(0.5, kInfinity, {write, 3, " to ", "–", true}), "–");
}

TEST(EstimateWithError, TellsFixedNumbersFromUnknownErrors) {
  EXPECT_EQ(estimate_with_error({0.7333, 0.1912, 0.0, 1.0}, {write}), "0.733 +- 0.19");
  EXPECT_EQ(estimate_with_error({0.7333, 0.0, 0.0, 1.0}, {write}), "0.733");
  EXPECT_EQ(estimate_with_error({0.7333, kInfinity, 0.0, 1.0}, {write}), "0.733 (?)");
  EXPECT_EQ(estimate_with_error({0.7333, 0.1912, 0.0, 1.0}, {write, " ± ", ""}), "0.733 ± 0.19");
}

TEST(PressureText, TakesThePrefixThatFits) {
  EXPECT_EQ(pressure_text(1e6), "1 MPa");
  EXPECT_EQ(pressure_text(-1.5e6), "-1.5 MPa");
  EXPECT_EQ(pressure_text(7e10), "70 GPa");
  EXPECT_EQ(pressure_text(5e4), "50 kPa");
  EXPECT_EQ(pressure_text(MeanError{2, 6.5e8, 2.8e7, 2e7}), "650 +- 20 MPa");
  EXPECT_EQ(pressure_text(MeanError{1, 470.0, 0.0, 0.0}), "470 Pa");
  EXPECT_EQ(pressure_text(20.0), "20 Pa");
  EXPECT_EQ(pressure_text(123456.0, 3), "123 kPa");
  EXPECT_EQ(pressure_text(123456.0, 2), "120 kPa");
  EXPECT_EQ(pressure_text(999600.0, 3), "1000 kPa");
  EXPECT_EQ(pressure_text(0.0), "0 Pa");
}

TEST(DigitsToDiffer, StopsAtTheFirstDifference) {
  EXPECT_EQ(digits_to_differ(132.9, 132.9001, 4, 12), 7);
  EXPECT_EQ(digits_to_differ(1.0, 2.0, 3, 9), 3);
  EXPECT_EQ(digits_to_differ(1.0, 1.0, 3, 9), 9);
}

}  // namespace
}  // namespace softgrain
