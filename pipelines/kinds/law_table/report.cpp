// Soft particles with several neighbours in the report: measured means, what the laws make of them, and how far off
// they are. Then what runs leave behind.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibrate/multi_contact_fit.h"
#include "calibrate/multi_contact_states.h"
#include "common/contact/make_laws.h"
#include "common/core/text.h"
#include "common/data/law_words.h"
#include "common/data/multi_contact_replicates.h"
#include "pipelines/kinds/law_table/scene.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/run_data.h"
#include "pipelines/report/svg_plot.h"
#include "pipelines/run/findings.h"

namespace softgrain::report {

namespace {

struct Group {
  const char* id;
  const char* title;
  PartnerKind kind;
  bool held_out;
};
constexpr Group kGroups[] = {{"planes", "Planes, used in the fit", PartnerKind::plane, false},
                             {"planes-out", "Planes, predicted", PartnerKind::plane, true},
                             {"solids", "Solid spheres", PartnerKind::solid, false},
                             {"softs", "Soft neighbours", PartnerKind::soft, false},
                             {"softs-out", "Soft neighbours, predicted", PartnerKind::soft, true}};

/// Plain loading only: other paths to the same overlaps would be drawn on top of each other.
bool belongs(const MultiContactStates& c, const Group& g) {
  const auto& stages = c.configuration->stages;
  const auto loads =
      std::ranges::count_if(stages, [](const MultiContactStage& s) { return s.move == MultiContactMove::load; });
  const MultiContactUse wanted = g.held_out ? MultiContactUse::predicted : MultiContactUse::fitted;
  return c.all_of(g.kind) && c.use == wanted && loads == 1 && c.states.size() > 1 && !loading_states(c).empty();
}

double mean_force(const std::vector<double>& forces) {
  double sum = 0.0;
  for (const double f : forces) sum += f;
  return sum / static_cast<double>(forces.size());
}

void add_measured(Plot& plot, const MultiContactStates& c, const std::string& color) {
  Series s;
  s.label = c.configuration->name;
  for (const MultiContactState* state : loading_states(c)) {
    s.x.push_back(*std::max_element(state->overlap.begin(), state->overlap.end()));
    s.y.push_back(mean_force(state->mean));
    s.y_error.push_back(mean_force(state->error));
  }
  s.style = {color, 0.0, {}, 1.0, Marker::circle, 3.0};
  plot.add(s);
}

void add_law(Plot& plot, const MultiContactStates& c, const MultiContactLaw& law, const std::string& color,
             const char* dash) {
  Series s;
  s.hover = c.configuration->name + ", " + to_string(law.form) + " law";
  s.group = c.configuration->name;
  const MultiContactModel model = multi_contact_model(law);
  const std::vector<double>& end = loading_states(c).back()->overlap;
  for (int k = 1; k <= 60; ++k) {
    std::vector<double> overlap = end;
    for (double& x : overlap) x *= k / 60.0;
    s.x.push_back(*std::max_element(overlap.begin(), overlap.end()));
    s.y.push_back(mean_force(multi_contact_forces(model, c.configuration->partners, overlap)));
  }
  s.style = {color, 1.5, dash, 1.0, Marker::none, 3.0};
  s.sets_range = false;
  plot.add(s);
}

std::string group_figure(const Group& group, const std::vector<MultiContactStates>& states,
                         const LawTableEntry& entry) {
  Plot plot({"multi-contact-" + std::string(group.id),
             group.title,
             {"overlap h/Rs", Scale::linear, {}, {}},
             {"mean force per neighbour F/(E Rs²)", Scale::logarithmic, {}, {}},
             {},
             560.0,
             420.0});
  std::size_t color = 0;
  for (const MultiContactStates& c : states) {
    if (!belongs(c, group)) continue;
    const char* shade = palette::cycle(color++);
    add_measured(plot, c, shade);
    add_law(plot, c, *entry.find(entry.best), shade, "");
    if (entry.best != LawForm::pair && entry.find(LawForm::pair) != nullptr)
      add_law(plot, c, *entry.find(LawForm::pair), shade, "2 3");
  }
  if (color == 0) return "";
  return figure(plot.svg(),
                fmt::format("Points: means over packings with standard errors; lines: the {} law, dotted: the "
                            "pair law{}.",
                            to_string(entry.best), group.held_out ? "; none of this was used in the fit" : ""));
}

/// "0.73 ± 0.19"; a number that is fixed has no error, one whose error is not known says so.
std::string error_text(const Estimate& e) {
  return estimate_with_error(e, {format_number, " ± ", " (error not known)"});
}

std::string error_table(const LawTableEntry& entry) {
  std::vector<std::string> header{"configuration", "use"};
  for (const MultiContactLaw& law : entry.laws) header.push_back(to_string(law.form) + " law: error [%]");
  header.emplace_back("noise of the mean [%]");
  HtmlTable table(header, 2);
  const MultiContactLaw& first = entry.laws.front();
  for (std::size_t k = 0; k < first.errors.size(); ++k) {
    std::vector<std::string> cells{first.errors[k].name, to_string(first.errors[k].use)};
    for (const MultiContactLaw& law : entry.laws)
      cells.push_back(k < law.errors.size() ? format_number(100.0 * law.errors[k].error, 2) : "–");
    cells.push_back(format_number(100.0 * first.errors[k].noise, 2));
    table.row(std::move(cells));
  }
  return table.html();
}

std::string parameter_table(const LawTableEntry& entry) {
  HtmlTable table({"law", "a", "b", "delta", "m0", "m1", "m2", "error, fitted [%]", "error, held out [%]",
                   "error, leave one out [%]", "information criterion"});
  for (const MultiContactLaw& law : entry.laws) {
    std::vector<std::string> cells{form_label(entry, law)};
    for (const Estimate* e : {&law.a, &law.b, &law.delta, &law.m0, &law.m1, &law.m2}) cells.push_back(error_text(*e));
    for (const double x : {law.error_fitted, law.error_held_out, law.error_cross})
      cells.push_back(format_number(100.0 * x, 3));
    cells.push_back(format_number(law.criterion, 4));
    table.row(std::move(cells));
  }
  return table.html();
}

/// What packings and a library say of the numbers that were measured, and both together.
std::string prior_table(const LawTableEntry& entry) {
  if (!entry.prior) return "";
  HtmlTable table({"number of the isotropic law", "packings", "library", "both", "weight of the packings [%]"});
  const auto with_error = [](double value, double error) { return error_text({value, error, 0.0, 0.0}); };
  for (const PriorNumber& n : entry.prior->numbers)
    if (std::isfinite(n.own))
      table.row({n.name, with_error(n.own, n.own_error),
                 std::isfinite(n.library) ? with_error(n.library, n.library_error) : "–", with_error(n.value, n.error),
                 format_number(100.0 * n.own_weight, 2)});
  return paragraph(
             fmt::format("The isotropic law is that of the packings and of a library together ({}). Errors of the "
                         "packings are widened by {:.2g}: the form is off by more than packings scatter.",
                         entry.prior->library, entry.prior->own_factor)) +
         table.html();
}

std::string entry_body(const LawTableEntry& entry, const std::optional<MultiContactMeasurements>& multi_contact) {
  std::string body = paragraph(fmt::format(
      "Solid fraction {:.4f} ± {:.4f}, {}. Taken where none is named: the {} law. Measured up to h/Rs = "
      "{:.2f} and an equivalent lost volume of {:.3f}; grains overlap there by up to {:.1f} of the smaller radius. "
      "Sliding, {}; {}.",
      entry.solid_fraction, entry.solid_fraction_error, counted(entry.packings, "packing"), to_string(entry.best),
      entry.overlap_max, entry.volume_max, entry.grain_overlap_max, slides_text(entry), unloading_text(entry)));
  for (const MultiContactLaw& law : entry.laws)
    if (law.status != LawStatus::good)
      body += paragraph("The " + to_string(law.form) + " law is " + to_string(law.status) +
                        (law.reason.empty() ? "" : ": " + law.reason) + ".");
  body += parameter_table(entry) + prior_table(entry) + error_table(entry);
  if (!multi_contact) return body;
  const MultiContactMeasurements data = mean_over_orientations(*multi_contact);  // states point to its configurations
  const std::vector<MultiContactStates> states = average_states(data);
  std::vector<std::string> figures;
  for (const Group& g : kGroups) {
    const std::string f = group_figure(g, states, entry);
    if (!f.empty()) figures.push_back(f);
  }
  return body + figure_row(figures);
}

/// The measurement in the directory belongs to the entry of the same solid fraction.
bool measured_here(const LawTableEntry& entry, const MultiContactMeasurements& multi_contact) {
  double sum = 0.0;
  for (const PackingInfo& p : multi_contact.packings) sum += p.solid_fraction;
  return std::abs(sum / static_cast<double>(multi_contact.packings.size()) - entry.solid_fraction) < 1e-9;
}

}  // namespace

std::string law_table_section(const RunData& run) {
  if (!run.law_table) return "";
  std::string body;
  for (const LawTableEntry& entry : run.law_table->entries) {
    if (entry.find(entry.best) == nullptr) continue;
    const bool here =
        run.multi_contact && !run.multi_contact->packings.empty() && measured_here(entry, *run.multi_contact);
    body += entry_body(entry, here ? run.multi_contact : std::nullopt);
  }
  return section("law-table", "Multi-contact laws",
                 "Force on one neighbour while others press too: measured means and the fitted laws.", body);
}

}  // namespace softgrain::report

