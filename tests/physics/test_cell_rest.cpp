// Packings of cells on the way to rest: their tangent against differences of forces, mixed steps against Fire.
#include <gtest/gtest.h>

#include <cmath>

#include "macrosim/cell_matter/cell_steps.h"
#include "tests/support/cell_samples.h"

namespace softgrain {
namespace {

CellForces forces_of(const CellLaw& law, const std::vector<CellContent>& content, const std::vector<Sphere<3>>& sites,
                     const Cell<3>& cell, const FaceSprings& springs) {
  const RadicalCells cells = radical_cells(sites, cell);
  return cell_forces(law, content, sites, cells, cell.volume(), face_keys(cells), springs);
}

/// At rest, where all pressures are alike, nothing is left out: the answer to the forces that a small motion calls up
/// is that motion back, sliding faces aside.
TEST(CellTangent, TakesASmallMotionBack) {
  const CellSample s = cell_sample(25, 0.42, true, 4);
  const CellStart start = start_at_pressure(s.law, s.bodies, s.volume, s.fines, 1e-3);
  const CellLaw law{s.law.equation, {}, {10.0, 1.0}};
  FaceSprings springs;
  springs.keep(forces_of(law, start.content, s.sites, s.cell, {}).trial);
  auto moved = s.sites;
  RandomStream random(5, RandomPurpose::test, 1);
  std::vector<Vec3> motion(moved.size());
  Vec3 mean;
  for (Vec3& d : motion) {
    for (int k = 0; k < 3; ++k) d[k] = 1e-5 * (random.uniform() - 0.5);
    mean += d * (1.0 / static_cast<double>(motion.size()));
  }
  for (std::size_t i = 0; i < moved.size(); ++i) moved[i].x = wrapped(moved[i].x + motion[i], s.cell);
  const RadicalCells cells = radical_cells(moved, s.cell);
  const CellForces f = forces_of(law, start.content, moved, s.cell, springs);
  ASSERT_EQ(f.sliding, 0);
  const std::vector<Vec3> back = CellTangent(moved, cells, f).answer(1e-6, 1000);
  double error = 0.0;
  double size = 0.0;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    error += norm2(back[i] + motion[i] - mean);  // one motion of all calls up nothing
    size += norm2(motion[i]);
  }
  EXPECT_LT(std::sqrt(error / size), 0.02);
}

/// f(x) = -A x with eigenvalues from 0.01 to 1: mixing as many steps as there are unknowns solves it.
TEST(StepMixer, SolvesWhatIsLinear) {
  std::vector<Vec3> x(2, Vec3{{1.0, -2.0, 0.5}});
  StepMixer mixer(6);
  const auto size = [&] {
    double out = 0.0;
    for (const Vec3& d : x) out += norm2(d);
    return std::sqrt(out);
  };
  for (int n = 0; n < 9; ++n) {
    std::vector<Vec3> f(2);
    for (std::size_t i = 0; i < 2; ++i)
      for (int k = 0; k < 3; ++k) f[i][k] = -std::pow(0.01, (3.0 * static_cast<double>(i) + k) / 5.0) * x[i][k];
    const std::vector<Vec3> step = mixer.mix(f);
    for (std::size_t i = 0; i < 2; ++i) x[i] += step[i];
    mixer.took(step);
  }
  EXPECT_LT(size(), 1e-5);  // steps of f alone: 0.99^9 of where it began
}

class CellRest : public testing::TestWithParam<double> {
 protected:
  CellPacking packing() const {
    const CellSample s = cell_sample(40, 0.42, true, 9);
    return packing_of(s, start_at_pressure(s.law, s.bodies, s.volume, s.fines, 1e-4), {GetParam(), 1.0});
  }
  static CellRelaxation options(bool by_tangent) {
    CellRelaxation out;
    out.by_tangent = by_tangent;
    return out;
  }
};

TEST_P(CellRest, EndsWhereFireDoesAtAFifthOfTheTessellations) {
  CellPacking fast = packing();
  CellPacking slow = packing();
  std::int64_t few = 0;
  std::int64_t many = 0;
  for (const Vec3& strain : {Vec3{{1.0, 1.0, 0.97}}, Vec3{{1.01, 1.01, 0.97}}, Vec3{{1.0, 1.0, 1.01}}}) {
    const CellPoint a = fast.strain(strain, options(true));
    const CellPoint b = slow.strain(strain, options(false));
    ASSERT_EQ(a.relaxation.end, RelaxationEnd::converged);
    ASSERT_EQ(b.relaxation.end, RelaxationEnd::converged);
    EXPECT_LE(a.relaxation.residual, options(true).tolerance);
    few += a.tessellations;
    many += b.tessellations;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(a.stress[k][k] / b.stress[k][k], 1.0, 2e-3) << k;
    EXPECT_NEAR(a.energy / b.energy, 1.0, 1e-3);
  }
  EXPECT_LT(5 * few, many) << few << " and " << many;
}

TEST_P(CellRest, WithTheRoomHeldByStressToo) {
  BoxControl control;
  control.by_stress = {true, true, false};
  control.stress = {{2e-4, 2e-4, 0.0}};
  control.tolerance = 1e-3;
  control.largest_strain = 0.02;
  CellPacking fast = packing();
  CellPacking slow = packing();
  std::int64_t few = 0;
  std::int64_t many = 0;
  for (int n = 0; n < 3; ++n) {
    const CellPoint a = fast.press({{1.0, 1.0, 0.98}}, control, options(true));
    const CellPoint b = slow.press({{1.0, 1.0, 0.98}}, control, options(false));
    ASSERT_EQ(a.relaxation.end, RelaxationEnd::converged);
    ASSERT_EQ(b.relaxation.end, RelaxationEnd::converged);
    for (int k = 0; k < 2; ++k) EXPECT_NEAR(a.stress[k][k] / 2e-4, 1.0, 1e-3);
    EXPECT_NEAR(a.stress[2][2] / b.stress[2][2], 1.0, 3e-3);
    EXPECT_NEAR(a.volume / b.volume, 1.0, 5e-4);
    few += a.tessellations;
    many += b.tessellations;
  }
  EXPECT_LT(2 * few, many) << few << " and " << many;
}
INSTANTIATE_TEST_SUITE_P(Friction, CellRest, testing::Values(0.0, 0.05, 0.6));

TEST(CellPackings, BetweenPlanesComeToTheStressOfTheirWalls) {
  const CellSample s = cell_sample(40, 0.42, true, 6);
  const double l = s.cell.edges[0][0];
  const CellRoom room = PlaneBox{-Vec3{{0.5, 0.5, 0.5}}, {{l + 0.5, l + 0.5, l + 0.5}}};  // grains beside the planes
  const auto volume = room.cells_of(s.sites).volume;
  const double fines = s.fines + 0.51 * (room.volume() - s.cell.volume());
  const CellStart start = start_at_pressure(s.law, s.bodies, volume, fines, 1e-4);
  CellPacking p(CellLaw{s.law.equation, {}, {0.4, 1.0}}, s.sites, start.content, room);
  BoxControl control;
  control.by_stress = {true, true, true};
  control.stress = {{4e-4, 3e-4, 5e-4}};
  control.tolerance = 1e-3;
  control.largest_strain = 0.02;
  const CellPoint point = p.press({{1.0, 1.0, 1.0}}, control, {});
  EXPECT_EQ(point.relaxation.end, RelaxationEnd::converged);
  const auto loads = wall_loads(p.cells(), p.forces().pressure);
  const Vec3 size = p.room().high() - p.room().low();
  for (int k = 0; k < 3; ++k) {
    const double area = size[(k + 1) % 3] * size[(k + 2) % 3];
    for (const int side : {0, 1})
      EXPECT_NEAR(loads[static_cast<std::size_t>(2 * k + side)] / area / control.stress[k], 1.0, 0.02) << k;
  }
  // It goes on from its state with the same bits.
  CellPacking again(CellLaw{s.law.equation, {}, {0.4, 1.0}}, p.state(), false);
  EXPECT_EQ(again.strain({{1.0, 1.0, 0.99}}).stress, p.strain({{1.0, 1.0, 0.99}}).stress);
}

}  // namespace
}  // namespace softgrain
