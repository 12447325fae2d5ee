// Oblique impact, Chung and Ooi test 4 (tests/reference/scenes/oblique_impact): a sphere of aluminium oxide on a plane.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace softgrain::verification {

/// Tangential laws that a scene can ask for. The linear spring has the duration of the Hertz impact at normal incidence
/// and Mindlin's ratio of stiffnesses, 2 (1 - nu)/(2 - nu).
enum class TangentialOption { mindlin, rescaled, linear };
inline constexpr std::array<TangentialOption, 3> kTangentialOptions{
    TangentialOption::mindlin, TangentialOption::rescaled, TangentialOption::linear};
std::string name_of(TangentialOption option);

/// Published restitution and friction of the contact, radius [m] and speed [m/s].
struct ObliqueNumbers {
  double restitution = 0.98;
  double mu = 0.092;
  double radius = 2.5e-3;
  double speed = 3.9;
};

/// After the impact. The contact point moves with v - omega x R.
struct ObliqueOutcome {
  double incidence = 0.0;               ///< from the normal [degrees]
  double tangential_restitution = 0.0;  ///< tangential speed of the centre, after over before
  double rebound_angle = 0.0;           ///< of the contact point: atan(tangential/normal) [degrees]
  double spin = 0.0;                    ///< omega R over the speed of incidence
  double energy_ratio = 0.0;            ///< kinetic energy after over before
};
ObliqueOutcome run_oblique(double incidence_degrees, TangentialOption option);
/// The scene of it, for the program.
std::string oblique_scene(double incidence_degrees, TangentialOption option);

/// When the contact slides all the time: closed form from the impulse mu (1 + e) v_n alone.
ObliqueOutcome sliding_all_the_time(double incidence_degrees);
/// Incidence from which it does, tan = (7/2) mu (1 + e) [degrees].
double least_sliding_incidence();

/// Rows {incidence, value} read off the figures.
std::vector<std::vector<double>> digitised_restitution();
std::vector<std::vector<double>> digitised_rebound_angle();

/// Sum of the distances to all digitised values over the sum of their sizes, for incidences from `least` degrees on.
struct ObliqueErrors {
  double restitution = 0.0;
  double rebound_angle = 0.0;
};
ObliqueErrors oblique_errors(TangentialOption option, double least_incidence);

/// What others accept of their codes against the same values.
inline constexpr ObliqueErrors kAcceptedByOthers{0.016, 0.025};

}  // namespace softgrain::verification
