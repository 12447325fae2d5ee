// Models beside a resolved material, from outside: a mixture that the law was not measured on.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "common/data/cell_card.h"
#include "common/data/macro_result.h"
#include "common/io/text_file.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/unwrapped.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

std::string scene_of(const std::string& grains, const std::string& more) {
  const std::string card = std::string(SOFTGRAIN_SOURCE_DIR) + "/results/material_law/cell_law.toml";
  return "kind = \"material-models\"\nsamples = 2\n[packing]\npreparation = \"fast\"\nstart_pressure = 1e-4\n"
         "[test]\nstrain = 0.08\nsteps = 8\nincrements_per_step = 4\ntolerance = 1e-2\n" +
         grains +
         fmt::format(
             "[[model]]\nname = \"cells\"\nkind = \"cells\"\ncard = \"{0}\"\n"
             "[[model]]\nname = \"density\"\nkind = \"cells\"\nplaces = \"own\"\nstart = \"density\"\ncard = "
             "\"{0}\"\n",
             card) +
         more;
}

/// By the name of the model.
nlohmann::json scores_of(const std::string& directory) {
  nlohmann::json out;
  const nlohmann::json summary = summary_of(directory);
  for (const auto& one : summary["models"]) out[one["model"].get<std::string>()] = one;
  return out;
}

/// Nothing between a third and a half of the largest radius: neither law nor start know of it.
TEST(SlowMaterialModels, AGapGradedMaterialIsForeseenByCells) {
  const TemporaryDirectory directory;
  write_text_atomic(directory.file("scene.toml"),
                    scene_of("[grains]\ncount = 2500\nsizes = { form = \"classes\", class = [\n"
                             "  { radius_min = 0.008, radius_max = 0.016, exponent = 3.5, volume_share = 0.6 },\n"
                             "  { radius_min = 0.002667, radius_max = 0.005333, exponent = 3.5, volume_share = 0.4 } "
                             "] }\n",
                             ""));
  const ProgramOutcome outcome =
      run_the_program("run '" + directory.file("scene.toml") + "' --quiet --out '" + directory.file("out") + "'");
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  const nlohmann::json scores = scores_of(directory.file("out"));
  EXPECT_LT(scores["cells"]["axial"].get<double>(), 0.2);
  EXPECT_LT(scores["cells"]["lateral"].get<double>(), 0.2);
  // The onset is not that of the card: without the start pressure it is far off (results/material/models.md).
  EXPECT_GT(scores["density"]["axial"].get<double>(), scores["cells"]["axial"].get<double>());
  EXPECT_GT(scores["cells"]["evaluations"].get<double>(), 50.0);
}

/// A stage table.
std::string stage(const std::string& kind, double strain, int steps) {
  return fmt::format("[[loading.stage]]\nkind = \"{}\"\nstrain = {}\nsteps = {}\n", kind, strain, steps);
}

