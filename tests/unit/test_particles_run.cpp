// Scenes of explicit particles: what is read is what runs, watching changes nothing, walls move as told.
#include "microsim/particles/particles_run.h"

#include <zlib.h>

#include <numbers>

#include "common/core/error.h"
#include "common/dynamics/verlet.h"
#include "common/io/interrupt.h"
#include "common/io/text_file.h"
#include "tests/support/small_packing.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

const std::string kHead = R"(kind = "particles"
[material.glass]
density = 2500.0
E = "1 MPa"
nu = 0.2
[[contact]]
pair = ["glass", "glass"]
law = "hertz-tsuji"
restitution = 0.8
mu = 0.4
)";

std::string particle(double x, double y, double z, double r, const std::string& more = "") {
  return "[[particle]]\nmaterial = \"glass\"\nradius = " + std::to_string(r) + "\nposition = [" + std::to_string(x) +
         ", " + std::to_string(y) + ", " + std::to_string(z) + "]\n" + more;
}

ParticlesScene scene_of_text(const std::string& text) { return read_particles_scene(Scene::parse(text, "scene.toml")); }

ParticlesResult run(const ParticlesScene& scene) { return run_particles(scene, {}); }

/// Grains that fall into a sphere cut by a plane.
std::string multi_contact() {
  std::string text =
      "gravity = [0.0, 0.0, -9.81]\n" + kHead +
      "[[wall]]\nname = \"bowl\"\nshape = \"sphere-inside\"\ncenter = [0.0, 0.0, 0.0]\nradius = 0.1\nmaterial = "
      "\"glass\"\n"
      "[[wall]]\nshape = \"plane\"\npoint = [0.0, 0.0, -0.06]\nnormal = [0.0, 0.0, 2.0]\nmaterial = \"glass\"\n";
  for (int n = 0; n < 27; ++n)
    text += particle(0.025 * (n % 3 - 1) + 1e-4 * n, 0.025 * (n / 3 % 3 - 1), 0.025 * (n / 9 - 1), 0.011);
  return text;
}

TEST(ParticlesScene, ReadsWhatIsWritten) {
  const ParticlesScene scene =
      scene_of_text(multi_contact() + "[time]\nend = 0.1\nstep = 1e-4\n[output]\nevery = 1e-3\n");
  const auto& p = scene.system.particles;
  EXPECT_EQ(p.grains, 27);
  EXPECT_EQ(p.shells, 1);
  EXPECT_EQ(p.planes, 1);
  EXPECT_EQ(p.shell[5], 27);
  EXPECT_EQ(scene.wall_name, (std::vector<std::string>{"bowl", "wall-2"}));
  EXPECT_DOUBLE_EQ(1.0 / p.inverse_mass[3], 2500.0 * 4.0 / 3.0 * std::numbers::pi * 0.011 * 0.011 * 0.011);
  EXPECT_DOUBLE_EQ(1.0 / p.inverse_inertia[3], 0.4 * 0.011 * 0.011 / p.inverse_mass[3]);
  EXPECT_TRUE(p.plane_normal[0] == (Vec3{{0.0, 0.0, 1.0}}));
  EXPECT_EQ(scene.time.steps, 1000);
  EXPECT_EQ(scene.output_stride, 10);
}

