// Lattices and energy on the page.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "tests/verification/cases/energy_cases.h"
#include "tests/verification/cases/lattice_cases.h"
#include "tests/verification/page/page.h"

namespace softgrain::verification {

namespace {

using report::Marker;
using report::Plot;
using report::Scale;
using report::Series;
namespace palette = report::palette;

constexpr Lattice kDrawn[] = {Lattice::simple_cubic, Lattice::body_centred, Lattice::face_centred};
constexpr const char* kColors[] = {palette::blue, palette::green, palette::vermillion};
constexpr Marker kMarkers[] = {Marker::circle, Marker::square, Marker::triangle};

PageFigure pressure_figure() {
  Plot plot({.id = "lattice-pressure",
             .title = "Cubic lattices pressed from all sides",
             .x = {.label = "overlap over radius", .scale = Scale::logarithmic},
             .y = {.label = "pressure [Pa]", .scale = Scale::logarithmic}});
  for (std::size_t k = 0; k < std::size(kDrawn); ++k) {
    Series exact = series(name_of(kDrawn[k]) + ", closed form", line(kColors[k]));
    Series here = series(name_of(kDrawn[k]) + ", here", points(kColors[k], kMarkers[k]));
    for (double overlap = 1e-5; overlap < 0.06; overlap *= 2.5) {
      const LatticeState state{kDrawn[k], overlap, false};
      exact.x.push_back(overlap);
      exact.y.push_back(moduli_closed_form(state).pressure);
      here.y.push_back(-run_stretched(state, {})[0][0]);
    }
    here.x = exact.x;
    plot.add(exact);
    plot.add(here);
  }
  return {"lattice_pressure", "Pressure of cubic lattices over overlap", plot.svg()};
}

PageFigure moduli_figure() {
  Plot plot({.id = "lattice-moduli",
             .title = "Elastic constants of the face-centred cubic lattice",
             .x = {.label = "pressure [Pa]", .scale = Scale::logarithmic},
             .y = {.label = "modulus [Pa]", .scale = Scale::logarithmic}});
  struct Curve {
    std::string name;
    bool friction;
    double Moduli::*value;
  };
  const std::vector<Curve> curves{{"c11", false, &Moduli::c11},
                                  {"c44 with tangential springs", true, &Moduli::c44},
                                  {"c12", false, &Moduli::c12},
                                  {"c44", false, &Moduli::c44}};
  const Marker markers[] = {Marker::circle, Marker::diamond, Marker::square, Marker::hollow};
  for (std::size_t c = 0; c < curves.size(); ++c) {
    Series exact = series(curves[c].name + ", closed form", line(palette::cycle(c + 1), c == 2 ? "7 4" : ""));
    Series here = series(curves[c].name + ", here", points(palette::cycle(c + 1), markers[c]));
    for (double overlap = 1e-5; overlap < 0.06; overlap *= 4.0) {
      const LatticeState state{Lattice::face_centred, overlap, curves[c].friction};
      const Moduli closed = moduli_closed_form(state);
      exact.x.push_back(closed.pressure);
      exact.y.push_back(closed.*curves[c].value);
      here.y.push_back(run_moduli(state).*curves[c].value);
    }
    here.x = exact.x;
    plot.add(exact);
    plot.add(here);
  }
  return {"lattice_moduli", "Elastic constants over pressure", plot.svg()};
}

void lattice_rows(PageSection& out, Lattice lattice) {
  const std::string name = name_of(lattice);
  const LatticeState state{lattice, 1e-3, false};
  const Moduli here = run_moduli(state);
  const Moduli exact = moduli_closed_form(state);
  const std::string still = "at rest";
  out.rows.push_back(row(name, "pressure [Pa]", exact.pressure, here.pressure, still));
  out.rows.push_back(row(name, "c11 [Pa]", exact.c11, here.c11, still));
  out.rows.push_back(row(name, "c12 [Pa]", exact.c12, here.c12, still));
  out.rows.push_back(row(name, "c44 [Pa]", exact.c44, here.c44, "20 steps of shear"));
  const LatticeState springs{lattice, 1e-3, true};
  out.rows.push_back(row(name + ", tangential springs", "c44 [Pa]", moduli_closed_form(springs).c44,
                         run_shear_modulus(springs), "20 steps of shear"));
}

}  // namespace

PageSection lattice_section() {
  PageSection out;
  out.title = "Lattices under strain";
  out.text =
      R"(Simple cubic (27 grains), body-centred (16) and face-centred cubic (32) lattices of equal glass spheres in a
periodic cell, pressed to an overlap of 1e-3 R. `c11` and `c12` are central differences of the stress in the summary
between lattices stretched along x, given by their positions; `c44` is a run with `[cell] shear_rate` in which grains
turn at half the rate, so that tangential springs (Mindlin, never sliding) take part. The face-centred lattice comes a
second time with x and y along [110] and [1-10] (36 grains), where this shear measures `(c11 - c12)/2` of the cube: with
the bulk modulus, to which springs add nothing, that makes all three constants with springs.

Closed forms with `k = (3/2) K √h`, `kt`, `f` of a contact, `l = 2R - h`, volume V per grain and sums over bonds
`S1 = Σ nx²`, `S4 = Σ nx⁴`, `S22 = Σ nx² ny²`:

    c11 = [k l² S4 + f l (S4 - S1)]/V
    c12 = [k l² S22 + f l (S22 + S1)]/V
    c44 = [k l² S22 + kt l² (S1/2 - S22) + f l (S22 - S1)]/V

Without the terms of prestress (those with f) the face-centred lattice with springs is that of Duffy and Mindlin (1957),
`c11 = 2 c44 = (4 - 3ν)/(2 - ν) X`, `c12 = ν/(2 (2 - ν)) X`, `X = [3 G² p/(2 (1 - ν)²)]^(1/3)`, which a test holds it to.
Simple cubic without springs resists no shear, and its prestress makes `c44 = -p`. What is left of the errors is the
finite strain, a thousandth of the overlap; stresses at any stretch agree to 1e-11.)";
  for (const Lattice lattice : kLattices) lattice_rows(out, lattice);
  out.figures = {pressure_figure(), moduli_figure()};
  return out;
}

