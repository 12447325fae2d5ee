// What a run says of itself: log.txt has what the terminal had, a run that broke off says status and reason, and the
// report of a run that was stopped does not look like one of results.
#include <gtest/gtest.h>
#include <omp.h>
#include <sys/stat.h>

#include <filesystem>
#include <sstream>

#include "common/io/progress.h"
#include "tests/support/every_kind.h"
#include "tests/support/process.h"
#include "tests/support/program.h"
#include "tests/support/unwrapped.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
namespace fs = std::filesystem;

bool has(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }

TEST(RunLog, HasWhatTheTerminalSaid) {
  const KindRuns runs({"macro", "macrosim", kTinyMacro, 0});
  const std::string command = "macrosim '" + runs.out("scene.toml") + "' --out '" + runs.out("out") + "' ";
  const std::string threads = "--threads " + std::to_string(omp_get_num_procs() + 1);
  const ProgramOutcome done = run_the_program(command + threads + " --set macro.steps=2");
  ASSERT_EQ(done.status, 0) << done.output;
  const std::string log = log_of(runs.out("out"));
  EXPECT_TRUE(has(log.substr(0, log.find('\n')), " softgrain ")) << log;
  for (const char* words : {"--set macro.steps=2", "seed 1", "scene.toml", "bodies = 6", "steps = 2",
                            "preparing macro samples: begins", "preparing macro samples: done",
                            "macro with laws: begins", "macro: resolved twins: done", "warning: --threads"})
    EXPECT_TRUE(has(log, words)) << words << " not in\n" << log;
  std::istringstream said(done.output);
  for (std::string line; std::getline(said, line);)
    if (!has(line, " so far")) {  // of stages the log has beginning and end
      EXPECT_TRUE(has(log, line)) << line << " not in\n" << log;
    }
  // A quiet run says the same to its log.
  ASSERT_EQ(run_the_program(command + "--quiet --set macro.steps=2").status, 0);
  EXPECT_TRUE(has(log_of(runs.out("out")), "macro with laws: done"));
}

std::size_t count_of(const std::string& text, const std::string& line_begin) {
  std::size_t n = text.starts_with(line_begin) ? 1 : 0;
  for (std::size_t at = text.find("\n" + line_begin); at != std::string::npos;
       at = text.find("\n" + line_begin, at + 1))
    ++n;
  return n;
}

class ConsoleSummary : public ::testing::TestWithParam<KindScene> {};

