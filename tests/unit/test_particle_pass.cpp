// Laws may ask for a pass over particles before contacts are evaluated; the ones that do not must see nothing of it.
#include <gtest/gtest.h>

#include "common/dynamics/force_pass.h"
#include "common/dynamics/pair_loop.h"
#include "common/neighbours/verlet_list.h"

namespace softgrain {
namespace {

/// Force = overlap times the sum of all overlaps of both bodies: needs the sums before the first contact.
struct MultiContactLaw {
  static constexpr LawTraits traits{.needs_particle_pass = true};

  template <int D>
  void share(const ContactState<D>& s, bool of_i, MultiContactSum<D>& sum) const {
    sum.add(of_i ? s.overlap : 2.0 * s.overlap, s.normal);
  }
  template <int D>
  [[nodiscard]] ContactResponse<D> evaluate(const ContactState<D>& s) const {
    ContactResponse<D> out;
    out.normal_force = out.elastic_force = s.overlap * (s.sum_i->volume + s.sum_j->volume);
    return out;
  }
};

struct ForceOfContact {
  std::vector<double> force;
  void apart(std::size_t) {}
  template <LawTraits>
  void touch(std::size_t, std::size_t, std::size_t, const ContactGeometry<3>&, const ContactResponse<3>& r) {
    force.push_back(r.normal_force);
  }
};

System3 three_in_a_row() {
  System3 s;
  s.materials = {{"grain", 1000.0, 1e6, 0.3, false}};
  s.laws = LawSet(1);
  s.laws.set(0, 0, hertz_law(HertzCoefficients::of(s.materials[0], s.materials[0], 0.0, 1.0), false));
  for (const double x : {0.0, 1.9, 3.6}) {
    NewBody<3> b;
    b.x = {{x, 0.0, 0.0}};
    b.r = 1.0;
    b.mass = 1.0;
    add_grain(s.particles, b);
  }
  rebuild_neighbours(s);
  return s;
}

TEST(ParticlePass, SumsAreThereBeforeTheFirstContactIsEvaluated) {
  System3 s = three_in_a_row();  // overlaps 0.1 (0-1) and 0.3 (1-2)
  ASSERT_EQ(s.contacts.sections.size(), 1u);
  s.contacts.particle_sum.assign(3, MultiContactSum<3>{});
  const MultiContactLaw law;
  const ContactSection section = s.contacts.sections[0];
  SystemPairs<3, Geometry::sphere_sphere, false, System3> source{s, 0.0, History::none};
  const PairRange range{section.begin, section.end};
  add_shares(source, law, range);
  ForceOfContact sink;
  run_section(source, law, range, sink);
  ASSERT_EQ(sink.force.size(), 2u);
  // Sums: body 0: 0.1; body 1: 2*0.1 + 0.3; body 2: 2*0.3.
  EXPECT_NEAR(sink.force[0], 0.1 * (0.1 + 0.5), 1e-12);
  EXPECT_NEAR(sink.force[1], 0.3 * (0.5 + 0.6), 1e-12);
}

TEST(ParticlePass, LawsWithoutOneStoreNoSums) {
  System3 s = three_in_a_row();
  force_pass(s, 0.0);
  EXPECT_TRUE(s.contacts.particle_sum.empty());
}

}  // namespace
}  // namespace softgrain
