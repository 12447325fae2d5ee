// Law tables as other commands use them: macro scenes, check; what is wrong is refused with exit status 2.
#include <gtest/gtest.h>

#include <filesystem>

#include "common/io/text_file.h"
#include "tests/support/law_table_files.h"
#include "tests/support/markup_check.h"
#include "tests/support/synthetic_multi_contact.h"
#include "tests/support/tiny_comparison.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
using nlohmann::json;
using synthetic::law_entry;
namespace fs = std::filesystem;

class LawTableUse : public LawTableFiles {};

TEST_F(LawTableUse, MacroScenesTakeTablesAndCards) {
  expect(macro("best", ""), 0, {});
  EXPECT_EQ(summary("best")["law"]["form"], "directional");
  expect(macro("directional", "form = \"directional\"\n"), 0, {});
  expect(macro("isotropic", "form = \"isotropic\"\n"), 0, {});
  expect(macro("pair", "form = \"pair\"\n"), 0, {});
  EXPECT_EQ(summary("pair")["law"]["form"], "pair");
  EXPECT_EQ(end_stress("best"), end_stress("directional"));
  EXPECT_NE(end_stress("isotropic"), end_stress("directional"));
  EXPECT_LT(end_stress("pair"), end_stress("isotropic")) << "a pair law knows nothing of the other contacts";
  const auto curves = load_macro(file("isotropic") + "/macro.h5");
  EXPECT_EQ(curves.at(0).engine, "law");
  EXPECT_EQ(unbalanced_tags(read_text(file("isotropic") + "/report.html")), "");
  expect(macro("card", "", "--law '" + file("law.toml") + "'"), 0, {});
  EXPECT_EQ(summary("card")["law"]["form"], "pair");
  expect(macro("card2", "form = \"pair\"\n", "--law '" + file("law.toml") + "'"), 0, {});
  EXPECT_EQ(end_stress("card"), end_stress("card2"));
}

/// Each contact against the row of the nearest ratio, whatever was measured at the largest one.
TEST_F(LawTableUse, ContactsBeyondTheRangeAreCountedByTheRowOfTheirRatio) {
  const auto warns = [&](const std::string& name, double near, double far) {
    LawTableEntry entry = law_entry(0.70);
    entry.overlap_max = entry.volume_max = 1.9;
    for (MultiContactLaw& law : entry.laws)
      for (PartnerRow& row : law.partners) row.overlap_max = near;
    for (MultiContactLaw& law : entry.laws) {
      PartnerRow solid = law.partners[1];
      PartnerRow soft = law.partners[3];
      solid.ratio = soft.ratio = 1000.0;
      solid.overlap_max = soft.overlap_max = far;
      law.partners.insert(law.partners.begin() + 2, solid);
      law.partners.push_back(soft);
    }
    save_law_table({1, {entry}}, file("law_table.toml"));
    expect(macro(name, ""), 0, {});
    return summary(name).dump().find("deeper at the end than the law was measured") != std::string::npos;
  };
  EXPECT_FALSE(warns("far", 1.9, 1e-9));
  EXPECT_TRUE(warns("near", 1e-9, 1.9));
}

TEST_F(LawTableUse, TheFrictionOfAScene) {
  expect(macro("measured", ""), 0, {});
  expect(macro("smooth", "mu = 0.0\n"), 0, {});
  EXPECT_NE(end_stress("measured"), end_stress("smooth"));
}

/// Shear after a preload: contacts along x retreat, those along z go on.
TEST_F(LawTableUse, TheUnloadingBranchActsOnContactsThatRetreat) {
  const auto shear = [&](const std::string& name, const std::string& lines) {
    expect(macro(name, lines,
                 "--set macro.test=shear --set macro.preload=0.1 --set macro.preload_steps=2 --set macro.steps=4 "
                 "--set macro.strain=0.1 --set macro.bodies=30"),
           0, {});
    return load_macro(file(name) + "/macro.h5").at(0);
  };
  LawTableEntry entry = law_entry(0.70);
  const auto with_unloading = [&](const std::string& name, double unloading) {
    entry.unloading = synthetic::near(unloading);
    save_law_table({1, {entry}}, file("law_table.toml"));
    return shear(name, "unloading = true\n");
  };
  const MacroCurve loading = shear("loading", "");
  const MacroCurve same = with_unloading("same", 1.0);
  const MacroCurve steep = with_unloading("steep", 1.25);
  const MacroCurve steeper = with_unloading("steeper", 1.5);
  for (const MacroCurve* c : {&same, &steep, &steeper}) {
    ASSERT_EQ(c->stress_x.size(), loading.stress_x.size());
    EXPECT_NEAR(c->stress_x.at(2), loading.stress_x.at(2), 0.15 * loading.stress_x.at(2)) << "the preload only loads";
  }
  EXPECT_NEAR(same.stress_x.back(), loading.stress_x.back(), 0.02 * loading.stress_x.at(2));
  EXPECT_LT(steep.stress_x.back(), 0.9 * loading.stress_x.back());
  EXPECT_LT(steeper.stress_x.back(), 0.95 * steep.stress_x.back());
  EXPECT_GT(steeper.stress_x.back(), 0.0);
}

