// The report of a made-up run: the sections that its data allow, self-contained, escaped, well formed.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "common/contact/make_laws.h"
#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/io/csv_file.h"
#include "common/io/text_file.h"
#include "pipelines/kinds/soft_particle/scene.h"
#include "pipelines/report/law_curves.h"
#include "pipelines/report/plot_helpers.h"
#include "pipelines/report/report.h"
#include "pipelines/report/run_data.h"
#include "pipelines/run/run_context.h"
#include "tests/support/markup_check.h"
#include "tests/support/synthetic_multi_contact.h"
#include "tests/support/synthetic_run.h"

namespace softgrain {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSummary = R"json({
  "status": "good", "command": "run",
  "remarks": ["radii <script>alert(1)</script> & more"],
  "comparison": {"stress_error": 0.19, "speedup_seconds": 407.0, "speedup_contact_evaluations": 400.0},
  "calibration": {"seconds": 1.5},
  "files": {"law": "law.toml"},
  "provenance": {"version": "0.1.0", "commit": "abc", "compiler": "g++ -O3", "threads": 2, "seed": 5, "command": "softgrain run x.toml",
                 "scene": "kind = \"soft-particle\"  # <b>bold</b>"}
})json";

class Report : public ::testing::Test {
 protected:
  void SetUp() override {
    directory_ = fs::temp_directory_path() /
                 ("softgrain_report_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(directory_);
    fs::create_directories(directory_);
  }
  void TearDown() override { fs::remove_all(directory_); }

  [[nodiscard]] std::string path(const std::string& file) const { return (directory_ / file).string(); }
  [[nodiscard]] std::string written() const {
    write_report(directory_.string());
    return read_text(path("report.html"));
  }

  fs::path directory_;
};

void remove_all(std::string& text, const std::string& part) {
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part)) text.erase(at, part.size());
}

TEST_F(Report, AWholeRunHasAllSections) {
  save(synthetic::measurements(), path("measurements.h5"));
  save_card(synthetic::card(), path("law.toml"));
  save_macro(synthetic::macro(), path("macro.h5"));
  write_text_atomic(path("summary.json"), kSummary);
  std::string html = written();
  for (const char* id :
       {"notes", "laws", "normal", "tangential", "stiffness", "relaxations", "macro", "radii", "cost", "provenance"}) {
    EXPECT_TRUE(has_text(html, std::string("id=\"") + id + "\"")) << id;
  }
  EXPECT_TRUE(has_text(html, "seed 104"));
  EXPECT_TRUE(has_text(html, "solid grain of radius Rs"));
  EXPECT_TRUE(has_text(html, "N/degree"));
  EXPECT_EQ(unbalanced_tags(html), "");
  for (const char* bad : {">nan", " nan", "\"nan", "inf "}) EXPECT_FALSE(has_text(html, bad)) << bad;
  remove_all(html, "xmlns=\"http://www.w3.org/2000/svg\"");
  remove_all(html, "http-equiv=\"Content-Security-Policy\"");
  EXPECT_FALSE(has_text(html, "http"));
}

TEST_F(Report, CurvesCarryTheirValuesForTheScript) {
  save(synthetic::measurements(), path("measurements.h5"));
  save_card(synthetic::card(), path("law.toml"));
  save_macro(synthetic::macro(), path("macro.h5"));
  const std::string html = written();
  EXPECT_TRUE(has_text(html, "data-y-label=\"normal force Fn [N]\""));
  EXPECT_TRUE(has_text(html, "data-entry=\"one packing (12)\" data-name=\"packing 4 (seed 104)\" data-x=\"0.05,0.1,"));
  EXPECT_TRUE(has_text(html, "class=\"entry\" data-entry=\"one packing (12)\""));
  EXPECT_TRUE(has_text(html, "fitted: Δ = 0.05 to 0.3"));
  EXPECT_TRUE(has_text(html, "Law minus resolved twin, axial"));
  EXPECT_TRUE(has_text(html, "Error against cost"));
  EXPECT_TRUE(has_text(html, "default-src 'none'"));
}

