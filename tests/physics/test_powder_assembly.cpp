// Powders brought together: what makes that fast changes neither the state it ends in nor the bits of a run that is
// taken up again.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "common/dynamics/force_pass.h"
#include "microsim/powder/powder_assembly.h"

namespace softgrain {
namespace {

PowderSpec small(double kappa) {
  PowderSpec spec;
  spec.disks = 60;
  spec.stiffness = kappa;
  return spec;
}

double coordination(const PowderState& s, const PowderSpec& spec) {
  return powder_contacts(s.system, kPowderZeroForce, spec.cohesive).coordination;
}

PowderProtocol method(int number) {
  PowderProtocol p;
  p.method = number;
  return p;
}

void expect_same_bits(const PowderState& a, const PowderState& b) {
  EXPECT_EQ(a.system.step, b.system.step);
  EXPECT_EQ(a.system.cell.edges, b.system.cell.edges);
  for (std::size_t u = 0; u < a.system.particles.sphere.size(); ++u) {
    EXPECT_EQ(a.system.particles.sphere[u].x, b.system.particles.sphere[u].x);
    EXPECT_EQ(a.system.particles.velocity[u], b.system.particles.velocity[u]);
  }
}

TEST(StressCellSteps, ManyAtOnceAreTheSameAsOneByOne) {
  PowderState a = start_powder(small(1e3), 1, 0);
  PowderState b = start_powder(small(1e3), 1, 0);
  const StressControl<2> control{{{0.01, 0.01}}, a.phase_edge, 2.0, 1.0};
  StressCellVerlet<2> many(2e-3, control);
  StressCellVerlet<2> single(2e-3, control);
  many.initialise(a.system);
  single.initialise(b.system);
  many.advance(a.system, 4000);
  for (int k = 0; k < 4000; ++k) single.step(b.system);
  EXPECT_GT(a.system.contacts.size(), 0u);
  expect_same_bits(a, b);
}

/// dv/dt = -gamma v for a disk alone in a cell of fixed lengths; second order in the step.
TEST(StressCellSteps, DragSlowsExponentially) {
  PowderSpec spec = small(1e3);
  spec.disks = 2;
  spec.solid_fraction = 0.01;
  double error[2] = {0.0, 0.0};
  for (const int fine : {0, 1}) {
    PowderState s = start_powder(spec, 1, 0);
    s.system.particles.velocity[0] = Vec<2>{{0.01, -0.02}};
    s.system.particles.spin[0] = Vec<1>{{0.3}};
    const double dt = fine == 1 ? 0.01 : 0.02;
    StressCellVerlet<2> steps(dt, {{}, s.phase_edge, std::numeric_limits<double>::infinity(), 1.0});
    steps.initialise(s.system);
    steps.set_drag(0.0, {0.5, 0.0});
    steps.advance(s.system, std::lround(2.0 / dt));
    const double left = std::exp(-1.0);
    error[fine] = std::abs(s.system.particles.velocity[0][1] / (-0.02) - left);
    EXPECT_NEAR(s.system.particles.spin[0][0] / 0.3, left, 1e-3);
  }
  EXPECT_LT(error[0], 1e-4);
  EXPECT_NEAR(error[0] / error[1], 4.0, 0.2);
}

/// The published protocol waits until undamped vibrations have rung down; with the drag a sample ends sooner in the
/// same place. Contacts may be missing that slow ringing would have closed (a few per thousand; of packs as small as 60
/// disks a few per hundred).
TEST(PowderAssembly, TheDragChangesTheTimeNotTheResult) {
  PowderSpec spec = small(1e3);
  spec.disks = 200;
  const auto phases = powder_phases(spec, method(1));
  PowderOptions options;
  PowderOptions published;
  published.settle_drag = 0.0;
  published.time_max = 400.0;  // tiny packs may ring for ever
  double time[2] = {0.0, 0.0};
  double z[2] = {0.0, 0.0};
  for (const std::uint64_t sample : {0, 1, 2, 3}) {
    PowderState a = start_powder(spec, 3, sample);
    PowderState b = start_powder(spec, 3, sample);
    const PowderResult fast = run_powder(a, spec, phases, options);
    (void)run_powder(b, spec, phases, published);
    time[0] += a.system.time;
    time[1] += b.system.time;
    const PowderResult slow = run_powder(b, spec, phases, options);  // what rings still comes to rest
    ASSERT_TRUE(fast.usable) << fast.reason;
    ASSERT_TRUE(slow.usable) << slow.reason;
    EXPECT_NEAR(fast.fraction, slow.fraction, 3e-4);
    EXPECT_NEAR(coordination(a, spec), coordination(b, spec), 2.01 * 2.0 / 200.0) << "two contacts of 200 disks";
    z[0] += coordination(a, spec);
    z[1] += coordination(b, spec);
  }
  EXPECT_NEAR(z[0] / z[1], 1.0, 0.01) << "three contacts of 310";
  EXPECT_LT(time[0], 0.75 * time[1]);
}

TEST(PowderAssembly, DisksAggregateInAFixedCellBeforeItIsFreed) {
  PowderSpec spec = small(1e3);
  spec.start_speed = 9.48;
  PowderState s = start_powder(spec, 1, 0);
  const auto phases = powder_phases(spec, method(2));
  ASSERT_EQ(phases.size(), 3u);
  const PowderResult r = run_powder(s, spec, phases, {});
  ASSERT_TRUE(r.usable) << r.reason;
  EXPECT_TRUE(one_aggregate(s.system));
  EXPECT_NEAR(r.stress[0], 0.01, 1e-4);
  EXPECT_NEAR(r.stress[1], 0.01, 1e-4);
  double energy = -1.0;
  for (const PowderPoint& p : s.points) {
    if (energy < 0.0) energy = p.kinetic;
    if (p.phase > 1) continue;
    EXPECT_NEAR(p.fraction, 0.36, p.phase == 0 ? 1e-12 : 0.02) << "nothing presses yet";
  }
  // Mean of m v^2/2 at the start, V0^2/<1/m> = 9.48^2 D0/2 (both components; <d^-2> = 2) within sampling.
  EXPECT_NEAR(energy, 0.5 * 9.48 * 9.48 * 1e-3, 0.006);
  Vec<2> momentum{};
  for (std::size_t u = 0; u < 60; ++u)
    momentum += s.system.particles.velocity[u] * (1.0 / s.system.particles.inverse_mass[u]);
  EXPECT_LT(norm(momentum), 1e-2);
}

PowderSpec series_b() {
  PowderSpec spec = small(1e3);
  spec.rolling = true;
  spec.pressure = 0.0;
  spec.start_speed = 9.48;
  return spec;
}

TEST(PowderAssembly, StiffeningSlowerChangesLittle) {
  const PowderSpec spec = series_b();
  PowderProtocol protocol = method(2);
  protocol.aggregation_kappa = 1e2;
  double fraction[2];
  double z[2];
  for (const int slow : {0, 1}) {
    protocol.stiffening_time = slow == 1 ? 80.0 : 20.0;
    PowderState s = start_powder(spec, 1, 0);
    const PowderResult r = run_powder(s, spec, powder_phases(spec, protocol), {});
    ASSERT_TRUE(r.usable) << r.reason;
    EXPECT_EQ(s.stiffness, 1e3);
    fraction[slow] = r.fraction;
    z[slow] = coordination(s, spec);
  }
  EXPECT_NEAR(fraction[0], fraction[1], 5e-3);
  EXPECT_NEAR(z[0], z[1], 0.07) << "two contacts of sixty disks";
}

TEST(PowderAssembly, AnotherStiffnessLeavesTangentialForcesAndMoments) {
  const PowderSpec spec = series_b();
  PowderState s = start_powder(spec, 1, 0);
  PowderOptions options;
  options.time_max = 60.0;
  (void)run_powder(s, spec, powder_phases(spec, method(2)), options);
  const auto before = contact_records(s.system);
  set_stiffness(s, spec, 2e3);
  const auto after = contact_records(s.system);
  ASSERT_EQ(before.size(), after.size());
  double largest = 0.0;
  for (std::size_t c = 0; c < before.size(); ++c) {
    largest = std::max(largest, norm(before[c].tangential_force));
    EXPECT_NEAR(after[c].tangential_force[0], before[c].tangential_force[0], 1e-12);
    EXPECT_NEAR(after[c].tangential_force[1], before[c].tangential_force[1], 1e-12);
    EXPECT_NEAR(after[c].rolling_moment[0], before[c].rolling_moment[0], 1e-12);
  }
  EXPECT_GT(largest, 1e-3);
}

/// Stops after so many recorded points.
struct Stop : std::runtime_error {
  Stop() : std::runtime_error("stop") {}
};

TEST(PowderAssembly, ARunTakenUpAgainHasTheSameBits) {
  PowderSpec spec = series_b();
  spec.pressure = 0.01;
  PowderProtocol protocol = method(2);
  protocol.aggregation_kappa = 1e2;
  protocol.stiffening_time = 30.0;
  const auto phases = powder_phases(spec, protocol);
  PowderState whole = start_powder(spec, 2, 0);
  const PowderResult r = run_powder(whole, spec, phases, {});
  ASSERT_TRUE(r.usable) << r.reason;
  for (const std::size_t stop : {std::size_t{2}, whole.points.size() / 2, whole.points.size() - 2}) {
    PowderState first = start_powder(spec, 2, 0);
    PowderState saved;
    RunControl<PowderState> control;
    control.save = [&](const PowderState& now) {
      if (now.points.size() < stop) return;
      saved = now;
      throw Stop();
    };
    EXPECT_THROW((void)run_powder(first, spec, phases, {}, control), Stop);
    const PowderResult again = run_powder(saved, spec, phases, {});
    EXPECT_TRUE(again.usable);
    expect_same_bits(whole, saved);
    EXPECT_EQ(whole.snapshots.position, saved.snapshots.position);
  }
}

/// Consolidation is plastic: what a pressure has closed stays closed without it. Taken up again anywhere, the same
/// bits.
TEST(PowderAssembly, PressuresComeOneAfterTheOther) {
  PowderSpec spec = small(1e4);
  spec.rolling = true;
  PowderProtocol protocol = method(1);
  protocol.pressures = {0.1, 1.0, 10.0, 0.1};
  spec.pressure = protocol.pressures.back();
  const auto phases = powder_phases(spec, protocol);
  ASSERT_EQ(phases.size(), 4U);
  EXPECT_EQ(phases[2].name, "load");
  EXPECT_EQ(phases[3].name, "unload");
  PowderState s = start_powder(spec, 5, 0);
  const PowderResult r = run_powder(s, spec, phases, {});
  ASSERT_TRUE(r.usable) << r.reason;
  ASSERT_EQ(s.stages.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(s.stages[k].pressure, protocol.pressures[k]);
    EXPECT_GT(s.stages[k].bulk, 0.0);
    EXPECT_GT(s.stages[k].shear, 0.0);
  }
  EXPECT_GT(s.stages[1].fraction, s.stages[0].fraction);
  EXPECT_GT(s.stages[2].fraction, s.stages[1].fraction);
  EXPECT_LT(s.stages[3].fraction, s.stages[2].fraction);
  EXPECT_GT(s.stages[3].fraction, s.stages[0].fraction + 0.4 * (s.stages[2].fraction - s.stages[0].fraction));
  EXPECT_NEAR(r.stress[0], 0.1, 1e-4);
  PowderState first = start_powder(spec, 5, 0);
  PowderState saved;
  RunControl<PowderState> control;
  control.save = [&](const PowderState& now) {
    saved = now;
    if (now.stages.size() == 2) throw Stop();
  };
  EXPECT_THROW((void)run_powder(first, spec, phases, {}, control), Stop);
  (void)run_powder(saved, spec, phases, {});
  expect_same_bits(s, saved);
  ASSERT_EQ(saved.stages.size(), 4U);
  EXPECT_EQ(saved.stages[3].fraction, s.stages[3].fraction);
  EXPECT_EQ(saved.stages[1].bulk, s.stages[1].bulk);
}

TEST(PowderAssembly, AStateAtItsEndIsOnlyLookedAt) {
  const PowderSpec spec = small(1e3);
  const auto phases = powder_phases(spec, method(1));
  PowderState s = start_powder(spec, 3, 0);
  const PowderResult r = run_powder(s, spec, phases, {});
  const PowderState copy = s;
  const PowderResult again = run_powder(s, spec, phases, {}, {.save = [](const PowderState&) { FAIL(); }});
  expect_same_bits(copy, s);
  EXPECT_TRUE(again.usable);
  EXPECT_EQ(again.fraction, r.fraction);
  EXPECT_NEAR(again.stress[0], r.stress[0], 1e-9);
}

}  // namespace
}  // namespace softgrain
