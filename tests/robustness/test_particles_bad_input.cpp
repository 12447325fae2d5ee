// Wrong scenes of explicit particles: status 2, and a message that says where and what.
#include <gtest/gtest.h>

#include "common/io/text_file.h"
#include "microsim/particles/scene_memory.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

const char* const kGood = R"(kind = "particles"
[material.glass]
density = 2500.0
E = "1 MPa"
nu = 0.2
[material.bare]
E = "1 MPa"
nu = 0.2
[[contact]]
pair = ["glass", "glass"]
law = "hertz-tsuji"
restitution = 0.9
mu = 0.3
[[contact]]
pair = ["glass", "rigid"]
law = "hertz-tsuji"
restitution = 0.9
mu = 0.3
[[particle]]
material = "glass"
radius = 0.01
position = [0.0, 0.0, 0.05]
[[particle]]
material = "glass"
radius = 0.01
position = [0.0, 0.0, 0.1]
[[wall]]
shape = "plane"
point = [0.0, 0.0, 0.0]
normal = [0.0, 0.0, 1.0]
material = "rigid"
[time]
end = 1e-3
)";

class ParticlesBadInput : public ::testing::Test {
 protected:
  /// Replaces the first `from` in the good scene, runs it, expects status 2 and all `words` in the message.
  void expect(const std::string& from, const std::string& to, const std::vector<std::string>& words,
              const std::string& command = "microsim") {
    std::string text = kGood;
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    expect_text(text.replace(at, from.size(), to), words, command);
  }
  void expect_text(const std::string& text, const std::vector<std::string>& words,
                   const std::string& command = "microsim") {
    write_text_atomic(directory_.file("scene.toml"), text);
    const std::string out = command == "check" ? "" : " --out '" + directory_.file("out") + "'";
    const ProgramOutcome outcome = run_the_program(command + " '" + directory_.file("scene.toml") + "' --quiet" + out);
    EXPECT_EQ(outcome.status, 2) << outcome.output << "\n" << text;
    for (const std::string& word : words)
      EXPECT_NE(outcome.output.find(word), std::string::npos) << word << " not in: " << outcome.output;
  }
  void expect_file(const std::string& content, const std::vector<std::string>& words,
                   const std::string& command = "microsim") {
    write_text_atomic(directory_.file("many.xyzr"), content);
    expect("[time]", "[particles]\nfile = \"many.xyzr\"\nmaterial = \"glass\"\n[time]", words, command);
  }
  TemporaryDirectory directory_;
};

TEST_F(ParticlesBadInput, TheGoodSceneIsGood) {
  write_text_atomic(directory_.file("scene.toml"), kGood);
  const auto outcome = run_the_program("microsim '" + directory_.file("scene.toml") + "' --quiet --out '" +
                                       directory_.file("out") + "'");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
}

TEST_F(ParticlesBadInput, CheckSaysWhatFollowsFromTheGoodOne) {
  write_text_atomic(directory_.file("scene.toml"), kGood);
  const auto outcome = run_the_program("check '" + directory_.file("scene.toml") + "' --json");
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  const auto facts = nlohmann::json::parse(outcome.output);
  EXPECT_EQ(facts["bodies"], 3);
  EXPECT_EQ(facts["contacts"], 0);
  EXPECT_GT(facts["bytes"], 2 * 100.0);
  EXPECT_GT(facts["seconds"], 0.0);
  EXPECT_LT(facts["time_step"].get<double>(), 0.051 * facts["step_limit"].get<double>());
}

