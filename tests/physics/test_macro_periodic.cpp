// The periodic cell of macro scenes: stress from the forces of a pass against sums over contacts and against the
// energy, bodies and shells that lie across faces, threads, preparations.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>

#include "common/contact/make_laws.h"
#include "common/dynamics/contact_watch.h"
#include "common/dynamics/force_pass.h"
#include "macrosim/body_contacts.h"
#include "macrosim/compression.h"
#include "macrosim/constructed_packing.h"
#include "macrosim/preparation.h"
#include "macrosim/pressed_box.h"
#include "tests/support/multi_contact.h"

namespace softgrain {
namespace {

MacroSpec periodic_spec(std::int64_t bodies = 60) {
  MacroSpec spec;
  spec.boundary = Boundary::periodic;
  spec.bodies = bodies;
  spec.soft_share = 0.3;
  return spec;
}

/// All bodies moved by a vector, home into the cell.
MacroPacking moved(const MacroPacking& packing, const Vec3& by) {
  MacroPacking out = packing;
  const Vec3 size = packing.size();
  for (MacroBody& b : out.bodies)
    for (int k = 0; k < 3; ++k) {
      const double x = b.x[k] - packing.low[k] + by[k];
      b.x[k] = packing.low[k] + x - size[k] * std::floor(x / size[k]);
    }
  return out;
}

double largest_force(const System3& s) {
  double largest = 0.0;
  for (const auto& f : s.particles.force) largest = std::max(largest, norm(Vec3(f)));
  return largest;
}

/// A squeezed state that is not at rest, so that no agreement comes from equilibrium.
MacroSystem squeezed_twin(const MacroSpec& spec, const MacroPacking& packing) {
  MacroSystem macro = make_shelled_system(spec, packing, {generate_shell_packing(test::coarse_spec(), 1, 0)}, 1, 0);
  strain_box(macro.system, macro.box, {{0.04, 0.05, 0.06}});
  force_pass(macro.system, 0.0, History::none);
  return macro;
}

class PeriodicTwin : public testing::Test {
 protected:
  const MacroSpec spec_ = periodic_spec();
  const MacroPacking packing_ = make_macro_packing(spec_, 2, 0);
};

TEST_F(PeriodicTwin, VirialOfForcesIsThatOfContacts) {
  MacroSystem macro = squeezed_twin(spec_, packing_);
  const Vec3 size = box_high(macro.system, macro.box);
  const Vec3 by_contacts = contact_stress(macro.system, macro.box) * (size[0] * size[1] * size[2]);
  const Vec3 by_forces = ContactVirial<3>().of(macro.system);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(by_forces[k], by_contacts[k], 1e-11 * by_contacts[k]);
  EXPECT_GT(by_contacts[2], 1.2 * by_contacts[0]);
}

/// Laws with rolling resistance put down one thing more of each contact.
TEST_F(PeriodicTwin, VirialOfForcesIsThatOfContactsWhereSoftParticlesResistRolling) {
  const LawTable table = load_law_table(SOFTGRAIN_SOURCE_DIR "/results/law_table/law_table.toml");
  ASSERT_TRUE(main_entry(table).rolls());
  MultiContactChoices choices;
  choices.modulus = spec_.youngs_modulus;
  const MultiContactLaws laws = make_multi_contact_laws(main_entry(table), choices);
  MacroSystem macro =
      make_law_system(spec_, packing_, {laws.soft_solid, laws.solid_soft, laws.soft_plane, laws.soft_soft}, 1.0);
  strain_box(macro.system, macro.box, {{0.10, 0.12, 0.14}});
  force_pass(macro.system, 0.0, History::none);
  const Vec3 size = box_high(macro.system, macro.box);
  const Vec3 by_contacts = contact_stress(macro.system, macro.box) * (size[0] * size[1] * size[2]);
  const Vec3 by_forces = ContactVirial<3>().of(macro.system);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(by_forces[k], by_contacts[k], 1e-11 * by_contacts[k]);
  EXPECT_GT(by_contacts[2], 0.0);
}

/// No face is a place of its own: contents, shells and all forces are those of the scene elsewhere in the cell.
TEST_F(PeriodicTwin, NothingChangesWhereFacesLieElsewhere) {
  const Vec3 size = packing_.size();
  const MacroSystem here = squeezed_twin(spec_, packing_);
  for (const Vec3& by : {Vec3{{0.37 * size[0], 0.0, 0.0}}, Vec3{{0.5 * size[0], 0.21 * size[1], 0.83 * size[2]}}}) {
    const MacroSystem there = squeezed_twin(spec_, moved(packing_, by));
    ASSERT_EQ(here.system.particles.size(), there.system.particles.size());
    const double largest = largest_force(here.system);
    for (std::size_t u = 0; u < here.system.particles.force.size(); ++u)
      EXPECT_LT(norm(Vec3(here.system.particles.force[u]) - Vec3(there.system.particles.force[u])), 1e-9 * largest)
          << u;
    const Vec3 a = contact_stress(here.system, here.box);
    const Vec3 b = contact_stress(there.system, there.box);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], 1e-10 * a[k]);
    const auto contacts_here = body_contacts(here, contact_records(here.system));
    const auto contacts_there = body_contacts(there, contact_records(there.system));
    ASSERT_EQ(contacts_here.size(), contacts_there.size());
    for (std::size_t k = 0; k < contacts_here.size(); ++k)
      EXPECT_LT(norm(contacts_here[k].branch - contacts_there[k].branch), 1e-12) << k;
  }
}

