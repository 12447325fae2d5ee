// What the report of every kind has at its head and at its end, and the grading curve in between.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "pipelines/report/run_data.h"
#include "pipelines/run/run_context.h"
#include "tests/support/every_kind.h"
#include "tests/support/process.h"
#include "tests/support/program.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

/// The summary names the kind of the scene; where it does not, as in those of earlier versions, the scene in it does.
void summary_says_its_kind(const KindRuns& runs) {
  const std::string path = runs.out("a") + "/summary.json";
  const std::string kind = kind_of(Scene::parse(runs.kind().text, "scene")).name;
  auto summary = nlohmann::json::parse(read_text(path));
  EXPECT_EQ(summary.value("kind", ""), kind);
  report::RunData earlier;
  summary.erase("kind");
  earlier.summary = summary;
  EXPECT_EQ(earlier.kind(), kind);
}

class ReportEnds : public ::testing::TestWithParam<KindScene> {};

TEST_P(ReportEnds, EveryKindNamesItsMaterialAndSaysWhatToDoNext) {
  const KindRuns runs(GetParam());
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("a"))), GetParam().status));
  summary_says_its_kind(runs);
  const std::string html = read_text(runs.out("a") + "/report.html");
  const auto has = [&](const std::string& words) { return html.find(words) != std::string::npos; };
  const std::size_t next = html.find("<h2>What to do next</h2>");
  ASSERT_NE(next, std::string::npos);
  EXPECT_GT(next, html.find("<section id=\"provenance\""));
  const std::string steps = html.substr(next, html.find("</section>", next) - next);
  std::size_t lines = 0;
  for (std::size_t at = steps.find("<li>"); at != std::string::npos; at = steps.find("<li>", at + 1)) ++lines;
  EXPECT_EQ(lines, 2U) << steps;
  EXPECT_EQ(steps.find('`'), std::string::npos) << "commands are marked as such";
  EXPECT_TRUE(has("<dt>Material</dt>") || has("<dt>Grains</dt>") || has("Rs = ")) << "of what it is made";
  if (runs.kind().name == "macro" || runs.kind().name == "macro-comparison") {
    EXPECT_TRUE(has("<dt>Law used</dt>"));
    EXPECT_TRUE(has("hash ")) << "which law";
  }
  const std::set<std::string> bodies{"macro", "particles", "disks", "powder", "grain-box", "soft-particle"};
  if (bodies.contains(runs.kind().name)) {
    EXPECT_TRUE(has("Grading curve"));
  }
  // Whatever the kind leaves, a run that begins in the same directory finds nothing of it (but directories of variants,
  // which are runs of their own).
  (void)run_the_program("export '" + runs.out("a") + "' --to csv");
  remove_earlier_run(runs.out("a"), "run", {});
  std::set<std::string> left;
  for (const auto& entry : std::filesystem::directory_iterator(runs.out("a")))
    if (!std::filesystem::exists(entry.path() / "log.txt")) left.insert(entry.path().filename().string());
  left.erase(".lock");
  EXPECT_EQ(left, std::set<std::string>{"log.txt"});
}

INSTANTIATE_TEST_SUITE_P(Kinds, ReportEnds, ::testing::ValuesIn(quick_kinds()), name_of_kind);

}  // namespace
