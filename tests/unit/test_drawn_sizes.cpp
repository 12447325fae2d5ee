// Where radii are drawn a distribution of sizes is what they follow; what is measured on it remembers it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/core/error.h"
#include "common/core/particles.h"
#include "common/data/card_text.h"
#include "common/data/measurements.h"
#include "common/data/soft_particle_schema.h"
#include "macrosim/constructed_packing.h"
#include "microsim/grain_box/grain_box_run.h"
#include "microsim/particles/particles_scene.h"
#include "microsim/powder/powder_start.h"
#include "microsim/powder/powder_state_io.h"
#include "microsim/shell_packing.h"
#include "pipelines/compare/compare_inputs.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using softgrain::test::TemporaryDirectory;

/// Half the volume in grains of 1 mm, half in such of 3 mm: 27 of the small for each large one.
Grading two_sizes(int dimension = 3) {
  return Grading::classes({{1e-3, 1e-3, 4.0, 0.5}, {3e-3, 3e-3, 4.0, 0.5}}, dimension);
}

std::int64_t count_near(const std::vector<double>& radii, double r) {
  return std::count_if(radii.begin(), radii.end(), [r](double x) { return std::abs(x / r - 1.0) < 1e-12; });
}

SoftParticleSpec sized_spec() {
  SoftParticleSpec spec;
  spec.sizes = Grading::fuller(0.5, 2e-3, 8e-3);
  spec.exponent = std::nan("");
  spec.polydispersity = 4.0;
  spec.rmax_over_shell = 0.5;
  return spec;
}

TEST(DrawnSizes, OfMacroScenes) {
  MacroSpec spec;
  spec.bodies = 28 + 28;
  spec.soft_share = 0.0;
  spec.solid_sizes = two_sizes();
  std::vector<double> radii;
  for (const MacroBody& b : make_packing(spec, 1, 0).bodies) radii.push_back(b.r);
  EXPECT_EQ(count_near(radii, 1e-3), 54);
  EXPECT_EQ(count_near(radii, 3e-3), 2);
  EXPECT_TRUE(std::is_sorted(radii.begin(), radii.end(), std::greater<>()));
}

TEST(DrawnSizes, OfSoftParticlesMakeTheirShare) {
  MacroSpec spec;
  spec.bodies = 400;
  spec.soft_share = 0.4;
  spec.solid_sizes = two_sizes();
  spec.soft_sizes = Grading::fuller(0.5, 2e-3, 3e-3);
  double soft = 0.0;
  double all = 0.0;
  for (const MacroBody& b : drawn_bodies(spec, 1, 0)) {
    all += cube(b.r);
    if (!b.soft) continue;
    soft += cube(b.r);
    EXPECT_GE(b.r, 2e-3);
    EXPECT_LE(b.r, 3e-3);
  }
  EXPECT_NEAR(soft / all, 0.4, 0.02);
}

TEST(DrawnSizes, OfSolidGrainsWhoseVoidsAreFilled) {
  MacroSpec spec;
  spec.construction = Construction::voids;
  spec.bodies = 28;
  spec.solid_sizes = two_sizes();
  const std::vector<MacroBody> bodies = drawn_bodies(spec, 1, 0);
  EXPECT_EQ(bodies.size(), 28U);
  EXPECT_TRUE(std::none_of(bodies.begin(), bodies.end(), [](const MacroBody& b) { return b.soft; }));
  EXPECT_EQ(bodies[0].r, 3e-3);
  EXPECT_EQ(bodies[1].r, 1e-3);
}

TEST(DrawnSizes, OfGrainBoxes) {
  GrainBoxSpec spec;
  spec.grains = 56;
  spec.material.sizes = two_sizes();
  const GrainPack pack = make_loose_pack(spec, 1);
  EXPECT_EQ(count_near(pack.radius, 1e-3), 54);
  EXPECT_EQ(count_near(pack.radius, 3e-3), 2);
}

TEST(DrawnSizes, OfPowdersAreByAreaAndOverTheLargest) {
  PowderSpec spec;
  spec.disks = 100;
  spec.sizes = two_sizes(2);  // 9 small for each large one
  spec.diameter_min = 1.0 / 3.0;
  const System<2> s = make_powder(spec, 1, 0);
  std::vector<double> diameters;
  for (const auto& disk : s.particles.sphere) diameters.push_back(2.0 * disk.r);
  EXPECT_EQ(count_near(diameters, 1.0 / 3.0), 90);
  EXPECT_EQ(count_near(diameters, 1.0), 10);
}

