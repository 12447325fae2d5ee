// What shear leaves behind in cells: springs that yield one after another, onsets and strengths that move; forces
// against derivatives of the energy, and no cycle that gains any.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <vector>

#include "common/core/error.h"
#include "common/core/parallel_tasks.h"
#include "common/io/hdf5_file.h"
#include "macrosim/cell_matter/material_point.h"
#include "macrosim/cell_specimen.h"
#include "tests/support/cell_samples.h"
#include "tests/support/temporary_directory.h"

namespace softgrain {
namespace {

constexpr double kMu = 0.5;

/// Numbers about as found on power-law packings of mu = 0.3.
ShearMemory sample_memory() { return {1.1, 0.95, 20.0, 0.6, 0.0, 1e-3}; }

/// Cells of one onset and one state, loose (pores above the critical ones) or dense.
CellPacking packing_with(const ShearMemory& memory, double onset, double pressure, int cells = 30,
                         std::uint64_t index = 8, double mu = kMu) {
  const CellSample s = cell_sample(cells, 0.42, true, index);
  const PorosityForm equation{0.034, 1.5};
  const double x = state_at(equation, pressure);
  const double phi = onset + x * (1.0 - onset);
  constexpr double kCritical = 0.62;
  std::vector<CellContent> content;
  for (const double v : s.volume)
    content.push_back({phi * v, phi * v * (1.0 - onset) / onset, phi * v * (1.0 - kCritical) / kCritical});
  return {CellLaw{equation, {}, {mu, 3.0}, memory}, s.sites, content, s.cell};
}

double mean_pressure(const CellPoint& p) { return (p.stress[0][0] + p.stress[1][1] + p.stress[2][2]) / 3.0; }

double mean_onset(const CellPacking& p) {
  double solid = 0.0;
  double pores = 0.0;
  for (const CellContent& c : p.content()) {
    solid += c.solid;
    pores += c.pores;
  }
  return solid / (solid + pores);
}

/// Shear at constant volume, in steps of a quarter of a percent.
CellPoint shear(CellPacking& p, int steps, double way = 1.0, double step = 2.5e-3) {
  CellPoint point;
  for (int n = 0; n < steps; ++n)
    point = p.strain({{std::exp(0.5 * way * step), std::exp(0.5 * way * step), std::exp(-way * step)}});
  return point;
}

TEST(Backbone, SumsAreOneAndTheCurveIsAHyperbola) {
  const Backbone& b = backbone();
  double share = 0.0;
  double limit = 0.0;
  for (std::size_t s = 0; s < kFaceSprings; ++s) {
    share += b.share[s];
    limit += b.share[s] * b.yield[s];
  }
  EXPECT_NEAR(share, 1.0, 1e-14);
  EXPECT_NEAR(limit, 1.0, 1e-14);
  EXPECT_NEAR(b.share[2], 0.3921, 1e-4);
  EXPECT_NEAR(b.yield[2], 0.7040, 1e-4);
  for (const double g : {0.05, 0.3, 1.0, 3.0, 20.0}) {
    const PulledSprings pulled = pull({}, 0.0, 2.0, {{g / 2.0, 0.0, 0.7}}, {{0.0, 0.0, 1.0}}, 1.0);
    EXPECT_NEAR(-pulled.sum[0], g / std::hypot(1.0, g), 0.035) << g;
    EXPECT_EQ(pulled.sum[2], 0.0);
    EXPECT_EQ(pulled.slides, g > 10.0);
  }
}

/// Masing: the way back has twice the scale of the first one, and a closed cycle ends where it began.
TEST(Backbone, ReversalsHaveTwiceTheScale) {
  const Vec3 normal{{0.0, 0.0, 1.0}};
  const auto moved = [&](const PulledSprings& from, double g) {
    return pull(from.force, 1.0, 1.0, {{g, 0.0, 0.0}}, normal, 1.0);
  };
  const PulledSprings up = moved({}, 2.0);
  for (const double g : {0.1, 0.5, 1.7}) {
    const double first = moved({}, g).sum[0];
    EXPECT_NEAR(moved(up, -2.0 * g).sum[0] - up.sum[0], -2.0 * first, 1e-14) << g;
  }
  PulledSprings cycle = moved(moved(up, -4.0), 4.0);
  EXPECT_NEAR(cycle.sum[0], up.sum[0], 1e-14);
  // All slip beyond the last limit is work of the whole friction.
  const PulledSprings far = moved({}, 12.0);
  const FaceSlip slip = slip_of(far.sum, 1.0, moved(far, 2.0).sum, 1.0, {{2.0, 0.0, 0.0}}, normal);
  EXPECT_NEAR(slip.slip, 2.0, 1e-12);
  EXPECT_NEAR(slip.work, 2.0, 1e-12);
}

TEST(Backbone, AStiffnessThatChangesKeepsTheDisplacement) {
  const Vec3 normal{{0.0, 0.0, 1.0}};
  const PulledSprings one = pull({}, 0.0, 2.0, {{0.3, 0.1, 0.0}}, normal, 1.0);
  for (const double k : {0.5, 2.0, 7.0}) {
    const PulledSprings changed = pull(one.force, 2.0, k, {}, normal, 100.0);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(changed.sum[c], one.sum[c] * k / 2.0, 1e-14);
    EXPECT_NEAR(changed.energy, one.energy * k / 2.0, 1e-14);
    EXPECT_NEAR(slip_of(one.sum, 2.0, changed.sum, k, {}, normal).slip, 0.0, 1e-15);
  }
  EXPECT_EQ(norm(pull(one.force, 2.0, 0.0, {}, normal, 1.0).sum), 0.0);
}

TEST(ShearMemory, SlipCompactsBelowTheCriticalRatioAndDilatesAboveIt) {
  const ShearMemory m = sample_memory();
  const CellContent loose{0.6, 0.4, 0.37};
  const double critical = 1.5 * kMu;
  EXPECT_EQ(m.pores_after(kMu, loose, 0.9, 0.0, 0.0), loose.pores);
  EXPECT_NEAR(m.pores_after(kMu, loose, 0.9, 0.01, critical * 0.01), loose.pores, 1e-12);
  const double onset = 0.6 * (1.0 + 1.1 * (critical * 0.01 - 0.3 * 0.01));
  EXPECT_NEAR(m.pores_after(kMu, loose, 0.9, 0.01, 0.3 * 0.01), 0.6 / onset - 0.6, 1e-12);
  EXPECT_GT(m.pores_after(kMu, loose, 0.9, 0.01, 1.2 * 0.01), loose.pores);
  // Not beyond the least state.
  const double least = 0.6 / 0.99;
  const double held = m.pores_after(kMu, loose, least, 1.0, 0.0);
  EXPECT_NEAR((0.6 / least - 0.6 / (0.6 + held)) / (1.0 - 0.6 / (0.6 + held)), m.least_state, 1e-12);
  EXPECT_EQ((ShearMemory{0.0, 0.95, 20.0, 0.6, 0.0, 0.0}.pores_after(kMu, loose, 0.9, 0.01, 0.0)), loose.pores);
}

TEST(ShearMemory, StrengthFollowsTheDistanceFromTheCriticalState) {
  const ShearMemory m = sample_memory();
  EXPECT_NEAR(m.strength(kMu, {0.6, 0.37, 0.37}, 0.9), kMu, 1e-12);
  const double psi = (0.6 / 0.97 - 0.6) / (1.0 - 0.6 / 0.97);
  EXPECT_NEAR(m.strength(kMu, {0.6, 0.4, 0.37}, 0.9), kMu * (1.0 - 0.6 * std::tanh(20.0 * psi / 0.6)), 1e-12);
  EXPECT_GT(m.strength(kMu, {0.6, 0.3, 0.37}, 0.85), kMu);
  EXPECT_LT(m.strength(kMu, {0.6, 0.3, 0.37}, 0.85), 1.6 * kMu);
  // Nearly unjammed and loose: the critical strength.
  EXPECT_NEAR(m.strength(kMu, {0.6, 0.4, 0.37}, 0.9999), kMu, 1e-12);
}

/// Pressure, stiffness, energy and hardening belong together in every part of the curve, and go on through the ends of
/// its parts.
TEST(ShearMemory, ACellThatIsMadeRoomForKeepsSomePressure) {
  const EquationOfState equation = PorosityForm{0.034, 1.5};
  const CellContent c{0.6, 0.4, 0.4};
  constexpr double kTail = 0.01;
  const PoreGuard guard{0.9};
  const auto at = [&](double volume) { return respond(equation, guard, c, volume, kTail); };
  for (const double v : {0.93, 0.97, 0.98, 0.99, 0.9975, 1.0, 1.01, 1.1}) {
    const double h = 1e-6;
    const CellResponse up = at(v + h);
    const CellResponse down = at(v - h);
    const CellResponse r = at(v);
    EXPECT_GT(r.pressure, 0.0) << v;
    EXPECT_GT(r.stiffness, 0.0) << v;
    EXPECT_NEAR((down.energy - up.energy) / (2.0 * h) / r.pressure, 1.0, 1e-4) << v;
    EXPECT_NEAR((down.pressure - up.pressure) / (2.0 * h) / r.stiffness, 1.0, 1e-4) << v;
    EXPECT_NEAR((up.stiffness - down.stiffness) / (2.0 * h) / r.hardening, 1.0, 1e-3) << v;
  }
  EXPECT_EQ(respond(equation, guard, c, 1.01).pressure, 0.0) << "without it";
  EXPECT_NEAR(at(0.95).pressure, respond(equation, guard, c, 0.95).pressure, 1e-15) << "above it nothing changes";
}

/// Cells of different onsets that lose their pressure one after another reach equilibrium all the same.
TEST(ShearMemoryCells, CollapseToAPressureThatStays) {
  CellSample s = cell_sample(40, 0.42, true, 4);
  s.law.equation = PorosityForm{0.0446, 1.666};
  s.law.void_ratio = 0.7143;
  s.law.excess = {0.658, 0.4187, 0.313};
  s.law.critical_pores = 0.916;
  const CellStart start = start_at_pressure(s.law, s.bodies, s.volume, 0.8 * s.fines, 1e-4);
  const ShearMemory memory{0.95, 0.916, 14.1, 0.85, 0.0, 1.3e-3};
  CellPacking p(CellLaw{s.law.equation, {}, {0.567, 2.46}, memory}, s.sites, start.content, s.cell);
  CellPoint point;
  for (int n = 0; n < 20; ++n) {
    point = p.strain({{std::exp(3e-3), 1.0, std::exp(-3e-3)}}, {.tolerance = 1e-2});
    ASSERT_EQ(point.relaxation.end, RelaxationEnd::converged) << n;
    EXPECT_LT(point.tessellations, 150) << n;
  }
  EXPECT_LT(mean_pressure(point), 1e-5);
  EXPECT_GT(mean_pressure(point), 2e-7);
}

/// Springs that hold without slipping: all of the energy is that of the state, so its derivatives are forces and
/// stress, their stiffening with pressure included.
class HoldingSprings : public ::testing::Test {
 protected:
  HoldingSprings() : s_(cell_sample(25, 0.42, true, 4)) {
    RandomStream random(3, RandomPurpose::test, 9);
    for (const double v : s_.volume) {
      const double pores = 0.40 * v / (1.1 - 0.1 * random.uniform());
      content_.push_back({0.62 * v, pores, pores});
    }
    law_ = {PorosityForm{0.034, 1.5}, {}, {1e5, 3.0}, sample_memory()};
    springs_.keep(forces(s_.sites, s_.cell).trial);
    for (auto& one : s_.sites)
      for (int k = 0; k < 3; ++k) one.x[k] += 0.02 * (random.uniform() - 0.5);
    for (auto& one : s_.sites) one.x = wrapped(one.x, s_.cell);
    SpringSet now = forces(s_.sites, s_.cell).trial;
    const RadicalCells cells = radical_cells(s_.sites, s_.cell);
    for (std::size_t f = 0; f < now.springs.size(); ++f) {
      const double shape = cells.faces[f].area / cells.faces[f].distance;
      now.springs[f].stiffness *= shape / now.springs[f].shape;
      now.springs[f].shape = shape;
    }
    springs_.keep(now);
  }
  [[nodiscard]] CellForces forces(const std::vector<Sphere<3>>& sites, const Cell<3>& cell) const {
    const RadicalCells cells = radical_cells(sites, cell);
    return cell_forces(law_, content_, sites, cells, cell.volume(), face_keys(cells), springs_);
  }
  [[nodiscard]] double energy(std::vector<Sphere<3>> sites, const Cell<3>& cell) const {
    for (auto& one : sites) one.x = wrapped(one.x, cell);
    const CellForces f = forces(sites, cell);
    return f.energy + f.spring_energy;
  }

