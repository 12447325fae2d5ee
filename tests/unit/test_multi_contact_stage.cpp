// The measuring stage with a level whose soft particles hold soft particles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "calibrate/multi_contact_states.h"
#include "pipelines/kinds/law_table/multi_contact_stage.h"
#include "pipelines/kinds/law_table/multi_contact_summary.h"
#include "tests/support/multi_contact.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/tiny_law_table.h"

namespace softgrain {
namespace {

/// Room for a sphere at x: distance to the nearest grain or the shell.
double room_at(const ShellPacking& packing, const Vec3& x) {
  double room = 1.0 - norm(x);
  for (std::size_t k = 0; k < packing.radius.size(); ++k)
    room = std::min(room, norm(x - packing.position[k]) - packing.radius[k]);
  return room;
}

/// One inner soft particle in the widest void that a coarse grid finds.
SoftContent with_one_inner(const ShellPacking& packing) {
  InnerSoft best;
  for (int k = 0; k < 9 * 9 * 9; ++k) {
    const Vec3 x{{(k % 9 - 4) * 0.2, (k / 9 % 9 - 4) * 0.2, (k / 81 - 4) * 0.2}};
    if (const double room = room_at(packing, x); room > best.r) best = {x, room};
  }
  return {packing, {best}, {}};
}

MultiContactLevel stiff_level(const SoftParticleSpec& spec, const std::string& tag) {
  SoftContact law;
  law.normal = {1.0, 2.5, 0.0};
  law.tangential = {0.5, 1.0, 0.0};
  law.modulus = spec.youngs_modulus;
  law.friction = 0.3;
  SoftContact reverse = law;
  reverse.i_is_soft = false;
  SoftContact both = law;
  both.partner_is_soft = true;
  return {[](const ShellPacking& p, std::int64_t) { return with_one_inner(p); },
          {law, law, reverse, both, 0.7},
          tag,
          "level.h5"};
}

class MultiContactStage : public ::testing::Test {
 protected:
  MultiContactStage()
      : scene_(Scene::parse(test::kTinyLawTable, "scene.toml")), setup_(read_multi_contact_setup(scene_.root())) {
    options_.out = directory_.file("out");
    options_.quiet = true;
    options_.threads = 1;
    options_.law_cache = directory_.file("cache");
    std::filesystem::create_directories(options_.law_cache);
  }
  MultiContactMeasurements measure(const MultiContactLevel* level) {
    const softgrain::Run run(scene_, options_, "run", {.seed = setup_.seed});
    contents_.clear();
    MultiContactMeasurements data = run_multi_contact_stage(setup_, run, left_out_, contents_, level);
    run.store.clear();
    return data;
  }
  [[nodiscard]] long cached() const {
    return std::distance(std::filesystem::directory_iterator(options_.law_cache),
                         std::filesystem::directory_iterator());
  }

