// Error bars of macro runs through the program: both estimators, parts, what cannot be had, stopping.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/core/statistics.h"
#include "common/data/macro_band.h"
#include "common/io/text_file.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"

namespace softgrain {
namespace {

using test::run_the_program;
using test::TemporaryDirectory;
namespace fs = std::filesystem;

const std::string kTable = std::string(SOFTGRAIN_SOURCE_DIR) + "/results/law_table/law_table.toml";

class MacroBands : public testing::Test {
 protected:
  void SetUp() override {
    write_text_atomic(directory_.file("scene.toml"), R"(kind = "macro"
law = ")" + kTable + R"("
[macro]
bodies = 20
strain = 0.12
steps = 3
increments_per_step = 2
resolved = false
)");
  }
  auto run(const std::string& name, const std::string& more) {
    return run_the_program("macrosim '" + directory_.file("scene.toml") + "' --quiet --out '" + directory_.file(name) +
                           "' " + more);
  }
  MacroCurve curve(const std::string& name) { return load_macro(directory_.file(name) + "/macro.h5").at(0); }
  static MacroBand band(const MacroCurve& c, BandPart part) { return band_of(c, BandOf::axial, part).value(); }

  TemporaryDirectory directory_;
};

double width(const MacroBand& b) { return b.high.back() - b.low.back(); }

/// Slope of the changes that draws make by one estimate over those by the other, at the end of the curve.
double slope_of_draws(const MacroCurve& few, const MacroCurve& all) {
  double product = 0.0;
  double square = 0.0;
  for (std::size_t r = 0; r < all.drawn_axial.size(); ++r) {
    const double change = all.drawn_axial[r].back() - all.stress_axial.back();
    product += change * (few.drawn_axial[r].back() - few.stress_axial.back());
    square += change * change;
  }
  return product / square;
}

/// Ten runs in place of a run for every draw; the parts add up, and the curve itself is not touched.
TEST_F(MacroBands, AFewRunsGiveTheBandOfAllDraws) {
  ASSERT_EQ(run("none", "").status, 0);
  ASSERT_EQ(run("few", "--bands 32").status, 0);
  ASSERT_EQ(run("all", "--bands 32 --set macro.band_estimator=draws").status, 0);
  const MacroCurve few = curve("few");
  EXPECT_EQ(few.stress_axial, curve("none").stress_axial);
  EXPECT_FALSE(band_of(curve("none"), BandOf::axial, BandPart::all));
  const double by_few = width(band(few, BandPart::law));
  const double by_all = width(band(curve("all"), BandPart::law));
  EXPECT_GT(by_few, 0.4 * by_all);
  EXPECT_LT(by_few, 2.5 * by_all);
  EXPECT_NEAR(slope_of_draws(few, curve("all")), 1.0, 0.4);
  const double stress = few.stress_axial.back();
  const MacroBand law = band(few, BandPart::law);
  const MacroBand off = band(few, BandPart::discrepancy);
  const MacroBand all = band(few, BandPart::all);
  EXPECT_GT(width(off), 0.02 * stress);
  EXPECT_NEAR(all.high.back() - stress, std::hypot(law.high.back() - stress, off.high.back() - stress), 1e-9 * stress);
  EXPECT_LT(all.low.back(), stress);
  ASSERT_EQ(few.drawn_axial.size(), 32U);
  std::vector<double> ends;
  for (const std::vector<double>& draw : few.drawn_axial) ends.push_back(draw.back());
  EXPECT_EQ(std::max(stress, quantile(ends, 0.975)), law.high.back()) << "the draws are in the file";
  EXPECT_FALSE(band_of(few, BandOf::axial, BandPart::noise)) << "nothing was run twice";
}

/// The plan names configurations of the scene, is cheaper than packings of all alike, and does what it says.
TEST_F(MacroBands, APlanSaysWhatToMeasureNext) {
  ASSERT_EQ(run("planned", "--bands 32").status, 0);
  const std::string plan = "law plan '" + kTable + "' --measure '" + SOFTGRAIN_SOURCE_DIR +
                           "/pipelines/law_table.toml' --for '" + directory_.file("planned") + "' ";
  const auto by_run = run_the_program(plan + "--json");
  ASSERT_EQ(by_run.status, 0) << by_run.output;
  const auto told = nlohmann::json::parse(by_run.output);
  EXPECT_EQ(told["draws"], 32);
  EXPECT_EQ(told["curves"], 1);
  EXPECT_GT(told["law_part"].get<double>(), 0.01);
  EXPECT_GT(told["candidates"].size(), 60U);
  ASSERT_FALSE(told["plan"].empty());
  double share = 1.0;
  for (const auto& step : told["plan"]) {
    EXPECT_LT(step["share"].get<double>(), share);
    share = step["share"].get<double>();
    EXPECT_EQ(step["packings"].get<int>() % 8, 0);
  }
  EXPECT_LT(share, 0.9);
  EXPECT_GT(told["core_seconds_alike"].get<double>(), told["core_seconds"].get<double>());
  const std::string text = run_the_program(plan).output;
  EXPECT_NE(text.find("plan, one after the other"), std::string::npos) << text;
  for (const auto& candidate : told["candidates"])
    EXPECT_NE(candidate["configuration"], "icosahedron-plane-free") << "no fit sees what is held out";
  // Refits of another law say nothing of these draws, even where its best numbers are the same.
  fs::create_directory(directory_.file("other"));
  fs::copy_file(fs::path(kTable).replace_extension(".h5"), directory_.file("other/law_table.h5"));
  write_text_atomic(directory_.file("other/law_table.toml"), read_text(kTable) + "# of other draws\n");
  const auto other = run_the_program("law plan '" + directory_.file("other") + plan.substr(plan.find("' --measure")));
  EXPECT_EQ(other.status, 2) << other.output;
  EXPECT_NE(other.output.find("was run with another law"), std::string::npos) << other.output;
  for (const char* idle : {"--json --toml", "--out never"}) {
    const auto refused = run_the_program(plan + idle);
    EXPECT_EQ(refused.status, 2) << refused.output;
  }
  // A run that does not say its law is taken, with a note.
  fs::remove(directory_.file("planned/.run"));
  EXPECT_NE(run_the_program(plan).output.find("does not say which law"), std::string::npos);
  // As tables of the scene: what it has and what the plan adds.
  const std::string scene = read_text(std::string(SOFTGRAIN_SOURCE_DIR) + "/pipelines/law_table.toml");
  write_text_atomic(directory_.file("more.toml"), scene + run_the_program(plan + "--toml").output);
  const auto checked = run_the_program("check '" + directory_.file("more.toml") + "'");
  EXPECT_EQ(checked.status, 0) << checked.output;
  EXPECT_NE(checked.output.find("as planned"), std::string::npos) << checked.output;
}

TEST_F(MacroBands, BitsDoNotDependOnThreads) {
  ASSERT_EQ(run("one", "--bands 12 --threads 1 --set macro.noise_samples=1").status, 0);
  ASSERT_EQ(run("three", "--bands 12 --threads 3 --set macro.noise_samples=1").status, 0);
  for (const BandPart part : {BandPart::law, BandPart::discrepancy, BandPart::noise, BandPart::all}) {
    EXPECT_EQ(band(curve("one"), part).low, band(curve("three"), part).low) << to_string(part);
    EXPECT_EQ(band(curve("one"), part).high, band(curve("three"), part).high) << to_string(part);
  }
}

TEST_F(MacroBands, WhatCannotBeDrawnIsRefusedBeforeAnyWork) {
  const auto refused = [&](const std::string& more, const std::string& says) {
    const auto r = run("refused", more);
    EXPECT_EQ(r.status, 2) << more;
    EXPECT_NE(r.output.find(says), std::string::npos) << r.output;
  };
  refused("--bands 5000", "refits of its");
  refused("--set macro.bands=3", "say nothing of a 95 % band");
  // A table beside which there is no .h5.
  write_text_atomic(directory_.file("alone.toml"), read_text(kTable));
  refused("--bands 16 --law '" + directory_.file("alone.toml") + "'", "keeps no refits");
}

}  // namespace
}  // namespace softgrain
