// The Python package reads of a run what the program reads of it. Skipped where Python has no h5py.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "common/data/law_card.h"
#include "common/data/macro_result.h"
#include "common/data/measurements.h"
#include "pipelines/snapshots/snapshots.h"
#include "tests/support/every_kind.h"
#include "tests/support/process.h"
#include "tests/support/program.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
using nlohmann::json;

const std::string kPackage = SOFTGRAIN_SOURCE_DIR "/pipelines/python";

/// A Python of at least 3.11 with h5py and numpy: the packages of Debian belong to the system's own.
std::string python_with_h5py() {
  for (const std::string python : {"/usr/bin/python3", "python3"})
    if (std::system((python + " -c 'import h5py, numpy, tomllib' >/dev/null 2>&1").c_str()) == 0) return python;
  return "";
}

ProgramOutcome output_of(const std::string& line) {
  ProgramOutcome outcome;
  FILE* pipe = ::popen((line + " 2>&1").c_str(), "r");
  std::array<char, 4096> buffer{};
  outcome.output.clear();
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe))
    outcome.output.append(buffer.data(), n);
  outcome.status = ::pclose(pipe);
  return outcome;
}

json read_with_python(const std::string& python, const std::string& run) {
  const ProgramOutcome done =
      output_of("PYTHONDONTWRITEBYTECODE=1 " + python +
                " '" SOFTGRAIN_SOURCE_DIR "/tests/support/read_with_python.py' '" + kPackage + "' '" + run + "'");
  EXPECT_EQ(done.status, 0) << done.output;
  const std::size_t at = done.output.find("RESULT ");
  return at == std::string::npos ? json::object() : json::parse(done.output.substr(at + 7));
}

void expect_same_states(const json& seen, const std::vector<Snapshot>& states) {
  ASSERT_EQ(seen.size(), states.size());
  for (std::size_t k = 0; k < states.size(); ++k) {
    const Snapshot& s = states[k];
    const json& one = seen[k];
    EXPECT_EQ(one["series"], s.series);
    EXPECT_EQ(one["kind"], to_string(s.kind));
    EXPECT_EQ(one["frame"], s.frame);
    EXPECT_EQ(one["particles"], s.particles.size());
    EXPECT_EQ(one["walls"], s.walls.size());
    EXPECT_EQ(one["contacts"], s.has_contacts ? json(s.contacts.size()) : json(nullptr));
    double radii = 0.0;
    double x = 0.0;
    std::int64_t bodies = 0;
    for (const SnapshotParticle& p : s.particles) {
      radii += p.radius;
      x += p.position[0];
      bodies += p.body;
    }
    double normal = 0.0;
    double force_x = 0.0;
    for (const SnapshotContact& c : s.contacts) {
      normal += c.normal_force;
      force_x += c.force[0];
    }
    EXPECT_NEAR(one["radii"].get<double>(), radii, 1e-12 * radii);
    EXPECT_NEAR(one["x"].get<double>(), x, 1e-12);
    EXPECT_EQ(one["body"], bodies);
    EXPECT_NEAR(one["normal_force"].get<double>(), normal, 1e-12 * (1.0 + std::abs(normal)));
    EXPECT_NEAR(one["force_x"].get<double>(), force_x, 1e-12 * (1.0 + std::abs(normal)));
  }
}

