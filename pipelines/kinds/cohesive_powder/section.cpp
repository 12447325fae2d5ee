// Cohesive powders: packings with their forces, snapshots, courses, forces, scattered intensity, tables.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/statistics.h"
#include "pipelines/kinds/cohesive_powder/report_plots.h"
#include "pipelines/kinds/cohesive_powder/report_view.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/sections.h"

namespace softgrain::report {

namespace {

using nlohmann::json;

/// Width of one small picture [px], and how many of them stand in the row.
constexpr double kSnapshotWidth = 260.0;
constexpr std::size_t kSnapshots = 6;

/// A column of the table: where its value stands in the summary of a sample.
struct Column {
  std::string header;
  std::string path;
  int digits = 4;
  bool yes_no = false;  ///< a flag, shown as a word; its mean is how many say yes
};

std::optional<double> value_of(const json& sample, const Column& column) {
  if (!column.yes_no) return find_number(sample, column.path);
  const json* flag = find_value(sample, column.path);
  if (flag == nullptr || !flag->is_boolean()) return std::nullopt;
  return flag->get<bool>() ? 1.0 : 0.0;
}

std::vector<Column> contact_columns() {
  return {{"Phi", "Phi"},
          {"Phi in 3D", "solid_fraction_3d"},
          {"z", "z"},
          {"z*", "z_star"},
          {"repulsive", "repulsive"},
          {"tensile", "tensile"},
          {"unstressed", "unstressed"},
          {"distant", "distant"},
          {"rattlers", "rattlers"}};
}

std::vector<Column> force_columns() {
  return {{"<N>", "mean_normal", 3},
          {"<N> repulsive", "mean_repulsive", 3},
          {"<N> tensile", "mean_tensile", 3},
          {"sqrt <N²>", "quadratic_mean_normal", 3},
          {"share without force", "zero_share", 3},
          {"P of Rumpf", "rumpf_pressure", 3},
          {"over the imposed", "rumpf_ratio", 4},
          {"F_perc", "F_perc.either", 3}};
}

std::vector<Column> rigidity_columns() {
  return {{"h", "rigidity.fixed.h"},
          {"k", "rigidity.fixed.k"},
          {"positive definite", "rigidity.fixed.positive_definite", 0, true},
          {"h, free cell", "rigidity.free.h"},
          {"k, free cell", "rigidity.free.k"},
          {"positive definite, free cell", "rigidity.free.positive_definite", 0, true},
          {"h, backbone", "rigidity.backbone.h"},
          {"k, backbone", "rigidity.backbone.k"},
          {"positive definite, backbone", "rigidity.backbone.positive_definite", 0, true}};
}

std::vector<Column> structure_columns() {
  return {{"dF", "scattering.dF", 3},
          {"error of dF", "scattering.dF_error", 2},
          {"xi [a]", "scattering.xi", 3},
          {"error of xi", "scattering.xi_error", 2},
          {"<R>_w [a]", "holes.mean_radius", 4},
          {"largest hole [a]", "holes.largest_radius", 4},
          {"holes", "holes.count"}};
}

/// Mean of the values with the sample deviation in brackets.
std::string mean_text(const std::vector<double>& values, int digits) {
  if (values.empty()) return "–";
  const MeanError m = mean_error(values);
  if (m.n < 2) return format_number(m.mean, digits);
  return fmt::format("{} ({})", format_number(m.mean, digits), format_number(m.deviation, 2));
}

std::string cell_text(double value, const Column& column) {
  if (column.yes_no) return value > 0.0 ? "yes" : "no";
  return format_number(value, column.digits);
}

std::string summary_text(const std::vector<double>& values, const Column& column) {
  if (!column.yes_no) return mean_text(values, column.digits);
  return fmt::format("{} of {}", std::count(values.begin(), values.end(), 1.0), values.size());
}

/// A fit that is not usable must not stand in a table as if it were.
bool counts(const json& sample, const Column& column) {
  if (!column.path.starts_with("scattering.")) return true;
  const json* usable = find_value(sample, "scattering.usable");
  return usable != nullptr && usable->is_boolean() && usable->get<bool>();
}

bool is_usable(const json& sample) {
  const json* usable = find_value(sample, "usable");
  return usable != nullptr && usable->is_boolean() && usable->get<bool>();
}

/// One row per sample and one of means over usable samples; columns without any value are left out.
std::string table_of(const json& samples, std::vector<Column> columns) {
  std::erase_if(columns, [&](const Column& c) {
    return std::none_of(samples.begin(), samples.end(), [&](const json& s) { return value_of(s, c).has_value(); });
  });
  if (columns.empty()) return "";
  std::vector<std::string> header{"sample"};
  for (const Column& c : columns) header.push_back(c.header);
  HtmlTable table(header);
  std::vector<std::vector<double>> values(columns.size());
  for (std::size_t k = 0; k < samples.size(); ++k) {
    std::vector<std::string> row{fmt::format("{}{}", k, is_usable(samples[k]) ? "" : " (not at rest)")};
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const auto value = counts(samples[k], columns[c]) ? value_of(samples[k], columns[c]) : std::nullopt;
      row.push_back(value ? cell_text(*value, columns[c]) : "–");
      if (value && is_usable(samples[k])) values[c].push_back(*value);
    }
    table.row(std::move(row));
  }
  std::vector<std::string> row{"mean (deviation)"};
  for (std::size_t c = 0; c < columns.size(); ++c) row.push_back(summary_text(values[c], columns[c]));
  table.row(std::move(row));
  return table.html();
}

/// Shares x_k of disks with k interactions, as columns.
std::string shares_table(const json& samples) {
  json rows = json::array();
  std::size_t most = 0;
  for (const json& s : samples) {
    json row = json::object();
    row["usable"] = is_usable(s);
    if (const json* shares = find_value(s, "shares"); shares != nullptr && shares->is_array()) {
      most = std::max(most, shares->size());
      for (std::size_t k = 0; k < shares->size(); ++k) row[fmt::format("x{}", k)] = (*shares)[k];
    }
    rows.push_back(row);
  }
  // A sample without disks of k neighbours has the share 0, not none.
  std::vector<Column> columns;
  for (std::size_t k = 0; k < most; ++k) {
    const std::string name = fmt::format("x{}", k);
    for (json& row : rows)
      if (!row.contains(name)) row[name] = 0.0;
    columns.push_back({fmt::format("x_{}", k), name, 3});
  }
  return table_of(rows, columns);
}

std::string fit_text(const json& fit) {
  const auto number = [&](const char* key) { return find_number(fit, key).value_or(std::nan("")); };
  const json* range = find_value(fit, "k_range");
  const double last = range != nullptr && range->is_array() && range->size() == 2 && (*range)[1].is_number()
                          ? (*range)[1].get<double>()
                          : std::nan("");
  const json* usable = find_value(fit, "usable");
  if (usable == nullptr || !usable->is_boolean() || !usable->get<bool>())
    return "not to be relied on (" + find_text(fit, "reason") + ")";
  return fmt::format("up to k a = {}: dF = {}, xi = {} a, chi² per degree {}", format_number(last, 3),
                     format_with_error(number("dF"), number("dF_error")),
                     format_with_error(number("xi"), number("xi_error")), format_number(number("chi2_per_degree"), 2));
}

/// One fit to all samples, and what other ends of the fitted range make of it.
std::string common_fit(const json& summary) {
  const json* fit = find_value(summary, "scattering");
  if (fit == nullptr || !fit->is_object()) return "";
  std::string out = paragraph("One fit to all samples, " + fit_text(*fit) + ".");
  const json* others = find_value(*fit, "other_ranges");
  if (others == nullptr || !others->is_array()) return out;
  for (const json& other : *others) out += paragraph("Another end of the range: " + fit_text(other) + ".");
  return out;
}

std::string tables(const RunData& run) {
  const json* samples = find_value(run.summary, "samples");
  if (samples == nullptr || !samples->is_array() || samples->empty()) return "";
  return table_of(*samples, contact_columns()) + table_of(*samples, force_columns()) +
         paragraph(
             "Lengths in a (largest diameter), forces in F0 (adhesion; without it P a). Interactions are contacts "
             "and distant pairs; unstressed ones are below the published threshold. F_perc: largest force whose "
             "contacts "
             "still reach across the cell. Phi in 3D: the equivalent 0.752 Phi^1.5.") +
         shares_table(*samples) + paragraph("x_k: share of disks with k interactions.") +
         table_of(*samples, rigidity_columns()) +
         paragraph(
             "h: self-stresses, k: motions without force, of the rigidity matrix with fixed cell, with its two strains "
             "free, and without rattlers (where there is no cohesion). Positive definite: the springs alone hold it.") +
         table_of(*samples, structure_columns()) +
         paragraph(
             "dF, xi: fit of I(k), with its standard error; values of fits that cannot be relied on are left "
             "out. <R>_w: radii of holes, weighted by their areas.") +
         common_fit(run.summary);
}

/// At most kSnapshots of them, the first and the last among them.
std::vector<const PowderSnapshot*> chosen(const std::vector<PowderSnapshot>& all) {
  std::vector<const PowderSnapshot*> out;
  const std::size_t n = std::min(all.size(), kSnapshots);
  for (std::size_t k = 0; k < n; ++k) out.push_back(&all[n < 2 ? 0 : k * (all.size() - 1) / (n - 1)]);
  return out;
}

std::string snapshots(const PowderRun& run) {
  if (run.samples.empty()) return "";
  const auto list = chosen(run.samples.front().snapshots);
  double longest = 0.0;
  for (const auto* s : list) longest = std::max({longest, s->lengths[0], s->lengths[1]});
  if (!(longest > 0.0)) return "";
  std::string cells;
  for (std::size_t k = 0; k < list.size(); ++k) {
    const std::string title = fmt::format("{}: t = {} T0", k + 1, format_number(list[k]->time, 3));
    cells += "<div>" + snapshot_view(*list[k], (kSnapshotWidth - 4.0) / longest, kSnapshotWidth, title) + "</div>\n";
  }
  return "<figure><div class=\"strip\">\n" + cells + "</div>\n<figcaption>" +
         escape("The assembly of sample 0, all pictures to the same scale.") + "</figcaption></figure>\n";
}

std::string packings(const PowderRun& run) {
  if (run.samples.empty()) return "";
  const PowderSample& sample = run.samples.front();
  const std::string forces = packing_view(sample, PowderLines::forces, run.zero_force, "Forces, sample 0");
  const std::string stressed =
      packing_view(sample, PowderLines::stressed, run.zero_force, "Stressed and unstressed contacts, sample 0");
  if (forces.empty()) return "";
  return figure_row(
      {figure(forces, fmt::format("Lines between the centres of interacting disks, as wide as the normal force: {} a "
                                  "stand for {} F0, which one in twenty exceeds. Sample 0.",
                                  kStrongLine, format_number(strong_force(sample.contacts), 2))),
       figure(stressed,
              fmt::format("All interactions; unstressed ones have |N| below {}. Disks with none but such are grey.",
                          format_number(run.zero_force, 2)))});
}

}  // namespace

std::string powder_section(const RunData& run) {
  if (!run.powder) return "";
  const PowderRun& powder = *run.powder;
  const std::string scattering = scattering_figure(powder);
  return section("powder", "Packings", packings(powder) + snapshots(powder)) +
         section("powder-course", "Assembly", course_figures(powder)) +
         section("powder-forces", "Forces", force_figures(powder)) +
         section("powder-scattering", "Scattered intensity", scattering.empty() ? "" : figure_row({scattering})) +
         section("powder-samples", "Samples", tables(run));
}

}  // namespace softgrain::report
