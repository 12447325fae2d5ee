// The vectorised contact loop against the scalar one: the same bits, whatever the cell and the history, for every law
// without x^y; with it the same to rounding.
#include "common/dynamics/block_loop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/contact/soft_contact.h"
#include "common/core/particles.h"
#include "common/core/random.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/pair_loop.h"
#include "common/dynamics/parallel_pass.h"
#include "common/neighbours/verlet_list.h"

namespace {

using namespace softgrain;

/// Adds every contact to its bodies, in list order: the slow, obvious way.
template <int D>
struct PlainSink {
  Particles<D>& p;
  BodyStiffness& stiffness;
  Vec<D>& virial;

  void apart(std::size_t) {}
  template <LawTraits kLaw>
  void touch(std::size_t, std::size_t i, std::size_t j, const ContactGeometry<D>& g, const ContactResponse<D>& r) {
    Vec<D> f = g.normal * r.normal_force;
    if constexpr (kLaw.has_tangential) {
      f = g.normal * r.normal_force + r.tangential_force;
      const Rot<D> moment = cross(g.normal, r.tangential_force);
      p.torque[i] -= moment * g.arm_i;
      p.torque[j] -= moment * g.arm_j;
      p.torque[i] += r.rolling_moment;
      p.torque[j] -= r.rolling_moment;
    }
    p.force[i] += f;
    p.force[j] -= f;
    const double k = r.normal_stiffness + r.tangential_stiffness;
    stiffness.translation[i] += k;
    stiffness.translation[j] += k;
    double roll = 0.0;
    if constexpr (has_roll_history<D>(kLaw)) roll = r.rolling_stiffness;
    stiffness.rotation[i] += r.tangential_stiffness * g.arm_i * g.arm_i + roll;
    stiffness.rotation[j] += r.tangential_stiffness * g.arm_j * g.arm_j + roll;
    stiffness.force[i] += std::abs(r.normal_force);
    stiffness.contacts[i] += r.normal_force != 0.0 ? 1 : 0;
    for (int a = 0; a < D; ++a) virial[a] += f[a] * g.branch[a];
  }
};

template <int D>
void clear(Particles<D>& p) {
  std::fill(p.force.begin(), p.force.end(), Stored<D>{});
  std::fill(p.torque.begin(), p.torque.end(), StoredRot<D>{});
}

/// What a pass adds up beside forces.
template <int D>
struct Sums {
  BodyStiffness stiffness;
  Vec<D> virial{};

