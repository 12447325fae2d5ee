#include "pipelines/kinds/soft_particle/results.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/core/statistics.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/plot_helpers.h"
#include "pipelines/report/run_data.h"
#include "pipelines/run/findings.h"

namespace softgrain {

namespace {

using namespace report;

void check_measurements_file(const std::string& path, Findings& out) {
  const Measurements data = load_measurements(path);
  std::size_t open = 0;
  for (const PackingRun& run : data.runs) {
    open += static_cast<std::size_t>(
        std::count_if(run.normal.begin(), run.normal.end(), [](const NormalPoint& p) { return !p.converged; }));
    open += static_cast<std::size_t>(std::count_if(run.tangential.begin(), run.tangential.end(),
                                                   [](const TangentialPoint& p) { return !p.converged; }));
  }
  out.add("kind", "measurements",
          fmt::format("measurements: {} packings, {} runs", data.packings.size(), data.runs.size()));
  if (open > 0) out.warn(fmt::format("{} recorded points did not converge; fits leave them out", open));
}

std::string measured_line(const Measurements& data) {
  std::size_t points = 0;
  std::vector<double> fraction;
  for (const PackingRun& r : data.runs) points += r.normal.size() + r.tangential.size();
  for (const PackingInfo& p : data.packings) fraction.push_back(p.solid_fraction);
  const MeanError m = mean_error(fraction);
  return fmt::format("{} packings at solid fraction {}, {} relaxed states.", data.packings.size(),
                     format_with_error(m.mean, m.error), format_count(static_cast<std::int64_t>(points)));
}

std::string law_line(const PairLaw& law, const SoftParticleSpec& spec) {
  if (law.status != LawStatus::good || !has_part(law, LawPart::normal))
    return fmt::format("{}: {}{}", to_string(law.kind), to_string(law.status),
                       law.reason.empty() ? "." : ": " + law.reason);
  const double force = spec.youngs_modulus * spec.shell_radius * spec.shell_radius;
  const ThresholdPowerLaw& n = law.normal;
  return fmt::format("{}: Fn = a Δ^b + c above δ; a = {} N, b = {}, c = {} N, δ = {}; fitted for Δ = {} to {}.",
                     to_string(law.kind), format_with_error(n.a.value * force, n.a.standard_error * force),
                     format_with_error(n.b.value, n.b.standard_error), format_number(n.c.value * force, 2),
                     format_with_error(n.delta.value, n.delta.standard_error), format_number(law.delta_min),
                     format_number(law.delta_max));
}

std::vector<HeadLine> lines_of(const RunData& run) {
  std::vector<HeadLine> lines;
  if (run.measurements) lines.emplace_back("Measured", measured_line(*run.measurements));
  if (run.card)
    for (const PairLaw& law : run.card->pairs) lines.emplace_back("Law", law_line(law, run.card->spec));
  return lines;
}

}  // namespace

KindResults soft_particle_results() {
  return {.files = {{.names = "measurements\\.h5",
                     .is = [](const h5::Group& root) { return root.has("runs") && !root.has("configurations"); },
                     .check = check_measurements_file},
                    {.names = "law\\.h5|states_measurements\\.h5"}},
          .sections = {{Place::normal, normal_section},
                       {Place::tangential, tangential_section},
                       {Place::stiffness, stiffness_section},
                       {Place::relaxations, relaxations_section}},
          .lines = lines_of};
}

}  // namespace softgrain
