// What the styles do beside forces of pairs: output without side effects, moving walls, laws from cards, refusals.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <tuple>

#include "common/contact/make_laws.h"
#include "common/contact/soft_contact.h"
#include "common/core/error.h"
#include "common/io/text_file.h"
#include "macrosim/lammps/words.h"
#include "tests/lammps/in_process.h"
#include "tests/lammps/macro_scene.h"
#include "tests/lammps/run_ranks.h"
#include "tests/support/temporary_directory.h"
// After the headers of LAMMPS.
#include "compute.h"
#include "fix.h"
#include "macrosim/lammps/fix_softgrain_wall.h"
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

/// Lines of a script with one sphere below a lid that comes down, and a file of laws.
std::vector<std::string> lid_script(const TemporaryDirectory& directory) {
  const Material grain{"grain", 2500.0, 5e5, 0.3, false};
  std::ofstream(directory.path() + "/laws.toml")
      << laws_text({{"solid", hertz_law(HertzCoefficients::of(grain, grain, 0.5, 1.0), false)}});
  return {"shell cd " + directory.path(),
          "units si",
          "atom_style sphere",
          "boundary f f f",
          "newton off",
          "comm_modify vel yes",
          "neighbor 0.003 bin",
          "region box block 0 0.1 0 0.1 0 0.1",
          "create_box 1 box",
          "create_atoms 1 single 0.05 0.05 0.02",
          "set type 1 diameter 0.02 density 2500",
          "pair_style softgrain soft none",
          "pair_coeff * * laws.toml solid",
          "fix lid all softgrain/wall plane 0 0 0.03 0 0 -1 move 0 0 -0.1 law 1 laws.toml solid",
          "compute contacts all softgrain/contacts",
          "thermo_style custom step f_lid[1] c_contacts[11]"};
}

/// A plane that moves goes on from where it is when the time step changes.
TEST(Styles, AnotherTimeStepMovesNoPlane) {
  const TemporaryDirectory directory;
  InProcess lammps;
  for (const std::string& line : lid_script(directory)) lammps(line);
  for (const char* line : {"timestep 1e-4", "run 100 post no"}) lammps(line);
  const double force = fix_value(lammps, "lid", 0);
  EXPECT_GT(force, 1.0) << "1 mm into the sphere, which nothing moves";
  for (const char* line : {"timestep 1e-5", "run 0 post no"}) lammps(line);
  EXPECT_DOUBLE_EQ(fix_value(lammps, "lid", 0), force);
  lammps("run 1000 post no");  // another millimetre
  EXPECT_NEAR(fix_value(lammps, "lid", 0), std::pow(2.0, 1.5) * force, 1e-6 * force);
}

/// Springs of a preparation, those with walls too; the sphere is 1 mm into the lid.
TEST(Styles, SpringsOfWallsAreReadByTheirNumber) {
  const TemporaryDirectory directory;
  std::ofstream(directory.path() + "/springs.txt") << "1 springs\n1 -1 1e-5 2e-5 0\n";
  InProcess lammps;
  for (std::string line : lid_script(directory)) {
    if (line.starts_with("pair_style")) line += " springs springs.txt";
    if (line.starts_with("fix lid")) line.replace(line.find("0.03"), 4, "0.029");
    lammps(line);
    if (line.starts_with("atom_style")) lammps("atom_modify map yes");
  }
  lammps("run 0 post no");
  const auto& store = lammps.pair().walls.at(0)->store;
  ASSERT_EQ(store.size(), 1U);
  EXPECT_NEAR(store.spring[0][0], 1e-5, 1e-12);
  EXPECT_NEAR(store.spring[0][1], 2e-5, 1e-12);
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
  std::string text = read_text(path);  // a card without the initial slope
  for (std::size_t at = 0; (at = text.find("[pair.tangential_initial]", at)) != std::string::npos; ++at)
    text.replace(text.find("fitted = true", at), 13, "fitted = false");
  const TemporaryDirectory directory;
  std::ofstream(directory.path() + "/one.toml") << text;
  const auto slope = [&](bool said) {
    return lammps::law_of_card(directory.path() + "/one.toml", "soft-solid", {5e5, 0.3, 0.1, false, "", said},
                               MPI_COMM_WORLD);
  };
  EXPECT_NO_THROW((void)slope(false)) << "the one that it has";
  EXPECT_THROW((void)slope(true), InputError);
  EXPECT_THROW((void)lammps::law_of_card(path, "soft-solid", {5e5, 0.3, 0.1, false, "", false, true}, MPI_COMM_WORLD),
               InputError)
      << "the card has no unloading branch";
  EXPECT_THROW((void)lammps::law_of_card(path, "soft", {5e5, 0.3, 0.0, false, ""}, MPI_COMM_WORLD), InputError);
  EXPECT_THROW((void)lammps::law_of_card("no such file", "soft-soft", {}, MPI_COMM_WORLD), IoError);
  EXPECT_THROW((void)lammps::law_of_file(path, "x", MPI_COMM_WORLD), InputError);
}

