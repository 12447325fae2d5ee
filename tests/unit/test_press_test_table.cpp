// What tables of press tests may hold: repeats in columns, branches of unloading, the touch point and the machine.
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "calibrate/experiment_fit.h"
#include "common/core/error.h"
#include "common/io/text_file.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using test::TemporaryDirectory;

class PressTestTable : public ::testing::Test {
 protected:
  ForceCurves read(const std::string& text, Unloading unloading = Unloading::fit) {
    write_text_atomic(directory_.file("data.csv"), kHead + text);
    ForceCurveOptions options;
    options.unloading = unloading;
    return read_force_curves(directory_.file("data.csv"), options);
  }
  void expect_refused(const std::string& text, const std::string& words) {
    try {
      (void)read(text);
      FAIL() << "was read: " << words;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
    }
  }
  static constexpr const char* kHeadText = "# kind = soft-solid\n# Rs = 10 mm\n# E = 1 MPa\n";
  const std::string kHead = kHeadText;
  TemporaryDirectory directory_;
};

TEST_F(PressTestTable, RepeatsInColumnsAndTheBranchByReversal) {
  const ForceCurves c = read(
      "hn [mm]; Fn 1 [N]; Fn_2 [N]\n0.5; 0; 0\n1; 1; 1.1\n1.5; 2; 2.1\n2; 4; 4.1\n2.5; 7; 7.1\n2; 3; \n1.5; 1; 1.2\n"
      "1; 0; 0.1\n1.4; 0.8; 0.9\n2.6; 8; 8.1\n");
  ASSERT_EQ(c.samples.size(), 2U);
  EXPECT_EQ(c.samples[0].name, "data 1");
  EXPECT_EQ(c.samples[1].name, "data 2");
  for (const ForceCurve& s : c.samples) {
    ASSERT_EQ(s.normal.size(), 6U);
    EXPECT_NEAR(s.normal.back().delta, 0.26, 1e-12);
    ASSERT_EQ(s.unloaded.size(), 1U);
    EXPECT_NEAR(s.unloaded[0].deepest, 0.25, 1e-12);
  }
  EXPECT_EQ(c.samples[0].unloaded[0].points.size(), 4U) << "reloading is part of it";
  EXPECT_EQ(c.samples[1].unloaded[0].points.size(), 3U) << "an empty cell is no reading";
  EXPECT_EQ(c.samples[1].unloaded[0].force, 7.1);
}

/// Repeats are numbers, not texts: 10 comes after 2, and 01 is 1.
TEST_F(PressTestTable, RepeatsAreInTheOrderOfTheirNumbers) {
  const ForceCurves c = read(
      "hn [mm]; Fn 10 [N]; Fn 2 [N]; Fn 01 [N]\n0.5; 10; 2; 1\n1; 11; 3; 2\n1.5; 12; 4; 3\n2; 13; 5; 4\n"
      "2.5; 14; 6; 5\n");
  ASSERT_EQ(c.samples.size(), 3U);
  const std::array names{"data 1", "data 2", "data 10"};
  const std::array forces{1.0, 2.0, 10.0};
  for (std::size_t s = 0; s < 3; ++s) {
    EXPECT_EQ(c.samples[s].name, names[s]);
    EXPECT_EQ(c.samples[s].normal.at(0).force, forces[s]);
  }
  const std::string rows = "0.5; 0; 0\n1; 1; 1\n1.5; 2; 2\n2; 4; 4\n2.5; 7; 7\n";
  expect_refused("hn [mm]; Fn 1 [N]; Fn 01 [N]\n" + rows,
                 "columns \"Fn 1 [N]\" and \"Fn 01 [N]\" both name Fn of repeat 1");
  const ForceCurves pairs = read(
      "hn 1 [mm]; Fn 01 [N]; Fn 2 [N]; hn 02 [mm]\n0.5; 0; 0; 0.6\n1; 1; 1; 1.1\n"
      "1.5; 2; 2; 1.6\n2; 4; 4; 2.1\n2.5; 7; 7; 2.6\n");
  ASSERT_EQ(pairs.samples.size(), 2U);
  EXPECT_NEAR(pairs.samples[1].normal[0].delta, 0.06, 1e-12);
}

TEST_F(PressTestTable, PairsOfColumnsTouchPointOffsetAndMachine) {
  const ForceCurves c = read(
      "# touch = 0.2 mm\n# force offset = 0.5 N\n# machine stiffness = 20 N/mm\n"
      "hn 1 [mm]; Fn 1 [N]; hn 2 [mm]; Fn 2 [N]\n0.7; 0.5; 0.8; 0.5\n1.2; 1.5; 1.3; 1.5\n1.7; 2.5; 1.8; 2.5\n"
      "2.2; 4.5; 2.3; 4.5\n2.7; 8.5; 2.8; 8.5\n");
  ASSERT_EQ(c.samples.size(), 2U);
  EXPECT_NEAR(c.samples[0].normal[0].delta, 0.05, 1e-12);
  EXPECT_NEAR(c.samples[1].normal[0].delta, 0.06, 1e-12);
  EXPECT_NEAR(c.samples[0].normal[4].force, 8.0, 1e-12);
  EXPECT_NEAR(c.samples[0].normal[4].delta, (2.7 - 0.2 - 8.0 / 20.0) / 10.0, 1e-12);
}

TEST_F(PressTestTable, JitterIsNoBranchAndColumnsMaySayIt) {
  const ForceCurves jitter = read("hn [mm]; Fn [N]\n0.5; 0\n1; 1\n0.99; 1\n1.5; 2\n2; 4\n2; 4.1\n2.5; 7\n");
  EXPECT_EQ(jitter.samples.at(0).normal.size(), 5U);
  EXPECT_TRUE(jitter.samples[0].unloaded.empty());
  ASSERT_FALSE(jitter.remarks.empty());
  EXPECT_NE(jitter.remarks.front().find("2 readings whose overlap falls back"), std::string::npos);
  const std::string named = "hn [mm]; Fn [N]; branch\n0.5; 0; loading\n1; 1; loading\n1.5; 2; loading\n2; 4; loading\n";
  EXPECT_EQ(read(named + "2.5; 7; loading\n2.45; 6; unloading\n").samples.at(0).unloaded.size(), 1U);
  expect_refused(named + "2.5; 7; unloading\n", "lie below the largest overlap so far");
  expect_refused(named + "1.9; 7; loading\n", "must rise");
  expect_refused(named + "2.5; 7; up\n", "must be loading, unloading or reloading");
}

TEST_F(PressTestTable, ColumnsThatDoNotGoTogetherAreRefused) {
  const std::string rows = "0.5; 0; 0\n1; 1; 1\n1.5; 2; 2\n2; 4; 4\n2.5; 7; 7\n";
  expect_refused("hn [mm]; Fn [N]; Fn 2 [N]\n" + rows, "number the forces of all repeats");
  expect_refused("hn [mm]; Fn [N]; force [N]\n" + rows, "repeats are numbered: Fn 1 [N], Fn 2 [N]");
  expect_refused("hn 1 [mm]; Fn 1 [N]; hn 2 [mm]\n" + rows, "repeat 2 has no column of the force");
  expect_refused("# machine stiffness = -2 N/mm\nhn [mm]; Fn 1 [N]; Fn 2 [N]\n" + rows, "machine stiffness");
}

}  // namespace