/// Unloading is steeper. While a packing is loaded hardly any particle unloads.
TEST_F(LawTableUse, ParticlesThatRememberUnloadMoreSteeply) {
  const std::string head = "kind = \"macro\"\nlaw = \"law_table.toml\"\nform = \"isotropic\"\n";
  const std::string test =
      "[macro]\nbodies = 16\nresolved = false\n[[stage]]\nkind = \"oedometric\"\nstrain = 0.2\nsteps = 2\n"
      "[[stage]]\nkind = \"unload\"\nstrain = 0.02\nsteps = 2\n[[stage]]\nkind = \"reload\"\nsteps = 2\n";
  const auto curve = [&](const std::string& name, const std::string& lines) {
    write_text_atomic(file("scene.toml"), head + lines + test);
    expect(run_the_program("run '" + file("scene.toml") + "' --quiet --out '" + file(name) + "'"), 0, {});
    return load_macro(file(name) + "/macro.h5").at(0);
  };
  const MacroCurve off = curve("off", "");
  const MacroCurve one = curve("one", "unloading_ratio = 1.0\n");
  const MacroCurve on = curve("on", "unloading_ratio = 1.5\n");
  ASSERT_EQ(on.stress_axial.size(), 7U);
  EXPECT_EQ(one.stress_axial, off.stress_axial);
  EXPECT_EQ(one.law.hash, off.law.hash);
  EXPECT_NE(on.law.hash, off.law.hash);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(on.stress_axial[k], off.stress_axial[k], 0.02 * off.stress_axial[2]);
  EXPECT_GT(off.stress_axial[2], 0.0);
  EXPECT_LT(on.stress_axial[3], 0.97 * off.stress_axial[3]);
  EXPECT_LT(on.stress_axial[4], 0.95 * off.stress_axial[4]);
  EXPECT_NEAR(on.stress_axial[6], off.stress_axial[6], 0.1 * off.stress_axial[6]) << "back where unloading began";
  EXPECT_NE(summary("off").dump().find("has no unloading branch"), std::string::npos);
  EXPECT_EQ(summary("on").dump().find("has no unloading branch"), std::string::npos);
  EXPECT_NE(summary("on").dump().find("unload 1.5 times as steeply as they load"), std::string::npos);
  EXPECT_EQ(summary("one").dump().find("unload 1"), std::string::npos);
}

TEST_F(LawTableUse, AMemoryWhereItCannotBeIsRefused) {
  const std::string ratio = "unloading_ratio = 1.3\n";
  const std::string isotropic = "form = \"isotropic\"\n";
  expect(macro("out", isotropic + "unloading_ratio = 0.9\n"), 2, {"unloading_ratio = 0.9", "from 1 to 3"});
  expect(macro("out", isotropic + "unloading_ratio = 3.1\n"), 2, {"unloading_ratio = 3.1", "from 1 to 3"});
  const std::string alone = "goes with the isotropic form alone: form = \"isotropic\"";
  expect(macro("out", ratio), 2, {"unloading_ratio", alone});  // best: directional
  expect(macro("out", "form = \"pair\"\n" + ratio), 2, {"unloading_ratio", alone});
  expect(macro("out", isotropic + "unloading = true\n" + ratio), 2, {"unloading_ratio", "without unloading = true"});
  expect(macro("out", ratio, "--law '" + file("law.toml") + "'"), 2, {"unloading_ratio", "goes with a law table"});
  expect(macro("out", isotropic + ratio, "--engine lammps --write-only"), 2, {"unloading_ratio", "--engine lammps"});
  LawTableEntry entry = law_entry(0.70);
  entry.best = LawForm::isotropic;
  save_law_table({1, {entry}}, file("law_table.toml"));
  expect(macro("best", ratio), 0, {});
}

