// What a fit of crowd laws takes from slides, rolls and retreats.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/contact/crowd_from_table.h"
#include "common/core/few_samples.h"
#include "tests/support/known_crowd.h"

namespace softgrain {
namespace {

using synthetic::arrangements;
using synthetic::crowd_configuration;
using synthetic::crowd_measurements;
using synthetic::CrowdOptionsKnown;
using synthetic::known;
using synthetic::quick;

TEST(CrowdSideFit, SlidesAndRetreatsGiveTheirNumbers) {
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

TEST(CrowdSideFit, EveryKindOfNeighbourComesBackInItsOwnWay) {
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
TEST(CrowdSideFit, TheStiffnessAgainstASlideIsOverThatOfTheForceThatWasMeasured) {
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

TEST(CrowdSideFit, RollsGiveStiffnessAndLimit) {
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
TEST(CrowdSideFit, OtherPathsGiveNoFrictionLimit) {
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
TEST(CrowdSideFit, ErrorsOfSlidesAndRetreatsAreThoseOfPackingsAndConfigurations) {
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

}  // namespace
}  // namespace softgrain
