#include "macrosim/compression.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/core/error.h"
#include "common/core/stopwatch.h"
#include "common/dynamics/contact_watch.h"
#include "common/dynamics/damped_relaxation.h"
#include "common/dynamics/residual.h"
#include "common/io/interrupt.h"
#include "common/io/text_file.h"
#include "common/state/checkpoint.h"
#include "macrosim/body_contacts.h"
#include "macrosim/curve_notes.h"
#include "macrosim/grain_record.h"
#include "macrosim/pressed_box.h"

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
LawUse watch(CompressionState& state) {
  MacroCurve& c = state.curve;
  const ContactWatch<3> seen = watch_contacts(state.macro.system);
  if (seen.behind_planes > 0) throw NotUsable(behind_wall_text(c.engine, seen.behind, c.strain.back()));
  record_law_use(c, seen.laws);
  return c.grains > 0 || c.soft == 0 ? LawUse{} : seen.laws;
}

/// How far the box is from its lengths at the start.
void record_strains(const MacroSystem& macro, MacroCurve& c) {
  const Vec3 size = box_high(macro.system, macro.box) - box_low(macro.system, macro.box);
  c.strain_x.push_back(1.0 - size[0] / c.start.size_x);
  c.strain_y.push_back(1.0 - size[1] / c.start.size_y);
  c.strain_z.push_back(1.0 - size[2] / c.start.size_z);
}

void record(CompressionState& state, const MacroSpec& spec, const MacroStage& stage, std::int64_t number,
            const RelaxationResult& rest) {
  const System3& s = state.macro.system;
  const Vec3 stress = box_stress(s, state.macro.box);
  const Residual r = residual(s);
  MacroCurve& c = state.curve;
  record_strains(state.macro, c);
  c.stage.push_back(static_cast<double>(number));
  const bool staged = spec.test == MacroTest::stages;
  const double strain = staged ? c.strain_z.back() : strain_at(spec, static_cast<std::int64_t>(c.strain.size()));
  c.strain.push_back(strain);
  c.stress_axial.push_back(stress[2]);
  c.stress_lateral.push_back(0.5 * (stress[0] + stress[1]));
  c.stress_x.push_back(stress[0]);
  c.stress_y.push_back(stress[1]);
  c.stress_deviator.push_back(stress[2] - stress[0]);
  c.stress_axial_contacts.push_back(contact_stress(s, state.macro.box)[2]);
  const auto bodies = static_cast<double>(c.grains > 0 ? s.particles.grains : c.bodies);
  c.coordination.push_back(2.0 * static_cast<double>(r.contacts) / bodies);
  c.residual.push_back(rest.residual);
  record_bodies(state.macro, c);
  if (!spec.splits.empty()) record_grains(state.macro, spec, c);
  note_relaxation(c, rest, strain, stage.tolerance);
}

BoxControl control_of(const MacroSpec& spec, const MacroStage& stage, const Vec3& stress) {
  BoxControl control;
  for (std::size_t k = 0; k < 3; ++k) control.by_stress[k] = stage.axis[k].by_stress;
  control.stress = stress;
  control.alike = stage.alike;
  control.tolerance = stage.tolerance / 3.0;
  control.least_stress = least_stress(spec);
  control.farthest = kFarthestStrain;
  return control;
}

/// Where every axis goes to its stress, the mean stress comes first, without change of shape: a loose packing that is
/// pressed from all sides at once hardly resists one, and would take any.
void press_alike(MacroSystem& macro, const MacroSpec& spec, const MacroStage& stage, const Vec3& stress) {
  constexpr double kRoughly = 10.0;
  if (stage.alike || !stage.axis[0].by_stress || !stage.axis[1].by_stress || !stage.axis[2].by_stress) return;
  const double mean = (stress[0] + stress[1] + stress[2]) / 3.0;
  BoxControl control = control_of(spec, stage, {{mean, mean, mean}});
  control.alike = true;
  control.tolerance *= kRoughly;
  DampedOptions options = relaxation_options(spec, stage, macro);
  options.tolerance *= kRoughly;
  PressedBox pressed(macro.box, control);
  DampedRelaxation<3>(options).relax(macro.system, pressed);
}

RelaxationResult step_of(MacroSystem& macro, const MacroSpec& spec, const MacroStage& stage, const Vec3& strain,
                         const Vec3& stress) {
  if (strain != Vec3{}) strain_box(macro.system, macro.box, strain);
  DampedRelaxation<3> relaxation(relaxation_options(spec, stage, macro));
  if (!stage.by_stress() || stress == Vec3{}) return relaxation.relax(macro.system);
  press_alike(macro, spec, stage, stress);
  PressedBox pressed(macro.box, control_of(spec, stage, stress));
  return relaxation.relax(macro.system, pressed);
}

