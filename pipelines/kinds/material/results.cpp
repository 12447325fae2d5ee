#include "pipelines/kinds/material/results.h"

#include <fmt/format.h>

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
    std::string text = fmt::format("{} grains, largest over smallest {}; solid fraction {} at the start",
                                   format_count(v.grains), format_number(v.size_ratio, 3),
                                   format_with_error(v.solid_fraction_start->mean, v.solid_fraction_start->error));
    if (last.axial_end)
      text += fmt::format(", axial stress {} E at the end of {}",
                          format_with_error(last.axial_end->mean / summary.youngs_modulus,
                                            last.axial_end->error / summary.youngs_modulus),
                          last.record.name);
    lines.emplace_back(v.name == "material" ? "Material" : "Material " + v.name, text + ".");
  }
  if (lines.size() > 4) return {{"Material", fmt::format("{} variants.", lines.size())}};
  return lines;
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
          .sections = {{Place::material, material_section}},
          .lines = lines_of};
}

}  // namespace softgrain
