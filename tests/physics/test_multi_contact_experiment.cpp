// A soft particle with several neighbours [SP 1.7.1]: the same mechanics as the measurement of one contact, balance of
// forces, symmetry, and inner soft particles that act by law.
#include <gtest/gtest.h>

#include <cmath>

#include "common/core/error.h"
#include "common/dynamics/force_pass.h"
#include "microsim/multi_contact_arrangements.h"
#include "microsim/multi_contact_experiment.h"
#include "microsim/protocol.h"
#include "microsim/soft_experiment.h"
#include "tests/support/multi_contact.h"

namespace softgrain {
namespace {

using test::coarse_spec;
using test::content_of;
using test::multi_contact_of;

const MultiContactPlan kHalfAndEnd{{0.5, 1.0}};

/// Rs, increment and overlaps are powers of two: every prescribed position is exact, whatever the order of additions.
SoftParticleSpec binary_spec() {
  SoftParticleSpec spec = coarse_spec();
  spec.shell_radius = 0x1p-6;
  return spec;
}

template <class MakeExperiment>
std::vector<double> single_contact_forces(const SoftParticleSpec& spec, MakeExperiment make, double deltas[2]) {
  DampedProtocolOptions options;
  options.increment = 0x1p-7;
  options.tolerance = 1e-2;
  const auto protocol = make_damped_protocol(options);
  SoftExperiment e = make();
  std::vector<double> forces;
  for (int k = 0; k < 2; ++k) {
    protocol->approach(e, deltas[k] * spec.shell_radius);
    forces.push_back(protocol->settle(e, false).force[0] /
                     (spec.youngs_modulus * spec.shell_radius * spec.shell_radius));
  }
  return forces;
}

MultiContactOptions damped_options() {
  MultiContactOptions options;
  options.relaxation = Relaxation::damped;
  return options;
}

MultiContactOptions binary_options() {
  MultiContactOptions options = damped_options();
  options.increment = 0x1p-7;
  options.least_stiffness = 0.0;  // as the measurement of one contact
  return options;
}

TEST(MultiContactExperiment, OnePlaneIsTheMeasurementOfOneContactBitForBit) {
  const SoftParticleSpec spec = binary_spec();
  const SoftContent content = content_of(spec, 0);
  double deltas[2] = {0.125, 0.25};
  const auto expected = single_contact_forces(
      spec, [&] { return make_soft_solid(spec, content.grains, false); }, deltas);
  MultiContactExperiment e = make_multi_contact(
      spec, multi_contact_of(PartnerKind::plane, 0.0, directions_of(Arrangement::one), 0.25), content, {});
  const MultiContactRun run = run_multi_contact(e, kHalfAndEnd, binary_options());
  ASSERT_EQ(run.points.size(), 2U);
  EXPECT_GT(run.points[1].normal[0], 1e-4);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(run.points[k].normal[0], expected[k]);
    EXPECT_NEAR(run.points[k].overlap[0], deltas[k], 1e-15);
    EXPECT_TRUE(run.points[k].converged);
  }
  EXPECT_EQ(run.cost.loop_passes, e.system.cost.loop_passes);
}

TEST(MultiContactExperiment, OneEqualSoftNeighbourIsTheSoftSoftMeasurementBitForBit) {
  const SoftParticleSpec spec = binary_spec();
  const SoftContent first = content_of(spec, 0);
  const SoftContent second = content_of(spec, 1);
  double deltas[2] = {0.25, 0.5};
  const auto expected = single_contact_forces(
      spec, [&] { return make_soft_soft(spec, first.grains, second.grains, false); }, deltas);
  MultiContactExperiment e = make_multi_contact(
      spec, multi_contact_of(PartnerKind::soft, 1.0, directions_of(Arrangement::one), 0.5), first, {&second});
  const MultiContactRun run = run_multi_contact(e, kHalfAndEnd, binary_options());
  EXPECT_GT(run.points[1].normal[0], 1e-5);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(run.points[k].normal[0], expected[k]);
}

/// Speed, overlaps and Rs are powers of two, and each approach is one stretch: the same motion in both experiments.
struct BinaryMotion {
  static constexpr double kSpeed = 0x1p-6;
  static constexpr double kStep = 2.0;
  static constexpr double kSettle = 32.0;

