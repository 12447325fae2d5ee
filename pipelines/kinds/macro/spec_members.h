// Every member of what macro scenes and tests of materials are made of, for the keys of what is kept of them.
#pragma once

#include "macrosim/macro_spec.h"
#include "pipelines/run/key_text.h"

namespace softgrain {

SOFTGRAIN_EVERY_MEMBER(Estimate, value, standard_error, low, high)
SOFTGRAIN_EVERY_MEMBER(CellCard, form, modulus, exponent, void_ratio, excess_alone, excess_many, excess_decay, friction,
                       stiffness, lateral_ratio, pressure_low, pressure_high, mixture_high, youngs_modulus, density,
                       poisson_ratio, grain_friction, preparation, start_pressure, split, fines_ratio, fines_sizes,
                       samples)
SOFTGRAIN_EVERY_MEMBER(CellMatter, card, share, solid_fraction, at_density)
SOFTGRAIN_EVERY_MEMBER(PreparationProtocol, start_fraction, inertial_number, friction, restitution, coarse_share,
                       first_pressure, tolerance, max_passes)
SOFTGRAIN_EVERY_MEMBER(AxisDrive, by_stress, value, as_at)
SOFTGRAIN_EVERY_MEMBER(StageRecord, name, kind, way, modulus_stress, by_stress)
SOFTGRAIN_EVERY_MEMBER(MacroStage, record, axis, logarithmic, isotropic, steps, increments_per_step, tolerance)
SOFTGRAIN_EVERY_MEMBER(TwinMotion, relaxation, speed, step_factor, settle_time, restitution)
SOFTGRAIN_EVERY_MEMBER(MacroSpec, boundary, construction, bodies, preparation, protocol, soft_share, exponent,
                       solid_radius_max, solid_polydispersity, soft_radius_max, soft_polydispersity, solid_sizes,
                       soft_sizes, cells, packing_text, solid_fill, youngs_modulus, poisson_ratio, friction,
                       wall_friction, density, start_pressure, test, splits, stages, modulus_stress, strain_end,
                       preload, preload_steps, steps, increments_per_step, tolerance, force_floor, max_passes, twin,
                       kt_secant)

}  // namespace softgrain
