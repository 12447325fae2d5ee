// Chains of beads on the page.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/verification/cases/chain_cases.h"
#include "tests/verification/page/page.h"

namespace softgrain::verification {

namespace {

using report::Marker;
using report::Plot;
using report::Scale;
using report::Series;
namespace palette = report::palette;

PageFigure speeds_figure() {
  Plot plot({.id = "solitary-speed",
             .title = "Solitary wave in a chain of steel beads",
             .x = {.label = "largest speed of a bead [m/s]", .scale = Scale::logarithmic},
             .y = {.label = "speed of the wave [m/s]", .scale = Scale::logarithmic}});
  Series here = series("here", points(palette::blue));
  Series discrete = series("travelling wave of the discrete chain", line(palette::green));
  Series longer = series("long-wave theory (0.8 % above)", line(palette::vermillion, "6 4"));
  for (const double v : {0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0}) {
    const SolitaryWave w = run_solitary(v);
    here.x.push_back(w.amplitude);
    here.y.push_back(w.speed);
    discrete.y.push_back(discrete_wave_speed(w.amplitude));
    longer.y.push_back(long_wave_speed(w.amplitude));
  }
  discrete.x = longer.x = here.x;
  for (const Series& s : {longer, discrete, here}) plot.add(s);
  return {"solitary_speed", "Speed of the solitary wave over its amplitude", plot.svg()};
}

PageFigure shape_figure() {
  Plot plot({.id = "solitary-shape",
             .title = "Shape of the solitary wave",
             .x = {.label = "distance from the crest [beads]"},
             .y = {.label = "speed of a bead over its largest"}});
  const PulseShape shape = pulse_shape();
  Series discrete = series("travelling wave of the discrete chain", line(palette::green), shape.x, shape.discrete);
  Series longer = series("long-wave theory", line(palette::vermillion, "6 4"));
  for (double x = -3.9; x < 3.95; x += 0.05) {
    const double phase = std::sqrt(10.0) / 5.0 * x;
    longer.x.push_back(x);
    longer.y.push_back(std::abs(phase) < 0.5 * std::numbers::pi ? std::pow(std::cos(phase), 4) : 0.0);
  }
  Series here = series("here", points(palette::blue));
  for (std::size_t k = 0; k < shape.x.size(); k += 12) {
    here.x.push_back(shape.x[k]);
    here.y.push_back(shape.here[k]);
  }
  for (const Series& s : {longer, discrete, here}) plot.add(s);
  return {"solitary_shape", "Speed of a bead as the wave passes", plot.svg()};
}

PageFigure sound_figure() {
  Plot plot({.id = "sound",
             .title = "Sound in a compressed ring of 40 beads",
             .x = {.label = "wave number times spacing"},
             .y = {.label = "angular frequency [1/s]"}});
  Series here = series("here", points(palette::blue));
  Series exact = series("2 √(k/m) sin(q a/2)", line(palette::green));
  Series longest = series("long waves, a √(k/m)", line(palette::vermillion, "6 4"));
  longest.sets_range = false;
  for (int mode = 1; mode <= kRingBeads / 2; ++mode) {
    const SoundMode s = run_sound(mode);
    const double q = 2.0 * std::numbers::pi * mode / kRingBeads;
    here.x.push_back(q);
    here.y.push_back(s.frequency);
    exact.y.push_back(s.closed_form);
    longest.y.push_back(s.closed_form / (2.0 * std::sin(0.5 * q)) * q);
  }
  exact.x = longest.x = here.x;
  for (const Series& s : {longest, exact, here}) plot.add(s);
  return {"sound", "Frequency over wave number", plot.svg()};
}

PageFigure tapered_figure() {
  Plot plot({.id = "tapered",
             .title = "Chain of ever smaller beads with gaps: final speeds",
             .x = {.label = "bead"},
             .y = {.label = "speed over that of the first", .scale = Scale::logarithmic}});
  const char* colors[] = {palette::blue, palette::vermillion};
  for (const double e : {1.0, 0.9}) {
    const TaperedChain chain{0.8, e, 8};
    std::vector<double> bead;
    for (std::size_t i = 1; i <= chain.beads; ++i) bead.push_back(static_cast<double>(i));
    const char* color = colors[e < 1.0 ? 1 : 0];
    const std::string name = "e = " + value_text(e);
    plot.add(series("closed form, " + name, line(color, e < 1.0 ? "6 4" : ""), bead, tapered_closed_form(chain)));
    plot.add(
        series("here, " + name, points(color, e < 1.0 ? Marker::square : Marker::circle), bead, run_tapered(chain)));
  }
  return {"tapered_chain", "Final speeds of a chain of ever smaller beads", plot.svg()};
}

double cradle_error() {
  double largest = 0.0;
  for (std::size_t strikers = 1; strikers < kCradleBeads; ++strikers) {
    const auto speeds = run_cradle(strikers);
    for (std::size_t i = 0; i < kCradleBeads; ++i)
      largest = std::max(largest, std::abs(speeds[i] - (i + strikers < kCradleBeads ? 0.0 : 1.0)));
  }
  return largest;
}

void momentum_rows(PageSection& out) {
  out.rows.push_back({"Newton's cradle, 5 beads, 1 to 4 strike", "final speeds over that of the strikers", "0 or 1",
                      "-", error_text(cradle_error()), "1/200 of the contact time"});
  for (const double e : {1.0, 0.9}) {
    const TaperedChain chain{0.8, e, 6};
    out.rows.push_back(row("chain of 6 ever smaller beads, e = " + value_text(e), "speed of the last over the first",
                           tapered_closed_form(chain).back(), run_tapered(chain).back(),
                           "1/200 of the shortest contact"));
  }
}

}  // namespace

PageSection chain_section() {
  PageSection out;
  out.title = "Chains of beads";
  out.text =
      R"(*Single impacts.* With gaps between the beads each impact is over before the next: a cradle sends as many as come; in
a chain of ever smaller beads (radius times 0.8 each) `v(i+1) = (1 + e) m(i)/(m(i) + m(i+1)) v(i)`.

*Solitary wave.* Eighty touching beads, the first one moving. Nesterenko's long-wave theory gives `V = (16/25)^(1/5)
c0^(4/5) v_m^(1/5)` with `c0² = 2E/(π ρ (1 - ν²))`. The wave is only five beads long, so the reference is the chain
itself: its travelling wave solves `m c² r = K (tent * r^(3/2))` (English and Pego 2005), which is iterated on a grid
and gives `V^5 = 0.615407 c0^4 v_m` instead of `16/25`; long-wave theory is 0.78 % above that.

*Sound.* Forty beads in a periodic cell, pressed to an overlap of 1e-3 R; small standing waves. What is left of the
error is the phase of velocity Verlet, `(ω dt)²/24` with 400 steps a period; without it the frequencies agree to 3e-8.)";
  momentum_rows(out);
  const SolitaryWave w = run_solitary(1.0);
  const std::string step = "1/400 of the contact time";
  out.rows.push_back(row("solitary wave, struck at 1 m/s", "speed [m/s], discrete chain",
                         discrete_wave_speed(w.amplitude), w.speed, step));
  out.rows.push_back(row("solitary wave, struck at 1 m/s", "speed [m/s], long-wave theory",
                         long_wave_speed(w.amplitude), w.speed, step));
  for (const int mode : {1, 10, 20}) {
    const SoundMode s = run_sound(mode);
    out.rows.push_back(row("sound, mode " + std::to_string(mode) + " of 40 beads", "frequency [1/s]", s.closed_form,
                           s.frequency, "1/400 of the period"));
  }
  const SoundMode longest = run_sound(1);
  out.rows.push_back(row("sound, mode 1 of 40 beads", "speed [m/s], 2R √(k/m) of long waves", longest.long_wave,
                         longest.wave_speed, "1/400 of the period"));
  out.figures = {tapered_figure(), speeds_figure(), shape_figure(), sound_figure()};
  return out;
}

}  // namespace softgrain::verification
