// What a fit of multi-contact laws takes from slides, rolls and retreats.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/contact/make_laws.h"
#include "common/core/few_samples.h"
#include "tests/support/known_multi_contact.h"

namespace softgrain {
namespace {

using synthetic::arrangements;
using synthetic::known;
using synthetic::multi_contact_configuration;
using synthetic::multi_contact_measurements;
using synthetic::MultiContactOptionsKnown;
using synthetic::quick;

TEST(MultiContactSideFit, SlidesAndRetreatsGiveTheirNumbers) {
  const MultiContactModel model = known(LawForm::directional);
  auto list = arrangements();
  list.push_back(
      multi_contact_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.25, MultiContactMove::unload));
  list.push_back(multi_contact_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.25, MultiContactMove::slide));
  MultiContactOptionsKnown o;
  o.unloading = 1.6;
  o.kt = 0.06;
  o.limit = 0.21;
  const LawTableEntry entry = fit_multi_contact_laws(multi_contact_measurements(model, list, o), quick());
  EXPECT_NEAR(entry.unloading.value, 1.6, 1e-3);
  EXPECT_NEAR(entry.slide_plane.friction.value, 0.21, 1e-9);
  const MultiContactPartner plane{PartnerKind::plane, 0.0, {{1.0, 0.0, 0.0}}};
  const double kn = (multi_contact_forces(model, {plane}, {0.25 + 1e-5})[0] -
                     multi_contact_forces(model, {plane}, {0.25 - 1e-5})[0]) /
                    2e-5;
  EXPECT_NEAR(entry.slide_plane.kt_ratio.value, 0.06 / kn, 1e-3 * 0.06 / kn);
  EXPECT_EQ(entry.slide_solid.friction.value, entry.slide_plane.friction.value) << "solid spheres slide like planes";
  EXPECT_EQ(entry.unloading_of(entry.slide_solid).value, entry.unloading.value) << "and come back like them";
}

TEST(MultiContactSideFit, EveryKindOfNeighbourComesBackInItsOwnWay) {
  const MultiContactModel model = known(LawForm::directional);
  auto list = arrangements();
  const std::size_t first = list.size();
  list.push_back(
      multi_contact_configuration(Arrangement::cube, PartnerKind::plane, 0.0, 0.18, MultiContactMove::unload));
  list.push_back(multi_contact_configuration(Arrangement::one, PartnerKind::solid, 2.0, 0.3, MultiContactMove::unload));
  list.push_back(
      multi_contact_configuration(Arrangement::opposite, PartnerKind::soft, 1.0, 0.35, MultiContactMove::unload));
  MultiContactMeasurements data = multi_contact_measurements(model, list, {});
  const double steep[] = {1.2, 1.4, 1.7};
  for (std::size_t k = 0; k < 3; ++k) {
    MultiContactOptionsKnown o;
    o.unloading = steep[k];
    const MultiContactMeasurements own = multi_contact_measurements(model, list, o);
    for (std::size_t r = 0; r < data.runs.size(); ++r)
      if (own.runs[r].configuration == static_cast<std::int64_t>(first + k)) data.runs[r] = own.runs[r];
  }
  const LawTableEntry entry = fit_multi_contact_laws(data, quick());
  EXPECT_NEAR(entry.unloading.value, 1.2, 1e-3);
  EXPECT_NEAR(entry.unloading_of(entry.slide_plane).value, 1.2, 1e-3);
  ASSERT_TRUE(entry.slide_solid.has_unloading && entry.slide_soft.has_unloading);
  EXPECT_NEAR(entry.slide_solid.unloading.value, 1.4, 1e-3);
  EXPECT_NEAR(entry.unloading_of(entry.slide_soft).value, 1.7, 1e-3);
}

/// A soft neighbour that gives way: the law is far off its force, and kt/kn is still over the stiffness it has.
TEST(MultiContactSideFit, TheStiffnessAgainstASlideIsOverThatOfTheForceThatWasMeasured) {
  const MultiContactModel model = known(LawForm::directional);
  auto list = arrangements();
  list.push_back(
      multi_contact_configuration(Arrangement::cube, PartnerKind::plane, 0.0, 0.17, MultiContactMove::slide));
  MultiContactOptionsKnown o;
  o.kt = 0.06;
  MultiContactMeasurements data = multi_contact_measurements(model, list, o);
  const double full = fit_multi_contact_laws(data, quick()).slide_plane.kt_ratio.value;
  for (MultiContactRun& run : data.runs)
    if (run.configuration == static_cast<std::int64_t>(list.size()) - 1)
      for (MultiContactPoint& p : run.points) {
        for (double& f : p.normal) f *= 0.5;
        for (Vec3& t : p.tangential) t *= 0.5;
      }
  EXPECT_NEAR(fit_multi_contact_laws(data, quick()).slide_plane.kt_ratio.value, full, 1e-6 * full);
}

