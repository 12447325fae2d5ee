#include "macrosim/compression.h"

#include <chrono>
#include <cmath>

#include "common/core/error.h"
#include "common/dynamics/damped_relaxation.h"
#include "common/dynamics/residual.h"
#include "common/io/interrupt.h"

namespace softgrain {

namespace {

/// Nominal strain of the whole test after increment n of N, as a step from the state before: keeps increments equal in
/// length.
Vec3 increment(const MacroSpec& spec, std::int64_t n, std::int64_t total) {
  const auto at = [&](std::int64_t k) { return spec.strain_end * static_cast<double>(k) / static_cast<double>(total); };
  const double factor = 1.0 - (1.0 - at(n)) / (1.0 - at(n - 1));
  if (spec.test == "isotropic") return {{factor, factor, factor}};
  return {{0.0, 0.0, factor}};
}

double largest_radius(const Particles<3>& p) {
  double r = 0.0;
  for (const auto& s : p.sphere) r = std::max(r, s.r);
  return r;
}

DampedOptions relaxation_options(const MacroSpec& spec, const System3& s) {
  DampedOptions options;
  options.tolerance = spec.tolerance;
  options.max_passes = spec.max_passes;
  const double r = largest_radius(s.particles);
  options.force_floor = spec.force_floor * spec.youngs_modulus * r * r;
  return options;
}

void record(CompressionState& state, const MacroSpec& spec, double strain, const RelaxationResult& rest) {
  const System3& s = state.macro.system;
  const Vec3 wall = wall_stress(s, state.macro.box);
  const Residual r = residual(s);
  MacroCurve& c = state.curve;
  c.strain.push_back(strain);
  c.stress_axial.push_back(wall[2]);
  c.stress_lateral.push_back(0.5 * (wall[0] + wall[1]));
  c.stress_axial_contacts.push_back(contact_stress(s, state.macro.box)[2]);
  const auto bodies = static_cast<double>(c.grains > 0 ? s.particles.grains : c.bodies);
  c.coordination.push_back(2.0 * static_cast<double>(r.contacts) / bodies);
  c.residual.push_back(rest.residual);
  if (rest.end == RelaxationEnd::converged) return;
  c.usable = false;
  c.note = "relaxation " + to_string(rest.end) + " at strain " + std::to_string(strain) + " (residual " +
           std::to_string(rest.residual) + " of the mean contact force, wanted " + std::to_string(spec.tolerance) + ")";
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
  curve.soft_volume_share = packing.soft_volume_share();
  curve.solid_fraction = packing.solid_fraction();
  return curve;
}

void compress(CompressionState& state, const MacroSpec& spec, const CompressionObserver& observer) {
  System3& s = state.macro.system;
  DampedRelaxation<3> relaxation(relaxation_options(spec, s));
  const std::int64_t total = spec.steps * spec.increments_per_step;
  while (static_cast<std::int64_t>(state.curve.strain.size()) <= spec.steps) {
    const auto point = static_cast<std::int64_t>(state.curve.strain.size());
    const auto start = std::chrono::steady_clock::now();
    const Cost before = s.cost;
    RelaxationResult rest;
    if (point == 0) rest = relaxation.relax(s);
    for (std::int64_t k = 0; point > 0 && k < spec.increments_per_step; ++k) {
      strain_box(s, state.macro.box, increment(spec, (point - 1) * spec.increments_per_step + k + 1, total));
      rest = relaxation.relax(s);
    }
    record(state, spec, spec.strain_end * static_cast<double>(point) / static_cast<double>(spec.steps), rest);
    state.curve.cost +=
        {s.cost.loop_passes - before.loop_passes, s.cost.contact_evaluations - before.contact_evaluations,
         std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()};
    observer(state, static_cast<double>(point + 1) / static_cast<double>(spec.steps + 1));
    if (interrupt_requested()) throw Interrupted("stopped by a signal; finished points are saved");
  }
}

}  // namespace softgrain
