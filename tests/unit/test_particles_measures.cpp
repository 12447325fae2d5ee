// Cells from files, runs by steps, and what is measured at the end of a run: contacts, stress, cost.
#include "common/dynamics/verlet.h"
#include "common/io/text_file.h"
#include "microsim/particles/particles_run.h"
#include "microsim/particles/trajectory.h"
#include "tests/support/small_packing.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

const std::string kScene = R"(kind = "particles"
[material.glass]
density = 2500.0
E = "10 MPa"
nu = 0.25
[[contact]]
pair = ["glass", "glass"]
law = "hertz-tsuji"
restitution = 0.5
mu = 0.4
[particles]
file = "many.xyzr"
material = "glass"
[cell]
size = "file"
periodic = [true, true, true]
)";

/// A cubic lattice of 4 x 4 x 4 grains of radius 0.01 that overlap by 2 % of it along the axes.
std::string lattice() {
  constexpr double kSpacing = 0.0198;
  std::string text = "64" + std::string(3, ' ');
  for (int k = 0; k < 3; ++k) text += std::to_string(4 * kSpacing) + " ";
  text += "\n";
  for (int n = 0; n < 64; ++n) {
    for (const int place : {n % 4, n / 4 % 4, n / 16}) text += std::to_string(kSpacing * place) + " ";
    text += "0.01\n";
  }
  return text;
}

class ParticlesMeasures : public ::testing::Test {
 protected:
  void SetUp() override { write_text_atomic(directory_.file("many.xyzr"), lattice()); }
  [[nodiscard]] ParticlesScene read(const std::string& more) const {
    return read_particles_scene(Scene::parse(kScene + more, directory_.file("scene.toml")));
  }
  TemporaryDirectory directory_;
};

TEST_F(ParticlesMeasures, TheCellComesFromTheFile) {
  const ParticlesScene scene = read("[time]\nsteps = 10\n");
  EXPECT_TRUE(scene.system.cell.edges == (box_cell<3>({{0.0792, 0.0792, 0.0792}}, {true, true, true}).edges));
  EXPECT_TRUE(scene.system.cell.periodic[0] && scene.system.cell.periodic[2]);
}

TEST_F(ParticlesMeasures, EndByTheNumberOfSteps) {
  const ParticlesScene fixed = read("[time]\nsteps = 30\nstep = 1e-5\nwarm_up_steps = 10\n");
  EXPECT_EQ(fixed.time.steps, 30);
  EXPECT_EQ(fixed.time.warm_up_steps, 10);
  EXPECT_DOUBLE_EQ(fixed.time.end, 3e-4);
  const ParticlesScene automatic = read("[time]\nsteps = 30\n");
  EXPECT_DOUBLE_EQ(automatic.time.step, 0.05 * automatic.time.natural_time);
  EXPECT_DOUBLE_EQ(automatic.time.end, 30.0 * automatic.time.step);
}

TEST_F(ParticlesMeasures, StressOfALatticeByHand) {
  const ParticlesScene scene = read("[time]\nsteps = 1\n");
  const ContactTotals totals = contact_totals(scene.system);
  EXPECT_EQ(totals.contacts, 192);
  EXPECT_DOUBLE_EQ(totals.coordination_number, 6.0);
  // One contact of force F per grain and axis: sigma_kk = -F/a^2 at the spacing a.
  const double k = HertzCoefficients::of(glass(), glass(), 0.4, 0.5).inverse_d;
  const double force = std::sqrt(0.005) * std::pow(2e-4, 1.5) * k;
  ASSERT_TRUE(totals.has_stress);
  EXPECT_NEAR(totals.pressure, force / (0.0198 * 0.0198), 1e-6 * totals.pressure);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(totals.stress[r][c], r == c ? -totals.pressure : 0.0, 1e-6 * totals.pressure) << r << c;
}

TEST_F(ParticlesMeasures, ShearOfTheCellGivesAShearStressThatOpposesIt) {
  // Grains start at rest, so that the images carry the shear in; half a period of a shear wave across the cell is
  // plenty.
  ParticlesScene scene = read("[time]\nsteps = 400\n");
  scene.system.cell.velocity_gradient[0][1] = 0.05 / scene.time.end;
  auto& p = scene.system.particles;
  for (std::size_t u = 0; u < p.velocity.size(); ++u)
    p.velocity[u] = scene.system.cell.velocity_gradient * Vec3(p.sphere[u].x);
  const ParticlesResult result = run_particles(scene, {});
  ASSERT_TRUE(result.usable) << result.reason;
  const ContactTotals totals = contact_totals(result.system);
  EXPECT_GT(totals.stress[0][1], 0.01 * totals.pressure);
  EXPECT_NEAR(result.system.cell.edges[0][1] / result.system.cell.edges[1][1], 0.05, 1e-12);
}

