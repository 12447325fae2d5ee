// Law tables as calibrate fits them from files, and as pipelines measure their own; what is wrong is refused.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>

#include "common/contact/make_laws.h"
#include "common/data/multi_contact_replicates.h"
#include "common/io/text_file.h"
#include "tests/support/law_table_files.h"
#include "tests/support/markup_check.h"
#include "tests/support/synthetic_multi_contact.h"
#include "tests/support/tiny_law_table.h"
#include "tests/support/tiny_pipeline.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
using nlohmann::json;
using synthetic::law_entry;
namespace fs = std::filesystem;

class LawTableCalibrate : public LawTableFiles {};

MultiContactModel known() { return multi_contact_model(synthetic::multi_contact_law(LawForm::directional)); }

std::vector<MultiContactConfiguration> arrangements() {
  using synthetic::multi_contact_configuration;
  return {multi_contact_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.3),
          multi_contact_configuration(Arrangement::opposite, PartnerKind::plane, 0.0, 0.25),
          multi_contact_configuration(Arrangement::orthogonal, PartnerKind::plane, 0.0, 0.25),
          multi_contact_configuration(Arrangement::tetrahedron, PartnerKind::plane, 0.0, 0.2),
          multi_contact_configuration(Arrangement::cube, PartnerKind::plane, 0.0, 0.18),
          multi_contact_configuration(Arrangement::one, PartnerKind::solid, 1.0, 0.35),
          multi_contact_configuration(Arrangement::one, PartnerKind::soft, 1.0, 0.4)};
}

TEST_F(LawTableCalibrate, CalibrateFitsOneEntryPerFile) {
  synthetic::MultiContactOptionsKnown o;
  o.noise = 0.02;
  o.packings = 6;
  MultiContactMeasurements data = synthetic::multi_contact_measurements(known(), arrangements(), o);
  save_multi_contact(data, file("dense.h5"));
  for (PackingInfo& p : data.packings) p.solid_fraction -= 0.05;
  save_multi_contact(data, file("loose.h5"));
  const std::string out = " --quiet --set replicates=0 --out '" + file("out") + "'";
  const std::string both = "calibrate '" + file("dense.h5") + "' '" + file("loose.h5") + "'";
  expect(run_the_program(both + out), 0, {"laws at solid fraction 0.65", "laws at solid fraction 0.70", "(best)"});
  const softgrain::LawTable table = load_law_table(file("out") + "/law_table.toml");
  ASSERT_EQ(table.entries.size(), 2U);
  EXPECT_NEAR(table.entries[0].solid_fraction, 0.6525, 1e-12);
  EXPECT_NEAR(table.entries[1].find(LawForm::directional)->a.value, 0.7, 0.05);
  EXPECT_EQ(table.entries[0].find(LawForm::isotropic)->a.value, table.entries[1].find(LawForm::isotropic)->a.value);
  EXPECT_TRUE(fs::exists(file("out") + "/law_table.h5"));
  EXPECT_EQ(summary("out")["entries"].size(), 2U);
  EXPECT_EQ(summary("out")["status"], "good");
  EXPECT_EQ(table.entries[0].best, LawForm::directional);
  EXPECT_EQ(unbalanced_tags(read_text(file("out") + "/report.html")), "");
  expect(macro("macro", "", "--law '" + file("out") + "/law_table.toml'"), 0, {});
}

TEST_F(LawTableCalibrate, WrongInputsOfCalibrateAreRefused) {
  synthetic::MultiContactOptionsKnown o;
  o.noise = 0.02;
  o.packings = 3;
  const MultiContactMeasurements data = synthetic::multi_contact_measurements(known(), arrangements(), o);
  save_multi_contact(data, file("multi_contact.h5"));
  save(synthetic::measurements(4), file("measurements.h5"));
  const std::string multi_contact = "calibrate '" + file("multi_contact.h5") + "' ";
  const std::string out = " --quiet --set replicates=0 --out '" + file("out") + "'";
  expect(run_the_program(multi_contact + out), 2, {"only 3 packings, at least"});
  expect(run_the_program(multi_contact + "'" + file("multi_contact.h5") + "' --set min_packings=2" + out), 2,
         {"same solid fraction"});
  expect(run_the_program(multi_contact + "'" + file("measurements.h5") + "'" + out), 2, {"a run each"});
  expect(run_the_program(multi_contact + "--set replicats=1" + out), 2, {"replicats", "replicates"});
  expect(run_the_program(multi_contact + "--set discrepancy=0" + out), 2, {"discrepancy"});
}