  static std::vector<double> single(SoftExperiment e, const double (&deltas)[2]) {
    LeastWorkProtocolOptions o;
    o.increment = 1.0;
    o.increment_passes = 0;
    o.approach_speed = kSpeed;
    o.step_factor = kStep;
    o.settle_time = o.path_settle_time = kSettle;
    const auto protocol = make_least_work_protocol(o);
    std::vector<double> forces;
    for (const double delta : deltas) {
      protocol->approach(e, delta * e.spec.shell_radius);
      forces.push_back(protocol->settle(e, false).force[0] /
                       (e.spec.youngs_modulus * e.spec.shell_radius * e.spec.shell_radius));
    }
    return forces;
  }
  static MultiContactRun several(MultiContactExperiment e) {
    MultiContactOptions o;
    o.relaxation = Relaxation::slow_dynamics;
    o.increment = 1.0;
    o.approach_speed = kSpeed;
    o.step_factor = kStep;
    o.settle_time = kSettle;
    o.least_stiffness = 0.0;
    return run_multi_contact(e, kHalfAndEnd, o);
  }
};

TEST(MultiContactExperiment, SlowDynamicsOfOnePlaneIsThatOfOneContactBitForBit) {
  const SoftParticleSpec spec = binary_spec();
  const SoftContent content = content_of(spec, 0);
  const auto expected = BinaryMotion::single(make_soft_solid(spec, content.grains, false), {0.125, 0.25});
  const MultiContactRun run = BinaryMotion::several(make_multi_contact(
      spec, multi_contact_of(PartnerKind::plane, 0.0, directions_of(Arrangement::one), 0.25), content, {}));
  EXPECT_GT(run.points[1].normal[0], 1e-4);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(run.points[k].normal[0], expected[k]);
}

TEST(MultiContactExperiment, SlowDynamicsOfASoftNeighbourIsThatOfOneContactBitForBit) {
  const SoftParticleSpec spec = binary_spec();
  const SoftContent first = content_of(spec, 0);
  const SoftContent second = content_of(spec, 1);
  const auto expected = BinaryMotion::single(make_soft_soft(spec, first.grains, second.grains, false), {0.25, 0.5});
  const MultiContactRun run = BinaryMotion::several(make_multi_contact(
      spec, multi_contact_of(PartnerKind::soft, 1.0, directions_of(Arrangement::one), 0.5), first, {&second}));
  EXPECT_GT(run.points[1].normal[0], 1e-5);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(run.points[k].normal[0], expected[k]);
}

/// One grain that fills its shell nearly: the law of the contact is that of two spheres, or of a sphere and a plane.
SoftContent one_grain() { return {ShellPacking{0, {Vec3{}}, {0.9999}}, {}, {}}; }

/// Moved along the surface by `way`, sliding or rolling, at an overlap of 1 %.
MultiContactExperiment moved_along(PartnerKind kind, MultiContactMove move, double way, MultiContactRun& run) {
  MultiContactConfiguration c = multi_contact_of(kind, 1.0, directions_of(Arrangement::one), 0.01);
  MultiContactStage along{move, c.stages[0].overlap};
  (move == MultiContactMove::roll ? along.roll : along.slide) = way;
  c.stages.push_back(along);
  MultiContactOptions options;
  options.settle_time = 20.0;
  options.approach_speed = 0.02;
  MultiContactExperiment e = make_multi_contact(coarse_spec(), c, one_grain(), {});
  run = run_multi_contact(e, {{1.0}, {0.5, 1.0}}, options);
  return e;
}

/// Sliding drags the grain along. Rolling does so no more than a pressed grain is off its centre: h/2 times the angle.
TEST(MultiContactExperiment, WhatRollsDoesNotSlide) {
  constexpr double kWay = 0.02;
  for (const PartnerKind kind : {PartnerKind::plane, PartnerKind::solid}) {
    MultiContactRun rolled;
    MultiContactRun slid;
    (void)moved_along(kind, MultiContactMove::roll, kWay, rolled);
    (void)moved_along(kind, MultiContactMove::slide, kWay, slid);
    const MultiContactPoint& end = rolled.points.back();
    EXPECT_NEAR(end.normal[0], rolled.points.front().normal[0], 0.01 * end.normal[0]);
    EXPECT_GT(norm(slid.points.back().tangential[0]), 0.15 * slid.points.back().normal[0]) << to_string(kind);
    EXPECT_LT(norm(end.tangential[0]), 0.015 * end.normal[0]) << to_string(kind);
  }
}

/// Its contact goes over the surface, at 1 - h/2 from the centre.
TEST(MultiContactExperiment, WhatRollsGoesRound) {
  for (const PartnerKind kind : {PartnerKind::plane, PartnerKind::solid}) {
    MultiContactRun run;
    const MultiContactExperiment e = moved_along(kind, MultiContactMove::roll, 0.2, run);
    EXPECT_NEAR(run.points.back().roll, 0.2, 1e-15);
    EXPECT_NEAR(run.points.back().overlap[0], 0.01, 1e-5);
    const double angle = 0.2 / (1.0 - 0.5 * 0.01);
    EXPECT_NEAR(dot(e.direction(0), e.configuration.partners[0].direction), std::cos(angle), 1e-12);
    const Vec3 place = e.system.particles.sphere[at(e.neighbours[0].body)].x;
    const double distance = (kind == PartnerKind::plane ? 0.99 : 1.99) * e.spec.shell_radius;
    EXPECT_NEAR(norm(place - e.direction(0) * distance), 0.0, 1e-5 * distance) << to_string(kind);
  }
}

TEST(MultiContactExperiment, MomentsAreThoseOfTheForcesOnEachNeighbour) {
  const SoftParticleSpec spec = coarse_spec();
  const MultiContactConfiguration c =
      multi_contact_of(PartnerKind::plane, 0.0, directions_of(Arrangement::orthogonal), 0.2);
  MultiContactExperiment e = make_multi_contact(spec, c, content_of(spec, 1), {});
  (void)run_multi_contact(e, {{1.0}}, damped_options());
  const MultiContactPoint point = e.observe();
  const double unit = spec.youngs_modulus * std::pow(spec.shell_radius, 3);
  for (std::size_t k = 0; k < 2; ++k) {
    Vec3 moment{};
    for (const ContactRecord<3>& r : contact_records(e.system))
      if (r.j == e.neighbours[k].body)
        moment += cross(r.point - e.direction(k) * (0.9 * spec.shell_radius),
                        -(r.normal * r.normal_force + r.tangential_force));
    EXPECT_GT(norm(moment), 1e-8 * unit);
    EXPECT_NEAR(norm(point.moment[k] * unit - moment), 0.0, 1e-12 * norm(moment));
  }
}

/// Sum of all forces on what is not moved by forces, over the sum of their sizes.
double imbalance(const MultiContactExperiment& e) {
  Vec3 sum{};
  double sizes = 0.0;
  for (const ContactRecord<3>& c : contact_records(e.system)) {
    if (c.j < e.centre_bodies) continue;
    const Vec3 force = c.normal * c.normal_force + c.tangential_force;
    if (c.i < e.centre_bodies) sum += force;
    sizes += norm(force);
  }
  return norm(sum) / sizes;
}

TEST(MultiContactExperiment, ForcesOfNeighboursAndShellBalance) {
  const SoftParticleSpec spec = coarse_spec();
  const SoftContent content = content_of(spec, 2);
  const SoftContent other = content_of(spec, 3);
  MultiContactConfiguration c = multi_contact_of(PartnerKind::plane, 0.0, directions_of(Arrangement::octant), 0.2);
  c.partners[1].kind = PartnerKind::solid;
  c.partners[1].ratio = 0.5;
  c.partners[2].kind = PartnerKind::soft;
  c.partners[2].ratio = 1.0;
  MultiContactOptions options = damped_options();
  options.tolerance = 1e-6;
  MultiContactExperiment e = make_multi_contact(spec, c, content, {&other});
  const MultiContactRun run = run_multi_contact(e, {{1.0}}, options);
  EXPECT_TRUE(run.points[0].converged);
  EXPECT_GT(run.points[0].normal[0], 1e-4);
  EXPECT_GT(run.points[0].normal[1], 0.0);
  EXPECT_LT(imbalance(e), 1e-5);
}

TEST(MultiContactExperiment, ForceOnAFreeShellVanishesAndOverlapsFollowIt) {
  const SoftParticleSpec spec = coarse_spec();
  MultiContactConfiguration c = multi_contact_of(PartnerKind::plane, 0.0, directions_of(Arrangement::cube), 0.15);
  c.centre_free = true;
  MultiContactOptions options = damped_options();
  options.tolerance = 1e-5;
  MultiContactExperiment e = make_multi_contact(spec, c, content_of(spec, 4), {});
  const MultiContactPoint p = run_multi_contact(e, {{1.0}}, options).points[0];
  ASSERT_TRUE(p.converged);
  EXPECT_GT(norm(p.centre), 1e-4);
  Vec3 sum{};
  double total = 0.0;
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_NEAR(p.overlap[k], 0.15 + dot(p.centre, c.partners[k].direction), 1e-12);
    sum += c.partners[k].direction * p.normal[k] + p.tangential[k];
    total += p.normal[k];
  }
  EXPECT_LT(norm(sum), 1e-4 * total);  // nothing but the neighbours holds it
}

