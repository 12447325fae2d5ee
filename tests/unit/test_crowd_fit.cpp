// Fits of crowd laws to measurements made from a known law.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calibrate/crowd_fit.h"
#include "calibrate/crowd_form_fit.h"
#include "calibrate/crowd_states.h"
#include "common/contact/crowd_from_table.h"
#include "common/core/error.h"
#include "pipelines/kinds/law_table/crowd_law_fit.h"
#include "tests/support/synthetic_crowd.h"

namespace softgrain {
namespace {

using synthetic::crowd_configuration;
using synthetic::crowd_measurements;
using synthetic::CrowdOptionsKnown;

CrowdModel known(Crowd crowd) {
  CrowdModel model;
  model.crowd = crowd;
  model.form.pressure = {0.62, 2.7, 0.07};
  if (crowd == Crowd::directional) model.form.coupling = {0.65, 0.55, 0.15};
  set_partners(model, PartnerKind::solid, {0.5, 2.0}, {std::log(0.7), std::log(0.85)}, 1.1);
  set_partners(model, PartnerKind::soft, {1.0, 2.0}, {std::log(0.4), std::log(0.5)}, 1.25);
  return model;
}

std::vector<CrowdConfiguration> arrangements() {
  std::vector<CrowdConfiguration> list{crowd_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.3),
                                       crowd_configuration(Arrangement::opposite, PartnerKind::plane, 0.0, 0.25),
                                       crowd_configuration(Arrangement::orthogonal, PartnerKind::plane, 0.0, 0.25),
                                       crowd_configuration(Arrangement::tetrahedron, PartnerKind::plane, 0.0, 0.2),
                                       crowd_configuration(Arrangement::cube, PartnerKind::plane, 0.0, 0.18),
                                       crowd_configuration(Arrangement::icosahedron, PartnerKind::plane, 0.0, 0.13),
                                       crowd_configuration(Arrangement::one, PartnerKind::solid, 0.5, 0.35),
                                       crowd_configuration(Arrangement::one, PartnerKind::solid, 2.0, 0.3),
                                       crowd_configuration(Arrangement::one, PartnerKind::soft, 1.0, 0.35),
                                       crowd_configuration(Arrangement::opposite, PartnerKind::soft, 2.0, 0.35)};
  list[5].held_out = true;
  return list;
}

CrowdFitOptions quick(double discrepancy = 0.01) {
  CrowdFitOptions o;
  o.discrepancy = discrepancy;
  o.replicates = 0;
  return o;
}

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

/// The same loading of the same packings is no new data: it is fitted once, and not at all when it is held out.
TEST(CrowdFit, ALoadingIsUsedOnce) {
  std::vector<CrowdConfiguration> list{
      crowd_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.3),
      crowd_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.25, CrowdMove::unload),
      crowd_configuration(Arrangement::cube, PartnerKind::plane, 0.0, 0.15, CrowdMove::slide),
      crowd_configuration(Arrangement::cube, PartnerKind::plane, 0.0, 0.2),
      crowd_configuration(Arrangement::one, PartnerKind::solid, 1.0, 0.3),
      crowd_configuration(Arrangement::cube, PartnerKind::plane, 0.0, 0.2)};
  list[3].held_out = true;
  list[5].centre_free = true;
  const CrowdMeasurements data = crowd_measurements(known(Crowd::bag), list, {});
  const auto states = average_states(data);
  const CrowdUse expected[] = {CrowdUse::fitted,    CrowdUse::repeated, CrowdUse::repeated,
                               CrowdUse::predicted, CrowdUse::fitted,   CrowdUse::repeated};
  for (std::size_t k = 0; k < list.size(); ++k) EXPECT_EQ(states[k].use, expected[k]) << k;
  list[3].held_out = false;
  const CrowdMeasurements all = crowd_measurements(known(Crowd::bag), list, {});
  EXPECT_EQ(average_states(all)[2].use, CrowdUse::repeated);
  EXPECT_EQ(average_states(all)[3].use, CrowdUse::fitted) << "the deepest of its loading";
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

