#include "pipelines/run/size_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/statistics.h"

namespace softgrain {

namespace {

constexpr int kSteps = 60;  // of the curves over the logarithm of the size

struct Worst {
  double difference = 0.0;
  double grains = 0.0;  ///< mean number
};

Worst worst_of(const DrawnSizes& sizes) {
  Worst out;
  for (const std::vector<double>& radii : sizes.samples) {
    out.difference = std::max(out.difference, sizes.asked.largest_difference(radii));
    out.grains += static_cast<double>(radii.size()) / static_cast<double>(sizes.samples.size());
  }
  return out;
}

/// Sizes of the curves, from below the smallest to above the largest.
std::vector<double> radii_of_curves(const DrawnSizes& sizes) {
  double low = sizes.asked.smallest();
  double high = sizes.asked.largest();
  for (const std::vector<double>& radii : sizes.samples)
    for (const double r : radii) {
      low = std::min(low, r);
      high = std::max(high, r);
    }
  low *= 0.98;
  high *= 1.02;
  std::vector<double> out;
  for (int k = 0; k <= kSteps; ++k) out.push_back(low * std::pow(high / low, static_cast<double>(k) / kSteps));
  return out;
}

/// Volume of the largest grain over that of as many grains.
double largest_share(const DrawnSizes& sizes, double grains) {
  return sizes.asked.volume(sizes.asked.largest()) / (grains * sizes.asked.mean_volume());
}

SizesSummary summary_of(const DrawnSizes& sizes) {
  const Worst worst = worst_of(sizes);
  SizesSummary out{.of = sizes.of,
                   .form = to_string(sizes.asked.form()),
                   .dimension = sizes.asked.dimension(),
                   .samples = static_cast<std::int64_t>(sizes.samples.size()),
                   .grains = worst.grains,
                   .largest_difference = worst.difference,
                   .largest_grain = largest_share(sizes, worst.grains),
                   .unit = sizes.unit,
                   .diameter = {},
                   .asked = {},
                   .obtained = {}};
  for (const double r : radii_of_curves(sizes)) {
    Tally obtained;
    for (const std::vector<double>& radii : sizes.samples) obtained.add(sizes.asked.obtained_passing(radii, r));
    out.diameter.push_back(2.0 * r * sizes.scale);
    out.asked.push_back(sizes.asked.passing(r));
    out.obtained.push_back(obtained.statistics().mean);
  }
  return out;
}

}  // namespace

std::vector<SizesSummary> summaries_of(const std::vector<DrawnSizes>& all) {
  std::vector<SizesSummary> out;
  for (const DrawnSizes& sizes : all)
    if (!sizes.samples.empty()) out.push_back(summary_of(sizes));
  return out;
}

std::vector<DrawnSizes> shell_sizes(const SoftParticleSpec& spec, const std::vector<PackingInfo>& packings) {
  if (!spec.sizes) return {};
  DrawnSizes sizes{.of = "grains in shells, grown until they touch", .asked = *spec.sizes, .samples = {}};
  for (const PackingInfo& p : packings) sizes.samples.push_back(p.radii);
  return {sizes};
}

void add_sizes(Findings& out, const std::vector<DrawnSizes>& all) {
  constexpr double kCoarse = 0.1;
  for (const DrawnSizes& sizes : all) {
    if (sizes.samples.empty()) continue;
    const Worst worst = worst_of(sizes);
    const double share = largest_share(sizes, worst.grains);
    const char* whole = share_of(sizes.asked.dimension());
    out.add("sizes of " + sizes.of, {{"largest_difference", worst.difference}, {"largest_grain", share}},
            fmt::format("{}: {}; passing differs from what is asked by at most {:.2g} % of the {}, {:.0f} grains",
                        sizes.of, to_string(sizes.asked.form()), 100.0 * worst.difference, whole, worst.grains));
    if (share > kCoarse)
      out.warn(fmt::format("{}: the largest is {:.2g} of the {} of all {:.0f}: so few cannot follow the distribution",
                           sizes.of, share, whole, worst.grains));
  }
}

}  // namespace softgrain
