// A ball that bounces with restitution, and the energy of two elastic balls between planes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace softgrain::verification {

inline constexpr double kBounceRestitution = 0.8;
inline constexpr double kDropHeight = 0.1;  ///< of the lowest point of the ball [m]

/// One flight after the other: apex over kDropHeight, and duration over that of the fall and rise before the first.
struct Bounce {
  double height = 0.0;
  double duration = 0.0;
};
/// Flights after the first, second... bounce. Closed form of short contacts: e^(2n) and e^n.
std::vector<Bounce> run_bounces(std::size_t count);
/// The same from the equation of one contact with the weight in it, solved apart (Runge-Kutta, 20,000 steps a contact).
std::vector<Bounce> bounces_with_weight(std::size_t count);
std::string bounce_scene(std::size_t count);

/// How two elastic balls between two planes move.
enum class PairMotion {
  pressed,   ///< always in contact, oscillating
  colliding  ///< with gaps: impacts of the balls on each other and on the planes
};

/// Relative error of kinetic and Hertz energy (2/5 F h per contact) along a run.
struct EnergyCourse {
  std::vector<double> time;   ///< over the duration of an impact at the speed of the balls
  std::vector<double> error;  ///< energy over its first value, minus 1
  double rms = 0.0;
  double largest = 0.0;
  double drift = 0.0;  ///< of a straight line through the errors, over the whole run
};
/// `impacts` durations long, with `steps_per_impact` steps each.
EnergyCourse run_pair(PairMotion motion, int steps_per_impact, int impacts);

}  // namespace softgrain::verification