TEST_F(Report, EveryCurveHasATableBesideThePageAndALinkToIt) {
  save(synthetic::measurements(), path("measurements.h5"));
  save_card(synthetic::card(), path("law.toml"));
  save_macro(synthetic::macro(), path("macro.h5"));
  const std::string html = written();
  EXPECT_FALSE(has_text(html, "<metadata")) << "tables are beside the page, not in it";
  std::size_t tables = 0;
  for (const auto& entry : fs::directory_iterator(directory_ / "curves")) {
    const std::string name = entry.path().stem();
    EXPECT_TRUE(has_text(html, "href=\"curves/" + name + ".csv\" download=\"" + name + ".csv\"")) << name;
    EXPECT_TRUE(fs::exists(path("figures/" + name + ".svg"))) << name;
    const CsvFile table = CsvFile::read(entry.path());
    ASSERT_GE(table.columns().size(), 4U) << name;
    EXPECT_EQ(table.columns()[1].title, "curve") << name;
    EXPECT_FALSE(table.rows().empty()) << name;
    ++tables;
  }
  EXPECT_GE(tables, 8U);
  const std::string forces = read_text(path("curves/fn-soft-particle-on-a-solid-plane.csv"));
  EXPECT_TRUE(has_text(forces, ",curve,normal overlap \u0394 = hn/Rs,normal force Fn [N],error bar [N],band low [N]"));
  EXPECT_TRUE(has_text(forces, "\none packing (12),packing 4 (seed 104),0.05"));
  EXPECT_FALSE(has_text(read_text(path("figures/fn-soft-particle-on-a-solid-plane.svg")), "<metadata"));
}

TEST_F(Report, TablesOfAnEarlierReportGoAndThoseOfTheReaderStay) {
  save(synthetic::measurements(), path("measurements.h5"));
  (void)written();
  const std::string one = "curves/fn-soft-particle-on-a-solid-plane.csv";
  const std::string kept = read_text(path(one));
  write_text_atomic(path("curves/fn-of-mine.csv"), kept);
  write_text_atomic(path("curves/data.csv"), "hn [mm],Fn [N]\n1,2\n");
  fs::remove(path("measurements.h5"));
  save_macro(synthetic::macro(), path("macro.h5"));
  fs::remove_all(path("figures"));
  (void)written();
  EXPECT_FALSE(fs::exists(path(one)));
  EXPECT_EQ(read_text(path("curves/fn-of-mine.csv")), kept);
  EXPECT_TRUE(fs::exists(path("curves/data.csv")));
  fs::remove(path("curves/fn-of-mine.csv"));
  fs::remove(path("curves/data.csv"));
  report::remove_figures(directory_.string());
  EXPECT_FALSE(fs::exists(path("curves")));
}

TEST_F(Report, TheHeadSaysWhatCameOutAndLinksToTheSections) {
  save(synthetic::measurements(), path("measurements.h5"));
  save_card(synthetic::card(), path("law.toml"));
  save_macro(synthetic::macro(), path("macro.h5"));
  write_text_atomic(path("summary.json"), kSummary);
  std::string html = written();
  const std::string head = html.substr(html.find("<h1>"), html.find("<section") - html.find("<h1>"));
  for (const char* part : {"status-good", "Rs = 16 mm", "12 packings at solid fraction", "soft-solid: Fn = a",
                           "Stress by the law differs", "href=\"#normal\"", "href=\"#macro\"", "href=\"#cost\""})
    EXPECT_TRUE(has_text(head, part)) << part;
  EXPECT_FALSE(has_text(head, "Do not use"));
  write_text_atomic(path("summary.json"), R"({"status": "not usable", "remarks": ["no law was found"]})");
  html = written();
  EXPECT_TRUE(has_text(html, "status-bad"));
  EXPECT_TRUE(has_text(html, "Do not use this result as it is:</strong> no law was found"));
}

TEST(ErrorCosts, LawAndRelaxationAgainstTheirReferences) {
  report::RunData run;
  run.macro = synthetic::macro();
  run.measurements = synthetic::measurements();
  const auto points = report::error_costs(run);
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[0].engine, "law");
  EXPECT_NEAR(points[0].error, 0.5 * (0.2 + (1.05 - 0.86) / 1.05), 0.01);
  EXPECT_NEAR(points[0].cost, 6.0e6 / 2.4e9, 1e-6);
  EXPECT_NEAR(points[1].error, 1.0 / 0.96 - 1.0, 0.02);
  EXPECT_NEAR(points[1].cost, 1.9e6 / 1.9e8, 1e-4);
}

/// A shell that moves may leave every neighbour: nothing was loaded then, and there is nothing to draw.
/// As the fit leaves them out.
TEST(TangentialFigure, HasNoPointThatDidNotConverge) {
  report::RunData run;
  run.summary = nlohmann::json::object();
  run.measurements = synthetic::measurements(4);
  const auto page = [&] { return report::tangential_section(run); };
  PackingRun& first = run.measurements->runs.front();
  for (const double angle : {-1.0, 0.0, 1.0}) first.tangential.push_back({0.3, angle, 5.0 * angle, 0.0, 0.0, true});
  const std::string good = page();
  ASSERT_FALSE(good.empty());
  first.tangential.push_back({0.3, 1.0, 1e3, 1e3, 1.0, false});
  EXPECT_EQ(page(), good);
}