namespace softgrain {

namespace {

using namespace report;

void check_multi_contact_file(const std::string& path, Findings& out) {
  const MultiContactMeasurements data = load_multi_contact(path);
  std::size_t open = 0;
  for (const MultiContactRun& run : data.runs)
    open += static_cast<std::size_t>(
        std::count_if(run.points.begin(), run.points.end(), [](const MultiContactPoint& p) { return !p.converged; }));
  out.add("kind", "multi-contact measurements",
          fmt::format("multi-contact measurements: {} configurations, {} packings, {} runs", data.configurations.size(),
                      data.packings.size(), data.runs.size()));
  if (open > 0) out.warn(fmt::format("{} recorded points did not converge", open));
}

std::string table_line(const LawTableEntry& entry) {
  const MultiContactLaw* best = entry.find(entry.best);
  if (best == nullptr) return "";
  std::string held_out;
  if (std::isfinite(best->error_held_out))
    held_out = fmt::format(" and by {} % on what was held out", format_number(100.0 * best->error_held_out, 2));
  return fmt::format("Solid fraction {}: form {}, off by {} % where it was fitted{}; h/Rs up to {}.",
                     format_number(entry.solid_fraction, 3), form_label(entry, *best),
                     format_number(100.0 * best->error_fitted, 2), held_out, format_number(entry.overlap_max, 2));
}

std::vector<HeadLine> lines_of(const RunData& run) {
  std::vector<HeadLine> lines;
  if (run.law_table)
    for (const LawTableEntry& entry : run.law_table->entries)
      lines.emplace_back("Multi-contact law", table_line(entry));
  return lines;
}

std::vector<RunValue> values_of(const RunData& run) {
  std::vector<RunValue> out;
  if (!run.law_table) return out;
  for (const LawTableEntry& entry : run.law_table->entries) {
    const MultiContactLaw* best = entry.find(entry.best);
    if (best == nullptr) continue;
    const std::string of =
        fmt::format(" ({} law at solid fraction {:.3g})", to_string(entry.best), entry.solid_fraction);
    out.push_back({"off where it was fitted" + of, "%", 100.0 * best->error_fitted});
    if (std::isfinite(best->error_held_out))
      out.push_back({"off on what was held out" + of, "%", 100.0 * best->error_held_out});
  }
  return out;
}

NextSteps next_of(const RunData& run) {
  return {"Take it in a scene, with error bars: `softgrain macrosim SCENE.toml --law " + run.directory +
              "/law_table.toml --bands 64`.",
          "What to measure next for that scene, most per second first: `softgrain law plan " + run.directory +
              "/law_table.toml --for SCENE.toml`."};
}

void check_table_values(const std::string& path, Findings& out) {
  check_replicates(path);
  out.add("kind", "law table values", "values and refits of a law table");
}

}  // namespace

KindResults law_table_results() {
  return {.files = {{.names = "(multi_contact|crowd)(_(variant|level)_[0-9]+)?\\.h5",
                     .is = [](const h5::Group& root) { return root.has("configurations"); },
                     .check = check_multi_contact_file},
                    {.names = "law(_table)?\\.toml", .check = check_laws},
                    {.names = "law_table_level_[0-9]+\\.toml"},
                    {.names = "law_table(_level_[0-9]+)?\\.h5",
                     .is = [](const h5::Group& root) { return root.has("entry_0"); },
                     .check = check_table_values}},
          .sections = {{Part::several, law_table_section}},
          .lines = lines_of,
          .values = values_of,
          .next = next_of};
}

}  // namespace softgrain
