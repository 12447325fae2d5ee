// What the styles do beside forces of pairs: output without side effects, moving walls, laws from cards, refusals.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <tuple>

#include "common/contact/make_laws.h"
#include "common/contact/soft_contact.h"
#include "common/core/error.h"
#include "macrosim/lammps/words.h"
#include "tests/lammps/in_process.h"
#include "tests/lammps/macro_scene.h"
#include "tests/support/temporary_directory.h"
// After the headers of LAMMPS.
#include "compute.h"
#include "fix.h"
#include "modify.h"

namespace softgrain::test {
namespace {

double fix_value(InProcess& lammps, const char* id, int k) {
  auto* modify = lammps.lammps().modify;
  return modify->fix[modify->find_fix(id)]->compute_vector(k);
}

TEST(Styles, SingleTellsWhatTheContactIsAndChangesNothing) {
  const TemporaryDirectory directory;
  const MacroScene scene = macro_scene(60, true);
  write_scene(scene, directory.path());
  InProcess lammps;
  lammps("shell cd " + directory.path());
  lammps("variable restart equal 0");
  lammps("include head.in");
  lammps("change_box all z scale 0.95 remap");
  lammps("run 20000");
  auto& pair = lammps.pair();
  auto* compute = lammps.lammps().modify->compute[lammps.lammps().modify->find_compute("contacts")];
  compute->compute_local();
  const auto before = pair.store.spring;
  const auto memory = pair.store.memory;
  std::map<std::pair<int, int>, int> local;
  auto& atoms = lammps.atoms();
  std::map<int, int> of_tag;
  for (int i = 0; i < atoms.nlocal; ++i) of_tag[atoms.tag[i]] = i;
  int pairs = 0;
  for (int row = 0; row < compute->size_local_rows; ++row) {
    const double* c = compute->array_local[row];
    if (c[1] < 0.0) continue;
    ++pairs;
    const int i = of_tag[static_cast<int>(c[0])];
    const int j = of_tag[static_cast<int>(c[1])];
    for (const auto& [a, b, sign] : {std::tuple{i, j, 1.0}, std::tuple{j, i, -1.0}}) {
      double factor = 0.0;
      (void)pair.single(a, b, 0, 0, 0.0, 0.0, 0.0, factor);
      const double distance = std::sqrt(c[6] * c[6] + c[7] * c[7] + c[8] * c[8]);
      EXPECT_NEAR(factor * distance, c[2], 1e-12 * c[2]);
      EXPECT_EQ(pair.svector[4], c[2]);
      // Normal and tangential force together are the force on the first body.
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(factor * c[6 + k] * sign + pair.svector[k], sign * c[3 + k], 1e-9 * c[2]);
    }
  }
  EXPECT_GT(pairs, 50);
  EXPECT_EQ(pair.store.spring, before);
  EXPECT_EQ(pair.store.memory, memory);
}

TEST(Styles, APlaneThatMovesCarriesItsBodyAlong) {
  const TemporaryDirectory directory;
  const Material grain{"grain", 2500.0, 5e5, 0.3, false};
  std::ofstream(directory.path() + "/laws.toml")
      << laws_text({{"solid", hertz_law(HertzCoefficients::of(grain, grain, 0.5, 0.05), false)}});
  InProcess lammps;
  lammps("shell cd " + directory.path());
  for (const char* line :
       {"units si", "atom_style sphere", "boundary f f f", "newton off", "comm_modify vel yes", "neighbor 0.001 multi",
        "region box block -1 1 -1 1 -1 1", "create_box 1 box", "create_atoms 1 single 0 0 0.0099",
        "set type 1 diameter 0.02 density 2500", "pair_style softgrain soft none", "pair_coeff * * laws.toml solid",
        "fix floor all softgrain/wall plane 0 0 0 0 0 1 move 0.1 0 0.5 law 1 laws.toml solid",
        "fix move all nve/sphere", "fix weight all gravity 9.81 vector 0 0 -1", "thermo_style custom step f_floor[1]",
        "timestep 5e-6", "run 40000"})
    lammps(line);
  // 0.2 s later the plane is 0.1 m higher and its body rides on it at its speed, under its weight.
  const auto& atoms = lammps.atoms();
  const double weight = 2500.0 * 4.0 / 3.0 * M_PI * 1e-6 * 9.81;
  const double overlap =
      std::pow(weight / (std::sqrt(0.01) * HertzCoefficients::of(grain, grain, 0, 1).inverse_d), 2.0 / 3);
  EXPECT_NEAR(fix_value(lammps, "floor", 0), weight, 1e-3 * weight);
  EXPECT_NEAR(atoms.x[0][2], 0.1 + 0.01 - overlap, 1e-3 * overlap);
  EXPECT_NEAR(atoms.v[0][2], 0.5, 1e-4);
  // Friction takes it along: it rolls with the tangential speed of the plane at the contact.
  EXPECT_NEAR(atoms.v[0][0] - atoms.omega[0][1] * (0.01 - 0.5 * overlap), 0.1, 1e-3);
  EXPECT_GT(atoms.v[0][0], 0.01);
}

TEST(Styles, ALawCardIsReadAsTheProgramReadsIt) {
  const std::string path = SOFTGRAIN_SOURCE_DIR "/results/published/law.toml";
  const LawCard card = load_card(path);
  for (const PairKind kind : {PairKind::soft_solid, PairKind::soft_soft})
    for (const bool secant : {false, true}) {
      const SoftContact ours = make_soft_contact(card, kind, 5e5, 0.3, 0.1, secant);
      const auto theirs = std::get<SoftContact>(
          lammps::law_of_card(path, to_string(kind), {5e5, 0.3, 0.1, secant, ""}, MPI_COMM_WORLD));
      EXPECT_EQ(laws_text({{"law", ours}}), laws_text({{"law", theirs}}));
    }
  EXPECT_THROW((void)lammps::law_of_card(path, "soft", {5e5, 0.3, 0.0, false, ""}, MPI_COMM_WORLD), InputError);
  EXPECT_THROW((void)lammps::law_of_card("no such file", "soft-soft", {}, MPI_COMM_WORLD), IoError);
  EXPECT_THROW((void)lammps::law_of_file(path, "x", MPI_COMM_WORLD), InputError);
}

}  // namespace
}  // namespace softgrain::test
