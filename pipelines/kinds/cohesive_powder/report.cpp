// Cohesive powders in the report: packings with their forces, snapshots, courses, forces, scattered intensity, tables.
// Then the states that powder.h5 holds, and what runs leave behind.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "common/core/statistics.h"
#include "common/core/text.h"
#include "common/state/system_io.h"
#include "microsim/powder/powder_state_io.h"
#include "pipelines/kinds/cohesive_powder/powder_data.h"
#include "pipelines/kinds/cohesive_powder/report_plots.h"
#include "pipelines/kinds/cohesive_powder/scene.h"
#include "pipelines/kinds/cohesive_powder/summary.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/run_data.h"
#include "pipelines/run/findings.h"

namespace softgrain::report {

namespace {

/// Width of one small picture [px], and how many of them stand in the row.
constexpr double kSnapshotWidth = 260.0;
constexpr std::size_t kSnapshots = 6;

/// A column of the table. A sample without the value gives NaN.
struct Column {
  std::string header;
  std::function<double(const PackSummary&)> of;
  int digits = 4;
  bool yes_no = false;  ///< a flag, shown as a word; its mean is how many say yes
};

std::vector<Column> contact_columns() {
  const auto count = [](std::int64_t PowderContacts::*member) {
    return [member](const PackSummary& s) { return static_cast<double>(s.contacts.*member); };
  };
  return {{"Phi", [](const PackSummary& s) { return s.fraction; }},
          {"Phi in 3D", [](const PackSummary& s) { return s.analysis.solid_fraction_3d; }},
          {"z", [](const PackSummary& s) { return s.contacts.coordination; }},
          {"z*", [](const PackSummary& s) { return s.contacts.coordination_backbone; }},
          {"repulsive", count(&PowderContacts::repulsive)},
          {"tensile", count(&PowderContacts::tensile)},
          {"unstressed", count(&PowderContacts::unstressed)},
          {"distant", count(&PowderContacts::distant)},
          {"rattlers", count(&PowderContacts::rattlers)}};
}

std::vector<Column> force_columns() {
  return {{"<N>", [](const PackSummary& s) { return s.contacts.mean_normal; }, 3},
          {"<N> repulsive", [](const PackSummary& s) { return s.contacts.mean_repulsive; }, 3},
          {"<N> tensile", [](const PackSummary& s) { return s.contacts.mean_tensile; }, 3},
          {"sqrt <N²>", [](const PackSummary& s) { return s.contacts.square_mean_normal; }, 3},
          {"share without force", [](const PackSummary& s) { return s.analysis.forces.zero_share.value_or(kNaN); }, 3},
          {"P of Rumpf", [](const PackSummary& s) { return s.contacts.rumpf_pressure; }, 3},
          {"over the imposed", [](const PackSummary& s) { return s.analysis.rumpf_ratio.value_or(kNaN); }, 4},
          {"F_perc", [](const PackSummary& s) { return s.analysis.percolation.either.value_or(kNaN); }, 3},
          {"B", [](const PackSummary& s) { return s.analysis.moduli ? s.analysis.moduli->bulk : kNaN; }, 3},
          {"G", [](const PackSummary& s) { return s.analysis.moduli ? s.analysis.moduli->shear : kNaN; }, 3}};
}

/// h, k and definiteness of one matrix, which `find` gives; null: there is none.
void add_rigidity(std::vector<Column>& columns, const std::string& which,
                  const Rigidity* (*find)(const PowderRigidity&)) {
  const auto of = [find](double (*value)(const Rigidity&)) {
    return [find, value](const PackSummary& s) {
      const Rigidity* matrix = s.analysis.rigidity ? find(*s.analysis.rigidity) : nullptr;
      return matrix != nullptr ? value(*matrix) : kNaN;
    };
  };
  columns.push_back({"h" + which, of([](const Rigidity& r) { return static_cast<double>(r.indeterminacy); })});
  columns.push_back({"k" + which, of([](const Rigidity& r) { return static_cast<double>(r.floppy); })});
  columns.push_back(
      {"positive definite" + which, of([](const Rigidity& r) { return r.stiffness.positive ? 1.0 : 0.0; }), 0, true});
}

std::vector<Column> rigidity_columns() {
  std::vector<Column> columns;
  add_rigidity(columns, "", [](const PowderRigidity& r) { return &r.fixed; });
  add_rigidity(columns, ", free cell", [](const PowderRigidity& r) { return r.free ? &*r.free : nullptr; });
  add_rigidity(columns, ", backbone", [](const PowderRigidity& r) { return r.backbone ? &*r.backbone : nullptr; });
  return columns;
}

std::vector<Column> structure_columns() {
  // A fit that is not usable must not stand in a table as if it were.
  const auto fitted = [](double (*value)(const ScatteringFit&)) {
    return [value](const PackSummary& s) { return s.scattering && s.scattering->usable ? value(*s.scattering) : kNaN; };
  };
  const auto hole = [](double (*value)(const PowderHoles&)) {
    return [value](const PackSummary& s) { return s.holes ? value(*s.holes) : kNaN; };
  };
  return {{"dF", fitted([](const ScatteringFit& f) { return f.dimension.value; }), 3},
          {"error of dF", fitted([](const ScatteringFit& f) { return f.dimension.error; }), 2},
          {"xi [a]", fitted([](const ScatteringFit& f) { return f.length.value; }), 3},
          {"error of xi", fitted([](const ScatteringFit& f) { return f.length.error; }), 2},
          {"<R>_w [a]", hole([](const PowderHoles& h) { return h.mean_radius; })},
          {"largest hole [a]", hole([](const PowderHoles& h) { return h.largest_radius; })},
          {"holes", hole([](const PowderHoles& h) { return static_cast<double>(h.count); })}};
}

std::string cell_text(double value, const Column& column) {
  if (column.yes_no) return value > 0.0 ? "yes" : "no";
  return format_number(value, column.digits);
}

/// Mean of the values with its standard error; of a flag how many say yes.
std::string mean_text(const std::vector<double>& values, const Column& column) {
  if (column.yes_no) return fmt::format("{} of {}", std::count(values.begin(), values.end(), 1.0), values.size());
  if (values.empty()) return "–";
  const MeanError m = mean_error(values);
  return m.n < 2 ? format_number(m.mean, column.digits) : format_with_error(m.mean, m.error);
}

std::string deviation_text(const std::vector<double>& values, const Column& column) {
  return column.yes_no || values.size() < 2 ? "–" : format_number(mean_error(values).deviation, 2);
}

/// One row per sample, then means over usable samples and how much these scatter; columns without any value are left
/// out.
std::string table_of(const std::vector<PackSummary>& samples, std::vector<Column> columns) {
  std::erase_if(columns, [&](const Column& c) {
    return std::all_of(samples.begin(), samples.end(), [&](const PackSummary& s) { return std::isnan(c.of(s)); });
  });
  if (columns.empty()) return "";
  std::vector<std::string> header{"sample"};
  for (const Column& c : columns) header.push_back(c.header);
  HtmlTable table(header);
  std::vector<std::vector<double>> values(columns.size());
  for (std::size_t k = 0; k < samples.size(); ++k) {
    std::vector<std::string> row{fmt::format("{}{}", k, samples[k].usable ? "" : " (not at rest)")};
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const double value = columns[c].of(samples[k]);
      row.push_back(std::isnan(value) ? "–" : cell_text(value, columns[c]));
      if (!std::isnan(value) && samples[k].usable) values[c].push_back(value);
    }
    table.row(std::move(row));
  }
  std::vector<std::string> means{"mean ± standard error"};
  std::vector<std::string> deviations{"standard deviation"};
  for (std::size_t c = 0; c < columns.size(); ++c) {
    means.push_back(mean_text(values[c], columns[c]));
    deviations.push_back(deviation_text(values[c], columns[c]));
  }
  table.row(std::move(means));
  table.row(std::move(deviations));
  return table.html();
}

/// Shares x_k of disks with k interactions, as columns. A sample without disks of k neighbours has the share 0, not
/// none.
std::string shares_table(const std::vector<PackSummary>& samples) {
  std::size_t most = 0;
  for (const PackSummary& s : samples) most = std::max(most, s.contacts.shares.size());
  std::vector<Column> columns;
  for (std::size_t k = 0; k < most; ++k)
    columns.push_back({fmt::format("x_{}", k),
                       [k](const PackSummary& s) { return k < s.contacts.shares.size() ? s.contacts.shares[k] : 0.0; },
                       3});
  return table_of(samples, columns);
}

/// What became of the lower end of the fractal.
std::string lower_end_text(const ScatteringFit& fit) {
  if (fit.tie_cost > 0.0)
    return fmt::format("amplitude free (tied to Phi, chi² grows by {})", format_number(fit.tie_cost, 2));
  return fmt::format("l = {} a", format_with_error(fit.lower_length.value, fit.lower_length.error));
}

std::string fit_text(const ScatteringFit& fit) {
  if (!fit.usable) return "not to be relied on (" + fit.reason + ")";
  return fmt::format("up to k a = {}: dF = {}, xi = {} a, {}, chi² per degree {}{}", format_number(fit.k_high, 3),
                     format_with_error(fit.dimension.value, fit.dimension.error),
                     format_with_error(fit.length.value, fit.length.error), lower_end_text(fit),
                     format_number(fit.chi2_per_degree, 2),
                     fit.bounded.empty() ? "" : ", at the end of what the disks allow: " + fit.bounded);
}

/// One fit to all samples, and what other ends of the fitted range make of it.
std::string common_fit(const std::optional<EnsembleFit>& ensemble) {
  if (!ensemble) return "";
  std::string out = paragraph("One fit to all samples, " + fit_text(ensemble->fit) + ".");
  for (const ScatteringFit& other : ensemble->other_ranges)
    out += paragraph("Another end of the range: " + fit_text(other) + ".");
  return out;
}

std::string tables(const RunData& run) {
  const auto summary = run.summary_as<PowderSummary>();
  const std::vector<PackSummary>& samples = summary.samples;
  if (samples.empty()) return "";
  return table_of(samples, contact_columns()) + table_of(samples, force_columns()) +
         paragraph(
             "Lengths in a (largest diameter), forces in F0 (adhesion; without it P a). Interactions are contacts "
             "and distant pairs; unstressed ones have |N| below 1e-4. F_perc: largest force whose contacts "
             "still reach across the cell. B, G: bulk and shear modulus of the springs of all contacts, in F0/a. Phi "
             "in 3D: the equivalent 0.752 Phi^1.5.") +
         shares_table(samples) + paragraph("x_k: share of disks with k interactions.") +
         table_of(samples, rigidity_columns()) +
         paragraph(
             "h: self-stresses, k: motions without force, of the rigidity matrix with fixed cell, with its two strains "
             "free, and without rattlers (where there is no cohesion). Positive definite: the springs alone hold it.") +
         table_of(samples, structure_columns()) +
         paragraph(
             "dF, xi: fit of I(k), with its standard error; values of fits that cannot be relied on are left "
             "out. <R>_w: radii of holes, weighted by their areas.") +
         common_fit(summary.scattering);
}

/// Selects at most kSnapshots snapshots, the first and the last included.
std::vector<Snapshot> chosen(const SnapshotSeries& all) {
  std::vector<Snapshot> out;
  const std::size_t n = std::min(all.size(), kSnapshots);
  for (std::size_t k = 0; k < n; ++k)
    if (const auto one = all.at(n < 2 ? 0 : k * (all.size() - 1) / (n - 1))) out.push_back(*one);
  return out;
}

std::string snapshots(const PowderRun& run) {
  if (run.samples.empty()) return "";
  const std::vector<Snapshot> list = chosen(*run.samples.front().snapshots);
  double longest = 0.0;
  for (const Snapshot& s : list) longest = std::max({longest, s.cell_edges[0][0], s.cell_edges[1][1]});
  if (!(longest > 0.0)) return "";
  std::string cells;
  for (std::size_t k = 0; k < list.size(); ++k) {
    const std::string title = fmt::format("{}: t = {} T0", k + 1, format_number(list[k].time, 3));
    cells += "<div>" + snapshot_view(list[k], (kSnapshotWidth - 4.0) / longest, kSnapshotWidth, title) + "</div>\n";
  }
  return "<figure><div class=\"strip\">\n" + cells + "</div>\n<figcaption>" +
         escape("The assembly of sample 0, all pictures to the same scale.") + "</figcaption></figure>\n";
}

std::string packings(const PowderRun& run) {
  if (run.samples.empty()) return "";
  const PowderSample& sample = run.samples.front();
  const std::string forces = packing_view(sample, PowderLines::forces, run.idle_colour, "Forces, sample 0");
  const std::string stressed =
      packing_view(sample, PowderLines::stressed, run.idle_colour, "Stressed and unstressed contacts, sample 0");
  if (forces.empty()) return "";
  return figure_row(
      {figure(forces, fmt::format("Lines between the centres of interacting disks, as wide as the normal force: {} a "
                                  "stand for {} F0, which one in twenty exceeds. Sample 0.",
                                  kStrongLine, format_number(strong_force(sample.contacts), 2))),
       figure(stressed,
              fmt::format("All interactions; those with |N| below {} are blue. Disks with none but such are grey.",
                          format_number(run.idle_colour, 2)))});
}

}  // namespace