/// A ball that rolls on a plane under each law, and slows down by 5/7 mu_r g.
TEST(ParticlesScene, ContactsMayResistRolling) {
  for (const std::string law : {"law = \"hertz-tsuji\"\n",
                                "law = \"linear-spring\"\nnormal_stiffness = 1e4\n"
                                "tangential_stiffness = 8e3\n"}) {
    const auto text = [&](const std::string& more) {
      return "kind = \"particles\"\ngravity = [0.0, 0.0, -9.81]\n[material.glass]\ndensity = 2500.0\nE = \"10 MPa\"\n"
             "nu = 0.2\n[[contact]]\npair = [\"glass\", \"glass\"]\n" +
             law + "restitution = 0.5\nmu = 0.6\n" + more +
             "[[wall]]\nshape = \"plane\"\npoint = [0.0, 0.0, 0.0]\nnormal = [0.0, 0.0, 1.0]\nmaterial = \"glass\"\n" +
             particle(0.0, 0.0, 0.009985, 0.01, "velocity = [0.2, 0.0, 0.0]\nspin = [0.0, 20.0, 0.0]\n") +
             "[time]\nend = 0.2\n";
    };
    const auto speed = [&](const std::string& more) {
      const ParticlesScene scene = scene_of_text(text(more));
      return std::pair{run(scene).system.particles.velocity[0][0], scene.time.step};
    };
    const double slowed = 5.0 / 7.0 * 0.05 * 9.81 * 0.2;
    EXPECT_NEAR(0.2 - speed("mu_r = 0.05\n").first, slowed, 0.02 * slowed) << law;
    EXPECT_NEAR(0.2 - speed("mu_r = 0.05\nkr_ratio = 0.3\nrolling_damping = 0\n").first, slowed, 0.05 * slowed) << law;
    EXPECT_NEAR(speed("").first, 0.2, 0.01 * slowed) << law;
    EXPECT_LT(speed("mu_r = 0.05\nkr_ratio = 500.0\n").second, 0.5 * speed("mu_r = 0.05\n").second) << law;
  }
}

TEST(ParticlesScene, ParticlesBelongToTheSphereThatIsNamed) {
  const std::string walls =
      "[[wall]]\nname = \"a\"\nshape = \"sphere-inside\"\ncenter = [0.0, 0.0, 0.0]\nradius = 0.1\nmaterial = "
      "\"glass\"\n"
      "[[wall]]\nname = \"b\"\nshape = \"sphere-inside\"\ncenter = [0.05, 0.0, 0.0]\nradius = 0.1\nmaterial = "
      "\"glass\"\n";
  const ParticlesScene scene = scene_of_text(
      kHead + walls + particle(0.04, 0.0, 0.0, 0.01) + particle(0.03, 0.0, 0.0, 0.01, "inside = \"b\"\n") +
      particle(0.02, 0.0, 0.0, 0.01, "inside = \"none\"\n") + particle(0.5, 0.0, 0.0, 0.01) + "[time]\nend = 1e-3\n");
  EXPECT_EQ(scene.system.particles.shell, (std::vector<std::int32_t>{4, 5, -1, -1, -1, -1}));
}

TEST(ParticlesScene, AutomaticStepResolvesImpactsAndDividesTheEnd) {
  const ParticlesScene scene =
      scene_of_text(kHead + particle(-0.02, 0.0, 0.0, 0.01, "velocity = [3.0, 0.0, 0.0]\n") +
                    particle(0.02, 0.0, 0.0, 0.01, "velocity = [-3.0, 0.0, 0.0]\n") + "[time]\nend = 0.01\n");
  EXPECT_LE(scene.time.step, scene.time.contact_time / 200.0);
  EXPECT_LE(scene.time.step, 0.05 * scene.time.natural_time);
  EXPECT_DOUBLE_EQ(scene.time.step * static_cast<double>(scene.time.steps), 0.01);
}