/// One blind case of each kind of test: the card is of fines of ratio 2 and knows neither this material nor its seed.
/// In results/material_law/shear_memory.md two samples of another seed are 3 to 7 % off; here 5 to 9.
TEST(SlowMaterialModels, ShearMemoryForeseesEachKindOfTest) {
  const TemporaryDirectory directory;
  const std::string preload = stage("isotropic", 0.02, 4);
  write_text_atomic(
      directory.file("scene.toml"),
      "kind = \"material-models\"\nseed = 97\nsamples = 2\n[grains]\ncount = 2500\nratio = 6\nradius_max = \"16 mm\"\n"
      "[packing]\npreparation = \"fast\"\nstart_pressure = 1e-4\n[test]\nsteps = 16\nincrements_per_step = 4\n"
      "tolerance = 1e-2\n[[loading]]\nname = \"oedometric\"\n" +
          stage("oedometric", 0.08, 16) + stage("unload", 0.02, 8) + "[[loading]]\nname = \"shear\"\n" + preload +
          stage("shear", 0.08, 16) + "[[loading]]\nname = \"triaxial\"\n" + preload + stage("triaxial", 0.1, 16) +
          "[[loading]]\nname = \"cyclic\"\n" + preload + stage("shear", 0.01, 4) + stage("cycles", 0.02, 8) +
          "count = 2\n[[model]]\nname = \"memory\"\nkind = \"cells\"\ncard = \"" + SOFTGRAIN_SOURCE_DIR +
          "/results/material_law/cell_law_memory_lambda.toml\"\n");
  const ProgramOutcome outcome =
      run_the_program("run '" + directory.file("scene.toml") + "' --quiet --out '" + directory.file("out") + "'");
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  nlohmann::json scores;
  const nlohmann::json summary = summary_of(directory.file("out"));
  for (const auto& one : summary["models"]) scores[one["variant"].get<std::string>()] = one;
  ASSERT_EQ(scores.size(), 4U) << scores.dump();
  for (const char* test : {"oedometric", "shear", "triaxial", "cyclic"}) {
    EXPECT_LT(scores[test]["axial"].get<double>(), 0.12) << test;
    EXPECT_LT(scores[test]["lateral"].get<double>(), 0.2) << test;
  }
  EXPECT_NEAR(scores["oedometric"]["unloading"].get<double>(), 0.0, 0.15);
  EXPECT_NEAR(scores["triaxial"]["q_over_p_at_2"].get<double>(), 0.0, 0.15);
  EXPECT_NEAR(scores["triaxial"]["q_over_p_at_6"].get<double>(), 0.0, 0.15);
  EXPECT_NEAR(scores["triaxial"]["volume"].get<double>(), 0.0, 0.01);
  EXPECT_NEAR(scores["shear"]["q_over_p_at_6"].get<double>(), 0.0, 0.15);
}

