// Derivatives of residuals by differences, for models without an exact Jacobian.
#pragma once

#include "calibrate/least_squares.h"

namespace softgrain {

/// dr/dp by central differences whose step is shrunk and extrapolated to zero until the error estimate grows
/// (Ridders 1982, Advances in Engineering Software 4, 75). About ten digits for smooth models. False where r is
/// undefined.
bool ridders_jacobian(const ResidualFunction& evaluate, std::size_t residuals, std::span<const double> parameters,
                      std::span<double> jacobian);

}  // namespace softgrain