/// sigma_k V = -dU/de_k of frictionless bodies that move with the cell, which leans by this shear strain.
void expect_stress_to_be_the_work_of_strain(double shear) {
  MacroSpec spec = periodic_spec();
  spec.friction = 0.0;
  spec.soft_share = 0.0;
  const MacroPacking packing = make_macro_packing(spec, 4, 0);
  const auto squeezed = [&] {
    MacroSystem macro = make_law_system(spec, packing, pair_soft_laws({}, {}, 0.0), 1.0);
    strain_box(macro.system, macro.box, {{0.03, 0.02, 0.05}});
    shear_cell(macro.system, shear);
    return macro;
  };
  const auto energy_at = [&](const Vec3& strain) {
    MacroSystem macro = squeezed();
    strain_box(macro.system, macro.box, strain);
    return watch_contacts(macro.system).stored;
  };
  MacroSystem macro = squeezed();
  const Vec3 size = box_high(macro.system, macro.box);
  const Vec3 stress = contact_stress(macro.system, macro.box);
  for (int k = 0; k < 3; ++k) {
    constexpr double kStep = 1e-5;
    Vec3 strain{};
    strain[k] = kStep;
    const double work = (energy_at(strain) - energy_at(-strain)) / (2.0 * kStep);
    EXPECT_NEAR(work, stress[k] * size[0] * size[1] * size[2], 1e-6 * work) << k << ", shear " << shear;
  }
}

TEST(PeriodicCell, StressIsTheWorkOfStrain) { expect_stress_to_be_the_work_of_strain(0.0); }

TEST(PeriodicCell, StressOfATiltedCellIsTheWorkOfStrain) {
  for (const double shear : {0.15, -0.3}) expect_stress_to_be_the_work_of_strain(shear);
}

/// Coordinates in units of the edges stay, and the lean with them: a strain of x adds no shear.
TEST(PeriodicCell, StrainOfATiltedCellIsAffine) {
  MacroSpec spec = periodic_spec();
  spec.soft_share = 0.0;
  MacroSystem macro = make_law_system(spec, make_macro_packing(spec, 6, 0), pair_soft_laws({}, {}, 0.0), 1.0);
  System3& s = macro.system;
  shear_cell(s, 0.25);
  const Cell<3> before = s.cell;
  std::vector<Vec3> places;
  for (const Sphere<3>& sphere : s.particles.sphere) places.push_back(before.fractional(sphere.x));
  const Vec3 strain{{0.05, 0.02, -0.03}};
  strain_box(s, macro.box, strain);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      EXPECT_DOUBLE_EQ(s.cell.edges[r][c], (1.0 - strain[r]) * before.edges[r][c]) << r << ", " << c;
  for (std::size_t u = 0; u < places.size(); ++u) {
    const Vec3 now = s.cell.fractional(s.particles.sphere[u].x);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(std::remainder(now[k] - places[u][k], 1.0), 0.0, 1e-12) << u << ", " << k;
  }
}

/// Springs of contacts across faces follow the strain as those inside do.
TEST(PeriodicCell, AffineStrainLoadsAllSprings) {
  MacroSpec spec = periodic_spec();
  spec.soft_share = 0.0;
  const MacroPacking packing = make_macro_packing(spec, 5, 0);
  const Vec3 size = packing.size();
  const auto strained = [&](const MacroPacking& p) {
    MacroSystem macro = make_law_system(spec, p, pair_soft_laws({}, {}, 0.0), 1.0);
    strain_box(macro.system, macro.box, {{0.02, 0.02, 0.02}});
    for (int k = 0; k < 3; ++k) strain_box(macro.system, macro.box, {{-0.002, 0.0, 0.002}});
    force_pass(macro.system, 0.0, History::none);
    return macro;
  };
  const MacroSystem a = strained(packing);
  const MacroSystem b = strained(moved(packing, size * 0.5));
  const auto tangential = [](const MacroSystem& m) {
    double sum = 0.0;
    for (const auto& c : contact_records(m.system)) sum += norm(c.tangential_force);
    return sum;
  };
  EXPECT_GT(tangential(a), 0.0);
  EXPECT_NEAR(tangential(a), tangential(b), 1e-9 * tangential(a));
}

