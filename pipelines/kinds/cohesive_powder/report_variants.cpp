// Variants of a cohesive powder: a table of all, and how far they are from what is published.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/core/text.h"
#include "pipelines/kinds/cohesive_powder/scene.h"
#include "pipelines/kinds/cohesive_powder/summary.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/run_data.h"
#include "pipelines/report/svg_plot.h"

namespace softgrain::report {

namespace {

/// Mean with its standard error.
std::string ours(const VariantEntry& entry, const std::string& quantity) {
  return format_with_error(entry.ours(quantity).mean, entry.ours(quantity).error);
}

/// Published value as printed: a value without an error keeps its own digits.
std::string theirs(const VariantEntry& entry, const std::string& quantity) {
  return format_with_error(entry.theirs(quantity).value, entry.theirs(quantity).error);
}

std::string difference(const VariantEntry& entry, const std::string& quantity) {
  const PublishedDifference off = entry.off(quantity);
  if (!std::isfinite(off.in_errors)) return format_number(off.value, 2);
  return fmt::format("{} ({} errors)", format_number(off.value, 2), format_fixed(off.in_errors, 1));
}

std::string status_text(const VariantEntry& entry) {
  return fmt::format("{}, {} of {}", to_string(entry.status), entry.usable_samples, entry.samples);
}

std::string comparison_table(const std::vector<VariantEntry>& entries) {
  HtmlTable table({"variant", "samples at rest", "Phi", "published", "difference", "z", "published", "difference"});
  for (const VariantEntry& e : entries)
    table.row({e.name, status_text(e), ours(e, "Phi"), theirs(e, "Phi"), difference(e, "Phi"), ours(e, "z"),
               theirs(e, "z"), difference(e, "z")});
  return table.html();
}

/// Published numbers beside Phi and z, a row each; empty without any.
std::string other_comparisons(const std::vector<VariantEntry>& entries) {
  HtmlTable table({"variant", "number", "here", "published", "difference"});
  bool any = false;
  for (const VariantEntry& e : entries)
    for (const auto& [name, number] : e.published) {
      if (name == "Phi" || name == "z") continue;
      table.row({e.name, name, ours(e, name), theirs(e, name), difference(e, name)});
      any = true;
    }
  return any ? table.html() : "";
}

/// A quantity and how its column is called.
using Quantity = std::pair<const char*, const char*>;

/// Means and standard errors, one row per variant; columns without any value are left out.
std::string quantity_table(const std::vector<VariantEntry>& entries, std::vector<Quantity> quantities) {
  std::erase_if(quantities, [&](const Quantity& q) {
    return std::ranges::none_of(entries, [&](const VariantEntry& e) { return e.values.contains(q.first); });
  });
  if (quantities.empty()) return "";
  std::vector<std::string> header{"variant"};
  for (const Quantity& q : quantities) header.emplace_back(q.second);
  HtmlTable table(header);
  for (const VariantEntry& e : entries) {
    std::vector<std::string> row{e.name};
    for (const Quantity& q : quantities) row.push_back(ours(e, q.first));
    table.row(std::move(row));
  }
  return table.html();
}

std::string tables(const std::vector<VariantEntry>& entries) {
  return comparison_table(entries) +
         paragraph(
             "Mean over samples ± standard error; the difference to the published value also in combined standard "
             "errors where both are known.") +
         other_comparisons(entries) +
         quantity_table(entries, {{"z_star", "z*"},
                                  {"x_0", "x_0"},
                                  {"x_1", "x_1"},
                                  {"x_2", "x_2"},
                                  {"x_3", "x_3"},
                                  {"zero_share", "share without force"},
                                  {"solid_fraction_3d", "Phi in 3D"}}) +
         quantity_table(entries, {{"mean_normal", "<N>"},
                                  {"mean_repulsive", "<N> repulsive"},
                                  {"mean_tensile", "<N> tensile"},
                                  {"rumpf_ratio", "P of Rumpf over P"},
                                  {"F_perc", "F_perc"}}) +
         quantity_table(entries, {{"h", "h"},
                                  {"k", "k"},
                                  {"h_backbone", "h, backbone"},
                                  {"k_backbone", "k, backbone"},
                                  {"dF", "dF"},
                                  {"xi", "xi [a]"},
                                  {"R_w", "<R>_w [a]"},
                                  {"loop_passes", "loop passes"},
                                  {"seconds", "seconds per sample"}});
}

struct Extent {
  double low = 1e300;
  double high = -1e300;
  void add(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
};

/// Where ours and theirs would be equal.
Series diagonal(const Extent& e) {
  const double margin = 0.05 * (e.high - e.low) + 1e-3 * std::abs(e.high);
  Series s{.label = "equal", .hover = "", .x = {e.low - margin, e.high + margin}, .y = {}};
  s.y = s.x;
  s.style = {.color = palette::grey, .width = 1.0, .dash = "5 4"};
  return s;
}

/// Another marker where the colours begin again.
SeriesStyle point_style(std::size_t index) {
  constexpr std::array kMarkers{Marker::circle, Marker::square, Marker::triangle, Marker::diamond};
  constexpr std::size_t kColours = 7;
  return {.color = palette::cycle(index),
          .width = 0.0,
          .marker = kMarkers[index / kColours % kMarkers.size()],
          .marker_size = 4.0};
}

std::string comparison_figure(const std::vector<VariantEntry>& entries, const std::string& quantity) {
  Plot plot({.id = "powder-published-" + quantity,
             .title = quantity + ", here and published",
             .x = {.label = quantity + ", published"},
             .y = {.label = quantity + ", here"}});
  Extent extent;
  std::vector<Series> points;
  for (const VariantEntry& e : entries) {
    const double published = e.theirs(quantity).value;
    const double here = e.ours(quantity).mean;
    if (!std::isfinite(published) || !std::isfinite(here)) continue;
    extent.add(published);
    extent.add(here);
    Series s{.label = e.name, .hover = "", .x = {published}, .y = {here}};
    const double error = e.ours(quantity).error;
    if (std::isfinite(error)) s.y_error = {error};
    s.style = point_style(points.size());
    points.push_back(std::move(s));
  }
  if (points.empty()) return "";
  plot.add(diagonal(extent));
  for (Series& s : points) plot.add(std::move(s));
  return figure(plot.svg(), "Mean over samples with its standard error; dashed: no difference.");
}

std::string links(const std::vector<VariantEntry>& entries) {
  std::string names;
  for (const VariantEntry& e : entries)
    if (e.status != RunStatus::not_run) append_part(names, e.name, ", ");
  if (names.empty()) return "";
  return paragraph("Each variant has a directory of its own with all its data: " + names +
                   "; softgrain report on that directory shows its packings.");
}

}  // namespace

std::string powder_variants_section(const RunData& run) {
  const auto summary = run.summary_as<PowderVariantsSummary>();
  if (run.kind() != "cohesive-powder" || summary.variants.empty()) return "";
  const std::vector<VariantEntry>& entries = summary.variants;
  std::vector<std::string> figures;
  for (const char* quantity : {"Phi", "z"})
    if (std::string drawn = comparison_figure(entries, quantity); !drawn.empty()) figures.push_back(std::move(drawn));
  return section("powder-variants", "Variants", "Each variant beside the published values.",
                 tables(entries) + (figures.empty() ? "" : figure_row(figures)) + links(entries));
}

}  // namespace softgrain::report
