// Models without bodies of their own: the equation of state at the mean density.
#include <algorithm>
#include <cmath>

#include "common/core/limits.h"
#include "macrosim/body_contacts.h"
#include "macrosim/cell_specimen.h"
#include "pipelines/kinds/material_models/models.h"

namespace softgrain {

namespace {

/// Argument x of the equation of state K x^n for a mixture with this solid fraction.
double state_of(const CellCard& card, double solid_fraction, double onset) {
  if (card.form == StateForm::porosity) return (solid_fraction - onset) / (1.0 - onset);
  return 1.0 - (1.0 / solid_fraction - 1.0) / (1.0 / onset - 1.0);
}

double pressure_at(const CellCard& card, double state) {
  return state > 0.0 ? card.modulus.value * std::pow(state, card.exponent.value) : 0.0;
}

/// Where the mixture jams that bears `pressure` over E at this solid fraction.
double onset_of(const CellCard& card, double solid_fraction, double pressure) {
  const double state = std::pow(pressure / card.modulus.value, 1.0 / card.exponent.value);
  if (card.form == StateForm::porosity) return (solid_fraction - state) / (1.0 - state);
  return 1.0 / (1.0 + (1.0 / solid_fraction - 1.0) / (1.0 - state));
}

double solid_fraction_at(const MacroCurve& c, std::size_t point) {
  const double at_start = c.more.at(kSolidFraction).front();
  return at_start / ((1.0 - c.strain_x[point]) * (1.0 - c.strain_y[point]) * (1.0 - c.strain_z[point]));
}

}  // namespace

double onset_by_card(const CellCard& card, double share) {
  const FinesLaw law = fines_law_of(card, 1.0);
  const double coarse = 1.0 - share;
  const double pores = law.void_ratio * share + (coarse > 0.0 ? law.excess.volume(share, coarse) : 0.0);
  return 1.0 / (1.0 + pores);
}

MacroCurve mean_field(const CellCard& card, const MacroCurve& truth, double pressure, double onset) {
  MacroCurve out = truth;
  out.more.clear();
  out.cost = {};
  out.note.clear();
  out.usable = true;
  out.bodies = 0;
  const double e = truth.start.youngs_modulus;
  if (std::isnan(onset)) onset = onset_of(card, truth.more.at(kSolidFraction).front(), pressure);
  for (std::size_t k = 0; k < truth.strain.size(); ++k) {
    const double p = e * pressure_at(card, state_of(card, solid_fraction_at(truth, k), onset));
    const bool alike = truth.strain_x[k] == truth.strain_z[k];
    const double ratio = alike ? 1.0 : card.lateral_ratio.value;
    out.stress_axial[k] = 3.0 * p / (1.0 + 2.0 * ratio);
    out.stress_lateral[k] = out.stress_x[k] = out.stress_y[k] = ratio * out.stress_axial[k];
    out.more[kSolidFraction].push_back(solid_fraction_at(truth, k));
  }
  return out;
}

void map_by_state(const CellCard& card, const MacroCurve& truth, double pressure, MacroCurve& substitute) {
  const double onset_t = onset_of(card, truth.more.at(kSolidFraction).front(), pressure);
  const double onset_s = onset_of(card, substitute.more.at(kSolidFraction).front(), pressure);
  const std::size_t points = std::min(truth.strain.size(), substitute.strain.size());
  for (std::size_t k = 0; k < points; ++k) {
    const double own = pressure_at(card, state_of(card, solid_fraction_at(substitute, k), onset_s));
    // Along the strain of the substitute, so that both lose the same share of their volume.
    const double phi = truth.more.at(kSolidFraction).front() * solid_fraction_at(substitute, k) /
                       substitute.more.at(kSolidFraction).front();
    const double factor = own > 0.0 ? pressure_at(card, state_of(card, phi, onset_t)) / own : 1.0;
    for (std::vector<double>* column : {&substitute.stress_axial, &substitute.stress_lateral, &substitute.stress_x,
                                        &substitute.stress_y, &substitute.stress_deviator})
      if (k < column->size()) (*column)[k] *= factor;
  }
}

}  // namespace softgrain