/// Bodies without friction under a pressure: the same bits on one and two threads, of a list that both share.
TEST(PeriodicCell, PressingGivesTheSameBitsOnAnyThreads) {
  MacroSpec spec = periodic_spec(1500);
  spec.soft_share = 0.0;
  const int threads = omp_get_max_threads();
  std::vector<Vec3> places[2];
  const MacroPacking loose = place_loosely(drawn_bodies(spec, 1, 0), 1, 0, 0.35, Boundary::periodic);
  for (const int n : {1, 2}) {
    omp_set_num_threads(n);
    HardBodies hard(spec, loose);
    strain_box(hard.system, hard.box, {{0.22, 0.22, 0.22}});
    DampedOptions options;
    options.max_passes = 150;
    PressedBox pressed(hard.box, {.by_stress = {true, true, true}, .stress = {{5e3, 5e3, 5e3}}});
    DampedRelaxation<3>(options).relax(hard.system, pressed);
    ASSERT_GT(hard.system.contacts.size(), 8000U);
    for (const Sphere<3>& s : hard.system.particles.sphere) places[n - 1].push_back(s.x);
    places[n - 1].push_back(hard.size());
  }
  omp_set_num_threads(threads);
  EXPECT_EQ(places[0], places[1]);
}

/// Every preparation ends at the pressure, without walls, in a packing as dense as such ones are; nobody overlaps
/// across a face more than inside.
TEST(PeriodicCell, EveryPreparationJams) {
  for (const Preparation preparation :
       {Preparation::frictionless, Preparation::fast, Preparation::slow, Preparation::dense}) {
    MacroSpec spec = periodic_spec(150);
    spec.preparation = preparation;
    spec.protocol = protocol_of(preparation, spec.friction);
    if (preparation == Preparation::slow) spec.protocol.inertial_number = 0.02;
    const MacroPacking packing = make_macro_packing(spec, 3, 0);
    EXPECT_EQ(packing.low, Vec3{});
    EXPECT_GT(packing.solid_fraction(), preparation == Preparation::fast ? 0.54 : 0.56) << to_string(preparation);
    EXPECT_LT(packing.solid_fraction(), 0.70) << to_string(preparation);
    HardBodies hard(spec, packing);
    force_pass(hard.system, 0.0, History::none);
    EXPECT_NEAR(hard.pressure() / spec.youngs_modulus, spec.start_pressure, 0.03 * spec.start_pressure)
        << to_string(preparation);
    for (const auto& c : contact_records(hard.system))
      EXPECT_LT(c.overlap, 0.02 * hard.system.particles.sphere[static_cast<std::size_t>(c.i)].r);
  }
}

/// Soft particles in the voids of a cell: the share is met, nobody overlaps across a face.
TEST(PeriodicCell, VoidsAreFilledAcrossFaces) {
  MacroSpec spec = periodic_spec(80);
  spec.construction = Construction::voids;
  spec.soft_share = 0.3;
  spec.solid_polydispersity = 1.5;
  spec.soft_polydispersity = 3.0;
  const MacroPacking packing = make_packing(spec, 1, 0);
  EXPECT_NEAR(packing.soft_volume_share(), 0.3, 0.02);
  EXPECT_GT(packing.soft_count(), 20);
  HardBodies hard(spec, packing);
  force_pass(hard.system, 0.0, History::none);
  EXPECT_NEAR(hard.pressure() / spec.youngs_modulus, spec.start_pressure, 0.03 * spec.start_pressure);
  for (const auto& c : contact_records(hard.system))
    EXPECT_LT(c.overlap, 0.03 * hard.system.particles.sphere[static_cast<std::size_t>(c.i)].r);
}

/// Too few bodies for a cell that must be longer than two of the largest: said before any work.
TEST(PeriodicCell, TooFewBodiesAreRefused) {
  MacroSpec spec = periodic_spec(6);
  EXPECT_THROW((void)make_macro_packing(spec, 1, 0), InputError);
}

}  // namespace
}  // namespace softgrain
