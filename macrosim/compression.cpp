#include "macrosim/compression.h"

#include <optional>

#include "common/core/cost.h"
#include "common/core/error.h"
#include "common/dynamics/contact_watch.h"
#include "common/dynamics/damped_relaxation.h"
#include "common/dynamics/residual.h"
#include "macrosim/body_contacts.h"
#include "macrosim/pressed_box.h"
#include "macrosim/staged_test.h"
#include "macrosim/twin_places.h"

namespace softgrain {

namespace {

DampedOptions relaxation_options(const MacroSpec& spec, const MacroStage& stage, const MacroSystem& macro) {
  DampedOptions options;
  options.tolerance = stage.tolerance;
  options.max_passes = spec.max_passes;
  options.force_floor = test_force_floor(spec, macro.largest_radius);
  return options;
}

void record_bodies(const MacroSystem& macro, MacroCurve& c) {
  const auto contacts = contact_records(macro.system);
  const auto between = body_contacts(macro, contacts);
  c.fabric.push_back(fabric_anisotropy(macro, contacts));
  c.fabric_bodies.push_back(fabric_anisotropy(macro, between));
  c.coordination_bodies.push_back(body_coordination(macro, between));
  c.body_forces.clear();
  for (const BodyContact& b : between) c.body_forces.push_back(b.normal_force);
}

/// Nobody has gone through a wall; soft particles of a law run against the range of their law.
LawUse watch_bodies(CompressionState& state) {
  MacroCurve& c = state.curve;
  const ContactWatch<3> seen = watch_contacts(state.macro.system);
  if (!seen.behind_planes.empty())
    throw UnusableResult(behind_wall_text(c.engine, seen.behind_planes.front(), c.strain.back()));
  record_law_use(c, seen.laws);
  return c.grains > 0 || c.soft == 0 ? LawUse{} : seen.laws;
}

void record_point(CompressionState& state, const MacroSpec& spec, const MacroStage& stage, std::int64_t number,
                  const RelaxationResult& rest) {
  const System3& s = state.macro.system;
  const Vec3 stress = box_stress(s, state.macro.box);
  const Residual r = residual(s);
  MacroCurve& c = state.curve;
  const Vec3 size = box_high(s, state.macro.box) - box_low(s, state.macro.box);
  record_stress_strain(c, spec, number, size, stress);
  c.stress_axial_contacts.push_back(contact_stress(s, state.macro.box)[2]);
  const auto bodies = static_cast<double>(c.grains > 0 ? s.particles.grains : c.bodies);
  c.coordination.push_back(2.0 * static_cast<double>(r.contacts) / bodies);
  c.residual.push_back(rest.residual);
  record_bodies(state.macro, c);
  if (!spec.splits.empty()) record_grains(state.macro, spec, c);
  note_unrest(c, state.worst, stage);
}

RelaxationResult step_of(MacroSystem& macro, const MacroSpec& spec, const MacroStage& stage, const Vec3& strain,
                         const std::optional<Vec3>& stress) {
  if (macro.dashpots && spec.twin.relaxation == TwinRelaxation::slow_dynamics)
    strain_in_motion(macro, spec, strain);
  else if (strain != Vec3{})
    strain_box(macro.system, macro.box, strain);
  DampedRelaxation<3> relaxation(relaxation_options(spec, stage, macro));
  if (!stress) return relaxation.relax(macro.system);
  if (const auto mean = mean_first(spec, stage, *stress)) {
    DampedOptions options = relaxation_options(spec, stage, macro);
    options.tolerance *= kRoughly;
    PressedBox alike(macro.box, *mean);
    DampedRelaxation<3>(options).relax(macro.system, alike);
  }
  PressedBox pressed(macro.box, box_control(spec, stage, *stress));
  return relaxation.relax(macro.system, pressed);
}

/// Strains the box and relaxes, the box too where it goes by stress; what it cost goes to the curve.
RelaxationResult counted_step(CompressionState& state, const MacroSpec& spec, const MacroStage& stage,
                              const Vec3& strain, const std::optional<Vec3>& stress) {
  const Stopwatch watch;
  const Cost before = state.macro.system.cost;
  MacroSystem& macro = state.macro;
  RelaxationResult rest;
  try {
    rest = step_of(macro, spec, stage, strain, stress);
  } catch (const InputError& e) {  // a cell that has become too small: no fault of the scene
    throw UnusableResult(e.what());
  }
  const Cost& now = macro.system.cost;
  state.curve.cost +=
      {now.loop_passes - before.loop_passes, now.contact_evaluations - before.contact_evaluations, watch.seconds()};
  return rest;
}

struct ContactTest {
  const MacroSpec& spec;
  const PointRecord& also;

  RelaxationResult step(CompressionState& state, const MacroStage& stage, const Vec3& strain,
                        const std::optional<Vec3>& stress) const {
    return counted_step(state, spec, stage, strain, stress);
  }
  void record(CompressionState& state, const MacroStage& stage, std::int64_t number,
              const RelaxationResult& rest) const {
    record_point(state, spec, stage, number, rest);
    if (also) also(state.macro, state.curve);
  }
  static LawUse watch(CompressionState& state) { return watch_bodies(state); }
  static void note_use(CompressionState& state, const LawUse& last) {
    note_law_use(state.curve, last, state.curve.strain.back());
  }
  static bool ended(CompressionState& state) {
    return !state.curve.usable && watch_contacts(state.macro.system).laws.rejected > 0;
  }
};

}  // namespace

MacroCurve begin_curve(const MacroSpec& spec, const MacroPacking& packing, const MacroSystem& macro,
                       const std::string& engine, std::int64_t sample) {
  MacroCurve curve = blank_curve(spec, packing, engine, sample);
  curve.grains = macro.inner_grains;
  return curve;
}

void compress(CompressionState& state, const MacroSpec& spec, const RunControl<CompressionState>& control,
              const PointRecord& also) {
  run_stages(state, spec, ContactTest{spec, also}, control);
}

}  // namespace softgrain
