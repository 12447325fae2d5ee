// What a test of a macro scene does when: stages, recorded points, increments between them, and when they are at rest.
// One place for all engines.
#pragma once

#include "common/core/vec.h"
#include "macrosim/macro_spec.h"

namespace softgrain {

/// Sets what a stage of a way that goes by strain drives, to this strain (slides(): shear strain). Axes that the way
/// holds by stress are left to the caller.
void drive_by_strain(MacroStage& stage, StageKind way, double strain);

/// A stage that strains by the tolerance and the increments of the spec; its name is that of its kind.
MacroStage short_stage(const MacroSpec& spec, StageKind kind, double strain, std::int64_t steps);

/// The stages of a test: those of the scene, or of a short form: one; of is_shear() with a preload two, the isotropic
/// strain first. "direct-shear" holds the stress along z with which its shear begins.
std::vector<MacroStage> stages_of(const MacroSpec& spec);

/// Number of points that a test records, the unstrained one included.
std::int64_t recorded_points(const MacroSpec& spec);

/// Number of recorded points in the isotropic part of a test that is_shear().
std::int64_t preload_points(const MacroSpec& spec);

/// A recorded point, number 1 to `steps` of its stage; the first one of all is number 0 of the first stage.
struct StagePoint {
  std::int64_t stage = 0;
  std::int64_t number = 0;
};
StagePoint stage_point(const std::vector<MacroStage>& stages, std::int64_t point);

/// The recorded point at which a stage begins.
std::int64_t first_point(const std::vector<MacroStage>& stages, std::int64_t stage);

/// The direction along z of the way that a stage goes or turns back on: -1 where the last stage of a way of its own, up
/// to this one, lengthens z by strain; else 1.
double way_sign(const std::vector<MacroStage>& stages, std::int64_t stage);

/// Nominal strain at a point of a short form, from the start; in shear logarithmic (sliding: shear strain) from the end
/// of the preload, which is recorded at -preload .. 0.
double strain_at(const MacroSpec& spec, std::int64_t point);

/// Strain of the box, as strain_box takes it, in increment n (from 1) of a stage; 0 along axes that go by stress.
Vec3 strain_increment(const MacroStage& stage, std::int64_t n);

/// Shear strain of one increment of a stage, over the height that there is: equal parts.
double shear_increment(const MacroStage& stage);

/// Sum of all shear strains up to a recorded point.
double shear_at(const std::vector<MacroStage>& stages, std::int64_t point);

/// Whether any stage shears by sliding.
bool any_slides(const std::vector<MacroStage>& stages);

/// Stress at the end of increment n of a stage [Pa]: on the straight way from what it was at its start to its target.
/// `starts`: stresses at which the stages up to this one began. 0 along axes that go by strain.
Vec3 stress_at(const MacroStage& stage, std::int64_t n, const std::vector<Vec3>& starts);

/// Stress at which every stage up to that of `point` began, from what was recorded before.
std::vector<Vec3> stage_starts(const std::vector<MacroStage>& stages, const MacroCurve& curve, std::int64_t point);

/// Strain of one increment by stress that nothing but a flowing packing gives: the stress is out of reach.
inline constexpr double kFarthestStrain = 0.3;

/// Stresses asked for count for this at least where a tolerance is relative to them [Pa].
inline double least_stress(const MacroSpec& spec) { return spec.start_pressure * spec.youngs_modulus; }

/// Relative tolerance of the stresses of a stage: of the largest asked for, or least_stress() where that is larger.
inline double stress_tolerance(const MacroStage& stage) { return stage.tolerance / 3.0; }

/// The mean contact force never counts for less in a test [N]; `largest_radius` of the bodies [m].
double test_force_floor(const MacroSpec& spec, double largest_radius);

/// A test whose strains, and stresses to go to, differ from those of `spec` in their twelfth digit. Paths of grains are
/// chaotic: where contacts slide and open, two such runs part, and no run is more certain than that.
MacroSpec slightly_changed(MacroSpec spec);

}  // namespace softgrain