std::string powder_section(const RunData& run) {
  const PowderRun* found = run.file("powder.h5", load_powder);
  if (found == nullptr) return "";
  const PowderRun& powder = *found;
  const std::string scattering = scattering_figure(powder);
  std::vector<PowderStages> stages;
  for (const PowderSample& s : powder.samples) stages.push_back(s.stages);
  return section("powder", "Packings", "Solid fraction and contacts of the packings, and pictures of their particles.",
                 packings(powder) + snapshots(powder)) +
         section("powder-course", "Assembly",
                 "How solid fraction, kinetic energy and contacts develop during the assembly.",
                 course_figures(powder)) +
         section("powder-consolidation", "Consolidation", "Solid fraction against pressure, on loading and unloading.",
                 consolidation_figures(stages)) +
         section("powder-forces", "Forces", "Distributions of normal and tangential contact forces.",
                 force_figures(powder)) +
         section("powder-scattering", "Scattered intensity",
                 "Scattered intensity over the wave number: its slope gives the fractal dimension, its knee the "
                 "correlation length.",
                 scattering.empty() ? "" : figure_row({scattering})) +
         section("powder-samples", "Samples", "Numbers of every sample.", tables(run));
}

}  // namespace softgrain::report

namespace softgrain {

namespace {

void name_units(Snapshot& s, const PowderSpec& spec) {
  const Snapshot form = powder_frames();
  s.kind = form.kind;
  s.length_unit = form.length_unit;
  s.force_unit = spec.cohesive ? form.force_unit : "P a";
  s.time_unit = form.time_unit;
}

struct SampleStates {
  Snapshot last;
  std::optional<SnapshotSeries> pictures;  ///< of the assembly
};

SampleStates read_states(const h5::Group& group, const PowderSpec& spec, SnapshotChoice choice) {
  SampleStates out{snapshot_of(read_powder_system(group, spec)), {}};
  name_units(out.last, spec);
  out.last.time = group.open("system").number("time");
  if (choice == SnapshotChoice::all) out.pictures = read_powder_series(group, out.last);
  return out;
}

/// The last picture of an assembly may be its end, which is told with contacts instead.
void visit_sample(SampleStates states, std::size_t sample, const VisitSnapshot& visit) {
  std::int64_t frame = 0;
  const auto show = [&](Snapshot& s) {
    s.series = fmt::format("sample_{}", sample);
    s.label = fmt::format("powder, sample {}, time {:.4g} T0", sample, s.time);
    s.frame = frame++;
    visit(s);
  };
  for (std::size_t k = 0; states.pictures && k < states.pictures->size(); ++k)
    if (auto picture = states.pictures->at(k); picture && picture->time < states.last.time) show(*picture);
  show(states.last);
}

}  // namespace

void visit_powder(const std::string& path, SnapshotChoice choice, const VisitSnapshot& visit) {
  const h5::Group root = h5::open_file(path);
  const PowderSpec spec = read_powder_spec(root.open("spec"));
  for (std::size_t k = 0; root.has(fmt::format("sample_{}", k)); ++k) {
    const h5::Group sample = root.open(fmt::format("sample_{}", k));
    visit_sample(h5::naming_file(path, [&] { return read_states(sample, spec, choice); }), k, visit);
  }
}

namespace {

void check_powder_file(const std::string& path, Findings& out) {
  const PowderRun run = load_powder(path);
  const auto unusable =
      std::count_if(run.samples.begin(), run.samples.end(), [](const PowderSample& s) { return !s.usable; });
  out.add("kind", "powders", "cohesive powders: " + counted(run.samples.size(), "sample"));
  if (unusable > 0) out.warn(counted(unusable, "sample") + " did not reach equilibrium");
}

std::vector<HeadLine> lines_of(const report::RunData& run) {
  const auto* powder = run.file("powder.h5", load_powder);
  if (powder == nullptr) return {};
  return {{"Powder", fmt::format("{} packs of disks.", powder->samples.size())}};
}

/// What the disks are called in tables, and in the summary.
constexpr std::pair<const char*, const char*> kBeside[] = {{"solid fraction", "Phi"}, {"coordination number", "z"}};

/// Means over samples at rest, with their standard errors.
std::vector<RunValue> values_of(const report::RunData& run) {
  std::vector<RunValue> out;
  for (const auto& [name, key] : kBeside) {
    const auto powder = run.summary_as<PowderSummary>();
    const auto one = powder.statistics.is_object() && run.kind() == "cohesive-powder" ? powder.statistics.find(key)
                                                                                      : powder.statistics.end();
    if (one != powder.statistics.end()) {
      QuantityMean m = record_of<QuantityMean>(*one);
      if (m.samples > 1) m.error = m.deviation / std::sqrt(static_cast<double>(m.samples));
      out.push_back({name, "", m.mean, m.error});
    }
    for (const VariantEntry& v : run.summary_as<PowderVariantsSummary>().variants)
      if (const QuantityMean m = v.ours(key); m.samples > 0)
        out.push_back({fmt::format("{} ({})", name, v.name), "", m.mean, m.error});
  }
  return out;
}

NextSteps next_of(const report::RunData& run) {
  return {
      "How sure the means are: more samples (`--set samples=8`); what they depend on: `softgrain sweep SCENE.toml "
      "--over contact.mu=0.1,0.3,0.5`.",
      "Packings with their forces elsewhere: `softgrain export " + run.directory + " --to vtp`."};
}

}  // namespace

KindResults powder_results() {
  return {.files = {{.names = "powder\\.h5",
                     .is = [](const h5::Group& root) { return root.has("sample_0") && root.has("spec"); },
                     .check = check_powder_file,
                     .visit = visit_powder}},
          .sections = {{Part::states, report::powder_variants_section}, {Part::states, report::powder_section}},
          .lines = lines_of,
          .values = values_of,
          .next = next_of};
}

}  // namespace softgrain