TEST(MultiContactSideFit, RollsGiveStiffnessAndLimit) {
  auto list = arrangements();
  for (const PartnerKind kind : {PartnerKind::plane, PartnerKind::soft})
    list.push_back(multi_contact_configuration(Arrangement::cube, kind, kind == PartnerKind::plane ? 0.0 : 2.0, 0.25,
                                               MultiContactMove::roll));
  MultiContactOptionsKnown o;
  o.rolling = 0.005;
  o.points = 40;
  const auto fitted = [&](double friction) {
    o.rolling_friction = friction;
    return fit_multi_contact_laws(multi_contact_measurements(known(LawForm::directional), list, o), quick());
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
TEST(MultiContactSideFit, OtherPathsGiveNoFrictionLimit) {
  auto list = arrangements();
  MultiContactConfiguration back =
      multi_contact_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.25, MultiContactMove::slide);
  back.stages.push_back({MultiContactMove::slide, back.stages[0].overlap, 0.2});
  list.push_back(back);
  MultiContactConfiguration oblique = multi_contact_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.3);
  oblique.name = "oblique";
  oblique.stages = {{MultiContactMove::oblique, {0.3}, 0.2}};
  list.push_back(oblique);
  MultiContactMeasurements data = multi_contact_measurements(known(LawForm::directional), list, {});
  const auto states = average_states(data);
  EXPECT_EQ(states.back().use, MultiContactUse::repeated) << "no loading";
  EXPECT_TRUE(loading_states(states.back()).empty());
  const LawTableEntry entry = fit_multi_contact_laws(data, quick());
  EXPECT_FALSE(entry.slide_plane.measured);
}

/// Errors of one configuration are those of its packings; of two that differ, the difference is in them too.
TEST(MultiContactSideFit, ErrorsOfSlidesAndRetreatsAreThoseOfPackingsAndConfigurations) {
  const MultiContactModel model = known(LawForm::isotropic);
  auto list = arrangements();
  list.resize(5);
  list.push_back(
      multi_contact_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.25, MultiContactMove::unload));
  list.push_back(multi_contact_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.25, MultiContactMove::slide));
  MultiContactOptionsKnown o;
  o.noise = 0.1;
  o.unloading = 1.6;
  o.kt = 0.06;
  MultiContactFitOptions options = quick();
  options.replicates = 40;
  const LawTableEntry one = fit_multi_contact_laws(multi_contact_measurements(model, list, o), options);
  const double few_packings = few_samples_factor(static_cast<std::size_t>(one.packings));
  EXPECT_GT(few_packings, 1.0);
  const auto expect_interval = [&](const Estimate& e, const char* what) {
    EXPECT_GT(e.standard_error, 1e-4 * e.value) << what;
    EXPECT_LT(e.standard_error, 0.5 * e.value) << what;
    EXPECT_LT(e.low, e.value) << what;
    EXPECT_GT(e.high, e.value) << what;
    EXPECT_GT(e.high - e.low, 2.0 * e.standard_error) << what;
    EXPECT_LT(e.high - e.low, 6.0 * few_packings * e.standard_error) << what;
  };
  expect_interval(one.slide_plane.kt_ratio, "kt/kn");
  expect_interval(one.slide_plane.friction, "friction");
  expect_interval(one.unloading, "retreat");
  for (const SlideLaw& borrowed : {one.slide_solid, one.slide_soft}) {
    EXPECT_EQ(borrowed.friction.value, one.slide_plane.friction.value);
    EXPECT_TRUE(std::isinf(borrowed.friction.standard_error)) << "of other neighbours nothing was measured";
    EXPECT_TRUE(std::isinf(borrowed.kt_ratio.high));
  }

  // Another configuration that slides three times as hard.
  list.push_back(
      multi_contact_configuration(Arrangement::opposite, PartnerKind::plane, 0.0, 0.25, MultiContactMove::slide));
  MultiContactMeasurements apart = multi_contact_measurements(model, list, o);
  for (MultiContactRun& run : apart.runs)
    if (run.configuration == static_cast<std::int64_t>(list.size()) - 1)
      for (MultiContactPoint& p : run.points) p.tangential[0] = p.tangential[0] * 3.0;
  const LawTableEntry two = fit_multi_contact_laws(apart, options);
  EXPECT_GT(two.slide_plane.kt_ratio.standard_error, 3.0 * one.slide_plane.kt_ratio.standard_error);

  options.replicates = 9;  // too few to say anything
  const LawTableEntry few = fit_multi_contact_laws(multi_contact_measurements(model, list, o), options);
  EXPECT_TRUE(std::isinf(few.slide_plane.friction.standard_error));
  EXPECT_TRUE(std::isinf(few.unloading.standard_error));
  EXPECT_EQ(few.unloading.low, -std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace softgrain