TEST_F(ParticlesBadInput, Particles) {
  expect("radius = 0.01", "radius = 0.0", {"scene.toml:21: radius", "above 0"});
  expect("radius = 0.01", "radius = -0.01", {"scene.toml:21: radius", "above 0"});
  expect("radius = 0.01", "radius = nan", {"scene.toml:21: radius", "finite"});
  expect("radius = 0.01", "radius = 1e-120", {"scene.toml:21: radius = 1e-120", "1e-30"});
  expect("radius = 0.01", "radius = \"1 kg\"", {"scene.toml:21: radius"});
  expect("radius = 0.01", "radus = 0.01", {"radius", "radus", "scene.toml:"});
  expect("position = [0.0, 0.0, 0.05]", "position = [0.0, inf, 0.05]", {"scene.toml:22: position", "finite"});
  expect("position = [0.0, 0.0, 0.05]", "position = [0.0, 0.05]", {"scene.toml:22: position", "three"});
  expect("position = [0.0, 0.0, 0.05]", "position = [0.0, 0.0, 0.1]",
         {"scene.toml:26: position", "same centre", "scene.toml:22"});
  expect("material = \"glass\"", "material = \"glas\"", {"scene.toml:20: material", "nearest is 'glass'"});
  expect("material = \"glass\"", "material = \"bare\"", {"scene.toml:20: material", "density"});
  expect("position = [0.0, 0.0, 0.05]", "position = [0.0, 0.0, 0.05]\ninside = \"nowhere\"",
         {"scene.toml:23: inside", "no wall"});
  expect("position = [0.0, 0.0, 0.05]", "position = [0.0, 0.0, 0.05]\nmass = 1.0",
         {"scene.toml:23: unknown key 'mass'"});
}

TEST_F(ParticlesBadInput, CentresOnePeriodApart) {
  std::string text = kGood;
  const std::size_t wall = text.find("[[wall]]");
  text.replace(wall, text.find("[time]") - wall, "[cell]\nsize = [0.1, 0.1, 0.05]\nperiodic = [true, true, true]\n");
  expect_text(text, {"position", "has the same centre as particle 0"});
}

/// A tangential spring far stiffer than the normal one was not seen before bodies touched.
TEST_F(ParticlesBadInput, StepsThatATangentialSpringMakesUnstable) {
  const std::string stiff = "law = \"linear-spring\"\nnormal_stiffness = 1e3\ntangential_stiffness = 1e6";
  std::string text = kGood;
  text.replace(text.find("law = \"hertz-tsuji\""), 19, stiff);
  expect_text(text + "step = 1e-4\n", {"step = 0.0001", "above the stable limit", "of a tangential spring",
                                       "set by particle 0 (radius 0.01 m) with linear-spring of glass and glass"});
  const auto facts = [&](const std::string& more) {
    write_text_atomic(directory_.file("scene.toml"), text + more);
    const auto outcome = run_the_program("check '" + directory_.file("scene.toml") + "' --json");
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    return nlohmann::json::parse(outcome.output);
  };
  const nlohmann::json automatic = facts("");
  EXPECT_NE(automatic["limited_by"].dump().find("of a tangential spring"), std::string::npos) << automatic;
  EXPECT_LT(automatic["time_step"].get<double>(), 5e-5);
  EXPECT_EQ(facts("step = 4e-5\n")["time_step"], 4e-5);
  text.replace(text.find("mu = 0.3"), 8, "mu = 0.0");
  EXPECT_EQ(facts("step = 1e-4\n")["time_step"], 1e-4) << "without friction the spring bears nothing";
}

/// They stand in messages, summaries and reports.
TEST_F(ParticlesBadInput, NamesAreOneLine) {
  const std::string wall = "shape = \"plane\"";
  for (const char* name : {R"(a\nb)", R"(a\tb)", R"(a\u001b[31m)", R"(a\u007f)"}) {
    expect(wall, wall + "\nname = \"" + name + "\"", {"scene.toml:29: name", "must be one line of text"});
    expect("[material.bare]", std::string("[material.\"") + name + "\"]",
           {"scene.toml:6: a", "must be one line of text"});
  }
  expect(wall, wall + "\nname = \"a\\u001b[31m\"", {"name = \"a [31m\""});
}

TEST_F(ParticlesBadInput, EmptyScenes) {
  expect_text("kind = \"particles\"\n[time]\nend = 1.0\n", {"scene.toml:1", "no particle"});
  expect_text("kind = \"particle\"\n", {"scene.toml:1: kind", "nearest is \"particles\""});
  expect_text("", {"kind"});
}

TEST_F(ParticlesBadInput, Materials) {
  expect("density = 2500.0", "density = 0.0", {"scene.toml:3: density"});
  expect("nu = 0.2", "nu = 0.6", {"scene.toml:5: nu", "0.5"});
  expect("nu = 0.2", "rigid = true", {"scene.toml:4: E", "rigid"});
  expect("[material.bare]", "[material.rigid]", {"rigid", "taken"});
  expect("E = \"1 MPa\"\nnu = 0.2\n", "", {"scene.toml:", "pair", "E and nu", "glass"});
}

