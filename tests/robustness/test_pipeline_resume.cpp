// A pipeline that is killed, stopped or given other threads ends with the same bits; one without usable laws says so.
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "common/core/random.h"
#include "common/data/law_card.h"
#include "common/data/macro_result.h"
#include "common/data/measurements.h"
#include "common/io/text_file.h"
#include "tests/support/process.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/tiny_pipeline.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
namespace fs = std::filesystem;

void expect_same(double a, double b, const std::string& what) {
  EXPECT_EQ(std::bit_cast<std::uint64_t>(a), std::bit_cast<std::uint64_t>(b)) << what << ": " << a << ", " << b;
}

void expect_same(const std::vector<double>& a, const std::vector<double>& b, const std::string& what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  for (std::size_t k = 0; k < a.size(); ++k) expect_same(a[k], b[k], what + " " + std::to_string(k));
}

void expect_same(const Cost& a, const Cost& b, const std::string& what) {
  EXPECT_EQ(a.loop_passes, b.loop_passes) << what;
  EXPECT_EQ(a.contact_evaluations, b.contact_evaluations) << what;
}

void expect_same(const PackingRun& a, const PackingRun& b, const std::string& what) {
  EXPECT_EQ(a.packing, b.packing) << what;
  EXPECT_EQ(a.kind, b.kind) << what;
  ASSERT_EQ(a.normal.size(), b.normal.size()) << what;
  for (std::size_t k = 0; k < a.normal.size(); ++k) {
    expect_same(a.normal[k].force, b.normal[k].force, what + " force");
    expect_same(a.normal[k].residual, b.normal[k].residual, what + " residual");
    expect_same(a.normal[k].max_overlap, b.normal[k].max_overlap, what + " overlap");
    EXPECT_EQ(a.normal[k].converged, b.normal[k].converged) << what;
  }
  ASSERT_EQ(a.tangential.size(), b.tangential.size()) << what;
  for (std::size_t k = 0; k < a.tangential.size(); ++k) {
    expect_same(a.tangential[k].force_parallel, b.tangential[k].force_parallel, what + " parallel force");
    expect_same(a.tangential[k].force_perpendicular, b.tangential[k].force_perpendicular,
                what + " perpendicular force");
  }
  expect_same(a.normal_cost, b.normal_cost, what);
  expect_same(a.tangential_cost, b.tangential_cost, what);
}

void expect_same_measurements(const std::string& a, const std::string& b) {
  const Measurements x = load_measurements(a + "/measurements.h5");
  const Measurements y = load_measurements(b + "/measurements.h5");
  ASSERT_EQ(x.packings.size(), y.packings.size());
  for (std::size_t k = 0; k < x.packings.size(); ++k) expect_same(x.packings[k].radii, y.packings[k].radii, "radii");
  ASSERT_EQ(x.runs.size(), y.runs.size());
  for (std::size_t k = 0; k < x.runs.size(); ++k) expect_same(x.runs[k], y.runs[k], "run " + std::to_string(k));
}

void expect_same_laws(const std::string& a, const std::string& b) {
  const LawCard x = load_card(a + "/law.toml");
  const LawCard y = load_card(b + "/law.toml");
  ASSERT_EQ(x.pairs.size(), y.pairs.size());
  for (std::size_t k = 0; k < x.pairs.size(); ++k) {
    expect_same(x.pairs[k].normal.a.value, y.pairs[k].normal.a.value, "a");
    expect_same(x.pairs[k].normal.b.value, y.pairs[k].normal.b.value, "b");
    expect_same(x.pairs[k].normal.delta.value, y.pairs[k].normal.delta.value, "delta");
    expect_same(x.pairs[k].normal.b.low, y.pairs[k].normal.b.low, "bootstrap");
    expect_same(x.pairs[k].tangential_initial.a.value, y.pairs[k].tangential_initial.a.value, "tangential a");
    expect_same(x.pairs[k].covariance, y.pairs[k].covariance, "covariance");
  }
}

void expect_same_macro(const std::string& a, const std::string& b) {
  const auto x = load_macro(a + "/macro.h5");
  const auto y = load_macro(b + "/macro.h5");
  ASSERT_EQ(x.size(), 2U);
  ASSERT_EQ(x.size(), y.size());
  for (std::size_t k = 0; k < x.size(); ++k) {
    EXPECT_EQ(x[k].strain.size(), 5U);
    expect_same(x[k].strain, y[k].strain, x[k].engine + " strain");
    expect_same(x[k].stress_axial, y[k].stress_axial, x[k].engine + " axial stress");
    expect_same(x[k].stress_lateral, y[k].stress_lateral, x[k].engine + " lateral stress");
    expect_same(x[k].stress_axial_contacts, y[k].stress_axial_contacts, x[k].engine + " contact stress");
    expect_same(x[k].residual, y[k].residual, x[k].engine + " residual");
    expect_same(x[k].cost, y[k].cost, x[k].engine);
  }
}

