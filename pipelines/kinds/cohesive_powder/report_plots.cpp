#include "pipelines/kinds/cohesive_powder/report_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/plot_helpers.h"

namespace softgrain::report {

namespace {

/// A curve keeps at most this many points: no more can be seen.
constexpr std::size_t kCurvePoints = 600;
constexpr int kBins = 48;

using MomentValue = double (*)(const PowderPoint&);

Series course_series(const PowderSample& sample, std::size_t number, std::size_t samples, MomentValue value) {
  Series s{.label = samples > 1 && samples <= 8 ? fmt::format("sample {}", number) : "",
           .hover = fmt::format("sample {}", number),
           .x = {},
           .y = {}};
  const std::size_t last = sample.course.size() - 1;
  const std::size_t stride = last / kCurvePoints + 1;
  for (std::size_t k = 0; k <= last; k += stride) {
    s.x.push_back(sample.course[k].time);
    s.y.push_back(value(sample.course[k]));
  }
  if (last % stride != 0) s.x.push_back(sample.course[last].time), s.y.push_back(value(sample.course[last]));
  s.style = {.color = palette::cycle(number), .width = 1.4};
  return s;
}

std::string course_figure(const PowderRun& run, const PlotOptions& options, MomentValue value,
                          const std::string& caption) {
  Plot plot(options);
  for (std::size_t k = 0; k < run.samples.size(); ++k)
    if (run.samples[k].course.size() > 1) plot.add(course_series(run.samples[k], k, run.samples.size(), value));
  return plot.empty() ? "" : figure(plot.svg(), caption);
}

/// A vertical line over the whole height of a plot of densities.
Series mark(double x, double top, double bottom, const std::string& label) {
  return {.label = label,
          .hover = label,
          .x = {x, x},
          .y = {bottom, top},
          .style = {.color = palette::vermillion, .width = 1.3, .dash = "5 3"}};
}

double top_of(const Series& s) { return s.y.empty() ? 0.0 : *std::max_element(s.y.begin(), s.y.end()); }

std::string normal_figure(const PowderRun& run, const PowderForces& forces) {
  const auto [low, high] = std::minmax_element(forces.normal.begin(), forces.normal.end());
  const double end = std::max(*high, *low + 1e-6);
  Series s = histogram(forces.normal, *low, end + 1e-9 * (end - *low), kBins);
  s.style = {.color = palette::blue, .width = 1.6};
  for (double& y : s.y)
    if (y == 0.0) y = std::nan("");  // a gap on the logarithmic axis
  Plot plot({.id = "powder-normal",
             .title = "Normal forces",
             .x = {.label = run.cohesive ? "N/F0" : "N/(P a)"},
             .y = {.label = "probability density", .scale = Scale::logarithmic}});
  plot.add(std::move(s));
  return figure(plot.svg(), fmt::format("{} interactions of all samples with |N| of at least {}.",
                                        format_count(static_cast<std::int64_t>(forces.normal.size())),
                                        format_number(kPowderZeroForce, 2)));
}

std::string ratio_figure(const PowderForces& forces) {
  constexpr double reach = 4.0;
  Series s = histogram(forces.ratio, -reach, reach, kBins);
  s.style = {.color = palette::blue, .width = 1.6};
  const double top = 1.05 * top_of(s);
  Plot plot({.id = "powder-ratio",
             .title = "Tangential over normal force",
             .x = {.label = "T/N", .low = -reach, .high = reach},
             .y = {.label = "probability density", .low = 0.0}});
  plot.add(std::move(s));
  plot.add(mark(-std::numbers::sqrt3, top, 0.0, ""));
  plot.add(mark(std::numbers::sqrt3, top, 0.0, "|T/N| = sqrt 3: an equal disk held by two touching ones"));
  const auto outside =
      std::count_if(forces.ratio.begin(), forces.ratio.end(), [](double r) { return !(std::abs(r) < reach); });
  return figure(plot.svg(), fmt::format("Contacts alone; {} of {} lie outside the plot.", format_count(outside),
                                        format_count(static_cast<std::int64_t>(forces.ratio.size()))));
}

std::string angle_figure(const PowderForces& forces) {
  Series s = histogram(forces.angle, 0.0, 180.0 + 1e-9, 36);
  s.style = {.color = palette::blue, .width = 1.6};
  Plot plot({.id = "powder-angle",
             .title = "Angle of the force",
             .x = {.label = "angle between n and the total force [degree]", .low = 0.0, .high = 180.0},
             .y = {.label = "probability density [1/degree]", .low = 0.0}});
  plot.add(std::move(s));
  return figure(plot.svg(), "0: pressed along the normal, 180: pulled along it, 90: tangential. Contacts alone.");
}

Series fit_line(const FittedCurve& fitted) {
  const std::string label = fitted.fit.usable
                                ? fmt::format("fit: dF = {}, xi = {} a", format_number(fitted.fit.model.dimension, 3),
                                              format_number(fitted.fit.model.length, 3))
                                : "fit, not to be relied on";
  Series s{.label = label, .hover = "", .x = {}, .y = {}};
  for (int n = 0; n <= 160; ++n) {
    const double k = fitted.fit.k_low * std::pow(fitted.fit.k_high / fitted.fit.k_low, n / 160.0);
    s.x.push_back(k);
    s.y.push_back(scattering_intensity(fitted.fit.model, k));
  }
  s.style = {.color = palette::vermillion, .width = 2.2, .dash = fitted.fit.usable ? "" : "5 3"};
  return s;
}

/// The curve to show with its fit: the mean, else that of the first sample that has one.
const FittedCurve* main_curve(const PowderRun& run) {
  if (run.scattering) return &*run.scattering;
  for (const PowderSample& s : run.samples)
    if (s.scattering) return &*s.scattering;
  return nullptr;
}

}  // namespace

Series histogram(const std::vector<double>& values, double low, double high, int bins) {
  Histogram counted(low, high, static_cast<std::size_t>(bins));
  for (const double v : values) counted.add(v);
  return outline(counted);
}

PowderForces powder_forces(const PowderRun& run) {
  PowderForces out;
  for (const PowderSample& sample : run.samples)
    for (const auto& c : sample.contacts) {
      if (std::abs(c.normal_force) < kPowderZeroForce) continue;
      out.normal.push_back(c.normal_force);
      if (c.overlap <= 0.0) continue;
      const double tangential = c.tangential_force[1] * c.normal[0] - c.tangential_force[0] * c.normal[1];
      out.ratio.push_back(tangential / c.normal_force);
      out.angle.push_back(std::atan2(std::abs(tangential), c.normal_force) * 180.0 / std::numbers::pi);
    }
  return out;
}

std::string course_figures(const PowderRun& run) {
  const AxisOptions time{.label = "time [T0]"};
  const std::string fraction = course_figure(
      run, {.id = "powder-phi", .title = "Solid fraction", .x = time, .y = {.label = "Phi"}},
      [](const PowderPoint& m) { return m.fraction; }, "Area of the disks over that of the cell.");
  if (fraction.empty()) return "";
  return figure_row(
      {fraction,
       course_figure(
           run, {.id = "powder-z", .title = "Coordination number", .x = time, .y = {.label = "z", .low = 0.0}},
           [](const PowderPoint& m) { return m.coordination; }, "Interactions per disk, distant pairs included."),
       course_figure(
           run,
           {.id = "powder-kinetic",
            .title = "Kinetic energy",
            .x = time,
            .y = {.label = "kinetic energy per disk [F0 a]", .scale = Scale::logarithmic}},
           [](const PowderPoint& m) { return m.kinetic; }, "Relative to the moving cell.")});
}

std::string force_figures(const PowderRun& run) {
  const PowderForces forces = powder_forces(run);
  if (forces.ratio.empty()) return "";
  return figure_row({normal_figure(run, forces), ratio_figure(forces), angle_figure(forces)});
}

std::string scattering_figure(const PowderRun& run) {
  const FittedCurve* main = main_curve(run);
  if (main == nullptr || main->curve.k.empty()) return "";
  Plot plot({.id = "powder-scattering",
             .title = "Scattered intensity",
             .x = {.label = "k a", .scale = Scale::logarithmic},
             .y = {.label = "I(k) [a²]", .scale = Scale::logarithmic}});
  bool first = true;
  for (const PowderSample& s : run.samples) {
    if (!s.scattering || run.samples.size() < 2) continue;
    plot.add({.label = first ? "samples" : "",
              .hover = "sample",
              .x = s.scattering->curve.k,
              .y = s.scattering->curve.intensity,
              .style = {.color = palette::grey, .width = 0.8, .opacity = 0.6}});
    first = false;
  }
  plot.add(
      {.label = "mean over directions" + std::string(run.scattering && run.samples.size() > 1 ? " and samples" : ""),
       .hover = "I(k)",
       .x = main->curve.k,
       .y = main->curve.intensity,
       .style = {.color = palette::blue, .width = 0.0, .marker = Marker::circle, .marker_size = 2.2}});
  if (main->fit.k_high > main->fit.k_low && main->fit.k_low > 0.0) plot.add(fit_line(*main));
  return figure(
      plot.svg(),
      main->fit.k_high > 0.0
          ? fmt::format("Fitted for k a from {} to {}: beyond that the disks' own form factor bends the curve.",
                        format_number(main->fit.k_low, 3), format_number(main->fit.k_high, 3))
          : std::string("Too few wave numbers for a fit: the cell is small."));
}

}  // namespace softgrain::report