  CellSample s_;
  CellLaw law_;
  std::vector<CellContent> content_;
  FaceSprings springs_;
};

TEST_F(HoldingSprings, ForcesAreDerivativesOfTheEnergy) {
  const CellForces f = forces(s_.sites, s_.cell);
  for (const FaceSpring& one : f.trial.springs) ASSERT_EQ(one.yields, 0.0);
  EXPECT_GT(f.spring_energy, 0.01 * f.energy);
  double springs = 0.0;
  for (std::size_t i = 0; i < s_.sites.size(); ++i)
    springs = std::max(springs, f.pressure[i] / f.response[i].pressure - 1.0);
  EXPECT_GT(springs, 0.01) << "the part of the springs in the pressure is tested";
  for (std::size_t i = 0; i < s_.sites.size(); i += 3)
    for (int k = 0; k < 3; ++k) {
      const double h = 1e-6;
      auto up = s_.sites;
      auto down = s_.sites;
      up[i].x[k] += h;
      down[i].x[k] -= h;
      EXPECT_NEAR(f.force[i][k], (energy(down, s_.cell) - energy(up, s_.cell)) / (2.0 * h), 2e-5 * f.mean_load)
          << i << " " << k;
    }
}

TEST_F(HoldingSprings, StressDoesTheWorkOfTheEnergy) {
  const CellForces f = forces(s_.sites, s_.cell);
  const double p = (f.stress[0][0] + f.stress[1][1] + f.stress[2][2]) / 3.0;
  for (int k = 0; k < 3; ++k) {
    const auto at = [&](double e) {
      auto sites = s_.sites;
      Cell<3> cell = s_.cell;
      cell.edges[k] += s_.cell.edges[k] * e;
      for (auto& one : sites) one.x[k] += e * one.x[k];
      return energy(sites, cell);
    };
    const double h = 1e-6;
    EXPECT_NEAR(f.stress[k][k], (at(-h) - at(h)) / (2.0 * h * s_.cell.volume()), 1e-5 * p) << k;
  }
}

TEST(ShearMemoryCells, WithoutDilatancyAndStrengthNothingMoves) {
  CellPacking p = packing_with({0.0, 1.0, 0.0, 0.5, 0.0, 0.0}, 0.60, 1e-3);
  const double before = mean_onset(p);
  const double pressure = mean_pressure(shear(p, 12));
  EXPECT_EQ(mean_onset(p), before);
  EXPECT_NEAR(pressure / 1e-3, 1.0, 0.05);
}

TEST(ShearMemoryCells, AtConstantVolumeLooseMatterLosesItsPressureAndDenseMatterGainsIt) {
  CellPacking loose = packing_with(sample_memory(), 0.600, 1e-4);
  CellPacking dense = packing_with(sample_memory(), 0.645, 1e-4);
  const CellPoint weak = shear(loose, 16);
  const CellPoint strong = shear(dense, 16);
  EXPECT_LT(mean_pressure(weak), 0.2e-4);
  EXPECT_GT(mean_pressure(strong), 3e-4);
  EXPECT_GT(mean_onset(loose), 0.604);
  EXPECT_LT(mean_onset(dense), 0.640);
  const auto ratio = [](const CellPoint& q) { return (q.stress[2][2] - q.stress[0][0]) / mean_pressure(q); };
  EXPECT_GT(ratio(strong), 0.8);
}

/// Stress against a step twice and four times as large: what a part of a strain leaves counts from the next part on.
TEST(ShearMemoryCells, StrainStepsOfAnySizeEndAtNearlyTheSameStress) {
  CellPacking fine = packing_with(sample_memory(), 0.610, 1e-3);
  CellPacking one = packing_with(sample_memory(), 0.610, 1e-3);
  const CellPoint a = shear(fine, 32, 1.0, 1.25e-3);
  const CellPoint b = shear(one, 1, 1.0, 0.04);
  EXPECT_NEAR(b.stress[2][2] / a.stress[2][2], 1.0, 0.03);
  EXPECT_NEAR(b.stress[0][0] / a.stress[0][0], 1.0, 0.03);
}

class ShearMemoryCycles : public testing::TestWithParam<std::tuple<double, double>> {};

/// Random strains and back: the work of the boundary is never less than the energy that is there.
TEST_P(ShearMemoryCycles, NeverGainEnergy) {
  const auto [onset, amplitude] = GetParam();
  CellPacking p = packing_with(sample_memory(), onset, 1e-3, 20, 3);
  RandomStream random(5, RandomPurpose::test, 77);
  const double start = p.now().energy;
  Matrix<3> stress = p.now().stress;
  double volume = p.now().volume;
  double work = 0.0;
  double turned_over = 0.0;
  std::vector<Vec3> corners;
  for (int n = 0; n < 4; ++n) {
    Vec3 c;
    for (int k = 0; k < 3; ++k) c[k] = amplitude * (2.0 * random.uniform() - 1.0);
    corners.push_back(c);
  }
  corners.emplace_back();
  Vec3 at;
  double least = 0.0;
  for (const Vec3& corner : corners) {
    const double length = norm(corner - at);
    const int steps = std::max(2, static_cast<int>(std::ceil(length / 1.25e-3)));
    const Vec3 part = (corner - at) * (1.0 / steps);
    for (int n = 0; n < steps; ++n) {
      const CellPoint point =
          p.strain({{std::exp(part[0]), std::exp(part[1]), std::exp(part[2])}}, {.tolerance = 1e-4});
      EXPECT_EQ(point.relaxation.end, RelaxationEnd::converged);
      for (int k = 0; k < 3; ++k) {
        const double one = -0.5 * (stress[k][k] * volume + point.stress[k][k] * point.volume) * part[k];
        work += one;
        turned_over += std::abs(one);
      }
      stress = point.stress;
      volume = point.volume;
      least = std::min(least, work - (point.energy - start));
    }
    at = corner;
  }
  EXPECT_GT(work - (p.now().energy - start), 3e-4 * turned_over);
  EXPECT_GT(least, -1e-3 * turned_over);
}
INSTANTIATE_TEST_SUITE_P(LooseAndDense, ShearMemoryCycles,
                         testing::Combine(testing::Values(0.60, 0.64), testing::Values(0.002, 0.01)));

TEST(ShearMemoryCells, GoOnWithTheSameBitsFromAFile) {
  const test::TemporaryDirectory directory;
  CellPacking p = packing_with(sample_memory(), 0.61, 1e-3);
  shear(p, 3);
  {
    h5::AtomicFile file(directory.file("state.h5"));
    write_cell_state(file.root(), p.state());
    file.commit();
  }
  const CellState state = read_cell_state(h5::open_file(directory.file("state.h5")));
  const CellLaw law{PorosityForm{0.034, 1.5}, {}, {kMu, 3.0}, sample_memory()};
  CellPacking again(law, state, true);
  EXPECT_EQ(shear(again, 3, -1.0).stress, shear(p, 3, -1.0).stress);
  BoxControl control;
  control.by_stress = {true, true, false};
  control.stress = {{1.2e-3, 1.2e-3, 0.0}};
  again = CellPacking(law, p.state(), true);
  EXPECT_EQ(again.press({{1.0, 1.0, 0.99}}, control).stress, p.press({{1.0, 1.0, 0.99}}, control).stress);
  // A law that forgets does not go on from it, nor this one from a state without memory.
  EXPECT_THROW(CellPacking(CellLaw{law.equation, {}, law.friction}, state, true), IoError);
  CellState forgetful = state;
  forgetful.strength.clear();
  forgetful.next_pores.clear();
  EXPECT_THROW(CellPacking(law, forgetful, true), IoError);
}

/// So many that their springs are tried on several threads.
TEST(ShearMemoryCells, AreTheSameBitsForAnyNumberOfThreads) {
  const int before = omp_get_max_threads();
  std::vector<CellState> ends;
  for (const int threads : {1, 2, 3, 5, 8}) {
    omp_set_num_threads(threads);
    CellPacking p = packing_with(sample_memory(), 0.61, 1e-3, 620);
    (void)shear(p, 1);
    ends.push_back(p.state());
  }
  omp_set_num_threads(before);
  const CellState& one = ends.front();
  ASSERT_GT(one.springs.springs.size(), kParallelLength);
  for (const CellState& many : ends) {
    EXPECT_EQ(one.stress, many.stress);
    EXPECT_EQ(one.strength, many.strength);
    EXPECT_EQ(one.next_pores, many.next_pores);
    EXPECT_EQ(one.springs.parts, many.springs.parts);
  }
}

TEST(ShearMemoryCells, HoldTheStressThatIsAsked) {
  CellPacking p = packing_with(sample_memory(), 0.605, 1e-3);
  BoxControl control;
  control.by_stress = {true, true, false};
  control.stress = {{1e-3, 1e-3, 0.0}};
  CellPoint point;
  for (int n = 0; n < 4; ++n) point = p.press({{1.0, 1.0, 0.99}}, control);
  EXPECT_EQ(point.relaxation.end, RelaxationEnd::converged);
  EXPECT_NEAR(point.stress[0][0] / 1e-3, 1.0, 2e-3);
  EXPECT_NEAR(point.stress[1][1] / 1e-3, 1.0, 2e-3);
  EXPECT_GT(point.stress[2][2], 1.3e-3);
}

/// A stress asked for at once is gone to in parts that strain little: strength does not depend on the steps.
TEST(ShearMemoryCells, AStressInOneStepGivesTheStrainOfMany) {
  const auto axial_strain = [](int steps) {
    CellPacking p = packing_with(sample_memory(), 0.605, 1e-3);
    const double before = p.room().high()[2] - p.room().low()[2];
    BoxControl control;
    control.by_stress = {true, true, true};
    for (int n = 1; n <= steps; ++n) {
      control.stress = {{1e-3, 1e-3, 1e-3 + 5e-4 * n / steps}};
      EXPECT_EQ(p.press({{1.0, 1.0, 1.0}}, control).relaxation.end, RelaxationEnd::converged) << n << " of " << steps;
    }
    return std::log(before / (p.room().high()[2] - p.room().low()[2]));
  };
  const double many = axial_strain(16);
  EXPECT_GT(many, 4.0 * kMemoryStrain) << "else nothing is tested";
  EXPECT_NEAR(axial_strain(1) / many, 1.0, 0.1);
}

/// A material point against an independent program of the same equations, whose parts of a strain follow each other in
/// another way.
TEST(MaterialPoint, GivesTheNumbersOfAnotherProgram) {
  const PorosityForm equation{0.0336, 1.495};
  const CellLaw law{equation, {}, {0.506, 3.05}, ShearMemory{1.18, 0.95, 35.0, 0.666, 0.0, 0.0016}};
  const double x = state_at(equation, 1e-4);
  const MaterialPoint start(law, 0.6 + 0.4 * x, 0.6, 0.617);
  const auto pressure = [](const Vec3& s) { return (s[0] + s[1] + s[2]) / 3.0; };
  const auto ratio = [&](const Vec3& s) { return (s[2] - 0.5 * (s[0] + s[1])) / pressure(s); };
  MaterialPoint pressed = start;
  pressed.strain({{0.0, 0.0, -std::log(0.96)}});
  EXPECT_NEAR(pressure(pressed.stress()) / 5.794e-4, 1.0, 0.03);
  EXPECT_NEAR(ratio(pressed.stress()) / 0.3173, 1.0, 0.03);
  pressed.strain({{0.0, 0.0, -std::log(0.92 / 0.96)}});
  EXPECT_NEAR(pressure(pressed.stress()) / 1.519e-3, 1.0, 0.03);
  EXPECT_NEAR(pressed.onset(), 0.6132, 5e-4);
  MaterialPoint sheared = start;
  sheared.strain({{0.5 * std::log(0.99), 0.5 * std::log(0.99), -std::log(0.99)}});
  EXPECT_NEAR(std::log(pressure(sheared.stress()) / 4.75e-5), 0.0, 0.25) << "while it collapses";
  EXPECT_NEAR(ratio(sheared.stress()) / 0.2713, 1.0, 0.03);
  MaterialPoint triaxial = start;
  EXPECT_TRUE(triaxial.strain_at(-std::log(0.92), 1e-4));
  EXPECT_NEAR(triaxial.stress()[0] / 1e-4, 1.0, 1e-5);
  EXPECT_NEAR(triaxial.stress()[1], triaxial.stress()[0], 1e-15);
  EXPECT_NEAR(ratio(triaxial.stress()) / 0.6396, 1.0, 0.03);
  EXPECT_NEAR(triaxial.solid_fraction(), 0.62475, 5e-4);
}

/// Cells that are all alike at first, and the point that stands for them: what motion that is not affine makes.
TEST(MaterialPoint, IsTheMeanFieldOfCells) {
  CellPacking cells = packing_with(sample_memory(), 0.605, 1e-4, 60);
  const CellLaw law{PorosityForm{0.034, 1.5}, {}, {kMu, 3.0}, sample_memory()};
  const double x = state_at(law.equation, 1e-4);
  MaterialPoint point(law, 0.605 + 0.395 * x, 0.605, 0.62);
  EXPECT_NEAR(point.stress()[1] / 1e-4, 1.0, 1e-9);
  CellPoint c;
  for (int n = 0; n < 4; ++n) {
    c = cells.strain({{1.0, 1.0, 0.99}});
    point.strain({{0.0, 0.0, -std::log(0.99)}});
  }
  const Vec3 s = point.stress();
  EXPECT_NEAR(mean_pressure(c) / ((s[0] + s[1] + s[2]) / 3.0), 1.0, 0.12);
  EXPECT_NEAR(c.stress[0][0] / c.stress[2][2] / (s[0] / s[2]), 1.0, 0.05);
  EXPECT_NEAR(mean_onset(cells), point.onset(), 1e-3);
  EXPECT_THROW(MaterialPoint(CellLaw{law.equation, {}, law.friction}, 0.62, 0.6, 0.62), InputError);
  EXPECT_THROW(MaterialPoint(law, 1.2, 0.6, 0.62), InputError);
}

TEST(ShearMemoryCells, RefuseNumbersThatAreNoLaw) {
  const auto refused = [](const ShearMemory& m, double mu = kMu) {
    EXPECT_THROW(packing_with(m, 0.61, 1e-3, 20, 3, mu), InputError);
  };
  refused({-0.1, 0.95, 20.0, 0.6, 0.0, 0.0});
  refused({1.0, 0.0, 20.0, 0.6, 0.0, 0.0});
  refused({1.0, 0.95, NAN, 0.6, 0.0, 0.0});
  refused({1.0, 0.95, 20.0, 1.0, 0.0, 0.0});
  refused({1.0, 0.95, 20.0, 0.6, 0.0, 1.0});
  refused({2.7, 0.95, 20.0, 0.6, 0.0, 0.0});  // slip of the strongest faces would give energy back
  refused({1.0, 0.95, 20.0, 0.6, 0.0, 0.0}, 0.0);
  const CellLaw pores{PoreForm{0.03, 2.0}, {}, {kMu, 3.0}, sample_memory()};
  EXPECT_THROW(MaterialPoint(pores, 0.62, 0.6, 0.62), InputError);
}

}  // namespace
}  // namespace softgrain