/// Two soft neighbours, five planes around each: those and the centre hold it, nothing else.
TEST(MultiContactExperiment, APressedSoftNeighbourRestsBetweenItsPlanesAndTheCentre) {
  const SoftParticleSpec spec = coarse_spec();
  MultiContactConfiguration c = multi_contact_of(PartnerKind::soft, 0.8, directions_of(Arrangement::opposite), 0.32);
  c.centre_free = true;
  for (std::int32_t k = 0; k < 2; ++k) {
    const Vec3 away = c.partners[at(k)].direction;
    for (const Vec3& n :
         {away, Vec3{{0.0, 1.0, 0.0}}, Vec3{{0.0, -1.0, 0.0}}, Vec3{{0.0, 0.0, 1.0}}, Vec3{{0.0, 0.0, -1.0}}}) {
      c.partners.push_back({PartnerKind::plane, 0.0, n, false, k});
      c.stages[0].overlap.push_back(0.2);
    }
  }
  MultiContactOptions options = damped_options();
  options.tolerance = 1e-5;
  const SoftContent first = content_of(spec, 5);
  const SoftContent second = content_of(spec, 6);
  MultiContactExperiment e = make_multi_contact(spec, c, content_of(spec, 4), {&first, &second});
  const MultiContactPoint p = run_multi_contact(e, {{1.0}}, options).points[0];
  ASSERT_TRUE(p.converged);
  const auto load = [&](std::size_t k) { return c.partners[k].direction * p.normal[k] + p.tangential[k]; };
  for (std::size_t k = 0; k < 2; ++k) {
    const Vec3 place = e.system.particles.sphere[at(e.neighbours[k].body)].x * (1.0 / spec.shell_radius);
    EXPECT_NEAR(p.overlap[k], 1.8 - norm(place - p.centre), 1e-12);
    EXPECT_GT(std::abs(norm(place) - 1.48), 1e-4) << "not led";
    Vec3 planes{};
    for (std::size_t n = 2 + 5 * k; n < 7 + 5 * k; ++n) {
      EXPECT_NEAR(p.overlap[n], 0.2 + dot(place - c.partners[k].direction * 1.48, c.partners[n].direction), 1e-12);
      EXPECT_GT(p.normal[n], 0.0);
      planes += load(n);
    }
    EXPECT_GT(p.normal[k], 0.0);
    EXPECT_LT(norm(load(k) - planes), 1e-4 * p.normal[k]);
  }
  EXPECT_LT(norm(load(0) + load(1)), 1e-4 * p.normal[0]);  // the centre has no other neighbour
}

