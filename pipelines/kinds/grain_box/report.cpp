// Packs of grains between six planes in the report: stresses, moduli, contacts, and a look inside. Then what runs leave
// behind.
#include "pipelines/kinds/grain_box/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/text.h"
#include "microsim/grain_box/analysis.h"
#include "microsim/grain_box/record.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/run_data.h"
#include "pipelines/run/findings.h"

namespace softgrain::report {

namespace {

using Packs = std::vector<GrainBoxResult>;

constexpr double kGiga = 1e-9;
constexpr double kMega = 1e-6;

/// Colours repeat after seven packs; dashes then keep them apart.
SeriesStyle line_style(std::size_t index) {
  return {.color = palette::cycle(index), .width = 1.6, .dash = index < 7 ? "" : "6 3"};
}

std::string strain_figure(const Packs& packs, const PlotOptions& options, PointValue value, double unit,
                          const std::string& caption) {
  Plot plot(options);
  for (std::size_t k = 0; k < packs.size(); ++k) {
    Series s = over_strain(packs[k], value, unit, line_style(k));
    if (std::any_of(s.y.begin(), s.y.end(), [](double y) { return std::isfinite(y); })) plot.add(std::move(s));
  }
  return plot.empty() ? "" : figure(plot.svg(), caption);
}

std::string stress_figures(const Packs& packs) {
  const AxisOptions strain{.label = "strain along the main axis [%]"};
  return figure_row(
      {strain_figure(
           packs,
           {.id = "box-stress", .title = "Confining stress", .x = strain, .y = {.label = "sigma_c [MPa]", .low = 0.0}},
           [](const BoxPoint& p) { return p.pressure; }, kMega,
           "Mean of the three wall stresses. Strain from the length at which stress first appears."),
       strain_figure(
           packs,
           {.id = "box-deviator",
            .title = "Deviatoric stress",
            .x = strain,
            .y = {.label = "sqrt(3 J2) [MPa]", .low = 0.0}},
           [](const BoxPoint& p) { return p.deviator; }, kMega,
           "Axial minus lateral stress when two stresses are equal."),
       strain_figure(
           packs,
           {.id = "box-sliding",
            .title = "Sliding contacts",
            .x = strain,
            .y = {.label = "share of contacts", .low = 0.0}},
           [](const BoxPoint& p) { return p.sliding_share; }, 1.0,
           "Contacts with |Q| at the Coulomb limit mu P of the state, of all that carry force. From the moment "
           "friction is on."),
       strain_figure(
           packs,
           {.id = "box-coordination",
            .title = "Coordination number",
            .x = strain,
            .y = {.label = "contacts per grain"}},
           [](const BoxPoint& p) { return p.coordination; }, 1.0,
           "A wall contact counts for one grain, a contact of two grains for both.")});
}

/// The first pack in full: single intervals, fits, probe, effective medium.
std::string first_pack_figure(const GrainBoxResult& result, bool bulk) {
  const GrainBoxFits fits = fit_growth(result);
  const PowerFit& low = bulk ? fits.bulk_low : fits.shear_low;
  const PowerFit& high = bulk ? fits.bulk_high : fits.shear_high;
  const std::string symbol = bulk ? "K" : "G";
  Plot plot({.id = "box-first-" + symbol,
             .title = fmt::format("{} modulus, {}", bulk ? "Bulk" : "Shear", result.spec.name),
             .x = {.label = "sigma_c [MPa]", .scale = Scale::logarithmic},
             .y = {.label = symbol + " [GPa]", .scale = Scale::logarithmic}});
  Series dots = over_pressure(
      result, bulk ? &BoxPoint::bulk : &BoxPoint::shear_modulus, kGiga,
      {.color = palette::sky, .width = 0.0, .opacity = 0.6, .marker = Marker::circle, .marker_size = 1.4});
  dots.label = "per interval";
  dots.sets_range = false;
  if (dots.x.empty()) return "";
  plot.add(std::move(dots));
  Series mean = binned_over_pressure(result, bulk ? &BoxPoint::bulk : &BoxPoint::shear_modulus, kGiga,
                                     {.color = palette::blue, .width = 2.0});
  mean.label = "mean";
  plot.add(std::move(mean));
  Series probe = over_pressure(result, bulk ? &BoxPoint::bulk_probe : &BoxPoint::shear_probe, kGiga,
                               {.color = palette::green, .width = 0.0, .marker = Marker::hollow, .marker_size = 3.0});
  probe.label = "elastic probe (nothing slides)";
  if (!probe.x.empty()) plot.add(std::move(probe));
  Series medium = over_pressure(result, bulk ? &BoxPoint::bulk_medium : &BoxPoint::shear_medium, kGiga,
                                {.color = palette::black, .width = 1.3, .dash = "5 3"});
  medium.label = "effective medium";
  if (!medium.x.empty()) plot.add(std::move(medium));
  const auto add_fit = [&](const PowerFit& fit, const std::array<double, 2>& range, const char* color) {
    if (!std::isfinite(fit.exponent)) return;
    plot.add(fitted_line(fit, range, kGiga, fmt::format("~ sigma_c^{:.3f}", fit.exponent),
                         {.color = color, .width = 1.4, .dash = "2 2"}));
  };
  add_fit(low, result.spec.fit.low, palette::vermillion);
  add_fit(high, result.spec.fit.high, palette::purple);
  return figure(plot.svg(), fmt::format("{} of every interval by Hooke's law, and its mean over bins of sigma_c. The "
                                        "effective medium has the pack's own "
                                        "solid fraction and coordination number, and contacts that never slide.",
                                        symbol));
}

std::string all_packs_figure(const Packs& packs, bool bulk) {
  const std::string symbol = bulk ? "K" : "G";
  Plot plot({.id = "box-all-" + symbol,
             .title = fmt::format("{} modulus against confining stress", bulk ? "Bulk" : "Shear"),
             .x = {.label = "sigma_c [MPa]", .scale = Scale::logarithmic},
             .y = {.label = symbol + " [GPa]", .scale = Scale::logarithmic}});
  for (std::size_t k = 0; k < packs.size(); ++k) {
    Series s = binned_over_pressure(packs[k], bulk ? &BoxPoint::bulk : &BoxPoint::shear_modulus, kGiga, line_style(k));
    if (!s.x.empty()) plot.add(std::move(s));
  }
  return plot.empty() ? "" : figure(plot.svg(), "Means over bins of sigma_c.");
}

std::string modulus_figures(const Packs& packs) {
  std::string out = figure_row({first_pack_figure(packs.front(), true), first_pack_figure(packs.front(), false)});
  if (packs.size() > 1) out += figure_row({all_packs_figure(packs, true), all_packs_figure(packs, false)});
  return out;
}

std::string share_text(double share) { return std::isfinite(share) ? format_number(share, 3) : "–"; }

/// Last point of a phase; of the phase before it where it has none.
const BoxPoint& last_of(const GrainBoxResult& result, BoxPhase phase) {
  static const BoxPoint none{};
  for (auto k = static_cast<std::int64_t>(phase); k >= static_cast<std::int64_t>(BoxPhase::compaction); --k) {
    const auto points = result.points_of(static_cast<BoxPhase>(k));
    if (!points.empty()) return *points.back();
  }
  return none;
}

/// "20, pressed on from 4, 10" [MPa]
std::string pressure_text(const GrainBoxGeneration& generation, double reached) {
  std::string text = format_number(reached * kMega, 4);
  for (std::size_t k = 0; k < generation.lower_pressures.size(); ++k)
    text += (k == 0 ? ", pressed on from " : ", ") + format_number(generation.lower_pressures[k] * kMega, 4);
  return text;
}

std::string generation_table(const Packs& packs) {
  HtmlTable table({"pack", "grains", "mu", "sigma_c (mu = 0) [MPa]", "solid fraction", "contacts per grain",
                   "sigma_c at start of loading [MPa]", "sliding there", "sigma_c of smallest G [MPa]"});
  for (const GrainBoxResult& r : packs) {
    const BoxPoint& a = last_of(r, BoxPhase::compaction);
    const BoxPoint& b = last_of(r, BoxPhase::friction);
    table.row({r.spec.name, format_count(r.spec.grains),
               std::isfinite(r.spec.friction) ? format_number(r.spec.friction, 3) : "infinite",
               pressure_text(r.spec.generation, a.pressure), format_number(a.solid_fraction, 4),
               format_number(a.coordination, 4), format_number(b.pressure * kMega, 4), share_text(b.sliding_share),
               format_number(pressure_of_smallest_shear(r) * kMega, 3)});
  }
  return table.html();
}

std::string end_table(const Packs& packs) {
  HtmlTable table({"at the end", "sigma_c [MPa]", "solid fraction", "contacts per grain", "sliding: |Q| = mu P",
                   "|Q| = mu P at the start of the increment", "shear/sigma_c, largest [%]",
                   "moment of the wall forces/(V sigma_c), largest [%]", "status"});
  for (const GrainBoxResult& r : packs) {
    const BoxPoint& c = last_of(r, BoxPhase::loading);
    table.row({r.spec.name, format_number(c.pressure * kMega, 4), format_number(c.solid_fraction, 4),
               format_number(c.coordination, 4), share_text(c.sliding_share), share_text(c.at_start_limit),
               format_number(100.0 * largest_over_pressure(r, &BoxPoint::shear), 2),
               format_number(100.0 * largest_over_pressure(r, &BoxPoint::moment), 2), r.usable ? "good" : "broke off"});
  }
  return table.html() + paragraph(
                            "Shear: by the first moments of the wall forces, symmetric part. Their moment about the "
                            "centre of the box is 0 in equilibrium.");
}

std::string value_text(double value, double error) {
  return std::isfinite(value) ? format_with_error(value, error) : "–";
}

std::string fit_text(const PowerFit& fit) {
  return std::isfinite(fit.exponent) ? format_with_error(fit.exponent, fit.standard_error) : "–";
}

std::string exponents_table(const Packs& packs) {
  const GrainBoxFit& range = packs.front().spec.fit;
  const auto text = [](const std::array<double, 2>& r) {
    return fmt::format("{} to {} MPa", format_number(r[0] * kMega, 3), format_number(r[1] * kMega, 3));
  };
  HtmlTable table({"growth exponent", "K, " + text(range.low), "K, " + text(range.high), "G, " + text(range.low),
                   "G, " + text(range.high)});
  for (const GrainBoxResult& r : packs) {
    const GrainBoxFits f = fit_growth(r);
    table.row(
        {r.spec.name, fit_text(f.bulk_low), fit_text(f.bulk_high), fit_text(f.shear_low), fit_text(f.shear_high)});
  }
  return table.html();
}

/// What is set side by side at equal sigma_c.
struct ComparedModulus {
  const char* name;
  double ModuliAt::*value;
  double ModuliAt::*error;
  double unit;
};
constexpr ComparedModulus kCompared[] = {
    {"K [GPa]", &ModuliAt::bulk, &ModuliAt::bulk_error, kGiga},
    {"G [GPa]", &ModuliAt::shear, &ModuliAt::shear_error, kGiga},
    {"mean normal force [N]", &ModuliAt::force, &ModuliAt::force_error, 1.0},
};

std::string moduli_table(const Packs& packs, const ComparedModulus& what) {
  const std::vector<double> stresses = comparison_stresses(packs);
  std::vector<std::string> header{fmt::format("{} at sigma_c [MPa]", what.name)};
  for (const double s : stresses) header.push_back(format_number(s * kMega, 3));
  HtmlTable table(header);
  for (const GrainBoxResult& r : packs) {
    std::vector<std::string> row{r.spec.name};
    for (const double s : stresses) {
      const ModuliAt m = moduli_at(r, s);
      row.push_back(value_text(m.*what.value * what.unit, m.*what.error * what.unit));
    }
    table.row(std::move(row));
  }
  return table.html();
}

std::string moduli_tables(const Packs& packs) {
  std::string out;
  for (const ComparedModulus& what : kCompared) out += moduli_table(packs, what);
  return out;
}

std::string arrangements_tables(const Packs& packs) {
  const std::vector<OverArrangements> over = over_arrangements(packs);
  if (over.empty()) return "";
  HtmlTable sliding({"pack", "arrangements", "sliding at the end of the loading"});
  std::vector<std::string> header{"over arrangements, at sigma_c [MPa]"};
  for (const ModuliAt& m : over.front().moduli) header.push_back(format_number(m.pressure * kMega, 3));
  HtmlTable moduli(header);
  for (const OverArrangements& o : over) {
    sliding.row(
        {o.pack, format_count(static_cast<std::int64_t>(o.arrangements)), value_text(o.sliding, o.sliding_error)});
    for (const ComparedModulus& what : kCompared) {
      std::vector<std::string> row{o.pack + ", " + what.name};
      for (const ModuliAt& m : o.moduli)
        row.push_back(value_text(m.*what.value * what.unit, m.*what.error * what.unit));
      moduli.row(std::move(row));
    }
  }
  return moduli.html() + paragraph("Means over arrangements with the standard errors of these means.") + sliding.html();
}

std::string effort_table(const Packs& packs) {
  HtmlTable table({"pack", "states", "iterations", "loop passes", "factorisations", "tries that failed",
                   "worst residual", "seconds", "seconds per state"});
  for (const GrainBoxResult& r : packs) {
    const StepEffort e = total_effort(r.state);
    const auto states = static_cast<double>(r.state.points.size());
    table.row({r.spec.name, format_count(static_cast<std::int64_t>(r.state.points.size())), format_count(e.iterations),
               format_count(e.loop_passes), format_count(e.factorisations), format_count(e.retries),
               format_number(e.residual, 2), format_seconds(r.state.seconds),
               states > 0.0 ? format_number(r.state.seconds / states, 3) : "–"});
  }
  return table.html() + paragraph(
                            "Residual: net force (or moment over radius) on a grain over its largest contact force, "
                            "the worst grain of all states.");
}

}  // namespace

std::string grain_box_section(const RunData& run) {
  const Packs* found = run.file("grain_box.h5", load_grain_boxes);
  if (found == nullptr || found->empty()) return "";
  const Packs& packs = *found;
  const std::string view = pack_view(packs.front());
  return section("grain-boxes", "Packs",
                 "How every pack was generated, its state at the end, and the stress during the loading.",
                 generation_table(packs) + end_table(packs) + stress_figures(packs)) +
         section(
             "moduli", "Moduli", "Bulk and shear modulus against pressure, with the exponents of their growth.",
             modulus_figures(packs) + exponents_table(packs) + moduli_tables(packs) +
                 paragraph(
                     "Mean over the intervals within 10 % of the stress, with the standard error of their scatter.") +
                 arrangements_tables(packs)) +
         section("pack-view", "Section through a pack", "Grains of a pack and the forces between them.",
                 view.empty()
                     ? ""
                     : figure_row({figure(
                           view,
                           "Grains cut by the middle plane, and the forces between grains within a mean radius of "
                           "it: as wide as the force; red where the contact slides.")})) +
         section("grain-box-cost", "Cost", "Increments, iterations and time of every pack.", effort_table(packs));
}

}  // namespace softgrain::report

