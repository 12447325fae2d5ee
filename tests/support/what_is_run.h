// What a run of a scene goes by, as text: everything that its reader makes of it, without what does not count in it.
// Two scenes with the same text are run alike.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "macrosim/test_protocol.h"
#include "microsim/particles/particles_scene.h"
#include "pipelines/kinds/cohesive_powder/variants.h"
#include "pipelines/kinds/grain_box/scene.h"
#include "pipelines/kinds/hierarchy/scene.h"
#include "pipelines/kinds/inverse/scene.h"
#include "pipelines/kinds/kinds.h"
#include "pipelines/kinds/law_table/scene.h"
#include "pipelines/kinds/macro_comparison/scene.h"
#include "pipelines/kinds/material_law/scene.h"
#include "pipelines/kinds/material_models/scene.h"
#include "pipelines/kinds/pipeline/scene.h"
#include "pipelines/kinds/recipe/scene.h"
#include "tests/support/fingerprint.h"

namespace softgrain::test {

/// The test is its stages, however they are said.
inline void tell(Fingerprint& f, const MacroSpec& spec) {
  MacroSpec rest = spec;
  f(stages_of(spec));
  rest.stages.clear();
  rest.strain_end = rest.preload = rest.tolerance = 0.0;
  rest.preload_steps = rest.steps = rest.increments_per_step = 0;
  if (spec.construction == Construction::mixed) rest.solid_fill = 0.0;
  if (spec.preparation == Preparation::lammps) rest.protocol = PreparationProtocol{spec.protocol.start_fraction};
  f.plain(rest);
}

/// Which keys were given is bookkeeping; where there are no twins or bands nothing is said of them.
inline void tell(Fingerprint& f, const MacroSetup& setup) {
  MacroSetup rest = setup;
  rest.said.clear();
  if (setup.twins.empty()) rest.spec.twin = {};
  if (setup.bands == 0) rest.band_estimator = BandEstimator::components;
  if (setup.given) {  // nothing is drawn or prepared
    rest.spec.protocol = {};
    rest.spec.bodies = 0;
    rest.spec.solid_fill = rest.spec.start_pressure = 0.0;
  }
  f.plain(rest);
}

inline void tell(Fingerprint& f, const MeasurementPlan& plan) {
  MeasurementPlan rest = plan;
  if (plan.angles_deg.empty()) {
    rest = {};
    rest.deltas = plan.deltas;
  }
  f.plain(rest);
}

/// Protocols of relaxations that no series has are not asked.
inline void tell(Fingerprint& f, const MeasureSetup& setup) {
  f(setup.spec);
  for (const MeasureSeries& s : setup.series) {
    if (s.relaxation == Relaxation::damped) f(setup.damped);
    if (s.relaxation == Relaxation::published) f(setup.published);
    if (s.relaxation == Relaxation::least_work || s.relaxation == Relaxation::slow_dynamics) f(setup.least_work);
    f(s);
  }
  f(setup.seed);
  f(setup.kept_states);
}

/// Searched members of the soft particle come from the search.
inline void tell(Fingerprint& f, const InverseSetup& setup) {
  InverseSetup rest = setup;
  for (const SearchParameter& p : setup.search) p.set(rest.measure.spec, 0.5 * (p.low + p.high));
  MeasureSeries series;
  series.relaxation = setup.relaxation;
  rest.measure.series = {series};
  f.plain(rest);
}

inline void tell(Fingerprint& f, const PowderSpec& spec) {
  PowderSpec rest = spec;
  if (!spec.rolling) rest.rolling_stiffness = rest.rolling_friction = 0.0;
  f.plain(rest);
}

inline void tell(Fingerprint& f, const PowderStructureOptions& o) {
  PowderStructureOptions rest = o;
  if (!o.scattering) rest.fit_k_max = 0.0;
  if (!o.scattering && !o.holes) rest.mesh = 0.0;
  f.plain(rest);
}

inline void tell(Fingerprint& f, const PowderVariant& v) {
  f(v.name);
  f(v.picked);
  f(v.setup);
  f(v.published);
}

/// Materials count by the laws and masses that were made of them.
template <int D>
void tell(Fingerprint& f, const System<D>& s) {
  for (const Material& m : s.materials) f(m.name);
  f(s.laws);
  f(s.particles);
  f(s.cell);
  f(s.gravity);
}

/// Without the text of the scene.
template <int D>
void tell(Fingerprint& f, const ParticlesSceneOf<D>& s) {
  ParticlesSceneOf<D> rest = s;
  rest.text.clear();
  f.plain(rest);
}

/// Without files' texts, which are in what was read of them.
inline void tell(Fingerprint& f, const LawSources& law) {
  LawSources rest = law;
  for (FittedLaw& one : rest.laws) one.text.clear();
  if (law.table() == nullptr) rest.range = RangePolicy::reject;
  f.plain(rest);
}

/// Throws InputError for what the reader of its kind refuses.
inline std::string what_is_run(const Scene& scene) {
  Fingerprint f;
  const std::string kind = kind_of(scene).name;
  if (const auto refuse = kind_of(scene).refuse; refuse != nullptr) refuse(scene, {});
  if (kind == "pipeline")
    f(read_pipeline_setup(scene));
  else if (kind == "macro-comparison")
    f(read_macro_comparison(scene));
  else if (kind == "law-table")
    f(read_law_table(scene));
  else if (kind == "hierarchy")
    f(read_hierarchy_setup(scene));
  else if (kind == "inverse")
    f(read_inverse(scene));
  else if (kind == "soft-particle")
    f(read_soft_particle_scene(scene));
  else if (kind == "grain-box")
    f(read_grain_box(scene));
  else if (kind == "macro")
    f(read_macro_scene(scene, ""));
  else if (kind == "material")
    f(read_material_scene(scene));
  else if (kind == "material-law")
    f(read_material_law_scene(scene));
  else if (kind == "material-models")
    f(read_material_models_scene(scene));
  else if (kind == "recipe")
    f(read_recipe_scene(scene));
  else if (kind == "particles" && particles_dimension(scene) == 3)
    f(read_particles_scene<3>(scene));
  else if (kind == "particles")
    f(read_particles_scene<2>(scene));
  else if (kind == "cohesive-powder" && has_powder_variants(scene))
    f(read_powder_variants(scene));
  else if (kind == "cohesive-powder")
    f(read_powder(scene));
  else
    ADD_FAILURE() << "kind " << kind << " has no place here: give it one";
  return f.text();
}

}  // namespace softgrain::test