SoftContent mirrored(SoftContent content) {
  for (Vec3& x : content.grains.position) x[0] = -x[0];
  return content;
}

TEST(MultiContactExperiment, AMirroredParticleFeelsTheMirroredForces) {
  SoftParticleSpec spec = coarse_spec();
  spec.friction = 0.0;  // paths without friction end in the same state
  const SoftContent content = content_of(spec, 5);
  MultiContactConfiguration c = multi_contact_of(PartnerKind::plane, 0.0, directions_of(Arrangement::opposite), 0.2);
  MultiContactOptions options;
  options.tolerance = 1e-4;
  MultiContactExperiment e = make_multi_contact(spec, c, content, {});
  MultiContactExperiment m = make_multi_contact(spec, c, mirrored(content), {});
  const MultiContactPoint p = run_multi_contact(e, {{1.0}}, options).points[0];
  const MultiContactPoint q = run_multi_contact(m, {{1.0}}, options).points[0];
  EXPECT_GT(p.normal[0], 0.0);
  EXPECT_EQ(p.normal[0], q.normal[1]);
  EXPECT_EQ(p.normal[1], q.normal[0]);
}

TEST(MultiContactExperiment, NeighboursAreBlindToEachOther) {
  const SoftParticleSpec spec = coarse_spec();
  const SoftContent content = content_of(spec, 0);
  MultiContactConfiguration c;
  c.name = "blind";
  c.partners = {{PartnerKind::soft, 2.0, {{1.0, 0.0, 0.0}}},
                {PartnerKind::soft, 2.0, {{0.5, std::sqrt(0.75), 0.0}}},
                {PartnerKind::solid, 2.0, {{0.5, 0.0, std::sqrt(0.75)}}},
                {PartnerKind::plane, 0.0, {{0.0, 1.0, 0.0}}}};
  c.stages = {{MultiContactMove::load, std::vector<double>(4, 0.05), 0.0}};
  MultiContactExperiment e = make_multi_contact(spec, c, content, {&content, &content});
  (void)run_multi_contact(e, {{1.0}}, {});
  const auto& n = e.neighbours;
  const auto owner = [&](Slot s) {
    if (s < e.centre_bodies || s == e.centre_shell) return -1;
    for (std::size_t k = 0; k < n.size(); ++k)
      if (s == n[k].body || (s >= n[k].begin && s < n[k].end)) return static_cast<int>(k);
    return -2;
  };
  for (std::size_t k = 0; k < e.system.contacts.i.size(); ++k) {
    const int a = owner(e.system.contacts.i[k]);
    const int b = owner(e.system.contacts.j[k]);
    EXPECT_TRUE(a == b || a == -1 || b == -1) << a << " meets " << b;
  }
}

