// Cohesive powders through the built program: a small pack comes to rest, other threads change nothing, what does not
// rest is said, what cannot be is refused.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/io/text_file.h"
#include "pipelines/kinds/cohesive_powder/powder_data.h"
#include "tests/support/process.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
using nlohmann::json;
namespace fs = std::filesystem;

constexpr const char* kPack = R"(kind = "cohesive-powder"
seed = 1
samples = 2
[disks]
count = 100
solid_fraction = 0.36
[contact]
cohesive = false
kappa = 1e4
mu = 0.5
[assembly]
)";

class Powder : public ::testing::Test {
 protected:
  Powder() { write_text_atomic(scene(), kPack); }
  [[nodiscard]] std::string scene() const { return directory_.file("scene.toml"); }
  [[nodiscard]] std::string out(const std::string& name) const { return directory_.file(name); }
  json run(const std::string& name, const std::string& more, int status) {
    const ProgramOutcome outcome =
        run_the_program("microsim '" + scene() + "' --quiet --out '" + out(name) + "' " + more);
    EXPECT_EQ(outcome.status, status) << outcome.output;
    output_ = outcome.output;
    return json::parse(read_text(out(name) + "/summary.json"));
  }
  void expect_refused(const std::string& more, const std::string& word) {
    const ProgramOutcome outcome = run_the_program("microsim '" + scene() + "' --out '" + out("bad") + "' " + more);
    EXPECT_EQ(outcome.status, 2) << outcome.output;
    EXPECT_NE(outcome.output.find(word), std::string::npos) << outcome.output;
  }

  TemporaryDirectory directory_;
  std::string output_;  ///< of the last run
};

TEST_F(Powder, DisksWithoutCohesionJam) {
  const json s = run("out", "--threads 1", 0);
  const double error = s["statistics"]["Phi"]["deviation"].get<double>() / std::sqrt(2.0);
  EXPECT_NE(output_.find(fmt::format("Phi {:.4f} +- {:.4f}", s["mean"]["Phi"].get<double>(), error)),
            std::string::npos)
      << output_;
  EXPECT_EQ(s["status"], "good");
  EXPECT_GT(s["mean"]["Phi"].get<double>(), 0.76);
  EXPECT_LT(s["mean"]["Phi"].get<double>(), 0.85);
  for (const json& sample : s["samples"]) {
    EXPECT_NEAR(sample["stress"][0].get<double>(), 1.0, 1e-4);
    EXPECT_NEAR(sample["rumpf_pressure"].get<double>(), 1.0, 0.06) << "pressure from the mean force alone";
    EXPECT_NEAR(sample["branch_pressure"].get<double>(), 1.0, 2e-3) << "with the distances of centres";
    double shares = 0.0;
    for (const json& x : sample["shares"]) shares += x.get<double>();
    EXPECT_NEAR(shares, 1.0, 1e-12);
    EXPECT_GE(sample["z_star"].get<double>(), sample["z"].get<double>());
  }
  EXPECT_TRUE(fs::exists(out("out") + "/powder.h5"));
  for (const json& sample : s["samples"]) {
    for (const char* variant : {"fixed", "free", "backbone", "backbone_free"})
      EXPECT_TRUE(sample["rigidity"][variant]["identity_holds"].get<bool>()) << variant;
    EXPECT_TRUE(sample["rigidity"]["backbone_free"]["positive_definite"].get<bool>()) << "it carries its load";
    EXPECT_EQ(sample["rigidity"]["backbone_free"]["k"], 2) << "the translations";
    EXPECT_GT(sample["F_perc"]["both"].get<double>(), 0.1);
    EXPECT_NEAR(sample["rumpf_ratio"].get<double>(), sample["rumpf_pressure"].get<double>(), 1e-12);
  }
  EXPECT_EQ(s["statistics"]["Phi"]["samples"], 2);
  EXPECT_NEAR(s["statistics"]["Phi"]["mean"].get<double>(), s["mean"]["Phi"].get<double>(), 1e-12);
  EXPECT_GT(s["statistics"]["rigidity.backbone_free.h"]["mean"].get<double>(), 0.0);
  EXPECT_EQ(run("two", "--threads 2", 0)["samples"], s["samples"]);
}

TEST_F(Powder, WhatDoesNotRestIsSaid) {
  const json s = run("out", "--set assembly.time_max=3 --set analysis.rigidity=false", 3);
  EXPECT_TRUE(s["samples"][0]["rigidity"].is_null()) << "not asked for";
  EXPECT_TRUE(s["statistics"].empty()) << "no sample to be averaged";
  EXPECT_EQ(s["status"], "not usable");
  ASSERT_FALSE(s["remarks"].empty());
  EXPECT_NE(s["remarks"][0].get<std::string>().find("phase compaction"), std::string::npos);
}

TEST_F(Powder, WhatCannotBeIsRefused) {
  expect_refused("--set assembly.method=2", "do not aggregate");
  expect_refused("--set assembly.pressure=0.01", "kappa");
  expect_refused("--set disks.solid_fraction=1.2", "solid_fraction");
  expect_refused("--set contact.kapa=1e4", "kappa");
  expect_refused("--set contact.cohesive=true --set assembly.pressure=0", "nothing moves");
  expect_refused("--set assembly.pressures=[0.1,0.2]", "kappa");
  const std::string powder = "--set contact.cohesive=true ";
  expect_refused(powder + "--set assembly.pressures=[0.1,0.05,0.2]", "rise to a largest one");
  expect_refused(powder + "--set assembly.pressures=[0.1,0.1]", "rise to a largest one");
  expect_refused(powder + "--set assembly.pressures=[0.1,0]", "above 0");
  expect_refused(powder + "--set assembly.pressures=[0.1,1] --set assembly.pressure=1", "leave one of the two out");
  expect_refused("--set assembly.cell_inertia=0", "must be from 1e-06 to 1000000");
  expect_refused("--set assembly.edge_speed_cap=1e-3", "allow at least");
  expect_refused("--set assembly.edge_speed_cap=1e-8 --set assembly.time_max=1e12", "days of one core");
  // L/a = sqrt(100 pi 7/12/4/0.36) = 11.3, but for the draw of the sizes.
  expect_refused("--set assembly.cell_mass=0.3", "cell_inertia = 0.02");
  expect_refused("--set assembly.strain_rate_cap=0.05", "edge_speed_cap = 0.56");
}

