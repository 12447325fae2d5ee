// Whether measured forces can be those of a soft particle: wrong units and signs show.
#pragma once

#include <string>
#include <vector>

namespace softgrain {

/// What is not as it should be of forces Fn [N] at overlaps Delta = hn/Rs of a soft particle of radius Rs [m] and
/// grains of Young's modulus E [Pa]; empty: nothing. One sentence each:
/// - tension: most of the force is negative, while compression counts positive;
/// - too stiff: the largest force is above that of a solid sphere of the same radius and modulus on a rigid plane,
///   4/3 E Rs^2 Delta^1.5 (Hertz, nu = 0);
/// - too soft: at Delta above 0.1 it is less than 2e-4 of it; published soft particles have 0.01 to 0.1.
/// Both hint at the unit of force, E or Rs.
std::vector<std::string> implausible_forces(const std::vector<double>& delta, const std::vector<double>& force,
                                            double shell_radius, double youngs_modulus);

}  // namespace softgrain