TEST(CrowdFit, SlidesAndRetreatsGiveTheirNumbers) {
  const CrowdModel model = known(Crowd::directional);
  auto list = arrangements();
  list.push_back(crowd_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.25, CrowdMove::unload));
  list.push_back(crowd_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.25, CrowdMove::slide));
  CrowdOptionsKnown o;
  o.retreat = 1.6;
  o.kt = 0.06;
  o.limit = 0.21;
  const LawTableEntry entry = fit_crowd_laws(crowd_measurements(model, list, o), quick());
  EXPECT_NEAR(entry.retreat.value, 1.6, 1e-3);
  EXPECT_NEAR(entry.slide_plane.friction.value, 0.21, 1e-9);
  const CrowdPartner plane{PartnerKind::plane, 0.0, {{1.0, 0.0, 0.0}}};
  const double kn =
      (crowd_forces(model, {plane}, {0.25 + 1e-5})[0] - crowd_forces(model, {plane}, {0.25 - 1e-5})[0]) / 2e-5;
  EXPECT_NEAR(entry.slide_plane.kt_ratio.value, 0.06 / kn, 1e-3 * 0.06 / kn);
  EXPECT_EQ(entry.slide_solid.friction.value, entry.slide_plane.friction.value) << "solid spheres slide like planes";
  EXPECT_EQ(entry.retreat_of(entry.slide_solid).value, entry.retreat.value) << "and come back like them";
}

/// A path that shears begins like a plain loading and is another one; that of a slide is the same.
TEST(CrowdFit, APathThatGoesOnLoadingIsALoadingOfItsOwn) {
  auto list = arrangements();
  CrowdConfiguration sheared = list[4];
  sheared.name = "sheared";
  sheared.stages.push_back({CrowdMove::load, {0.24, 0.24, 0.14, 0.14, 0.14, 0.14}});
  CrowdConfiguration shallow = sheared;
  shallow.name = "half of it";
  for (CrowdStage& s : shallow.stages)
    for (double& h : s.overlap) h *= 0.5;
  list.push_back(sheared);
  list.push_back(shallow);
  list.push_back(crowd_configuration(Arrangement::cube, PartnerKind::plane, 0.0, 0.17, CrowdMove::slide));
  const CrowdMeasurements data = crowd_measurements(known(Crowd::bag), list, {});
  const std::vector<CrowdStates> states = average_states(data);
  EXPECT_EQ(states[4].use, CrowdUse::fitted);
  EXPECT_EQ(states[10].use, CrowdUse::fitted);
  EXPECT_EQ(states[11].use, CrowdUse::repeated);
  EXPECT_EQ(states[12].use, CrowdUse::repeated);
  list[10].held_out = true;
  const CrowdMeasurements out = crowd_measurements(known(Crowd::bag), list, {});
  EXPECT_EQ(average_states(out)[10].use, CrowdUse::predicted);
  EXPECT_EQ(average_states(out)[4].use, CrowdUse::fitted);
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

TEST(CrowdFit, EveryKindOfNeighbourComesBackInItsOwnWay) {
  const CrowdModel model = known(Crowd::directional);
  auto list = arrangements();
  const std::size_t first = list.size();
  list.push_back(crowd_configuration(Arrangement::cube, PartnerKind::plane, 0.0, 0.18, CrowdMove::unload));
  list.push_back(crowd_configuration(Arrangement::one, PartnerKind::solid, 2.0, 0.3, CrowdMove::unload));
  list.push_back(crowd_configuration(Arrangement::opposite, PartnerKind::soft, 1.0, 0.35, CrowdMove::unload));
  CrowdMeasurements data = crowd_measurements(model, list, {});
  const double steep[] = {1.2, 1.4, 1.7};
  for (std::size_t k = 0; k < 3; ++k) {
    CrowdOptionsKnown o;
    o.retreat = steep[k];
    const CrowdMeasurements own = crowd_measurements(model, list, o);
    for (std::size_t r = 0; r < data.runs.size(); ++r)
      if (own.runs[r].configuration == static_cast<std::int64_t>(first + k)) data.runs[r] = own.runs[r];
  }
  const LawTableEntry entry = fit_crowd_laws(data, quick());
  EXPECT_NEAR(entry.retreat.value, 1.2, 1e-3);
  EXPECT_NEAR(entry.retreat_of(entry.slide_plane).value, 1.2, 1e-3);
  ASSERT_TRUE(entry.slide_solid.retreats && entry.slide_soft.retreats);
  EXPECT_NEAR(entry.slide_solid.retreat.value, 1.4, 1e-3);
  EXPECT_NEAR(entry.retreat_of(entry.slide_soft).value, 1.7, 1e-3);
}

/// A soft neighbour that gives way: the law is far off its force, and kt/kn is still over the stiffness it has.
TEST(CrowdFit, TheStiffnessAgainstASlideIsOverThatOfTheForceThatWasMeasured) {
  const CrowdModel model = known(Crowd::directional);
  auto list = arrangements();
  list.push_back(crowd_configuration(Arrangement::cube, PartnerKind::plane, 0.0, 0.17, CrowdMove::slide));
  CrowdOptionsKnown o;
  o.kt = 0.06;
  CrowdMeasurements data = crowd_measurements(model, list, o);
  const double full = fit_crowd_laws(data, quick()).slide_plane.kt_ratio.value;
  for (CrowdRun& run : data.runs)
    if (run.configuration == static_cast<std::int64_t>(list.size()) - 1)
      for (CrowdPoint& p : run.points) {
        for (double& f : p.normal) f *= 0.5;
        for (Vec3& t : p.tangential) t *= 0.5;
      }
  EXPECT_NEAR(fit_crowd_laws(data, quick()).slide_plane.kt_ratio.value, full, 1e-6 * full);
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

TEST(CrowdFit, RollsGiveStiffnessAndLimit) {
  auto list = arrangements();
  for (const PartnerKind kind : {PartnerKind::plane, PartnerKind::soft})
    list.push_back(
        crowd_configuration(Arrangement::cube, kind, kind == PartnerKind::plane ? 0.0 : 2.0, 0.25, CrowdMove::roll));
  CrowdOptionsKnown o;
  o.rolling = 0.005;
  o.points = 40;
  const auto fitted = [&](double friction) {
    o.rolling_friction = friction;
    return fit_crowd_laws(crowd_measurements(known(Crowd::directional), list, o), quick());
  };
  LawTableEntry entry = fitted(10.0);  // never reached
  EXPECT_TRUE(entry.slide_plane.rolls);
  EXPECT_NEAR(entry.slide_plane.rolling.value, 0.005, 1e-9);
  // Of unequal soft particles by the harmonic mean of both radii, 4/3 Rs.
  EXPECT_NEAR(entry.slide_soft.rolling.value, 0.005 * 9.0 / 16.0, 1e-9);
  entry = fitted(0.001);  // reached early
  EXPECT_NEAR(entry.slide_plane.rolling_friction.value, 0.001, 1e-9);
  EXPECT_NEAR(entry.slide_soft.rolling_friction.value, 0.001 * 0.75, 1e-9);
  EXPECT_FALSE(entry.slide_solid.rolls) << "nothing rolled on solid spheres";
  EXPECT_FALSE(entry.slide_plane.measured) << "nor did anything slide";
}

/// What was slid back, pressed on or came at an angle is not what the definitions speak of.
TEST(CrowdFit, OtherPathsGiveNoFrictionLimit) {
  auto list = arrangements();
  CrowdConfiguration back = crowd_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.25, CrowdMove::slide);
  back.stages.push_back({CrowdMove::slide, back.stages[0].overlap, 0.2});
  list.push_back(back);
  CrowdConfiguration oblique = crowd_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.3);
  oblique.name = "oblique";
  oblique.stages = {{CrowdMove::oblique, {0.3}, 0.2}};
  list.push_back(oblique);
  CrowdMeasurements data = crowd_measurements(known(Crowd::directional), list, {});
  const auto states = average_states(data);
  EXPECT_EQ(states.back().use, CrowdUse::repeated) << "no loading";
  EXPECT_TRUE(loading_states(states.back()).empty());
  const LawTableEntry entry = fit_crowd_laws(data, quick());
  EXPECT_FALSE(entry.slide_plane.measured);
}

