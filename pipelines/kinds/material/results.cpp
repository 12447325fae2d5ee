#include "pipelines/kinds/material/scene.h"

#include <fmt/format.h>

#include "pipelines/kinds/macro/values.h"
#include "pipelines/kinds/material/summary.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/run_data.h"

namespace softgrain {

namespace {

using namespace report;

std::vector<HeadLine> lines_of(const RunData& run) {
  std::vector<HeadLine> lines;
  const auto summary = run.summary_as<MaterialSummary>();
  for (const MaterialVariantSummary& v : summary.variants) {
    if (v.runs.stages.empty() || !v.solid_fraction_start) continue;
    const StageMeans& last = v.runs.stages.back();
    const double modulus = modulus_of(summary, v);
    std::string text =
        fmt::format("{} grains with E = {} MPa, mu = {:g}, largest over smallest {}; solid fraction {} at the start",
                    format_count(v.grains), format_number(1e-6 * modulus), v.friction, format_number(v.size_ratio, 3),
                    format_with_error(v.solid_fraction_start->mean, v.solid_fraction_start->error));
    if (last.axial_end)
      text += fmt::format(", axial stress {} E at the end of {}",
                          format_with_error(last.axial_end->mean / modulus, last.axial_end->error / modulus),
                          last.record.name);
    lines.emplace_back(v.name == "material" ? "Material" : "Material " + v.name, text + ".");
  }
  if (lines.size() > 4) return {{"Material", fmt::format("{} variants.", lines.size())}};
  return lines;
}

/// Curves of the tests of materials. Summaries of other kinds have variants too, which are left out.
std::vector<NamedCurves> tests_of(const RunData& run) {
  std::vector<NamedCurves> out;
  for (const MaterialVariantSummary& v : run.summary_as<MaterialSummary>().variants) {
    if (v.file.empty()) continue;
    if (const auto* curves = run.file(v.file, load_macro)) out.push_back({v.name, *curves});
  }
  if (out.size() == 1) out.front().name.clear();
  return out;
}

std::vector<RunValue> values_of(const RunData& run) {
  const std::vector<NamedCurves> tests = tests_of(run);
  std::vector<RunValue> out;
  if (tests.empty()) return out;
  for (const MaterialVariantSummary& v : run.summary_as<MaterialSummary>().variants) {
    const std::string of = tests.size() > 1 ? " (" + v.name + ")" : "";
    const auto add = [&](const char* what, const std::optional<MeanError>& m) {
      if (m) out.push_back({what + of, "", m->mean, m->error});
    };
    add("solid fraction at the start", v.solid_fraction_start);
    add("coordination number at the start", v.coordination_start);
  }
  const std::vector<RunValue> stresses = stress_values(tests);
  out.insert(out.begin(), stresses.begin(), stresses.end());
  return out;
}

std::vector<RunCurve> curves_of_run(const RunData& run) { return stress_curves(tests_of(run)); }

NextSteps next_of(const RunData&) {
  return {
      "How far from converged: `softgrain run SCENE.toml --seeds 1..8` for the scatter, `softgrain sweep SCENE.toml "
      "--over grains.count=1000,2000,4000` for the size.",
      "A law of this material for larger spans: `softgrain run pipelines/material_law.toml` with the same [material] "
      "and [grains]; models beside it: `softgrain run pipelines/material_vs_models.toml`."};
}

}  // namespace

std::vector<double> mean_stresses(const MacroCurve& c) {
  std::vector<double> p;
  for (std::size_t k = 0; k < c.strain.size(); ++k)
    p.push_back((c.stress_x[k] + c.stress_y[k] + c.stress_axial[k]) / 3.0);
  return p;
}

KindResults material_results() {
  return {.files = {{.names = "material\\.csv"},
                    {.names = "(material|states_material)(_.+)?\\.h5", .says_so = true},
                    {.names = "lammps-(.+-)?[0-9]+"}},
          .sections = {{Part::tests, material_section}},
          .lines = lines_of,
          .values = values_of,
          .curves = curves_of_run,
          .next = next_of};
}

}  // namespace softgrain
