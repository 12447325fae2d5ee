// What softgrain check asks about numbers that may lack their unit, and how it writes ranges.
#include "pipelines/run/findings.h"

#include <gtest/gtest.h>

#include "common/io/scene.h"

namespace softgrain {
namespace {

TEST(Findings, UnitsThatWereForgottenAreAskedFor) {
  Findings small;
  small.warn_of_grains(70.0, 2.65);
  ASSERT_EQ(small.warnings().size(), 2U);
  EXPECT_EQ(small.warnings()[0], "E is 70 Pa: numbers without a unit are pascals; was \"70 GPa\" meant?");
  EXPECT_EQ(small.warnings()[1],
            "density is 2.65 kg/m^3: numbers without a unit are kg/m^3; was \"2.65 g/cm^3\" meant?");
  Findings usual;
  usual.warn_of_grains(5e5, 2500.0);
  usual.warn_of_grains(70e9, 20.0);  // foam is as light
  EXPECT_TRUE(usual.warnings().empty());
}

TEST(RangeText, LeavesOutWhatAllowsForRounding) {
  EXPECT_EQ(range_text(Range::closed(-1e-9, 1.0 + 1e-9)), "from 0 to 1");
  EXPECT_EQ(range_text(Range::closed(1e-9, 0.1)), "from 1e-09 to 0.1");
  EXPECT_EQ(range_text(Range{1.0, 1e9, true, false}), "above 1 and at most 1000000000");
  EXPECT_EQ(range_text(Range::closed(-0.25, 0.123456789)), "from -0.25 to 0.123456789");
}

}  // namespace
}  // namespace softgrain
