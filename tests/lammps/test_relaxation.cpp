// A macro scene strained and relaxed by both engines: the same passes, the same state.
#include <gtest/gtest.h>

#include "common/dynamics/contact_watch.h"
#include "common/dynamics/damped_relaxation.h"
#include "common/dynamics/residual.h"
#include "macrosim/body_contacts.h"
#include "tests/lammps/in_process.h"
#include "tests/lammps/macro_scene.h"
#include "tests/support/temporary_directory.h"
// After the headers of LAMMPS.
#include "compute.h"
#include "domain.h"
#include "fix.h"
#include "modify.h"

namespace softgrain::test {
namespace {

class Relaxation : public ::testing::TestWithParam<bool> {
 protected:
  Relaxation() : scene(macro_scene(90, GetParam())), ours(scene.system()) {
    options.tolerance = scene.spec.tolerance;
    options.max_passes = scene.spec.max_passes;
    options.force_floor = scene.spec.force_floor * scene.spec.youngs_modulus * 0.016 * 0.016;
    write_scene(scene, directory.path());
    lammps("shell cd " + directory.path());
    lammps("variable restart equal 0");
    lammps("include head.in");
  }

  void strain(double by) {
    strain_box(ours.system, ours.box, {{0.0, 0.0, by}});
    lammps(fmt::format("change_box all z scale {:.17g} remap", 1.0 - by));
  }

  /// Both engines; ours tells.
  RelaxationResult relax(std::int64_t passes) {
    options.max_passes = passes;
    lammps(fmt::format("fix_modify relax max_passes {}", passes));
    lammps("run 20000");
    return DampedRelaxation<3>(options).relax(ours.system);
  }

  /// Largest distance between the places of a body in both engines, in radii of the smallest.
  double difference() {
    auto& atoms = lammps.atoms();
    double worst = 0.0;
    double smallest = 1.0;
    for (int i = 0; i < atoms.nlocal; ++i) {
      const auto& b = ours.system.particles.sphere[static_cast<std::size_t>(atoms.tag[i] - 1)];
      worst = std::max(worst, norm(Vec3{{atoms.x[i][0], atoms.x[i][1], atoms.x[i][2]}} - b.x));
      smallest = std::min(smallest, b.r);
    }
    return worst / smallest;
  }

  [[nodiscard]] double fix_value(const char* id, int k) {
    auto* modify = lammps.lammps().modify;
    return modify->fix[modify->find_fix(id)]->compute_vector(k);
  }
  [[nodiscard]] const double* contacts() {
    auto* modify = lammps.lammps().modify;
    auto* compute = modify->compute[modify->find_compute("contacts")];
    compute->compute_vector();
    return compute->vector;
  }

  TemporaryDirectory directory;
  MacroScene scene;
  MacroSystem ours;
  DampedOptions options;
  InProcess lammps;
};

TEST_P(Relaxation, ItsVectorEndsWithTheStress) {
  auto* modify = lammps.lammps().modify;
  EXPECT_EQ(modify->fix[modify->find_fix("relax")]->size_vector, 6 + 3) << "six numbers of relaxations, three stresses";
}

TEST_P(Relaxation, OfTheFirstIncrementTakesTheSamePassesToTheSamePlace) {
  strain(0.01);
  const RelaxationResult rest = relax(20000);
  EXPECT_EQ(rest.end, RelaxationEnd::converged);
  EXPECT_EQ(fix_value("relax", 2), 1.0);
  EXPECT_EQ(fix_value("relax", 0), static_cast<double>(rest.passes));
  EXPECT_LT(difference(), 1e-9);
  EXPECT_NEAR(fix_value("relax", 1), rest.residual, 1e-6 * rest.residual);
  const double top = ours.system.particles.force[static_cast<std::size_t>(ours.box.plane[5])][2];
  EXPECT_NEAR(fix_value("walls", 5), top, 1e-6 * top);
}

// What preparations of many bodies ask for: a few that are not at rest, limits on single ones, none too soft.
TEST_P(Relaxation, WithTheLimitsOfPreparationsGoesTheSameWay) {
  const double bodies = lammps.atoms().nlocal;
  const double all = ours.system.particles.size();  // ours counts walls where it takes the mean move
  options.unbalanced_fraction = 0.04;
  options.max_lead = 2.0;
  options.least_stiffness = 0.05 * scene.spec.youngs_modulus;
  strain(0.01);
  lammps(fmt::format("fix_modify relax unbalanced_fraction 0.04 max_displacement_ratio {:.17g} least_stiffness {:.17g}",
                     options.max_lead * std::sqrt(bodies / all), options.least_stiffness));
  const RelaxationResult rest = relax(20000);
  EXPECT_EQ(fix_value("relax", 0), static_cast<double>(rest.passes));
  EXPECT_LT(difference(), 1e-8);
  EXPECT_NEAR(fix_value("relax", 1), rest.residual, 1e-5 * rest.residual);
}

// Springs, memories and the box go on from one increment to the next. Small differences then grow a hundredfold every
// twenty passes, so that only the beginning is the same.
TEST_P(Relaxation, OfTheNextIncrementBeginsTheSame) {
  strain(0.01);
  (void)relax(20000);
  strain(0.01);
  const RelaxationResult rest = relax(30);
  EXPECT_EQ(fix_value("relax", 0), 30.0);
  EXPECT_EQ(rest.passes, 30);
  EXPECT_LT(difference(), 1e-9);
  EXPECT_NEAR(fix_value("relax", 1), rest.residual, 1e-6 * rest.residual);
}

TEST_P(Relaxation, ContactsAreCountedAsWeCount) {
  strain(0.06);
  (void)relax(20);
  const double* c = contacts();
  const auto records = contact_records(ours.system);
  const Residual r = residual(ours.system);
  const ContactWatch<3> watch = watch_contacts(ours.system);
  EXPECT_EQ(c[0], static_cast<double>(records.size()));
  EXPECT_NEAR(c[2], r.mean_contact * static_cast<double>(records.size()), 1e-6 * c[2]);
  EXPECT_NEAR(c[3], fabric_anisotropy(ours, records), 1e-7);
  const auto* domain = lammps.lammps().domain;
  EXPECT_NEAR(c[6] / (domain->xprd * domain->yprd * domain->zprd), contact_stress(ours.system, ours.box)[2],
              1e-6 * contact_stress(ours.system, ours.box)[2]);
  EXPECT_NEAR(c[10], watch.overlap, 1e-7);
  EXPECT_EQ(c[11], static_cast<double>(watch.laws.evaluations));
  EXPECT_GT(watch.laws.evaluations, 0);
  EXPECT_EQ(c[16], 0.0);
}

INSTANTIATE_TEST_SUITE_P(WithAndWithoutUnloading, Relaxation, ::testing::Bool());

}  // namespace
}  // namespace softgrain::test
