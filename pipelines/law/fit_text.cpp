#include "pipelines/law/fit_text.h"

#include <fmt/format.h>

#include <vector>

#include "common/data/estimate_words.h"

namespace softgrain {

namespace {

std::string threshold_text(const ThresholdPowerLaw& n, double newton) {
  if (n.delta.value > 0.0) return fmt::format("c = {:.3g} N, delta = {}", newton * n.c.value, bracket_text(n.delta));
  const bool known = interval_known(n.delta.low, n.delta.high);
  return "no threshold shows: c and delta are not determined" +
         (known ? fmt::format(" (delta below {:.3g})", n.delta.high) : std::string());
}

}  // namespace

bool is_by_symmetry(const PairLaw& law) {
  return law.points == 0 && has_numbers(law.status) && law.normal.b.value > 0.0;
}

std::string verdict_text(const PairLaw& law) {
  std::string text = to_string(law.kind) + ": " + (is_by_symmetry(law) ? "by symmetry" : to_string(law.status));
  if (!law.reason.empty()) text += " - " + law.reason;
  return text;
}

std::string normal_law_text(const FitReport& report, const SoftParticleSpec& spec) {
  const PairLaw& law = report.law;
  const ThresholdPowerLaw& n = law.normal;
  const double newton = spec.youngs_modulus * spec.shell_radius * spec.shell_radius;
  const std::vector<double> ends{law.delta_max};
  const Band band = law_band(report, LawCurve::normal, ends).front();
  const Estimate force{band.value, 0.0, band.low, band.high};
  return fmt::format("  F = a D^b + c [N]: a = {}, b = {}, {}\n  F({:.3g}) = {} N\n", bracket_text(n.a, newton),
                     bracket_text(n.b), threshold_text(n, newton), band.delta, bracket_text(force, newton));
}

}  // namespace softgrain
