#include "pipelines/results/paired_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/text.h"

namespace softgrain {

namespace {

constexpr std::size_t kShownDifferences = 3;

std::string line_of(const PairedNumber& n) {
  const bool pascal = n.unit == "Pa";
  const auto number = [&](double x, int digits) {
    return pascal ? pressure_text(x, digits) : fmt::format("{:.{}g}", x, digits);
  };
  std::string text =
      fmt::format("  {}: {} - {}: difference {}", n.name + (n.unit.empty() || pascal ? "" : " [" + n.unit + "]"),
                  number(n.a, 5), number(n.b, 5), number(n.difference, 3));
  if (!std::isfinite(n.error))
    return text + fmt::format(" (no error: {})\n", n.unknown.empty() ? "too few samples" : n.unknown);
  if (n.error == 0.0 && n.pairs > 0) return text + " +- 0 (exact: the packings behind it are the same in both)\n";
  text += fmt::format(" +- {} (95 %: {} to {})", number(n.error, 2), number(n.low, 3), number(n.high, 3));
  if (n.pairs > 0 && std::isfinite(n.unpaired_error) && n.error > 0.0)
    text +=
        fmt::format("; unpaired +- {}, {:.2g} times as much", number(n.unpaired_error, 2), n.unpaired_error / n.error);
  if (std::isfinite(n.low) && (n.low > 0.0 || n.high < 0.0)) return text + "\n";
  return text + "; not told from 0\n";
}

}  // namespace

double PairedNumber::over_one() const {
  const double one = 0.5 * (error_a + error_b);
  return std::isfinite(error) && one > 0.0 && std::isfinite(one) ? error / one : kNaN;
}

PairedNumber paired_number(const std::string& name, const std::string& unit, const std::vector<double>& a,
                           const std::vector<double>& b) {
  if (a.size() != b.size())
    throw InputError(fmt::format("{}: {} and {} values cannot be paired", name, a.size(), b.size()));
  std::vector<double> differences;
  for (std::size_t k = 0; k < a.size(); ++k) differences.push_back(a[k] - b[k]);
  const MeanError of_a = mean_error(a);
  const MeanError of_b = mean_error(b);
  const Estimate d = mean_estimate(mean_error(differences));
  return {.name = name,
          .unit = unit,
          .a = of_a.mean,
          .b = of_b.mean,
          .difference = d.value,
          .error = d.standard_error,
          .low = d.low,
          .high = d.high,
          .error_a = of_a.error,
          .error_b = of_b.error,
          .unpaired_error = std::hypot(of_a.error, of_b.error),
          .pairs = static_cast<std::int64_t>(a.size())};
}

Estimate with_error_parts(double value, const std::vector<ErrorPart>& parts) {
  double square = 0.0;
  double scatter = 0.0;
  double all = 0.0;
  bool exact = !parts.empty();
  for (const ErrorPart& p : parts) {
    if (p == kExactPart) continue;
    exact = false;
    if (!(p.degrees >= 1.0)) return student_estimate(value, kInfinity, 0.0);
    square += p.error * p.error;
    scatter += std::pow(p.error, 4) / p.degrees;
    all += p.degrees;
  }
  if (exact) return {value, 0.0, value, value};
  return student_estimate(value, std::sqrt(square), scatter > 0.0 ? square * square / scatter : all);
}

Estimate difference_of_means(const std::vector<double>& a, const std::vector<double>& b) {
  const MeanError of_a = mean_error(a);
  const MeanError of_b = mean_error(b);
  const auto part = [](const MeanError& m) { return ErrorPart{m.error, static_cast<double>(m.n) - 1.0}; };
  return with_error_parts(of_a.mean - of_b.mean, {part(of_a), part(of_b)});
}

PairedNumber unpaired_number(const std::string& name, const std::string& unit, const Estimate& a, const Estimate& b) {
  const double error = std::hypot(a.standard_error, b.standard_error);
  const double difference = a.value - b.value;
  return {.name = name,
          .unit = unit,
          .a = a.value,
          .b = b.value,
          .difference = difference,
          .error = error,
          .low = difference - kNormal95 * error,
          .high = difference + kNormal95 * error,
          .error_a = a.standard_error,
          .error_b = b.standard_error,
          .unpaired_error = error,
          .pairs = 0};
}

std::string paired_text(const PairedSummary& summary) {
  if (summary.numbers.empty()) return "";
  std::string text = "A - B, the error of the difference:\n";
  const std::size_t shown = std::min(summary.numbers.size(), kShownDifferences);
  for (std::size_t k = 0; k < shown; ++k) text += line_of(summary.numbers[k]);
  text += summary.paired ? "  paired: " + summary.method + "\n"
                         : "  not paired, errors as of independent runs: " + summary.reason + "\n";
  if (summary.numbers.size() > shown)
    text += fmt::format("  {} in summary and differences.csv (--out DIR)\n",
                        counted(summary.numbers.size() - shown, "more difference"));
  return text;
}

TextTable table_of(const PairedSummary& summary) {
  TextTable out{
      {"number", "unit", "A", "B", "A - B", "standard error", "low (95 %)", "high (95 %)", "standard error of A",
       "standard error of B", "unpaired standard error", "error over that of one value", "pairs"},
      {}};
  const auto text = [](double x) { return std::isfinite(x) ? fmt::format("{:.8g}", x) : std::string(); };
  for (const PairedNumber& n : summary.numbers)
    out.rows.push_back({n.name, n.unit, text(n.a), text(n.b), text(n.difference), text(n.error), text(n.low),
                        text(n.high), text(n.error_a), text(n.error_b), text(n.unpaired_error), text(n.over_one()),
                        std::to_string(n.pairs)});
  return out;
}

}  // namespace softgrain