namespace softgrain {

namespace {

using namespace report;

void check_grain_box_file(const std::string& path, Findings& out) {
  out.add("kind", "grain boxes", fmt::format("grain boxes: {} packs", load_grain_boxes(path).size()));
}

/// "E = 70 GPa, nu = 0.2, radii 0.07 to 0.13 mm"
HeadLine grains_line(const GrainBoxMaterial& m) {
  return {"Grains",
          fmt::format("E = {} GPa, nu = {:g}, radii {} to {} mm.", format_number(1e-9 * m.youngs_modulus),
                      m.poisson_ratio, format_number(1e3 * m.radius_min, 3), format_number(1e3 * m.radius_max, 3))};
}

std::vector<HeadLine> lines_of(const RunData& run) {
  const auto* boxes = run.file("grain_box.h5", load_grain_boxes);
  if (boxes == nullptr) return {};
  std::vector<HeadLine> lines;
  if (!boxes->empty() && is_known(boxes->front().spec.material.youngs_modulus))
    lines.push_back(grains_line(boxes->front().spec.material));
  if (boxes->size() > 3) {
    lines.emplace_back("Packs", fmt::format("{} packs of grains.", boxes->size()));
    return lines;
  }
  for (const GrainBoxResult& r : *boxes) {
    const auto points = r.points_of(BoxPhase::loading);
    if (points.empty()) continue;
    lines.emplace_back(
        "Pack " + r.spec.name,
        fmt::format("{} grains, mu = {:g}, {} loading to a confining stress of {} MPa; {}.",
                    format_count(r.spec.grains), r.spec.friction, r.spec.loading.test,
                    format_number(points.back()->pressure * 1e-6, 4), counted(r.state.points.size(), "state")));
  }
  return lines;
}

/// Values of the last state of the loading.
std::vector<RunValue> values_of(const RunData& run) {
  std::vector<RunValue> out;
  const auto* boxes = run.file("grain_box.h5", load_grain_boxes);
  if (boxes == nullptr) return out;
  for (const GrainBoxResult& r : *boxes) {
    const auto points = r.points_of(BoxPhase::loading);
    if (points.empty()) continue;
    const std::string of = boxes->size() > 1 ? " (" + r.spec.name + ")" : "";
    out.push_back({"confining stress at the end" + of, "Pa", points.back()->pressure});
    out.push_back({"coordination number at the end" + of, "", points.back()->coordination});
    out.push_back({"sliding contacts at the end" + of, "%", 100.0 * points.back()->sliding_share});
  }
  return out;
}

std::vector<RunCurve> curves_of_run(const RunData& run) {
  std::vector<RunCurve> out;
  const auto* boxes = run.file("grain_box.h5", load_grain_boxes);
  if (boxes == nullptr) return out;
  for (const GrainBoxResult& r : *boxes) {
    const Series s = over_strain(r, [](const BoxPoint& p) { return p.pressure; }, 1.0, {});
    out.push_back({"Confining stress", "strain along the main axis [%]", "confining stress", "Pa",
                   boxes->size() > 1 ? r.spec.name : "", s.x, s.y});
  }
  return out;
}

NextSteps next_of(const RunData& run) {
  return {"Errors of K, G and sliding shares: `--set arrangements=4` makes every pack several times.",
          "What the moduli depend on: `softgrain sweep SCENE.toml --over material.mu=0.2,0.4`; states elsewhere: "
          "`softgrain export " +
              run.directory + " --to vtp`."};
}

}  // namespace

KindResults grain_box_results() {
  return {.files = {{.names = "grain_box\\.h5",
                     .is = [](const h5::Group& root) { return root.has("packs"); },
                     .check = check_grain_box_file,
                     .visit = visit_grain_boxes}},
          .sections = {{Part::states, grain_box_section}},
          .lines = lines_of,
          .values = values_of,
          .curves = curves_of_run,
          .next = next_of};
}

}  // namespace softgrain
