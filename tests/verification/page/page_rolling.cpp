// Rolling, restitution and bounces on the page.
#include <algorithm>
#include <cmath>

#include "tests/verification/cases/energy_cases.h"
#include "tests/verification/cases/restitution_cases.h"
#include "tests/verification/cases/rolling_cases.h"
#include "tests/verification/page/page.h"

namespace softgrain::verification {

namespace {

using report::Marker;
using report::Plot;
using report::Scale;
using report::Series;
namespace palette = report::palette;

struct SlidingErrors {
  double time = 0.0, speed = 0.0;
  void add(const EndOfSliding& here, const EndOfSliding& exact) {
    time = std::max(time, std::abs(here.time / exact.time - 1.0));
    speed = std::max(speed, std::abs(here.speed / exact.speed - 1.0));
  }
};

EndOfSliding spun_closed_form(double mu) { return {mu, 2.0 / 7.0, 2.0 / 7.0, 2.0 / 7.0}; }

PageFigure sliding_figure() {
  Plot plot({.id = "rolling-start",
             .title = "A ball set sliding or spinning starts to roll: error of the time",
             .x = {.label = "friction coefficient"},
             .y = {.label = "relative error of the time", .scale = Scale::logarithmic}});
  Series other = series("MFIX", line_and_points(palette::grey, Marker::diamond));
  Series linear = series("here: pushed, linear spring", line_and_points(palette::blue, Marker::hollow));
  linear.style.marker_size = 7.0;
  Series hertz = series("here: pushed, Hertz", line_and_points(palette::green, Marker::square));
  Series spun = series("here: spun, linear spring", line_and_points(palette::vermillion, Marker::triangle));
  for (const PublishedSliding& p : published_sliding()) {
    const double mu = p.closed_form.mu;
    const double exact = p.closed_form.time;
    const auto add = [&](Series& s, double time) {
      s.x.push_back(mu);
      s.y.push_back(std::abs(time / exact - 1.0));
    };
    add(other, p.other_code.time);
    add(linear, run_pushed_ball(mu, RollingLaw::linear).time);
    add(hertz, run_pushed_ball(mu, RollingLaw::hertz).time);
    add(spun, run_spun_ball(mu).time);
  }
  for (const Series& s : {other, linear, hertz, spun}) plot.add(s);
  return {"rolling_start", "Error of the time at which sliding ends over friction", plot.svg()};
}

PageFigure incline_figure() {
  Plot plot({.id = "incline",
             .title = "A ball on an incline, friction 0.2",
             .x = {.label = "angle [degrees]"},
             .y = {.label = "acceleration over g"}});
  Series centre = series("closed form: centre", line(palette::blue));
  Series surface = series("closed form: R times angular acceleration", line(palette::vermillion, "7 4"));
  for (double angle = 0.0; angle <= 80.0; angle += 0.5) {
    const InclineOutcome exact = incline_closed_form(angle);
    centre.x.push_back(angle);
    centre.y.push_back(exact.acceleration);
    surface.x.push_back(angle);
    surface.y.push_back(exact.surface);
  }
  Series here = series("here: centre", points(palette::blue));
  Series spin = series("here: R times angular acceleration", points(palette::vermillion, Marker::square));
  for (double angle = 5.0; angle <= 75.0; angle += 5.0) {
    const InclineOutcome out = run_incline(angle);
    here.x.push_back(angle);
    here.y.push_back(out.acceleration);
    spin.x.push_back(angle);
    spin.y.push_back(out.surface);
  }
  for (const Series& s : {centre, surface, here, spin}) plot.add(s);
  return {"incline", "Acceleration down an incline over its angle", plot.svg()};
}

PageRow error_row(const std::string& what, const std::string& quantity, const std::string& reference, double error,
                  const std::string& step) {
  return {what, quantity, reference, "-", error_text(error), step};
}

void incline_rows(PageSection& out) {
  double rolling = 0.0;
  double sliding = 0.0;
  for (double angle = 2.5; angle < 80.0; angle += 2.5) {
    const InclineOutcome here = run_incline(angle);
    const InclineOutcome exact = incline_closed_form(angle);
    double& largest = angle < steepest_rolling_angle() ? rolling : sliding;
    largest = std::max({largest, std::abs(here.acceleration / exact.acceleration - 1.0),
                        std::abs(here.surface / exact.surface - 1.0)});
  }
  const std::string step = "0.05 √(m/k)";
  out.rows.push_back(
      error_row("incline below tan = 3.5 µ", "acceleration of centre and surface", "5/7 g sin", rolling, step));
  out.rows.push_back(error_row("incline above it", "acceleration of centre and surface", "g (sin - µ cos), 5/2 µ g cos",
                               sliding, step));
}

}  // namespace

PageSection rolling_section() {
  PageSection out;
  out.title = "Starting to roll";
  out.text =
      R"(MFIX verification case DEM04 (scene `tests/reference/scenes/sliding_ball.toml`): a ball pushed without spin slides
until `t = 2 u0/(7 µ g)` and then rolls with `5 u0/7`. The same ball spun without speed gets `2/7` of its surface
speed after the same time. Largest errors over µ = 0.2 to 1 in nine steps; MFIX itself is off by up to 0.57 % in time
and 0.017 % in speed. On an incline the ball rolls while `tan <= (7/2) µ`.)";
  SlidingErrors linear, hertz, spun;
  for (const PublishedSliding& p : published_sliding()) {
    linear.add(run_pushed_ball(p.closed_form.mu, RollingLaw::linear), p.closed_form);
    hertz.add(run_pushed_ball(p.closed_form.mu, RollingLaw::hertz), p.closed_form);
    spun.add(run_spun_ball(p.closed_form.mu), spun_closed_form(p.closed_form.mu));
  }
  const std::string step = "0.05 √(m/k)";
  out.rows.push_back(error_row("pushed ball, linear spring", "time t µ g/u0", "2/7", linear.time, step));
  out.rows.push_back(error_row("pushed ball, linear spring", "speed v/u0", "5/7", linear.speed, step));
  out.rows.push_back(error_row("pushed ball, Hertz", "time t µ g/u0", "2/7", hertz.time, step));
  out.rows.push_back(error_row("pushed ball, Hertz", "speed v/u0", "5/7", hertz.speed, step));
  out.rows.push_back(error_row("spun ball", "time t µ g/(ω0 R)", "2/7", spun.time, step));
  out.rows.push_back(error_row("spun ball", "speed v/(ω0 R)", "2/7", spun.speed, step));
  incline_rows(out);
  out.figures = {sliding_figure(), incline_figure()};
  return out;
}

