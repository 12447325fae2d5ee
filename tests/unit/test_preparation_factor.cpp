// Factors on void ratios for other preparations: from synthetic samples, and what they do to cells.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "calibrate/state_curves.h"
#include "common/core/error.h"
#include "macrosim/body_contacts.h"
#include "macrosim/cell_specimen.h"
#include "pipelines/kinds/material_law/fit.h"

namespace softgrain {
namespace {

constexpr double kFactorK = 0.05;
constexpr double kFactorN = 1.8;

/// A sample whose onset has this void ratio, and that begins with p/E = `pressure`.
MacroCurve started_sample(StateForm form, std::int64_t sample, double void_ratio, double pressure) {
  MacroCurve c;
  c.sample = sample;
  c.usable = true;
  c.start.youngs_modulus = 2e6;
  c.more[kSolidFraction] = {state_phi(form, kFactorK, kFactorN, 1.0 / (1.0 + void_ratio), pressure), 0.9};
  for (auto* column : {&c.stress_x, &c.stress_y, &c.stress_axial}) column->assign(2, 2e6 * pressure);
  return c;
}

class PreparationFactors : public testing::TestWithParam<StateForm> {
 protected:
  [[nodiscard]] MacroCurve sample(std::int64_t number, double void_ratio, double pressure = 1e-4) const {
    return started_sample(GetParam(), number, void_ratio, pressure);
  }
  [[nodiscard]] std::optional<Estimate> factor(const std::vector<MacroCurve>& own,
                                               const std::vector<MacroCurve>& other) const {
    return preparation_factor(GetParam(), kFactorK, kFactorN, own, other);
  }
};

/// Samples differ in their void ratios by much more than in their factors, and start at other pressures.
TEST_P(PreparationFactors, AreMeansOfRatiosOfPairs) {
  const std::array own{0.60, 0.66, 0.71};
  const std::array ratio{0.72, 0.73, 0.75};
  std::vector<MacroCurve> a;
  std::vector<MacroCurve> b;
  for (std::size_t k = 0; k < 3; ++k) {
    a.push_back(sample(static_cast<std::int64_t>(k), own[k], 2e-4));
    b.push_back(sample(static_cast<std::int64_t>(k), ratio[k] * own[k], 1e-4 * static_cast<double>(k)));
  }
  const auto f = factor(a, {b[2], b[0], b[1]});
  ASSERT_TRUE(f);
  EXPECT_NEAR(f->value, 2.2 / 3.0, 1e-12);
  const double error =
      std::sqrt((0.0133333333 * 0.0133333333 + 0.0033333333 * 0.0033333333 + 0.0166666667 * 0.0166666667) / 6.0);
  EXPECT_NEAR(f->standard_error, error, 1e-8);
  EXPECT_NEAR(f->high - f->value, 4.302653 * error, 1e-7);  // Student, two degrees of freedom
}

TEST_P(PreparationFactors, LeaveOutSamplesWithoutAPartner) {
  MacroCurve broken = sample(1, 0.3);
  broken.usable = false;
  const auto f = factor({sample(0, 0.6), sample(1, 0.9), sample(3, 0.2)}, {sample(0, 0.45), broken, sample(7, 0.1)});
  ASSERT_TRUE(f);
  EXPECT_NEAR(f->value, 0.75, 1e-12);
  EXPECT_FALSE(std::isfinite(f->standard_error)) << "one pair has no error";
  EXPECT_FALSE(factor({sample(0, 0.6)}, {broken}));
  MacroCurve silent = sample(0, 0.6);
  silent.more.clear();
  EXPECT_FALSE(factor({sample(0, 0.6)}, {silent}));
}

TEST_P(PreparationFactors, OnsetsFollowFromThePointsOfTheirEquation) {
  const double onset = 0.62;
  for (const double pressure : {0.0, 1e-6, 1e-3}) {
    const double phi = state_phi(GetParam(), kFactorK, kFactorN, onset, pressure);
    EXPECT_NEAR(onset_at(GetParam(), kFactorK, kFactorN, phi, pressure), onset, 1e-12) << pressure;
  }
}

CellCard factor_card(StateForm form) {
  CellCard card;
  card.form = form;
  card.modulus.value = kFactorK;
  card.exponent.value = kFactorN;
  card.void_ratio.value = 0.7;
  card.excess_alone.value = 0.66;
  card.excess_many.value = 0.4;
  card.excess_decay.value = 0.3;
  card.preparation = "fast";
  card.preparations = {{"dense", {0.73, 0.003, 0.72, 0.74}}};
  if (form == StateForm::porosity) {
    card.memory = CellMemory{};
    card.memory->critical_pores.value = 0.9;
  }
  return card;
}

/// Fines, coarse grains and mixtures jam with 0.73 of the pores; the critical state stays where it is.
TEST_P(PreparationFactors, ScaleThePoresOfTheMixtureAndNotTheCriticalState) {
  const CellCard card = factor_card(GetParam());
  const FinesLaw own = fines_law_of(card, 1.0);
  const FinesLaw dense = fines_law_of(card, 1.0, "dense");
  const auto pores = [](const FinesLaw& law, double fines, double coarse) {
    return law.void_ratio * fines + law.excess.volume(fines, coarse);
  };
  for (const auto& [fines, coarse] : {std::pair{0.0, 1.0}, {0.3, 0.7}, {0.9, 0.1}}) {
    EXPECT_NEAR(pores(dense, fines, coarse) / pores(own, fines, coarse), 0.73, 1e-12) << fines;
    EXPECT_NEAR(dense.critical_pores * pores(dense, fines, coarse), own.critical_pores * pores(own, fines, coarse),
                1e-12);
    const double phi_j = 1.0 / (1.0 + 0.73 * pores(own, fines, coarse));
    EXPECT_NEAR(1.0 / room_at_pressure(dense, fines, coarse, 1e-4),
                state_phi(GetParam(), kFactorK, kFactorN, phi_j, 1e-4), 1e-9)
        << fines;
  }
  const FinesLaw same = fines_law_of(card, 1.0, "fast");
  EXPECT_EQ(same.void_ratio, own.void_ratio);
  EXPECT_EQ(same.critical_pores, own.critical_pores);
  EXPECT_THROW((void)fines_law_of(card, 1.0, "slow"), InputError);
}

/// At the density at which a dense mixture bears p, cells start with that pressure; by the card's own preparation that
/// density would be far beyond it.
TEST_P(PreparationFactors, CellsFromDensityAloneStartWithThePressureOfTheirPreparation) {
  const CellCard card = factor_card(GetParam());
  const FinesLaw dense = fines_law_of(card, 1.0, "dense");
  const CoarseBodies bodies{{1.0, 1.0, 1.0}, {}};
  const double coarse = 3.0 * bodies.grain(0);
  const double fines = 0.6 * coarse;
  const double room = room_at_pressure(dense, fines, coarse, 2e-4);
  const std::vector<double> volume(3, room / 3.0);
  const CellStart start = start_at_density(dense, bodies, volume, fines);
  EXPECT_NEAR(start.pressure / 2e-4, 1.0, 1e-6);
  EXPECT_EQ(start.excess_share, 1.0);
  EXPECT_NEAR(start_at_pressure(dense, bodies, volume, fines, 2e-4).excess_share, 1.0, 1e-6);
  EXPECT_GT(start_at_density(fines_law_of(card, 1.0), bodies, volume, fines).pressure, 10.0 * 2e-4);
}
INSTANTIATE_TEST_SUITE_P(Forms, PreparationFactors, testing::Values(StateForm::porosity, StateForm::pores));

/// Shear notices a small error of the excess pores; without memory, or where another preparation explains it, a large
/// one alone is said.
TEST(CellStartRemark, SaysThatACardWithMemoryIsOfAnotherGrading) {
  MacroSpec spec;
  spec.preparation = Preparation::fast;
  spec.start_pressure = 1e-4;
  spec.cells = CellMatter{factor_card(StateForm::porosity), 0.3};
  spec.cells->card.mixture_high = 4.0;
  CellStart start;
  start.excess_share = 1.03;
  EXPECT_EQ(start_remark(spec, start), "");
  for (const double share : {1.15, 0.83}) {
    start.excess_share = share;
    EXPECT_NE(start_remark(spec, start).find("critical state does not follow"), std::string::npos) << share;
  }
  spec.cells->at_density = true;
  EXPECT_EQ(start_remark(spec, start), "");
  spec.cells->at_density = false;
  spec.preparation = Preparation::dense;
  EXPECT_EQ(start_remark(spec, start).find("excess pores"), std::string::npos) << "the preparation differs";
  spec.cells->preparation = "dense";
  EXPECT_EQ(start_remark(spec, start), "") << "its factor is known, and the critical state follows";
  spec.cells->card.memory.reset();
  EXPECT_EQ(start_remark(spec, start), "");
  start.excess_share = 0.4;
  EXPECT_EQ(start_remark(spec, start), "excess pores are 0.4 times those of the card at this start pressure");
}

}  // namespace
}  // namespace softgrain