TEST(MultiContactExperiment, UnloadingComesBackToNothingAndSlidingDragsTheNeighbour) {
  const SoftParticleSpec spec = coarse_spec();
  MultiContactConfiguration c = multi_contact_of(PartnerKind::plane, 0.0, directions_of(Arrangement::one), 0.25);
  c.stages.push_back({MultiContactMove::slide, {0.25}, 0.05});
  c.stages.push_back({MultiContactMove::unload, {0.0}, 0.0});
  MultiContactExperiment e = make_multi_contact(spec, c, content_of(spec, 1), {});
  const MultiContactRun run = run_multi_contact(e, {{1.0}, {0.5, 1.0}, {1.0}}, {});
  ASSERT_EQ(run.points.size(), 4U);
  const Vec3 along = slide_direction(c.partners[0].direction);
  EXPECT_NEAR(run.points[1].slide, 0.025, 1e-12);
  EXPECT_NEAR(run.points[2].slide, 0.05, 1e-12);
  EXPECT_NEAR(run.points[2].overlap[0], 0.25, 1e-12);
  // The plane is dragged back by the grains it slides over, at most by their friction.
  const double drag = -dot(run.points[2].tangential[0], along);
  EXPECT_GT(drag, 0.02 * run.points[2].normal[0]);
  EXPECT_LE(drag, spec.friction * run.points[2].normal[0] * (1.0 + 1e-9));
  EXPECT_NEAR(run.points[3].normal[0], 0.0, 1e-9);
}