/// The first measurement is kept in the run directory for the report: never over another input.
TEST_F(LawTableCalibrate, CalibrateNeverWritesOverItsInputs) {
  const auto path = [&](const std::string& name) { return file(name) + "/multi_contact.h5"; };
  for (const char* name : {"a", "b"}) fs::create_directory(file(name));
  synthetic::MultiContactOptionsKnown o;
  o.noise = 0.02;
  const MultiContactMeasurements data = synthetic::multi_contact_measurements(known(), arrangements(), o);
  for (const char* name : {"a", "b"}) save_multi_contact(data, path(name));
  const std::string before = read_text(path("b"));
  const std::string quick = " --quiet --set replicates=0 --out '" + file("b") + "'";
  expect(run_the_program("calibrate '" + path("a") + "' '" + path("b") + "'" + quick), 2,
         {path("b") + " is an input", "give another --out"});
  EXPECT_EQ(read_text(path("b")), before);
  // The first one may lie there: it is what is kept.
  const auto alone = run_the_program("calibrate '" + path("b") + "'" + quick);
  EXPECT_NE(alone.status, 2) << alone.output;
  EXPECT_EQ(read_text(path("b")), before);
  // So may no measurement bear the name of what is written.
  save(synthetic::measurements(4), file("a") + "/law.h5");
  expect(run_the_program("calibrate '" + file("a") + "/law.h5' --quiet --out '" + file("a") + "'"), 2,
         {"law.h5 is an input"});
}

TEST_F(LawTableCalibrate, LawTableScenesThatCannotEndInALawAreRefused) {
  const auto refused = [&](const std::string& from, const std::string& to, const std::vector<std::string>& words) {
    std::string text = std::string(kTinyLawTable) + kTinyLawFit;
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    write_text_atomic(file("table.toml"), text.replace(at, from.size(), to));
    expect(run_the_program("run '" + file("table.toml") + "' --quiet --out '" + file("out") + "'"), 2, words);
  };
  refused("arrangement = \"one\"\npartner = \"plane\"", "arrangement = \"orthogonal\"\npartner = \"plane\"",
          {"configuration", "needs one plane alone"});
  refused("min_packings = 2", "min_packings = 5", {"packings_max", "min_packings"});
  refused("replicates = 0", "replicates = 0\n[[variant]]\npackings = 2", {"beta", "a variant needs another"});
  refused("replicates = 0", "replicates = 0\n[[variant]]\nbeta = -1", {"beta = -1"});
  refused("replicates = 0", "replicates = 0\n[[plan]]\nconfiguration = \"one-plain\"\npackings = 4",
          {"configuration", "no [[configuration]] has this name"});
  refused("replicates = 0", "replicates = 0\n[[plan]]\nconfiguration = \"one-plane\"\ndepth = 1.5\npackings = 4",
          {"depth = 1.5"});
  refused("points = 4", "points = 4\norientations = 0", {"orientations = 0"});
  refused("min_packings = 2", "min_packings = 3\n[[variant]]\nbeta = 4\npackings = 2", {"packings", "min_packings"});
}

/// The multi-contact law is run beside the pair law of the run, each on the same bodies, and it is the one
/// that the macro command takes from the same table.
TEST_F(LawTableCalibrate, APipelineShowsTheLawOfATableBesideItsOwn) {
  std::string text = kTinyPipeline;
  text += "samples = 2\nresolved = false\n";
  write_text_atomic(file("alone.toml"), text);
  write_text_atomic(file("both.toml"), text + "[law]\ntable = \"law_table.toml\"\nrange = \"clamp\"\n");
  for (const std::string name : {"alone", "both"})
    expect(run_the_program("run '" + file(name + ".toml") + "' --quiet --out '" + file(name) + "'"), 3, {});
  const auto alone = load_macro(file("alone") + "/macro.h5");
  const auto both = load_macro(file("both") + "/macro.h5");
  const auto axial = [](const std::vector<MacroCurve>& curves, const std::string& engine) {
    std::vector<std::vector<double>> out;
    for (const MacroCurve& c : curves)
      if (c.engine == engine) out.push_back(c.stress_axial);
    return out;
  };
  ASSERT_EQ(axial(both, "law").size(), 2U);
  EXPECT_EQ(axial(both, "pair"), axial(alone, "law"));
  EXPECT_NE(axial(both, "law"), axial(alone, "law"));
  EXPECT_TRUE(summary("both").contains("pair"));
  EXPECT_FALSE(summary("alone").contains("pair"));
  for (const MacroCurve& c : both)
    EXPECT_EQ(c.law.form, c.engine == "pair" ? LawForm::pair : law_entry(0.70).best) << c.engine;
}

