// Macro scenes of coarse grains in cells of fines: periodic and between planes, stopped and gone on, bad input.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/data/cell_card.h"
#include "common/data/macro_band.h"
#include "common/data/macro_result.h"
#include "common/io/text_file.h"
#include "tests/support/disturbed_run.h"
#include "tests/support/program.h"
#include "tests/support/run_comparison.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

CellCard sample_card() {
  CellCard card;
  const auto exact = [](double x) { return Estimate{x, 0.01 * x, 0.98 * x, 1.02 * x}; };
  card.modulus = exact(0.0447);
  card.exponent = exact(1.75);
  card.void_ratio = exact(0.567);
  card.excess_alone = exact(0.6155);
  card.excess_many = exact(0.3075);
  card.excess_decay = exact(0.355);
  card.friction = exact(0.6);
  card.stiffness = exact(1.0);
  card.lateral_ratio = exact(0.48);
  card.pressure_low = 1e-4;
  card.pressure_high = 1e-2;
  card.mixture_high = 4.0;
  card.youngs_modulus = 5e5;
  card.density = 2500.0;
  card.poisson_ratio = card.grain_friction = 0.3;
  card.preparation = "fast";
  card.start_pressure = 1e-4;
  card.split = 1.0 / 3.0;
  card.fines_ratio = 4.0;
  card.fines_sizes = "power law r^-3.5";
  card.samples = 3;
  return card;
}

class CellsMacro : public testing::Test {
 protected:
  CellsMacro() {
    write_cell_card(sample_card(), file("cells.toml"));
    scene("");
  }
  [[nodiscard]] std::string file(const std::string& name) const { return directory_.file(name); }
  void scene(const std::string& macro, const std::string& fines = "share = 0.4\n",
             const std::string& head = "law = \"cells.toml\"\n") const {
    write_text_atomic(file("scene.toml"), "kind = \"macro\"\n" + head +
                                              "[macro]\nbodies = 40\nboundary = \"periodic\"\npreparation = \"fast\"\n"
                                              "start_pressure = 1e-4\nsolid_radius_max = 0.016\n"
                                              "solid_polydispersity = 3\nsteps = 3\nstrain = 0.06\n" +
                                              macro + "[fines]\n" + fines);
  }
  [[nodiscard]] ProgramOutcome run(const std::string& name, const std::string& more = "", int threads = 1) const {
    return run_the_program(
        fmt::format("macrosim '{}' --quiet --threads {} --out '{}' {}", file("scene.toml"), threads, file(name), more));
  }
  [[nodiscard]] MacroCurve curve(const std::string& name) const { return load_macro(file(name) + "/macro.h5").at(0); }
  static void expect(const ProgramOutcome& outcome, int status, const std::vector<std::string>& words) {
    EXPECT_EQ(outcome.status, status) << outcome.output;
    for (const std::string& word : words)
      EXPECT_NE(outcome.output.find(word), std::string::npos) << word << " not in " << outcome.output;
  }

  TemporaryDirectory directory_;
};

/// All cells alike at the start; the pressure of the whole is then close to that of one cell with the mean density.
TEST_F(CellsMacro, FollowTheEquationOfStateOfTheirMeanDensity) {
  expect(run("out"), 0, {});
  const MacroCurve c = curve("out");
  const auto mean = [&](std::size_t n) { return (c.stress_axial[n] + 2.0 * c.stress_lateral[n]) / 3.0; };
  const CellCard card = sample_card();
  const double e = 5e5;
  ASSERT_EQ(c.strain.size(), 4U);
  EXPECT_NEAR(c.stress_axial[0], 1e-4 * e, 1e-3 * 1e-4 * e);
  const double phi = c.more.at("solid_fraction")[0];
  const double x = std::pow(1e-4 / card.modulus.value, 1.0 / card.exponent.value);
  const double onset = (phi - x) / (1.0 - x);
  for (std::size_t n = 1; n < c.strain.size(); ++n) {
    const double dense = (phi / (1.0 - c.strain[n]) - onset) / (1.0 - onset);
    EXPECT_NEAR(mean(n) / (e * card.modulus.value * std::pow(dense, card.exponent.value)), 1.0, 0.06) << n;
    EXPECT_GT(c.stress_axial[n], c.stress_lateral[n]);
  }
  const nlohmann::json summary = nlohmann::json::parse(read_text(file("out") + "/summary.json"));
  EXPECT_NE(read_text(file("out") + "/report.html").find("material without shells"), std::string::npos);
  EXPECT_NE(summary["law"]["picture"].get<std::string>().find("material without shells"), std::string::npos);
  EXPECT_EQ(summary["status"], "good");
}

