#include "macrosim/compression.h"

#include <array>
#include <optional>

#include "common/core/cost.h"
#include "common/core/error.h"
#include "common/dynamics/contact_tensors.h"
#include "common/dynamics/contact_watch.h"
#include "common/dynamics/damped_relaxation.h"
#include "common/dynamics/parallel_pass.h"
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
  if (spec.balance == Balance::own_load) {
    const Vec3 stress = box_stress(macro.system, macro.box);
    options.own_stress = (stress[0] + stress[1] + stress[2]) / 3.0;
  }
  return options;
}

/// The tensors of the contacts, beside the axial stresses.
void record_tensors(const MacroSystem& macro, const std::vector<ContactRecord<3>>& contacts,
                    const std::vector<BodyContact>& between, MacroCurve& c) {
  const Matrix<3> stress = contact_stress_tensor(macro.system, macro.box, contacts);
  c.stress_axial_contacts.push_back(stress[2][2]);
  c.stress_xy.push_back(0.5 * (stress[0][1] + stress[1][0]));
  c.stress_xz.push_back(0.5 * (stress[0][2] + stress[2][0]));
  c.stress_yz.push_back(0.5 * (stress[1][2] + stress[2][1]));
  c.stress_asymmetry.push_back(asymmetry(stress));
  const BodyFabric fabric = body_fabric(macro, between);
  constexpr std::array<std::array<int, 2>, 6> kComponents{{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};
  for (std::size_t k = 0; k < kComponents.size(); ++k) {
    const auto [row, column] = kComponents[k];
    c.fabric_tensor[k].push_back(fabric.all[row][column]);
    c.fabric_strong[k].push_back(fabric.strong[row][column]);
  }
}

void record_bodies(const MacroSystem& macro, MacroCurve& c) {
  const auto contacts = contact_records(macro.system);
  const auto between = body_contacts(macro, contacts);
  c.fabric.push_back(fabric_anisotropy(macro, contacts));
  c.fabric_bodies.push_back(fabric_anisotropy(macro, between));
  c.coordination_bodies.push_back(body_coordination(macro, between));
  record_tensors(macro, contacts, between, c);
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

/// Whether increments are strained by dynamics, at a rate, instead of in one stroke.
bool in_motion(const MacroSystem& macro, const MacroSpec& spec) {
  return macro.dashpots && spec.twin.relaxation == TwinRelaxation::slow_dynamics;
}

/// Inertial number of the motion that led to the last point, with the mean stress there; the point itself is at rest.
/// Zero where nothing goes by strain, and where nothing bears yet.
void record_rate(const MacroSystem& macro, const MacroSpec& spec, const MacroStage& stage, MacroCurve& c) {
  if (!in_motion(macro, spec)) return;
  const auto& p = macro.system.particles;
  double diameter = 0.0;
  for (std::size_t u = 0; u < at(p.grains); ++u) diameter += 2.0 * p.sphere[u].r / p.grains;
  const double pressure = (c.stress_x.back() + c.stress_y.back() + c.stress_axial.back()) / 3.0;
  const bool first = c.strain.size() == 1;
  const double rate = first ? 0.0 : straining_rate(macro, spec, strain_increment(stage, 1), shear_increment(stage));
  c.inertial_number.push_back(pressure > 0.0 ? inertial_number(rate, diameter, spec.density, pressure) : 0.0);
}

void record_point(CompressionState& state, const MacroSpec& spec, const MacroStage& stage, std::int64_t number,
                  const RelaxationResult& rest) {
  const System3& s = state.macro.system;
  const Vec3 stress = box_stress(s, state.macro.box);
  const Residual r = residual(s);
  MacroCurve& c = state.curve;
  const Vec3 size = box_high(s, state.macro.box) - box_low(s, state.macro.box);
  record_stress_strain(c, spec, number, size, stress);
  const auto bodies = static_cast<double>(c.grains > 0 ? s.particles.grains : c.bodies);
  c.coordination.push_back(2.0 * static_cast<double>(r.contacts) / bodies);
  c.residual.push_back(rest.residual);
  record_bodies(state.macro, c);
  record_rate(state.macro, spec, stage, c);
  if (!spec.splits.empty()) record_grains(state.macro, spec, c);
  note_unrest(c, state.worst, stage);
}

/// `shear`: strain by which the cell slides, beside the strains of its axes.
RelaxationResult step_of(MacroSystem& macro, const MacroSpec& spec, const MacroStage& stage, const Vec3& strain,
                         double shear, const std::optional<Vec3>& stress) {
  if (in_motion(macro, spec)) {
    strain_in_motion(macro, spec, strain, shear);
  } else {
    if (strain != Vec3{}) strain_box(macro.system, macro.box, strain);
    if (shear != 0.0) shear_cell(macro.system, shear);
  }
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
    // The first point of all is the start at rest.
    const double shear = state.curve.strain.empty() ? 0.0 : shear_increment(stage);
    rest = step_of(macro, spec, stage, strain, shear, stress);
    if (rest.end == RelaxationEnd::converged) keep_largest_volumes(macro.system);
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