/// The same in seconds, on few grains: the table is there, a model that cannot be is named.
TEST(MaterialModelsRun, WritesItsTableAndSaysWhatCouldNotBe) {
  const TemporaryDirectory directory;
  write_text_atomic(directory.file("scene.toml"),
                    scene_of("[grains]\ncount = 400\nratio = 4\n",
                             "[[model]]\nname = \"split\"\nkind = \"coarse\"\nsplit = 0.2\n"
                             "[[model]]\nname = \"coarse\"\nkind = \"coarse\"\n"));
  const std::string out = directory.file("out");
  const ProgramOutcome outcome =
      run_the_program("run '" + directory.file("scene.toml") + "' --quiet --out '" + out + "'");
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  const nlohmann::json scores = scores_of(out);
  EXPECT_EQ(scores["split"]["samples"], 0);
  EXPECT_NE(scores["split"]["remark"].get<std::string>().find("one side of the split"), std::string::npos);
  EXPECT_EQ(scores["cells"]["samples"], 2);
  EXPECT_LT(scores["cells"]["axial"].get<double>(), 0.35);
  EXPECT_GT(scores["coarse"]["axial"].get<double>(), 0.5);  // a material is not its coarse grains
  const std::string page = read_text(out + "/report.html");
  for (const char* part : {"Models compared with the resolved material", "models-cost", "models-material"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  EXPECT_NE(read_text(out + "/models.csv").find("density,cells,no,"), std::string::npos);
}

/// Each draw of the card is a run of its own; without bands the model is the same to the last bit.
TEST(MaterialModelsRun, DrawsOfTheCardGiveABand) {
  const TemporaryDirectory directory;
  const std::string scene =
      "kind = \"material-models\"\nsamples = 1\n[packing]\npreparation = \"fast\"\n[test]\nstrain = 0.02\nsteps = 2\n"
      "[grains]\ncount = 300\nratio = 4\n[[model]]\nname = \"cells\"\nkind = \"cells\"\ncard = \"" +
      std::string(SOFTGRAIN_SOURCE_DIR) + "/results/material_law/cell_law_memory.toml\"\n";
  const auto run = [&](const std::string& name, const std::string& more) {
    write_text_atomic(directory.file(name + ".toml"), scene + more);
    return run_the_program("run '" + directory.file(name + ".toml") + "' --quiet --out '" + directory.file(name) + "'");
  };
  const ProgramOutcome few = run("few", "bands = 7\n");
  EXPECT_EQ(few.status, 2);
  EXPECT_NE(unwrapped(few.output).find("7 draws say nothing of a 95 % band"), std::string::npos) << few.output;
  ASSERT_EQ(run("without", "").status, 0);
  const ProgramOutcome outcome = run("with", "bands = 8\n");
  const ProgramOutcome checked = run_the_program("check '" + directory.file("with.toml") + "'");
  EXPECT_NE(unwrapped(checked.output).find("model cells: cells, and once more for each of 8 draws of its card"),
            std::string::npos)
      << checked.output;
  EXPECT_NE(unwrapped(checked.output).find("the card is of fines of ratio 2, these have 1.33"), std::string::npos)
      << checked.output;
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  const nlohmann::json with = scores_of(directory.file("with"))["cells"];
  const nlohmann::json without = scores_of(directory.file("without"))["cells"];
  EXPECT_EQ(with["axial"], without["axial"]);
  // Columns of the report that say nothing of any model are left out.
  const auto has_column = [&](const char* name, const char* title) {
    return read_text(directory.file(name) + "/report.html").find(title) != std::string::npos;
  };
  EXPECT_TRUE(has_column("with", ">band, inside<"));
  EXPECT_FALSE(has_column("without", ">band, inside<"));
  EXPECT_FALSE(has_column("with", ">q/p at 6 %<"));
  EXPECT_TRUE(without["band"].is_null()) << without["band"];
  EXPECT_GT(with["band"].get<double>(), 0.03);  // K alone is known to 10 %
  EXPECT_LT(with["band"].get<double>(), 1.0);
  EXPECT_GE(with["inside"].get<double>(), 0.0);
  EXPECT_LE(with["inside"].get<double>(), 1.0);
}

/// A mean field does not apply to shear, so nothing is compared.
TEST(MaterialModelsRun, WithoutACurveOfAnyModelIsNotUsable) {
  const TemporaryDirectory directory;
  write_text_atomic(directory.file("scene.toml"),
                    "kind = \"material-models\"\n[packing]\npreparation = \"fast\"\n[test]\ntest = \"shear\"\nstrain = "
                    "0.02\nsteps = 2\n[grains]\ncount = 300\nratio = 4\n[[model]]\nname = \"mean\"\nkind = "
                    "\"mean-field\"\ncard = \"" +
                        std::string(SOFTGRAIN_SOURCE_DIR) + "/results/material_law/cell_law.toml\"\n");
  const ProgramOutcome outcome =
      run_the_program("run '" + directory.file("scene.toml") + "' --quiet --out '" + directory.file("out") + "'");
  EXPECT_EQ(outcome.status, 3) << outcome.output;
  EXPECT_NE(unwrapped(outcome.output).find("no model has a curve: a mean field does not apply to shear"),
            std::string::npos)
      << outcome.output;
}

/// The run ended where it would have written the checkpoint of a model, after the reference was run.
TEST(MaterialModelsRun, TakesTheLongestNames) {
  const TemporaryDirectory directory;
  const auto name = [](char letter) { return "name = \"" + std::string(100, letter) + "\"\n"; };
  write_text_atomic(directory.file("scene.toml"),
                    "kind = \"material-models\"\n[packing]\npreparation = \"fast\"\n[test]\nstrain = 0.02\nsteps = 2\n"
                    "[grains]\ncount = 200\nratio = 3\n[[loading]]\n" +
                        name('l') + "[[variant]]\n" + name('v') + "[[model]]\n" + name('m') +
                        "kind = \"coarse\"\nsplit = 0.5\n");
  const ProgramOutcome outcome =
      run_the_program("run '" + directory.file("scene.toml") + "' --quiet --out '" + directory.file("out") + "'");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_TRUE(scores_of(directory.file("out")).contains(std::string(100, 'm')));
}

/// The reference ran before the run found out.
TEST(MaterialModelsRun, BandsThatACardCannotGiveAreRefusedAtOnce) {
  const TemporaryDirectory directory;
  CellCard card = read_cell_card(std::string(SOFTGRAIN_SOURCE_DIR) + "/results/material_law/cell_law_memory.toml");
  card.modulus.high = HUGE_VAL;
  write_cell_card(card, directory.file("card.toml"));
  const std::string scene = directory.file("scene.toml");
  write_text_atomic(scene,
                    "kind = \"material-models\"\nsamples = 1\n[packing]\npreparation = \"fast\"\n[grains]\ncount = "
                    "300\nratio = 4\n[[model]]\nname = \"cells\"\nkind = \"cells\"\ncard = \"card.toml\"\nbands = 8\n");
  for (const std::string& command :
       {"check '" + scene + "'", "run '" + scene + "' --out '" + directory.file("out") + "'"}) {
    const ProgramOutcome outcome = run_the_program(command);
    EXPECT_EQ(outcome.status, 2) << outcome.output;
    EXPECT_NE(unwrapped(outcome.output).find("scene.toml:12: bands = 8: the interval of K is not known"),
              std::string::npos)
        << outcome.output;
  }
  EXPECT_FALSE(std::filesystem::exists(directory.file("out")));
}

/// The card is of grains with mu = 0.3; what needs none is run.
TEST(MaterialModelsRun, RefusesACardOfGrainsWithAnotherFriction) {
  const TemporaryDirectory directory;
  write_text_atomic(directory.file("scene.toml"), scene_of("[grains]\ncount = 200\nratio = 4\n[material]\nmu = 0.5\n",
                                                           "[[model]]\nname = \"coarse\"\nkind = \"coarse\"\n"));
  const std::string out = directory.file("out");
  const ProgramOutcome outcome =
      run_the_program("run '" + directory.file("scene.toml") + "' --quiet --out '" + out + "'");
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  const std::string message = "measured with nu = 0.3, mu = 0.3 and serves no grains of nu = 0.3, mu = 0.5";
  EXPECT_NE(unwrapped(outcome.output).find(message), std::string::npos) << outcome.output;
  const nlohmann::json scores = scores_of(out);
  for (const char* model : {"cells", "density"}) {
    EXPECT_EQ(scores[model]["samples"], 0) << model;
    EXPECT_NE(scores[model]["remark"].get<std::string>().find(message), std::string::npos) << model;
  }
  EXPECT_EQ(scores["coarse"]["samples"], 2);
}

/// "m" on "x-y" is not "m-x" on "y", from whose checkpoint it would go on. Sieve curves have no exponent that fines
/// could be drawn by.
TEST(MaterialModelsRun, ModelsWithDashesInTheirNamesAreNotMixedUp) {
  const TemporaryDirectory directory;
  write_text_atomic(
      directory.file("scene.toml"),
      "kind = \"material-models\"\nsamples = 1\n[packing]\npreparation = \"fast\"\n[test]\nstrain = 0.01\nsteps = 2\n"
      "[grains]\ncount = 200\nratio = 4\n[[variant]]\nname = \"y\"\n[[variant]]\nname = \"x-y\"\n"
      "sizes = { form = \"sieve-curve\", openings = [0.008, 0.016, 0.032], passing = [0.0, 0.3, 1.0] }\n"
      "[[model]]\nname = \"m\"\nkind = \"coarse\"\nsplit = 0.45\n[[model]]\nname = \"m-x\"\nkind = \"coarse\"\n"
      "split = 0.7\n[[model]]\nname = \"drawn\"\nkind = \"substitute\"\nsplit = 0.6\nsmallest = 0.35\n");
  const std::string out = directory.file("out");
  const ProgramOutcome outcome =
      run_the_program("run '" + directory.file("scene.toml") + "' --quiet --out '" + out + "'");
  ASSERT_TRUE(outcome.status == 0 || outcome.status == 3) << outcome.output;
  const nlohmann::json summary = summary_of(out);
  std::map<std::string, nlohmann::json> scores;
  for (const auto& one : summary["models"])
    scores[one["variant"].get<std::string>() + " " + one["model"].get<std::string>()] = one;
  EXPECT_GT(scores["x-y m"]["bodies"].get<int>(), scores["x-y m-x"]["bodies"].get<int>());
  EXPECT_GT(scores["y m"]["bodies"].get<int>(), scores["y m-x"]["bodies"].get<int>());
  EXPECT_NE(scores["x-y drawn"]["remark"].get<std::string>().find("drawn from r^-3.5"), std::string::npos);
  EXPECT_EQ(scores["y drawn"]["remark"].get<std::string>().find("drawn from"), std::string::npos);
}

/// What was measured once is equal to the last bit, a time among it.
TEST(MaterialModelsRun, MakesPackingsOnceForAllLoadingsAndRunsMappedStandInsWithTheRawOnes) {
  const TemporaryDirectory directory;
  const std::string table = std::string(SOFTGRAIN_SOURCE_DIR) + "/results/law_table/law_table.toml";
  write_text_atomic(
      directory.file("scene.toml"),
      scene_of("[grains]\ncount = 300\nratio = 4\n[[loading]]\nname = \"one\"\nstrain = 0.005\nsteps = 2\n"
               "[[loading]]\nname = \"two\"\ntest = \"isotropic\"\nstrain = 0.005\nsteps = 2\n",
               fmt::format("[[model]]\nname = \"own\"\nkind = \"cells\"\nplaces = \"own\"\ncard = \"{0}\"\n"
                           "[[model]]\nname = \"raw\"\nkind = \"substitute\"\n"
                           "[[model]]\nname = \"mapped\"\nkind = \"substitute\"\nmapped = true\ncard = \"{0}\"\n"
                           "[[model]]\nname = \"shells\"\nkind = \"shells\"\nform = \"pair\"\ntable = \"{1}\"\n",
                           std::string(SOFTGRAIN_SOURCE_DIR) + "/results/material_law/cell_law.toml", table)));
  const auto run = [&](const std::string& name) {
    return run_the_program("run '" + directory.file("scene.toml") + "' --quiet --packing-cache '" +
                           directory.file("cache") + "' --out '" + directory.file(name) + "'");
  };
  const auto curve = [&](const std::string& name, const std::string& loading, const std::string& model) {
    for (const MacroCurve& c : load_macro(directory.file(name) + "/models_" + loading + ".h5"))
      if (c.engine == model && c.sample == 1) return c;
    ADD_FAILURE() << name << " " << loading << " " << model;
    return MacroCurve{};
  };
  const auto kept = [&] {
    const std::filesystem::directory_iterator files(directory.file("cache"));
    return std::distance(begin(files), end(files));
  };
  const ProgramOutcome first = run("first");
  ASSERT_EQ(first.status, 0) << first.output;
  const auto packings = kept();
  ASSERT_EQ(run("second").status, 0);
  EXPECT_EQ(kept(), packings);
  const MacroCurve raw = curve("first", "one", "raw");
  const MacroCurve mapped = curve("first", "one", "mapped");
  EXPECT_EQ(raw.cost.seconds, mapped.cost.seconds) << "run again";
  EXPECT_EQ(raw.strain, mapped.strain);
  EXPECT_NE(raw.stress_axial, mapped.stress_axial);
  for (const char* model : {"raw", "own", "shells"}) {
    const MacroCurve one = curve("first", "one", model);
    EXPECT_GT(one.preparation.seconds, 0.0) << model;
    EXPECT_EQ(one.preparation.seconds, curve("first", "two", model).preparation.seconds) << model;
    const MacroCurve taken = curve("second", "one", model);
    EXPECT_EQ(one.preparation.seconds, taken.preparation.seconds) << model;
    EXPECT_EQ(one.stress_axial, taken.stress_axial) << model;
  }
}

}  // namespace
