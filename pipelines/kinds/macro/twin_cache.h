// Resolved twins that later runs need not run again (they know nothing of the law that they are compared with), and the
// keys of what is kept of macro scenes and tests of materials.
#pragma once

#include <functional>
#include <string>

#include "macrosim/macro_spec.h"
#include "pipelines/kinds/macro/stage.h"
#include "pipelines/run/result_cache.h"

namespace softgrain {

/// Raised whenever the same key would give another curve: when contact laws, relaxations, twins or what is recorded
/// change. The test of cached results holds a curve of this number.
inline constexpr int kTwinSchema = 2;
/// The same of tests that slide: since 3 a strain after a slide keeps the lean of the cell.
inline constexpr int kSlidingTwinSchema = 3;

/// The text of all that determines the curve of a twin and the states that are kept of it: where every grain and shell
/// is at the start (`macro`), its springs (`packing`), material, test and motion (`spec`), and what of it is recorded
/// (`setup`). Cost is as it was when it ran.
std::string twin_key(const MacroSpec& spec, const MacroSetup& setup, const MacroPacking& packing,
                     const MacroSystem& macro, const std::string& engine, std::int64_t sample, const std::string& runs);

/// The text of all that determines how a sample, a packing of grains without soft particles, answers its test.
std::string test_key(const MacroSetup& setup, const MacroPacking& packing, std::int64_t sample);

/// Taken from --twin-cache, or run now and kept there; one that is not usable is not kept.
RunOutcome kept_twin(const std::string& key, const Run& run, const std::function<RunOutcome()>& go);

// Every member of what macro scenes and tests of materials are made of, for those keys.

SOFTGRAIN_EVERY_MEMBER(Estimate, value, standard_error, low, high)
SOFTGRAIN_EVERY_MEMBER(CellMemory, dilatancy, critical_pores, strength_slope, strength_range, density_slope,
                       least_state)
SOFTGRAIN_EVERY_MEMBER(CellCorrelation, numbers, matrix)
SOFTGRAIN_EVERY_MEMBER(PreparationFactor, preparation, factor)
SOFTGRAIN_EVERY_MEMBER(CellCard, form, modulus, exponent, void_ratio, excess_alone, excess_many, excess_decay, friction,
                       stiffness, lateral_ratio, memory, correlation, preparations, pressure_low, pressure_high,
                       mixture_high, youngs_modulus, density, poisson_ratio, grain_friction, grain_rolling, preparation,
                       start_pressure, split, fines_ratio, fines_sizes, samples)
SOFTGRAIN_EVERY_MEMBER(CellMatter, card, share, solid_fraction, at_density, preparation)
SOFTGRAIN_EVERY_MEMBER(PreparationProtocol, start_fraction, inertial_number, friction, restitution, coarse_share,
                       first_pressure, tolerance, max_passes)
SOFTGRAIN_EVERY_MEMBER(RollingResistance, friction, stiffness, damping)
SOFTGRAIN_EVERY_MEMBER(AxisDrive, by_stress, value, as_at)
SOFTGRAIN_EVERY_MEMBER(StageRecord, name, kind, way, modulus_stress, by_stress)
SOFTGRAIN_EVERY_MEMBER(MacroStage, record, axis, shear, logarithmic, isotropic, steps, increments_per_step, tolerance)
SOFTGRAIN_EVERY_MEMBER(TwinMotion, relaxation, speed, step_factor, settle_time, restitution)
SOFTGRAIN_EVERY_MEMBER(MacroSpec, boundary, construction, bodies, preparation, protocol, balance, soft_share, exponent,
                       solid_radius_max, solid_polydispersity, soft_radius_max, soft_polydispersity, solid_sizes,
                       soft_sizes, cells, packing_text, solid_fill, youngs_modulus, poisson_ratio, friction,
                       wall_friction, rolling, density, start_pressure, test, splits, stages, modulus_stress,
                       strain_end, preload, preload_steps, steps, increments_per_step, tolerance, force_floor,
                       max_passes, twin, kt_secant, grain_materials)

}  // namespace softgrain