TEST(DrawnSizes, OfSingleParticlesWithoutOverlapAcrossTheCell) {
  const std::string text =
      "kind = \"particles\"\n[material.m]\ndensity = 2650.0\nE = \"70 MPa\"\nnu = 0.2\n[[contact]]\npair = [\"m\", "
      "\"m\"]\nlaw = \"hertz-tsuji\"\nrestitution = 0.5\nmu = 0.5\n[[contact]]\npair = [\"m\", \"rigid\"]\nlaw = "
      "\"hertz-tsuji\"\nrestitution = 0.5\nmu = 0.5\n[[particle]]\nmaterial = \"m\"\nradius = 4e-3\nposition = "
      "[0.01, 0.01, 0.01]\n[particles]\nmaterial = \"m\"\ncount = 56\nsizes = { form = \"classes\", class = [{ radius "
      "= "
      "1e-3, volume_share = 0.5 }, { radius = 3e-3, volume_share = 0.5 }] }\n[cell]\nsize = [0.02, 0.02, "
      "0.02]\nperiodic = [true, false, false]\n[[wall]]\nshape = \"plane\"\npoint = [0.0, 0.0, 0.004]\nnormal = [0.0, "
      "0.0, 1.0]\nmaterial = \"rigid\"\n[time]\nend = 1e-5\n";
  const ParticlesScene scene = read_particles_scene<3>(Scene::parse(text, "s"));
  EXPECT_EQ(count_near(scene.drawn, 1e-3), 54);
  EXPECT_EQ(count_near(scene.drawn, 3e-3), 2);
  const auto& p = scene.system.particles;
  ASSERT_EQ(p.grains, 57);
  for (Slot i = 0; i < p.grains; ++i) {
    const auto& a = p.sphere[static_cast<std::size_t>(i)];
    EXPECT_GE(a.x[2] - a.r, 0.004);
    EXPECT_LE(a.x[2] + a.r, 0.02);
    for (Slot j = 0; j < i; ++j) {
      const auto& b = p.sphere[static_cast<std::size_t>(j)];
      Vec3 apart = a.x - b.x;
      apart[0] -= 0.02 * std::round(apart[0] / 0.02);
      EXPECT_GE(norm(apart), a.r + b.r) << i << " and " << j;
    }
  }
  const ParticlesScene same = read_particles_scene<3>(Scene::parse(text, "s"));
  EXPECT_EQ(same.system.particles.sphere[30].x[0], p.sphere[30].x[0]);
  const ParticlesScene other = read_particles_scene<3>(Scene::parse(text, "s", {"particles.seed=2"}));
  EXPECT_NE(other.system.particles.sphere[30].x[0], p.sphere[30].x[0]);
  // At the top level, as in scenes of all kinds; the command line goes first.
  const auto place = [&](const std::vector<std::string>& set, const std::optional<std::uint64_t>& seed = {}) {
    const ParticlesScene drawn = read_particles_scene<3>(Scene::parse(text, "s", set), seed);
    EXPECT_EQ(drawn.seed, 2U);
    return drawn.system.particles.sphere[30].x[0];
  };
  EXPECT_EQ(place({"seed=2"}), other.system.particles.sphere[30].x[0]);
  EXPECT_EQ(place({"seed=3"}, 2), other.system.particles.sphere[30].x[0]);
}

std::string drawn_scene(const std::string& particles, const std::string& more) {
  return "kind = \"particles\"\n[material.m]\ndensity = 1.0\nE = 1e6\nnu = 0.2\n[[contact]]\npair = [\"m\", "
         "\"m\"]\nlaw = \"hertz-tsuji\"\nrestitution = 0.5\nmu = 0.5\n[time]\nend = 1e-5\n[particles]\nmaterial = "
         "\"m\"\nsizes = { form = \"list\", radii = [1.0] }\n" +
         particles + more;
}

