// A law table as text for a terminal.
#include <fmt/format.h>

#include <cmath>

#include "common/core/text.h"
#include "common/data/law_words.h"
#include "pipelines/law/fitted_law.h"
#include "pipelines/law/law_values.h"
#include "pipelines/law/terminal_plot.h"

namespace softgrain::law {

namespace {

using Rows = std::vector<std::vector<std::string>>;

/// "0.733 +- 0.19"; parameters that a form does not have are fixed.
std::string number_text(const Estimate& e) { return estimate_with_error(e, {number}); }

std::string percent(double share) { return rounded_text(100.0 * share, {1, true}, "-"); }

std::string parameters_text(const LawTableEntry& entry) {
  Rows rows{{"form"}};
  for (const MultiContactParameterName& p : kMultiContactParameters) rows.push_back({p.key});
  for (const char* name : {"off by [%]: fitted", "held out", "leave one out", "criterion"}) rows.push_back({name});
  for (const MultiContactLaw& law : entry.laws) {
    std::size_t r = 0;
    rows[r++].push_back(form_label(entry, law));
    for (const MultiContactParameterName& p : kMultiContactParameters)
      rows[r++].push_back(number_text(law.*p.estimate));
    for (const double x : {law.error_fitted, law.error_held_out, law.error_cross}) rows[r++].push_back(percent(x));
    rows[r++].push_back(number(law.criterion, 5));
  }
  return aligned(rows, 2);
}

std::string partners_text(const MultiContactLaw& law) {
  Rows rows{{"neighbour", "R'/R", "w", "m", "h/min(R, R') to", "off by [%]"}};
  for (const PartnerRow& row : law.partners)
    rows.push_back({to_string(row.kind), number(row.ratio), number_text(row.weight), number_text(row.exponent),
                    number(row.overlap_max, 3), percent(row.error)});
  if (rows.size() == 1) return "";
  return fmt::format("  neighbours of the {} law, nu = w v^m (a plane has w = m = 1)\n", to_string(law.form)) +
         aligned(rows, 2);
}

std::string slides_table(const LawTableEntry& e) {
  Rows rows{{"friction", "mu_soft", "kt/kn"}};
  Rows rolls{{"rolling", "largest moment/FR", "stiffness/E R^2 R12"}};
  const auto add = [&](const char* name, const SlideLaw& slide) {
    const std::string from = slide.measured ? "" : " (not measured)";
    rows.push_back({name, number_text(slide.friction) + from, number_text(slide.kt_ratio) + from});
    rolls.push_back({name, slide.rolls ? number_text(slide.rolling_friction) : "not measured: free",
                     slide.rolls ? number_text(slide.rolling) : "-"});
  };
  add("on planes", e.slide_plane);
  add("on solid spheres", e.slide_solid);
  add("on soft ones", e.slide_soft);
  return aligned(rows, 2) + (e.rolls() ? aligned(rolls, 2) : "");
}

/// What packings and a library say of the numbers that were measured.
std::string prior_text(const LawTableEntry& e) {
  if (!e.prior) return "";
  const auto with_error = [](double value, double error) { return number_text({value, error, 0.0, 0.0}); };
  Rows rows{{"isotropic law", "packings", "library", "both", "weight of packings [%]"}};
  for (const PriorNumber& n : e.prior->numbers)
    if (std::isfinite(n.own))
      rows.push_back({n.name, with_error(n.own, n.own_error),
                      std::isfinite(n.library) ? with_error(n.library, n.library_error) : "-",
                      with_error(n.value, n.error), percent(n.own_weight)});
  return wrapped("  packings and a library together: " + e.prior->library, 4) + aligned(rows, 2);
}

/// Forms that are no good say why.
std::string statuses_text(const LawTableEntry& e) {
  std::string text;
  for (const MultiContactLaw& law : e.laws)
    if (law.status != LawStatus::good)
      text += wrapped(fmt::format("  {} law: {}{}", to_string(law.form), to_string(law.status),
                                  law.reason.empty() ? "" : " (" + law.reason + ")"),
                      4);
  return text;
}

/// Force of one plane and of each of six.
std::string plot_of(const LawTableEntry& e, bool utf8) {
  const MultiContactLaw* best = e.find(e.best);
  const bool usable = best->status != LawStatus::no_threshold_crossing && !best->rows(PartnerKind::solid).empty() &&
                      !best->rows(PartnerKind::soft).empty();
  if (!usable || !(e.overlap_max > 0.0)) return "";
  const LawTable alone{1, {e}};
  constexpr std::size_t kPoints = 160;
  TerminalPlot plot{"h/Rs", "F/(E Rs^2) on each plane, " + to_string(e.best) + " law", 76, 10, utf8, {}};
  for (const Arrangement arranged : {Arrangement::one, Arrangement::cube}) {
    MultiContactQuestion q;
    q.arrangement = arranged;
    q.beyond = Extrapolation::extrapolate;
    TerminalCurve curve;
    if (arranged == Arrangement::one) curve.look = TerminalCurve::Look::dotted;
    for (const LawPoint& p : multi_contact_values(alone, q, even(0.0, e.overlap_max, kPoints)).points) {
      if (p.where == Where::beyond) break;
      curve.x.push_back(p.delta);
      curve.y.push_back(p.force.value);
    }
    plot.curves.push_back(std::move(curve));
  }
  return draw(plot) + "  line: six planes (cube), as far as was measured; dots: one plane\n";
}

std::string unloading_of(const LawTableEntry& e) {
  if (!e.unloading_measured) return "not measured";
  std::string text = number_text(e.unloading) + " times as steep";
  if (e.slide_solid.has_unloading) text += ", " + number_text(e.slide_solid.unloading) + " against solid spheres";
  if (e.slide_soft.has_unloading) text += ", " + number_text(e.slide_soft.unloading) + " among soft particles";
  return text;
}

std::string entry_text(const LawTableEntry& e, bool main, bool utf8) {
  std::string text = wrapped(
      fmt::format("solid fraction {:.4f} +- {:.4f}{}: {}{}, {}", e.solid_fraction, e.solid_fraction_error,
                  main ? " (main: taken unless another is named)" : "", counted(e.packings, "packing"),
                  e.grains > 0.0 ? fmt::format(", a soft particle represents {} grains", number(e.grains, 3)) : "",
                  e.relaxation),
      4);
  text += wrapped("  " + show_spec(e.spec), 4);
  text +=
      wrapped(fmt::format("  valid up to an equivalent volume of {} and h/Rs = {} with a plane, where grains overlap "
                          "by up to {} of the smaller radius; beyond: {}; unloading {}",
                          number(e.volume_max, 3), number(e.overlap_max, 3), number(e.grain_overlap_max, 2),
                          to_string(e.beyond), unloading_of(e)),
              4);
  text += statuses_text(e) + parameters_text(e);
  if (const MultiContactLaw* best = e.find(e.best)) text += partners_text(*best);
  return text + prior_text(e) + slides_table(e) + plot_of(e, utf8);
}

}  // namespace

std::string show(const LawTable& table, const FittedLaw& file, bool utf8) {
  std::string text = wrapped(fmt::format("{}: law table, {} solid fraction{}", file.path, table.entries.size(),
                                         table.entries.size() == 1 ? "" : "s"),
                             2);
  const std::string origin = origin_text(file.origin);
  if (!origin.empty()) text += wrapped("  " + origin, 2);
  for (const std::string& note : table.notes) text += wrapped("  note: " + note, 4);
  for (const LawTableEntry& e : table.entries) text += "\n" + entry_text(e, &e == &main_entry(table), utf8);
  return text;
}

}  // namespace softgrain::law
