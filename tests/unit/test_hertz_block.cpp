// The vectorised contact loop against the scalar one: the same bits, whatever the law, the cell and the history.
#include "common/dynamics/hertz_block.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/core/random.h"
#include "common/core/solid_sphere.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/pair_loop.h"
#include "common/neighbours/verlet_list.h"

namespace {

using namespace softgrain;

/// Adds every contact to its bodies, in list order: the slow, obvious way.
template <int D>
struct PlainSink {
  Particles<D>& p;

  void apart(std::size_t) {}
  template <bool kTorque>
  void touch(std::size_t, std::size_t i, std::size_t j, const ContactGeometry<D>& g, const ContactResponse<D>& r) {
    Vec<D> f = g.normal * r.normal_force;
    if constexpr (kTorque) {
      f = g.normal * r.normal_force + r.tangential_force;
      const Rot<D> moment = cross(g.normal, r.tangential_force);
      p.torque[i] -= moment * g.arm_i;
      p.torque[j] -= moment * g.arm_j;
    }
    p.force[i] += f;
    p.force[j] -= f;
  }
};

template <int D>
void clear(Particles<D>& p) {
  std::fill(p.force.begin(), p.force.end(), Stored<D>{});
  std::fill(p.torque.begin(), p.torque.end(), StoredRot<D>{});
}

template <int D>
void scalar_pass(System<D>& s, double dt, History history) {
  clear(s.particles);
  PlainSink<D> sink{s.particles};
  pair_loop(s, dt, sink, history);
}

template <int D>
void fast_pass(System<D>& s, double dt, History history) {
  clear(s.particles);
  if (history == History::next) s.contacts.make_next();
  for (const ContactSection& section : s.contacts.sections) {
    ASSERT_TRUE(has_fast_loop(s.laws, section));
    hertz_loop(s, section, dt, {section.begin, section.end}, history);
  }
}

struct Case {
  bool friction = true;
  bool damped = true;
  bool rescaled = false;
  bool periodic = true;
  double shear = 0.0;
};

/// Overlapping grains of many sizes with random motion; some pairs touch, some are merely near.
template <int D>
System<D> crowd(const Case& c, int grains) {
  System<D> s;
  Material m;
  m.density = 2500.0;
  m.youngs_modulus = 1e6;
  m.poisson_ratio = 0.3;
  s.materials = {m};
  s.laws = LawSet(1);
  s.laws.set(0, 0, hertz_law(HertzCoefficients::of(m, m, c.friction ? 0.4 : 0.0, c.damped ? 0.6 : 1.0), c.rescaled));
  RandomStream random(7, RandomPurpose::test, 0);
  const double side = 10.0 * std::pow(grains / 400.0, 1.0 / D);
  for (int k = 0; k < grains; ++k) {
    NewBody<D> body;
    for (int a = 0; a < D; ++a) body.x[a] = side * random.uniform();
    body.r = 0.3 + 0.5 * random.uniform();
    body.mass = 3.0;
    body.inertia = 0.5;
    for (int a = 0; a < D; ++a) body.velocity[a] = random.uniform() - 0.5;
    for (double& w : body.spin.v) w = random.uniform() - 0.5;
    add_grain(s.particles, body);
  }
  Vec<D> size;
  std::array<bool, D> periodic{};
  for (int a = 0; a < D; ++a) {
    size[a] = side;
    periodic[static_cast<std::size_t>(a)] = c.periodic;
  }
  if (c.periodic) s.cell = box_cell<D>(size, periodic);
  s.cell.velocity_gradient[0][1] = c.shear;
  update_neighbours(s);
  return s;
}

template <int D>
void expect_same(const System<D>& a, const System<D>& b) {
  for (std::size_t u = 0; u < a.particles.force.size(); ++u) {
    ASSERT_EQ(a.particles.force[u], b.particles.force[u]) << "body " << u;
    ASSERT_EQ(a.particles.torque[u], b.particles.torque[u]) << "body " << u;
  }
  ASSERT_EQ(a.contacts.spring.size(), b.contacts.spring.size());
  for (std::size_t c = 0; c < a.contacts.spring.size(); ++c)
    ASSERT_EQ(a.contacts.spring[c], b.contacts.spring[c]) << "contact " << c;
  ASSERT_EQ(a.contacts.memory, b.contacts.memory);
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
  for (int k = 0; k < 12; ++k) {
    scalar_pass(plain, kStep, History::next);
    plain.contacts.commit();
    fast_pass(trying, kStep, History::next);
    trying.contacts.commit();
    fast_pass(in_place, kStep, History::advance);
    expect_same(plain, trying);
    expect_same(plain, in_place);
    for (const auto& f : plain.particles.force) any = any || f != Vec<D>{};
    for (auto* s : {&plain, &trying, &in_place}) {
      shake(*s, kStep);
      update_neighbours(*s);
    }
  }
  EXPECT_TRUE(any);
  EXPECT_GT(plain.neighbours.rebuilds, 1);  // histories have been carried over as well
}

class HertzBlock : public testing::TestWithParam<int> {};

Case case_of(int code) {
  return {(code & 1) != 0, (code & 2) != 0, (code & 4) != 0, (code & 8) != 0, (code & 16) != 0 ? 0.05 : 0.0};
}

/// Without friction there is no spring to rescale, and an open cell does not shear.
std::vector<int> cases_that_exist() {
  std::vector<int> codes;
  for (int code = 0; code < 32; ++code) {
    const Case c = case_of(code);
    if ((!c.rescaled || c.friction) && (c.shear == 0.0 || c.periodic)) codes.push_back(code);
  }
  return codes;
}

TEST_P(HertzBlock, GivesTheBitsOfTheScalarLoop) {
  const Case c = case_of(GetParam());
  compare<3>(c);
  compare<2>(c);
}

INSTANTIATE_TEST_SUITE_P(Laws, HertzBlock, testing::ValuesIn(cases_that_exist()));

/// Blocks of any length, their ends inside a vector register.
TEST(HertzBlock, TakesPartsOfAList) {
  const System<3> start = crowd<3>({}, 300);
  for (const std::int32_t cut : {0, 1, 3, 4, 7, 127, 128, 129, 200}) {
    System<3> whole = start;
    System<3> parts = start;
    fast_pass(whole, 0.01, History::advance);
    clear(parts.particles);
    const ContactSection& section = parts.contacts.sections.front();
    ASSERT_GT(section.end, cut);
    hertz_loop(parts, section, 0.01, {section.begin, section.begin + cut}, History::advance);
    hertz_loop(parts, section, 0.01, {section.begin + cut, section.end}, History::advance);
    expect_same(whole, parts);
  }
}

TEST(HertzBlock, LeavesHistoryAloneWhenAskedTo) {
  System<3> s = crowd<3>({}, 300);
  fast_pass(s, 0.01, History::advance);
  const auto spring = s.contacts.spring;
  fast_pass(s, 0.01, History::none);
  for (std::size_t c = 0; c < spring.size(); ++c) ASSERT_EQ(spring[c], s.contacts.spring[c]);
}

TEST(HertzBlock, ADistanceThatIsNoNumberMakesAForceThatIsNone) {
  System<3> scalar = crowd<3>({}, 300);
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

TEST(HertzBlock, CoincidentCentresHaveAFixedNormal) {
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