/// The least of (distance - radii) over all pairs, by the nearest images in a cell of edge 10 along x.
double least_gap(const ParticlesScene& scene) {
  const auto& sphere = scene.system.particles.sphere;
  double least = 1e300;
  for (std::size_t i = 0; i < sphere.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      Vec3 apart = sphere[i].x - sphere[j].x;
      apart[0] -= 10.0 * std::round(apart[0] / 10.0);
      least = std::min(least, norm(apart) - sphere[i].r - sphere[j].r);
    }
  return least;
}

/// In a box of places of their own too, within the cell or across its faces.
TEST(DrawnSizes, ParticlesStandClearOfImagesInEveryBoxOfPlaces) {
  const std::string cell =
      "[cell]\nsize = [10.0, 10.0, 10.0]\nperiodic = [true, false, false]\n[[particle]]\nmaterial = \"m\"\nradius = "
      "1.0\nposition = [9.9, 1.5, 1.5]\n";
  for (const char* low : {"0.0", "-3.0", "7.0", "17.0"}) {
    const double from = std::stod(low);
    for (int seed = 1; seed <= 5; ++seed) {
      const std::string box =
          fmt::format("count = 2\nseed = {}\nlow = [{}, 0.0, 0.0]\nhigh = [{}, 3.0, 8.0]\n", seed, from, from + 3.5);
      EXPECT_GE(least_gap(read_particles_scene<3>(Scene::parse(drawn_scene(box, cell), "s"))), 0.0) << box;
    }
  }
  const std::string whole = "count = 20\nlow = [-4.0, 0.0, 0.0]\nhigh = [6.0, 10.0, 10.0]\n";
  EXPECT_GE(least_gap(read_particles_scene<3>(Scene::parse(drawn_scene(whole, cell), "s"))), 0.0);
  const std::string wide = "count = 2\nlow = [0.0, 0.0, 0.0]\nhigh = [10.5, 3.0, 3.0]\n";
  try {
    (void)read_particles_scene<3>(Scene::parse(drawn_scene(wide, cell), "s"));
    ADD_FAILURE();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("wider than the cell, which is periodic along x"), std::string::npos)
        << e.what();
  }
  const std::string full = "count = 1000\nlow = [0.0, 0.0, 0.0]\nhigh = [3.0, 3.0, 3.0]\n";
  try {
    (void)read_particles_scene<3>(Scene::parse(drawn_scene(full, cell), "s"));
    ADD_FAILURE();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("of the box; at most 0.74 is possible"), std::string::npos) << e.what();
  }
}

/// Spheres beside each other, each filled.
TEST(DrawnSizes, ParticlesAreWithinOneOfSeveralSpheres) {
  std::string walls;
  for (const char* x : {"0.0", "20.0"})
    walls += std::string("[[wall]]\nshape = \"sphere-inside\"\ncenter = [") + x +
             ", 0.0, 0.0]\nradius = 5.0\nmaterial = \"m\"\n";
  const ParticlesScene scene = read_particles_scene<3>(
      Scene::parse(drawn_scene("count = 20\nlow = [-5.0, -5.0, -5.0]\nhigh = [25.0, 5.0, 5.0]\n", walls), "s"));
  const auto& p = scene.system.particles;
  std::array<int, 2> held{};
  for (Slot i = 0; i < p.grains; ++i) {
    const auto& a = p.sphere[static_cast<std::size_t>(i)];
    const Slot shell = p.shell[static_cast<std::size_t>(i)];
    ASSERT_GE(shell, p.grains);
    EXPECT_LE(norm(a.x - p.sphere[static_cast<std::size_t>(shell)].x) + a.r, 5.0);
    ++held[static_cast<std::size_t>(shell - p.grains)];
  }
  EXPECT_GT(held[0], 0);
  EXPECT_GT(held[1], 0);
}

