// Size distribution of the packed grains against the power law they were drawn from.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/statistics.h"
#include "common/core/text.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/sections.h"
#include "pipelines/report/svg_plot.h"
#include "pipelines/results/summary.h"

namespace softgrain::report {
namespace {

constexpr int kBins = 16;

struct SizeRange {
  double low;
  double high;
  [[nodiscard]] double edge(int k) const { return low * std::pow(high / low, static_cast<double>(k) / kBins); }
  [[nodiscard]] int bin(double r) const {
    return std::clamp(static_cast<int>(std::floor(kBins * std::log(r / low) / std::log(high / low))), 0, kBins - 1);
  }
};

/// Range of r/Rs over all packings; low >= high when there are no radii.
SizeRange size_range(const Measurements& data) {
  SizeRange range{1e300, 0.0};
  for (const PackingInfo& packing : data.packings) {
    for (const double r : packing.radii) {
      range.low = std::min(range.low, r / data.spec.shell_radius);
      range.high = std::max(range.high, r / data.spec.shell_radius);
    }
  }
  return range;
}

/// Number density P(r) Rs of one packing in logarithmic bins.
std::vector<double> density(const PackingInfo& packing, double shell_radius, const SizeRange& range) {
  std::vector<double> result(kBins, 0.0);
  for (const double r : packing.radii) result[static_cast<std::size_t>(range.bin(r / shell_radius))] += 1.0;
  const auto n = static_cast<double>(packing.radii.size());
  for (int k = 0; k < kBins; ++k) result[static_cast<std::size_t>(k)] /= n * (range.edge(k + 1) - range.edge(k));
  return result;
}

/// Mean over packings with its standard error; empty bins are left out of a logarithmic plot by being zero.
Series measured(const Measurements& data, const SizeRange& range) {
  std::vector<std::vector<double>> columns(kBins);
  for (const PackingInfo& packing : data.packings) {
    if (packing.radii.empty()) continue;
    const auto one = density(packing, data.spec.shell_radius, range);
    for (std::size_t k = 0; k < kBins; ++k) columns[k].push_back(one[k]);
  }
  Series s{.label = fmt::format("packed grains, mean of {} \u00b1 standard error",
                                counted(columns.front().size(), "packing")),
           .hover = "packed grains",
           .x = {},
           .y = {}};
  for (int k = 0; k < kBins; ++k) {
    const MeanError m = mean_error(columns[static_cast<std::size_t>(k)]);
    s.x.push_back(std::sqrt(range.edge(k) * range.edge(k + 1)));
    s.y.push_back(m.mean);
    s.y_error.push_back(m.error);
  }
  s.style = {.color = palette::blue, .width = 0.0, .marker = Marker::circle};
  return s;
}

/// (b-1) r^-b / (low^(1-b) - high^(1-b)), normalised over the range that is shown.
Series power_law(double b, const SizeRange& range, const std::string& label, const SeriesStyle& style) {
  Series s{.label = label, .hover = "", .x = {range.low, range.high}, .y = {}};
  const double area = std::abs(b - 1.0) < 1e-9
                          ? std::log(range.high / range.low)
                          : (std::pow(range.low, 1.0 - b) - std::pow(range.high, 1.0 - b)) / (b - 1.0);
  for (const double r : s.x) s.y.push_back(std::pow(r, -b) / area);
  s.style = style;
  s.sets_range = false;
  return s;
}

MeanError mean_exponent(const Measurements& data) {
  std::vector<double> exponents;
  for (const PackingInfo& p : data.packings) {
    if (p.exponent > 0.0) exponents.push_back(p.exponent);
  }
  return mean_error(exponents);
}

std::string packing_facts(const Measurements& data) {
  std::vector<double> grains, fraction, contacts;
  for (const PackingInfo& p : data.packings) {
    grains.push_back(static_cast<double>(p.grains));
    fraction.push_back(p.solid_fraction);
    contacts.push_back(p.contacts_per_grain);
  }
  const auto text = [](const std::vector<double>& v) {
    const MeanError m = mean_error(v);
    return format_with_error(m.mean, m.error);
  };
  return paragraph(
      fmt::format("{}; per packing (mean ± standard error): grains {}, solid fraction {}, contacts per grain "
                  "at the start {}.",
                  counted(data.packings.size(), "packing"), text(grains), text(fraction), text(contacts)));
}

constexpr const char* kPackingsLead =
    "Solid fraction of the measured packings, and how the radii of their grains are distributed.";

}  // namespace

std::string radii_section(const RunData& run) {
  if (!run.measurements || run.measurements->packings.empty()) return "";
  const Measurements& data = *run.measurements;
  const SizeRange range = size_range(data);
  if (!(range.low > 0.0 && range.low < range.high))
    return section("radii", "Packings", kPackingsLead, packing_facts(data));
  Plot plot({.id = "radii",
             .title = "Size distribution of the packed grains",
             .x = {.label = "grain radius over shell radius, r/Rs", .scale = Scale::logarithmic},
             .y = {.label = "number density P(r) Rs", .scale = Scale::logarithmic}});
  if (!data.spec.sizes)
    plot.add(power_law(data.spec.exponent, range,
                       fmt::format("drawn from P(r) ~ r^-b, b = {}", format_number(data.spec.exponent)),
                       {.color = palette::black, .width = 1.4, .dash = "6 4"}));
  const MeanError b = mean_exponent(data);
  if (b.n > 0) {
    plot.add(power_law(b.mean, range, "fitted after growth, b = " + format_with_error(b.mean, b.error),
                       {.color = palette::vermillion, .width = 1.6}));
  }
  plot.add(measured(data, range));
  const std::string caption =
      "Lines are normalised over the range of radii that is shown. b is the mean over packings of the "
      "maximum-likelihood exponent.";
  return section("radii", "Packings", kPackingsLead, packing_facts(data) + figure_row({figure(plot.svg(), caption)}));
}

namespace {

/// Passing over size of one kind of grains, in percent; empty without the curves.
std::string passing_figure(const SizesSummary& one, std::size_t number) {
  const std::size_t n = one.diameter.size();
  if (n < 2 || one.asked.size() != n || one.obtained.size() != n) return "";
  const bool metres = one.unit == "m";
  Series wanted{.label = "asked", .hover = "", .x = {}, .y = {}};
  Series found{.label = "obtained", .hover = "", .x = {}, .y = {}};
  for (std::size_t k = 0; k < n; ++k) {
    wanted.x.push_back(metres ? 1e3 * one.diameter[k] : one.diameter[k]);
    wanted.y.push_back(100.0 * one.asked[k]);
    found.y.push_back(100.0 * one.obtained[k]);
  }
  found.x = wanted.x;
  wanted.style = {.color = palette::black, .width = 1.4, .dash = "6 4"};
  found.style = {.color = palette::blue, .width = 1.6};
  Plot plot({.id = fmt::format("passing-{}", number),
             .title = "Passing: " + one.of,
             .x = {.label = metres ? "diameter [mm]" : "diameter over the largest", .scale = Scale::logarithmic},
             .y = {.label = fmt::format("passing [% of the {}]", share_of(one.dimension)), .low = 0.0, .high = 100.0}});
  plot.add(found);
  plot.add(wanted);
  return figure(
      plot.svg(),
      fmt::format("{}, by {}: {} in the mean of {}; what passes differs from what was asked by at most {} % of "
                  "the {}. One grain of the largest size is {} %: no sample comes closer than half that.",
                  one.of, one.form, format_number(one.grains), one.samples,
                  format_number(100.0 * one.largest_difference), share_of(one.dimension),
                  format_number(100.0 * one.largest_grain)));
}

}  // namespace

std::string sizes_section(const RunData& run) {
  std::vector<std::string> figures;
  for (const SizesSummary& one : run.summary_as<AnySummary>().sizes)
    if (const std::string drawn = passing_figure(one, figures.size()); !drawn.empty()) figures.push_back(drawn);
  return figures.empty()
             ? ""
             : section("sizes", "Sizes: requested and drawn",
                       "The requested distribution of sizes beside the sizes that were drawn.", figure_row(figures));
}

}  // namespace softgrain::report