/// Also where nothing moves yet: a cell that is sheared, a plane that a load drives.
TEST(ParticlesScene, AutomaticStepResolvesImpactsThatAreDriven) {
  const std::string pair = kHead + particle(0.2, 0.5, 0.5, 0.01) + particle(0.8, 0.5, 0.5, 0.01);
  const std::string cell = "[cell]\nsize = [1.0, 1.0, 1.0]\nperiodic = [true, true, true]\n";
  const std::string end = "[time]\nend = 1.0\n";
  EXPECT_TRUE(std::isinf(scene_of_text(pair + cell + end).time.contact_time));
  const SceneTime sheared = scene_of_text(pair + cell + "shear_rate = 50.0\n" + end).time;
  const SceneTime same =
      scene_of_text(pair + particle(0.5, 0.2, 0.5, 0.01, "velocity = [50.0, 0.0, 0.0]\n") + end).time;
  EXPECT_DOUBLE_EQ(sheared.contact_time, same.contact_time);
  EXPECT_LE(sheared.step, sheared.contact_time / 200.0);
  const std::string lid =
      "[[wall]]\nshape = \"plane\"\npoint = [0.0, 0.0, 0.5]\nnormal = [1.0, 0.0, 0.0]\nmaterial = \"glass\"\nmotion = "
      "\"force\"\nmass = 0.1\nforce = ";
  const SceneTime pressed = scene_of_text(pair + lid + "500.0\n" + end).time;
  EXPECT_TRUE(std::isfinite(pressed.contact_time));
  EXPECT_LE(pressed.step, pressed.contact_time / 200.0);
  EXPECT_TRUE(std::isinf(scene_of_text(pair + lid + "-500.0\n" + end).time.contact_time)) << "it goes away";
}

TEST(ParticlesScene, FilesOfManySpheresPlainAndPacked) {
  const TemporaryDirectory directory;
  const std::string content = "2 1 1 1\n0.0\t0.25 0.5 0.01\n1e-1 0.0 0.0 2.0e-2\n";
  write_text_atomic(directory.file("a.xyzr"), content);
  const gzFile packed = gzopen(directory.file("a.xyzr.gz").c_str(), "wb");
  ASSERT_EQ(gzwrite(packed, content.data(), static_cast<unsigned>(content.size())), static_cast<int>(content.size()));
  gzclose(packed);
  for (const char* name : {"a.xyzr", "a.xyzr.gz"}) {
    const ParticlesScene scene =
        read_particles_scene(Scene::parse(kHead + particle(0.5, 0.0, 0.0, 0.01) + "[particles]\nfile = \"" + name +
                                              "\"\nmaterial = \"glass\"\n[time]\nend = 1e-3\n",
                                          directory.file("scene.toml")));
    ASSERT_EQ(scene.system.particles.grains, 3) << name;
    EXPECT_TRUE(scene.system.particles.sphere[1].x == (Vec3{{0.0, 0.25, 0.5}}));
    EXPECT_EQ(scene.system.particles.sphere[2].r, 0.02);
  }
  std::filesystem::resize_file(directory.file("a.xyzr.gz"), 25);
  EXPECT_THROW((void)read_particles_scene(
                   Scene::parse(kHead + "[particles]\nfile = \"a.xyzr.gz\"\nmaterial = \"glass\"\n[time]\nend = 1e-3\n",
                                directory.file("scene.toml"))),
               IoError);
}

TEST(ParticlesRun, OutputWatchingAndCheckpointsDoNotChangeTheTrajectory) {
  const TemporaryDirectory directory;
  ParticlesScene scene = scene_of_text(
      multi_contact() + "[time]\nend = 0.15\nstep = 5e-5\n[output]\nevery = 1e-3\n[checkpoint]\nevery_steps = 700\n");
  ParticlesControl control;
  control.checkpoint = directory.file("checkpoint.h5");
  const ParticlesResult watched = run_particles(scene, control);
  ASSERT_TRUE(watched.usable) << watched.reason;
  EXPECT_EQ(watched.trajectory.time.size(), 151U);
  EXPECT_GE(watched.contacts.size(), 27U);
  // The bare loop, with nothing around it.
  System3 bare = scene.system;
  VelocityVerlet<3> integrator(scene.time.step);
  integrator.initialise(bare);
  for (std::int64_t k = 0; k < scene.time.steps; ++k) integrator.step(bare);
  expect_same_state(bare, watched.system);
}

