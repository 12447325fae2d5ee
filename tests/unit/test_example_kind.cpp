// The example of a kind (tests/example_kind), from which tests/new_kind.py makes new ones: all that the table of kinds
// asks of a kind does what it should.
#include <gtest/gtest.h>

#include <filesystem>

#include "common/core/error.h"
#include "common/io/text_file.h"
#include "pipelines/report/run_data.h"
#include "tests/example_kind/scene.h"
#include "tests/example_kind/summary.h"
#include "tests/support/temporary_directory.h"

namespace softgrain {
namespace {

constexpr const char* kScene = R"(kind = "example"
title = "Glass beads"
[grain]
radius = "5 mm"
E = "70 GPa"
nu = 0.2
[impacts]
speeds = [0.1, 1.0, 10.0]
)";

class ExampleKind : public ::testing::Test {
 protected:
  ExampleKind() { write_text_atomic(directory_.file("scene.toml"), kScene); }

  ExitStatus run(const std::string& out, bool resume = false) const {
    CommonOptions options;
    options.inputs = {directory_.file("scene.toml")};
    options.out = directory_.file(out);
    options.quiet = true;
    options.resume = resume;
    ::testing::internal::CaptureStdout();
    const ExitStatus status = example_kind().run(Scene::load(options.inputs[0]), options);
    console_ = ::testing::internal::GetCapturedStdout();
    return status;
  }

  test::TemporaryDirectory directory_;
  mutable std::string console_;
};

TEST_F(ExampleKind, RunsAndReportsWhatItsSummaryHolds) {
  ASSERT_EQ(run("out"), ExitStatus::good);
  const report::RunData data = report::load_run(directory_.file("out"));
  EXPECT_EQ(data.kind(), "example");
  const auto summary = data.summary_as<ExampleSummary>();
  ASSERT_EQ(summary.impacts.size(), 3U);
  // 2.868 (m^2/(R E*^2 v))^(1/5) at 1 m/s by hand: m = 1.309e-3 kg, E* = 72.92 GPa.
  EXPECT_NEAR(summary.impacts[1].closed_form, 2.6268e-5, 2e-9);
  for (const ExampleImpact& i : summary.impacts) EXPECT_NEAR(i.duration / i.closed_form, 1.0, 1e-3) << i.speed;
  EXPECT_NE(console_.find("1 m/s: contact of"), std::string::npos) << console_;
  EXPECT_NE(read_text(directory_.file("out") + "/impacts.csv").find("speed [m/s]"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(directory_.file("out") + "/work")) << "kept tasks go at the end";
  const KindResults results = example_results();
  EXPECT_NE(results.sections.front().html(data).find("<section id=\"example\""), std::string::npos);
  EXPECT_EQ(results.values(data).size(), 3U);
  EXPECT_EQ(results.lines(data).front().first, "Grains");
  EXPECT_EQ(results.next(data).size(), 2U);
}

TEST_F(ExampleKind, GoesOnWithWhatItKept) {
  ASSERT_EQ(run("out"), ExitStatus::good);
  const std::string whole = read_text(directory_.file("out") + "/impacts.csv");
  ASSERT_EQ(run("out", true), ExitStatus::good);
  EXPECT_EQ(read_text(directory_.file("out") + "/impacts.csv"), whole);
}

TEST_F(ExampleKind, ChecksWithoutRunning) {
  Findings out;
  example_kind().check(Scene::parse(kScene, "s"), {}, out);
  EXPECT_EQ(out.facts["impacts"], 3);
}

/// As the test Kinds asks of every kind in the table: a kind that is made from the example passes it.
TEST_F(ExampleKind, ExplainsEveryMemberOfItsSummary) {
  ASSERT_NE(example_kind().summary, nullptr);
  std::size_t numbers = 0;
  for (const RecordMember& m : example_kind().summary()) {
    EXPECT_NE(m.meaning, "") << m.path;
    if (!m.path.starts_with("impacts[].")) continue;
    ++numbers;
    EXPECT_NE(m.unit, "") << m.path;
  }
  EXPECT_EQ(numbers, 3U);
}

TEST_F(ExampleKind, SaysAllMistakesAtOnce) {
  try {
    example_kind().read(Scene::parse("kind = \"example\"\n[grain]\nraduis = 1\nE = -1\n[impacts]\nspeeds = []\n", "s"));
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(),
                 "s:2: missing key 'radius' in [grain]; did 'raduis' at s:3 mean it?\n"
                 "s:4: E = -1: must be above 0\n"
                 "s:6: speeds = []: at least one is needed");
  }
}

}  // namespace
}  // namespace softgrain
