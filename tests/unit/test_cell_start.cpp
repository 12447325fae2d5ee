// Equation of state of cells against derivatives and integrals; how much cells hold at the start.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "common/core/error.h"
#include "tests/support/cell_samples.h"
#include "tests/support/refusal.h"

namespace softgrain {
namespace {

const CellContent kContent{2.1, 0.8};

class EquationsOfState : public testing::TestWithParam<EquationOfState> {};

TEST_P(EquationsOfState, PressureAndStiffnessAreDerivativesOfTheEnergy) {
  const PoreGuard guard{0.25};
  for (const double q : {0.99, 0.9, 0.7, 0.4, 0.26, 0.24, 0.1, 0.03}) {
    const double v = kContent.solid + q * kContent.pores;
    const double h = 1e-6 * q;
    const CellResponse at = respond(GetParam(), guard, kContent, v);
    const CellResponse up = respond(GetParam(), guard, kContent, v + h);
    const CellResponse down = respond(GetParam(), guard, kContent, v - h);
    EXPECT_NEAR((down.energy - up.energy) / (2.0 * h) / at.pressure, 1.0, 1e-6) << q;
    EXPECT_NEAR((down.pressure - up.pressure) / (2.0 * h) / at.stiffness, 1.0, 1e-6) << q;
    EXPECT_GT(at.energy, 0.0);
  }
}

TEST_P(EquationsOfState, EndAtTheOnsetAndAtTheSolid) {
  const PoreGuard guard{0.25};
  const double onset = kContent.solid + kContent.pores;
  for (const double v : {onset, 1.01 * onset, 10.0 * onset}) {
    const CellResponse beyond = respond(GetParam(), guard, kContent, v);
    EXPECT_EQ(beyond.pressure, 0.0);
    EXPECT_EQ(beyond.stiffness, 0.0);
    EXPECT_EQ(beyond.energy, 0.0);
  }
  EXPECT_TRUE(std::isinf(respond(GetParam(), guard, kContent, kContent.solid).energy));
  EXPECT_TRUE(std::isinf(respond(GetParam(), {0.0}, kContent, 0.5 * kContent.solid).energy));
}

TEST_P(EquationsOfState, TheGuardActsOnlyWhereHardlyPoresAreLeftAndThenWithoutBound) {
  const auto at = [](double q, double from) {
    return respond(GetParam(), {from}, kContent, kContent.solid + q * kContent.pores);
  };
  EXPECT_EQ(at(0.26, 0.25).pressure, at(0.26, 0.0).pressure);
  EXPECT_NEAR((at(0.2, 0.25).pressure - at(0.2, 0.0).pressure) / modulus(GetParam()), 0.0625, 1e-12);
  EXPECT_LT(at(1e-6, 0.0).pressure, 1.01 * modulus(GetParam()));
  EXPECT_GT(at(1e-6, 0.25).pressure, 1e9 * modulus(GetParam()));
  EXPECT_GT(at(1e-6, 0.25).energy, 1e3 * at(1e-6, 0.0).energy);
}
INSTANTIATE_TEST_SUITE_P(BothForms, EquationsOfState,
                         testing::Values(EquationOfState{PoreForm{0.0336, 2.03}},
                                         EquationOfState{PorosityForm{0.0447, 1.75}}));

TEST(EquationOfStateValues, AreThoseOfTheFormulas) {
  const double v = kContent.solid + 0.8 * kContent.pores;
  EXPECT_NEAR((PoreForm{3.0, 2.5}.at(kContent, v).pressure), 3.0 * std::pow(0.2, 2.5), 1e-14);
  const double phi = kContent.solid / v;
  const double onset = kContent.solid / (kContent.solid + kContent.pores);
  EXPECT_NEAR((PorosityForm{3.0, 2.5}.at(kContent, v).pressure), 3.0 * std::pow((phi - onset) / (1.0 - onset), 2.5),
              1e-14);
  EXPECT_NEAR(state_at(PoreForm{3.0, 2.5}, 3.0 * std::pow(0.2, 2.5)), 0.2, 1e-14);
}

TEST(EquationOfStateValues, PoreFormOfCellsAlikeIsThatOfTheirSum) {
  const PoreForm form{1.0, 2.03};
  const CellContent small{0.2, 0.1};
  const CellContent sum{kContent.solid + small.solid, kContent.pores + small.pores};
  const double q = 0.83;
  const CellResponse a = form.at(kContent, kContent.solid + q * kContent.pores);
  const CellResponse b = form.at(small, small.solid + q * small.pores);
  const CellResponse c = form.at(sum, sum.solid + q * sum.pores);
  EXPECT_NEAR(a.pressure, c.pressure, 1e-14);
  EXPECT_NEAR(b.pressure, c.pressure, 1e-14);
  EXPECT_NEAR(a.energy + b.energy, c.energy, 1e-14);
}

TEST(ExcessPores, GoFromTheCoarseGrainsAloneToALayerAtEach) {
  const ExcessPores e{0.6155, 0.3075, 0.355};
  EXPECT_NEAR(e.volume(0.0, 2.0), 2.0 * 0.6155, 1e-14);
  EXPECT_NEAR(e.volume(100.0, 2.0), 2.0 * 0.3075, 1e-12);
  EXPECT_NEAR(e.volume(2.0 * 0.355, 2.0), 2.0 * (0.3075 + 0.308 * std::exp(-1.0)), 1e-12);
}

class CellStarts : public testing::TestWithParam<bool> {};

void expect_alike(const CellSample& s, const CellStart& start, double pressure) {
  double pores = 0.0;
  for (std::size_t i = 0; i < s.volume.size(); ++i) {
    const CellResponse r = respond(s.law.equation, {}, start.content[i], s.volume[i]);
    EXPECT_NEAR(r.pressure / pressure, 1.0, 1e-9) << i;
    EXPECT_NEAR(start.content[i].solid, s.bodies.grain(i) + start.fines[i], 1e-14);
    pores += start.content[i].pores - s.law.void_ratio * start.fines[i];
  }
  const double total = std::accumulate(start.fines.begin(), start.fines.end(), 0.0);
  EXPECT_NEAR(total / s.fines, 1.0, 1e-12);
  double coarse = 0.0;
  for (std::size_t i = 0; i < s.volume.size(); ++i) coarse += s.bodies.grain(i);
  EXPECT_NEAR(pores, start.excess_share * s.law.excess.volume(s.fines, coarse), 1e-10 * pores);
}

TEST_P(CellStarts, AllCellsBeginAtTheGivenPressureWithAllTheFines) {
  const CellSample s = cell_sample(40, 0.42, GetParam(), 2);
  for (const double p : {1e-5, 1e-4, 1e-3}) {
    const CellStart start = start_at_pressure(s.law, s.bodies, s.volume, s.fines, p);
    EXPECT_EQ(start.pressure > 0.0, true);
    EXPECT_NEAR(start.pressure / p, 1.0, 1e-12);
    expect_alike(s, start, p);
  }
}

/// Excess pores that the start pressure asks for are of the grading where the preparation is known: pores at the
/// critical state are then r_c times those at the onset. Where it is not they stay those of the card.
TEST_P(CellStarts, TheCriticalStateFollowsTheStartPressureWhereThePreparationIsKnown) {
  CellSample s = cell_sample(40, 0.42, GetParam(), 2);
  s.law.critical_pores = 0.9;
  const CellStart unknown = start_at_pressure(s.law, s.bodies, s.volume, s.fines, 1e-4);
  s.law.of_preparation = true;
  const CellStart known = start_at_pressure(s.law, s.bodies, s.volume, s.fines, 1e-4);
  ASSERT_GT(std::abs(known.excess_share - 1.0), 0.01);
  for (std::size_t i = 0; i < s.volume.size(); ++i) {
    const double fines = s.law.void_ratio * known.fines[i];
    const double excess = known.content[i].pores - fines;
    EXPECT_EQ(known.content[i].pores, unknown.content[i].pores);
    EXPECT_NEAR(known.content[i].critical / (0.9 * (fines + excess)), 1.0, 1e-12);
    EXPECT_NEAR(unknown.content[i].critical / (0.9 * (fines + excess / known.excess_share)), 1.0, 1e-12);
  }
}

TEST_P(CellStarts, TheDensityGivesThePressureAndThatPressureTheSameExcess) {
  const CellSample s = cell_sample(40, 0.42, GetParam(), 2);
  const CellStart by_density = start_at_density(s.law, s.bodies, s.volume, s.fines);
  EXPECT_EQ(by_density.excess_share, 1.0);
  expect_alike(s, by_density, by_density.pressure);
  const CellStart by_pressure = start_at_pressure(s.law, s.bodies, s.volume, s.fines, by_density.pressure);
  EXPECT_NEAR(by_pressure.excess_share, 1.0, 1e-9);
  for (std::size_t i = 0; i < s.volume.size(); ++i) EXPECT_NEAR(by_pressure.fines[i] / by_density.fines[i], 1.0, 1e-8);
}

TEST_P(CellStarts, SoftBodiesAreFinesAlone) {
  CellSample s = cell_sample(40, 0.42, GetParam(), 2);
  s.bodies.soft.assign(40, false);
  s.bodies.soft[39] = true;
  const double freed = kSphereVolume * cube(s.bodies.radius[39]);
  s.fines += 0.5 * freed;
  const CellStart start = start_at_pressure(s.law, s.bodies, s.volume, s.fines, 1e-4);
  expect_alike(s, start, 1e-4);
  EXPECT_EQ(start.content[39].solid, start.fines[39]);
  EXPECT_NEAR(start.content[39].pores, s.law.void_ratio * start.fines[39], 1e-14);
}
INSTANTIATE_TEST_SUITE_P(BothForms, CellStarts, testing::Bool());

TEST(CellStart, FollowsTheClosedFormOfThePoreForm) {
  const CellSample s = cell_sample(40, 0.42, false, 2);
  const double y = std::pow(1e-4 / 0.0336, 1.0 / 2.03);
  double coarse = 0.0;
  for (std::size_t i = 0; i < 40; ++i) coarse += s.bodies.grain(i);
  const double room = s.cell.volume();
  const double w = s.law.excess.volume(s.fines, coarse);
  const CellStart start = start_at_pressure(s.law, s.bodies, s.volume, s.fines, 1e-4);
  EXPECT_NEAR(start.state, y, 1e-14);
  EXPECT_NEAR(start.excess_share, (room - coarse - s.fines * (1.0 + (1.0 - y) * 0.567)) / ((1.0 - y) * w), 1e-12);
  const CellStart dense = start_at_density(s.law, s.bodies, s.volume, s.fines);
  EXPECT_NEAR(dense.state, 1.0 - (room - coarse - s.fines) / (w + s.fines * 0.567), 1e-12);
}

TEST_P(CellStarts, LeaveCellsThatAreTooSmallWithoutFinesAtTheSamePressure) {
  const CellSample s = cell_sample(40, 0.42, GetParam(), 2);
  const double fines = 0.5 * s.fines;
  const CellStart start = start_at_pressure(s.law, s.bodies, s.volume, fines, 1e-4);
  EXPECT_GT(start.without_fines, 0);
  double sum = 0.0;
  int without = 0;
  for (std::size_t i = 0; i < 40; ++i) {
    const double pressure = respond(s.law.equation, {0.0}, start.content[i], s.volume[i]).pressure;
    EXPECT_NEAR(pressure, 1e-4, 1e-12) << i;
    EXPECT_NEAR(start.content[i].solid, s.bodies.grain(i) + start.fines[i], 1e-14);
    without += start.fines[i] == 0.0 ? 1 : 0;
    sum += start.fines[i];
  }
  EXPECT_EQ(without, start.without_fines);
  EXPECT_NEAR(sum / fines, 1.0, 1e-8);
}

TEST_P(CellStarts, RefuseStatesThatCannotBeAndSayWhy) {
  const CellSample s = cell_sample(40, 0.42, GetParam(), 2);
  const auto at_pressure = [&](double p, double fines) { start_at_pressure(s.law, s.bodies, s.volume, fines, p); };
  test::expect_refused<InputError>([&] { at_pressure(1e-4, 1.3 * s.fines); }, "no room");
  test::expect_refused<InputError>([&] { at_pressure(0.0, s.fines); }, "above 0");
  test::expect_refused<InputError>([&] { at_pressure(1.0, s.fines); }, "below");
  test::expect_refused<InputError>([&] { at_pressure(1e-4, 0.05 * s.fines); }, "would hold no fines");
  test::expect_refused<InputError>([&] { start_at_density(s.law, s.bodies, s.volume, 0.8 * s.fines); }, "does not jam");
  test::expect_refused<InputError>([&] { at_pressure(1e-4, 3.0 * s.fines); }, "leaves no pores");
  test::expect_refused<InputError>([&] { at_pressure(1e-4, NAN); }, "fines");
  CoarseBodies none = s.bodies;
  none.soft.assign(40, true);
  test::expect_refused<InputError>([&] { start_at_pressure(s.law, none, s.volume, s.fines, 1e-4); }, "there are none");
  auto volume = s.volume;
  volume[3] = 0.5 * s.bodies.grain(3);
  test::expect_refused<InputError>([&] { start_at_density(s.law, s.bodies, volume, s.fines); }, "cell 3");
  volume.pop_back();
  test::expect_refused<InputError>([&] { start_at_density(s.law, s.bodies, volume, s.fines); }, "one volume");
  FinesLaw law = s.law;
  law.equation = PoreForm{0.03, 0.9};
  test::expect_refused<InputError>([&] { start_at_density(law, s.bodies, s.volume, s.fines); }, "exponent");
  law = s.law;
  law.void_ratio = 0.0;
  test::expect_refused<InputError>([&] { start_at_density(law, s.bodies, s.volume, s.fines); }, "void ratio");
}

}  // namespace
}  // namespace softgrain