constexpr int kNotUsable = 3;  // what the tiny pipeline ends with

class PipelineResume : public ::testing::Test {
 protected:
  /// One run that nobody disturbs, for all tests.
  static void SetUpTestSuite() {
    shared_ = std::make_unique<TemporaryDirectory>();
    write_text_atomic(shared_->file("scene.toml"), kTinyPipeline);
    ASSERT_TRUE(ended_with(wait_for(start(whole(), false)), kNotUsable));
    ASSERT_TRUE(fs::exists(whole() + "/macro.h5"));
  }
  static void TearDownTestSuite() { shared_.reset(); }

  static std::string scene() { return shared_->file("scene.toml"); }
  static std::string whole() { return shared_->file("whole"); }

  static pid_t start(const std::string& out, bool resume, const std::string& threads = "1") {
    std::vector<std::string> arguments{"run", scene(), "--out", out, "--threads", threads, "--quiet"};
    if (resume) arguments.emplace_back("--resume");
    return start_program(arguments);
  }
  static void expect_same_end(const std::string& out) {
    expect_same_measurements(whole(), out);
    expect_same_laws(whole(), out);
    expect_same_macro(whole(), out);
    EXPECT_FALSE(fs::exists(out + "/work"));
    EXPECT_TRUE(fs::exists(out + "/report.html"));
  }
  /// Kills after a random part of `longest` seconds, resumes, kills..., then lets it end.
  static int kill_and_resume(const std::string& out, std::uint64_t stream, const std::string& threads) {
    RandomStream random(30, RandomPurpose::test, stream);
    int kills = 0;
    for (int attempt = 0; attempt < 40; ++attempt) {
      const pid_t child = start(out, attempt > 0, threads);
      const int status = kills < 5 ? signal_after(child, 0.1 + 0.5 * random.uniform(), SIGKILL) : wait_for(child);
      if (WIFEXITED(status)) {
        EXPECT_EQ(WEXITSTATUS(status), kNotUsable);
        break;
      }
      ++kills;
    }
    return kills;
  }

  TemporaryDirectory directory_;
  static std::unique_ptr<TemporaryDirectory> shared_;
};
std::unique_ptr<TemporaryDirectory> PipelineResume::shared_;

TEST_F(PipelineResume, KilledAtRandomAndResumedIsBitwiseTheSame) {
  for (const std::uint64_t stream : {1U, 2U}) {
    const std::string out = directory_.file("killed" + std::to_string(stream));
    EXPECT_GE(kill_and_resume(out, stream, stream == 1 ? "1" : "2"), 1);
    expect_same_end(out);
  }
}

TEST_F(PipelineResume, AnInterruptedRunSaysSoAndGoesOn) {
  const std::string out = directory_.file("stopped");
  const auto begun = [&] { return fs::exists(out + "/work") && !fs::is_empty(out + "/work"); };
  ASSERT_TRUE(ended_with(signal_when(start(out, false), begun, SIGINT), 130));
  EXPECT_TRUE(begun());
  EXPECT_FALSE(fs::exists(out + "/summary.json"));
  ASSERT_TRUE(ended_with(wait_for(start(out, true)), kNotUsable));
  expect_same_end(out);
}

/// Stopped inside the macro part: what was measured is not measured again.
TEST_F(PipelineResume, InterruptedInTheMacroPartItGoesOnThere) {
  const std::string out = directory_.file("stopped");
  const auto begun = [&] { return fs::exists(fs::path(out) / "work" / "macro-shelled-0.h5"); };
  ASSERT_TRUE(interrupted_in_the_middle([&] { return start(out, false); }, begun, out));
  ASSERT_TRUE(ended_with(wait_for(start(out, true)), kNotUsable));
  expect_same_end(out);
}

TEST_F(PipelineResume, ThreadsDoNotMatter) {
  const std::string out = directory_.file("two");
  ASSERT_TRUE(ended_with(wait_for(start(out, false, "2")), kNotUsable));
  expect_same_end(out);
}

