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
  std::string unit;
  double a = kNaN;
  double b = kNaN;
  double difference = kNaN;  ///< a - b
  double error = kNaN;
  double low = kNaN;   ///< 95 % interval of the difference
  double high = kNaN;  ///< 95 % interval of the difference
  double error_a = kNaN;
  double error_b = kNaN;
  double unpaired_error = kNaN;
  std::int64_t pairs = 0;
  std::string unknown{};

  /// Error of the difference over the mean error of one value; NaN where one is not known.
  [[nodiscard]] double over_one() const;
};

void fields(auto&& visit, Of<PairedNumber> auto& n) {
  visit("name", n.name, Means{"name of the result"});
  visit("unit", n.unit, Means{"unit of the result; empty: a plain number"});
  visit("a", n.a, Means{"value of run A", "as `unit` says"});
  visit("b", n.b, Means{"value of run B", "as `unit` says"});
  visit("difference", n.difference, Means{"A minus B", "as `unit` says"});
  visit("standard_error", n.error, Means{"standard error of the difference", "as `unit` says"});
  range_field(visit, "interval_95", n.low, n.high, Means{"95 % interval of the difference", "as `unit` says"});
  visit("standard_error_a", n.error_a, Means{"standard error of A by itself", "as `unit` says"});
  visit("standard_error_b", n.error_b, Means{"standard error of B by itself", "as `unit` says"});
  visit("unpaired_standard_error", n.unpaired_error,
        Means{"standard error of the difference if both runs were independent", "as `unit` says"});
  visit("pairs", n.pairs, Means{"samples or packings that are the same in both runs; 0: not paired", "1"});
  visit("no_error", n.unknown, kLeftOut, Means{"why the difference has no error"});
}

struct PairedSummary {
  bool paired = false;
  std::string reason;
  std::string method;
  std::vector<PairedNumber> numbers;
};

void fields(auto&& visit, Of<PairedSummary> auto& s) {
  visit("paired", s.paired, Means{"whether errors are paired"});
  visit("reason", s.reason, Means{"why they are not"});
  visit("method", s.method, Means{"how they are paired"});
  visit("numbers", s.numbers, Means{"results of both runs, those that matter most first"});
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
