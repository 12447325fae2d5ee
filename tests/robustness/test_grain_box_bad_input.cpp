// Wrong scenes of grain boxes: status 2 or 3, and a message that says where and what.
#include <gtest/gtest.h>

#include "common/io/text_file.h"
#include "microsim/particles/scene_memory.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/unwrapped.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

const char* const kGood = R"(kind = "grain-box"
seed = 3
[material]
radius_min = "0.07 mm"
radius_max = "0.13 mm"
E = "70 GPa"
E_sd = 0.1
nu = 0.2
mu = 0.3
[walls]
nu = 0.495
[box]
grains = 40
aspect = [1.0, 1.0, 1.0]
solid_fraction = 0.2
[generation]
pressure = "20 MPa"
[solver]
method = "fast"
[loading]
test = "uniaxial"
increment = 1e-3
end_strain = 0.002
)";

class GrainBoxBadInput : public ::testing::Test {
 protected:
  /// Replaces the first `from` in the good scene, runs it, expects the status and all `words` in the message.
  void expect(const std::string& from, const std::string& to, const std::vector<std::string>& words, int status = 2) {
    std::string text = kGood;
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    write_text_atomic(directory_.file("scene.toml"), text.replace(at, from.size(), to));
    const ProgramOutcome outcome = run_the_program("microsim '" + directory_.file("scene.toml") +
                                                   "' --quiet --threads 1 --out '" + directory_.file("out") + "'");
    EXPECT_EQ(outcome.status, status) << outcome.output << "\n" << text;
    const std::string said = test::unwrapped(outcome.output);
    for (const std::string& word : words) EXPECT_NE(said.find(word), std::string::npos) << word << " not in: " << said;
  }
  TemporaryDirectory directory_;
};

TEST_F(GrainBoxBadInput, APackThatMemoryDoesNotHold) {
  if (available_memory() > 1e11) GTEST_SKIP() << "a machine with more memory than the largest pack takes";
  expect("grains = 40", "grains = 10000000",
         {"scene.toml:13: grains", "a pack of 10000000 grains needs about 110 GB", "allowed: up to "});
}

TEST_F(GrainBoxBadInput, Material) {
  expect("radius_max = \"0.13 mm\"", "radius_max = \"0.05 mm\"", {"scene.toml:5: radius_max", "radius_min"});
  expect("radius_max = \"0.13 mm\"", "radius_max = \"13 mm\"", {"scene.toml:5: radius_max", "20 times"});
  expect("E_sd = 0.1", "E_sd = 0.9", {"scene.toml:7: E_sd", "0.3"});
  expect("nu = 0.2", "nu = 0.7", {"scene.toml:8: nu", "at most 0.5"});
  expect("mu = 0.3", "mu = -1.0", {"scene.toml:9: mu", "0"});
  expect("mu = 0.3", "mu = 0.3\nmu_r = 0.1", {"scene.toml:10: mu_r", "the least-work solver knows no rolling"});
  expect("mu = 0.3", "mu = \"endless\"", {"scene.toml:9: mu", "infinite"});
  expect("E = \"70 GPa\"", "E = \"70 N\"", {"scene.toml:6: E"});
  expect("radius_min", "radius_mni", {"radius_mni", "radius_min"});
}

TEST_F(GrainBoxBadInput, Box) {
  expect("aspect = [1.0, 1.0, 1.0]", "aspect = [1.0, 1.0, 0.0]", {"scene.toml:14: aspect", "not closed"});
  expect("aspect = [1.0, 1.0, 1.0]", "aspect = [1.0, 1.0, 500.0]", {"too short"});
  expect("grains = 40", "grains = 3", {"scene.toml:13: grains", "8"});
  expect("solid_fraction = 0.2", "solid_fraction = 0.7", {"scene.toml:15: solid_fraction", "0.36"});
  expect("solid_fraction = 0.2", "solid_fracton = 0.2", {"solid_fracton", "solid_fraction"});
}