TEST(ParticlesRun, AnInterruptSavesAndResumeGivesTheSameBits) {
  const TemporaryDirectory directory;
  const ParticlesScene scene =
      scene_of_text(multi_contact() + "[time]\nend = 0.1\nstep = 5e-5\n[output]\nevery = 1e-3\n");
  const ParticlesResult whole = run(scene);
  ParticlesControl control;
  control.checkpoint = directory.file("checkpoint.h5");
  control.progress = [](std::int64_t step) {
    if (step == 1024) request_interrupt();
  };
  EXPECT_THROW((void)run_particles(scene, control), Interrupted);
  clear_interrupt();
  control.resume = true;
  control.progress = nullptr;
  const ParticlesResult resumed = run_particles(scene, control);
  expect_same_state(whole.system, resumed.system);
  EXPECT_EQ(whole.trajectory.position, resumed.trajectory.position);
  EXPECT_EQ(whole.trajectory.rotational_energy, resumed.trajectory.rotational_energy);
  ASSERT_EQ(whole.contacts.size(), resumed.contacts.size());
  for (std::size_t k = 0; k < whole.contacts.size(); ++k) {
    EXPECT_EQ(whole.contacts[k].duration, resumed.contacts[k].duration);
    EXPECT_EQ(whole.contacts[k].max_force, resumed.contacts[k].max_force);
    EXPECT_EQ(whole.contacts[k].count, resumed.contacts[k].count);
  }
}

TEST(ParticlesRun, ALostParticleEndsTheRunAndIsNamed) {
  ParticlesScene scene = scene_of_text(multi_contact() + "[time]\nend = 0.1\nstep = 5e-5\n");
  scene.system.particles.velocity[7] = {{0.0, std::numeric_limits<double>::quiet_NaN(), 0.0}};
  const ParticlesResult nan = run(scene);
  EXPECT_FALSE(nan.usable);
  EXPECT_NE(nan.reason.find(" 7 "), std::string::npos) << nan.reason;
  scene = scene_of_text(multi_contact() + "[time]\nend = 0.1\nstep = 5e-5\n");
  scene.system.particles.velocity[9] = {{400.0, 0.0, 0.0}};  // twice its radius in a step
  const ParticlesResult fast = run(scene);
  EXPECT_FALSE(fast.usable);
  EXPECT_NE(fast.reason.find(" 9 "), std::string::npos) << fast.reason;
}

/// A plate of given mass under a force squeezes a column of balls: at rest the contact forces carry it, gravity does
/// not act on it.
TEST(ParticlesRun, AWallUnderAForceComesToRestOnIt) {
  std::string head = kHead;
  head.replace(head.find("restitution = 0.8"), 17, "restitution = 0.1");
  const std::string text =
      head + particle(0.0, 0.0, 0.01, 0.01) + particle(0.0, 0.0, 0.03, 0.01) +
      "[[wall]]\nshape = \"plane\"\npoint = [0.0, 0.0, 0.0]\nnormal = [0.0, 0.0, 1.0]\nmaterial = \"glass\"\n"
      "[[wall]]\nname = \"plate\"\nshape = \"plane\"\npoint = [0.0, 0.0, 0.0401]\nnormal = [0.0, 0.0, -1.0]\nmaterial "
      "= \"glass\"\n"
      "motion = \"force\"\nforce = 0.5\nmass = 0.02\n[time]\nend = 1.5\n";
  const ParticlesResult out = run(scene_of_text(text));
  ASSERT_TRUE(out.usable) << out.reason;
  const auto& p = out.system.particles;
  EXPECT_LT(norm(p.velocity[3]), 1e-5);
  EXPECT_EQ(p.sphere[3].x[0], 0.0);
  const double d = 0.75 * 2.0 * (1.0 - 0.04) / 1e6;
  const double plane_overlap = std::pow(0.5 * d / std::sqrt(0.01), 2.0 / 3.0);
  const double ball_overlap = std::pow(0.5 * d / std::sqrt(0.005), 2.0 / 3.0);
  EXPECT_NEAR(p.sphere[3].x[2], 0.04 - 2.0 * plane_overlap - ball_overlap, 1e-3 * plane_overlap);
  EXPECT_NEAR(p.sphere[2].x[2], 0.0, 0.0);
}