TEST(MultiContactExperiment, ASlidingSphereKeepsItsOverlap) {
  const SoftParticleSpec spec = coarse_spec();
  MultiContactConfiguration c = multi_contact_of(PartnerKind::solid, 0.5, directions_of(Arrangement::one), 0.1);
  c.stages.push_back({MultiContactMove::slide, {0.1}, 0.1});
  MultiContactExperiment e = make_multi_contact(spec, c, content_of(spec, 1), {});
  const MultiContactRun run = run_multi_contact(e, {{1.0}, {0.3, 1.0}}, {});
  for (const MultiContactPoint& p : run.points) EXPECT_NEAR(p.overlap[0], 0.1, 1e-12);
  EXPECT_NEAR(std::acos(e.direction(0)[0]) * 1.4, 0.1, 1e-9);
}

TEST(MultiContactExperiment, RecordsAreDimensionlessBitForBit) {
  const SoftParticleSpec spec = coarse_spec();
  SoftParticleSpec scaled = spec;
  scaled.youngs_modulus *= 256.0;
  scaled.shell_radius *= 16.0;
  const SoftContent content = content_of(spec, 6);
  MultiContactConfiguration c = multi_contact_of(PartnerKind::soft, 0.5, directions_of(Arrangement::orthogonal), 0.2);
  c.partners[1].kind = PartnerKind::plane;
  c.partners[1].ratio = 0.0;
  c.stages.push_back({MultiContactMove::slide, {0.2, 0.2}, 0.05});
  MultiContactExperiment a = make_multi_contact(spec, c, content, {&content});
  MultiContactExperiment b = make_multi_contact(scaled, c, content, {&content});
  const MultiContactRun x = run_multi_contact(a, {{0.5, 1.0}, {1.0}}, {});
  const MultiContactRun y = run_multi_contact(b, {{0.5, 1.0}, {1.0}}, {});
  EXPECT_GT(x.points[1].normal[1], 1e-4);
  test::expect_equal(x.points, y.points);
}

/// Deep enough for force and near enough to the onset for loose grains, on many packings: one of them alone is chaotic.
TEST(MultiContactExperiment, TheLeastStiffnessSavesPassesAndLeavesTheMeanAlone) {
  const SoftParticleSpec spec = coarse_spec();
  double mean[2] = {0.0, 0.0};
  std::int64_t passes[2] = {0, 0};
  for (std::uint64_t packing = 0; packing < 16; ++packing)
    for (int k = 0; k < 2; ++k) {
      MultiContactOptions options = damped_options();
      if (k == 0) options.least_stiffness = 0.0;
      MultiContactExperiment e = make_multi_contact(
          spec, multi_contact_of(PartnerKind::plane, 0.0, directions_of(Arrangement::opposite), 0.25),
          content_of(spec, packing), {});
      const MultiContactRun run = run_multi_contact(e, {{1.0}}, options);
      mean[k] += run.points[0].normal[0] + run.points[0].normal[1];
      passes[k] += run.cost.loop_passes;
    }
  EXPECT_NEAR(mean[1] / mean[0], 1.0, 0.03);
  EXPECT_LT(passes[1], passes[0]);
}