/// A script takes the unloading branch of a card or leaves it out, for pairs and for walls.
TEST(Styles, UnloadingOfACardIsSwitchedByItsKeyword) {
  LawCard card = load_card(SOFTGRAIN_SOURCE_DIR "/results/published/law.toml");
  for (PairLaw& law : card.pairs) {
    law.unloading.emplace();
    law.unloading->residual = {0.3, 0.0, 0.3, 0.3};
    law.unloading->exponent = {2.0 + law.normal.b.value, 0.0, 2.0, 9.0};
  }
  const TemporaryDirectory directory;
  save_card(card, directory.path() + "/law.toml");
  const auto ours = [&](bool unloading) {
    const CardLaw law = make_card_law(card, PairKind::soft_solid, 5e5, 0.3, 0.0, false, std::nullopt, unloading);
    return laws_text({{"law", std::visit([](const auto& l) { return AnyLaw(l); }, law)}});
  };
  for (const auto& [words, unloading] :
       {std::pair{"", true}, std::pair{" unloading yes", true}, std::pair{" unloading no", false}}) {
    const std::string of_card = std::string(" card law.toml soft-solid modulus 5e5 friction 0.3 kt initial") + words;
    InProcess lammps;
    for (const std::string& line : lid_script(directory)) {
      if (line.starts_with("pair_style"))
        lammps("pair_style softgrain soft 1");
      else if (line.starts_with("fix lid"))
        lammps("fix lid all softgrain/wall plane 0 0 0.03 0 0 -1 law 1" + of_card);
      else
        lammps(line);
    }
    lammps("run 0 post no");
    EXPECT_EQ(laws_text({{"law", lammps.pair().walls.at(0)->laws.at(0)}}), ours(unloading)) << words;
  }
  EXPECT_NE(ours(true), ours(false));
}

/// Boxes that lean are not strained: lengths alone would change, and the box would be sheared besides.
TEST(Styles, ATiltedBoxIsRelaxedButNotStrained) {
  const TemporaryDirectory directory;
  const std::string path = directory.path();
  std::string script;
  for (std::string line : lid_script(directory)) {
    if (line.starts_with("boundary")) line = "boundary p p p";
    if (line.starts_with("region")) line = "region box prism 0 0.1 0 0.1 0 0.1 0 0.03 0";
    if (!line.starts_with("shell") && !line.starts_with("fix lid") && !line.starts_with("thermo_style"))
      script += line + "\n";
  }
  const auto status_with = [&](const std::string& words, const std::string& strain = "") {
    std::ofstream(path + "/tilted.in") << script << "fix relax all softgrain/relax tolerance 0.01 " << words
                                       << "\nrun 1\n"
                                       << strain << "\nrun 1\n";
    return run_ranks(1, path, "-in tilted.in");
  };
  const auto refused = [&](const std::string& why) {
    return read_text(path + "/screen.txt").find(why) != std::string::npos;
  };
  const std::string strain = "change_box all x scale 0.99 remap";
  EXPECT_EQ(status_with("track_box no", strain), 0) << read_text(path + "/screen.txt");
  EXPECT_NE(status_with("", strain), 0);
  EXPECT_TRUE(refused("a triclinic box has been strained; give track_box no"));
  EXPECT_NE(status_with("stress 10 10 10"), 0);
  EXPECT_TRUE(refused("stress and log_lists need a box with right angles"));
}

}  // namespace
}  // namespace softgrain::test
