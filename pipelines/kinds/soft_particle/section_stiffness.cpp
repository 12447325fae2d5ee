// Tangential stiffness against overlap: initial slope and secant, measured and fitted, in N/m and N per degree.
#include <fmt/format.h>

#include "pipelines/kinds/soft_particle/results.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/plot_helpers.h"
#include "pipelines/report/run_data.h"

namespace softgrain::report {
namespace {

std::string stiffness_figure(const RunData& run, PairKind kind, bool initial) {
  const Measurements& data = *run.measurements;
  const double radius = data.spec.shell_radius;
  const StiffnessAngles angles = run.angles(kind);
  const auto runs = runs_of(data, kind, run.relaxation(kind));
  const auto values = initial ? initial_stiffness(runs, angles, radius) : secant_stiffness(runs, angles, radius);
  if (values.empty()) return "";
  const double per_metre = per_degree_to_per_metre(radius);
  const LawPart part = initial ? LawPart::tangential_initial : LawPart::tangential_secant;
  const std::string what = initial ? fmt::format("initial slope (up to {}°)", angles.initial_deg)
                                   : fmt::format("secant at {}°", angles.secant_deg);
  PlotOptions options{.id = "stiffness-" + to_string(kind) + (initial ? "-initial" : "-secant"),
                      .title = "kt(Δ), " + what + ", " + to_string(kind),
                      .x = {},
                      .y = {.label = "tangential stiffness kt [N/m]"},
                      .right = RightAxis{"kt [N/degree]", 1.0 / per_metre}};
  options.x = overlap_axis(last_delta(values));
  options.shaded = fitted_range(run.law(kind), part);
  Plot plot(std::move(options));
  for (Series& s : packing_series(data, values, 1.0, fmt::format("one packing ({})", runs.size())))
    plot.add(std::move(s));
  if (const PairLaw* law = run.law(kind)) {
    add_law(plot, *law, part, data.spec.youngs_modulus * radius, "fitted law", palette::blue);
  }
  plot.add(mean_series(values, 1.0, "mean ± standard error",
                       {.color = palette::black, .width = 0.0, .marker = Marker::circle, .marker_size = 3.2}));
  return figure(plot.svg(),
                initial ? "Slope of the parallel force at ht = 0. The right axis gives the same per degree of rotation."
                        : "Half the difference between both signs of the rotation, over the displacement. The right "
                          "axis gives the same per degree of rotation.");
}

}  // namespace

std::string stiffness_section(const RunData& run) {
  if (!run.measurements) return "";
  std::string body;
  for (const PairKind kind : kPairKinds) {
    if (run.relaxation(kind).empty()) continue;
    body += figure_row({stiffness_figure(run, kind, true), stiffness_figure(run, kind, false)});
  }
  return section("stiffness", "Tangential stiffness",
                 "Tangential stiffness against overlap, measured and, where there is a law, fitted.", body);
}

}  // namespace softgrain::report
