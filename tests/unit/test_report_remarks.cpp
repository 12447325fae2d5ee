// What the report says to be careful with holds for the law, the soft particle and the measurement of the run itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/data/law_words.h"
#include "pipelines/kinds/law_table/scene.h"
#include "pipelines/kinds/macro/scene.h"
#include "pipelines/kinds/soft_particle/scene.h"
#include "pipelines/report/run_data.h"
#include "pipelines/report/sections.h"
#include "pipelines/results/summary.h"
#include "tests/support/markup_check.h"
#include "tests/support/synthetic_multi_contact.h"
#include "tests/support/synthetic_run.h"

namespace softgrain {
namespace {

std::string all_of(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

std::vector<MacroCurve> curves_with(LawForm form) {
  std::vector<MacroCurve> curves = synthetic::macro();
  for (MacroCurve& c : curves)
    if (c.engine == "law") c.law = {form, 0.7, 5e5, 0.3, 0.3, "numbers"};
  return curves;
}

TEST(PairLawRemark, GivesWhatWasMeasuredForTheCommittedTable) {
  const LawTable table = load_law_table(SOFTGRAIN_SOURCE_DIR "/results/law_table/law_table.toml");
  std::vector<double> missed;
  double among_soft = 0.0;
  for (const ConfigurationError& e : main_entry(table).find(LawForm::pair)->errors) {
    if (e.name.starts_with("one-")) continue;
    if (e.name.ends_with("-pressed"))
      among_soft = std::max(among_soft, 1.0 / e.end_ratio);
    else
      missed.push_back(1.0 / e.end_ratio);
  }
  std::sort(missed.begin(), missed.end());
  EXPECT_NEAR(missed.front(), kPairLawMissesLeast, 0.05);
  EXPECT_NEAR(missed.back(), kPairLawMissesMost, 0.5);
  EXPECT_NEAR(among_soft, kPairLawMissesAmongSoft, 0.5);
  EXPECT_TRUE(has_text(pair_law_remark(), "2.2 to 12 times")) << pair_law_remark();
}

/// Runs that ended early say nothing of the end, neither their stress nor their strain.
TEST(MacroLine, IsOfUsableRuns) {
  const auto line = [](const std::vector<bool>& usable) {
    report::RunData run;
    for (std::size_t k = 0; k < usable.size(); ++k) {
      MacroCurve& c = run.macro.emplace_back();
      c.engine = "law";
      c.sample = static_cast<std::int64_t>(k);
      c.usable = usable[k];
      c.strain = {0.0, usable[k] ? 0.3 : 0.1};
      c.stress_axial = {0.0, usable[k] ? 500.0 : 900.0};
    }
    return macro_results().lines(run).at(0).second;
  };
  EXPECT_EQ(line({false, true, false}), "Axial stress 500 Pa at strain 0.3 (oedometric; 1 sample; 2 not usable).");
  EXPECT_TRUE(has_text(line({true, true}), "at strain 0.3 (oedometric; 2 samples, mean)"));
  EXPECT_EQ(line({false}), "No usable run.");
}

TEST(MacroRemarks, ThePairLawIsRemarkedOnWhereItWasUsed) {
  EXPECT_TRUE(has_text(all_of(macro_remarks(curves_with(LawForm::pair))), pair_law_remark()));
  EXPECT_TRUE(has_text(all_of(macro_remarks(curves_with(LawForm::pair))), "is taken as the friction limit"));
  for (const LawForm form : {LawForm::isotropic, LawForm::directional}) {
    const std::string said = all_of(macro_remarks(curves_with(form)));
    EXPECT_FALSE(has_text(said, "one contact")) << to_string(form) << ": " << said;
    EXPECT_FALSE(has_text(said, "against a plane")) << to_string(form) << ": " << said;
  }
}

TEST(ReportRemarks, ThePairLawIsRemarkedOnWhereItWasUsed) {
  report::RunData run;
  run.summary = nlohmann::json::object();
  run.macro = curves_with(LawForm::pair);
  EXPECT_TRUE(has_text(report::notes_section(run), "2.2 to 12 times"));
  run.macro = curves_with(LawForm::directional);
  EXPECT_EQ(report::notes_section(run), "");
}

TEST(ReportMacro, NamesTheLawOfItsCurves) {
  report::RunData run;
  run.macro = curves_with(LawForm::directional);
  EXPECT_TRUE(has_text(report::macro_section(run), "directional law at solid fraction 0.7000"));
  EXPECT_TRUE(has_text(report::macro_section(run), "mu = 0.3, used with E = 500000 Pa; hash numbers"));
  run.macro = synthetic::macro();
  EXPECT_TRUE(has_text(report::macro_section(run), "not recorded"));
}

TEST(ReportNormal, ThePublishedLawIsOfThePublishedSoftParticle) {
  report::RunData run;
  run.measurements = synthetic::measurements();
  const std::string same = report::normal_section(run);
  EXPECT_TRUE(has_text(same, "which are those of this run."));
  EXPECT_FALSE(has_text(same, "another soft particle"));
  run.measurements->spec.beta = 2.0;  // not published
  EXPECT_EQ(report::normal_section(run), same);
  const std::vector<std::pair<const char*, std::function<void(SoftParticleSpec&)>>> changes{
      {"exponent of the radii: 3 against 3.5", [](SoftParticleSpec& s) { s.exponent = 3.0; }},
      {"polydispersity: 5 against 10", [](SoftParticleSpec& s) { s.polydispersity = 5.0; }},
      {"nu of the grains: 0.2 against 0.3", [](SoftParticleSpec& s) { s.poisson_ratio = 0.2; }},
      {"mu of the grains: 0.5 against 0.3", [](SoftParticleSpec& s) { s.friction = 0.5; }}};
  for (const auto& [says, change] : changes) {
    run.measurements = synthetic::measurements();
    change(run.measurements->spec);
    const std::string other = report::normal_section(run);
    EXPECT_TRUE(has_text(other, "published law (another soft particle)")) << says;
    EXPECT_TRUE(has_text(other, says)) << says;
  }
}

TEST(ReportLawTable, SaysWhatWasNotMeasured) {
  report::RunData run;
  run.law_table = LawTable{1, {synthetic::law_entry(0.7)}};
  const std::string measured = report::law_table_section(run);
  EXPECT_TRUE(has_text(measured, "unloading is 1.50 times as steep as loading"));
  EXPECT_FALSE(has_text(measured, "not measured"));
  LawTableEntry& entry = run.law_table->entries[0];
  entry.unloading_measured = false;
  entry.slide_solid = {synthetic::unknown(0.25), synthetic::unknown(0.35), false};
  const std::string missing = report::law_table_section(run);
  EXPECT_TRUE(has_text(missing, "unloading was not measured"));
  EXPECT_FALSE(has_text(missing, "as steep as loading"));
  EXPECT_TRUE(has_text(missing, "not measured against solid spheres (0.35, 0.25 taken instead)"));
}

}  // namespace
}  // namespace softgrain
