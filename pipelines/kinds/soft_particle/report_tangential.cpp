// Tangential force against tangential displacement, along it and across it, at a few overlaps; tangential stiffness
// against overlap: initial slope and secant, measured and fitted, in N/m and N per degree.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <set>

#include "common/core/statistics.h"
#include "pipelines/kinds/soft_particle/scene.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/plot_helpers.h"
#include "pipelines/report/run_data.h"

namespace softgrain::report {

namespace {

constexpr std::size_t kCurves = 4;

/// Selects at most kCurves overlaps, spread over those where a rotation meets a force, the largest included.
std::vector<long long> chosen_overlaps(const std::vector<const PackingRun*>& runs) {
  std::set<long long> all;
  for (const PackingRun* run : runs) {
    for (const TangentialPoint& p : run->tangential) {
      if (p.converged && p.angle_deg != 0.0 && p.force_parallel != 0.0) all.insert(delta_key(p.delta));
    }
  }
  const std::vector<long long> sorted(all.begin(), all.end());
  if (sorted.size() <= kCurves) return sorted;
  std::vector<long long> result;
  for (std::size_t k = 1; k <= kCurves; ++k) result.push_back(sorted[k * sorted.size() / kCurves - 1]);
  return result;
}

/// Mean over packings against ht [mm], of points that converged, as the fit takes them.
Series mean_curve(const std::vector<const PackingRun*>& runs, long long overlap, double mm_per_degree,
                  double TangentialPoint::*force) {
  std::map<long long, std::vector<double>> columns;  // by angle in 1e-6 degree
  for (const PackingRun* run : runs) {
    for (const TangentialPoint& p : run->tangential) {
      if (p.converged && delta_key(p.delta) == overlap) columns[delta_key(p.angle_deg)].push_back(p.*force);
    }
  }
  Series s{.label = "Δ = " + format_number(key_delta(overlap)), .hover = "", .x = {}, .y = {}};
  for (const auto& [angle, values] : columns) {
    const MeanError m = mean_error(values);
    s.x.push_back(key_delta(angle) * mm_per_degree);
    s.y.push_back(m.mean);
    s.y_error.push_back(m.error);
  }
  return s;
}

std::string force_figure(const RunData& run, PairKind kind, bool parallel) {
  const SoftParticleSpec& spec = run.measurements->spec;
  const auto runs = runs_of(*run.measurements, kind, run.relaxation(kind));
  const double mm_per_degree = 1e3 * std::numbers::pi * spec.shell_radius / 180.0;
  Plot plot({.id = "tangential-" + to_string(kind) + (parallel ? "-parallel" : "-perpendicular"),
             .title = std::string("Ft(ht) ") + (parallel ? "along" : "across") + " the displacement, " + describe(kind),
             .x = {.label = fmt::format("tangential displacement ht [mm]   (1° of rotation = {} mm)",
                                        format_number(mm_per_degree, 3))},
             .y = {.label = std::string(parallel ? "parallel" : "perpendicular") + " force [N]"}});
  static constexpr Marker markers[] = {Marker::circle, Marker::square, Marker::triangle, Marker::diamond};
  std::size_t index = 0;
  for (const long long overlap : chosen_overlaps(runs)) {
    Series s = mean_curve(runs, overlap, mm_per_degree,
                          parallel ? &TangentialPoint::force_parallel : &TangentialPoint::force_perpendicular);
    s.style = {.color = palette::cycle(index), .width = 1.4, .marker = markers[index % 4], .marker_size = 3.0};
    plot.add(std::move(s));
    ++index;
  }
  return figure(plot.svg(), parallel ? "Mean over packings ± standard error. The value at ht = 0 (prestrain) comes "
                                       "from the inhomogeneity of single packings."
                                     : "Across the displacement the mean should vanish within its error.");
}

}  // namespace

std::string tangential_section(const RunData& run) {
  if (!run.measurements) return "";
  std::string body;
  for (const PairKind kind : kPairKinds) {
    const std::string relaxation = run.relaxation(kind);
    if (relaxation.empty() || chosen_overlaps(runs_of(*run.measurements, kind, relaxation)).empty()) continue;
    body += "<h3>" + escape(describe(kind) + ", relaxation \"" + relaxation + "\"") + "</h3>\n" +
            figure_row({force_figure(run, kind, true), force_figure(run, kind, false)});
  }
  std::string turns = run.measurements->shell_turns ? "The first shell turned together with its grains"
                                                    : "The first shell did not turn with its grains";
  turns += run.measurements->turn == TurnProtocol::slow
               ? fmt::format(", slowly, its rim at {} m/s, while they moved on.",
                             format_number(run.measurements->turn_speed, 3))
               : ", all at once, nothing relaxing on the way (frozen turn): beyond 0.05° the force is too small.";
  return body.empty()
             ? ""
             : section("tangential", "Tangential force",
                       "Tangential force against the angle of rotation, at each overlap.", body + paragraph(turns));
}

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
