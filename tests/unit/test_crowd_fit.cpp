// Fits of crowd laws to measurements made from a known law.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calibrate/crowd_form_fit.h"
#include "calibrate/crowd_states.h"
#include "common/contact/crowd_from_table.h"
#include "common/core/error.h"
#include "pipelines/kinds/law_table/crowd_law_fit.h"
#include "tests/support/known_crowd.h"

namespace softgrain {
namespace {

using synthetic::arrangements;
using synthetic::crowd_configuration;
using synthetic::crowd_measurements;
using synthetic::CrowdOptionsKnown;
using synthetic::known;
using synthetic::quick;

void expect_within(const Estimate& e, double value, const std::string& what) {
  EXPECT_GT(e.standard_error, 0.0) << what;
  EXPECT_NEAR(e.value, value, 3.0 * e.standard_error) << what;
}

TEST(CrowdFit, RecoversAKnownLawWithinItsErrors) {
  CrowdOptionsKnown o;
  o.noise = 0.05;
  const CrowdModel model = known(Crowd::directional);
  CrowdFitOptions options = quick();
  options.replicates = 30;  // errors of neighbours come from them
  const LawTableEntry entry = fit_crowd_laws(crowd_measurements(model, arrangements(), o), options);
  EXPECT_EQ(entry.best, Crowd::directional);
  options.best = Crowd::bag;
  options.replicates = 0;
  EXPECT_EQ(fit_crowd_laws(crowd_measurements(model, arrangements(), o), options).best, Crowd::bag) << "asked for";
  const CrowdLaw& law = *entry.find(Crowd::directional);
  EXPECT_EQ(law.status, LawStatus::good) << law.reason;
  EXPECT_EQ(law.parameters, 6);
  expect_within(law.a, model.form.pressure.a, "a");
  expect_within(law.b, model.form.pressure.b, "b");
  expect_within(law.delta, model.form.pressure.delta, "delta");
  expect_within(law.m0, model.form.coupling.m0, "m0");
  expect_within(law.m1, model.form.coupling.m1, "m1");
  expect_within(law.m2, model.form.coupling.m2, "m2");
  ASSERT_EQ(law.partners.size(), 4U);
  const double weights[] = {0.7, 0.85, 0.4, 0.5};
  const double exponents[] = {1.1, 1.1, 1.25, 1.25};
  for (std::size_t k = 0; k < 4; ++k) {
    expect_within(law.partners[k].weight, weights[k], "w " + std::to_string(k));
    expect_within(law.partners[k].exponent, exponents[k], "m " + std::to_string(k));
  }
  EXPECT_LT(law.error_held_out, 0.05);
  EXPECT_LT(law.error_cross, entry.find(Crowd::bag)->error_cross);
  EXPECT_LT(law.criterion, entry.find(Crowd::bag)->criterion);
  EXPECT_NEAR(entry.solid_fraction, 0.7055, 1e-12);
  EXPECT_NEAR(entry.overlap_max, 0.3, 1e-12);
}

TEST(CrowdFit, ExactDataOfABagGiveTheBag) {
  const auto list = arrangements();
  const CrowdMeasurements data = crowd_measurements(known(Crowd::bag), list, {});
  const auto states = average_states(data);
  StateSelection planes;
  for (std::size_t c = 0; c < 5; ++c) planes.push_back(&states[c]);
  CrowdModel model;
  model.crowd = Crowd::bag;
  model.form.pressure = {0.7, 2.9, 0.08};
  (void)fit_planes(model, planes, 0.01, false);
  EXPECT_NEAR(model.form.pressure.a, 0.62, 1e-6);
  EXPECT_NEAR(model.form.pressure.b, 2.7, 1e-6);
  EXPECT_NEAR(model.form.pressure.delta, 0.07, 1e-6);
  EXPECT_LT(crowd_error(model, states[5]), 1e-6) << "held out";
}

TEST(CrowdFit, DataOfABagGiveTheBag) {
  CrowdOptionsKnown o;
  o.noise = 1e-3;
  auto list = arrangements();
  list.resize(6);  // planes
  const LawTableEntry entry = fit_crowd_laws(crowd_measurements(known(Crowd::bag), list, o), quick());
  const CrowdLaw& bag = *entry.find(Crowd::bag);
  EXPECT_EQ(bag.status, LawStatus::good) << bag.reason;
  expect_within(bag.a, 0.62, "a");
  expect_within(bag.b, 2.7, "b");
  expect_within(bag.delta, 0.07, "delta");
  EXPECT_EQ(bag.m0.value, 1.0);
  EXPECT_LT(bag.error_held_out, 1e-3);
  EXPECT_LT(bag.error_cross, 1e-3);
  const CrowdLaw& directional = *entry.find(Crowd::directional);
  EXPECT_NEAR(directional.m0.value, 1.0, 1e-2);
  EXPECT_NEAR(directional.m1.value, 0.0, 1e-2);
  EXPECT_NEAR(directional.m2.value, 0.0, 1e-2);
  EXPECT_GT(entry.find(Crowd::pair)->error_cross, 0.3);
}

TEST(CrowdFit, HeldOutConfigurationsDoNotMatter) {
  CrowdOptionsKnown o;
  o.noise = 0.05;
  auto list = arrangements();
  list.push_back(crowd_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.25, CrowdMove::unload));
  list.push_back(crowd_configuration(Arrangement::opposite, PartnerKind::plane, 0.0, 0.25, CrowdMove::slide));
  for (std::size_t c = list.size() - 2; c < list.size(); ++c) list[c].held_out = true;
  CrowdMeasurements data = crowd_measurements(known(Crowd::directional), list, o);
  CrowdFitOptions options = quick();
  options.replicates = 3;
  const LawTableEntry a = fit_crowd_laws(data, options);
  for (CrowdRun& run : data.runs)
    if (list[static_cast<std::size_t>(run.configuration)].held_out)
      for (CrowdPoint& p : run.points)
        for (double& f : p.normal) f *= 1.2;
  const LawTableEntry b = fit_crowd_laws(data, options);
  for (std::size_t k = 0; k < a.laws.size(); ++k) {
    for (const CrowdParameterName& p : kCrowdParameters) {
      EXPECT_EQ((a.laws[k].*p.estimate).value, (b.laws[k].*p.estimate).value) << p.key;
      EXPECT_EQ((a.laws[k].*p.estimate).low, (b.laws[k].*p.estimate).low) << p.key;
    }
    for (std::size_t r = 0; r < a.laws[k].partners.size(); ++r)
      EXPECT_EQ(a.laws[k].partners[r].weight.value, b.laws[k].partners[r].weight.value);
    EXPECT_NE(a.laws[k].error_held_out, b.laws[k].error_held_out);
    EXPECT_EQ(a.laws[k].error_cross, b.laws[k].error_cross) << "the choice of form does not look at them";
    EXPECT_EQ(a.laws[k].error_fitted, b.laws[k].error_fitted);
  }
  EXPECT_EQ(a.retreat.value, b.retreat.value);
  EXPECT_EQ(a.slide_plane.kt_ratio.value, b.slide_plane.kt_ratio.value);
  EXPECT_TRUE(std::isinf(a.slide_plane.friction.standard_error)) << "held-out slides teach nothing";
}

/// A law that is too hard by a factor and begins too early on a loading: what would put it right is found.
TEST(CrowdFit, WhatPutsALawRightIsAFactorAndAnOnset) {
  const CrowdModel truth = known(Crowd::directional);
  CrowdModel law = truth;
  law.form.pressure.a *= std::exp(0.2);
  law.form.pressure.delta -= 0.015;
  const CrowdMeasurements data = crowd_measurements(truth, arrangements(), {});
  const std::vector<CrowdStates> states = average_states(data);
  const FormOffset off = form_offset(law, states[4], 0.05);
  EXPECT_NEAR(off.force, -0.2, 1e-4);
  EXPECT_NEAR(off.onset, 0.015, 1e-5);
}

/// A soft particle among five planes and a soft one, which has five planes too: either may stand in the middle.
TEST(CrowdFit, WhatTwoPressedSoftParticlesFeelIsTheSameFromEitherSide) {
  constexpr double kRatio = 2.0;
  constexpr double kContact = 0.3;
  const std::vector<Vec3> around{Vec3{{-1.0, 0.0, 0.0}}, Vec3{{0.0, 1.0, 0.0}}, Vec3{{0.0, -1.0, 0.0}},
                                 Vec3{{0.0, 0.0, 1.0}}, Vec3{{0.0, 0.0, -1.0}}};
  const auto seen_from = [&](double other, double own_depth, double other_depth, Crowd form) {
    std::vector<CrowdPartner> partners{{PartnerKind::soft, other, {{1.0, 0.0, 0.0}}}};
    std::vector<double> overlap{kContact * (other > 1.0 ? 1.0 : other)};
    for (const Vec3& n : around) {
      partners.push_back({PartnerKind::plane, 0.0, n});
      overlap.push_back(own_depth);
    }
    for (const Vec3& n : around) {
      partners.push_back({PartnerKind::plane, 0.0, -n, false, 0});
      overlap.push_back(other_depth * other);
    }
    const std::vector<double> force = crowd_forces(known(form), partners, overlap);
    EXPECT_EQ(force.size(), 6U);
    return force;
  };
  for (const Crowd form : {Crowd::pair, Crowd::bag, Crowd::directional}) {
    const double small = seen_from(kRatio, 0.15, 0.1, form)[0];
    const double large = seen_from(1.0 / kRatio, 0.1, 0.15, form)[0];
    EXPECT_NEAR(small, kRatio * kRatio * large, 1e-12 * small);
    const double not_pressed = seen_from(kRatio, 0.15, 0.0, form)[0];
    if (form == Crowd::pair)
      EXPECT_EQ(small, not_pressed) << "it knows of one contact alone";
    else
      EXPECT_GT(small, 1.1 * not_pressed);
  }
}

/// Crowds around free shells: laws of crowds are fitted to them alone, the pair law to one neighbour of a held one.
TEST(CrowdFit, WhereShellsWereFreeHeldOnesServeThePairLawAlone) {
  CrowdModel crowd = known(Crowd::directional);
  crowd.smooth = {0.6, 1.2};
  auto list = arrangements();
  std::vector<CrowdConfiguration> free;
  for (const CrowdConfiguration& c : list) {
    if (c.partners.size() == 1) continue;
    free.push_back(c);
    free.back().centre_free = true;
    free.back().name += "-free";
  }
  free.push_back(crowd_configuration(Arrangement::random_8, PartnerKind::plane, 0.0, 0.2));
  free.push_back(crowd_configuration(Arrangement::cube, PartnerKind::plane, 0.0, 0.2));
  free.back().name = "smooth";
  for (CrowdPartner& p : free.back().partners) p.smooth = true;
  free.push_back(crowd_configuration(Arrangement::tetrahedron, PartnerKind::solid, 0.5, 0.3));
  free.push_back(crowd_configuration(Arrangement::cube, PartnerKind::solid, 2.0, 0.25));
  free.push_back(crowd_configuration(Arrangement::cube, PartnerKind::soft, 1.0, 0.3));
  free.push_back(crowd_configuration(Arrangement::octant, PartnerKind::plane, 0.0, 0.25));
  free.back().name = "mixed";
  free.back().partners[0] = {PartnerKind::solid, 2.0, free.back().partners[0].direction};
  free.back().partners[1] = {PartnerKind::soft, 1.0, free.back().partners[1].direction};
  for (std::size_t k = 5; k < free.size(); ++k) free[k].centre_free = true;
  // Held shells are stiffer: a law that listened to both would be neither.
  CrowdModel held = crowd;
  held.form.pressure.a *= 1.5;
  CrowdMeasurements data = crowd_measurements(crowd, free, {});
  for (CrowdRun& run : data.runs) run.configuration += static_cast<std::int64_t>(list.size());
  const CrowdMeasurements stiff = crowd_measurements(held, list, {});
  data.runs.insert(data.runs.end(), stiff.runs.begin(), stiff.runs.end());
  data.configurations = list;
  data.configurations.insert(data.configurations.end(), free.begin(), free.end());
  const LawTableEntry entry = fit_crowd_laws(data, quick());
  const CrowdLaw& law = *entry.find(Crowd::directional);
  EXPECT_EQ(entry.best, Crowd::directional);
  EXPECT_NEAR(law.a.value, 0.62, 1e-6);
  EXPECT_NEAR(law.m1.value, 0.55, 1e-5);
  EXPECT_NEAR(entry.find(Crowd::pair)->a.value, 1.5 * 0.62, 1e-6);
  const auto smooth = law.rows(PartnerKind::plane);
  ASSERT_EQ(smooth.size(), 1U);
  EXPECT_NEAR(smooth[0].weight.value, 0.6, 1e-5);
  EXPECT_NEAR(smooth[0].exponent.value, 1.2, 1e-5);
  EXPECT_LT(law.error_fitted, 1e-6) << "the mixed one too";
  for (const ConfigurationError& e : law.errors) {
    if (e.name.starts_with("cube-plane") && !e.name.ends_with("free")) {
      EXPECT_EQ(e.use, CrowdUse::apart) << e.name;
    }
    if (e.name == "mixed") {
      EXPECT_EQ(e.use, CrowdUse::fitted);
    }
  }
}

/// Draws of packings without any force have no law: they are counted, and their start values are no replicates.
TEST(CrowdFit, RefitsWithoutAMinimumAreCountedAndLeftOut) {
  auto list = arrangements();
  list.resize(5);
  CrowdOptionsKnown o;
  o.packings = 4;
  o.noise = 0.02;
  CrowdMeasurements data = crowd_measurements(known(Crowd::bag), list, o);
  for (CrowdRun& run : data.runs)
    if (run.packing > 0)
      for (CrowdPoint& p : run.points) std::fill(p.normal.begin(), p.normal.end(), 0.0);
  CrowdFitOptions options = quick();
  options.replicates = 60;
  const LawTableEntry entry = fit_crowd_laws(data, options);
  for (const CrowdLaw& law : entry.laws) {
    EXPECT_GE(law.replicates_failed, 9) << to_string(law.form)
                                        << ": a third of the draws is without the one packing with force";
    EXPECT_EQ(law.replicates.size(), 60U) << to_string(law.form) << ": further draws stand in for them";
  }
}

TEST(CrowdFit, ARefitThatStalledIsNoRefit) {
  FormFit fit;
  fit.partners.push_back({PartnerKind::solid, {1.0}, {}, 3});
  LeastSquaresFit& solid = fit.partners.front().fit;
  fit.planes.end = solid.end = FitEnd::converged;
  EXPECT_EQ(fit.trouble(), "");
  solid.rank_deficient = true;  // a weight that is not determined says so by its error
  EXPECT_EQ(fit.trouble(), "");
  solid.end = FitEnd::stalled;
  solid.message = "stalled: far";
  EXPECT_EQ(fit.trouble(), "solid neighbours: stalled: far");
  fit.planes.rank_deficient = true;
  EXPECT_EQ(fit.trouble().substr(0, 6), "planes");
}

/// A law that is far off on what it has not seen is marked, whatever its fit; which form is best does not depend on it.
TEST(CrowdFit, ALawFarOffOnWhatWasHeldOutIsInaccurate) {
  CrowdOptionsKnown o;
  o.noise = 0.01;
  auto list = arrangements();
  CrowdMeasurements data = crowd_measurements(known(Crowd::directional), list, o);
  CrowdFitOptions options = quick();
  const LawTableEntry near = fit_crowd_laws(data, options);
  EXPECT_EQ(near.find(near.best)->status, LawStatus::good);
  for (CrowdRun& run : data.runs)
    if (list[static_cast<std::size_t>(run.configuration)].held_out)
      for (CrowdPoint& p : run.points)
        for (double& f : p.normal) f *= 3.0;
  const LawTableEntry far = fit_crowd_laws(data, options);
  EXPECT_EQ(far.best, near.best);
  const CrowdLaw& law = *far.find(far.best);
  EXPECT_EQ(law.status, LawStatus::inaccurate);
  EXPECT_NE(law.reason.find("loadings that were held out; at most 50 % are allowed"), std::string::npos) << law.reason;
  CrowdLawFit fit;
  add_entry(fit, data, options, 0.04);
  EXPECT_FALSE(fit.usable);
  options.largest_error = 0.9;
  EXPECT_EQ(fit_crowd_laws(data, options).find(far.best)->status, LawStatus::good);
}

TEST(CrowdFit, WithOneLoadingThereIsNothingToLeaveOut) {
  CrowdOptionsKnown o;
  o.noise = 0.01;
  const LawTableEntry entry = fit_crowd_laws(crowd_measurements(known(Crowd::bag), {arrangements()[0]}, o), quick());
  for (const CrowdLaw& law : entry.laws) EXPECT_TRUE(std::isnan(law.error_cross)) << to_string(law.form);
  EXPECT_EQ(entry.best, Crowd::pair);
}

TEST(CrowdFit, BelowTheThresholdThereIsNoLaw) {
  std::vector<CrowdConfiguration> list{crowd_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.06)};
  EXPECT_THROW((void)fit_crowd_laws(crowd_measurements(known(Crowd::bag), list, {}), quick()), NotUsable);
  list[0] = crowd_configuration(Arrangement::opposite, PartnerKind::plane, 0.0, 0.2);  // not one plane alone
  EXPECT_THROW((void)fit_crowd_laws(crowd_measurements(known(Crowd::bag), list, {}), quick()), NotUsable);
}

TEST(CrowdFit, TooFewPackingsAreBadInput) {
  CrowdOptionsKnown o;
  o.packings = 3;
  EXPECT_THROW((void)fit_crowd_laws(crowd_measurements(known(Crowd::bag), arrangements(), o), quick()), BadInput);
}

TEST(CrowdFit, TheSeedDecidesTheReplicates) {
  CrowdOptionsKnown o;
  o.noise = 0.1;
  auto list = arrangements();
  list.resize(5);
  const CrowdMeasurements data = crowd_measurements(known(Crowd::bag), list, o);
  CrowdFitOptions options = quick();
  options.replicates = 12;
  const LawTableEntry a = fit_crowd_laws(data, options);
  const LawTableEntry b = fit_crowd_laws(data, options);
  EXPECT_EQ(a.laws[1].a.low, b.laws[1].a.low);
  EXPECT_LT(a.laws[1].a.low, a.laws[1].a.value);
  EXPECT_GT(a.laws[1].a.high, a.laws[1].a.value);
  options.seed = 2;
  EXPECT_NE(fit_crowd_laws(data, options).laws[1].a.low, a.laws[1].a.low);
}

}  // namespace
}  // namespace softgrain