/// Lines that a terminal shows whole (but for file names), five warnings at most, notes in the log and the report.
TEST_P(ConsoleSummary, IsShort) {
  const KindRuns runs(GetParam());
  const std::string command = GetParam().command + " '" + runs.out("scene.toml") + "' --out '" + runs.out("out") + "'";
  const ProgramOutcome done = run_the_program(command);
  ASSERT_EQ(done.status, GetParam().status) << done.output;
  std::istringstream said(done.output);
  for (std::string line; std::getline(said, line);)
    if (!has(line, runs.out("out"))) {
      EXPECT_LE(line.size(), 100U) << line;
    }
  EXPECT_LE(count_of(done.output, "warning: "), 5U) << done.output;
  EXPECT_EQ(count_of(done.output, "note: "), 0U) << done.output;
  const auto summary = nlohmann::json::parse(read_text(runs.out("out") + "/summary.json"));
  const std::string log = log_of(runs.out("out"));
  for (const char* list : {"warnings", "remarks"})
    for (const auto& text : summary.value(list, nlohmann::json::array()))
      EXPECT_TRUE(has(log, text.get<std::string>())) << text << " not in\n" << log;
  if (summary["status"] == "good" && !summary["remarks"].empty()) {
    EXPECT_TRUE(has(done.output, " at the end of log.txt\n")) << done.output;
    EXPECT_TRUE(has(read_text(runs.out("out") + "/report.html"), "<details id=\"notes\">"));
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, ConsoleSummary, ::testing::ValuesIn(quick_kinds()), name_of_kind);

TEST(RunLog, SaysHowARunEnded) {
  const KindRuns runs({"particles", "microsim", tiny_particles("0.2"), 0});
  const std::string command = "microsim '" + runs.out("scene.toml") + "' --out '" + runs.out("out") + "' ";
  ASSERT_EQ(run_the_program(command).status, 0);
  ASSERT_EQ(run_the_program(command + "--resume --set time.end=0.3").status, 2);
  std::string log = log_of(runs.out("out"));
  EXPECT_TRUE(has(log, "belongs to another scene")) << log;
  EXPECT_TRUE(has(log, "ended with status 2 (bad input)")) << log;
  const int status = signal_when(
      start_program(runs.arguments("stopped", {"--set", "time.end=100"})),
      [&] { return fs::exists(runs.out("stopped") + "/checkpoint.h5"); }, SIGTERM);
  ASSERT_TRUE(ended_with(status, 130));
  log = log_of(runs.out("stopped"));
  EXPECT_TRUE(has(log, "ended with status 130 (interrupted)")) << log;
}

TEST(RunLog, ARunThatBrokeOffSaysStatusAndReason) {
  const KindRuns runs({"particles", "microsim", tiny_particles("0.2"), 0});
  const std::string command = "microsim '" + runs.out("scene.toml") + "' --out '" + runs.out("out") + "' ";
  const ProgramOutcome done =
      run_the_program(command + "--set guards.overlap.limit=1e-9 --set guards.overlap.action=stop");
  EXPECT_EQ(done.status, 3) << done.output;
  EXPECT_TRUE(has(done.output, "status: not usable (exit status 3): ")) << done.output;
  EXPECT_TRUE(has(done.output, "overlap by")) << done.output;
  EXPECT_TRUE(has(log_of(runs.out("out")), "status: not usable (exit status 3): "));
  EXPECT_FALSE(has(run_the_program(command).output, "status: "));
}

/// Opening it waited for a reader for ever, deaf to SIGTERM.
TEST(RunLog, APipeInItsPlaceIsRefused) {
  const KindRuns runs({"particles", "microsim", tiny_particles("0.2"), 0});
  fs::create_directory(runs.out("out"));
  ASSERT_EQ(::mkfifo((runs.out("out") + "/log.txt").c_str(), 0600), 0);
  for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--resume"}}) {
    const std::string errors = runs.out("errors.txt");
    const pid_t child = start_program(runs.arguments("out", more), errors_to(errors));
    EXPECT_TRUE(ended_with(signal_after(child, 60.0, SIGKILL), 4));
    EXPECT_TRUE(has(read_text(errors), "log.txt: is a pipe, not a file")) << read_text(errors);
  }
}

TEST(RunLog, LogsLieWithinEachOther) {
  std::string outer;
  std::string inner;
  const auto into = [](std::string& text) { return [&text](const std::string& line) { text += line + ";"; }; };
  {
    const LogScope all(into(outer));
    log_text("a\nb");
    {
      const LogScope part(into(inner));
      log_text("c");
    }
    log_text("d");
  }
  log_text("e");
  EXPECT_EQ(outer, "a;b;d;e;");
  EXPECT_EQ(inner, "c;");
  const LogScope none([](const std::string&) {});  // no text of this test is written to any more
}

TEST(UnfinishedRun, TheReportSaysSo) {
  const KindRuns runs({"macro", "macrosim", kTinyMacro, 0});
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("out"))), 0));
  const std::string report = "report '" + runs.out("out") + "'";
  ASSERT_EQ(run_the_program(report).status, 0);
  EXPECT_FALSE(has(read_text(runs.out("out") + "/report.html"), "unfinished"));
  fs::remove(runs.out("out") + "/summary.json");  // as a run leaves it that is stopped after its curves
  const ProgramOutcome done = run_the_program(report);
  ASSERT_EQ(done.status, 0) << done.output;
  EXPECT_TRUE(has(done.output, "has not come to its end")) << done.output;
  const std::string html = read_text(runs.out("out") + "/report.html");
  EXPECT_TRUE(has(html, "Results of an unfinished run:"));
  EXPECT_TRUE(has(html, "status-bad\">unfinished<"));
  EXPECT_TRUE(has(html, "(unfinished run)</title>"));
  EXPECT_TRUE(has(run_the_program(report + " --json").output, "\"unfinished_run\": true"));
  fs::remove(runs.out("out") + "/macro.h5");
  for (const char* file : {"macro_initial.h5", "states_macro.h5"}) fs::remove(runs.out("out") + "/" + file);
  const ProgramOutcome nothing = run_the_program(report);
  EXPECT_EQ(nothing.status, 4);
  EXPECT_TRUE(has(nothing.output, "has not come to its end and has no results yet")) << nothing.output;
  const ProgramOutcome check = run_the_program("check '" + runs.out("out") + "'");
  EXPECT_EQ(check.status, 2);
  EXPECT_TRUE(has(check.output, "has not come to its end and has no results yet")) << check.output;
}

}  // namespace