TEST_F(ParticlesBadInput, Contacts) {
  expect("restitution = 0.9", "restitution = 1.1", {"scene.toml:12: restitution", "from 0 to 1"});
  expect("mu = 0.3", "mu = 0.3\nkr_ratio = 1.0", {"scene.toml:14: kr_ratio", "nothing resists rolling"});
  expect("mu = 0.3", "mu = 0.0\nmu_r = 0.1", {"scene.toml:14: mu_r", "needs friction"});
  expect("restitution = 0.9", "restitution = 1.0\nmu_r = 0.1\nrolling_damping = 0.5",
         {"scene.toml:14: rolling_damping", "no dashpot"});
  expect("mu = 0.3", "mu = -0.3", {"scene.toml:13: mu"});
  expect("mu = 0.3\n", "", {"mu", "scene.toml:"});
  expect("law = \"hertz-tsuji\"", "law = \"hertz-tsuij\"", {"scene.toml:11: law", "nearest is \"hertz-tsuji\""});
  expect("pair = [\"glass\", \"rigid\"]", "pair = [\"glass\", \"rigit\"]",
         {"scene.toml:15: pair", "nearest is 'rigid'"});
  expect("pair = [\"glass\", \"rigid\"]", "pair = [\"glass\", \"glass\"]",
         {"scene.toml:15: pair", "already", "scene.toml:10"});
  expect("pair = [\"glass\", \"rigid\"]", "pair = [\"glass\", \"bare\"]",
         {"'glass'", "'rigid'", "no law", "scene.toml:"});
  expect("pair = [\"glass\", \"rigid\"]", "pair = [\"rigid\", \"rigid\"]", {"scene.toml:15: pair", "two rigid"});
  expect("mu = 0.3", "mu = 0.3\ntangential = \"spring\"", {"scene.toml:14: tangential"});
  expect("mu = 0.3", "mu = 0.3\nnormal_stiffness = 1.0", {"scene.toml:14: unknown key 'normal_stiffness'"});
  expect("law = \"hertz-tsuji\"", "law = \"linear-spring\"\nnormal_stiffness = 1e3\ntangential_stiffness = 0.0",
         {"scene.toml:13: tangential_stiffness"});
}

TEST_F(ParticlesBadInput, Walls) {
  expect("shape = \"plane\"", "shape = \"box\"", {"scene.toml:28: shape"});
  expect("normal = [0.0, 0.0, 1.0]", "normal = [0.0, 0.0, 0.0]", {"scene.toml:30: normal"});
  expect("material = \"rigid\"", "material = \"rigid\"\nmotion = \"force\"\nforce = 1.0\nmass = 1e-9",
         {"scene.toml:28", "mass", "heaviest"});
  expect("material = \"rigid\"", "material = \"rigid\"\nmotion = \"velocity\"", {"velocity", "scene.toml:"});
  expect("shape = \"plane\"\npoint = [0.0, 0.0, 0.0]\nnormal = [0.0, 0.0, 1.0]",
         "shape = \"sphere-inside\"\ncenter = [0.0, 0.0, 0.05]\nradius = 0.009", {"scene.toml:22", "radius", "wall-1"});
  expect("material = \"rigid\"\n",
         "material = \"rigid\"\nname = \"a\"\n[[wall]]\nshape = \"plane\"\npoint = [0.0, 0.0, 0.0]\nnormal = [0.0, "
         "0.0, 1.0]\nmaterial = \"rigid\"\nname = \"a\"\n",
         {"scene.toml:38: name", "scene.toml:28"});
  expect("material = \"rigid\"\n", "material = \"rigid\"\nname = \"none\"\n", {"scene.toml:32: name", "inside"});
}