/// Where nothing is drawn a seed would have no effect; two of them would be one too many.
TEST(DrawnSizes, ASeedOfSingleParticlesNeedsSomethingToDraw) {
  const std::string grain =
      "kind = \"particles\"\n[material.a]\ndensity = 1.0\nE = 1.0\nnu = 0.2\n[[particle]]\nmaterial = \"a\"\nradius = "
      "1.0\nposition = [0.0, 0.0, 0.0]\n[time]\nstep = 0.1\nend = 0.2\n";
  const std::string drawn =
      grain +
      "[particles]\nmaterial = \"a\"\ncount = 2\nseed = 3\nlow = [2.0, 2.0, 2.0]\nhigh = [9.0, 9.0, 9.0]\nsizes = { "
      "form = \"power-law\", exponent = 3.0, radius_min = 0.5, radius_max = 1.0 }\n[[contact]]\npair = [\"a\", "
      "\"a\"]\nlaw = \"hertz-tsuji\"\nrestitution = 0.5\nmu = 0.5\n";
  const auto complaint = [](const std::string& text, const std::vector<std::string>& set,
                            const std::optional<std::uint64_t>& seed) -> std::string {
    try {
      (void)read_particles_scene<3>(Scene::parse(text, "s", set), seed);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(complaint(grain, {"seed=1"}, {}).find("nothing is drawn at random"), std::string::npos);
  EXPECT_NE(complaint(grain, {}, 1).find("--seed: nothing is drawn at random"), std::string::npos);
  EXPECT_NE(complaint(drawn, {"seed=1"}, {}).find("seed = 3: is given at the top level too"), std::string::npos);
  EXPECT_EQ(complaint(drawn, {}, {}), "");
}

TEST(DrawnSizes, OfPowdersAreKept) {
  TemporaryDirectory directory;
  PowderSpec spec;
  spec.sizes = two_sizes(2);
  h5::AtomicFile file(directory.file("powder.h5"));
  write_powder_spec(file.root().create("spec"), spec);
  file.commit();
  EXPECT_TRUE(read_powder_spec(h5::open_file(directory.file("powder.h5")).open("spec")) == spec);
}

TEST(DrawnSizes, OfShellsHaveTheVolumeOfBetaShells) {
  SoftParticleSpec spec = sized_spec();
  spec.beta = 0.3;  // so loose that all find a place
  double volume = 0.0;
  for (std::uint64_t k = 0; k < 20; ++k) {
    const ShellPacking packing = generate_shell_packing(spec, 1, k);
    // Without growth the largest is one of 8 mm at most; with it nothing is below the smallest.
    EXPECT_GE(*std::min_element(packing.radius.begin(), packing.radius.end()), 2e-3 / spec.shell_radius);
    volume += static_cast<double>(packing.radius.size()) * spec.sizes->mean_volume() / 20.0;
  }
  EXPECT_NEAR(volume / cube(spec.shell_radius), 0.3, 0.02);
  spec.placement = Placement::voids;
  EXPECT_GT(generate_shell_packing(spec, 1, 0).radius.size(), 10U);
}

TEST(DrawnSizes, OfSoftParticlesAreKeptInFilesAndCards) {
  const SoftParticleSpec spec = sized_spec();
  TemporaryDirectory directory;
  h5::AtomicFile file(directory.file("spec.h5"));
  write_spec(file.root(), spec);
  file.commit();
  const SoftParticleSpec stored = read_spec(h5::open_file(directory.file("spec.h5")));
  ASSERT_TRUE(stored.sizes.has_value());
  EXPECT_EQ(*stored.sizes, *spec.sizes);
  EXPECT_TRUE(packing_known(stored));
  const Scene card = Scene::parse(spec_text(spec), "card");
  const SoftParticleSpec read = card.read([](const SceneTable& t) { return read_spec_text(t, false); });
  ASSERT_TRUE(read.sizes.has_value());
  EXPECT_EQ(*read.sizes, *spec.sizes);
  EXPECT_EQ(read.polydispersity, 4.0);
}

TEST(DrawnSizes, AnotherDistributionIsAnotherSoftParticle) {
  const SoftParticleSpec spec = sized_spec();
  SoftParticleSpec other = spec;
  other.sizes = Grading::fuller(0.6, 2e-3, 8e-3);
  SoftParticleSpec power;
  power.polydispersity = 4.0;
  SoftParticleSpec smaller = spec;
  smaller.shell_radius = 0.1 * spec.shell_radius;
  smaller.sizes = Grading::fuller(0.5, 2e-4, 8e-4);
  EXPECT_TRUE(same_sizes(spec, smaller));
  for (const SoftParticleSpec& b : {other, power}) {
    EXPECT_FALSE(same_sizes(spec, b));
    EXPECT_EQ(differences(spec, b).obstacles.size(), 1U);
    EXPECT_EQ(differences(b, spec).obstacles.size(), 1U);
  }
  EXPECT_TRUE(differences(spec, smaller).obstacles.empty());
}

}  // namespace
