// The laws of soft particles with several contacts: geometry against quadrature, forces against the energy they come
// from, Newton's third law, the limits.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <numbers>
#include <string>

#include "common/contact/soft_multi_contact.h"
#include "common/dynamics/force_pass.h"
#include "common/neighbours/spatial_order.h"
#include "common/neighbours/verlet_list.h"

namespace softgrain {
namespace {

/// Share of a unit sphere that a sphere of curvature k covers at overlap x, by summing disks.
double covered(double x, double k) {
  constexpr int kDisks = 200000;
  const double other = k == 0.0 ? 0.0 : 1.0 / k;           // signed radius
  const double centre = k == 0.0 ? 0.0 : 1.0 + other - x;  // of the other sphere on the axis, from ours
  double sum = 0.0;
  for (int n = 0; n < kDisks; ++n) {
    const double z = -1.0 + 2.0 * (n + 0.5) / kDisks;
    const double own = 1.0 - z * z;  // squared radius of the disk
    double disk = 0.0;
    if (k == 0.0) {
      disk = z > 1.0 - x ? own : 0.0;
    } else {
      const double room = other * other - (z - centre) * (z - centre);
      disk = k > 0.0 ? std::clamp(room, 0.0, own) : own - std::clamp(room, 0.0, own);
    }
    sum += disk;
  }
  return 0.75 * sum * 2.0 / kDisks;
}

TEST(MultiContactForm, LensIsWhatTheOtherBodyCovers) {
  for (const double k : {0.0, 0.25, 1.0, 4.0, -0.1, -0.3})
    for (const double x : {0.05, 0.2, 0.4}) {
      const Lens l = lens(x, k);
      EXPECT_NEAR(l.volume, covered(x, k), 1e-6) << k << ", " << x;
      const double h = 1e-5;
      EXPECT_NEAR(l.slope, (lens(x + h, k).volume - lens(x - h, k).volume) / (2 * h), 1e-8) << k << ", " << x;
      EXPECT_NEAR(l.curvature, (lens(x + h, k).slope - lens(x - h, k).slope) / (2 * h), 1e-6) << k << ", " << x;
    }
}

TEST(MultiContactForm, CapDepthInvertsTheVolumeOfACap) {
  for (const double d : {1e-6, 1e-3, 0.03, 0.1, 0.5, 0.9999, 1.0, 1.0001, 1.6, 1.99})
    EXPECT_NEAR(cap_depth(lens(d, 0.0).volume), d, 1e-14 * d) << d;
  EXPECT_EQ(cap_depth(0.0), 0.0);
  for (const double beyond : {1.0, 1.5}) {  // a finite pressure, if one of no meaning
    EXPECT_NEAR(cap_depth(beyond), 2.0, 1e-7);
    EXPECT_LT(cap_depth(beyond), 2.0);
  }
}

const MultiContactPressure kPressure{0.8, 3.0, 0.09};

TEST(MultiContactForm, PressureIsThePairLawOverItsDisk) {
  for (const double d : {0.05, 0.0901, 0.15, 0.3}) {
    const Lens l = lens(d, 0.0);
    const double force = d > 0.09 ? 0.8 * (std::pow(d, 3.0) - std::pow(0.09, 3.0)) : 0.0;
    const auto p = kPressure.at(l.volume);
    EXPECT_NEAR(p.p * l.slope, force, 1e-14);
    if (d < 0.09) continue;
    const double h = 1e-7;
    EXPECT_NEAR(p.slope, (kPressure.at(l.volume + h).p - kPressure.at(l.volume - h).p) / (2 * h), 1e-6);
  }
}

const MultiContactCoupling kDirectional{0.6, 0.5, 0.1};

/// Energy over E R^3 of a body with plane contacts, by quadrature of the pressure.
double energy(const MultiContactForm& form, const std::vector<double>& depth, const std::vector<Vec3>& n) {
  MultiContactSum<3> sum;
  for (std::size_t c = 0; c < n.size(); ++c) sum.add(lens(depth[c], 0.0).volume, n[c]);
  const double s = form.equivalent_volume(sum);
  constexpr int kSteps = 20000;
  double e = 0.0;
  for (int k = 0; k < kSteps; ++k) e += form.pressure.at(s * (k + 0.5) / kSteps).p * s / kSteps;
  return e;
}

TEST(MultiContactForm, ForcesComeFromTheEnergy) {
  const MultiContactForm form{kPressure, kDirectional};
  const std::vector<Vec3> n{{{1, 0, 0}}, {{-1, 0, 0}}, {{0, 0.6, 0.8}}, {{0.48, -0.6, -0.64}}};
  const std::vector<double> depth{0.15, 0.2, 0.1, 0.05};
  MultiContactSum<3> sum;
  for (std::size_t c = 0; c < n.size(); ++c) sum.add(lens(depth[c], 0.0).volume, n[c]);
  sum.close(form.pressure, form.equivalent_volume(sum));
  for (std::size_t c = 0; c < n.size(); ++c) {
    const Lens l = lens(depth[c], 0.0);
    const double force = l.slope * sum.gain * form.felt(sum, l.volume, n[c]);
    auto more = depth;
    auto less = depth;
    more[c] += 1e-4;
    less[c] -= 1e-4;
    EXPECT_NEAR(force, (energy(form, more, n) - energy(form, less, n)) / 2e-4, 2e-4 * force) << c;
  }
}

LostVolumeTable soft_table() {
  LostVolumeTable t;
  t.log_weight = MonotoneCurve({std::log(0.25), 0.0, std::log(4.0)}, {std::log(0.4), std::log(0.6), std::log(0.9)});
  t.common_exponent = 1.3;
  return t;
}

template <class Law>
Law law_between(bool i_soft, bool j_soft) {
  Law law;
  law.form = {kPressure, kDirectional};
  if (i_soft && j_soft) law.partner = soft_table();
  law.modulus = 5e5;
  law.friction = 0.3;
  law.kt_ratio = 0.3;
  law.unloading = 1.5;
  law.i_is_soft = i_soft;
  law.j_is_soft = j_soft;
  return law;
}

/// Materials 0 solid (Hertz among themselves), 1 soft, 2 wall.
template <class Law>
System3 multi_contact(const std::vector<std::pair<double, bool>>& bodies, const std::vector<Vec3>& places) {
  System3 s;
  s.materials = {{"solid", 2500.0, 5e5, 0.3, false}, {"soft", 1700.0, 5e5, 0.3, false}, {"wall", 1.0, 5e5, 0.3, false}};
  s.laws = LawSet(3);
  s.laws.set(0, 0, hertz_law(HertzCoefficients::of(s.materials[0], s.materials[0], 0.0, 1.0), false));
  s.laws.set(1, 0, law_between<Law>(true, false), true);
  s.laws.set(0, 1, law_between<Law>(false, true), true);
  s.laws.set(1, 1, law_between<Law>(true, true));
  s.laws.set(1, 2, law_between<Law>(true, false));
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    NewBody<3> b;
    b.x = places[k];
    b.r = bodies[k].first;
    b.mass = 1.0;
    b.inertia = 1.0;
    b.material = bodies[k].second ? 1 : 0;
    add_grain(s.particles, b);
  }
  return s;
}

const std::vector<std::pair<double, bool>> kBodies{
    {0.01, true}, {0.008, false}, {0.012, true}, {0.004, true}, {0.009, true}};
const std::vector<Vec3> kPlaces{
    {{0, 0, 0}}, {{0.0165, 0, 0}}, {{0, -0.0195, 0}}, {{0.0, 0.0125, 0.0005}}, {{0.0, 0.0, 0.0165}}};

template <class Law>
class SoftMultiContactLaws : public ::testing::Test {};
using AllForms =
    ::testing::Types<SoftMultiContact<LawForm::pair, false>, SoftMultiContact<LawForm::isotropic, false>,
                     SoftMultiContact<LawForm::directional, false>, SoftMultiContact<LawForm::pair, true>,
                     SoftMultiContact<LawForm::isotropic, true>, SoftMultiContact<LawForm::directional, true>,
                     SoftMultiContact<LawForm::directional, false, true>>;
TYPED_TEST_SUITE(SoftMultiContactLaws, AllForms);

TYPED_TEST(SoftMultiContactLaws, ForcesAddUpToNothing) {
  System3 s = multi_contact<TypeParam>(kBodies, kPlaces);
  force_pass(s, 0.0);
  Vec3 sum{};
  double largest = 0.0;
  for (std::size_t k = 0; k < kBodies.size(); ++k) {
    sum += s.particles.force[k];
    largest = std::max(largest, norm(s.particles.force[k]));
  }
  EXPECT_GT(largest, 1e-3);
  EXPECT_LT(norm(sum), 1e-14 * largest);
  EXPECT_EQ(s.contacts.particle_sum.empty(), !TypeParam::traits.needs_particle_pass) << "the pair law keeps no sums";
}

TYPED_TEST(SoftMultiContactLaws, OneContactGivesThePairLaw) {
  for (const double ratio : {0.05, 0.0901, 0.12, 0.3})
    for (const bool wall : {true, false}) {
      System3 s = multi_contact<TypeParam>({{0.01, true}}, {Vec3{}});
      NewBody<3> plane;
      plane.material = 2;
      plane.x = {{0.0, 0.0, -0.01 * (1.0 - ratio)}};
      if (wall) add_plane(s.particles, plane, Vec3{{0, 0, 1}});
      force_pass(s, 0.0);
      const double expected =
          wall && ratio > 0.09 ? 5e5 * 1e-4 * 0.8 * (std::pow(ratio, 3.0) - std::pow(0.09, 3.0)) : 0.0;
      EXPECT_NEAR(s.particles.force[0][2], expected, 1e-10 * expected + 1e-15);
    }
}

TYPED_TEST(SoftMultiContactLaws, SwappingTheBodiesChangesNothing) {
  System3 a = multi_contact<TypeParam>({kBodies[0], kBodies[1]}, {kPlaces[0], kPlaces[1]});
  System3 b = multi_contact<TypeParam>({kBodies[1], kBodies[0]}, {kPlaces[1], kPlaces[0]});
  force_pass(a, 0.0);
  force_pass(b, 0.0);
  EXPECT_NEAR(a.particles.force[0][0], b.particles.force[1][0], 1e-14 * std::abs(a.particles.force[0][0]));
  EXPECT_LT(a.particles.force[0][0], 0.0);
}

/// The stiffness that relaxations rely on is the slope of the force.
TYPED_TEST(SoftMultiContactLaws, StiffnessIsTheSlopeOfTheForce) {
  const auto force_at = [](double shift, double* stiffness) {
    auto places = kPlaces;
    places[1][0] += shift;
    System3 s = multi_contact<TypeParam>(kBodies, places);
    BodyStiffness k;
    force_pass(s, 0.0, k);
    if (stiffness != nullptr) *stiffness = k.translation[1] / 1.3;  // kn + kt, kt = 0.3 kn
    return s.particles.force[1][0];
  };
  double stiffness = 0.0;
  force_at(0.0, &stiffness);
  const double slope = -(force_at(1e-7, nullptr) - force_at(-1e-7, nullptr)) / 2e-7;
  EXPECT_NEAR(stiffness, slope, 1e-4 * slope);
}

/// Loading, unloading and loading again: the same way back, less work returned than was put in, none with kUnloading
/// off.
TYPED_TEST(SoftMultiContactLaws, UnloadingReturnsLessWork) {
  System3 s = multi_contact<TypeParam>({{0.01, true}}, {Vec3{}});
  NewBody<3> plane;
  plane.material = 2;
  plane.x = {{0.0, 0.0, -0.01}};
  const Slot wall = add_plane(s.particles, plane, Vec3{{0, 0, 1}});
  const auto work = [&](double from, double to) {
    double sum = 0.0;
    constexpr int kSteps = 2000;
    for (int k = 0; k < kSteps; ++k) {
      const double ratio = from + (to - from) * (k + 0.5) / kSteps;
      s.particles.sphere[static_cast<std::size_t>(wall)].x[2] = -0.01 * (1.0 - ratio);
      force_pass(s, 0.0);
      s.contacts.commit();
      sum += s.particles.force[0][2] * 0.01 * (to - from) / kSteps;
    }
    return sum;
  };
  const double in = work(0.01, 0.25);
  const double out = -work(0.25, 0.01);
  const double again = work(0.01, 0.25);
  if (TypeParam::traits.memory_in_sums) {
    EXPECT_NEAR(out, in / 1.5, 2e-3 * in);
    EXPECT_NEAR(again, out, 2e-3 * in);
  } else {
    EXPECT_NEAR(out, in, 1e-6 * in);
  }
}

/// A lattice of soft and solid bodies after one pass, as it was added or in spatial order, where threads go along
/// stretches of the list.
template <class Law>
std::pair<System3, BodyStiffness> large_multi_contact(int threads, bool ordered) {
  constexpr int kEdge = 17;
  std::vector<std::pair<double, bool>> bodies;
  std::vector<Vec3> places;
  for (int k = 0; k < kEdge * kEdge * kEdge; ++k) {
    bodies.push_back({0.01, k % 3 != 0});
    places.push_back(Vec3{{double(k % kEdge), double(k / kEdge % kEdge), double(k / (kEdge * kEdge))}} * 0.0185);
  }
  const int before = omp_get_max_threads();
  omp_set_num_threads(threads);
  std::pair<System3, BodyStiffness> out{multi_contact<Law>(bodies, places), {}};
  if (ordered) reorder_grains(out.first, spatial_order(out.first));
  force_pass(out.first, 0.0, out.second);
  omp_set_num_threads(before);
  return out;
}

TYPED_TEST(SoftMultiContactLaws, ThreadsChangeNoBit) {
  for (const bool ordered : {false, true}) {
    const auto [one, stiffness] = large_multi_contact<TypeParam>(1, ordered);
    ASSERT_GT(one.contacts.size(), 8000) << "too small for the parallel path";
    EXPECT_NE(one.particles.force[0], (Stored<3>{}));
    EXPECT_GT(stiffness.mean_force(), 0.0);
    for (const int threads : {2, 3}) {
      const auto [many, also] = large_multi_contact<TypeParam>(threads, ordered);
      EXPECT_EQ(one.particles.force, many.particles.force) << threads << ordered;
      EXPECT_EQ(one.particles.torque, many.particles.torque) << threads << ordered;
      EXPECT_EQ(stiffness.translation, also.translation) << threads << ordered;
      EXPECT_EQ(stiffness.rotation, also.rotation) << threads << ordered;
      EXPECT_EQ(stiffness.force, also.force) << threads << ordered;
      EXPECT_EQ(stiffness.contacts, also.contacts) << threads << ordered;
    }
  }
}

/// Bag and directional law against the plain double sum over pairs of contacts.
TEST(SoftMultiContact, SumsOverContactsAreTheSumsOverPairs) {
  const std::vector<Vec3> n{{{1, 0, 0}}, {{-0.6, 0.8, 0}}, {{0, 0.6, -0.8}}, {{0.48, -0.6, 0.64}}};
  const std::vector<double> nu{0.01, 0.02, 0.005, 0.03};
  for (const MultiContactCoupling& m : {MultiContactCoupling{}, kDirectional}) {
    MultiContactSum<3> sum;
    for (std::size_t c = 0; c < n.size(); ++c) sum.add(nu[c], n[c]);
    double s2 = 0.0;
    for (std::size_t c = 0; c < n.size(); ++c) {
      double felt = 0.0;
      for (std::size_t d = 0; d < n.size(); ++d) felt += (c == d ? 1.0 : m.at(dot(n[c], n[d]))) * nu[d];
      s2 += nu[c] * felt;
      EXPECT_NEAR((MultiContactForm{kPressure, m}.felt(sum, nu[c], n[c])), felt, 1e-15);
    }
    EXPECT_NEAR((MultiContactForm{kPressure, m}.equivalent_volume(sum)), std::sqrt(s2), 1e-15);
  }
}

}  // namespace
}  // namespace softgrain
