// Fits of the cell law: excess pores and face friction come back from curves whose truth is known.
#include <gtest/gtest.h>

#include <cmath>

#include "calibrate/excess_pores_fit.h"
#include "calibrate/face_friction_fit.h"
#include "common/core/error.h"
#include "common/core/random.h"

namespace softgrain {
namespace {

constexpr double kVoidRatio = 0.74;
constexpr double kAlone = 0.68;
constexpr double kMany = 0.40;
constexpr double kDecay = 0.35;

/// A state fit of fines, coarse grains and mixtures whose onsets obey the form; replicates scatter by `scatter`.
struct Mixtures {
  StateFit states;
  MixtureGroups groups{"fines", "coarse", {}};
  RandomStream random{7, RandomPurpose::test, 1};

  explicit Mixtures(double scatter, std::vector<double> ratios = {0.25, 0.67, 1.5, 4.0}, int degrees = 12) {
    states.usable = true;
    states.degrees = degrees;
    states.fit.parameters = {std::log(0.06), 2.0};
    add("fines", 1.0 / (1.0 + kVoidRatio));
    add("coarse", 1.0 / (1.0 + kAlone));
    for (std::size_t k = 0; k < ratios.size(); ++k) {
      const double pores = kMany + (kAlone - kMany) * std::exp(-ratios[k] / kDecay);
      const std::string name = "mixture " + std::to_string(k);
      add(name, (1.0 + ratios[k]) / (1.0 + ratios[k] + pores + kVoidRatio * ratios[k]));
      groups.mixtures.push_back({name, ratios[k]});
    }
    for (int r = 0; r < 200; ++r) {
      states.replicates.push_back(states.fit.parameters);
      for (std::size_t g = 2; g < states.replicates.back().size(); ++g)
        states.replicates.back()[g] += scatter * random.normal();
    }
  }
  void add(const std::string& name, double onset) {
    StateGroup group;
    group.name = name;
    states.groups.push_back(group);
    states.fit.parameters.push_back(onset);
  }
};

TEST(ExcessPoresFit, GivesBackTheForm) {
  const Mixtures m(3e-4);
  const ExcessPoresFit fit = fit_excess_pores(m.states, m.groups);
  ASSERT_TRUE(fit.usable) << fit.message;
  EXPECT_NEAR(fit.void_ratio.value, kVoidRatio, 1e-12);
  EXPECT_NEAR(fit.alone.value, kAlone, 1e-12);
  EXPECT_NEAR(fit.many.value, kMany, 1e-8);
  EXPECT_NEAR(fit.decay.value, kDecay, 1e-8);
  EXPECT_LT(fit.deviation, 1e-8);
  EXPECT_EQ(fit.widening, 1.0);
  // d e/d phi = -1/phi^2.
  EXPECT_NEAR(fit.void_ratio.standard_error, 3e-4 * std::pow(1.0 + kVoidRatio, 2), 1.5e-4);
  for (const Estimate* e : {&fit.many, &fit.decay}) {
    EXPECT_LT(e->low, e->value);
    EXPECT_GT(e->high, e->value);
    EXPECT_GT(e->standard_error, 0.0);
  }
}

/// Onsets that scatter are fitted within the intervals that replicates of that scatter tell.
TEST(ExcessPoresFit, IntervalsHoldTheTruth) {
  int held_many = 0;
  int held_decay = 0;
  constexpr int kTrials = 40;
  RandomStream random(3, RandomPurpose::test, 5);
  for (int t = 0; t < kTrials; ++t) {
    Mixtures m(5e-4);
    std::vector<double> shift;
    for (std::size_t g = 2; g < m.states.fit.parameters.size(); ++g) {
      shift.push_back(5e-4 * random.normal());
      m.states.fit.parameters[g] += shift.back();
      for (auto& r : m.states.replicates) r[g] += shift.back();
    }
    const ExcessPoresFit fit = fit_excess_pores(m.states, m.groups);
    if (!fit.usable) continue;
    held_many += fit.many.low <= kMany && kMany <= fit.many.high ? 1 : 0;
    held_decay += fit.decay.low <= kDecay && kDecay <= fit.decay.high ? 1 : 0;
  }
  EXPECT_GE(held_many, 34);
  EXPECT_GE(held_decay, 34);
}

TEST(ExcessPoresFit, AFormThatMissesTheMixturesHasWiderIntervals) {
  Mixtures good(5e-4);
  Mixtures bad(5e-4);
  for (std::size_t k = 0; k < 4; ++k) {
    const double off = k % 2 == 0 ? 4e-3 : -4e-3;
    bad.states.fit.parameters[4 + k] += off;
    for (auto& r : bad.states.replicates) r[4 + k] += off;
  }
  const ExcessPoresFit a = fit_excess_pores(good.states, good.groups);
  const ExcessPoresFit b = fit_excess_pores(bad.states, bad.groups);
  ASSERT_TRUE(a.usable && b.usable) << a.message << b.message;
  EXPECT_GT(b.widening, 3.0);
  EXPECT_GT(b.many.standard_error, 2.0 * a.many.standard_error);
  EXPECT_GT(b.deviation, 0.005);
}

TEST(ExcessPoresFit, SaysWhatIsNotDetermined) {
  const Mixtures late(5e-4, {6.0, 8.0, 10.0});  // the decay is over
  const ExcessPoresFit fit = fit_excess_pores(late.states, late.groups);
  EXPECT_FALSE(fit.usable);
  EXPECT_NE(fit.message.find("xi"), std::string::npos) << fit.message;
  Mixtures dense(5e-4);
  dense.states.fit.parameters[5] = 0.95;
  EXPECT_NE(fit_excess_pores(dense.states, dense.groups).message.find("no excess pores"), std::string::npos);
  Mixtures few(5e-4, {1.0, 2.0});
  EXPECT_THROW((void)fit_excess_pores(few.states, few.groups), InputError);
  Mixtures other(5e-4);
  other.groups.fines = "sand";
  EXPECT_THROW((void)fit_excess_pores(other.states, other.groups), InputError);
  const Mixtures single(5e-4, {0.25, 0.67, 1.5, 4.0}, 0);
  const ExcessPoresFit without = fit_excess_pores(single.states, single.groups);
  EXPECT_TRUE(without.usable);
  EXPECT_NEAR(without.decay.value, kDecay, 1e-8);
  EXPECT_FALSE(std::isfinite(without.decay.standard_error));
}

/// Like fines: springs that harden to a Coulomb limit, in two tests.
std::vector<double> friction_curves(const FaceFrictionTrial& t) {
  std::vector<double> row;
  for (int k = 1; k <= 8; ++k) {
    const double sheared = t.friction * std::tanh(0.3 * k * t.stiffness / t.friction);
    row.push_back((1.0 - 0.5 * sheared) / (1.0 + 0.5 * sheared));
  }
  for (int k = 1; k <= 8; ++k) row.push_back(1.4 * t.friction * std::tanh(0.1 * k * t.stiffness / t.friction));
  return row;
}

std::vector<std::vector<double>> all_curves(const std::vector<FaceFrictionTrial>& trials) {
  std::vector<std::vector<double>> out;
  for (const auto& t : trials) out.push_back(friction_curves(t));
  return out;
}

FaceFrictionData measured_curves(const std::vector<FaceFrictionTrial>& samples) {
  return {all_curves(samples), std::vector<double>(16, 1.0 / 8.0)};
}

TEST(FaceFrictionFit, GivesBackBothNumbersFromAnywhere) {
  for (const FaceFrictionTrial truth : {FaceFrictionTrial{0.6, 1.0}, {0.8, 2.0}, {0.25, 4.0}, {1.5, 0.5}}) {
    const FaceFrictionFit fit = fit_face_friction(all_curves, measured_curves({truth, truth, truth}));
    ASSERT_TRUE(fit.usable) << fit.message;
    EXPECT_NEAR(fit.friction.value / truth.friction, 1.0, 3e-4);
    EXPECT_NEAR(fit.stiffness.value / truth.stiffness, 1.0, 3e-4);
    EXPECT_LT(fit.deviation, 1e-3);
    EXPECT_LT(fit.friction.standard_error, 1e-9);  // samples are alike
  }
}

TEST(FaceFrictionFit, ErrorsAreTheScatterOfSamples) {
  const FaceFrictionFit fit =
      fit_face_friction(all_curves, measured_curves({{0.6 * 0.95, 1.5 * 1.1}, {0.6, 1.5 / 1.1}, {0.6 * 1.05, 1.5}}));
  ASSERT_TRUE(fit.usable) << fit.message;
  EXPECT_NEAR(fit.friction.value, 0.6, 0.01);
  EXPECT_NEAR(fit.friction.standard_error, 0.6 * 0.05 / std::sqrt(3.0), 0.003);
  EXPECT_NEAR(fit.stiffness.standard_error, 1.5 * 0.095 / std::sqrt(3.0), 0.02);
  EXPECT_NEAR(fit.friction.high, 0.6 * std::exp(4.303 * 0.05 / std::sqrt(3.0)), 0.02);  // Student, two degrees
}

TEST(FaceFrictionFit, SaysWhatIsNotDetermined) {
  FaceFrictionData data = measured_curves({{0.6, 1.0}});
  const FaceFrictionFit one = fit_face_friction(all_curves, data);
  EXPECT_TRUE(one.usable);
  EXPECT_FALSE(std::isfinite(one.friction.standard_error));
  data.samples[0][3] = std::nan("");  // a point that bears nothing
  EXPECT_TRUE(fit_face_friction(all_curves, data).usable);
  const auto flat = [](const std::vector<FaceFrictionTrial>& trials) {
    return std::vector<std::vector<double>>(trials.size(), std::vector<double>(16, 0.5));
  };
  EXPECT_NE(fit_face_friction(flat, data).message.find("do not determine"), std::string::npos);
  const auto none = [](const std::vector<FaceFrictionTrial>& trials) {
    return std::vector<std::vector<double>>(trials.size());
  };
  EXPECT_NE(fit_face_friction(none, data).message.find("gives no curve"), std::string::npos);
  // Friction that never slides: mu_f has no upper end.
  const FaceFrictionFit rough = fit_face_friction(all_curves, measured_curves({{1e3, 1.0}}));
  EXPECT_FALSE(rough.usable);
  EXPECT_NE(rough.message.find("mu_f"), std::string::npos) << rough.message;
  data.weight.pop_back();
  EXPECT_THROW((void)fit_face_friction(all_curves, data), InputError);
}

}  // namespace
}  // namespace softgrain