TEST_F(Report, AMultiContactThatNeverTouchedIsLeftOut) {
  const MultiContactModel model = multi_contact_model(synthetic::multi_contact_law(LawForm::pair));
  MultiContactMeasurements data = synthetic::multi_contact_measurements(
      model,
      {synthetic::multi_contact_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.3),
       synthetic::multi_contact_configuration(Arrangement::cube, PartnerKind::plane, 0.0, 0.2)},
      {});
  data.configurations[1].centre_free = true;
  for (MultiContactRun& run : data.runs)
    if (run.configuration == 1)
      for (MultiContactPoint& p : run.points)
        for (double& x : p.overlap) x = -0.01;
  LawTableEntry entry = synthetic::law_entry();
  entry.solid_fraction = 0.0;
  for (const PackingInfo& p : data.packings)
    entry.solid_fraction += p.solid_fraction / static_cast<double>(data.packings.size());
  save_multi_contact(data, path("multi_contact.h5"));
  save_law_table({1, {entry}}, path("law_table.toml"));
  const std::string html = written();
  EXPECT_TRUE(has_text(html, "multi-contact-planes"));
  fs::rename(path("multi_contact.h5"), path("crowd.h5"));  // as earlier versions named it
  EXPECT_TRUE(has_text(written(), "multi-contact-planes"));
}

TEST_F(Report, TextsOfOthersAreEscaped) {
  write_text_atomic(path("summary.json"), kSummary);
  const std::string html = written();
  EXPECT_FALSE(has_text(html, "<script>alert"));
  EXPECT_TRUE(has_text(html, "&lt;script&gt;alert"));
  EXPECT_TRUE(has_text(html, "# &lt;b&gt;bold"));
}

TEST_F(Report, ASummaryAloneMakesAPage) {
  write_text_atomic(
      path("summary.json"),
      R"({"status": "not converged", "particles": [{"id": 0, "position": [0, 0, 1.5], "velocity": [0, 0, 0]}],
    "contacts": [{"pair": [0, 1], "duration": 1e-5, "max_force": 12.0, "max_overlap": 1e-6}]})");
  const std::string html = written();
  EXPECT_TRUE(has_text(html, "id=\"particles\""));
  EXPECT_TRUE(has_text(html, "id=\"contacts\""));
  EXPECT_TRUE(has_text(html, "not converged"));
  EXPECT_FALSE(has_text(html, "id=\"normal\""));
  EXPECT_EQ(unbalanced_tags(html), "");
}

TEST_F(Report, OddSummariesDoNotStopIt) {
  write_text_atomic(
      path("summary.json"),
      R"({"status": 7, "remarks": "none", "provenance": [1], "files": 3, "comparison": null, "particles": [1, "a"], "measurement": {"points": "many"}})");
  EXPECT_EQ(unbalanced_tags(written()), "");
}

TEST_F(Report, LawsOfTheSummaryStandInForACard) {
  write_text_atomic(path("summary.json"),
                    R"({"laws": {"soft-solid": {"normal": {"a": 0.5755, "a_interval": [0.5, 0.6], "b": 2.8}}}})");
  const std::string html = written();
  EXPECT_TRUE(has_text(html, "id=\"laws\""));
  EXPECT_TRUE(has_text(html, "0.5755"));
  EXPECT_TRUE(has_text(html, "0.5 .. 0.6"));
}

TEST_F(Report, UnusableResultsAreSaid) {
  auto card = synthetic::card();
  card.pairs[1].status = LawStatus::no_threshold_crossing;
  card.pairs[1].reason = "force is zero up to Delta 0.30";
  save_card(card, path("law.toml"));
  auto macro = synthetic::macro();
  macro[0].usable = false;
  macro[0].note = "step capped at 3000 iterations";
  save_macro(macro, path("macro.h5"));
  save(synthetic::measurements(4), path("measurements.h5"));
  const std::string html = written();
  EXPECT_TRUE(has_text(html, "force is zero up to Delta 0.30"));
  EXPECT_TRUE(has_text(html, "step capped at 3000 iterations"));
  EXPECT_TRUE(has_text(html, "did not reach their convergence criterion"));
  EXPECT_TRUE(has_text(html, "Only 4 packings"));
}

