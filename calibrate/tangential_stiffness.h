// From forces under rotation to tangential stiffness kt [N/m], one soft particle at one normal overlap.
#pragma once

#include <optional>
#include <vector>

#include "common/data/measurements.h"

namespace softgrain {

/// ht = pi Rs alpha / 180 [m]: displacement of the grains at the shell when the particle turns by alpha degrees
/// [SP 1.4].
double tangential_displacement(double angle_deg, double shell_radius);

/// Slope of the parallel force at ht = 0: least-squares line with a free intercept (prestrain) through the converged
/// points with |angle| <= angle_deg [N/m]. Empty with fewer than two different angles.
std::optional<double> initial_slope(const std::vector<TangentialPoint>& points, double angle_deg, double shell_radius);

/// (F(+angle) - F(-angle)) / (2 ht); with one sign only, against the state before rotation, which takes the prestrain
/// out as well [N/m]. Empty when the points are missing or not converged.
std::optional<double> secant(const std::vector<TangentialPoint>& points, double angle_deg, double shell_radius);

}  // namespace softgrain