TEST_F(LawTableUse, WhatTheTableDidNotMeasureIsRefusedOrSaid) {
  LawTableEntry entry = law_entry(0.70);
  entry.unloading = synthetic::unknown(1.0);
  entry.unloading_measured = false;
  save_law_table({1, {entry}}, file("law_table.toml"));
  expect(macro("out", "unloading = true\n"), 2, {"unloading", "was not measured at solid fraction 0.7000"});
  expect(macro("loading", ""), 0, {});
  EXPECT_EQ(summary("loading")["remarks"].dump().find("not measured"), std::string::npos);
  entry.slide_soft = {synthetic::unknown(0.3), synthetic::unknown(0.3), false};
  save_law_table({1, {entry}}, file("law_table.toml"));
  expect(macro("sliding", ""), 0, {});
  EXPECT_NE(summary("sliding")["remarks"].dump().find("not measured among soft particles (0.30, 0.30 taken instead)"),
            std::string::npos);
  expect(run_the_program("check '" + file("law_table.toml") + "'"), 0,
         {"unloading was not measured", "not measured among soft particles"});
}

TEST_F(LawTableUse, TheMainEntryIsTakenAndTheLawIsNamedEverywhere) {
  LawTableEntry dense = law_entry(0.70);
  dense.packings = 32;
  const LawTableEntry loose = law_entry(0.65, -0.05);
  save_law_table({1, {dense}}, file("dense.toml"));
  save_law_table({1, {loose}}, file("loose.toml"));
  save_law_table({1, {loose, dense}}, file("law_table.toml"));
  expect(macro("dense", "", "--law '" + file("dense.toml") + "'"), 0,
         {"law: directional law at solid fraction 0.7000"});
  expect(macro("loose", "", "--law '" + file("loose.toml") + "'"), 0, {});
  ASSERT_NE(end_stress("dense"), end_stress("loose"));
  expect(macro("main", ""), 0, {});
  EXPECT_EQ(end_stress("main"), end_stress("dense"));
  expect(macro("named", "solid_fraction = 0.65\n"), 0, {});
  EXPECT_EQ(end_stress("named"), end_stress("loose"));
  expect(macro("between", "solid_fraction = 0.68\n"), 0, {});
  EXPECT_GT(end_stress("between"), std::min(end_stress("dense"), end_stress("loose")));
  EXPECT_LT(end_stress("between"), std::max(end_stress("dense"), end_stress("loose")));

  const json law = summary("main")["law"];
  EXPECT_EQ(law["form"], "directional");
  EXPECT_EQ(law["solid_fraction"], 0.7);
  EXPECT_EQ(law["E"], dense.spec.youngs_modulus);
  EXPECT_EQ(law["nu"], dense.spec.poisson_ratio);
  EXPECT_EQ(law["mu"], dense.spec.friction);
  EXPECT_EQ(law["hash"], summary("dense")["law"]["hash"]) << "the same numbers, from another file";
  EXPECT_NE(law["hash"], summary("named")["law"]["hash"]);
  EXPECT_EQ(summary("between")["law"]["solid_fraction"], 0.68);
  const LawIdentity kept = load_macro(file("named") + "/macro.h5").at(0).law;
  EXPECT_EQ(kept.solid_fraction, 0.65);
  EXPECT_EQ(kept.hash, summary("named")["law"]["hash"].get<std::string>());
  const std::string report = read_text(file("named") + "/report.html");
  EXPECT_NE(report.find("directional law at solid fraction 0.6500"), std::string::npos);
  EXPECT_NE(report.find(kept.hash), std::string::npos);
  expect(macro("card", "", "--law '" + file("law.toml") + "'"), 0, {"law: pair law, for grains of nu = 0.3"});
  EXPECT_TRUE(summary("card")["law"]["solid_fraction"].is_null());
}

TEST_F(LawTableUse, ACardOfOtherGrainsIsSaid) {
  const std::string card = "--law '" + file("law.toml") + "' ";
  expect(macro("same", "", card), 0, {});
  EXPECT_EQ(summary("same")["remarks"].dump().find("the law card was measured with"), std::string::npos);
  expect(macro("other", "", card + "--set macro.mu=0.5"), 0, {});
  EXPECT_NE(
      summary("other")["remarks"].dump().find("measured with nu = 0.3, mu = 0.3, the grains of this scene have nu "
                                              "= 0.3, mu = 0.5"),
      std::string::npos);
}