/// So many cells that they are joined, and the springs of their faces tried, on several threads.
TEST_F(CellsMacro, ManyAreTheSameBitsOnAnyThreads) {
  scene("", "share = 0.4\n", "law = \"" SOFTGRAIN_SOURCE_DIR "/results/material_law/cell_law_memory.toml\"\n");
  const std::string many = "--set macro.bodies=700 --set macro.steps=1 --set macro.strain=0.005";
  expect(run("one", many), 0, {});
  for (const int threads : {2, 3, 5, 8}) {
    const std::string name = fmt::format("on_{}", threads);
    expect(run(name, many, threads), 0, {});
    expect_same_runs(file("one"), file(name));
  }
}

TEST_F(CellsMacro, AreTheSameBitsOnAnyThreadsAndWhereTheyWereStopped) {
  scene("samples = 2\n");
  const auto start = [&](const std::string& name, const std::string& threads, bool resume) {
    std::vector<std::string> words{"macrosim", file("scene.toml"),   "--out", file(name), "--quiet", "--threads",
                                   threads,    "--checkpoint-every", "0"};
    if (resume) words.emplace_back("--resume");
    return start_program(words);
  };
  const double whole = child_seconds_of([&] { EXPECT_TRUE(ended_with(wait_for(start("one", "1", false)), 0)); });
  EXPECT_TRUE(ended_with(wait_for(start("two", "3", false)), 0));
  expect_same_runs(file("one"), file("two"));
  int stops = 0;
  for (std::uint64_t round = 0; round < 8 && stops < 3; ++round) {
    const std::string name = "stopped" + std::to_string(round);
    stops += run_disturbed({SIGTERM, 3, 0.6 * whole, 300 + round}, file(name), 0,
                           [&](int part) { return start(name, part % 2 == 0 ? "1" : "2", part > 0); });
    expect_same_runs(file("one"), file(name));
  }
  EXPECT_GE(stops, 1);
}

TEST_F(CellsMacro, BetweenPlanesAndThroughStagesToo) {
  write_text_atomic(file("scene.toml"), read_text(file("scene.toml")) +
                                            "[[stage]]\nkind = \"consolidation\"\nstress = \"500 Pa\"\nsteps = 2\n"
                                            "[[stage]]\nkind = \"triaxial\"\nstrain = 0.04\nsteps = 2\n"
                                            "[[stage]]\nkind = \"unload\"\nstrain = 0.01\nsteps = 2\n");
  std::string text = read_text(file("scene.toml"));
  for (const char* key : {"steps = 3\n", "strain = 0.06\n"}) text.erase(text.find(key), std::string(key).size());
  for (const char* boundary : {"periodic", "walls"}) {
    write_text_atomic(file("scene.toml"), text);
    expect(run(boundary, std::string("--set macro.boundary=") + boundary), 0, {});
    const MacroCurve c = curve(boundary);
    ASSERT_EQ(c.stress_axial.size(), 7U);
    EXPECT_NEAR(c.stress_axial[2] / 500.0, 1.0, 0.01) << boundary;
    for (const std::size_t n : {2U, 3U, 4U}) EXPECT_NEAR(c.stress_lateral[n] / 500.0, 1.0, 0.01) << boundary << n;
    EXPECT_GT(c.stress_axial[4], c.stress_axial[3]);
    EXPECT_LT(c.stress_axial[6], c.stress_axial[4]);
  }
}

