// Counts in bins of equal width.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

namespace softgrain {

/// Bin k holds low + k w <= x < low + (k + 1) w, w = (high - low)/bins; what lies outside is counted apart, so that
/// nothing is lost.
struct Histogram {
  double low = 0.0;
  double high = 1.0;
  std::vector<std::int64_t> counts;
  std::int64_t below = 0;
  std::int64_t above = 0;  ///< values at or above `high`, and what is not a number

  Histogram(double from, double to, std::size_t bins) : low(from), high(to), counts(bins, 0) {}

  void add(double x) {
    const double place = (x - low) / (high - low) * static_cast<double>(counts.size());
    if (place < 0.0)
      ++below;
    else if (place < static_cast<double>(counts.size()))
      ++counts[static_cast<std::size_t>(place)];
    else
      ++above;
  }
  [[nodiscard]] std::int64_t total() const {
    std::int64_t sum = below + above;
    for (const std::int64_t n : counts) sum += n;
    return sum;
  }
  [[nodiscard]] double width() const { return (high - low) / static_cast<double>(counts.size()); }
  /// Probability density: its integral and the shares outside add up to 1. Zero when nothing was counted.
  [[nodiscard]] std::vector<double> density() const {
    const auto all = static_cast<double>(total());
    std::vector<double> out;
    for (const std::int64_t n : counts) out.push_back(all > 0.0 ? static_cast<double>(n) / (all * width()) : 0.0);
    return out;
  }
};

/// Distribution of contact forces over their mean, f/<f>, in bins of 0.1 from 0 to 10 (Radjai, Jean, Moreau, Roux 1996,
/// DOI 10.1103/PhysRevLett.77.274: exponential above the mean). Forces of any unit; empty where their mean is not
/// positive.
inline std::optional<Histogram> force_distribution(const std::vector<double>& forces) {
  double sum = 0.0;
  for (const double f : forces) sum += f;
  if (!(sum > 0.0)) return std::nullopt;
  const double mean = sum / static_cast<double>(forces.size());
  Histogram out(0.0, 10.0, 100);
  for (const double f : forces) out.add(f / mean);
  return out;
}

}  // namespace softgrain
