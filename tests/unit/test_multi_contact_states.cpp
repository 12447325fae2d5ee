// Means over packings, and what each configuration is used for.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calibrate/multi_contact_states.h"
#include "tests/support/known_multi_contact.h"

namespace softgrain {
namespace {

using synthetic::arrangements;
using synthetic::known;
using synthetic::multi_contact_configuration;
using synthetic::multi_contact_measurements;
using synthetic::MultiContactOptionsKnown;
using synthetic::quick;

/// The same loading of the same packings is no new data: it is fitted once, and not at all when it is held out.
TEST(MultiContactStates, ALoadingIsUsedOnce) {
  std::vector<MultiContactConfiguration> list{
      multi_contact_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.3),
      multi_contact_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.25, MultiContactMove::unload),
      multi_contact_configuration(Arrangement::cube, PartnerKind::plane, 0.0, 0.15, MultiContactMove::slide),
      multi_contact_configuration(Arrangement::cube, PartnerKind::plane, 0.0, 0.2),
      multi_contact_configuration(Arrangement::one, PartnerKind::solid, 1.0, 0.3),
      multi_contact_configuration(Arrangement::cube, PartnerKind::plane, 0.0, 0.2)};
  list[3].held_out = true;
  list[5].centre_free = true;
  const MultiContactMeasurements data = multi_contact_measurements(known(LawForm::isotropic), list, {});
  const auto states = average_states(data);
  const MultiContactUse expected[] = {MultiContactUse::fitted,    MultiContactUse::repeated, MultiContactUse::repeated,
                                      MultiContactUse::predicted, MultiContactUse::fitted,   MultiContactUse::repeated};
  for (std::size_t k = 0; k < list.size(); ++k) EXPECT_EQ(states[k].use, expected[k]) << k;
  list[3].held_out = false;
  const MultiContactMeasurements all = multi_contact_measurements(known(LawForm::isotropic), list, {});
  EXPECT_EQ(average_states(all)[2].use, MultiContactUse::repeated);
  EXPECT_EQ(average_states(all)[3].use, MultiContactUse::fitted) << "the deepest of its loading";
}

TEST(MultiContactStates, PathsKeepTheirProportionsOrAreSheared) {
  MultiContactConfiguration c = multi_contact_configuration(Arrangement::cube, PartnerKind::plane, 0.0, 0.2);
  c.stages = {{MultiContactMove::load, {0.2, 0.1, 0.15, 0.0, 0.1, 0.1}},
              {MultiContactMove::unload, {0.1, 0.05, 0.075, 0.0, 0.05, 0.05}}};
  EXPECT_TRUE(c.in_proportion()) << "unequally deep, and back the same way";
  c.stages[1].overlap[1] = 0.1;
  EXPECT_FALSE(c.in_proportion()) << "one stays";
  c.stages[1] = {MultiContactMove::load, {0.25, 0.05, 0.15, 0.0, 0.1, 0.1}};
  EXPECT_FALSE(c.in_proportion()) << "one comes in as another goes";
}

/// A path that shears begins like a plain loading and is another one; that of a slide is the same.
TEST(MultiContactStates, APathThatGoesOnLoadingIsALoadingOfItsOwn) {
  auto list = arrangements();
  MultiContactConfiguration sheared = list[4];
  sheared.name = "sheared";
  sheared.stages.push_back({MultiContactMove::load, {0.24, 0.24, 0.14, 0.14, 0.14, 0.14}});
  MultiContactConfiguration shallow = sheared;
  shallow.name = "half of it";
  for (auto& s : shallow.stages)
    for (double& h : s.overlap) h *= 0.5;
  list.push_back(sheared);
  list.push_back(shallow);
  list.push_back(
      multi_contact_configuration(Arrangement::cube, PartnerKind::plane, 0.0, 0.17, MultiContactMove::slide));
  const MultiContactMeasurements data = multi_contact_measurements(known(LawForm::isotropic), list, {});
  const std::vector<MultiContactStates> states = average_states(data);
  EXPECT_EQ(states[4].use, MultiContactUse::fitted);
  EXPECT_EQ(states[10].use, MultiContactUse::fitted);
  EXPECT_EQ(states[11].use, MultiContactUse::repeated);
  EXPECT_EQ(states[12].use, MultiContactUse::repeated);
  list[10].held_out = true;
  const MultiContactMeasurements out = multi_contact_measurements(known(LawForm::isotropic), list, {});
  EXPECT_EQ(average_states(out)[10].use, MultiContactUse::predicted);
  EXPECT_EQ(average_states(out)[4].use, MultiContactUse::fitted);
}

TEST(MultiContactStates, WeightsAreRepetitions) {
  MultiContactOptionsKnown o;
  o.noise = 0.1;
  o.packings = 4;
  const MultiContactMeasurements data = multi_contact_measurements(known(LawForm::isotropic), arrangements(), o);
  MultiContactMeasurements repeated = data;
  repeated.runs.clear();
  for (const MultiContactRun& run : data.runs)
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
TEST(MultiContactStates, ErrorsAreThoseOfAMean) {
  MultiContactOptionsKnown o;
  o.noise = 0.1;
  o.packings = 3;
  const MultiContactMeasurements data = multi_contact_measurements(known(LawForm::isotropic), {arrangements()[0]}, o);
  const auto states = average_states(data);
  ASSERT_EQ(data.runs.size(), 3U);
  const std::size_t last = states[0].states.size() - 1;
  std::vector<double> force;
  for (const MultiContactRun& run : data.runs) force.push_back(run.points[last].normal[0]);
  const double mean = (force[0] + force[1] + force[2]) / 3.0;
  double squares = 0.0;
  for (const double f : force) squares += (f - mean) * (f - mean);
  ASSERT_GT(squares, 0.0);
  EXPECT_NEAR(states[0].states[last].mean[0], mean, 1e-12 * mean);
  EXPECT_NEAR(states[0].states[last].error[0] / std::sqrt(squares / 6.0), 1.0, 1e-6);
}

TEST(MultiContactStates, WhatDidNotConvergeDoesNotCount) {
  MultiContactOptionsKnown o;
  o.packings = 3;
  MultiContactMeasurements data = multi_contact_measurements(known(LawForm::isotropic), {arrangements()[0]}, o);
  const auto all = average_states(data);
  data.runs[0].points[4].converged = false;
  data.runs[0].points[4].normal[0] = 1e9;
  for (MultiContactRun& run : data.runs) run.points[5].converged = run.packing == 2;  // one alone is no mean
  const auto states = average_states(data);
  ASSERT_EQ(states[0].states.size(), all[0].states.size() - 1);
  EXPECT_EQ(states[0].states[4].packings, 2);
  EXPECT_DOUBLE_EQ(states[0].states[4].mean[0], all[0].states[4].mean[0]);
}

}  // namespace
}  // namespace softgrain