/// The same with a table that the run measures itself: it is the one that a scene of kind law-table makes of the same
/// tables, and what the pair law does is what it does without it.
TEST_F(LawTableCalibrate, APipelineMeasuresASmallTableOfItsOwn) {
  const std::string multi_contact =
      "[multi_contact]\nrelaxation = \"damped\"\nincrement = 0.05\npackings_min = 4\npackings_max = 4\npoints = 4\n"
      "[[configuration]]\narrangement = \"one\"\npartner = \"plane\"\noverlap = 0.45\n"
      "[[configuration]]\narrangement = \"cube\"\npartner = \"plane\"\noverlap = 0.3\n"
      "[[configuration]]\narrangement = \"one\"\npartner = \"solid\"\noverlap = 0.45\n"
      "[[configuration]]\narrangement = \"one\"\npartner = \"soft\"\noverlap = 0.55\n";
  const std::string text = std::string(kTinyPipeline) + "samples = 2\nresolved = false\n";
  write_text_atomic(file("alone.toml"), text);
  write_text_atomic(file("both.toml"),
                    text + multi_contact + "[calibrate.multi_contact]\nbest = \"isotropic\"\nreplicates = 10\n");
  std::string table =
      text.substr(0, text.find("[measure]")) + multi_contact + "[calibrate]\nbest = \"isotropic\"\nreplicates = 10\n";
  table.replace(table.find("\"pipeline\""), 10, "\"law-table\"");
  table.erase(table.find("count = 4\n"), 10);
  write_text_atomic(file("table.toml"), table);
  for (const std::string name : {"alone", "both"})
    expect(run_the_program("run '" + file(name + ".toml") + "' --quiet --out '" + file(name) + "'"), 3, {});
  expect(run_the_program("run '" + file("table.toml") + "' --quiet --out '" + file("table") + "'"), 0, {});
  const softgrain::LawTable own = load_law_table(file("both") + "/law_table.toml");
  const softgrain::LawTable apart = load_law_table(file("table") + "/law_table.toml");
  ASSERT_EQ(own.entries.size(), 1U);
  EXPECT_EQ(multi_contact_numbers(*own.entries[0].find(LawForm::isotropic)),
            multi_contact_numbers(*apart.entries[0].find(LawForm::isotropic)));
  std::map<std::string, std::vector<std::vector<double>>> axial;
  for (const MacroCurve& c : load_macro(file("both") + "/macro.h5")) axial[c.engine].push_back(c.stress_axial);
  std::vector<std::vector<double>> alone;
  for (const MacroCurve& c : load_macro(file("alone") + "/macro.h5")) alone.push_back(c.stress_axial);
  EXPECT_EQ(axial["pair"], alone);
  ASSERT_EQ(axial["law"].size(), 2U);
  EXPECT_NE(axial["law"], alone);
  EXPECT_TRUE(summary("both").contains("entries"));
  EXPECT_EQ(summary("both").at("multi_contact").at("configurations").size(), 4U);
  EXPECT_EQ(summary("both").at("pair").at("macro").at("law").at("form"), "pair");
}

/// Pressed in too little, nothing crosses its threshold: that is said, and the pair law goes on alone.
TEST_F(LawTableCalibrate, APipelineWithoutALawOfMultiContactsGoesOnWithItsPairLaw) {
  std::string text = std::string(kTinyPipeline) +
                     "resolved = false\n[multi_contact]\nrelaxation = \"damped\"\npackings_min = 4\n"
                     "packings_max = 4\npoints = 2\n[[configuration]]\narrangement = \"one\"\npartner = \"plane\"\n"
                     "overlap = 0.02\n";
  write_text_atomic(file("shallow.toml"), text);
  expect(run_the_program("run '" + file("shallow.toml") + "' --quiet --out '" + file("shallow") + "'"), 3,
         {"no multi-contact law", "press deeper"});
  EXPECT_FALSE(std::filesystem::exists(file("shallow") + "/law_table.toml"));
  EXPECT_FALSE(summary("shallow").contains("pair"));
  const auto curves = load_macro(file("shallow") + "/macro.h5");
  ASSERT_EQ(curves.size(), 1U);
  EXPECT_EQ(curves[0].law.form, LawForm::pair);
  EXPECT_GT(curves[0].stress_axial.back(), 0.0);
}

}  // namespace
