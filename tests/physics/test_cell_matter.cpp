// Matter in cells: forces and stress against derivatives of the energy, uniform strain, friction that only takes
// energy.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <vector>

#include "common/core/error.h"
#include "common/core/parallel_tasks.h"
#include "tests/support/cell_samples.h"

namespace softgrain {
namespace {

struct Scattered {
  CellLaw law;
  std::vector<CellContent> content;
};

/// Cells of one solid fraction with pores that scatter, so that pressures differ; some cells bear nothing.
Scattered scattered(const CellSample& s, const std::vector<double>& volume) {
  RandomStream random(3, RandomPurpose::test, 9);
  Scattered out{{s.law.equation, {}, {}}, {}};
  for (const double v : volume) out.content.push_back({0.72 * v, 0.28 * v / (1.1 - 0.5 * random.uniform())});
  return out;
}

double energy_of(const Scattered& m, const std::vector<Sphere<3>>& sites, const RadicalCells& cells, double volume) {
  return cell_forces(m.law, m.content, sites, cells, volume, face_keys(cells), {}).energy;
}

class CellMatter : public testing::TestWithParam<bool> {};

TEST_P(CellMatter, ForceIsTheDerivativeOfTheEnergy) {
  const CellSample s = cell_sample(25, 0.42, GetParam(), 4);
  const Scattered m = scattered(s, s.volume);
  const auto energy = [&](std::vector<Sphere<3>> sites) {
    for (auto& one : sites) one.x = wrapped(one.x, s.cell);
    return energy_of(m, sites, radical_cells(sites, s.cell), s.cell.volume());
  };
  const RadicalCells cells = radical_cells(s.sites, s.cell);
  const CellForces f = cell_forces(m.law, m.content, s.sites, cells, s.cell.volume(), face_keys(cells), {});
  EXPECT_GT(f.residual(), 0.1);
  Vec3 sum;
  for (std::size_t i = 0; i < s.sites.size(); ++i) {
    sum += f.force[i];
    for (int k = 0; k < 3; ++k) {
      const double h = 1e-5;
      auto up = s.sites;
      auto down = s.sites;
      up[i].x[k] += h;
      down[i].x[k] -= h;
      EXPECT_NEAR(f.force[i][k], (energy(down) - energy(up)) / (2.0 * h), 1e-6 * f.mean_load) << i << " " << k;
    }
  }
  EXPECT_LT(norm(sum), 1e-10 * f.mean_load);
}

/// Virtual work: dU = -V sigma : d(epsilon) when cell and sites follow one strain, for all components that keep the
/// edges upper triangular.
TEST_P(CellMatter, StressDoesTheWorkOfTheEnergy) {
  CellSample s = cell_sample(25, 0.42, GetParam(), 5);
  s.cell.edges[0][1] = 0.2 * s.cell.edges[0][0];
  s.cell.edges[1][2] = -0.3 * s.cell.edges[0][0];
  for (auto& one : s.sites) one.x = wrapped(one.x, s.cell);
  const Scattered m = scattered(s, radical_cells(s.sites, s.cell).volume);
  const auto energy = [&](int k, int l, double e) {
    auto sites = s.sites;
    Cell<3> cell = s.cell;
    cell.edges[k] += s.cell.edges[l] * e;
    for (auto& one : sites) one.x[k] += e * one.x[l];
    return energy_of(m, sites, radical_cells(sites, cell), cell.volume());
  };
  const RadicalCells cells = radical_cells(s.sites, s.cell);
  const CellForces f = cell_forces(m.law, m.content, s.sites, cells, s.cell.volume(), face_keys(cells), {});
  const double p = (f.stress[0][0] + f.stress[1][1] + f.stress[2][2]) / 3.0;
  for (int k = 0; k < 3; ++k)
    for (int l = k; l < 3; ++l) {
      const double h = 1e-5;
      const double work = (energy(k, l, -h) - energy(k, l, h)) / (2.0 * h * s.cell.volume());
      EXPECT_NEAR(f.stress[k][l], work, 1e-6 * p) << k << l;
      EXPECT_NEAR(f.stress[k][l], f.stress[l][k], 1e-9 * p) << k << l;
    }
  EXPECT_GT(std::abs(f.stress[0][1]), 1e-3 * p);
}

TEST_P(CellMatter, BetweenPlanesWallsBearWhatTheEnergySays) {
  const CellSample s = cell_sample(25, 0.42, GetParam(), 6);
  const PlaneBox box{{}, {{s.cell.edges[0][0], s.cell.edges[1][1], s.cell.edges[2][2]}}};
  const RadicalCells cells = radical_cells(s.sites, box);
  const Scattered m = scattered(s, cells.volume);
  const CellForces f = cell_forces(m.law, m.content, s.sites, cells, box.volume(), face_keys(cells), {});
  const std::array<double, 6> loads = wall_loads(cells, f.pressure);
  Vec3 sum;
  for (const Vec3& one : f.force) sum += one;
  for (int k = 0; k < 3; ++k) {
    const auto u = static_cast<std::size_t>(2 * k);
    EXPECT_NEAR(sum[k], loads[u] - loads[u + 1], 1e-9 * loads[u]);
    const double h = 1e-5;
    const auto energy = [&](double move) {
      PlaneBox moved = box;
      moved.high[k] += move;
      return energy_of(m, s.sites, radical_cells(s.sites, moved), moved.volume());
    };
    EXPECT_NEAR(loads[u + 1], (energy(-h) - energy(h)) / (2.0 * h), 1e-6 * loads[u + 1]);
  }
  for (std::size_t i = 0; i < s.sites.size(); i += 5)
    for (int k = 0; k < 3; ++k) {
      const double h = 1e-5;
      auto up = s.sites;
      auto down = s.sites;
      up[i].x[k] += h;
      down[i].x[k] -= h;
      const double slope = (energy_of(m, down, radical_cells(down, box), box.volume()) -
                            energy_of(m, up, radical_cells(up, box), box.volume())) /
                           (2.0 * h);
      EXPECT_NEAR(f.force[i][k], slope, 1e-6 * f.mean_load);
    }
}

/// Equal cells under uniform strain: the equation of state, without a single relaxation pass; friction or not.
TEST_P(CellMatter, UniformStrainOfEqualCellsIsTheEquationOfState) {
  const Cell<3> cube = box_cell<3>({{2.0, 2.0, 2.0}}, {true, true, true});
  const FinesLaw fines = sample_fines(GetParam());
  const CellContent content{2.9, 1.1};
  for (const double coefficient : {0.0, 0.6}) {
    CellPacking lattice({fines.equation, {}, {coefficient, 1.0}},
                        {{Vec3{{0.1, 0.2, 0.3}}, 0.8}, {Vec3{{1.1, 1.2, 1.3}}, 0.8}}, {content, content}, cube);
    double volume = 4.0;
    for (int step = 0; step < 5; ++step) {
      const CellPoint point = lattice.strain({{0.99, 0.99, 0.99}});
      volume *= 0.99 * 0.99 * 0.99;
      const double p = respond(fines.equation, {}, content, volume).pressure;
      EXPECT_EQ(point.relaxation.end, RelaxationEnd::converged);
      EXPECT_EQ(point.relaxation.passes, 0);
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l) EXPECT_NEAR(point.stress[k][l] / p, k == l ? 1.0 : 0.0, 1e-11);
      EXPECT_EQ(point.sliding, 0.0);
    }
  }
}

/// Lattice under uniaxial strain, springs of known stiffness: sigma_zz - sigma_xx by hand.
TEST_P(CellMatter, SpringsFeelTheAffineMotionOfTheirFaces) {
  const Cell<3> cube = box_cell<3>({{2.0, 2.0, 2.0}}, {true, true, true});
  const FinesLaw fines = sample_fines(GetParam());
  const CellContent content{2.9, 1.1};
  const std::vector<Sphere<3>> sites{{Vec3{{0.1, 0.2, 0.3}}, 0.8}, {Vec3{{1.1, 1.2, 1.3}}, 0.8}};
  CellPacking lattice({fines.equation, {}, {1e3, 0.7}}, sites, {content, content}, cube);
  lattice.strain({{0.98, 0.98, 0.98}});
  const RadicalCells before = lattice.cells();
  const double e = 1e-6;
  const CellPoint point = lattice.strain({{1.0, 1.0, 1.0 - e}});
  const double volume = point.volume;
  const CellResponse r = respond(fines.equation, {}, content, 0.5 * volume);
  double expected = 0.0;
  for (const CellFace& f : lattice.cells().faces) {
    const double k = 0.7 * r.stiffness * 0.5 * volume * f.area / f.distance;
    const Vec3 n = f.separation * (1.0 / f.distance);
    const Vec3 motion{{0.0, 0.0, -e * f.separation[2]}};
    const Vec3 slip = motion - n * dot(motion, n);
    expected += -k * (slip[2] * f.separation[2] - slip[0] * f.separation[0]) / volume;
  }
  EXPECT_GT(expected, 0.01 * r.stiffness * e);
  EXPECT_NEAR((point.stress[2][2] - point.stress[0][0]) / expected, 1.0, 1e-4);
  EXPECT_NEAR(before.volume[0], 0.5 * volume / (1.0 - e), 1e-12);
}

struct Cycle {
  double work = 0.0;          ///< by the boundary
  double least_loss = 1e300;  ///< smallest rise of work - energy in one step
  double energy = 0.0;        ///< at the end, less that at the start
  double turned_over = 0.0;   ///< sum of |work| of the steps
};

/// There and back along one path of stretches; trapezoids in the logarithmic strain.
Cycle run_cycle(CellPacking& p, const Vec3& there, int steps, const CellRelaxation& options,
                bool first_compress = true) {
  Cycle out;
  const double start = p.now().energy;
  Matrix<3> stress = p.now().stress;
  double volume = p.now().volume;
  double energy = start;
  for (int n = 0; n < 2 * steps; ++n) {
    const bool go = (n < steps) == first_compress;
    Vec3 f;
    for (int k = 0; k < 3; ++k) f[k] = std::pow(there[k], (go ? 1.0 : -1.0) / steps);
    const CellPoint point = p.strain(f, options);
    EXPECT_EQ(point.relaxation.end, RelaxationEnd::converged);
    double work = 0.0;
    for (int k = 0; k < 3; ++k)
      work -= 0.5 * (stress[k][k] * volume + point.stress[k][k] * point.volume) * std::log(f[k]);
    out.work += work;
    out.turned_over += std::abs(work);
    out.least_loss = std::min(out.least_loss, work - (point.energy - energy));
    stress = point.stress;
    volume = point.volume;
    energy = point.energy;
  }
  out.energy = energy - start;
  return out;
}

TEST_P(CellMatter, WithoutFrictionACycleGivesBackItsWork) {
  const CellSample s = cell_sample(30, 0.42, GetParam(), 7);
  CellPacking p = packing_of(s, start_at_pressure(s.law, s.bodies, s.volume, s.fines, 5e-4), {0.0, 1.0});
  const double start = p.now().energy;
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(p.now().stress[k][k] / 5e-4, 1.0, 1e-9);  // all cells alike: at rest
  EXPECT_LT(p.forces().residual(), 1e-9);
  CellRelaxation exact;
  exact.tolerance = 1e-6;
  const Cycle cycle = run_cycle(p, {{1.0, 1.0, 0.95}}, 5, exact);
  EXPECT_NEAR(cycle.energy, 0.0, 1e-7 * start);
  EXPECT_NEAR(cycle.work, 0.0, 2e-3 * cycle.turned_over);
  EXPECT_NEAR(p.now().stress[0][0], 5e-4, 1e-8);
  // A fluid bears no shear.
  EXPECT_NEAR(p.now().stress[2][2], p.now().stress[0][0], 1e-8);
}

class CellFrictionCycles : public testing::TestWithParam<std::tuple<bool, int>> {};

TEST_P(CellFrictionCycles, NeverGainEnergy) {
  const auto [porosity, path] = GetParam();
  const CellSample s = cell_sample(30, 0.42, porosity, 8);
  CellPacking p = packing_of(s, start_at_pressure(s.law, s.bodies, s.volume, s.fines, 1e-3), {0.4, 1.0});
  const Vec3 there =
      std::array<Vec3, 2>{{{{1.0, 1.0, 0.96}}, {{1.02, 1.02, 1.0 / (1.02 * 1.02)}}}}[static_cast<std::size_t>(path)];
  CellRelaxation options;
  options.tolerance = 1e-3;
  for (int n = 0; n < 2; ++n) {
    const Cycle cycle = run_cycle(p, there, 10, options, n == 0 || path == 0);
    // Trapezoids of a step err by its square: far below what friction takes.
    EXPECT_GT(cycle.work - cycle.energy, 0.003 * cycle.turned_over) << n;
    EXPECT_GT(cycle.least_loss, -2e-4 * cycle.turned_over) << n;
  }
}
INSTANTIATE_TEST_SUITE_P(Paths, CellFrictionCycles, testing::Combine(testing::Bool(), testing::Values(0, 1)));

TEST_P(CellMatter, FrictionBearsShearAndLateralStressBelowTheAxialOne) {
  const CellSample s = cell_sample(60, 0.42, GetParam(), 9);
  CellPacking p = packing_of(s, start_at_pressure(s.law, s.bodies, s.volume, s.fines, 1e-4), {0.6, 1.0});
  CellPoint point;
  for (int n = 0; n < 5; ++n) point = p.strain({{1.0, 1.0, 0.99}});
  const double k0 = 0.5 * (point.stress[0][0] + point.stress[1][1]) / point.stress[2][2];
  EXPECT_GT(k0, 0.4);
  EXPECT_LT(k0, 0.65);
  EXPECT_EQ(point.guarded, 0);
  EXPECT_LT(point.tessellations, 200);
}

TEST_P(CellMatter, StrainStepsOfAnySizeEndAtTheSameStress) {
  const CellSample s = cell_sample(30, 0.42, GetParam(), 9);
  const CellStart start = start_at_pressure(s.law, s.bodies, s.volume, s.fines, 1e-4);
  CellPacking coarse = packing_of(s, start, {0.6, 1.0});
  CellPacking fine = packing_of(s, start, {0.6, 1.0});
  const CellPoint one = coarse.strain({{1.0, 1.0, 0.96}});
  CellPoint many;
  for (int n = 0; n < 8; ++n) many = fine.strain({{1.0, 1.0, std::pow(0.96, 1.0 / 8.0)}});
  EXPECT_NEAR(one.stress[2][2] / many.stress[2][2], 1.0, 5e-3);
  EXPECT_NEAR(one.stress[0][0] / many.stress[0][0], 1.0, 5e-3);
}

/// The same packing at another place of its cell: faces keep their springs while sites cross the boundary.
TEST_P(CellMatter, SpringsSurviveSitesThatCrossTheBoundary) {
  const CellSample s = cell_sample(30, 0.42, GetParam(), 10);
  const CellStart start = start_at_pressure(s.law, s.bodies, s.volume, s.fines, 1e-3);
  CellRelaxation options;
  options.tolerance = 1e-8;
  const auto curve_end = [&](const Vec3& shift) {
    CellSample moved = s;
    for (auto& one : moved.sites) one.x += shift;
    CellPacking p = packing_of(moved, start, {0.6, 1.0});
    for (int n = 0; n < 4; ++n) p.strain({{1.005, 1.0, 0.985}}, options);
    return p.now().stress;
  };
  const Matrix<3> here = curve_end({});
  // Sites 0 to 2 begin on a plane of the boundary each.
  const Matrix<3> there = curve_end(-Vec3{{s.sites[0].x[0], s.sites[1].x[1], s.sites[2].x[2]}});
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(there[k][k] / here[k][k], 1.0, 1e-5);
  EXPECT_GT(here[2][2] - here[0][0], 0.2 * here[2][2]);
}

/// So many that cells are joined, and springs are tried, on several threads.
TEST_P(CellMatter, IsTheSameBitsForAnyNumberOfThreads) {
  const CellSample s = cell_sample(620, 0.42, GetParam(), 11);
  const CellStart start = start_at_pressure(s.law, s.bodies, s.volume, s.fines, 1e-3);
  const int before = omp_get_max_threads();
  std::vector<CellPacking> ends;
  for (const int threads : {1, 2, 3, 5, 8}) {
    omp_set_num_threads(threads);
    ends.push_back(packing_of(s, start, {0.6, 1.0}));
    (void)ends.back().strain({{1.0, 1.0, 0.99}});
  }
  omp_set_num_threads(before);
  const CellPacking& one = ends.front();
  ASSERT_GT(one.cells().faces.size(), kParallelLength);
  for (const CellPacking& many : ends) {
    EXPECT_EQ(one.now().stress, many.now().stress);
    EXPECT_EQ(one.now().tessellations, many.now().tessellations);
    EXPECT_EQ(one.now().energy, many.now().energy);
    EXPECT_TRUE(one.cells().faces == many.cells().faces);
    EXPECT_EQ(one.forces().force, many.forces().force);
    for (std::size_t f = 0; f < one.forces().trial.springs.size(); ++f)
      ASSERT_EQ(one.forces().trial.springs[f].force, many.forces().trial.springs[f].force) << f;
  }
}

TEST_P(CellMatter, TheGuardHoldsCellsThatLoseTheirPoresAndCountsThem) {
  const CellSample s = cell_sample(30, 0.42, GetParam(), 12);
  CellPacking p = packing_of(s, start_at_pressure(s.law, s.bodies, s.volume, s.fines, 1e-3), {0.6, 1.0});
  CellPoint point;
  for (int n = 0; n < 12; ++n) point = p.strain({{0.993, 0.993, 0.993}});
  EXPECT_GT(point.guarded, 5);
  EXPECT_EQ(point.relaxation.end, RelaxationEnd::converged);
  const auto& volume = p.cells().volume;
  const auto start = start_at_pressure(s.law, s.bodies, s.volume, s.fines, 1e-3);
  for (std::size_t i = 0; i < volume.size(); ++i) EXPECT_GT(relative_pores(start.content[i], volume[i]), 0.02) << i;
  // One step to less room than the solid needs is refused and leaves the packing as it was.
  const double energy = p.now().energy;
  EXPECT_THROW(p.strain({{0.8, 0.8, 0.8}}), UnusableResult);
  EXPECT_EQ(p.now().energy, energy);
}

TEST(CellPackings, RefuseContentsThatDoNotFit) {
  const Cell<3> cube = box_cell<3>({{2.0, 2.0, 2.0}}, {true, true, true});
  const std::vector<Sphere<3>> two{{Vec3{{0.1, 0.2, 0.3}}, 0.8}, {Vec3{{1.1, 1.2, 1.3}}, 0.8}};
  const CellLaw law{PoreForm{0.03, 2.0}, {}, {}};
  EXPECT_THROW(CellPacking(law, two, {{2.9, 1.1}}, cube), InputError);
  EXPECT_THROW(CellPacking(law, two, {{2.9, 1.1}, {2.9, 0.0}}, cube), InputError);
  EXPECT_THROW(CellPacking(law, two, {{2.9, 1.1}, {4.5, 1.0}}, cube), InputError);
  EXPECT_THROW(CellPacking({PoreForm{0.03, 1.0}, {}, {}}, two, {{2.9, 1.1}, {2.9, 1.1}}, cube), InputError);
  EXPECT_THROW(CellPacking({PoreForm{0.03, 2.0}, {1.0}, {}}, two, {{2.9, 1.1}, {2.9, 1.1}}, cube), InputError);
  EXPECT_THROW(CellPacking({PoreForm{0.03, 2.0}, {}, {-0.1, 1.0}}, two, {{2.9, 1.1}, {2.9, 1.1}}, cube), InputError);
  CellPacking good(law, two, {{2.9, 1.1}, {2.9, 1.1}}, cube);
  EXPECT_THROW(good.strain({{1.0, 0.0, 1.0}}), InputError);
  EXPECT_THROW(good.strain({{1.0, NAN, 1.0}}), InputError);
}
INSTANTIATE_TEST_SUITE_P(BothForms, CellMatter, testing::Bool());

}  // namespace
}  // namespace softgrain
