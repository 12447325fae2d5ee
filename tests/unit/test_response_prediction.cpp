// Responses of spans that take no part, predicted from a made-up material whose truth is known.
#include <gtest/gtest.h>

#include <cmath>

#include "calibrate/response_prediction.h"
#include "common/core/error.h"
#include "common/core/random.h"

namespace softgrain {
namespace {

constexpr double kModulus = 0.05;
constexpr double kExponent = 1.8;
constexpr double kStart = 1e-4;
constexpr int kPoints = 9;

double onset_of(double span) { return 1.0 / (1.0 + 0.75 * std::exp(-0.3 * (std::hypot(std::log(span), 1.0) - 1.0))); }
double volume_at(int k) { return 1.0 - 0.01 * k; }

/// An oedometric test: pressures `stiffer` times the equation of state at its end, K0 that falls with the onset.
struct Truth {
  double scatter = 0.0;       ///< of onsets
  double ratio_slope = 0.0;   ///< of K0 over phi_J
  double log_factor = -0.05;  ///< a point
  double ratio_scatter = 0.0;

  [[nodiscard]] double ratio(double onset, int k) const { return 0.9 - 0.04 * k - ratio_slope * (onset - 0.6); }
  [[nodiscard]] double pressure(double onset, int k) const {
    const double phi = state_phi(StateForm::porosity, kModulus, kExponent, onset, kStart) / volume_at(k);
    return state_pressure(StateForm::porosity, kModulus, kExponent, onset, phi) * std::exp(log_factor * k);
  }
  [[nodiscard]] double axial(double span, int k) const {
    return 3.0 * pressure(onset_of(span), k) / (1.0 + 2.0 * ratio(onset_of(span), k));
  }
};

struct Made {
  std::vector<StateCurve> states;
  std::vector<ResponseCurve> responses;
};

/// States follow the equation exactly; responses are off it by the factor.
Made make(const Truth& t, std::uint64_t seed) {
  Made out;
  RandomStream random(seed, RandomPurpose::bootstrap, 77);
  for (const double span : {1.5, 2.4, 3.5, 6.0})
    for (int s = 0; s < 4; ++s) {
      const double onset = onset_of(span) + t.scatter * random.normal();
      StateCurve state{std::to_string(span), span, {}, {}, {}};
      ResponseCurve r{state.group, {}, {}, {}, {}};
      const double off = t.ratio_scatter * random.normal();
      for (int k = 0; k < kPoints; ++k) {
        const double phi = state_phi(StateForm::porosity, kModulus, kExponent, onset, kStart) / volume_at(k);
        state.phi.push_back(phi + 0.02 * t.scatter * random.normal());
        state.pressure.push_back(state_pressure(StateForm::porosity, kModulus, kExponent, onset, phi));
        r.volume.push_back(volume_at(k));
        r.pressure.push_back(t.pressure(onset, k));
        r.ratio.push_back(t.ratio(onset_of(span), k) + off);
        r.deviator.push_back(3.0 * (1.0 - r.ratio.back()) / (1.0 + 2.0 * r.ratio.back()));
      }
      out.states.push_back(state);
      out.responses.push_back(r);
    }
  return out;
}

StateFit fitted(const Made& made, std::uint64_t seed) {
  return fit_equation_of_state(made.states, {StateForm::porosity, 100, seed});
}

TEST(ResponsePrediction, AnExactMaterialGivesItselfBack) {
  Truth t;
  t.scatter = 1e-7;
  const Made made = make(t, 1);
  const StateFit fit = fitted(made, 1);
  ASSERT_TRUE(fit.usable) << fit.message;
  const ResponsePrediction found = predict_response(fit, made.responses, 30.0, {});
  ASSERT_TRUE(found.usable) << found.message;
  EXPECT_NEAR(found.solid_fraction.value, state_phi(StateForm::porosity, kModulus, kExponent, onset_of(30.0), kStart),
              2e-4);
  ASSERT_EQ(found.axial.size(), static_cast<std::size_t>(kPoints));
  EXPECT_NEAR(found.pressure[0].value, kStart, 1e-7);
  for (int k = 0; k < kPoints; ++k) {
    const auto at = static_cast<std::size_t>(k);
    EXPECT_NEAR(found.axial[at].value / t.axial(30.0, k), 1.0, 3e-3) << k;
    EXPECT_NEAR(found.lateral[at].value / (t.ratio(0.0, k) * t.axial(30.0, k)), 1.0, 3e-3) << k;
    EXPECT_NEAR(found.deviator[at].value, made.responses.front().deviator[at], 1e-9);
  }
}

/// K0 that goes on along its line and one that stays are as possible: the interval holds both.
TEST(ResponsePrediction, WhatChangesWithTheSpanMayGoOnOrStay) {
  Truth t;
  t.scatter = 1e-7;
  t.ratio_slope = 1.0;
  const Made made = make(t, 1);
  const ResponsePrediction found = predict_response(fitted(made, 1), made.responses, 30.0, {});
  ASSERT_TRUE(found.usable);
  const double pressure = t.pressure(onset_of(30.0), 5);
  const double stays = 3.0 * pressure / (1.0 + 2.0 * t.ratio(onset_of(6.0), 5));
  EXPECT_NEAR(found.axial[5].low / stays, 1.0, 5e-3);
  EXPECT_NEAR(found.axial[5].high / t.axial(30.0, 5), 1.0, 5e-3);
}

TEST(ResponsePrediction, IntervalsHoldTheTruthOfScatteredSamples) {
  Truth t;
  t.scatter = 0.001;
  t.ratio_scatter = 0.01;
  t.ratio_slope = 0.5;
  int hits = 0;
  double width = 0.0;
  constexpr int kSeeds = 10;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const Made made = make(t, static_cast<std::uint64_t>(40 + seed));
    const ResponsePrediction found =
        predict_response(fitted(made, static_cast<std::uint64_t>(seed)), made.responses, 12.0, {});
    if (!found.usable) continue;
    const Estimate& e = found.axial[5];
    hits += e.low <= t.axial(12.0, 5) && t.axial(12.0, 5) <= e.high ? 1 : 0;
    width += (e.high - e.low) / e.value / kSeeds;
  }
  EXPECT_GE(hits, 8);
  EXPECT_GT(width, 0.01);
  EXPECT_LT(width, 0.4);
}

TEST(ResponsePrediction, RefusesCurvesOfOtherPointsAndUnknownGroups) {
  const Made made = make({.scatter = 1e-4}, 1);
  const StateFit fit = fitted(made, 1);
  EXPECT_THROW((void)predict_response(fit, {}, 12.0, {}), InputError);
  auto other = made.responses;
  other[1].volume[4] *= 0.99;
  EXPECT_THROW((void)predict_response(fit, other, 12.0, {}), InputError);
  other = made.responses;
  other[1].group = "none such";
  EXPECT_THROW((void)predict_response(fit, other, 12.0, {}), InputError);
}

TEST(FittedOnset, IsThatOfAnExactCurve) {
  for (const StateForm form : {StateForm::porosity, StateForm::pores}) {
    StateCurve c{"", 6.0, {}, {}, {}};
    for (const double p : {0.0, 1e-4, 5e-4, 2e-3}) {
      c.pressure.push_back(p);
      c.phi.push_back(state_phi(form, kModulus, kExponent, 0.66, p));
    }
    EXPECT_NEAR(fitted_onset(form, kModulus, kExponent, c), 0.66, 1e-12);
  }
  EXPECT_THROW((void)fitted_onset(StateForm::porosity, kModulus, kExponent, {}), InputError);
}

}  // namespace
}  // namespace softgrain