TEST(PythonReader, ReadsAPipeline) {
  const std::string python = python_with_h5py();
  if (python.empty()) GTEST_SKIP() << "no Python with h5py (Debian: python3-h5py python3-numpy)";
  const KindRuns runs({"pipeline", "run", kTinyPipeline, 3});
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("a"))), 3));
  const std::string run = runs.out("a");
  const json seen = read_with_python(python, run);
  EXPECT_EQ(seen["status"], "not usable");
  expect_same_states(seen["snapshots"], read_snapshots(run));
  EXPECT_EQ(seen["last"].size(), read_snapshots(run, SnapshotChoice::last).size());
  const Measurements data = load_measurements(run + "/measurements.h5");
  ASSERT_EQ(seen["measured"].size(), data.runs.size());
  for (std::size_t k = 0; k < data.runs.size(); ++k) {
    const json& one = seen["measured"][k];
    EXPECT_EQ(one["kind"], to_string(data.runs[k].kind));
    EXPECT_EQ(one["relaxation"], data.runs[k].relaxation);
    ASSERT_EQ(one["force"].size(), data.runs[k].normal.size());
    for (std::size_t n = 0; n < data.runs[k].normal.size(); ++n)
      EXPECT_EQ(one["force"][n], data.runs[k].normal[n].force);
    ASSERT_EQ(one["angles"].size(), data.runs[k].tangential.size());
    for (std::size_t n = 0; n < data.runs[k].tangential.size(); ++n)
      EXPECT_EQ(one["turned_converged"][n], data.runs[k].tangential[n].converged);
  }
  const LawCard card = load_card(run + "/law.toml");
  for (const PairLaw& pair : card.pairs) {
    if (!seen.contains("law")) break;  // built without the compiled laws
    EXPECT_EQ(seen["law"][to_string(pair.kind)][0], 0.0);
    EXPECT_NEAR(seen["law"][to_string(pair.kind)][1].get<double>(), pair.normal.value(0.5),
                1e-12 * pair.normal.value(0.5));
  }
  const bool has_macro = std::filesystem::exists(run + "/macro.h5");
  EXPECT_EQ(seen.contains("macro"), has_macro);
  EXPECT_EQ(has_macro ? seen["macro"].size() : 0U, has_macro ? load_macro(run + "/macro.h5").size() : 0U);
}

TEST(PythonReader, ReadsParticles) {
  const std::string python = python_with_h5py();
  if (python.empty()) GTEST_SKIP() << "no Python with h5py (Debian: python3-h5py python3-numpy)";
  for (const std::string& scene : {tiny_particles("0.2"), tiny_disks("15.0")}) {
    const KindRuns runs({"particles", "microsim", scene, 0});
    ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("a", {"--set", "output.snapshots=5"}))), 0));
    const json seen = read_with_python(python, runs.out("a"));
    expect_same_states(seen["snapshots"], read_snapshots(runs.out("a")));
    EXPECT_EQ(seen["last"].size(), 1U);
  }
}

void expect_example(const KindScene& scene, const std::vector<std::string>& words) {
  const std::string python = python_with_h5py();
  if (python.empty()) GTEST_SKIP() << "no Python with h5py (Debian: python3-h5py python3-numpy)";
  const KindRuns runs(scene);
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("a"))), 0));
  const std::string picture = runs.out("picture.png");
  const ProgramOutcome done = output_of("PYTHONDONTWRITEBYTECODE=1 " + python + " '" + kPackage + "/example.py' '" +
                                        runs.out("a") + "' '" + picture + "'");
  if (done.output.find("built without its laws") != std::string::npos) GTEST_SKIP() << done.output;
  for (const std::string& word : words) EXPECT_NE(done.output.find(word), std::string::npos) << done.output;
  if (done.output.find("matplotlib is not installed") != std::string::npos) GTEST_SKIP() << done.output;
  EXPECT_EQ(done.status, 0) << done.output;
  EXPECT_GT(std::filesystem::file_size(picture), 10000U);
}

TEST(PythonReader, ExampleRuns) { expect_example({"soft-particle", "microsim", kTinySoftParticle, 0}, {"strongest"}); }

/// A macro run has neither measurements nor a law of its own.
TEST(PythonReader, ExampleRunsOnAMacroRun) {
  expect_example({"macro", "macrosim", kTinyMacro, 0},
                 {"law, sample 0: axial stress", "shelled, sample 0: axial stress", "no law in this run"});
}

}  // namespace
