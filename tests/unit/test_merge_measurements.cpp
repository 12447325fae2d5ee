// Measurement files join into one ensemble only when they belong together.
#include "common/data/measurements.h"

#include <gtest/gtest.h>

#include "common/core/error.h"
#include "tests/support/synthetic_law.h"

namespace {

using namespace softgrain;

Measurements part(std::uint64_t seed) {
  test::SyntheticOptions o;
  o.packings = 3;
  o.seed = seed;
  return test::synthetic(o);
}

TEST(MergeMeasurements, PackingsAreRenumbered) {
  const auto all = merge_measurements({part(1), part(2)}, {"a.h5", "b.h5"});
  EXPECT_EQ(all.packings.size(), 6U);
  ASSERT_EQ(all.runs.size(), 6U);
  EXPECT_EQ(all.runs[5].packing, 5);
  EXPECT_EQ(all.packings[5].radii, part(2).packings[2].radii);
}

TEST(MergeMeasurements, AnotherSoftParticleIsRefusedByName) {
  auto other = part(2);
  other.spec.friction = 0.5;
  try {
    merge_measurements({part(1), other}, {"a.h5", "b.h5"});
    FAIL() << "merged packings of different friction";
  } catch (const InputError& e) {
    const std::string text = e.what();
    EXPECT_NE(text.find("mu = 0.3 and 0.5"), std::string::npos) << text;
    EXPECT_NE(text.find("b.h5"), std::string::npos) << text;
  }
}

TEST(MergeMeasurements, ProtocolsAreNotMixed) {
  auto other = part(2);
  other.shell_turns = false;
  EXPECT_THROW(merge_measurements({part(1), other}, {"a", "b"}), InputError);
}

/// Of files that hold rotations; others have nothing to disagree about, and say nothing of what they are merged with.
TEST(MergeMeasurements, FrozenAndSlowTurnsAreNotMixed) {
  auto a = part(1);
  auto b = part(2);
  for (auto* m : {&a, &b})
    for (auto& run : m->runs) run.tangential = {{0.2, 0.05, 0.1, 0.0, 0.0, true}};
  b.turn = TurnProtocol::frozen;
  EXPECT_THROW(merge_measurements({a, b}, {"a", "b"}), InputError);
  for (auto& run : a.runs) run.tangential.clear();
  EXPECT_EQ(merge_measurements({a, b}, {"a", "b"}).turn, TurnProtocol::frozen);
}

/// The same name, other settings: another speed alone moves forces by a third. Earlier files do not say theirs.
TEST(MergeMeasurements, RelaxationsOfOneNameAndOtherSettingsAreNotMixed) {
  auto a = part(1);
  auto b = part(2);
  const std::string name = a.runs.front().relaxation;
  a.settings[name] = "step_factor = 4";
  EXPECT_EQ(merge_measurements({b, a}, {"b", "a"}).settings.at(name), "step_factor = 4");
  b.settings[name] = "step_factor = 15";
  try {
    merge_measurements({a, b}, {"a.h5", "b.h5"});
    FAIL() << "merged two protocols";
  } catch (const InputError& e) {
    for (const char* word : {"a.h5", "b.h5", "step_factor = 4", "step_factor = 15"})
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
  }
  b.settings = a.settings;
  EXPECT_EQ(merge_measurements({a, b}, {"a", "b"}).packings.size(), 6U);
}

TEST(MergeMeasurements, TheSamePackingTwiceIsRefused) {
  EXPECT_THROW(merge_measurements({part(1), part(1)}, {"a", "a"}), InputError);
  auto other = part(1);
  for (auto& run : other.runs) run.relaxation = "published";
  EXPECT_EQ(merge_measurements({part(1), other}, {"a", "b"}).runs.size(), 6U);
}

TEST(MergeMeasurements, NothingOrDamagedIsRefused) {
  EXPECT_THROW(merge_measurements({}, {}), InputError);
  auto broken = part(1);
  broken.runs[0].packing = 7;
  EXPECT_THROW(merge_measurements({broken}, {"a"}), InputError);
}

}  // namespace