/// Pressures of the law are over E: with another one, of the card or of the scene, the same curve in other pascals.
TEST_F(CellsMacro, TakeTheModulusAndTheDensityThatCardAndSceneSay) {
  expect(run("soft"), 0, {});
  CellCard stiff = sample_card();
  stiff.youngs_modulus = 5e10;
  stiff.density = 3000.0;
  write_cell_card(stiff, file("cells.toml"));
  expect(run("card"), 0, {});
  expect(run("scene", "--set material.E='5 MPa' --set material.density=2000"), 0, {});
  const MacroCurve soft = curve("soft");
  const auto same = [&](const std::string& name, double factor, double density) {
    const MacroCurve c = curve(name);
    EXPECT_EQ(c.start.youngs_modulus, 5e5 * factor);
    ASSERT_EQ(c.stress_axial.size(), soft.stress_axial.size());
    for (std::size_t k = 0; k < c.stress_axial.size(); ++k)
      EXPECT_NEAR(c.stress_axial[k] / soft.stress_axial[k], factor, 1e-3 * factor) << name << k;
    EXPECT_NEAR(c.more.at("bulk_density")[0], density * c.more.at("solid_fraction")[0], 1e-9 * density);
  };
  same("card", 1e5, 3000.0);
  same("scene", 10.0, 2000.0);
  expect(run("other", "--set material.nu=0.2"), 2, {"material.nu", "serves no others"});
  expect(run("wrong", "--set material.E=-1"), 2, {"material.E"});
  const std::string check = "check '" + file("scene.toml") + "' --set material.E='5 MPa'";
  expect(run_the_program(check), 0, {"E of the grains 5e+06 Pa", "measured with 5e+10 Pa"});
}

TEST_F(CellsMacro, RefuseAStressWhereNobodySaysTheModulus) {
  CellCard older = sample_card();
  older.youngs_modulus = older.density = std::nan("");
  write_cell_card(older, file("cells.toml"));
  std::string text = read_text(file("scene.toml"));
  for (const char* key : {"steps = 3\n", "strain = 0.06\n"}) text.erase(text.find(key), std::string(key).size());
  const std::string isotropic = text + "[[stage]]\nkind = \"isotropic\"\nstress = \"500 Pa\"\nsteps = 2\n";
  write_text_atomic(file("scene.toml"), isotropic);
  expect(run("pascals"), 2, {"scene.toml:", "stress = \"500 Pa\"", "needs E of the grains", "[material] E"});
  expect(run("known", "--set material.E='0.5 MPa'"), 0, {});
  EXPECT_NEAR(curve("known").stress_axial.back() / 500.0, 1.0, 0.01);
  write_text_atomic(file("scene.toml"), text + "[[stage]]\nkind = \"triaxial\"\nstrain = 0.02\nsteps = 2\n");
  expect(run("strain"), 0, {});
  const nlohmann::json summary = nlohmann::json::parse(read_text(file("strain") + "/summary.json"));
  EXPECT_NE(summary["remarks"].dump().find("E = 500000 Pa"), std::string::npos) << summary["remarks"];
  expect(run("start", "--set macro.start_pressure='50 Pa'"), 2, {"start_pressure", "needs E of the grains"});
  write_text_atomic(file("scene.toml"), text +
                                            "[[stage]]\nkind = \"triaxial\"\nstrain = 0.02\nsteps = 2\n"
                                            "lateral_stress = \"50 Pa\"\n");
  expect(run("sides"), 2, {"lateral_stress = \"50 Pa\"", "needs E of the grains"});
}

TEST_F(CellsMacro, BeginAtTheDensityThatIsGiven) {
  scene("", "share = 0.4\nsolid_fraction = 0.72\nstart = \"density\"\n");
  expect(run("given"), 0, {});
  EXPECT_NEAR(curve("given").more.at("solid_fraction")[0], 0.72, 1e-9);
  scene("", "share = 0.4\nsolid_fraction = 0.45\nstart = \"density\"\n");
  expect(run("loose"), 2, {"does not jam at this density"});
}

