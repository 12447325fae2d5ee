// A small macro scene under the directional multi-contact law, for our engine and as files for LAMMPS.
#pragma once

#include <fmt/format.h>

#include <fstream>
#include <string>
#include <vector>

#include "common/contact/law_set.h"
#include "macrosim/macro_packing.h"
#include "macrosim/macro_system.h"

namespace softgrain::test {

struct MacroScene {
  MacroSpec spec;
  MacroPacking packing;
  SoftLaws laws;

  [[nodiscard]] MacroSystem system() const { return make_law_system(spec, packing, laws, 0.7); }
};

template <bool kUnloading>
SoftLaws directional_laws(const MacroSpec& spec) {
  SoftMultiContact<LawForm::directional, kUnloading> law;
  law.form.pressure = {0.8, 3.0, 0.02};
  law.form.coupling = {0.8, 0.15, 0.1};
  law.partner.log_weight = MonotoneCurve({std::log(0.25), 0.0, std::log(4.0)}, {-0.9, -0.5, -0.1});
  law.partner.exponent = MonotoneCurve({std::log(0.25), 0.0, std::log(4.0)}, {1.3, 1.2, 1.1});
  law.modulus = spec.youngs_modulus;
  law.friction = 0.3;
  law.kt_ratio = 0.4;
  law.unloading = 1.7;
  SoftLaws out;
  out.soft_solid = out.soft_wall = law;
  out.solid_soft = mirrored(law);
  law.partner.exponent = {};
  law.partner.common_exponent = 1.25;
  law.j_is_soft = true;
  out.soft_soft = law;
  return out;
}

inline MacroScene macro_scene(std::int64_t bodies, bool unloading = false) {
  MacroScene out;
  out.spec.bodies = bodies;
  out.spec.solid_radius_max = out.spec.soft_radius_max = 0.016;
  out.spec.wall_friction = 0.2;
  out.spec.protocol.tolerance =
      1e-3;  // roundings grow a hundredfold in twenty passes while bodies rearrange; here few do
  out.packing = make_macro_packing(out.spec, 3, 0);
  out.laws = unloading ? directional_laws<true>(out.spec) : directional_laws<false>(out.spec);
  return out;
}

/// scene.data, laws.toml and head.in (all but the protocol) in a directory; types 1 solid, 2 soft.
inline void write_scene(const MacroScene& scene, const std::string& directory) {
  const MacroPacking& p = scene.packing;
  const Material grain{"grain", scene.spec.density, scene.spec.youngs_modulus, scene.spec.poisson_ratio, false};
  const auto hertz = [&](double friction) {
    return hertz_law(HertzCoefficients::of(grain, grain, friction, 1.0), false);
  };
  std::ofstream(directory + "/laws.toml") << laws_text({{"solid-solid", hertz(scene.spec.friction)},
                                                        {"solid-wall", hertz(scene.spec.wall_friction)},
                                                        {"soft-solid", scene.laws.soft_solid},
                                                        {"soft-soft", scene.laws.soft_soft},
                                                        {"soft-wall", scene.laws.soft_wall}});
  std::ofstream data(directory + "/scene.data");
  data << fmt::format("macro\n\n{} atoms\n2 atom types\n", p.bodies.size());
  for (int k = 0; k < 3; ++k)
    data << fmt::format("{:.17g} {:.17g} {}lo {}hi\n", p.low[k], p.high[k], "xyz"[k], "xyz"[k]);
  data << "\nAtoms # sphere\n\n";
  for (std::size_t k = 0; k < p.bodies.size(); ++k) {
    const MacroBody& b = p.bodies[k];
    data << fmt::format("{} {} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", k + 1, b.soft ? 2 : 1, 2.0 * b.r,
                        scene.spec.density * (b.soft ? 0.7 : 1.0), b.x[0], b.x[1], b.x[2]);
  }
  const double floor = scene.spec.force_floor * scene.spec.youngs_modulus * 0.016 * 0.016;
  std::ofstream(directory + "/head.in") << fmt::format(
      R"(units si
atom_style sphere
boundary f f f
newton off
comm_modify vel yes
neighbor 0.003 multi
neigh_modify every 1 delay 0 check yes
if "${{restart}} == 0" then "read_data scene.data" else "read_restart scene.restart"
pair_style softgrain soft 2
pair_coeff 1 1 laws.toml solid-solid
pair_coeff 1 2 laws.toml soft-solid
pair_coeff 2 2 laws.toml soft-soft
fix walls all softgrain/wall box law 1 laws.toml solid-wall law 2 laws.toml soft-wall
fix relax all softgrain/relax tolerance {:.17g} floor {:.17g} max_passes 20000
compute contacts all softgrain/contacts
thermo_style custom step f_relax f_relax[1] f_relax[3] c_contacts[1] f_walls[6]
thermo 0
)",
      scene.spec.tolerance, floor);
}

}  // namespace softgrain::test