  test::TemporaryDirectory directory_;
  Scene scene_;
  MultiContactSetup setup_;
  CommonOptions options_;
  std::vector<ShellPacking> contents_;
  std::vector<std::string> left_out_;
};

TEST_F(MultiContactStage, AnInnerLevelIsAnotherMeasurement) {
  const MultiContactMeasurements plain = measure(nullptr);
  const long plain_files = cached();
  EXPECT_EQ(contents_.size(), 3U);
  EXPECT_TRUE(std::filesystem::exists(options_.out + "/multi_contact.h5"));
  const MultiContactLevel level = stiff_level(setup_.spec, "one stiff inner soft particle");
  const MultiContactMeasurements filled = measure(&level);
  EXPECT_TRUE(std::filesystem::exists(options_.out + "/level.h5"));
  EXPECT_GT(cached(), plain_files);
  const MultiContactConfiguration& one = setup_.configurations[0];
  EXPECT_GT(mean_end_force(one, {filled.runs[0], filled.runs[1]}).mean,
            mean_end_force(one, {plain.runs[0], plain.runs[1]}).mean);
  const long all_files = cached();
  const MultiContactMeasurements again = measure(&level);
  EXPECT_EQ(cached(), all_files);
  ASSERT_EQ(again.runs.size(), filled.runs.size());
  for (std::size_t k = 0; k < again.runs.size(); ++k) test::expect_equal(again.runs[k].points, filled.runs[k].points);
  const MultiContactLevel other = stiff_level(setup_.spec, "another tag");
  (void)measure(&other);
  EXPECT_GT(cached(), all_files);
}

TEST_F(MultiContactStage, PackingsAreAddedUntilTheTargetIsMet) {
  setup_.configurations.resize(1);
  setup_.target = 0.9;
  EXPECT_EQ(measure(nullptr).runs.size(), 2U);
  setup_.target = 1e-6;
  const MultiContactMeasurements data = measure(nullptr);
  EXPECT_EQ(data.runs.size(), 3U);
  EXPECT_EQ(multi_contact_remarks(data, setup_.target).size(), 1U);
  EXPECT_TRUE(multi_contact_remarks(data, 0.9).empty());
}

TEST_F(MultiContactStage, AConfigurationHasAsManyPackingsAsItSays) {
  setup_.configurations.resize(2);
  setup_.target = 0.9;
  setup_.packings[setup_.configurations[1].name] = 5;
  const MultiContactMeasurements data = measure(nullptr);
  EXPECT_EQ(contents_.size(), 5U) << "more than packings_max, and each another one";
  const auto runs = [&](std::int64_t configuration) {
    return std::count_if(data.runs.begin(), data.runs.end(),
                         [&](const MultiContactRun& r) { return r.configuration == configuration; });
  };
  EXPECT_EQ(runs(0), 2);
  EXPECT_EQ(runs(1), 5);
}

/// The plan's packings come in as far as it says, along the same states, and count where they were.
TEST_F(MultiContactStage, PlannedPackingsGoAsDeepAsTheySay) {
  setup_.configurations.resize(1);
  setup_.target = 0.9;
  const MultiContactMeasurements before = measure(nullptr);
  setup_.plan = {{setup_.configurations[0].name, 0.6, 5}, {setup_.configurations[0].name, 1.0, 3}};
  const MultiContactMeasurements data = measure(nullptr);
  EXPECT_EQ(contents_.size(), 5U);
  ASSERT_EQ(data.runs.size(), 5U);
  for (std::size_t k = 0; k < 2; ++k) test::expect_equal(data.runs[k].points, before.runs[k].points);
  const auto& whole = data.runs[2].points;
  EXPECT_EQ(whole.size(), before.runs[0].points.size()) << "the deeper ones first";
  for (std::size_t r = 3; r < 5; ++r) {
    const auto& points = data.runs[r].points;
    EXPECT_EQ(data.runs[r].packing, static_cast<std::int64_t>(r));
    ASSERT_FALSE(points.empty());
    ASSERT_LT(points.size(), whole.size());
    EXPECT_LE(points.back().overlap[0], 0.6 * 0.3 + 1e-12);
    EXPECT_GT(whole[points.size()].overlap[0], 0.6 * 0.3) << "no state within the depth is left out";
    for (std::size_t k = 0; k < points.size(); ++k) EXPECT_NEAR(points[k].overlap[0], whole[k].overlap[0], 1e-12);
  }
  const auto force = mean_end_force(setup_.configurations[0], data.runs);
  EXPECT_EQ(force.runs, 3) << "ways that are cut short say nothing of the end";
  const auto states = average_states(data);
  EXPECT_EQ(states[0].states.front().packings, 5);
  EXPECT_EQ(states[0].states.back().packings, 3);
  // Nearer than all recorded states: said, and no run.
  setup_.plan = {{setup_.configurations[0].name, 1e-3, 5}};
  EXPECT_EQ(measure(nullptr).runs.size(), 2U);
  ASSERT_EQ(left_out_.size(), 1U);
  EXPECT_NE(left_out_[0].find("nothing is recorded within 0.001"), std::string::npos) << left_out_[0];
}

/// A packing in two orientations is one packing: its mean counts, and the errors are those over packings.
TEST_F(MultiContactStage, OrientationsOfAPackingCountAsOne) {
  setup_.configurations.resize(1);
  setup_.target = 0.9;
  const MultiContactMeasurements one = measure(nullptr);
  setup_.orientations = 2;
  const MultiContactMeasurements data = measure(nullptr);
  ASSERT_EQ(data.runs.size(), 4U);
  test::expect_equal(data.runs[0].points, one.runs[0].points);
  EXPECT_EQ(data.runs[1].orientation, 1);
  EXPECT_EQ(data.runs[1].packing, 0);
  EXPECT_NE(data.runs[1].points.back().normal, data.runs[0].points.back().normal);
  const MultiContactMeasurements kept = load_multi_contact(options_.out + "/multi_contact.h5");
  EXPECT_EQ(kept.runs[3].orientation, 1);
  const MultiContactMeasurements mean = mean_over_orientations(kept);
  ASSERT_EQ(mean.runs.size(), 2U);
  const auto end = [](const MultiContactRun& r) { return r.points.back().normal[0]; };
  EXPECT_DOUBLE_EQ(end(mean.runs[1]), 0.5 * (end(data.runs[2]) + end(data.runs[3])));
  EXPECT_EQ(mean.runs[1].cost.loop_passes, data.runs[2].cost.loop_passes + data.runs[3].cost.loop_passes);
  const auto force = mean_end_force(setup_.configurations[0], data.runs);
  EXPECT_EQ(force.runs, 2);
  EXPECT_DOUBLE_EQ(force.mean, 0.5 * (end(mean.runs[0]) + end(mean.runs[1])));
  EXPECT_NE(multi_contact_text(data).find("2 orientations of every packing"), std::string::npos)
      << multi_contact_text(data);
}

/// One packing whose grains are thrown out of their shell ends nothing but its own runs.
TEST_F(MultiContactStage, APackingThatBreaksOffIsLeftOut) {
  setup_.configurations.resize(1);
  setup_.target = 1e-6;
  const MultiContactMeasurements whole = measure(nullptr);
  ASSERT_EQ(whole.runs.size(), 3U);
  EXPECT_TRUE(left_out_.empty());
  MultiContactLevel level;
  level.file = "broken.h5";
  std::int64_t broken = 1;
  level.fill = [&](const ShellPacking& packing, std::int64_t number) {
    SoftContent content{packing, {}, {}};
    if (number == broken || broken < 0) content.grains.position[0] = {{3.0, 0.0, 0.0}};
    return content;
  };
  level.tag = "one broken";
  const MultiContactMeasurements rest = measure(&level);
  ASSERT_EQ(rest.runs.size(), 2U);
  EXPECT_EQ(rest.runs[0].packing, 0);
  EXPECT_EQ(rest.runs[1].packing, 2);
  ASSERT_EQ(left_out_.size(), 2U);  // in the pilot and in the measurement
  EXPECT_NE(left_out_[1].find("packing 1 is left out: it broke off: grain 0 "), std::string::npos) << left_out_[1];
  broken = -1;
  level.tag = "all broken";
  EXPECT_THROW((void)measure(&level), UnusableResult);
}

}  // namespace
}  // namespace softgrain