/// All void ratios of the card are times its factor for the preparation that [fines] says, from a start pressure and
/// from the density alone.
TEST_F(CellsMacro, BeginWithThePoresOfThePreparationThatIsSaid) {
  CellCard card = sample_card();
  card.preparations = {{"dense", {0.8, 0.01, 0.78, 0.82}}};
  write_cell_card(card, file("cells.toml"));
  const auto start = [&](const std::string& name, const std::string& fines) {
    scene("", "share = 0.4\n" + fines);
    expect(run(name, "--set macro.bodies=60 --set macro.strain=0.01 --set macro.steps=1"), 0, {});
    return curve(name);
  };
  const double x = std::pow(1e-4 / card.modulus.value, 1.0 / card.exponent.value);
  const auto pores = [&](const MacroCurve& c) {
    const double phi = c.more.at("solid_fraction")[0];
    return (1.0 - phi) / (phi - x);
  };
  const MacroCurve own = start("own", "");
  const MacroCurve dense = start("dense", "preparation = \"dense\"\n");
  EXPECT_NEAR(pores(dense) / pores(own), 0.8, 1e-6);
  const MacroCurve same = start("same", "preparation = \"fast\"\n");
  EXPECT_EQ(same.stress_axial, own.stress_axial);
  EXPECT_EQ(same.law.hash, own.law.hash);
  EXPECT_NE(dense.law.hash, own.law.hash) << "forces depend on the factor";
  const std::string density =
      fmt::format("start = \"density\"\nsolid_fraction = {:.12f}\n", dense.more.at("solid_fraction")[0]);
  const double given = start("given", density + "preparation = \"dense\"\n").stress_axial[0];
  EXPECT_NEAR(given / dense.stress_axial[0], 1.0, 0.2);
  EXPECT_GT(start("wrong", density).stress_axial[0], 5.0 * given) << "by the preparation of the card";
  scene("", "share = 0.4\npreparation = \"dense\"\n");
  expect(run_the_program("check '" + file("scene.toml") + "'"), 0, {"its void ratios times 0.8"});
  scene("", "share = 0.4\npreparation = \"slow\"\n");
  expect(run("bad"), 2, {"preparation", "has a factor for 'dense'", "none for 'slow'", "[law] preparations"});
  scene("", "share = 0.4\npreparation = \"slwo\"\n");
  expect(run("bad"), 2, {"nearest is \"slow\""});
  scene("preparation = \"dense\"\n");
  std::string text = read_text(file("scene.toml"));
  text.erase(text.find("preparation = \"fast\"\n"), 21);
  write_text_atomic(file("scene.toml"), text);
  expect(run_the_program("check '" + file("scene.toml") + "'"), 0, {"this specimen 'dense'", "[fines] preparation"});
  const std::string path = "'" + file("cells.toml") + "'";
  expect(run_the_program("law show " + path), 0, {"dense", "factor on e_J, e_c and w_inf"});
  expect(run_the_program("check " + path), 0, {"void ratios of grains prepared 'dense'"});
  const auto shown = nlohmann::json::parse(run_the_program("law show --json " + path).output);
  EXPECT_EQ(shown["parameters"]["void_ratio_factors"]["dense"]["value"], 0.8);
}

TEST_F(CellsMacro, SayWhatDoesNotFit) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"share = 1.2\n", "below 1"},
      {"share = 0.4\nshares = 1\n", "nearest"},
      {"share = 0.4\nstart = \"volume\"\n", "\"pressure\" or \"density\""},
      {"", "missing key 'share'"},
  };
  for (const auto& [fines, word] : cases) {
    scene("", fines);
    expect(run("bad"), 2, {word});
  }
  scene("wall_mu = 0.2\n");
  expect(run("bad", "--set macro.boundary=walls"), 2, {"walls of cells are smooth"});
  scene("resolved = true\n");
  expect(run("bad"), 2, {"material-models"});
  scene("construction = \"voids\"\n");
  expect(run("bad"), 2, {"cells fill all voids"});
  scene("", "share = 0.4\n", "law = \"cells.toml\"\nform = \"isotropic\"\n");
  expect(run("bad"), 2, {"is a card of the cell law"});
  scene("mu_r = 0.1\n");
  expect(run("bad"), 2, {"is that of the card"});
  scene("mu = 0.5\n");
  expect(run("bad"), 2, {"measured with nu = 0.3, mu = 0.3 and serves no grains of nu = 0.3, mu = 0.5"});
}

TEST_F(CellsMacro, WithoutShearMemoryWarnOfTestsThatShear) {
  expect(run("compressed"), 0, {});
  EXPECT_TRUE(curve("compressed").warning.empty());
  scene("test = \"shear\"\nstrain = 0.01\n");
  const std::string text = read_text(file("scene.toml"));
  write_text_atomic(file("scene.toml"), std::string(text).erase(text.find("strain = 0.06\n"), 14));
  expect(run("sheared"), 0, {"no shear memory and serves compression"});
  expect(run_the_program("check '" + file("scene.toml") + "'"), 0, {"no shear memory"});
}