constexpr const char* kSeriesB = R"(kind = "cohesive-powder"
seed = 2
samples = 2
[disks]
count = 60
solid_fraction = 0.36
[contact]
kappa = 1e3
mu = 0.5
rolling = true
[assembly]
method = 2
aggregation_kappa = 1e2
stiffening_time = 30.0
pressure = 0.01
record_every = 5.0
[analysis]
mesh = 10
)";

TEST_F(Powder, AKilledSeriesBGoesOnToTheSameEnd) {
  write_text_atomic(scene(), kSeriesB);
  const json whole = run("whole", "--threads 2", 0);
  const fs::path work = fs::path(out("half")) / "work";
  const auto begun = [&] {
    std::error_code none;
    return fs::exists(work, none) && !fs::is_empty(work, none);
  };
  for (const double seconds : {0.0, 0.1, 0.2}) {
    std::vector<std::string> words{"microsim", scene(), "--quiet", "--threads", "2", "--out", out("half")};
    if (seconds > 0.0) words.push_back("--resume");
    const pid_t child = start_program(words);
    if (seconds > 0.0)
      (void)signal_after(child, seconds, SIGKILL);
    else
      (void)signal_when(child, begun, SIGKILL);
  }
  const json resumed = run("half", "--resume", 0);
  EXPECT_EQ(resumed["samples"], whole["samples"]);
  EXPECT_EQ(resumed["mean"], whole["mean"]);
}

TEST_F(Powder, StatesOfAnEarlierRunAreAnalysedAgain) {
  write_text_atomic(scene(), kSeriesB);
  const json first = run("first", "", 0);
  const std::string states = "--set analysis.states='\"" + out("first") + "/powder.h5\"'";
  const json again = run("again", states + " --set analysis.mesh=20", 0);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(again["samples"][k]["Phi"], first["samples"][k]["Phi"]);
    EXPECT_EQ(again["samples"][k]["F_perc"], first["samples"][k]["F_perc"]);
    EXPECT_NE(again["samples"][k]["mesh"], first["samples"][k]["mesh"]);
  }
  expect_refused(states + " --set contact.mu=0.4", "other [disks], [contact]");
  expect_refused(states + " --set samples=3", "sample_2");
  expect_refused("--set assembly.method=1 --set assembly.aggregation_kappa=1e2", "only method 2");
}

/// A sample that ended while its contacts were soft keeps that stiffness, and nothing goes on with it.
TEST_F(Powder, AnUnfinishedSampleStaysAsItIs) {
  write_text_atomic(scene(), kSeriesB);
  const json first = run("first", "--set assembly.time_max=5 --set assembly.edge_speed_cap=0 --set samples=1", 3);
  const PowderRun kept = load_powder(out("first") + "/powder.h5");
  double sum = 0.0;
  for (const ContactRecord<2>& c : kept.samples.at(0).contacts) sum += c.normal_force;
  ASSERT_FALSE(kept.samples[0].contacts.empty());
  const double mean = first["samples"][0]["mean_normal"].get<double>();
  EXPECT_NEAR(sum / static_cast<double>(kept.samples[0].contacts.size()), mean, 1e-6 * std::abs(mean));
  const json again = run(
      "again",
      "--set assembly.edge_speed_cap=0 --set samples=1 --set analysis.states='\"" + out("first") + "/powder.h5\"'", 3);
  EXPECT_EQ(again["samples"][0]["steps"], first["samples"][0]["steps"]);
  EXPECT_EQ(again["samples"][0]["Phi"], first["samples"][0]["Phi"]);
}

constexpr const char* kSized = R"(kind = "cohesive-powder"
[disks]
count = 20
solid_fraction = 0.4
[disks.sizes]
form = "list"
file = "radii.csv"
[contact]
kappa = 100.0
cohesive = false
mu = 0.3
[analysis]
rigidity = false
[[variant]]
name = "a"
[[variant]]
name = "b"
contact = { mu = 0.15 }
)";

/// Variants of other sizes are not those of this run, though the scene names the same file.
TEST_F(Powder, VariantsOfAnotherSizeFileAreRunAgain) {
  write_text_atomic(scene(), kSized);
  write_text_atomic(out("radii.csv"), "radius [mm]\n1\n0.9\n0.8\n0.7\n0.6\n");
  const auto fractions = [&](const std::string& more) {
    (void)run_the_program("microsim '" + scene() + "' --quiet --out '" + out("v") + "' " + more);
    std::vector<double> phi;
    for (const char* name : {"a", "b"})
      phi.push_back(json::parse(read_text(out("v") + "/" + name + "/summary.json"))["samples"][0]["Phi"].get<double>());
    return phi;
  };
  const std::vector<double> before = fractions("");
  EXPECT_EQ(fractions("--resume"), before);
  write_text_atomic(out("radii.csv"), "radius [mm]\n1\n0.8\n0.7\n0.7\n0.6\n");
  const std::vector<double> after = fractions("--resume");
  EXPECT_NE(after[0], before[0]);
  EXPECT_NE(after[1], before[1]);
}

}  // namespace