/// Errors of one configuration are those of its packings; of two that differ, the difference is in them too.
TEST(CrowdFit, ErrorsOfSlidesAndRetreatsAreThoseOfPackingsAndConfigurations) {
  const CrowdModel model = known(Crowd::bag);
  auto list = arrangements();
  list.resize(5);
  list.push_back(crowd_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.25, CrowdMove::unload));
  list.push_back(crowd_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.25, CrowdMove::slide));
  CrowdOptionsKnown o;
  o.noise = 0.1;
  o.retreat = 1.6;
  o.kt = 0.06;
  CrowdFitOptions options = quick();
  options.replicates = 40;
  const LawTableEntry one = fit_crowd_laws(crowd_measurements(model, list, o), options);
  const auto expect_interval = [](const Estimate& e, const char* what) {
    EXPECT_GT(e.standard_error, 1e-4 * e.value) << what;
    EXPECT_LT(e.standard_error, 0.5 * e.value) << what;
    EXPECT_LT(e.low, e.value) << what;
    EXPECT_GT(e.high, e.value) << what;
    EXPECT_GT(e.high - e.low, 2.0 * e.standard_error) << what;
    EXPECT_LT(e.high - e.low, 6.0 * e.standard_error) << what;
  };
  expect_interval(one.slide_plane.kt_ratio, "kt/kn");
  expect_interval(one.slide_plane.friction, "friction");
  expect_interval(one.retreat, "retreat");
  for (const SlideLaw& borrowed : {one.slide_solid, one.slide_soft}) {
    EXPECT_EQ(borrowed.friction.value, one.slide_plane.friction.value);
    EXPECT_TRUE(std::isinf(borrowed.friction.standard_error)) << "of other neighbours nothing was measured";
    EXPECT_TRUE(std::isinf(borrowed.kt_ratio.high));
  }

  // Another configuration that slides three times as hard.
  list.push_back(crowd_configuration(Arrangement::opposite, PartnerKind::plane, 0.0, 0.25, CrowdMove::slide));
  CrowdMeasurements apart = crowd_measurements(model, list, o);
  for (CrowdRun& run : apart.runs)
    if (run.configuration == static_cast<std::int64_t>(list.size()) - 1)
      for (CrowdPoint& p : run.points) p.tangential[0] = p.tangential[0] * 3.0;
  const LawTableEntry two = fit_crowd_laws(apart, options);
  EXPECT_GT(two.slide_plane.kt_ratio.standard_error, 3.0 * one.slide_plane.kt_ratio.standard_error);

  options.replicates = 9;  // too few to say anything
  const LawTableEntry few = fit_crowd_laws(crowd_measurements(model, list, o), options);
  EXPECT_TRUE(std::isinf(few.slide_plane.friction.standard_error));
  EXPECT_TRUE(std::isinf(few.retreat.standard_error));
  EXPECT_EQ(few.retreat.low, -std::numeric_limits<double>::infinity());
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
    EXPECT_EQ(law.replicates.size() + static_cast<std::size_t>(law.replicates_failed), 60U) << to_string(law.form);
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