/// The least-work relaxation keeps nothing between recorded points that is not in the checkpoint.
TEST_F(PipelineResume, LeastWorkGoesOnWithTheSameBits) {
  const auto begin = [&](const std::string& out, bool resume) {
    std::vector<std::string> arguments{"run",       scene(),
                                       "--out",     directory_.file(out),
                                       "--threads", "1",
                                       "--set",     "measure.relaxation=least-work",
                                       "--set",     "measure.damped={}",
                                       "--quiet"};
    if (resume) arguments.emplace_back("--resume");
    return start_program(arguments);
  };
  ASSERT_TRUE(ended_with(wait_for(begin("undisturbed", false)), kNotUsable));
  const std::string work = directory_.file("stopped") + "/work";
  const auto begun = [&] { return fs::exists(work) && !fs::is_empty(work); };
  ASSERT_TRUE(ended_with(signal_when(begin("stopped", false), begun, SIGINT), 130));
  ASSERT_TRUE(ended_with(wait_for(begin("stopped", true)), kNotUsable));
  expect_same_measurements(directory_.file("undisturbed"), directory_.file("stopped"));
}

TEST_F(PipelineResume, AnotherSeedIsAnotherResult) {
  const std::string out = directory_.file("other");
  (void)run_the_program("run '" + scene() + "' --out '" + out + "' --quiet --threads 1 --seed 2");
  const Measurements x = load_measurements(whole() + "/measurements.h5");
  const Measurements y = load_measurements(out + "/measurements.h5");
  EXPECT_NE(x.runs[0].normal.back().force, y.runs[0].normal.back().force);
}

TEST_F(PipelineResume, ARunOfAnotherSceneIsNotGoneOnWith) {
  const std::string out = directory_.file("stopped");
  const auto begun = [&] { return fs::exists(out + "/work") && !fs::is_empty(out + "/work"); };
  ASSERT_TRUE(ended_with(signal_when(start(out, false), begun, SIGINT), 130));
  const auto outcome =
      run_the_program("run '" + scene() + "' --out '" + out + "' --quiet --resume --set material.mu=0.4");
  EXPECT_EQ(outcome.status, 2) << outcome.output;
  EXPECT_NE(outcome.output.find("another scene"), std::string::npos) << outcome.output;
}

std::string remarks_of(const nlohmann::json& summary) {
  std::string text;
  for (const auto& r : summary["remarks"]) text += r.get<std::string>() + "\n";
  return text;
}

/// The whole is marked, with the reason, in the summary that programs read.
TEST_F(PipelineResume, AnUnderdeterminedLawIsMarked) {
  const auto summary = summary_of(whole());
  EXPECT_EQ(summary["status"], "not usable");
  EXPECT_NE(remarks_of(summary).find("soft-soft law: underdetermined"), std::string::npos) << remarks_of(summary);
}

/// Overlaps too small for any force: the run ends well-ordered, with status 3, its data and the reason, and without
/// macro part.
TEST_F(PipelineResume, NoThresholdCrossingIsStatusThreeAndWritten) {
  const std::string out = directory_.file("shallow");
  const auto outcome = run_the_program(
      "run '" + scene() + "' --out '" + out +
      "' --quiet --set measure.soft_solid.deltas=[0.005,0.01,0.02] --set measure.soft_solid.tangential_deltas=[0.02]"
      " --set measure.soft_soft.deltas=[0.01,0.02]");
  EXPECT_EQ(outcome.status, 3) << outcome.output;
  const auto summary = summary_of(out);
  EXPECT_EQ(summary["status"], "not usable");
  EXPECT_NE(remarks_of(summary).find("soft-solid law: no threshold crossing"), std::string::npos)
      << remarks_of(summary);
  EXPECT_NE(remarks_of(summary).find("no macro run"), std::string::npos) << remarks_of(summary);
  EXPECT_EQ(load_measurements(out + "/measurements.h5").runs.size(), 8U);
  EXPECT_EQ(load_card(out + "/law.toml").pairs.at(0).status, LawStatus::no_threshold_crossing);
}

/// One point of tangential stiffness makes no law: the card says that it was not fitted and can be read again.
TEST_F(PipelineResume, AnUnfittedTangentialPartIsSaidInSummaryAndCard) {
  const std::string out = directory_.file("one");
  const auto outcome = run_the_program("run '" + scene() + "' --out '" + out +
                                       "' --quiet --set measure.soft_solid.tangential_deltas=[0.1]");
  EXPECT_EQ(outcome.status, 3) << outcome.output;
  EXPECT_NE(remarks_of(summary_of(out)).find("soft-solid law: underdetermined: initial tangential stiffness"),
            std::string::npos)
      << outcome.output;
  const PairLaw law = load_card(out + "/law.toml").pairs.at(0);
  EXPECT_FALSE(law.has_tangential_initial);
  EXPECT_GT(law.normal.a.value, 0.0);
  EXPECT_EQ(load_macro(out + "/macro.h5").size(), 2U);
}

}  // namespace