TEST_F(LawTableUse, ASolidFractionThatTheTableDoesNotReachIsRefusedWithItsRange) {
  save_law_table({1, {law_entry(0.65, -0.05), law_entry(0.70)}}, file("law_table.toml"));
  const std::vector<std::string> words{"scene.toml:", "solid_fraction", "0.650 to 0.700", "clamp"};
  expect(macro("out", "solid_fraction = 0.71\n"), 2, words);
  expect(macro("out", "solid_fraction = 0.6\n"), 2, words);
  EXPECT_FALSE(fs::exists(file("out") + "/macro.h5"));
  expect(run_the_program("check '" + file("scene.toml") + "'"), 2, words);
  expect(macro("clamped", "solid_fraction = 0.6\nrange = \"clamp\"\n"), 0, {});
  EXPECT_EQ(summary("clamped")["law"]["solid_fraction"], 0.65);
  EXPECT_NE(summary("clamped")["remarks"].dump().find("nearest entry was used"), std::string::npos);
  expect(macro("out", "solid_fraction = 0.7\n", "--law '" + file("law.toml") + "'"), 2,
         {"solid_fraction", "goes with a law table"});
  expect(run_the_program("law eval '" + file("law_table.toml") + "' --solid-fraction 0.71"), 2, {"0.650 to 0.700"});
}

TEST_F(LawTableUse, WhatALawCannotAnswerNamesItsFile) {
  LawTableEntry entry = law_entry(0.70);
  for (MultiContactLaw& law : entry.laws) law.partners.resize(2);
  save_law_table({1, {entry}}, file("hard.toml"));
  const std::string table = "'" + file("hard.toml") + "'";
  for (const std::string& command : {"law eval " + table, "law export " + table + " --to csv",
                                     "law export " + table + " --to lammps-table --kind soft-solid"})
    expect(run_the_program(command), 2, {"hard.toml: law table: the directional law knows no soft neighbours"});
  LawCard card = synthetic::card();
  card.pairs.pop_back();
  save_card(card, file("one.toml"));
  const std::string kind = card.pairs[0].kind == PairKind::soft_solid ? "soft-soft" : "soft-solid";
  for (const std::string command : {"law eval", "law export --to lammps-table"})
    expect(run_the_program(command + " '" + file("one.toml") + "' --kind " + kind), 2, {"one.toml: law card: no "});
}

TEST_F(LawTableUse, CheckAndLawTakeTheSameEntryAsTheRun) {
  LawTableEntry dense = law_entry(0.70);
  dense.packings = 32;
  save_law_table({1, {law_entry(0.65, -0.05), dense}}, file("law_table.toml"));
  expect(macro("run", ""), 0, {});
  const std::string hash = summary("run")["law"]["hash"];
  expect(run_the_program("check '" + file("scene.toml") + "'"), 0, {"directional law at solid fraction 0.7000", hash});
  expect(run_the_program("law eval '" + file("law_table.toml") + "'"), 0, {"at solid fraction 0.7000"});
  expect(run_the_program("law show '" + file("law_table.toml") + "'"), 0, {"0.7000 +- 0.0003 (main"});
  expect(run_the_program("law export '" + file("law_table.toml") + "' --to csv"), 0, {"0.7000"});
  expect(run_the_program("law export '" + file("law_table.toml") + "' --to lammps-table"), 0,
         {"the directional law at solid fraction 0.7000 of the table"});
  const json shown = json::parse(run_the_program("law show --json '" + file("law_table.toml") + "'").output);
  EXPECT_EQ(shown["parameters"]["entries"][1]["main"], true);
  EXPECT_EQ(shown["parameters"]["entries"][0]["main"], false);
}

TEST_F(LawTableUse, TwinsSayWhichSolidFractionIsMeant) {
  // Contents of three coarse grains are far looser than the table.
  LawTableEntry coarse = law_entry(0.70);
  coarse.spec.trials = 50;
  coarse.spec.polydispersity = 3.0;
  coarse.spec.rmax_over_shell = 0.5;
  save_law_table({1, {coarse}}, file("law_table.toml"));
  const std::string twin = "--set macro.resolved=true --set macro.bodies=6 --set macro.steps=1 --set macro.strain=0.35";
  expect(macro("out", "contents = 2\n", twin), 2,
         {"solid fraction", "outside the law table (0.680 to 0.720)", "clamp"});
  expect(macro("clamped", "contents = 2\nrange = \"clamp\"\n", twin), 0, {});
  EXPECT_NE(summary("clamped")["remarks"].dump().find("nearest entry was used"), std::string::npos);
}