  explicit Sums(const System<D>& s) { stiffness.clear(s.particles.sphere.size()); }
};

template <int D>
Sums<D> scalar_pass(System<D>& s, double dt, History history) {
  clear(s.particles);
  Sums<D> sums(s);
  PlainSink<D> sink{s.particles, sums.stiffness, sums.virial};
  if (history == History::next) s.contacts.make_next();
  std::fill(s.contacts.particle_sum.begin(), s.contacts.particle_sum.end(), MultiContactSum<D>{});
  const auto over_sections = [&](auto&& work) {
    for (const ContactSection& section : s.contacts.sections)
      with_pairs<D>(
          s, section,
          [&](const auto& law, auto& source) {
            work(law, source, PairRange{section.begin, section.end});
          },
          dt, history);
  };
  over_sections([](const auto& law, auto& source, const PairRange& range) { add_shares(source, law, range); });
  over_sections([&]<class Law>(const Law& law, auto&, const PairRange&) {
    if constexpr (Law::traits.needs_particle_pass)
      for (MultiContactSum<D>& sum : s.contacts.particle_sum)
        if (sum.square > 0.0) law.finish(sum);
  });
  over_sections([&](const auto& law, auto& source, const PairRange& range) { run_section(source, law, range, sink); });
  return sums;
}

template <int D>
Sums<D> fast_pass(System<D>& s, double dt, History history) {
  clear(s.particles);
  Sums<D> sums(s);
  if (history == History::next) s.contacts.make_next();
  particle_pass(s);
  Vec<D> old;
  old[0] = old[D - 1] = 1.0;
  std::vector<Vec<D>> virials(s.contacts.i.size(), old);
  block_loop<D>(s, {.dt = dt, .history = history, .stiffness = &sums.stiffness, .virials = virials.data()});
  for (const Vec<D>& of_pair : virials) sums.virial += of_pair;
  return sums;
}

/// Numbers of a kind, as they are compared.
using Group = std::vector<double>;

template <class Vectors>
Group group_of(const Vectors& vectors, int many) {
  Group out;
  for (const auto& v : vectors)
    for (int a = 0; a < many; ++a) out.push_back(v[a]);
  return out;
}

template <int D>
std::vector<Group> groups_of(const Sums<D>& s) {
  return {s.stiffness.translation, s.stiffness.rotation, s.stiffness.force,
          Group(s.stiffness.contacts.begin(), s.stiffness.contacts.end()), group_of(std::vector{s.virial}, D)};
}

template <int D>
std::vector<Group> groups_of(const System<D>& s) {
  return {group_of(s.particles.force, D), group_of(s.particles.torque, kRot<D>), group_of(s.contacts.spring, D),
          s.contacts.memory, group_of(s.contacts.roll, D)};
}

/// The same bits; or, with x^y in the law, which lanes take from other functions than single numbers
/// (common/core/lanes.h), the same to a few units in the last place of the largest number of a kind.
template <class Thing>
void expect_same(const Thing& a, const Thing& b, bool powers) {
  const std::vector<Group> left = groups_of(a), right = groups_of(b);
  for (std::size_t g = 0; g < left.size(); ++g) {
    ASSERT_EQ(left[g].size(), right[g].size()) << "kind " << g;
    double largest = 0.0;
    for (const double x : left[g]) largest = std::max(largest, std::abs(x));
    for (std::size_t k = 0; k < left[g].size(); ++k) {
      if (powers)
        ASSERT_NEAR(left[g][k], right[g][k], 1e-12 * largest) << "kind " << g << ", number " << k;
      else
        ASSERT_EQ(left[g][k], right[g][k]) << "kind " << g << ", number " << k;
    }
  }
}

bool has_powers(const AnyLaw& law) { return traits_of(law).is_fitted || traits_of(law).is_multi_contact; }

struct Case {
  AnyLaw law;
  bool periodic = true;
  double shear = 0.0;
};

Material stuff() {
  Material m;
  m.density = 2500.0;
  m.youngs_modulus = 1e6;
  m.poisson_ratio = 0.3;
  return m;
}

AnyLaw solid(bool friction, bool damped, bool rescaled) {
  const Material m = stuff();
  return hertz_law(HertzCoefficients::of(m, m, friction ? 0.4 : 0.0, damped ? 0.6 : 1.0), rescaled);
}

AnyLaw rolling(bool damped, bool rescaled) {
  const Material m = stuff();
  return hertz_law(HertzCoefficients::of(m, m, 0.4, damped ? 0.6 : 1.0, {0.01, 0.8, 0.7}), rescaled);
}

SoftContact soft(bool both, double damping) {
  SoftContact law;
  law.delta = 0.15;
  law.normal = threshold_term(0.6, 2.2, law.delta);
  law.tangential = threshold_term(1.5, 1.5, law.delta);
  law.modulus = 1e6;
  law.friction = 0.3;
  law.damping = damping;
  law.partner_is_soft = both;
  law.range = {0.5, Extrapolation::clamp};
  return law;
}

template <LawForm kLawForm, bool kUnloading, bool kRolling = false>
AnyLaw counting(bool both) {
  SoftMultiContact<kLawForm, kUnloading, kRolling> law;
  law.form.pressure = {0.6, 2.2, 0.1};
  law.form.coupling = {0.6, 0.5, 0.1};
  law.partner.log_weight = MonotoneCurve({-1.4, 0.0, 1.4}, {-0.5, -0.4, -0.3});
  law.partner.common_exponent = 1.2;
  law.modulus = 1e6;
  law.friction = 0.3;
  law.kt_ratio = 0.3;
  law.unloading = 1.5;
  law.rolling = 0.02;
  law.rolling_friction = 1e-3;
  law.j_is_soft = both;
  return law;
}

template <class Law>
AnyLaw disk(double adhesion) {
  Law law;
  law.normal = 1e6;
  law.tangential = 5e5;
  law.friction = 0.3;
  law.damping = 0.2;
  law.adhesion = adhesion;
  law.range = 0.05;
  law.rolling = 1e4;
  law.rolling_limit = 0.02;
  return law;
}

std::vector<AnyLaw> laws() {
  std::vector<AnyLaw> out;
  for (const bool friction : {false, true})
    for (const bool damped : {false, true})
      for (const bool rescaled : {false, true})
        if (friction || !rescaled) out.push_back(solid(friction, damped, rescaled));
  out.push_back(LinearSpring{1e6, 5e5, 0.3, 0.2});
  for (const bool both : {false, true}) {
    for (const double damping : {0.0, 0.3}) {
      out.push_back(soft(both, damping));
      out.push_back(SoftUnloading{soft(both, damping), {0.2, 2.5}});
    }
    out.push_back(counting<LawForm::pair, false>(both));
    out.push_back(counting<LawForm::pair, true>(both));
    out.push_back(counting<LawForm::isotropic, false>(both));
    out.push_back(counting<LawForm::isotropic, true>(both));
    out.push_back(counting<LawForm::directional, false>(both));
    out.push_back(counting<LawForm::directional, true>(both));
    out.push_back(counting<LawForm::pair, false, true>(both));
    out.push_back(counting<LawForm::isotropic, true, true>(both));
    out.push_back(counting<LawForm::directional, false, true>(both));
    out.push_back(counting<LawForm::directional, true, true>(both));
  }
  for (const double adhesion : {0.0, 2e4}) {
    out.push_back(disk<CohesiveDisk<false, false>>(adhesion));
    out.push_back(disk<CohesiveDisk<true, false>>(adhesion));
    out.push_back(disk<CohesiveDisk<true, true>>(adhesion));
  }
  for (const bool damped : {false, true})
    for (const bool rescaled : {false, true}) out.push_back(rolling(damped, rescaled));
  out.push_back(LinearSpringLaw<true>{1e6, 5e5, 0.3, 0.2, {0.01, 0.8, 0.7}});
  return out;
}

/// Overlapping grains of many sizes with random motion; some pairs touch, some are merely near. Without a periodic cell
/// they are in a shell and between planes.
template <int D>
System<D> crowd(const Case& c, int grains) {
  System<D> s;
  s.materials = {stuff()};
  s.laws = LawSet(1);
  s.laws.set(0, 0, c.law);
  RandomStream random(7, RandomPurpose::test, 0);
  const double side = 10.0 * std::pow(grains / 400.0, 1.0 / D);
  Vec<D> size;
  Vec<D> middle;
  std::array<bool, D> periodic{};
  for (int a = 0; a < D; ++a) {
    size[a] = side;
    middle[a] = 0.5 * side;
    periodic[static_cast<std::size_t>(a)] = c.periodic;
  }
  for (int k = 0; k < grains; ++k) {
    NewBody<D> body;
    for (int a = 0; a < D; ++a) body.x[a] = side * random.uniform();
    body.r = 0.3 + 0.5 * random.uniform();
    body.mass = 3.0;
    body.inertia = 0.5;
    for (int a = 0; a < D; ++a) body.velocity[a] = random.uniform() - 0.5;
    for (double& w : body.spin.v) w = random.uniform() - 0.5;
    body.shell = c.periodic ? -1 : grains;
    add_grain(s.particles, body);
  }
  if (!c.periodic) {
    NewBody<D> shell{middle, 0.5 * std::sqrt(D) * side, 100.0, 10.0};
    shell.velocity = middle * 0.01;
    shell.spin[0] = 0.2;
    add_shell(s.particles, shell);
    for (int a = 0; a < 2; ++a) {
      NewBody<D> plane;
      plane.velocity[1] = 0.1;
      Vec<D> normal{};
      normal[0] = a == 0 ? 0.8 : -0.8;
      normal[1] = 0.6;
      plane.x = middle - normal * (0.3 * side);
      add_plane(s.particles, plane, normal);
    }
  }
  if (c.periodic) s.cell = box_cell<D>(size, periodic);
  s.cell.velocity_gradient[0][1] = c.shear;
  update_neighbours(s);
  return s;
}

template <int D>
void shake(System<D>& s, double dt) {
  for (std::size_t u = 0; u < s.particles.sphere.size(); ++u) s.particles.sphere[u].x += s.particles.velocity[u] * dt;
}

template <int D>
void compare(const Case& c) {
  System<D> plain = crowd<D>(c, 400);
  System<D> trying = plain;
  System<D> in_place = plain;
  constexpr double kStep = 0.01;
  bool any = false;
  const bool powers = has_powers(c.law);
  for (int k = 0; k < 12; ++k) {
    const Sums<D> sums = scalar_pass(plain, kStep, History::next);
    plain.contacts.commit();
    expect_same(sums, fast_pass(trying, kStep, History::next), powers);
    trying.contacts.commit();
    fast_pass(in_place, kStep, History::advance);
    expect_same(plain, trying, powers);
    expect_same(trying, in_place, false);
    for (const auto& f : plain.particles.force) any = any || f != Vec<D>{};
    for (auto* s : {&plain, &trying, &in_place}) {
      shake(*s, kStep);
      update_neighbours(*s);
    }
  }
  EXPECT_TRUE(any);
  EXPECT_GT(plain.neighbours.rebuilds, 1);  // histories have been carried over as well
}

class BlockLoop : public testing::TestWithParam<std::size_t> {};

TEST_P(BlockLoop, GivesTheBitsOfTheScalarLoop) {
  const AnyLaw law = laws()[GetParam()];
  const int dimension = traits_of(law).dimension;
  for (const Case& c : {Case{law, true, 0.0}, Case{law, true, 0.05}, Case{law, false, 0.0}}) {
    SCOPED_TRACE(c.periodic ? "periodic" : "between walls");
    if (!c.periodic && soft_sides(law).j) continue;  // a wall is not a soft body
    if (dimension != 2) compare<3>(c);
    if (dimension != 3) compare<2>(c);
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, BlockLoop, testing::Range(std::size_t{0}, laws().size()));

/// Blocks of any length, their ends inside a vector register.
TEST(BlockLoopParts, TakesPartsOfAList) {
  const System<3> start = crowd<3>({solid(true, true, false)}, 300);
  for (const std::int32_t cut : {0, 1, 3, 4, 7, 127, 128, 129, 200}) {
    System<3> whole = start;
    System<3> parts = start;
    fast_pass(whole, 0.01, History::advance);
    clear(parts.particles);
    const ContactSection& section = parts.contacts.sections.front();
    ASSERT_GT(section.end, cut);
    block_loop<3>(parts, section, {section.begin, section.begin + cut}, {.dt = 0.01, .history = History::advance});
    block_loop<3>(parts, section, {section.begin + cut, section.end}, {.dt = 0.01, .history = History::advance});
    expect_same(whole, parts, false);
  }
}

TEST(BlockLoopParts, LeavesHistoryAloneWhenAskedTo) {
  System<3> s = crowd<3>({solid(true, true, false)}, 300);
  fast_pass(s, 0.01, History::advance);
  const auto spring = s.contacts.spring;
  fast_pass(s, 0.01, History::none);
  for (std::size_t c = 0; c < spring.size(); ++c) ASSERT_EQ(spring[c], s.contacts.spring[c]);
}

TEST(BlockLoopParts, ADistanceThatIsNoNumberMakesAForceThatIsNone) {
  System<3> scalar = crowd<3>({solid(true, true, false)}, 300);
  const ContactSection& section = scalar.contacts.sections.front();
  const auto lost = static_cast<std::size_t>(scalar.contacts.i[static_cast<std::size_t>(section.begin)]);
  scalar.particles.sphere[lost].x[1] = std::numeric_limits<double>::quiet_NaN();
  System<3> fast = scalar;
  scalar_pass(scalar, 0.01, History::advance);
  fast_pass(fast, 0.01, History::advance);
  EXPECT_TRUE(std::isnan(scalar.particles.force[lost][0]));
  for (std::size_t u = 0; u < fast.particles.force.size(); ++u)
    for (int k = 0; k < 3; ++k)
      ASSERT_EQ(std::isnan(scalar.particles.force[u][k]), std::isnan(fast.particles.force[u][k])) << "body " << u;
}

TEST(BlockLoopParts, CoincidentCentresHaveAFixedNormal) {
  System<3> s;
  Material m;
  m.density = 1000.0;
  m.youngs_modulus = 1e6;
  s.materials = {m};
  s.laws = LawSet(1);
  s.laws.set(0, 0, hertz_law(HertzCoefficients::of(m, m, 0.3, 0.5), false));
  for (int k = 0; k < 2; ++k) add_grain(s.particles, solid_sphere({{1.0, 1.0, 1.0}}, 1.0, 1000.0, 0));
  force_pass(s, 0.0);
  EXPECT_GT(s.particles.force[0][0], 0.0);
  EXPECT_EQ(s.particles.force[0][1], 0.0);
  EXPECT_EQ(s.particles.force[0][2], 0.0);
}

}  // namespace
