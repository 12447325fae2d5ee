#include "macrosim/compression.h"

#include <chrono>
#include <cmath>
#include <numeric>

#include "common/core/error.h"
#include "common/dynamics/contact_watch.h"
#include "common/dynamics/damped_relaxation.h"
#include "common/dynamics/residual.h"
#include "common/io/interrupt.h"
#include "common/state/checkpoint.h"
#include "macrosim/body_contacts.h"

namespace softgrain {

namespace {

/// Recorded points of the isotropic part of a shear test.
std::int64_t preload_points(const MacroSpec& spec) {
  return spec.test == "shear" && spec.preload > 0.0 ? spec.preload_steps : 0;
}

/// Step k of `total` equal ones to the nominal strain `end`, as a share of the length before it.
double nominal_step(double end, std::int64_t k, std::int64_t total) {
  const auto at = [&](std::int64_t n) { return end * static_cast<double>(n) / static_cast<double>(total); };
  return 1.0 - (1.0 - at(k)) / (1.0 - at(k - 1));
}

/// Strain of the box, as strain_box takes it, in increment k (from 1) on the way to recorded point `point` (from 1).
Vec3 increment(const MacroSpec& spec, std::int64_t point, std::int64_t k) {
  const std::int64_t n = (point - 1) * spec.increments_per_step + k;
  const std::int64_t preloading = preload_points(spec) * spec.increments_per_step;
  const std::int64_t total = spec.steps * spec.increments_per_step;
  if (spec.test == "shear") {
    if (n <= preloading) {
      const double factor = nominal_step(spec.preload, n, preloading);
      return {{factor, factor, factor}};
    }
    const double logarithmic = spec.strain_end / static_cast<double>(total);
    return {{-std::expm1(logarithmic), 0.0, -std::expm1(-logarithmic)}};
  }
  const double factor = nominal_step(spec.strain_end, n, total);
  if (spec.test == "isotropic") return {{factor, factor, factor}};
  return {{0.0, 0.0, factor}};
}

double strain_at(const MacroSpec& spec, std::int64_t point) {
  const std::int64_t before = preload_points(spec);
  if (point < before) return -spec.preload * static_cast<double>(before - point) / static_cast<double>(before);
  return spec.strain_end * static_cast<double>(point - before) / static_cast<double>(spec.steps);
}

DampedOptions relaxation_options(const MacroSpec& spec, const MacroSystem& macro) {
  DampedOptions options;
  options.tolerance = spec.tolerance;
  options.max_passes = spec.max_passes;
  options.force_floor = spec.force_floor * spec.youngs_modulus * macro.largest_radius * macro.largest_radius;
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

/// Nobody has gone through a wall; soft particles of a law run against the range of their law (twins have no fitted law
/// and record nothing).
LawUse watch(CompressionState& state) {
  MacroCurve& c = state.curve;
  const ContactWatch<3> seen = watch_contacts(state.macro.system);
  if (seen.behind_planes > 0)
    throw NotUsable("macro run '" + c.engine + "': the centre of body " + std::to_string(seen.behind) +
                    " is behind a wall at strain " + std::to_string(c.strain.back()));
  if (c.grains > 0 || c.soft == 0) return {};
  const LawUse& use = seen.laws;
  c.law_asked.push_back(static_cast<double>(use.asked));
  c.law_beyond.push_back(static_cast<double>(use.beyond));
  c.law_largest.push_back(use.largest);
  return use;
}

/// Over all recorded points; what happens beyond the range is that of `last`.
void note_law_use(MacroCurve& c, const LawUse& last, double strain) {
  LawUse all = last;
  const auto total = [](const std::vector<double>& v) {
    return static_cast<std::int64_t>(std::accumulate(v.begin(), v.end(), 0.0));
  };
  all.asked = total(c.law_asked);
  all.beyond = total(c.law_beyond);
  const std::string text = law_use_text(all);
  if (text.empty()) return;
  if (last.refused > 0) {
    c.usable = false;
    c.note = text + " (strain " + std::to_string(strain) + ")";
  } else if (c.note.empty()) {
    c.note = text;
  }
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
  if (rest.end == RelaxationEnd::converged) return;
  c.usable = false;
  c.note = "relaxation " + to_string(rest.end) + " at strain " + std::to_string(strain) + " (residual " +
           std::to_string(rest.residual) + " of the mean contact force, wanted " + std::to_string(spec.tolerance) + ")";
}

/// Strains the box and relaxes; what it cost goes to the curve.
RelaxationResult counted_step(DampedRelaxation<3>& relaxation, CompressionState& state, const Vec3& strain) {
  const auto start = std::chrono::steady_clock::now();
  const Cost before = state.macro.system.cost;
  if (strain != Vec3{}) strain_box(state.macro.system, state.macro.box, strain);
  const RelaxationResult rest = relaxation.relax(state.macro.system);
  const Cost& now = state.macro.system.cost;
  state.curve.cost += {now.loop_passes - before.loop_passes, now.contact_evaluations - before.contact_evaluations,
                       std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()};
  return rest;
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
  curve.preload = preload_points(spec) > 0 ? spec.preload : 0.0;
  curve.soft_volume_share = packing.soft_volume_share();
  curve.solid_fraction = packing.solid_fraction();
  return curve;
}

std::int64_t recorded_points(const MacroSpec& spec) { return preload_points(spec) + spec.steps + 1; }

void compress(CompressionState& state, const MacroSpec& spec, const CompressionObserver& observer,
              double checkpoint_seconds) {
  DampedRelaxation<3> relaxation(relaxation_options(spec, state.macro));
  const std::int64_t points = recorded_points(spec);
  CheckpointClock due(checkpoint_seconds);
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
      rest = counted_step(relaxation, state, increment(spec, point, state.increments + 1));
      ++state.increments;
      // After the last one the point is recorded, which needs what the relaxation said.
      if (state.increments == spec.increments_per_step || !(interrupt_requested() || due.due())) continue;
      observer(state, share(point));
      stop_if_interrupted("straining; all up to here is saved");
    }
    state.increments = 0;
    record(state, spec, strain_at(spec, point), rest);
    const LawUse use = watch(state);
    const bool last = point + 1 == points;
    if (last || use.refused > 0) note_law_use(state.curve, use, strain_at(spec, point));
    observer(state, share(point + 1));
    if (use.refused > 0) return;
    stop_if_interrupted("straining; all up to here is saved");
  }
}

}  // namespace softgrain