namespace {

/// Largest error over size ratios, speeds and phases of the first touch within a step.
double largest_error(NormalLaw law, double e, double steps_per_impact) {
  double largest = 0.0;
  for (const double ratio : {0.0, 1.0, 3.0, 10.0, 100.0})
    for (const double speed : {0.01, 10.0})
      for (double phase = 0.025; phase < 1.0; phase += 0.05) {
        const double here = recovered_restitution({law, e, ratio, speed, phase, steps_per_impact});
        largest = std::max(largest, std::abs(here - e));
      }
  return largest;
}

PageFigure restitution_figure() {
  Plot plot({.id = "restitution",
             .title = "Recovered restitution: largest error",
             .x = {.label = "restitution that was asked for"},
             .y = {.label = "error of the restitution", .scale = Scale::logarithmic}});
  const char* colors[] = {palette::vermillion, palette::blue};
  for (const NormalLaw law : {NormalLaw::linear, NormalLaw::hertz})
    for (const double steps : {100.0, 400.0, 1600.0}) {
      const bool hertz = law == NormalLaw::hertz;
      Series s = series((hertz ? "Hertz, " : "linear spring, ") + value_text(steps) + " steps per contact",
                        line_and_points(colors[hertz ? 1 : 0], steps < 200.0   ? Marker::hollow
                                                               : steps < 800.0 ? Marker::circle
                                                                               : Marker::triangle));
      for (double e = 0.1; e < 0.96; e += 0.1) {
        s.x.push_back(e);
        s.y.push_back(largest_error(law, e, steps));
      }
      plot.add(s);
    }
  return {"restitution", "Largest error of the recovered restitution", plot.svg()};
}

}  // namespace

PageSection restitution_section() {
  PageSection out;
  out.title = "Restitution";
  out.text =
      R"(Normal impacts with e = 0.1 to 1 against a plane and spheres of 1, 3, 10 and 100 times the radius at 0.01 and 10 m/s,
the first touch anywhere within a step: the largest error of them all. Neither size nor speed matters. Without damping
the error falls with the square of the step; with it only with the step, as the dashpot sets in at once (linear
spring) or with `h^(1/4)`. For the linear spring it vanishes where the contact lasts a whole number of steps, as it happens to at
e = 0.8 with 400.)";
  double hertz = 0.0;
  double linear = 0.0;
  for (double e = 0.1; e < 0.96; e += 0.1) {
    hertz = std::max(hertz, largest_error(NormalLaw::hertz, e, 400.0));
    linear = std::max(linear, largest_error(NormalLaw::linear, e, 400.0));
  }
  const std::string step = "1/400 of the contact time";
  out.rows.push_back(
      error_row("normal impact, Hertz and Tsuji", "restitution 0.1 to 0.9", "as asked for", hertz, step));
  out.rows.push_back(error_row("normal impact, linear spring", "restitution 0.1 to 0.9", "as asked for", linear, step));
  out.rows.push_back(
      error_row("normal impact, Hertz", "restitution 1", "1", largest_error(NormalLaw::hertz, 1.0, 400.0), step));
  out.figures = {restitution_figure()};
  return out;
}

}  // namespace softgrain::verification
