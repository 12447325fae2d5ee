// Curves of pressure over solid fraction of packings without shells, and the two forms of their equation of state.
#pragma once

#include <string>
#include <vector>

#include "common/data/cell_card.h"

namespace softgrain {

/// One compression of one sample.
struct StateCurve {
  std::string group;             ///< span and preparation: curves of one group share their onset
  double span = 1.0;             ///< largest over smallest radius, >= 1
  std::vector<double> phi;       ///< solid fraction, overlaps counted twice
  std::vector<double> pressure;  ///< p/E at it
  std::vector<double> weight;    ///< weight of the squared residual; empty: all 1
};

/// phi at which a packing with onset phi_J bears p/E = pressure.
double state_phi(StateForm form, double modulus, double exponent, double onset, double pressure);
/// p/E at phi; 0 below the onset.
double state_pressure(StateForm form, double modulus, double exponent, double onset, double phi);

/// Onset phi_J of a packing that bears p/E = pressure at phi.
double onset_at(StateForm form, double modulus, double exponent, double phi, double pressure);

/// How far a packing is beyond its onset: x = (phi - phi_J)/(1 - phi_J) (porosity) or 1 - Vp/Vp_J (pores). In p/E = K
/// x^n packings differ by their onsets alone, so that x at a pressure is that of all of them. Below 0 under the onset.
double state_of_phi(StateForm form, double onset, double phi);
/// phi at x, the inverse.
double phi_of_state(StateForm form, double onset, double state);

/// phi at which a packing bears, and its derivatives.
struct PhiSlopes {
  double value, by_log_modulus, by_exponent, by_onset;
};
PhiSlopes phi_slopes(StateForm form, double log_modulus, double exponent, double onset, double pressure);

/// The points of one sample that bear, by rising pressure.
struct StateSample {
  std::size_t group = 0;
  std::vector<double> log_pressure;
  std::vector<double> pressure;
  std::vector<double> phi;
  std::vector<double> root_weight;
};

struct StateSamples {
  struct Group {
    std::string name;
    double span = 1.0;
    int samples = 0;
    int points = 0;
  };
  std::vector<StateSample> samples;  ///< samples in the order of the curves
  std::vector<Group> groups;         ///< groups by span, then name
  std::size_t points = 0;
  int left_out = 0;  ///< points without pressure
};

/// Throws InputError for fewer than 4 points with pressure in a curve or none ("never bears"), phi outside (0, 1),
/// values that are not finite, spans below 1 or two of them in one group, weights below 0.
StateSamples read_state_curves(const std::vector<StateCurve>& curves);

}  // namespace softgrain
