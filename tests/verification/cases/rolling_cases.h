// Balls that start to roll: MFIX DEM04 (tests/reference/scenes/sliding_ball), the same from spin, and a ball on an
// incline.
#pragma once

#include <string>
#include <vector>

namespace softgrain::verification {

/// Moment at which the contact point stops, interpolated between frames, in units of the closed form's scale.
struct EndOfSliding {
  double mu = 0.0;
  double time = 0.0;   ///< t mu g/u0
  double speed = 0.0;  ///< v/u0
  double spin = 0.0;   ///< omega R/u0
};

/// A row of the outside data: closed form and what MFIX gave.
struct PublishedSliding {
  EndOfSliding closed_form;
  EndOfSliding other_code;
};
std::vector<PublishedSliding> published_sliding();

/// A ball pushed without spin: 2/7, 5/7, 5/7. Contact laws of the scene: the linear spring of the file, or Hertz.
enum class RollingLaw { linear, hertz };
EndOfSliding run_pushed_ball(double mu, RollingLaw law);
/// A ball spun without speed, u0 = omega0 R: sliding ends at 2/7, with 2/7 of the speed.
EndOfSliding run_spun_ball(double mu);
/// The text of it, for the program; the last state is well after the end of sliding.
std::string spun_ball_scene(double mu);
inline constexpr double kSpunSpeed = 0.1;    ///< omega0 R [m/s]
inline constexpr double kBallRadius = 5e-4;  ///< [m]

/// Accelerations over g down an incline, in the second half of a run.
struct InclineOutcome {
  double angle = 0.0;         ///< [degrees]
  double acceleration = 0.0;  ///< of the centre
  double surface = 0.0;       ///< of R omega
};
inline constexpr double kInclineFriction = 0.2;
InclineOutcome run_incline(double angle_degrees);
/// Rolls with 5/7 sin while mu >= (2/7) tan; else slides with sin - mu cos and turns with (5/2) mu cos.
InclineOutcome incline_closed_form(double angle_degrees);
/// Angle of tan = 7 mu/2 [degrees].
double steepest_rolling_angle();

}  // namespace softgrain::verification
