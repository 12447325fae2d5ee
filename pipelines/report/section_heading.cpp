// What was run and what came out, in a few lines.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "common/core/error.h"
#include "pipelines/compare/compare.h"
#include "pipelines/compare/statistics.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/plot_helpers.h"
#include "pipelines/report/sections.h"

namespace softgrain::report {
namespace {

std::string status_of(const RunData& run) {
  const std::string status = find_text(run.summary, "status");
  return status.empty() ? "no summary" : status;
}

std::string title_line(const RunData& run) {
  const std::string name = std::filesystem::weakly_canonical(run.directory).filename().string();
  const std::string command = find_text(run.summary, "command");
  const std::string status = status_of(run);
  return "<h1>" + escape((command.empty() ? "softgrain" : "softgrain " + command) + ": " + name) +
         " <span class=\"status status-" + (status == "good" ? "good" : "bad") + "\">" + escape(status) +
         "</span></h1>\n";
}

std::string material_line(const SoftParticleSpec& s) {
  return fmt::format(
      "Soft particle: shell radius Rs = {} mm, grains with E = {} MPa, nu = {}, mu = {}; radii ~ r^-{} over a factor "
      "{}, largest {} Rs.",
      format_number(1e3 * s.shell_radius), format_number(1e-6 * s.youngs_modulus), format_number(s.poisson_ratio),
      format_number(s.friction), format_number(s.exponent), format_number(s.polydispersity),
      format_number(s.rmax_over_shell));
}

std::string measured_line(const Measurements& data) {
  std::size_t points = 0;
  std::vector<double> fraction;
  for (const PackingRun& r : data.runs) points += r.normal.size() + r.tangential.size();
  for (const PackingInfo& p : data.packings) fraction.push_back(p.solid_fraction);
  const MeanError m = mean_error(fraction);
  return fmt::format("Measured: {} packings at solid fraction {}, {} relaxed states.", data.packings.size(),
                     format_with_error(m.mean, m.error), format_count(static_cast<std::int64_t>(points)));
}

std::string law_line(const PairLaw& law, const SoftParticleSpec& spec) {
  if (law.status != "good" || !has_part(law, LawPart::normal))
    return fmt::format("Law, {}: {}{}", to_string(law.kind), law.status, law.reason.empty() ? "." : ": " + law.reason);
  const double force = spec.youngs_modulus * spec.shell_radius * spec.shell_radius;
  const ThresholdPowerLaw& n = law.normal;
  return fmt::format("Law, {}: Fn = a Δ^b + c above δ, with a = {} N, b = {}, c = {} N, δ = {} (Δ up to {}).",
                     to_string(law.kind), format_with_error(n.a.value * force, n.a.standard_error * force),
                     format_with_error(n.b.value, n.b.standard_error), format_number(n.c.value * force, 2),
                     format_with_error(n.delta.value, n.delta.standard_error), format_number(law.delta_max));
}

std::string macro_line(const std::vector<MacroCurve>& macro) {
  const auto laws = curves_of(macro, "law");
  const auto twins = curves_of(macro, "shelled");
  if (laws.empty() || twins.empty()) return fmt::format("Macro: {} curves.", macro.size());
  try {
    const Comparison c = compare_curves(laws, twins);
    return fmt::format(
        "Macro: stress of the law differs from the resolved twin by {} % ({} samples); {} times fewer contact "
        "evaluations, {} times faster.",
        format_with_error(100 * c.axial_difference.mean, 100 * c.axial_difference.error), c.samples.size(),
        format_number(c.speedup_contact_evaluations, 3), format_number(c.speedup_seconds, 3));
  } catch (const BadInput& error) {
    return std::string("Macro: ") + error.what();
  }
}

}  // namespace

std::string heading_section(const RunData& run) {
  std::string lines;
  if (run.measurements || run.card)
    lines += paragraph(material_line(run.measurements ? run.measurements->spec : run.card->spec));
  if (run.measurements) lines += paragraph(measured_line(*run.measurements));
  if (run.card) {
    for (const PairLaw& law : run.card->pairs) lines += paragraph(law_line(law, run.card->spec));
  }
  if (!run.macro.empty()) lines += paragraph(macro_line(run.macro));
  if (const auto* particles = find_value(run.summary, "particles"); particles != nullptr && particles->is_array()) {
    lines += paragraph(fmt::format("Scene of {} explicit particles.", particles->size()));
  }
  for (const GrainBoxResult& r : run.grain_boxes) {
    const auto points = r.points_of(BoxPhase::loading);
    if (points.empty() || run.grain_boxes.size() > 3) continue;
    lines += paragraph(fmt::format("Pack {}: {} grains, {} loading to a confining stress of {} MPa; {} states.",
                                   r.spec.name, format_count(r.spec.grains), r.spec.loading.test,
                                   format_number(points.back()->pressure * 1e-6, 4), r.state.points.size()));
  }
  if (run.grain_boxes.size() > 3) lines += paragraph(fmt::format("{} packs of grains.", run.grain_boxes.size()));
  return title_line(run) + "<div class=\"lead\">\n" + lines + "</div>\n";
}

}  // namespace softgrain::report
