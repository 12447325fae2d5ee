#include "pipelines/kinds/material_law/fit.h"

#include <algorithm>
#include <cmath>

#include "calibrate/state_curves.h"
#include "common/core/few_samples.h"
#include "common/core/limits.h"
#include "common/core/statistics.h"
#include "macrosim/body_contacts.h"

namespace softgrain {

namespace {

/// (1 - phi_J)/phi_J of the packing that a test begins with; not a number where nothing tells it.
double void_ratio_at_onset(StateForm form, double modulus, double exponent, const MacroCurve& curve) {
  const auto fraction = curve.more.find(kSolidFraction);
  if (!curve.usable || fraction == curve.more.end() || fraction->second.empty()) return kNaN;
  const double stress = curve.stress_x.front() + curve.stress_y.front() + curve.stress_axial.front();
  const double pressure = std::max(0.0, stress / 3.0 / curve.start.youngs_modulus);
  const double onset = onset_at(form, modulus, exponent, fraction->second.front(), pressure);
  return (1.0 - onset) / onset;
}

}  // namespace

std::optional<Estimate> preparation_factor(StateForm form, double modulus, double exponent,
                                           const std::vector<MacroCurve>& own, const std::vector<MacroCurve>& other) {
  std::vector<double> ratios;
  for (const MacroCurve& a : own) {
    const auto b = std::ranges::find(other, a.sample, &MacroCurve::sample);
    if (b == other.end()) continue;
    const double ratio =
        void_ratio_at_onset(form, modulus, exponent, *b) / void_ratio_at_onset(form, modulus, exponent, a);
    if (std::isfinite(ratio)) ratios.push_back(ratio);
  }
  if (ratios.empty()) return std::nullopt;
  return mean_estimate(mean_error(ratios), 0.0);
}

}  // namespace softgrain
