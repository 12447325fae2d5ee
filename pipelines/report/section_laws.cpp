// Table of the fitted parameters with errors, intervals and units.
#include <fmt/format.h>

#include <cmath>

#include "common/core/text.h"
#include "common/data/law_words.h"
#include "pipelines/law/law_json.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/plot_helpers.h"
#include "pipelines/report/sections.h"

namespace softgrain::report {
namespace {

/// A unit in which a dimensionless parameter is also given.
struct UnitScale {
  double factor = 1.0;
  std::string unit;
};

std::string interval(const Estimate& e) { return ends_text(e.low, e.high, {format_number}); }

/// The parameter in the given unit, empty when it has none.
std::string in_unit(const Estimate& e, const std::vector<UnitScale>& units, std::size_t which) {
  if (which >= units.size()) return "";
  const UnitScale& u = units[which];
  return format_with_error(e.value * u.factor, e.standard_error * u.factor) + " " + u.unit;
}

void add_row(HtmlTable& table, const std::string& law, const std::string& name, const Estimate& e,
             const std::vector<UnitScale>& units) {
  table.row({law, name, format_number(e.value), format_number(e.standard_error, 2), interval(e), in_unit(e, units, 0),
             in_unit(e, units, 1)});
}

/// The law is named in its first row only.
void add_law_rows(HtmlTable& table, const std::string& name, const ThresholdPowerLaw& law,
                  const std::vector<UnitScale>& units) {
  add_row(table, name, "a", law.a, units);
  add_row(table, "", "b", law.b, {});
  add_row(table, "", "c", law.c, units);
  add_row(table, "", "δ", law.delta, {});
}

std::string status_line(const PairLaw& law, const char* noun) {
  std::string text = "Status: " + to_string(law.status);
  if (!law.reason.empty()) text += " (" + law.reason + ")";
  text += fmt::format(". {} {}, {}, fitted over Δ = {} .. {}", law.packings, noun, counted(law.points, "point"),
                      format_number(law.delta_min), format_number(law.delta_max));
  text += fmt::format("; chi²/dof {}, probability of a larger one {}", format_number(law.chi2_per_dof, 3),
                      format_number(law.quality, 2));
  if (law.max_overlap > 0.0)
    text += fmt::format("; largest grain overlap over the smaller radius {}", format_number(law.max_overlap, 2));
  if (law.unloading) text += "; " + unloading_text(law);
  return paragraph(text + ".");
}

std::string card_tables(const LawCard& card) {
  const double force = card.spec.youngs_modulus * card.spec.shell_radius * card.spec.shell_radius;
  const double stiffness = card.spec.youngs_modulus * card.spec.shell_radius;
  const std::vector<UnitScale> force_units{{force, "N"}};
  const std::vector<UnitScale> stiffness_units{
      {stiffness, "N/m"}, {stiffness / per_degree_to_per_metre(card.spec.shell_radius), "N/degree"}};
  const bool experiment = card.relaxation == "experiment";
  std::string out;
  for (const PairLaw& law : card.pairs) {
    HtmlTable table(
        {"law", "parameter", "value", "standard error", "95 % interval", "for this E and Rs", "per degree turned"}, 2);
    if (has_part(law, LawPart::normal)) add_law_rows(table, "Fn/(E Rs²)", law.normal, force_units);
    if (has_part(law, LawPart::tangential_initial))
      add_law_rows(table, fmt::format("kt/(E Rs), initial (≤ {}°)", law.initial_angle_deg), law.tangential_initial,
                   stiffness_units);
    if (has_part(law, LawPart::tangential_secant))
      add_law_rows(table, fmt::format("kt/(E Rs), secant at {}°", law.secant_angle_deg), law.tangential_secant,
                   stiffness_units);
    out += "<h3>" + escape(describe(law.kind)) + "</h3>\n" + status_line(law, experiment ? "samples" : "packings") +
           (table.empty() ? "" : table.html());
  }
  for (const std::string& note : card.notes) out += paragraph("Note: " + note + ".");
  out += paragraph(
      "F(Δ) = a Δ^b + c for Δ ≥ δ and zero below, c = -a δ^b. Standard errors from the covariance of the joint fit, "
      "intervals: " +
      card.intervals + ". a, b and δ are strongly correlated: judge a law by F(Δ), not by single parameters.");
  return out;
}

void add_numbers(HtmlTable& table, const std::string& kind, const char* part, const std::optional<LawNumbers>& law) {
  if (!law) return;
  for (const auto& [name, e] :
       {std::pair("a", law->a), std::pair("b", law->b), std::pair("c", law->c), std::pair("delta", law->delta)})
    if (!std::isnan(e.value))
      table.row({kind, part, name, format_number(e.value, 5),
                 std::isnan(e.low) ? "–" : format_number(e.low) + " .. " + format_number(e.high)});
}

/// Laws as the summary gives them, for runs whose card is elsewhere.
struct SummaryLaws {
  std::map<std::string, PairLawSummary> laws;
};
void fields(auto&& visit, Of<SummaryLaws> auto& s) { visit("laws", s.laws); }

std::string summary_table(const SummaryLaws& summary) {
  HtmlTable table({"pair", "law", "parameter", "value", "95 % interval"}, 3);
  for (const auto& [kind, law] : summary.laws) {
    add_numbers(table, kind, "normal", law.parts.normal);
    add_numbers(table, kind, "tangential", law.parts.tangential);
    add_numbers(table, kind, "tangential_secant", law.parts.tangential_secant);
  }
  return table.empty() ? "" : table.html();
}

}  // namespace

std::string laws_section(const RunData& run) {
  const std::string body =
      run.card && !run.card->pairs.empty() ? card_tables(*run.card) : summary_table(run.summary_as<SummaryLaws>());
  return section("laws", "Laws: parameters", "Parameters of the fitted laws with their 95 % intervals.", body);
}

}  // namespace softgrain::report