TEST_F(ParticlesBadInput, PlacesThatNothingHolds) {
  expect("position = [0.0, 0.0, 0.05]", "position = [0.0, 0.0, -0.05]",
         {"scene.toml:22: position", "particle 0 is 0.05 m behind the wall 'wall-1'", "turn the normal"});
  expect("normal = [0.0, 0.0, 1.0]", "normal = [0.0, 0.0, -1.0]",
         {"scene.toml:22: position", "behind the wall 'wall-1'", "(and 1 more)"});
  expect("[time]", "[guards.escape]\nlow = [-1.0, -1.0, 0.07]\n[time]",
         {"scene.toml:22: position", "outside the room of guards.escape", "z = 0.05 m"});
  expect_file("1 1 1 1\n0.0 0.0 -0.03 0.01\n", {"many.xyzr:2: position", "behind the wall 'wall-1'"});
}

TEST_F(ParticlesBadInput, CellTimeAndOutput) {
  expect("[time]", "[cell]\nsize = [1.0, 1.0, 1.0]\nperiodic = [true, true]\n[time]",
         {"scene.toml:34: periodic", "three"});
  expect("[time]", "[cell]\nsize = [1.0, 1.0, 0.0]\nperiodic = [true, true, false]\n[time]", {"scene.toml:33: size"});
  expect("[time]", "[cell]\nsize = [1.0, 1.0, 1.0]\nperiodic = [true, true, true]\n[time]",
         {"scene.toml:30: normal", "periodic"});
  expect("[time]", "[cell]\nsize = [1.0, 1.0, 1.0]\nperiodic = [true, false, false]\nshear_rate = 1.0\n[time]",
         {"scene.toml:35: shear_rate"});
  expect("end = 1e-3", "end = 0.0", {"scene.toml:33: end"});
  expect("end = 1e-3", "", {"end", "scene.toml:32"});
  expect("end = 1e-3", "end = 1e-3\nstep = 1e-2",
         {"scene.toml:34: step", "limit", "particle 0", "hertz-tsuji of glass and rigid", "scene.toml:15"});
  expect("end = 1e-3", "end = 1e-3\nstep = \"fast\"", {"scene.toml:34: step"});
  expect("end = 1e-3", "end = 1e30", {"scene.toml:33: end", "steps"});
  expect("end = 1e-3", "end = 1e-3\nstep_fraction = 0.7", {"scene.toml:34: step_fraction", "0.6"});
  expect("end = 1e-3", "end = 1e-3\nsteps = 10", {"scene.toml:34: steps", "not both"});
  expect("end = 1e-3", "steps = 0", {"scene.toml:33: steps", "1"});
  expect("end = 1e-3", "steps = 2000000000000", {"scene.toml:33: steps", "1000000000000"});
  expect("end = 1e-3", "steps = 1.5", {"scene.toml:33: steps"});
  expect("end = 1e-3", "steps = 10\nwarm_up_steps = 10", {"scene.toml:34: warm_up_steps", "9"});
  expect("end = 1e-3", "steps = 10\nwarm_up_steps = -1", {"scene.toml:34: warm_up_steps", "0"});
  expect("end = 1e-3", "steps = 10\nstep = 1e-2", {"scene.toml:34: step", "limit", "hertz-tsuji of glass and rigid"});
  expect("end = 1e-3", "end = 1e-3\n[output]\nrecord = false\nevery = 1e-4", {"scene.toml:36: every", "record"});
  expect("end = 1e-3", "end = 1e-3\n[output]\nrecord = 0", {"scene.toml:35: record"});
  expect("end = 1e-3", "end = 1e-3\n[output]\nevery = 0.0", {"scene.toml:35: every"});
  expect("end = 1e-3", "end = 1e-3\nstep = 1e-6\n[output]\nevery = 5e-7", {"scene.toml:36: every", "at least 1e-06 s"});
  expect("end = 1e-3", "end = 1e-3\n[output]\nevry = 1e-4", {"scene.toml:35: unknown key 'evry'", "'every'"});
  expect("end = 1e-3", "end = 1e-3\n[checkpoint]\nevery_steps = -1", {"scene.toml:35: every_steps"});
}

