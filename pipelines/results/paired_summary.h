// In what the numbers of two runs differ, with the error of the difference: part of the summary of `compare`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/core/limits.h"
#include "common/core/statistics.h"
#include "common/core/text.h"
#include "common/data/fields.h"
#include "common/io/json_record.h"

namespace softgrain {

/// One number of two runs A and B, and A - B.
struct PairedNumber {
  std::string name;
  std::string unit;  ///< empty: a plain number
  double a = kNaN;
  double b = kNaN;
  double difference = kNaN;      ///< a - b
  double error = kNaN;           ///< standard error of the difference
  double low = kNaN;             ///< 95 % interval of the difference
  double high = kNaN;            ///< 95 % interval of the difference
  double error_a = kNaN;         ///< standard error of a by itself
  double error_b = kNaN;         ///< standard error of b by itself
  double unpaired_error = kNaN;  ///< standard error of the difference if both were independent
  std::int64_t pairs = 0;        ///< samples or packings that are the same in both; 0: not paired
  std::string unknown{};         ///< why the difference has no error; empty: too few samples, or it has one

  /// Error of the difference over the mean error of one value; NaN where one is not known.
  [[nodiscard]] double over_one() const;
};

void fields(auto&& visit, Of<PairedNumber> auto& n) {
  visit("name", n.name);
  visit("unit", n.unit);
  visit("a", n.a);
  visit("b", n.b);
  visit("difference", n.difference);
  visit("standard_error", n.error);
  range_field(visit, "interval_95", n.low, n.high);
  visit("standard_error_a", n.error_a);
  visit("standard_error_b", n.error_b);
  visit("unpaired_standard_error", n.unpaired_error);
  visit("pairs", n.pairs);
  visit("no_error", n.unknown, kLeftOut);
}

struct PairedSummary {
  bool paired = false;
  std::string reason;                 ///< why errors are not paired
  std::string method;                 ///< how they are, in a sentence
  std::vector<PairedNumber> numbers;  ///< numbers of both runs, those that matter most first
};

void fields(auto&& visit, Of<PairedSummary> auto& s) {
  visit("paired", s.paired);
  visit("reason", s.reason);
  visit("method", s.method);
  visit("numbers", s.numbers);
}

/// Mean of paired samples a_k - b_k with Student's interval, n - 1 degrees of freedom. Throws InputError when lengths
/// differ.
PairedNumber paired_number(const std::string& name, const std::string& unit, const std::vector<double>& a,
                           const std::vector<double>& b);

/// One independent part of a standard error, with the degrees of freedom that it was estimated with.
struct ErrorPart {
  double error = 0.0;
  double degrees = 0.0;
  friend bool operator==(const ErrorPart&, const ErrorPart&) = default;
};

/// A part that is 0 however few samples there are: what it would come from is the same in both.
inline constexpr ErrorPart kExactPart{0.0, kInfinity};

/// A value with independent parts of its error, added in squares, and Student's interval with
///   (sum s_k)^2/(sum s_k^2/f_k)
/// degrees of freedom, s the squared parts, f their degrees (Welch 1947, doi:10.1093/biomet/34.1-2.28). Not known, so
/// infinite, without parts and where one has fewer than one degree; 0 where all are kExactPart.
Estimate with_error_parts(double value, const std::vector<ErrorPart>& parts);

/// Mean of `a` less mean of `b`, independent samples, with Welch's interval. Of fewer than two samples of either the
/// error is infinite.
Estimate difference_of_means(const std::vector<double>& a, const std::vector<double>& b);

/// a - b of two independent values; the interval is normal.
PairedNumber unpaired_number(const std::string& name, const std::string& unit, const Estimate& a, const Estimate& b);

/// The first three numbers, a line each, then how they were paired, or why they were not.
std::string paired_text(const PairedSummary& summary);

/// One row per number: differences.csv.
TextTable table_of(const PairedSummary& summary);

}  // namespace softgrain
