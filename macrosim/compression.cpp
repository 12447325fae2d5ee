#include "macrosim/compression.h"

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

namespace softgrain {

namespace {

DampedOptions relaxation_options(const MacroSpec& spec, const MacroSystem& macro) {
  DampedOptions options;
  options.tolerance = spec.tolerance;
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

void record(CompressionState& state, const MacroSpec& spec, double strain, const RelaxationResult& rest) {
  const System3& s = state.macro.system;
  const Vec3 wall = wall_stress(s, state.macro.box);
  const Residual r = residual(s);
  MacroCurve& c = state.curve;
  c.strain.push_back(strain);
  c.stress_axial.push_back(wall[2]);
  c.stress_lateral.push_back(0.5 * (wall[0] + wall[1]));
  c.stress_x.push_back(wall[0]);
  c.stress_y.push_back(wall[1]);
  c.stress_deviator.push_back(wall[2] - wall[0]);
  c.stress_axial_contacts.push_back(contact_stress(s, state.macro.box)[2]);
  const auto bodies = static_cast<double>(c.grains > 0 ? s.particles.grains : c.bodies);
  c.coordination.push_back(2.0 * static_cast<double>(r.contacts) / bodies);
  c.residual.push_back(rest.residual);
  record_bodies(state.macro, c);
  note_relaxation(c, rest, strain, spec.tolerance);
}

/// Strains the box and relaxes; what it cost goes to the curve.
RelaxationResult counted_step(DampedRelaxation<3>& relaxation, CompressionState& state, const Vec3& strain) {
  const Stopwatch watch;
  const Cost before = state.macro.system.cost;
  if (strain != Vec3{}) strain_box(state.macro.system, state.macro.box, strain);
  const RelaxationResult rest = relaxation.relax(state.macro.system);
  const Cost& now = state.macro.system.cost;
  state.curve.cost +=
      {now.loop_passes - before.loop_passes, now.contact_evaluations - before.contact_evaluations, watch.seconds()};
  return rest;
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
  return {any ? least->r : 0.0, any ? most->r : 0.0, spec.youngs_modulus, spec.poisson_ratio,
          spec.friction,        spec.wall_friction,  hash_of(packing)};
}

}  // namespace

MacroCurve begin_curve(const MacroSpec& spec, const MacroPacking& packing, const MacroSystem& macro,
                       const std::string& engine, std::int64_t sample) {
  MacroCurve curve;
  curve.engine = engine;
  curve.test = spec.test;
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
  DampedRelaxation<3> relaxation(relaxation_options(spec, state.macro));
  const std::int64_t points = recorded_points(spec);
  RunKeeper keeper(control);
  const auto share = [&](std::int64_t point) {
    const auto way = static_cast<double>(state.increments) / static_cast<double>(spec.increments_per_step);
    return (static_cast<double>(point) + way) / static_cast<double>(points);
  };
  if (!state.curve.usable && watch_contacts(state.macro.system).laws.refused > 0) return;  // had ended here before
  while (static_cast<std::int64_t>(state.curve.strain.size()) < points) {
    const auto point = static_cast<std::int64_t>(state.curve.strain.size());
    RelaxationResult rest;
    if (point == 0) rest = counted_step(relaxation, state, {});
    while (point > 0 && state.increments < spec.increments_per_step) {
      rest = counted_step(relaxation, state, strain_increment(spec, point, state.increments + 1));
      ++state.increments;
      // After the last one the point is recorded, which needs what the relaxation said.
      if (state.increments < spec.increments_per_step) keeper.between_points(state, share(point), kDoing);
    }
    state.increments = 0;
    record(state, spec, strain_at(spec, point), rest);
    const LawUse use = watch(state);
    const bool last = point + 1 == points;
    if (last || use.refused > 0) note_law_use(state.curve, use, strain_at(spec, point));
    keeper.at_point(state, share(point + 1), kDoing);
    if (use.refused > 0) return;
  }
}

}  // namespace softgrain
