// Fits of multi-contact laws to measurements made from a known law.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calibrate/multi_contact_fit.h"
#include "calibrate/multi_contact_states.h"
#include "common/contact/make_laws.h"
#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "pipelines/kinds/law_table/multi_contact_law_fit.h"
#include "tests/support/known_multi_contact.h"

namespace softgrain {
namespace {

using synthetic::arrangements;
using synthetic::known;
using synthetic::multi_contact_configuration;
using synthetic::multi_contact_measurements;
using synthetic::MultiContactOptionsKnown;
using synthetic::quick;

void expect_within(const Estimate& e, double value, const std::string& what) {
  EXPECT_GT(e.standard_error, 0.0) << what;
  EXPECT_NEAR(e.value, value, 3.0 * e.standard_error) << what;
}

TEST(MultiContactFit, RecoversAKnownLawWithinItsErrors) {
  MultiContactOptionsKnown o;
  o.noise = 0.05;
  const MultiContactModel model = known(LawForm::directional);
  MultiContactFitOptions options = quick();
  options.replicates = 30;  // errors of neighbours come from them
  const LawTableEntry entry = fit_multi_contact_laws(multi_contact_measurements(model, arrangements(), o), options);
  EXPECT_EQ(entry.best, LawForm::directional);
  options.best = LawForm::isotropic;
  options.replicates = 0;
  EXPECT_EQ(fit_multi_contact_laws(multi_contact_measurements(model, arrangements(), o), options).best,
            LawForm::isotropic)
      << "asked for";
  const MultiContactLaw& law = *entry.find(LawForm::directional);
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
  EXPECT_LT(law.error_cross, entry.find(LawForm::isotropic)->error_cross);
  EXPECT_LT(law.criterion, entry.find(LawForm::isotropic)->criterion);
  EXPECT_NEAR(entry.solid_fraction, 0.7055, 1e-12);
  EXPECT_NEAR(entry.overlap_max, 0.3, 1e-12);
}

TEST(MultiContactFit, ExactDataOfABagGiveTheBag) {
  const auto list = arrangements();
  const MultiContactMeasurements data = multi_contact_measurements(known(LawForm::isotropic), list, {});
  const auto states = average_states(data);
  StateSelection planes;
  for (std::size_t c = 0; c < 5; ++c) planes.push_back(&states[c]);
  MultiContactModel model;
  model.multi_contact = LawForm::isotropic;
  model.form.pressure = {0.7, 2.9, 0.08};
  (void)fit_planes(model, planes, 0.01, false);
  EXPECT_NEAR(model.form.pressure.a, 0.62, 1e-6);
  EXPECT_NEAR(model.form.pressure.b, 2.7, 1e-6);
  EXPECT_NEAR(model.form.pressure.delta, 0.07, 1e-6);
  EXPECT_LT(multi_contact_error(model, states[5]), 1e-6) << "held out";
}

TEST(MultiContactFit, DataOfABagGiveTheBag) {
  MultiContactOptionsKnown o;
  o.noise = 1e-3;
  auto list = arrangements();
  list.resize(6);  // planes
  const LawTableEntry entry =
      fit_multi_contact_laws(multi_contact_measurements(known(LawForm::isotropic), list, o), quick());
  const MultiContactLaw& bag = *entry.find(LawForm::isotropic);
  EXPECT_EQ(bag.status, LawStatus::good) << bag.reason;
  expect_within(bag.a, 0.62, "a");
  expect_within(bag.b, 2.7, "b");
  expect_within(bag.delta, 0.07, "delta");
  EXPECT_EQ(bag.m0.value, 1.0);
  EXPECT_LT(bag.error_held_out, 1e-3);
  EXPECT_LT(bag.error_cross, 1e-3);
  const MultiContactLaw& directional = *entry.find(LawForm::directional);
  EXPECT_NEAR(directional.m0.value, 1.0, 1e-2);
  EXPECT_NEAR(directional.m1.value, 0.0, 1e-2);
  EXPECT_NEAR(directional.m2.value, 0.0, 1e-2);
  EXPECT_GT(entry.find(LawForm::pair)->error_cross, 0.3);
}

TEST(MultiContactFit, HeldOutConfigurationsDoNotMatter) {
  MultiContactOptionsKnown o;
  o.noise = 0.05;
  auto list = arrangements();
  list.push_back(
      multi_contact_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.25, MultiContactMove::unload));
  list.push_back(
      multi_contact_configuration(Arrangement::opposite, PartnerKind::plane, 0.0, 0.25, MultiContactMove::slide));
  for (std::size_t c = list.size() - 2; c < list.size(); ++c) list[c].held_out = true;
  MultiContactMeasurements data = multi_contact_measurements(known(LawForm::directional), list, o);
  MultiContactFitOptions options = quick();
  options.replicates = 3;
  const LawTableEntry a = fit_multi_contact_laws(data, options);
  for (MultiContactRun& run : data.runs)
    if (list[static_cast<std::size_t>(run.configuration)].held_out)
      for (MultiContactPoint& p : run.points)
        for (double& f : p.normal) f *= 1.2;
  const LawTableEntry b = fit_multi_contact_laws(data, options);
  for (std::size_t k = 0; k < a.laws.size(); ++k) {
    for (const MultiContactParameterName& p : kMultiContactParameters) {
      EXPECT_EQ((a.laws[k].*p.estimate).value, (b.laws[k].*p.estimate).value) << p.key;
      EXPECT_EQ((a.laws[k].*p.estimate).low, (b.laws[k].*p.estimate).low) << p.key;
    }
    for (std::size_t r = 0; r < a.laws[k].partners.size(); ++r)
      EXPECT_EQ(a.laws[k].partners[r].weight.value, b.laws[k].partners[r].weight.value);
    EXPECT_NE(a.laws[k].error_held_out, b.laws[k].error_held_out);
    EXPECT_EQ(a.laws[k].error_cross, b.laws[k].error_cross) << "the choice of form does not look at them";
    EXPECT_EQ(a.laws[k].error_fitted, b.laws[k].error_fitted);
  }
  EXPECT_EQ(a.unloading.value, b.unloading.value);
  EXPECT_EQ(a.slide_plane.kt_ratio.value, b.slide_plane.kt_ratio.value);
  EXPECT_TRUE(std::isinf(a.slide_plane.friction.standard_error)) << "held-out slides teach nothing";
}

/// A law that is too hard by a factor and begins too early on a loading: what would put it right is found.
TEST(MultiContactFit, WhatPutsALawRightIsAFactorAndAnOnset) {
  const MultiContactModel truth = known(LawForm::directional);
  MultiContactModel law = truth;
  law.form.pressure.a *= std::exp(0.2);
  law.form.pressure.delta -= 0.015;
  const MultiContactMeasurements data = multi_contact_measurements(truth, arrangements(), {});
  const std::vector<MultiContactStates> states = average_states(data);
  const FormOffset off = form_offset(law, states[4], 0.05);
  EXPECT_NEAR(off.force, -0.2, 1e-4);
  EXPECT_NEAR(off.onset, 0.015, 1e-5);
}

/// A soft particle among five planes and a soft one, which has five planes too: either may stand in the middle.
TEST(MultiContactFit, WhatTwoPressedSoftParticlesFeelIsTheSameFromEitherSide) {
  constexpr double kRatio = 2.0;
  constexpr double kContact = 0.3;
  const std::vector<Vec3> around{Vec3{{-1.0, 0.0, 0.0}}, Vec3{{0.0, 1.0, 0.0}}, Vec3{{0.0, -1.0, 0.0}},
                                 Vec3{{0.0, 0.0, 1.0}}, Vec3{{0.0, 0.0, -1.0}}};
  const auto seen_from = [&](double other, double own_depth, double other_depth, LawForm form) {
    std::vector<MultiContactPartner> partners{{PartnerKind::soft, other, {{1.0, 0.0, 0.0}}}};
    std::vector<double> overlap{kContact * (other > 1.0 ? 1.0 : other)};
    for (const Vec3& n : around) {
      partners.push_back({PartnerKind::plane, 0.0, n});
      overlap.push_back(own_depth);
    }
    for (const Vec3& n : around) {
      partners.push_back({PartnerKind::plane, 0.0, -n, false, 0});
      overlap.push_back(other_depth * other);
    }
    const std::vector<double> force = multi_contact_forces(known(form), partners, overlap);
    EXPECT_EQ(force.size(), 6U);
    return force;
  };
  for (const LawForm form : {LawForm::pair, LawForm::isotropic, LawForm::directional}) {
    const double small = seen_from(kRatio, 0.15, 0.1, form)[0];
    const double large = seen_from(1.0 / kRatio, 0.1, 0.15, form)[0];
    EXPECT_NEAR(small, kRatio * kRatio * large, 1e-12 * small);
    const double not_pressed = seen_from(kRatio, 0.15, 0.0, form)[0];
    if (form == LawForm::pair)
      EXPECT_EQ(small, not_pressed) << "it knows of one contact alone";
    else
      EXPECT_GT(small, 1.1 * not_pressed);
  }
}

/// Configurations around free shells: multi-contact laws are fitted to them alone, the pair law to one neighbour of a
/// held one.
TEST(MultiContactFit, WhereShellsWereFreeHeldOnesServeThePairLawAlone) {
  MultiContactModel multi_contact = known(LawForm::directional);
  multi_contact.smooth = {0.6, 1.2};
  auto list = arrangements();
  std::vector<MultiContactConfiguration> free;
  for (const MultiContactConfiguration& c : list) {
    if (c.partners.size() == 1) continue;
    free.push_back(c);
    free.back().centre_free = true;
    free.back().name += "-free";
  }
  free.push_back(multi_contact_configuration(Arrangement::random_8, PartnerKind::plane, 0.0, 0.2));
  free.push_back(multi_contact_configuration(Arrangement::cube, PartnerKind::plane, 0.0, 0.2));
  free.back().name = "smooth";
  for (MultiContactPartner& p : free.back().partners) p.smooth = true;
  free.push_back(multi_contact_configuration(Arrangement::tetrahedron, PartnerKind::solid, 0.5, 0.3));
  free.push_back(multi_contact_configuration(Arrangement::cube, PartnerKind::solid, 2.0, 0.25));
  free.push_back(multi_contact_configuration(Arrangement::cube, PartnerKind::soft, 1.0, 0.3));
  free.push_back(multi_contact_configuration(Arrangement::octant, PartnerKind::plane, 0.0, 0.25));
  free.back().name = "mixed";
  free.back().partners[0] = {PartnerKind::solid, 2.0, free.back().partners[0].direction};
  free.back().partners[1] = {PartnerKind::soft, 1.0, free.back().partners[1].direction};
  for (std::size_t k = 5; k < free.size(); ++k) free[k].centre_free = true;
  // Held shells are stiffer: a law that listened to both would be neither.
  MultiContactModel held = multi_contact;
  held.form.pressure.a *= 1.5;
  MultiContactMeasurements data = multi_contact_measurements(multi_contact, free, {});
  for (MultiContactRun& run : data.runs) run.configuration += static_cast<std::int64_t>(list.size());
  const MultiContactMeasurements stiff = multi_contact_measurements(held, list, {});
  data.runs.insert(data.runs.end(), stiff.runs.begin(), stiff.runs.end());
  data.configurations = list;
  data.configurations.insert(data.configurations.end(), free.begin(), free.end());
  const LawTableEntry entry = fit_multi_contact_laws(data, quick());
  const MultiContactLaw& law = *entry.find(LawForm::directional);
  EXPECT_EQ(entry.best, LawForm::directional);
  EXPECT_NEAR(law.a.value, 0.62, 1e-6);
  EXPECT_NEAR(law.m1.value, 0.55, 1e-5);
  EXPECT_NEAR(entry.find(LawForm::pair)->a.value, 1.5 * 0.62, 1e-6);
  const auto smooth = law.rows(PartnerKind::plane);
  ASSERT_EQ(smooth.size(), 1U);
  EXPECT_NEAR(smooth[0].weight.value, 0.6, 1e-5);
  EXPECT_NEAR(smooth[0].exponent.value, 1.2, 1e-5);
  EXPECT_LT(law.error_fitted, 1e-6) << "the mixed one too";
  for (const ConfigurationError& e : law.errors) {
    if (e.name.starts_with("cube-plane") && !e.name.ends_with("free")) {
      EXPECT_EQ(e.use, MultiContactUse::apart) << e.name;
    }
    if (e.name == "mixed") {
      EXPECT_EQ(e.use, MultiContactUse::fitted);
    }
  }
}

/// Draws of packings without any force have no law: they are counted, and their start values are no replicates.
TEST(MultiContactFit, RefitsWithoutAMinimumAreCountedAndLeftOut) {
  auto list = arrangements();
  list.resize(5);
  MultiContactOptionsKnown o;
  o.packings = 4;
  o.noise = 0.02;
  MultiContactMeasurements data = multi_contact_measurements(known(LawForm::isotropic), list, o);
  for (MultiContactRun& run : data.runs)
    if (run.packing > 0)
      for (MultiContactPoint& p : run.points) std::fill(p.normal.begin(), p.normal.end(), 0.0);
  MultiContactFitOptions options = quick();
  options.replicates = 60;
  const LawTableEntry entry = fit_multi_contact_laws(data, options);
  for (const MultiContactLaw& law : entry.laws) {
    EXPECT_GE(law.replicates_failed, 9) << to_string(law.form)
                                        << ": a third of the draws is without the one packing with force";
    EXPECT_EQ(law.replicates.size(), 60U) << to_string(law.form) << ": further draws stand in for them";
  }
}

TEST(MultiContactFit, ARefitThatStalledIsNoRefit) {
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
TEST(MultiContactFit, ALawFarOffOnWhatWasHeldOutIsInaccurate) {
  MultiContactOptionsKnown o;
  o.noise = 0.01;
  auto list = arrangements();
  MultiContactMeasurements data = multi_contact_measurements(known(LawForm::directional), list, o);
  MultiContactFitOptions options = quick();
  const LawTableEntry near = fit_multi_contact_laws(data, options);
  EXPECT_EQ(near.find(near.best)->status, LawStatus::good);
  for (MultiContactRun& run : data.runs)
    if (list[static_cast<std::size_t>(run.configuration)].held_out)
      for (MultiContactPoint& p : run.points)
        for (double& f : p.normal) f *= 3.0;
  const LawTableEntry far = fit_multi_contact_laws(data, options);
  EXPECT_EQ(far.best, near.best);
  const MultiContactLaw& law = *far.find(far.best);
  EXPECT_EQ(law.status, LawStatus::inaccurate);
  EXPECT_NE(law.reason.find("loadings that were held out; at most 50 % are allowed"), std::string::npos) << law.reason;
  MultiContactLawFit fit;
  add_entry(fit, data, options, 0.04);
  EXPECT_FALSE(fit.usable);
  options.largest_error = 0.9;
  EXPECT_EQ(fit_multi_contact_laws(data, options).find(far.best)->status, LawStatus::good);
}

TEST(MultiContactFit, ALawWithOtherNumbersIsJudgedAgain) {
  MultiContactOptionsKnown o;
  o.noise = 0.01;
  const MultiContactMeasurements data = multi_contact_measurements(known(LawForm::isotropic), arrangements(), o);
  const MultiContactFitOptions options = quick();
  const LawTableEntry entry = fit_multi_contact_laws(data, options);
  const MultiContactLaw& fitted = *entry.find(LawForm::isotropic);
  MultiContactLaw law = fitted;
  law.errors.push_back({"of another table", MultiContactUse::apart, 0.3, 1.0, 0.0});
  judge_again(law, data, options.discrepancy);
  ASSERT_EQ(law.errors.size(), fitted.errors.size() + 1);
  for (std::size_t k = 0; k < fitted.errors.size(); ++k)
    EXPECT_NEAR(law.errors[k].error, fitted.errors[k].error, 1e-9) << law.errors[k].name;
  EXPECT_NEAR(law.error_fitted, fitted.error_fitted, 1e-9);
  EXPECT_NEAR(law.error_held_out, fitted.error_held_out, 1e-9);
  law.a.value *= 2.0;
  judge_again(law, data, options.discrepancy);
  EXPECT_GT(law.error_fitted, 0.8) << "all forces are twice as large";
  EXPECT_GT(law.error_held_out, 0.8);
  EXPECT_EQ(law.errors.back().error, 0.3) << "it was not measured here";
}

TEST(MultiContactFit, WithOneLoadingThereIsNothingToLeaveOut) {
  MultiContactOptionsKnown o;
  o.noise = 0.01;
  const LawTableEntry entry =
      fit_multi_contact_laws(multi_contact_measurements(known(LawForm::isotropic), {arrangements()[0]}, o), quick());
  for (const MultiContactLaw& law : entry.laws) EXPECT_TRUE(std::isnan(law.error_cross)) << to_string(law.form);
  EXPECT_EQ(entry.best, LawForm::pair);
}

TEST(MultiContactFit, BelowTheThresholdThereIsNoLaw) {
  std::vector<MultiContactConfiguration> list{
      multi_contact_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.06)};
  EXPECT_THROW((void)fit_multi_contact_laws(multi_contact_measurements(known(LawForm::isotropic), list, {}), quick()),
               UnusableResult);
  list[0] = multi_contact_configuration(Arrangement::opposite, PartnerKind::plane, 0.0, 0.2);  // not one plane alone
  EXPECT_THROW((void)fit_multi_contact_laws(multi_contact_measurements(known(LawForm::isotropic), list, {}), quick()),
               UnusableResult);
}

/// With the weight at which a fit starts, the neighbours below press nowhere, so that nothing changes with it.
TEST(MultiContactFit, AWeightWhoseStartBearsNothingIsFound) {
  MultiContactModel model = known(LawForm::isotropic);
  set_partners(model, PartnerKind::solid, {0.25}, {0.0}, 1.0);
  const std::vector<MultiContactPartner> cube =
      multi_contact_configuration(Arrangement::cube, PartnerKind::solid, 0.25, 0.2).partners;
  const auto bears = [&](double x) {
    return multi_contact_forces(model, cube, std::vector<double>(cube.size(), x)).front() > 0.0;
  };
  double deepest = 0.01;
  while (!bears(deepest + 0.005)) deepest += 0.005;
  set_partners(model, PartnerKind::solid, {0.25}, {std::log(2.5)}, 1.0);
  ASSERT_TRUE(bears(0.8 * deepest));
  auto list = arrangements();
  list.resize(5);  // planes
  list.push_back(multi_contact_configuration(Arrangement::cube, PartnerKind::solid, 0.25, deepest));
  MultiContactOptionsKnown o;
  o.noise = 0.02;
  const LawTableEntry entry = fit_multi_contact_laws(multi_contact_measurements(model, list, o), quick());
  const MultiContactLaw& law = *entry.find(LawForm::isotropic);
  ASSERT_EQ(law.partners.size(), 1U);
  EXPECT_NEAR(law.partners[0].weight.value, 2.5, 0.25);
  EXPECT_TRUE(std::isfinite(law.partners[0].weight.standard_error));
}

/// Neighbours may have been measured on fewer packings than planes: the interval of their row takes that number.
TEST(MultiContactFit, ARowHasTheDegreesOfFreedomOfItsOwnPackings) {
  auto list = arrangements();
  list.resize(5);  // planes
  list.push_back(multi_contact_configuration(Arrangement::cube, PartnerKind::solid, 0.5, 0.2));
  list.push_back(multi_contact_configuration(Arrangement::cube, PartnerKind::solid, 2.0, 0.2));
  MultiContactOptionsKnown o;
  o.noise = 0.02;
  MultiContactMeasurements data = multi_contact_measurements(known(LawForm::isotropic), list, o);
  const auto all = static_cast<std::int64_t>(data.packings.size());
  ASSERT_GT(all, 3);
  std::erase_if(data.runs, [](const MultiContactRun& run) { return run.configuration == 5 && run.packing >= 3; });
  const LawTableEntry entry = fit_multi_contact_laws(data, quick());
  const std::vector<PartnerRow>& rows = entry.find(LawForm::isotropic)->partners;
  ASSERT_EQ(rows.size(), 2U);
  const auto quantile = [](const Estimate& w) { return std::log(w.high / w.value) / (w.standard_error / w.value); };
  EXPECT_NEAR(quantile(rows[0].weight), student95(2.0), 1e-6);
  EXPECT_NEAR(quantile(rows[1].weight), student95(static_cast<double>(all) - 1.0), 1e-6);
  EXPECT_EQ(rows[0].exponent.high, rows[1].exponent.high);
}

/// The pool of packings may be larger than what was measured.
TEST(MultiContactFit, PackingsThatNothingWasMeasuredOnDoNotCount) {
  MultiContactOptionsKnown o;
  o.noise = 0.05;
  auto list = arrangements();
  list.resize(5);
  MultiContactMeasurements data = multi_contact_measurements(known(LawForm::isotropic), list, o);
  const LawTableEntry own = fit_multi_contact_laws(data, quick());
  const std::size_t measured = data.packings.size();
  for (int k = 0; k < 20; ++k) {
    data.packings.push_back(data.packings.front());
    data.packings.back().solid_fraction = 0.6;
  }
  const LawTableEntry entry = fit_multi_contact_laws(data, quick());
  EXPECT_EQ(entry.packings, static_cast<int>(measured));
  EXPECT_EQ(entry.solid_fraction, own.solid_fraction);
  EXPECT_EQ(entry.find(LawForm::isotropic)->a.low, own.find(LawForm::isotropic)->a.low);
  MultiContactFitOptions many = quick();
  many.min_packings = static_cast<int>(measured) + 5;
  EXPECT_THROW((void)fit_multi_contact_laws(data, many), UnusableResult);
}

TEST(MultiContactFit, TooFewPackingsAreBadInput) {
  MultiContactOptionsKnown o;
  o.packings = 3;
  EXPECT_THROW(
      (void)fit_multi_contact_laws(multi_contact_measurements(known(LawForm::isotropic), arrangements(), o), quick()),
      InputError);
}

TEST(MultiContactFit, TheSeedDecidesTheReplicates) {
  MultiContactOptionsKnown o;
  o.noise = 0.1;
  auto list = arrangements();
  list.resize(5);
  const MultiContactMeasurements data = multi_contact_measurements(known(LawForm::isotropic), list, o);
  MultiContactFitOptions options = quick();
  options.replicates = 12;
  const LawTableEntry a = fit_multi_contact_laws(data, options);
  const LawTableEntry b = fit_multi_contact_laws(data, options);
  EXPECT_EQ(a.laws[1].a.low, b.laws[1].a.low);
  EXPECT_LT(a.laws[1].a.low, a.laws[1].a.value);
  EXPECT_GT(a.laws[1].a.high, a.laws[1].a.value);
  options.seed = 2;
  EXPECT_NE(fit_multi_contact_laws(data, options).laws[1].a.low, a.laws[1].a.low);
}

}  // namespace
}  // namespace softgrain