TEST_F(Report, OnePackingAndNoRadiiAreEnough) {
  auto data = synthetic::measurements(1);
  data.packings[0].radii.clear();
  save(data, path("measurements.h5"));
  const std::string html = written();
  EXPECT_EQ(unbalanced_tags(html), "");
  EXPECT_TRUE(has_text(html, "id=\"normal\""));
}

TEST_F(Report, NothingToReportIsFileTrouble) {
  EXPECT_THROW(write_report(directory_.string()), IoError);
  EXPECT_THROW(write_report(path("absent")), IoError);
  write_text_atomic(path("summary.json"), "{ half");
  EXPECT_THROW(write_report(directory_.string()), IoError);
}

TEST_F(Report, TheCommandLeavesTheSummaryOfTheRunAlone) {
  write_text_atomic(path("summary.json"), kSummary);
  CommonOptions options;
  options.inputs = {directory_.string()};
  options.quiet = true;
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(command_report(options), ExitStatus::good);
  EXPECT_TRUE(has_text(::testing::internal::GetCapturedStdout(), "report.html"));
  EXPECT_EQ(read_text(path("summary.json")), kSummary);
  options.inputs.clear();
  EXPECT_THROW(command_report(options), InputError);
}

TEST_F(Report, TheCompareCommandWritesASummary) {
  save_macro(synthetic::macro(), path("macro.h5"));
  CommonOptions options;
  options.inputs = {directory_.string(), path("macro.h5")};
  options.out = path("out");
  options.quiet = true;
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(command_compare(options), ExitStatus::good);
  EXPECT_TRUE(has_text(::testing::internal::GetCapturedStdout(), "law against law"));
  const auto summary = nlohmann::json::parse(read_text(path("out/summary.json")));
  EXPECT_EQ(summary["macro"][0]["axial_difference"]["mean"].get<double>(), 0.0);
  options.inputs[1] = path("absent");
  EXPECT_THROW(command_compare(options), IoError);
  write_text_atomic(path("notes.txt"), "x");
  options.inputs[1] = path("notes.txt");
  EXPECT_THROW(command_compare(options), InputError);
  options.inputs.clear();
  EXPECT_THROW(command_compare(options), InputError);
}

TEST(ReferenceCurves, PublishedLawAndItsScaling) {
  SoftParticleSpec spec;
  EXPECT_NEAR(report::published_normal_force(0.2, spec), 73.669 * std::pow(0.2, 2.799) - 0.035, 1e-12);
  EXPECT_EQ(report::published_normal_force(0.06, spec), 0.0);
  const double before = report::published_normal_force(0.2, spec);
  spec.youngs_modulus *= 2.0;
  spec.shell_radius *= 3.0;
  EXPECT_NEAR(report::published_normal_force(0.2, spec), 18.0 * before, 1e-9);
}

TEST(ReferenceCurves, HertzOfASolidGrain) {
  const SoftParticleSpec spec;
  const double h = 0.1 * spec.shell_radius;
  const double expected =
      4.0 / 3.0 * spec.youngs_modulus / (2.0 * (1.0 - 0.09)) * std::sqrt(spec.shell_radius) * std::pow(h, 1.5);
  EXPECT_NEAR(report::hertz_force(0.1, spec, PairKind::soft_solid), expected, 1e-12);
  EXPECT_NEAR(report::hertz_force(0.1, spec, PairKind::soft_soft), expected * std::sqrt(0.5), 1e-12);
}

TEST(LinearisedBand, MatchesFiniteDifferences) {
  PairLaw law = synthetic::pair_law(PairKind::soft_solid, synthetic::kA);
  law.covariance.assign(49, 0.0);
  law.covariance[16] = 1e-4 * 1e-4;  // only delta uncertain
  const auto band = linearised_band(law, LawPart::normal, {0.03, 0.2});
  ASSERT_TRUE(band.has_value());
  EXPECT_EQ(band->low[0], 0.0);
  const auto shifted = [&](double delta) {
    return synthetic::kA * (std::pow(0.2, synthetic::kB) - std::pow(delta, synthetic::kB));
  };
  const double slope = (shifted(synthetic::kDelta + 1e-6) - shifted(synthetic::kDelta - 1e-6)) / 2e-6;
  const double students = student95(law.packings - 1);  // of few packings
  EXPECT_NEAR(0.5 * (band->high[1] - band->low[1]), students * std::abs(slope) * 1e-4, 1e-9);
  EXPECT_GT(students, 1.96);
  law.covariance.assign(49, 0.0);
  EXPECT_FALSE(linearised_band(law, LawPart::normal, {0.2}).has_value());
}

}  // namespace
}  // namespace softgrain
