#include "common/core/error.h"
#include "pipelines/macro_stage.h"

namespace softgrain {

namespace {

void read_bodies(const SceneTable& t, MacroSpec& spec) {
  spec.bodies = t.count("bodies", 1, 10000000, spec.bodies);
  spec.soft_share = t.number("soft_share", Unit::none, Range::closed(0.0, 1.0), spec.soft_share);
  spec.exponent = t.number("exponent", Unit::none, Range::above(1.0), spec.exponent);
  spec.solid_radius_max = t.number("solid_radius_max", Unit::length, Range::positive(), spec.solid_radius_max);
  spec.solid_polydispersity =
      t.number("solid_polydispersity", Unit::none, Range::above(1.0), spec.solid_polydispersity);
  spec.soft_radius_max = t.number("soft_radius_max", Unit::length, Range::positive(), spec.soft_radius_max);
  spec.soft_polydispersity = t.number("soft_polydispersity", Unit::none, Range::above(1.0), spec.soft_polydispersity);
  spec.friction = t.number("mu", Unit::none, Range::not_negative(), spec.friction);
  spec.wall_friction = t.number("wall_mu", Unit::none, Range::not_negative(), spec.wall_friction);
  spec.start_pressure = t.number("start_pressure", Unit::none, Range{0.0, 1e-2, true, false}, spec.start_pressure);
}

void read_test(const SceneTable& t, MacroSpec& spec) {
  spec.test = t.choice("test", {"oedometric", "isotropic"}, spec.test);
  spec.strain_end = t.number("strain", Unit::none, Range{0.0, 0.5, true, false}, spec.strain_end);
  spec.steps = t.count("steps", 1, 100000, spec.steps);
  spec.increments_per_step = t.count("increments_per_step", 1, 10000, spec.increments_per_step);
  spec.tolerance = t.number("tolerance", Unit::none, Range{0.0, 1.0, true, false}, spec.tolerance);
  spec.force_floor = t.number("force_floor", Unit::none, Range{0.0, 1e-2, true, false}, spec.force_floor);
  spec.max_passes = t.count("max_passes", 10, 100000000, spec.max_passes);
  spec.kt_secant = t.choice("kt", {"initial", "secant"}, "initial") == "secant";
}

}  // namespace

MacroSetup read_macro_setup(const SceneTable& macro, const SoftParticleSpec& defaults) {
  MacroSetup setup;
  MacroSpec& spec = setup.spec;
  spec.exponent = defaults.exponent;
  spec.solid_radius_max = spec.soft_radius_max = defaults.shell_radius;
  spec.youngs_modulus = defaults.youngs_modulus;
  spec.poisson_ratio = defaults.poisson_ratio;
  spec.friction = defaults.friction;
  spec.density = defaults.density;
  read_bodies(macro, spec);
  read_test(macro, spec);
  setup.samples = macro.count("samples", 1, 10000, 1);
  setup.resolved = macro.flag("resolved", true);
  return setup;
}

}  // namespace softgrain
