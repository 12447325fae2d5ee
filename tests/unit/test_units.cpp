// Units: every known one, exactness of decimal prefixes, refusals.
#include <gtest/gtest.h>

#include <numbers>

#include "common/core/error.h"
#include "common/io/scene.h"

namespace softgrain {
namespace {

struct Case {
  const char* text;
  Unit unit;
  double value;
};

class EveryUnit : public testing::TestWithParam<Case> {};

TEST_P(EveryUnit, IsReadExactly) {
  EXPECT_EQ(parse_quantity(GetParam().text, GetParam().unit), GetParam().value) << GetParam().text;
}

constexpr double kPi = std::numbers::pi;

INSTANTIATE_TEST_SUITE_P(
    Units, EveryUnit,
    testing::Values(Case{"0.3", Unit::none, 0.3}, Case{" +2e3 ", Unit::none, 2000.0}, Case{"-1.5", Unit::none, -1.5},
                    Case{"0.016", Unit::length, 0.016}, Case{"16 mm", Unit::length, 0.016},
                    Case{"16mm", Unit::length, 0.016}, Case{"0.7 mm", Unit::length, 0.0007},
                    Case{"1.1e1 um", Unit::length, 11e-6}, Case{"3 µm", Unit::length, 3e-6},
                    Case{"2 nm", Unit::length, 2e-9}, Case{"2 cm", Unit::length, 0.02},
                    Case{"2 km", Unit::length, 2000.0}, Case{"2 m", Unit::length, 2.0}, Case{"5 g", Unit::mass, 0.005},
                    Case{"5 kg", Unit::mass, 5.0}, Case{"5 mg", Unit::mass, 5e-6}, Case{"5 ug", Unit::mass, 5e-9},
                    Case{"5 t", Unit::mass, 5000.0}, Case{"300 ms", Unit::time, 0.3}, Case{"7 us", Unit::time, 7e-6},
                    Case{"7 ns", Unit::time, 7e-9}, Case{"2 min", Unit::time, 120.0}, Case{"2 h", Unit::time, 7200.0},
                    Case{"2 s", Unit::time, 2.0}, Case{"50 Hz", Unit::frequency, 50.0},
                    Case{"5 1/s", Unit::frequency, 5.0}, Case{"5 kHz", Unit::frequency, 5000.0},
                    Case{"0.5 MPa", Unit::pressure, 5e5}, Case{"48 GPa", Unit::pressure, 48e9},
                    Case{"3 kPa", Unit::pressure, 3000.0}, Case{"3 Pa", Unit::pressure, 3.0},
                    Case{"3 N/mm^2", Unit::pressure, 3e6}, Case{"2 bar", Unit::pressure, 2e5},
                    Case{"2.5 g/cm^3", Unit::density, 2500.0}, Case{"2500 kg/m^3", Unit::density, 2500.0},
                    Case{"2 mm/s", Unit::velocity, 0.002}, Case{"3 m/s", Unit::velocity, 3.0},
                    Case{"30 rad/s", Unit::angular_velocity, 30.0}, Case{"5 mN", Unit::force, 0.005},
                    Case{"5 uN", Unit::force, 5e-6}, Case{"5 kN", Unit::force, 5000.0},
                    Case{"-9.81 m/s^2", Unit::acceleration, -9.81}, Case{"5 N/mm", Unit::stiffness, 5000.0},
                    Case{"5 kN/m", Unit::stiffness, 5000.0}, Case{"1 deg", Unit::angle_degree, 1.0},
                    Case{"0.05 degree", Unit::angle_degree, 0.05}));

// Greek mu of a keyboard (U+03BC), raised digits, and spellings of laboratories.
INSTANTIATE_TEST_SUITE_P(
    Spellings, EveryUnit,
    testing::Values(Case{"3 \u03bcm", Unit::length, 3e-6}, Case{"3 \u00b5m", Unit::length, 3e-6},
                    Case{"7 \u03bcs", Unit::time, 7e-6}, Case{"5 \u03bcN", Unit::force, 5e-6},
                    Case{"5 \u03bcm/s", Unit::velocity, 5e-6}, Case{"5 \u03bcg", Unit::mass, 5e-9},
                    Case{"2500 kg/m\u00b3", Unit::density, 2500.0}, Case{"2500 kg/m3", Unit::density, 2500.0},
                    Case{"2500 kg/m**3", Unit::density, 2500.0}, Case{"2.5 g/cm\u00b3", Unit::density, 2500.0},
                    Case{"2.5 g/cc", Unit::density, 2500.0}, Case{"2.5 kg/dm\u00b3", Unit::density, 2500.0},
                    Case{"3 N/mm\u00b2", Unit::pressure, 3e6}, Case{"3 N/mm2", Unit::pressure, 3e6},
                    Case{"3 kN/m\u00b2", Unit::pressure, 3e3}, Case{"3 mbar", Unit::pressure, 300.0},
                    Case{"-9.81 m/s\u00b2", Unit::acceleration, -9.81}, Case{"90\u00b0", Unit::angle_degree, 90.0}));

TEST(Units, AnyUnitGoesToSi) {
  EXPECT_EQ(quantity_of_any_unit("50 GPa"), 5e10);
  EXPECT_EQ(quantity_of_any_unit("0.25"), 0.25);
  EXPECT_EQ(quantity_of_any_unit("16 mm"), 0.016);
  EXPECT_EQ(quantity_of_any_unit("2 g/cc"), 2000.0);
  for (const char* text : {"damped", "", "[0.1, 0.2]", "3 apples", "true"})
    EXPECT_FALSE(quantity_of_any_unit(text)) << text;
}

TEST(Units, FactorsThatAreNoPowersOfTen) {
  EXPECT_DOUBLE_EQ(parse_quantity("36 km/h", Unit::velocity), 10.0);
  EXPECT_DOUBLE_EQ(parse_quantity("60 rpm", Unit::angular_velocity), 2.0 * kPi);
  EXPECT_DOUBLE_EQ(parse_quantity("180 deg/s", Unit::angular_velocity), kPi);
  EXPECT_DOUBLE_EQ(parse_quantity("3.141592653589793 rad", Unit::angle_degree), 180.0);
}

TEST(Units, WhatIsNoQuantityIsRefused) {
  for (const char* text :
       {"", "mm", "nan", "inf", "-inf mm", "1e400", "1e-400", "1,5 mm", "16 mm 3", "0x10", "--3", "1e99999999999 m"})
    EXPECT_THROW((void)parse_quantity(text, Unit::length), InputError) << text;
}

TEST(Units, WrongUnitNamesTheKnownOnes) {
  try {
    (void)parse_quantity("16 Pa", Unit::length);
    FAIL() << "no error";
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "unknown unit 'Pa', known are m, km, cm, mm, um, µm, nm");
  }
  EXPECT_THROW((void)parse_quantity("3 mm", Unit::none), InputError);
  EXPECT_THROW((void)parse_quantity("3 M", Unit::length), InputError);
}

TEST(Units, ADecimalCommaIsNamedAndNotTakenForAUnit) {
  for (const auto& [text, unit] : {std::pair{"0,5 MPa", Unit::pressure}, std::pair{"0,5", Unit::none}}) try {
      (void)parse_quantity(text, unit);
      ADD_FAILURE() << "no error: " << text;
    } catch (const InputError& e) {
      EXPECT_STREQ(e.what(), "has a comma; write a decimal point, as in 0.5, and nothing between thousands");
    }
}

}  // namespace
}  // namespace softgrain
