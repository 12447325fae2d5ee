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
    for (const PairLaw& law : run.card->pairs) lines.emplace_back("Single-contact law", law_line(law, run.card->spec));
  return lines;
}

/// Measured forces of the relaxation that the law comes from.
ValuesByDelta measured_forces(const RunData& run, PairKind kind) {
  const std::string relaxation = run.relaxation(kind);
  return relaxation.empty() ? ValuesByDelta{} : normal_forces(runs_of(*run.measurements, kind, relaxation));
}

std::vector<double> of_packings(const std::map<std::int64_t, double>& by_packing) {
  std::vector<double> out;
  for (const auto& [ignored, value] : by_packing) out.push_back(value);
  return out;
}

/// The force at the largest overlap, and where it begins.
std::vector<RunValue> values_of(const RunData& run) {
  std::vector<RunValue> out;
  for (const PairKind kind : kPairKinds) {
    const ValuesByDelta forces = measured_forces(run, kind);
    if (!forces.empty()) {
      const MeanError m = mean_error(of_packings(forces.rbegin()->second));
      out.push_back({fmt::format("Fn at Delta = {:g} ({})", key_delta(forces.rbegin()->first), to_string(kind)), "N",
                     m.mean, m.error});
    }
    if (const PairLaw* law = run.law(kind))
      out.push_back({fmt::format("threshold delta ({})", to_string(kind)), "", law->normal.delta.value,
                     law->normal.delta.standard_error});
  }
  return out;
}

std::vector<RunCurve> curves_of_run(const RunData& run) {
  std::vector<RunCurve> out;
  for (const PairKind kind : kPairKinds) {
    RunCurve curve{"Normal force", "overlap Delta = hn/Rs", "normal force Fn", "N", to_string(kind), {}, {}};
    for (const auto& [key, by_packing] : measured_forces(run, kind)) {
      curve.x.push_back(key_delta(key));
      curve.y.push_back(mean_error(of_packings(by_packing)).mean);
    }
    if (!curve.x.empty()) out.push_back(std::move(curve));
  }
  return out;
}

NextSteps next_of(const RunData& run) {
  return {
      "Fit a law to it: `softgrain calibrate " + run.directory + "/measurements.h5`.",
      "Whether more packings or overlaps are needed shows in its intervals; other grains: `softgrain sweep SCENE.toml "
      "--over material.mu=0.1,0.3,0.5`."};
}

}  // namespace

KindResults soft_particle_results() {
  return {.files = {{.names = "measurements\\.h5",
                     .is = [](const h5::Group& root) { return root.has("runs") && !root.has("configurations"); },
                     .check = check_measurements_file},
                    {.names = "law\\.h5|states_measurements\\.h5"}},
          .sections = {{Part::measurements, normal_section},
                       {Part::measurements, tangential_section},
                       {Part::measurements, stiffness_section},
                       {Part::methods, relaxations_section}},
          .lines = lines_of,
          .values = values_of,
          .curves = curves_of_run,
          .next = next_of};
}

}  // namespace softgrain
