// What a test of a macro scene does when: recorded points, strain increments between them, and when they are at rest.
// One place for all engines.
#pragma once

#include "common/core/vec.h"
#include "macrosim/macro_spec.h"

namespace softgrain {

/// Number of points that a test records, the unstrained one included.
std::int64_t recorded_points(const MacroSpec& spec);

/// Of them, those of the isotropic part of a shear test.
std::int64_t preload_points(const MacroSpec& spec);

/// Nominal strain from the start; in shear logarithmic from the end of the preload, which is recorded at -preload .. 0.
double strain_at(const MacroSpec& spec, std::int64_t point);

/// Strain of the box, as strain_box takes it, in increment k (from 1) on the way to recorded point `point` (from 1).
Vec3 strain_increment(const MacroSpec& spec, std::int64_t point, std::int64_t k);

/// The mean contact force never counts for less in a test [N]; `largest_radius` of the bodies [m].
double test_force_floor(const MacroSpec& spec, double largest_radius);

}  // namespace softgrain