namespace {

PageFigure bounce_figure() {
  Plot plot({.id = "bounces",
             .title = "Bouncing ball, e = 0.8",
             .x = {.label = "bounce"},
             .y = {.label = "over the first height, or flight", .scale = Scale::logarithmic}});
  const auto here = run_bounces(8);
  Series height = series("here: height", points(palette::blue));
  Series flight = series("here: time of flight", points(palette::vermillion, Marker::square));
  Series squares = series("e^(2n)", line(palette::blue));
  Series powers = series("e^n", line(palette::vermillion, "6 4"));
  for (std::size_t n = 0; n < here.size(); ++n) {
    height.x.push_back(static_cast<double>(n + 1));
    height.y.push_back(here[n].height);
    flight.y.push_back(here[n].duration);
    powers.y.push_back(std::pow(kBounceRestitution, n + 1));
    squares.y.push_back(powers.y.back() * powers.y.back());
  }
  flight.x = squares.x = powers.x = height.x;
  for (const Series& s : {powers, squares, flight, height}) plot.add(s);
  return {"bounces", "Heights and flights of a bouncing ball", plot.svg()};
}

/// Largest error of each stretch of the run: a line that a small picture can hold.
Series envelope(const EnergyCourse& course, const std::string& label, report::SeriesStyle style) {
  constexpr std::size_t kStretches = 100;
  Series out = series(label, std::move(style));
  const std::size_t each = course.time.size() / kStretches;
  for (std::size_t s = 0; s < kStretches; ++s) {
    double largest = 0.0;
    for (std::size_t k = s * each; k < (s + 1) * each; ++k) largest = std::max(largest, std::abs(course.error[k]));
    out.x.push_back(course.time[s * each + each / 2]);
    out.y.push_back(largest);
  }
  return out;
}

PageFigure energy_figure() {
  Plot plot({.id = "energy",
             .title = "Two elastic balls between planes: error of the energy",
             .x = {.label = "time over the duration of an impact"},
             .y = {.label = "largest relative error in a hundredth of the run", .scale = Scale::logarithmic}});
  const char* colors[] = {palette::blue, palette::green, palette::vermillion};
  int c = 0;
  for (const int steps : {50, 100, 200}) {
    const std::string many = ", " + std::to_string(steps) + " steps per impact";
    plot.add(envelope(run_pair(PairMotion::colliding, steps, 2000), "colliding" + many, line(colors[c], "2 3")));
    plot.add(envelope(run_pair(PairMotion::pressed, steps, 2000), "always in contact" + many, line(colors[c])));
    ++c;
  }
  return {"energy", "Error of the energy over time", plot.svg()};
}

void energy_rows(PageSection& out) {
  for (const PairMotion motion : {PairMotion::pressed, PairMotion::colliding}) {
    const std::string what = motion == PairMotion::pressed ? "two balls always in contact" : "two balls colliding";
    const EnergyCourse coarse = run_pair(motion, 100, 2000);
    const EnergyCourse fine = run_pair(motion, 200, 2000);
    out.rows.push_back({what + ", 2000 impact times", "energy, root mean square", "constant", "-",
                        error_text(coarse.rms), "1/100 of an impact"});
    out.rows.push_back({what + ", 2000 impact times", "energy, root mean square", "constant", "-", error_text(fine.rms),
                        "1/200 of an impact"});
    out.rows.push_back(
        {what + ", 2000 impact times", "ratio of the two", "4", value_text(coarse.rms / fine.rms, 3), "-", "-"});
    out.rows.push_back({what + ", 2000 impact times", "energy, drift over the run", "0", "-", error_text(fine.drift),
                        "1/200 of an impact"});
  }
}

}  // namespace

PageSection energy_section() {
  PageSection out;
  out.title = "Bounces and energy";
  out.text =
      R"(A ball falls from 0.1 m on a rigid plane, e = 0.8. Heights go as `e^(2n)` and flights as `e^n` for contacts without
duration; here a contact lasts a thousandth of the first flight, and the weight in it takes its share, more of it as
flights get short. The equation of one contact with the weight in it, solved apart by Runge-Kutta, leaves the error of
the step. Two elastic balls between two planes keep their energy (kinetic, and `(2/5) F h` per contact): always in
contact the error is fourfold smaller at half the step and does not drift; contacts that open and close leave an error
of either sign at each opening.)";
  const auto here = run_bounces(6);
  const auto weight = bounces_with_weight(6);
  const std::string step = "1/200 of the first contact";
  for (const std::size_t n : {std::size_t{1}, std::size_t{3}, std::size_t{6}}) {
    const std::string what = "bouncing ball, bounce " + std::to_string(n);
    const double share = std::pow(kBounceRestitution, n);
    out.rows.push_back(row(what, "height over the first, short contacts", share * share, here[n - 1].height, step));
    out.rows.push_back(
        row(what, "height over the first, weight in the contact", weight[n - 1].height, here[n - 1].height, step));
    out.rows.push_back(
        row(what, "flight over the first, weight in the contact", weight[n - 1].duration, here[n - 1].duration, step));
  }
  energy_rows(out);
  out.figures = {bounce_figure(), energy_figure()};
  return out;
}

}  // namespace softgrain::verification