TEST_F(LawTableUse, WrongMacroScenesAreRefused) {
  expect(macro("out", "form = \"sack\"\n"), 2, {"form", "directional"});
  expect(macro("out", "range = \"guess\"\n"), 2, {"range", "clamp"});
  expect(macro("out", "mu = -0.1\n"), 2, {"mu = -0.1"});
  expect(macro("out", "", "--set macro.mu=0.5"), 2, {"mu = 0.3", "mu = 0.5", "measure a table"});
  const std::string card = "--law '" + file("law.toml") + "'";
  expect(macro("out", "form = \"isotropic\"\n", card), 2, {"form", "goes with a law table", "law.toml is a law card"});
  expect(macro("out", "mu = 0.1\n", card), 2, {"mu", "goes with a law table"});
  expect(macro("out", "unloading = true\n", card), 2, {"unloading was not measured for the law card"});
  expect(macro("out", "", "--law '" + file("scene.toml") + "'"), 2,
         {"scene.toml", "neither a law card", "[[pair]]", "[[entry]]"});
  expect(macro("out", "", "--law '" + file("absent.toml") + "'"), 4, {"absent.toml"});
  LawTableEntry other = law_entry(0.70);
  other.spec.poisson_ratio = 0.25;
  save_law_table({1, {other}}, file("other.toml"));
  // The scene takes nu from the table it is given, so another nu comes only with a comparison (below).
  expect(macro("good", "", "--law '" + file("other.toml") + "'"), 0, {});
  LawTableEntry shallow = law_entry(0.70);
  shallow.laws[2].status = LawStatus::no_threshold_crossing;
  shallow.laws[2].reason = "too shallow";
  save_law_table({1, {shallow}}, file("shallow.toml"));
  expect(macro("out", "", "--law '" + file("shallow.toml") + "'"), 2, {"not usable", "too shallow"});
}

TEST_F(LawTableUse, ComparisonsRefuseTablesOfOtherGrains) {
  const auto compare = [&](const std::string& law, const std::string& more) {
    std::string text = kTinyComparison;
    const std::string card = "card = \"law.toml\"\n";
    text.replace(text.find(card), card.size(), law);
    write_text_atomic(file("comparison.toml"), text);
    return run_the_program("run '" + file("comparison.toml") + "' --quiet --out '" + file("out") + "' " + more);
  };
  const std::string table = "table = \"law_table.toml\"\n";
  expect(compare(table + "range = \"clamp\"\n", "--set material.nu=0.2"), 2, {"nu = 0.3", "nu = 0.2"});
  expect(compare(table + "range = \"clamp\"\n", "--set material.mu=0.5"), 2, {"mu = 0.3", "mu = 0.5"});
  expect(compare(table, ""), 2, {"solid fraction", "outside the law table"});
  expect(compare(table + "forms = [\"sack\"]\n", ""), 2, {"sack", "pair, isotropic, directional"});
  expect(compare("card = \"law.toml\"\nforms = [\"isotropic\"]\n", ""), 2, {"isotropic", "needs a law table"});
  expect(compare("", ""), 2, {"law table, a law card, or both"});
}

TEST_F(LawTableUse, CheckSaysWhatIsInATable) {
  LawTableEntry second = law_entry(0.75, 0.01);
  second.laws[1].status = LawStatus::underdetermined;
  second.laws[1].reason = "planes: 3 of 6";
  second.laws[1].error_held_out = std::nan("");
  save_law_table({1, {law_entry(0.70), second}}, file("law_table.toml"));
  expect(run_the_program("check '" + file("law_table.toml") + "'"), 0,
         {"law table: 2 entries, solid fraction 0.700 to 0.750", "directional (chosen): good", "12 packings",
          "underdetermined (planes: 3 of 6)", "overlap of 0.280 Rs", "3.3 % on what was held out", "nothing held out",
          "soft neighbours of ratio 1 to 2"});
  const ProgramOutcome outcome = run_the_program("check --json '" + file("law_table.toml") + "'");
  const json facts = json::parse(outcome.output);
  EXPECT_EQ(facts["entries"][1]["laws"][1]["status"], "underdetermined");
  expect(run_the_program("check '" + file("law.toml") + "'"), 0, {"law card"});
  write_text_atomic(file("odd.toml"), "schema = 1\n");
  expect(run_the_program("check '" + file("odd.toml") + "'"), 2, {"odd.toml", "neither a law card"});
  expect(run_the_program("check '" + file("scene.toml") + "' --set form=sack"), 2, {"form", "sack"});
}

}  // namespace