TEST(ParticlesRun, AMovingWallCarriesItsParticles) {
  const std::string text =
      kHead + particle(0.0, 0.0, 0.0, 0.02) +
      "[[wall]]\nshape = \"sphere-inside\"\ncenter = [0.0, 0.0, 0.0]\nradius = 0.021\nmaterial = \"glass\"\n"
      "motion = \"velocity\"\nvelocity = [0.1, 0.0, 0.0]\n[time]\nend = 2.0\n";
  const ParticlesResult out = run(scene_of_text(text));
  ASSERT_TRUE(out.usable) << out.reason;
  EXPECT_NEAR(out.system.particles.sphere[1].x[0], 0.2, 1e-12);
  EXPECT_NEAR(out.system.particles.sphere[0].x[0], 0.2, 0.002);
}

/// Two free particles in a sheared cell: one that leaves through the upper face comes back with the speed of its image.
TEST(ParticlesRun, AShearedCellGivesImagesTheirVelocity) {
  const std::string text = kHead + particle(0.5, 0.9, 0.5, 0.01, "velocity = [0.0, 1.0, 0.0]\n") +
                           particle(0.1, 0.1, 0.1, 0.01) +
                           "[cell]\nsize = [1.0, 1.0, 1.0]\nperiodic = [true, true, true]\nshear_rate = "
                           "0.5\n[time]\nend = 0.3\nstep = 1e-4\n";
  const ParticlesResult out = run(scene_of_text(text));
  ASSERT_TRUE(out.usable) << out.reason;
  EXPECT_NEAR(out.system.particles.velocity[0][0], -0.5, 1e-12);
  EXPECT_NEAR(out.system.cell.edges[0][1], 0.15, 1e-9);
}

TEST(ParticlesRun, ContactsThatLastAndComeBackAreCounted) {
  // A ball that bounces three times on a plane, and one that rests on it from the beginning.
  const std::string text = "gravity = [0.0, 0.0, -9.81]\n" + kHead + particle(0.0, 0.0, 0.0101, 0.01) +
                           particle(1.0, 0.0, 0.00995, 0.01) +
                           "[[wall]]\nname = \"floor\"\nshape = \"plane\"\npoint = [0.0, 0.0, 0.0]\nnormal = [0.0, "
                           "0.0, 1.0]\nmaterial = \"glass\"\n[time]\nend = 0.02\n";
  const ParticlesResult out = run(scene_of_text(text));
  ASSERT_EQ(out.contacts.size(), 2U);
  EXPECT_GE(out.contacts[0].count, 1);
  EXPECT_GT(out.contacts[0].duration, 0.0);
  EXPECT_LE(out.contacts[1].duration, 0.02 + 1e-12);
  EXPECT_GE(out.contacts[1].max_overlap, 5e-5);
}

TEST(ParticlesRun, TheFileHoldsEverything) {
  const TemporaryDirectory directory;
  const ParticlesScene scene =
      scene_of_text(multi_contact() + "[time]\nend = 0.02\nstep = 5e-5\n[output]\nevery = 1e-3\n");
  const ParticlesResult out = run(scene);
  save_particles_run(directory.file("run.h5"), scene, out, build_provenance());
  const h5::Group root = h5::open_file(directory.file("run.h5"));
  EXPECT_EQ(root.text("status"), "good");
  EXPECT_EQ(root.open("trajectory").shape("position"), (h5::Shape{21, 27, 3}));
  EXPECT_EQ(root.open("trajectory").shape("wall_position"), (h5::Shape{21, 2, 3}));
  EXPECT_EQ(root.open("bodies").doubles("radius").size(), 27U);
  EXPECT_TRUE(root.has("provenance"));
  EXPECT_TRUE(root.open("final").has("contacts"));
  const Trajectory read_back = read_trajectory(root.open("trajectory"));
  EXPECT_EQ(read_back.velocity, out.trajectory.velocity);
}

}  // namespace