TEST_F(ParticlesBadInput, CellsFromFilesAndNarrowCells) {
  const std::string periodic = "periodic = [true, true, false]\n[time]";
  expect("[time]", "[cell]\nsize = \"file\"\n" + periodic, {"scene.toml:33: size", "[particles] file"});
  expect("[time]", "[cell]\nsize = \"fill\"\n" + periodic, {"scene.toml:33: size", "nearest is \"file\""});
  expect("[time]", "[cell]\nsize = [1.0, 0.039, 1.0]\n" + periodic, {"scene.toml:33: size", "axis y", "0.04"});
  // Neighbour lists need a little more room than two diameters.
  expect("[time]", "[cell]\nsize = [1.0, 0.0401, 1.0]\n" + periodic, {"scene.toml:33: size", "axis y", "0.0401606"});
  const std::string cell = "[cell]\nsize = \"file\"\n" + periodic;
  write_text_atomic(directory_.file("many.xyzr"), "1 0 1 1\n0 0 1 0.01\n");
  expect("[time]", "[particles]\nfile = \"many.xyzr\"\nmaterial = \"glass\"\n" + cell, {"many.xyzr:1", "above 0"});
}

TEST_F(ParticlesBadInput, ScenesTooLargeForTheMemory) {
  EXPECT_EQ(memory_problem(1000, 0.0), "") << "unknown memory refuses nothing";
  EXPECT_EQ(memory_problem(1000, 1e9), "");
  const std::string problem = memory_problem(1000000, 1e9);
  for (const char* word : {"GB", "bytes per grain", "per listed pair", "allowed: up to"})
    EXPECT_NE(problem.find(word), std::string::npos) << word << " not in: " << problem;
  if (memory_problem(100000000, available_memory()).empty()) GTEST_SKIP() << "there is memory for 1e8 grains here";
  for (const char* command : {"microsim", "check"})
    expect_file("100000000 1 1 1\n0 0 1 0.01\n", {"many.xyzr:1: N = 100000000", "GB", "bytes per grain"}, command);
}

TEST_F(ParticlesBadInput, FilesOfManySpheres) {
  expect_file("", {"many.xyzr:1", "N Lx Ly Lz"});
  expect_file("2 1 1 1\n0 0 1 0.01\n", {"many.xyzr:3", "ends after 1 of 2"});
  expect_file("1 1 1 1\n0 0 1 0.01\n0 1 1 0.01\n", {"many.xyzr:3", "more lines"});
  expect_file("1 1 1 1\n0 0 1 -0.01\n", {"many.xyzr:2", "above 0"});
  expect_file("1 1 1 1\n0 nan 1 0.01\n", {"many.xyzr:2", "finite"});
  expect_file("1 1 1 1\n0 1 0.01\n", {"many.xyzr:2", "four"});
  expect_file("1 1 1 1\n0 0 1 0.01 7\n", {"many.xyzr:2", "four"});
  expect_file("1.5 1 1 1\n0 0 1 0.01\n", {"many.xyzr:1", "whole number from 1 to 1e8"});
  expect_file("0 1 1 1\n", {"many.xyzr:1", "whole number from 1 to 1e8"});
  expect_file("1 1 1\n0 0 1 0.01\n", {"many.xyzr:1", "N Lx Ly Lz"});
  expect_file("1 1 1 1\n0 0 1 1e400\n", {"many.xyzr:2", "finite"});
  expect_file("1 1 1 1\n0 0 1 0.01" + std::string(5000, ' ') + "\n", {"many.xyzr:2", "longer"});
  expect_file("1 1 1 1\n0 0 0.1 0.01\n", {"many.xyzr:2", "same centre", "scene.toml:26"});
  expect_file("1 1 1 1\n0 0 1 1e-120\n", {"many.xyzr:2", "radius", "mass"});
  expect("[time]", "[particles]\nfile = \"nothing.xyzr\"\n[time]", {"material"});
}

TEST_F(ParticlesBadInput, MissingFilesAreFileTrouble) {
  std::string text = kGood;
  text += "[particles]\nfile = \"nothing.xyzr\"\nmaterial = \"glass\"\n";
  write_text_atomic(directory_.file("scene.toml"), text);
  const auto outcome = run_the_program("microsim '" + directory_.file("scene.toml") + "' --quiet --out '" +
                                       directory_.file("out") + "'");
  EXPECT_EQ(outcome.status, 4) << outcome.output;
  EXPECT_NE(outcome.output.find("nothing.xyzr"), std::string::npos);
}

}  // namespace
