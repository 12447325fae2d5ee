// Elastic normal impacts, Chung and Ooi tests 1 and 2 (tests/reference/scenes/two_spheres, sphere_on_rigid_plane).
#pragma once

#include <string>
#include <vector>

#include "tests/verification/cases/closed_forms.h"

namespace softgrain::verification {

/// One of the two published impacts.
struct ImpactCase {
  std::string name;
  std::string scene;          ///< file in tests/reference/scenes
  std::string data;           ///< beginning of the files in tests/reference/chung_ooi
  int axis = 0;               ///< along which particle 0 comes in
  double onset = 0.0;         ///< time at which the bodies touch [s]
  double speed = 0.0;         ///< of approach of the two bodies [m/s]
  ImpactNumbers published;    ///< closed form as printed
  ImpactNumbers closed_form;  ///< computed here, all digits
};

ImpactCase two_spheres();
ImpactCase sphere_on_rigid_plane();

/// What a run with `steps_per_contact` steps per duration of the impact gave.
struct ImpactErrors {
  double steps_per_contact = 0.0;
  ImpactNumbers here;
  ImpactNumbers relative;           ///< here over closed form, minus 1
  double relative_restitution = 0;  ///< rebound over approach speed, minus 1
};
ImpactErrors run_impact(const ImpactCase& which, double steps_per_contact);

/// Force on particle 0 from the change of its velocity, and the overlap, at every step of a run with 400 steps.
struct ImpactCurve {
  std::vector<double> time;     ///< since the bodies touched [s]
  std::vector<double> overlap;  ///< [m]
  std::vector<double> force;    ///< [N]
};
ImpactCurve impact_curve(const ImpactCase& which);

/// Points read off a figure: time [s] or overlap [m], and force [N].
struct DigitisedCurve {
  std::vector<double> x;
  std::vector<double> force;
};
DigitisedCurve digitised_over_time(const ImpactCase& which);
DigitisedCurve digitised_over_overlap(const ImpactCase& which);

/// Largest and root mean square distance between force of a curve and digitised points, over the largest force.
struct CurveDistance {
  double largest = 0.0;
  double rms = 0.0;
};
CurveDistance distance_over_time(const ImpactCase& which);
CurveDistance distance_over_overlap(const ImpactCase& which);

}  // namespace softgrain::verification