TEST_F(GrainBoxBadInput, Loading) {
  expect("test = \"uniaxial\"", "test = \"biaxial\"", {"scene.toml:21: test", "uniaxial"});
  expect("test = \"uniaxial\"", "test = \"triaxial\"", {"lateral_stress", "lateral_strain_rate"});
  expect("test = \"uniaxial\"", "test = \"polyaxial\"", {"strain_rates"});
  expect("test = \"uniaxial\"", "test = \"polyaxial\"\nstrain_rates = [0.0, 0.0, 0.0]",
         {"strain_rates", "at least one axis"});
  expect("test = \"uniaxial\"",
         "test = \"polyaxial\"\nstrain_rates = [0, 0, 1]\ncontrol = [\"stress\", \"stress\", \"strain\"]\n"
         "stresses = [\"-1 MPa\", \"1 MPa\", 0]",
         {"stresses", "cannot be pulled"});
  expect("test = \"uniaxial\"", "test = \"isotropic\"\naxis = \"x\"", {"unknown key 'axis'"});
  expect("increment = 1e-3", "increment = 0.0", {"scene.toml:22: increment", "from 1e-09 to 0.1"});
  expect("increment = 1e-3", "increment = 0.09\n[[variant]]\nname = \"a\"\ngrains = 4000", {"smallest grain", "below"});
  expect("test = \"uniaxial\"", "test = \"triaxial\"\nlateral_stress = \"90 GPa\"", {"overlap"});
  expect("increment = 1e-3", "increments = [1e-3, 1e-4]", {"scene.toml:22: increments", "stage_strains"});
  expect("end_strain = 0.002", "end_strain = 0.9", {"scene.toml:23: end_strain", "0.4"});
  expect("end_strain = 0.002", "probe_every = 5", {"no end"});
  expect("end_strain = 0.002", "end_stress = \"1 MPa\"", {"scene.toml:23: end_stress", "generation pressure"});
  expect("end_strain = 0.002", "end_stress = \"30 GPa\"", {"scene.toml:23: end_stress", "overlap"});
}

TEST_F(GrainBoxBadInput, SolverAndVariants) {
  expect("method = \"fast\"", "method = \"newton\"", {"scene.toml:19: method", "published"});
  expect("method = \"fast\"", "method = \"fast\"\nrefresh = 10", {"unknown key 'refresh'"});
  expect("end_strain = 0.002", "end_strain = 0.002\n[[variant]]\nmu = 0.1", {"missing key 'name'"});
  expect("end_strain = 0.002", "end_strain = 0.002\n[[variant]]\nname = \"a/b\"", {"name", "letters"});
  expect("end_strain = 0.002", "end_strain = 0.002\n[[variant]]\nname = \"a\"\n[[variant]]\nname = \"a\"",
         {"used twice"});
  expect("end_strain = 0.002", "end_strain = 0.002\n[[variant]]\nname = \"a\"\nnu = 0.1", {"unknown key 'nu'"});
}

/// A stress that frictionless grains cannot hold apart: the lateral walls run away.
TEST_F(GrainBoxBadInput, AStressOutOfReachEndsTheRunAndKeepsWhatCameBefore) {
  expect("test = \"uniaxial\"\nincrement = 1e-3\nend_strain = 0.002",
         "test = \"triaxial\"\nlateral_stress = \"1 Pa\"\nmax_halvings = 1\nincrement = 1e-3\nend_strain = 0.1",
         {"cannot be reached", "NOT USABLE"}, 3);
  EXPECT_NE(read_text(directory_.file("out/summary.json")).find("not usable"), std::string::npos);
  EXPECT_FALSE(read_text(directory_.file("out/report.html")).empty());
}

TEST_F(GrainBoxBadInput, NoEquilibriumEndsTheRun) {
  expect("method = \"fast\"", "method = \"fast\"\nmax_iterations = 1", {"no equilibrium"}, 3);
}

}  // namespace
