// Stress and fabric tensors at the end of macro tests, and the forces of their contacts.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/core/statistics.h"
#include "common/data/columns.h"
#include "pipelines/kinds/macro/scene.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/plot_helpers.h"

namespace softgrain::report {

namespace {

using TensorAtEnd = std::array<double, 6>;
using ReadTensor = std::function<std::optional<TensorAtEnd>(const MacroCurve&)>;

/// Stress over the mean stress.
std::optional<TensorAtEnd> stress_at_end(const MacroCurve& c) {
  TensorAtEnd out{};
  const std::array columns{&c.stress_x, &c.stress_y, &c.stress_axial, &c.stress_xy, &c.stress_xz, &c.stress_yz};
  for (std::size_t k = 0; k < out.size(); ++k) {
    if (columns[k]->empty()) return std::nullopt;
    out[k] = columns[k]->back();
  }
  const double mean = (out[0] + out[1] + out[2]) / 3.0;
  if (!(mean > 0.0)) return std::nullopt;
  for (double& x : out) x /= mean;
  return out;
}

std::optional<TensorAtEnd> fabric_at_end(const TensorColumns& columns) {
  TensorAtEnd out{};
  for (std::size_t k = 0; k < out.size(); ++k) {
    if (columns[k].empty()) return std::nullopt;
    out[k] = columns[k].back();
  }
  return out[0] + out[1] + out[2] > 0.0 ? std::optional(out) : std::nullopt;
}

struct TensorRow {
  const char* name;
  ReadTensor read;
};

const std::vector<TensorRow>& tensor_rows() {
  static const std::vector<TensorRow> rows{
      {"stress over p", stress_at_end},
      {"fabric", [](const MacroCurve& c) { return fabric_at_end(c.fabric_tensor); }},
      {"fabric of strong contacts", [](const MacroCurve& c) { return fabric_at_end(c.fabric_strong); }}};
  return rows;
}

std::vector<std::vector<const MacroCurve*>> curves_by_engine(const std::vector<MacroCurve>& curves) {
  std::vector<std::vector<const MacroCurve*>> out;
  for (const MacroCurve& c : curves) {
    if (!c.usable || c.strain.empty()) continue;
    const auto found = std::ranges::find_if(out, [&](const auto& group) { return group.front()->engine == c.engine; });
    if (found == out.end())
      out.push_back({&c});
    else
      found->push_back(&c);
  }
  return out;
}

std::string tensor_table(const std::vector<MacroCurve>& curves) {
  std::vector<std::string> header{"engine", "at the end"};
  header.insert(header.end(), kTensorComponents.begin(), kTensorComponents.end());
  HtmlTable table(header, 2);
  for (const auto& group : curves_by_engine(curves))
    for (const TensorRow& row : tensor_rows()) {
      std::array<std::vector<double>, 6> values;
      for (const MacroCurve* c : group)
        if (const auto tensor = row.read(*c))
          for (std::size_t k = 0; k < values.size(); ++k) values[k].push_back((*tensor)[k]);
      if (values.front().empty()) continue;
      std::vector<std::string> cells{engine_name(*group.front()), row.name};
      for (const auto& component : values) {
        const MeanError mean = mean_error(component);
        cells.push_back(format_with_error(mean.mean, mean.n > 1 ? mean.error : 0.0));
      }
      table.row(std::move(cells));
    }
  return table.empty() ? "" : table.html();
}

double largest_at_end(const std::vector<MacroCurve>& curves, std::vector<double> MacroCurve::*column, bool whole) {
  double largest = 0.0;
  for (const MacroCurve& c : curves)
    for (std::size_t k = whole || (c.*column).empty() ? 0 : (c.*column).size() - 1; k < (c.*column).size(); ++k)
      largest = std::max(largest, (c.*column)[k]);
  return largest;
}

std::string tensor_words(const std::vector<MacroCurve>& curves) {
  std::string text = fmt::format(
      "p is the mean stress, compression positive; shear stresses are those of the contacts, whose tensor is "
      "antisymmetric by {} of its norm at most. Fabric is the mean of n n over contacts between bodies (1/3 on the "
      "diagonal: isotropic); strong contacts bear more than the mean normal force. ",
      format_number(largest_at_end(curves, &MacroCurve::stress_asymmetry, false), 2));
  const bool moved = std::ranges::any_of(curves, [](const MacroCurve& c) { return !c.inertial_number.empty(); });
  text += moved ? fmt::format(
                      "Inertial number of twins strained in motion: {} at most (d: mean by number; recorded "
                      "points are at rest). All other runs are quasi-static and have none.",
                      format_number(largest_at_end(curves, &MacroCurve::inertial_number, true), 2))
                : std::string("Inertial number: none, the test is quasi-static.");
  return paragraph(text);
}

std::string force_distribution_figure(const std::vector<MacroCurve>& curves, const std::string& id) {
  Plot plot({.id = id + "-force-distribution",
             .title = "Contact forces at the end",
             .x = {.label = "normal force over its mean f/<f>"},
             .y = {.label = "probability density", .scale = Scale::logarithmic},
             .height = 310.0});
  for (const auto& group : curves_by_engine(curves)) {
    std::optional<Histogram> all;
    for (const MacroCurve* c : group) {
      const auto one = force_distribution(c->body_forces);
      if (!one) continue;
      if (all)
        add_counts(*all, *one);
      else
        all = one;
    }
    if (!all) continue;
    Series s = outline(*all);
    for (double& y : s.y)
      if (y == 0.0) y = std::nan("");  // a gap on the logarithmic axis
    s.label = engine_name(*group.front());
    s.style = engine_style(group.front()->engine);
    s.style.marker = Marker::none;
    plot.add(std::move(s));
  }
  return plot.empty() ? ""
                      : figure(plot.svg(),
                               "Contacts between bodies and with walls, each sample over its own mean, all "
                               "samples together. Exponential above the mean in most packings.");
}

}  // namespace

std::string tensor_parts(const std::vector<MacroCurve>& curves, const std::string& id) {
  const std::string table = tensor_table(curves);
  const std::string forces = force_distribution_figure(curves, id);
  return (forces.empty() ? "" : figure_row({forces})) + (table.empty() ? "" : table + tensor_words(curves));
}

}  // namespace softgrain::report