TEST(CrowdStates, WeightsAreRepetitions) {
  CrowdOptionsKnown o;
  o.noise = 0.1;
  o.packings = 4;
  const CrowdMeasurements data = crowd_measurements(known(Crowd::bag), arrangements(), o);
  CrowdMeasurements repeated = data;
  repeated.runs.clear();
  for (const CrowdRun& run : data.runs)
    for (int k = 0; k < (run.packing == 0 ? 2 : run.packing == 1 ? 0 : 1); ++k) repeated.runs.push_back(run);
  const auto weighted = average_states(data, {2.0, 0.0, 1.0, 1.0});
  const auto plain = average_states(repeated);
  ASSERT_EQ(weighted.size(), plain.size());
  for (std::size_t c = 0; c < plain.size(); ++c) {
    ASSERT_EQ(weighted[c].states.size(), plain[c].states.size());
    for (std::size_t s = 0; s < plain[c].states.size(); ++s)
      for (std::size_t k = 0; k < plain[c].states[s].mean.size(); ++k) {
        EXPECT_DOUBLE_EQ(weighted[c].states[s].mean[k], plain[c].states[s].mean[k]);
        EXPECT_NEAR(weighted[c].states[s].error[k], plain[c].states[s].error[k], 1e-9 * plain[c].states[s].error[k]);
      }
  }
}

/// Mean and sqrt(sum (x - mean)^2/(n (n - 1))) over packings.
TEST(CrowdStates, ErrorsAreThoseOfAMean) {
  CrowdOptionsKnown o;
  o.noise = 0.1;
  o.packings = 3;
  const CrowdMeasurements data = crowd_measurements(known(Crowd::bag), {arrangements()[0]}, o);
  const auto states = average_states(data);
  ASSERT_EQ(data.runs.size(), 3U);
  const std::size_t last = states[0].states.size() - 1;
  std::vector<double> force;
  for (const CrowdRun& run : data.runs) force.push_back(run.points[last].normal[0]);
  const double mean = (force[0] + force[1] + force[2]) / 3.0;
  double squares = 0.0;
  for (const double f : force) squares += (f - mean) * (f - mean);
  ASSERT_GT(squares, 0.0);
  EXPECT_NEAR(states[0].states[last].mean[0], mean, 1e-12 * mean);
  EXPECT_NEAR(states[0].states[last].error[0] / std::sqrt(squares / 6.0), 1.0, 1e-6);
}

TEST(CrowdStates, WhatDidNotConvergeDoesNotCount) {
  CrowdOptionsKnown o;
  o.packings = 3;
  CrowdMeasurements data = crowd_measurements(known(Crowd::bag), {arrangements()[0]}, o);
  const auto all = average_states(data);
  data.runs[0].points[4].converged = false;
  data.runs[0].points[4].normal[0] = 1e9;
  for (CrowdRun& run : data.runs) run.points[5].converged = run.packing == 2;  // one alone is no mean
  const auto states = average_states(data);
  ASSERT_EQ(states[0].states.size(), all[0].states.size() - 1);
  EXPECT_EQ(states[0].states[4].packings, 2);
  EXPECT_DOUBLE_EQ(states[0].states[4].mean[0], all[0].states[4].mean[0]);
}

}  // namespace
}  // namespace softgrain