TEST_F(ParticlesMeasures, OpenCellsHaveNoStress) {
  ParticlesScene scene = read("[time]\nsteps = 1\n");
  scene.system.cell.periodic = {true, true, false};
  EXPECT_FALSE(contact_totals(scene.system).has_stress);
}

TEST_F(ParticlesMeasures, CostIsSplitAndNothingIsRecordedWhenNotAsked) {
  const ParticlesScene scene = read("[time]\nsteps = 30\nwarm_up_steps = 10\n[output]\nrecord = false\n");
  const ParticlesResult result = run_particles(scene, {});
  EXPECT_EQ(result.warm_up.steps, 10);
  EXPECT_EQ(result.measured.steps, 20);
  EXPECT_EQ(result.measured.contact_evaluations, 2 * result.warm_up.contact_evaluations);
  EXPECT_GT(result.measured.seconds, 0.0);
  EXPECT_LE(result.warm_up.seconds + result.measured.seconds, result.system.cost.seconds);
  EXPECT_TRUE(result.trajectory.time.empty());
  EXPECT_FALSE(result.watched);
  const ParticlesScene recorded = read("[time]\nsteps = 30\n");
  const ParticlesResult same = run_particles(recorded, {});
  EXPECT_EQ(same.trajectory.time.size(), 2U);
  EXPECT_TRUE(same.system.particles.sphere[5].x == result.system.particles.sphere[5].x);
}

/// Every frame that keeps its contacts says stress, fabric and inertial number; a file gives them back.
TEST_F(ParticlesMeasures, FramesOfAShearedCellSayTheirTensors) {
  const ParticlesScene scene =
      read("shear_rate = 0.5\n[time]\nsteps = 40\nstep = 1e-6\n[output]\nevery = 1e-5\nsnapshots = 3\n");
  const ParticlesResult out = run_particles(scene, {});
  ASSERT_TRUE(out.usable) << out.reason;
  const Trajectory& t = out.trajectory;
  ASSERT_EQ(t.time.size(), 5U);
  ASSERT_EQ(t.stress.size(), 45U);
  ASSERT_EQ(t.inertial_number.size(), 5U);
  std::size_t with = 0;
  for (std::size_t k = 0; k < 5; ++k) {
    const bool has = std::isfinite(t.inertial_number[k]);
    EXPECT_EQ(has, std::isfinite(t.stress[9 * k])) << k;
    if (!has) continue;
    ++with;
    const double pressure = -(t.stress[9 * k] + t.stress[9 * k + 4] + t.stress[9 * k + 8]) / 3.0;
    EXPECT_NEAR(t.inertial_number[k], 0.5 * 0.02 * std::sqrt(2500.0 / pressure), 1e-12) << k;
    for (int a = 0; a < 3; ++a) EXPECT_NEAR(t.fabric[9 * k + 4 * static_cast<std::size_t>(a)], 1.0 / 3.0, 1e-6) << k;
  }
  EXPECT_EQ(with, 3U);
  EXPECT_TRUE(std::isfinite(t.inertial_number.back()));
  const ContactTotals<3> totals = contact_totals(out.system);
  EXPECT_EQ(totals.inertial_number, t.inertial_number.back());
  EXPECT_DOUBLE_EQ(totals.rate, 0.5);
  const std::string path = directory_.file("trajectory.h5");
  {
    h5::AtomicFile file(path);
    write_trajectory(file.root().create("trajectory"), t);
    file.commit();
  }
  const Trajectory back = read_trajectory(h5::open_file(path).open("trajectory"));
  EXPECT_EQ(back.fabric.back(), t.fabric.back());
  EXPECT_EQ(back.stress.back(), t.stress.back());
  EXPECT_EQ(back.inertial_number.back(), t.inertial_number.back());
}

TEST_F(ParticlesMeasures, WithoutShearThereIsNoInertialNumber) {
  const ParticlesScene scene = read("[time]\nsteps = 2\nstep = 1e-6\n");
  const ParticlesResult out = run_particles(scene, {});
  const ContactTotals<3> totals = contact_totals(out.system);
  EXPECT_TRUE(std::isnan(totals.inertial_number));
  EXPECT_GT(totals.pressure, 0.0);
  EXPECT_LT(totals.asymmetry, 1e-9);
}

}  // namespace