/// Cells count as unloaded far below the pressure at which a specimen starts, however low that is.
TEST_F(CellsMacro, WithShearMemoryStartAtThePressureThatIsAsked) {
  scene("", "share = 0.4\n", "law = \"" SOFTGRAIN_SOURCE_DIR "/results/material_law/cell_law_memory.toml\"\n");
  for (const double pressure : {1e-4, 1e-7, 1e-8}) {
    ASSERT_EQ(run("low", fmt::format("--set macro.start_pressure={} --set macro.strain=0.002", pressure)).status, 0);
    const MacroCurve c = curve("low");
    const double p = (c.stress_x.front() + c.stress_y.front() + c.stress_axial.front()) / 3.0;
    EXPECT_NEAR(p / (pressure * c.start.youngs_modulus), 1.0, 0.05) << pressure;
  }
}

/// What a run refuses at once, check refuses too.
TEST_F(CellsMacro, HaveNoBandsWithoutCorrelationsAndCheckSaysSo) {
  const std::string checked = "check '" + file("scene.toml") + "' ";
  expect(run_the_program(checked), 0, {});
  expect(run("bad", "--bands 8"), 2, {"no [correlation]"});
  expect(run_the_program(checked + "--bands 8"), 2, {"no [correlation]"});
  expect(run_the_program(checked + "--set macro.bands=8"), 2, {"no [correlation]"});
}

TEST_F(CellsMacro, BandsSayWhatTheCardDoesNotTell) {
  const auto refused = [&](const CellCard& card, const std::vector<std::string>& words) {
    write_cell_card(card, file("cells.toml"));
    expect(run("bad", "--bands 8"), 2, words);
  };
  CellCard card = sample_card();
  card.correlation = {{"K", "n", "xi"}, {1.0, 0.9, -0.9, 0.9, 1.0, 0.9, -0.9, 0.9, 1.0}};
  refused(card, {"cells.toml:33: matrix = ", "contradicts itself"});
  card.correlation = {{"K"}, {1.0}};
  card.modulus.high = HUGE_VAL;
  refused(card, {"cells.toml: the interval of K is not known"});
}

/// At a given density all stresses go with K: a band of K alone is as wide as the interval of K.
TEST_F(CellsMacro, BandsAreAsWideAsTheErrorsOfTheCard) {
  CellCard card = sample_card();
  card.correlation = {{"K"}, {1.0}};
  write_cell_card(card, file("cells.toml"));
  scene("", "share = 0.4\nstart = \"density\"\nsolid_fraction = 0.7\n");
  const ProgramOutcome outcome = run("bands", "--bands 60");
  expect(outcome, 0, {"60 draws from the errors of the card", "e_J", "held: their errors are not known"});
  const MacroCurve c = curve("bands");
  for (const BandOf of : {BandOf::axial, BandOf::lateral}) {
    const auto band = band_of(c, of, BandPart::law);
    ASSERT_TRUE(band);
    for (std::size_t k = 1; k < c.strain.size(); ++k) {
      const double stress = banded_stress(c, of)[k];
      EXPECT_NEAR(1.0 - band->low[k] / stress, 0.02, 0.008);
      EXPECT_NEAR(band->high[k] / stress - 1.0, 0.02, 0.008);
    }
  }
  expect(run("two", "--bands 60", 2), 0, {});
  EXPECT_EQ(band_of(curve("two"), BandOf::axial, BandPart::law)->high, band_of(c, BandOf::axial, BandPart::law)->high);
  scene("band_estimator = \"components\"\n");
  expect(run("bad", "--bands 8"), 2, {"cells run every draw"});
}

TEST_F(CellsMacro, TheirCardIsShownAndChecked) {
  const std::string card = "'" + file("cells.toml") + "'";
  expect(run_the_program("law show " + card), 0, {"material without shells", "mu_f", "0.588 .. 0.612"});
  const ProgramOutcome shown = run_the_program("law show --json " + card);
  const nlohmann::json j = nlohmann::json::parse(shown.output);
  EXPECT_EQ(j["kind"], "cell law");
  EXPECT_EQ(j["parameters"]["K"]["value"], 0.0447);
  expect(run_the_program("law eval " + card), 2, {"is a card of the cell law"});
  expect(run_the_program("check " + card), 0, {"card of the cell law, porosity form"});
  expect(run_the_program("check '" + file("scene.toml") + "'"), 0,
         {"for material without shells", "solid fraction of"});
  std::string text = read_text(file("cells.toml"));
  text.replace(text.find("K = "), 4, "K = 3 #");
  write_text_atomic(file("broken.toml"), text);
  EXPECT_EQ(run_the_program("law show '" + file("broken.toml") + "'").status, 2);
}

}  // namespace