/// Strains the box and relaxes, the box too where it goes by stress; what it cost goes to the curve.
RelaxationResult counted_step(CompressionState& state, const MacroSpec& spec, const MacroStage& stage,
                              const Vec3& strain, const Vec3& stress) {
  const Stopwatch watch;
  const Cost before = state.macro.system.cost;
  MacroSystem& macro = state.macro;
  RelaxationResult rest;
  try {
    rest = step_of(macro, spec, stage, strain, stress);
  } catch (const BadInput& e) {  // a cell that has become too small: no fault of the scene
    throw NotUsable(e.what());
  }
  const Cost& now = macro.system.cost;
  state.curve.cost +=
      {now.loop_passes - before.loop_passes, now.contact_evaluations - before.contact_evaluations, watch.seconds()};
  return rest;
}

/// A stress that the packing cannot bear ends the test: what comes after would start from nowhere.
bool out_of_reach(CompressionState& state, const MacroStage& stage, const Vec3& asked, const RelaxationResult& rest) {
  if (!stage.by_stress() || rest.end == RelaxationEnd::converged) return false;
  note_out_of_reach(state.curve, stage, asked);
  return state.over = true;
}

/// Of box and bodies, bit by bit.
std::string hash_of(const MacroPacking& packing) {
  std::string bytes;
  const auto add = [&bytes](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  for (const Vec3& corner : {packing.low, packing.high})
    for (int a = 0; a < 3; ++a) add(corner[a]);
  for (const MacroBody& body : packing.bodies) {
    for (int a = 0; a < 3; ++a) add(body.x[a]);
    add(body.r);
    add(body.soft);
  }
  return short_hash(bytes);
}

MacroStart start_of(const MacroSpec& spec, const MacroPacking& packing) {
  const auto [least, most] = std::minmax_element(packing.bodies.begin(), packing.bodies.end(),
                                                 [](const MacroBody& a, const MacroBody& b) { return a.r < b.r; });
  const bool any = !packing.bodies.empty();
  const Vec3 size = packing.size();
  return {any ? least->r : 0.0,
          any ? most->r : 0.0,
          spec.youngs_modulus,
          spec.poisson_ratio,
          spec.friction,
          spec.wall_friction,
          size[0],
          size[1],
          size[2],
          hash_of(packing)};
}

}  // namespace

MacroCurve begin_curve(const MacroSpec& spec, const MacroPacking& packing, const MacroSystem& macro,
                       const std::string& engine, std::int64_t sample) {
  MacroCurve curve;
  curve.engine = engine;
  curve.test = spec.test;
  curve.boundary = spec.boundary;
  for (const MacroStage& stage : stages_of(spec)) curve.stages.push_back(stage.record);
  curve.sample = sample;
  curve.bodies = static_cast<std::int64_t>(packing.bodies.size());
  curve.soft = packing.soft_count();
  curve.grains = macro.inner_grains;
  curve.start = start_of(spec, packing);
  curve.preload = preload_points(spec) > 0 ? spec.preload : 0.0;
  curve.soft_volume_share = packing.soft_volume_share();
  curve.solid_fraction = packing.solid_fraction();
  curve.preparation = packing.cost;
  return curve;
}

void compress(CompressionState& state, const MacroSpec& spec, const RunControl<CompressionState>& control) {
  constexpr const char* kDoing = "straining; all up to here is saved";
  const std::vector<MacroStage> stages = stages_of(spec);
  const std::int64_t points = recorded_points(spec);
  RunKeeper keeper(control);
  if (state.over) return;
  if (!state.curve.usable && watch_contacts(state.macro.system).laws.refused > 0) return;  // had ended here before
  while (static_cast<std::int64_t>(state.curve.strain.size()) < points) {
    const auto point = static_cast<std::int64_t>(state.curve.strain.size());
    const StagePoint at = stage_point(stages, point);
    const MacroStage& stage = stages[static_cast<std::size_t>(at.stage)];
    const auto share = [&] {
      const auto way = static_cast<double>(state.increments) / static_cast<double>(stage.increments_per_step);
      return (static_cast<double>(point) + way) / static_cast<double>(points);
    };
    RelaxationResult rest;
    Vec3 asked{};
    if (point == 0) rest = counted_step(state, spec, stage, {}, {});
    const auto starts = point > 0 ? stage_starts(stages, state.curve, point) : std::vector<Vec3>{};
    while (point > 0 && state.increments < stage.increments_per_step) {
      const std::int64_t n = (at.number - 1) * stage.increments_per_step + state.increments + 1;
      asked = stress_at(stage, n, starts);
      rest = counted_step(state, spec, stage, strain_increment(stage, n), asked);
      ++state.increments;
      if (stage.by_stress() && rest.end != RelaxationEnd::converged) break;
      // After the last one the point is recorded, which needs what the relaxation said.
      if (state.increments < stage.increments_per_step) keeper.between_points(state, share(), kDoing);
    }
    state.increments = 0;
    record(state, spec, stage, at.stage, rest);
    const LawUse use = watch(state);
    const bool over = point > 0 && out_of_reach(state, stage, asked, rest);
    const bool last = point + 1 == points || over;
    if (last || use.refused > 0) note_law_use(state.curve, use, state.curve.strain.back());
    keeper.at_point(state, static_cast<double>(point + 1) / static_cast<double>(points), kDoing);
    if (use.refused > 0 || over) return;
  }
}

}  // namespace softgrain