SoftContact inner_law(const SoftParticleSpec& spec, bool i_is_soft, bool partner_is_soft) {
  SoftContact law;
  law.normal = {2.0, 2.5, -2.0 * std::pow(0.05, 2.5)};
  law.tangential = {1.0, 1.0, -0.05};
  law.delta = 0.05;
  law.modulus = spec.youngs_modulus;
  law.friction = 0.2;
  law.i_is_soft = i_is_soft;
  law.partner_is_soft = partner_is_soft;
  return law;
}

InnerLaws inner_laws(const SoftParticleSpec& spec) {
  return {inner_law(spec, true, false), inner_law(spec, true, false), inner_law(spec, false, false),
          inner_law(spec, true, true), 0.7};
}

/// One inner soft particle in the middle and one small grain.
SoftContent one_inner(double r) {
  SoftContent content;
  content.grains.position = {{{0.0, 0.0, -0.94}}};
  content.grains.radius = {0.05};
  content.inner = {{{{0.0, 0.0, 0.0}}, r}};
  return content;
}

TEST(MultiContactExperiment, AnInnerSoftParticleCarriesTheForceOfItsLaw) {
  const SoftParticleSpec spec = coarse_spec();
  const InnerLaws laws = inner_laws(spec);
  const MultiContactConfiguration c = multi_contact_of(PartnerKind::plane, 0.0, directions_of(Arrangement::one), 0.6);
  MultiContactOptions options = damped_options();
  options.tolerance = 1e-8;
  // The grain stays out of the way. The plane, 0.6 deep, leaves 1.4 between it and the shell for a diameter of 1.6.
  constexpr double kRadius = 0.8;
  MultiContactExperiment e = make_multi_contact(spec, c, one_inner(kRadius), {}, &laws);
  const MultiContactPoint p = run_multi_contact(e, {{1.0}}, options).points[0];
  ASSERT_TRUE(p.converged);
  const SoftContact law = inner_law(spec, true, false);
  EXPECT_NEAR(p.normal[0], kRadius * kRadius * law.normal.value(0.1 / kRadius), 1e-6 * p.normal[0]);
}

TEST(MultiContactExperiment, InnerSoftParticlesMeetThoseOfSoftNeighboursAndSolids) {
  const SoftParticleSpec spec = coarse_spec();
  const InnerLaws laws = inner_laws(spec);
  MultiContactConfiguration c = multi_contact_of(PartnerKind::soft, 0.5, directions_of(Arrangement::opposite), 0.2);
  c.partners[1].kind = PartnerKind::solid;
  const SoftContent content = one_inner(1.0 - 1e-9);
  MultiContactExperiment e = make_multi_contact(spec, c, content, {&content}, &laws);
  MultiContactOptions options = damped_options();
  options.tolerance = 1e-8;
  const MultiContactPoint p = run_multi_contact(e, {{1.0}}, options).points[0];
  ASSERT_TRUE(p.converged);
  EXPECT_GT(p.normal[0], 1e-4);
  EXPECT_GT(p.normal[1], 1e-4);
  EXPECT_LT(imbalance(e), 1e-7);
}

TEST(MultiContactExperiment, BadArrangementsAreRefused) {
  const SoftParticleSpec spec = coarse_spec();
  const SoftContent content = content_of(spec, 0);
  MultiContactConfiguration c = multi_contact_of(PartnerKind::plane, 0.0, {Vec3{{1.0, 1.0, 0.0}}}, 0.1);
  EXPECT_THROW((void)make_multi_contact(spec, c, content, {}), InputError);
  c = multi_contact_of(PartnerKind::soft, 1.0, directions_of(Arrangement::opposite), 0.1);
  EXPECT_THROW((void)make_multi_contact(spec, c, content, {&content}), InputError);
  c = multi_contact_of(PartnerKind::solid, 0.0, directions_of(Arrangement::one), 0.1);
  EXPECT_THROW((void)make_multi_contact(spec, c, content, {}), InputError);
  c = multi_contact_of(PartnerKind::plane, 0.0, directions_of(Arrangement::one), 0.1);
  EXPECT_THROW((void)make_multi_contact(spec, c, one_inner(0.5), {}), InputError);
}

}  // namespace
}  // namespace softgrain
