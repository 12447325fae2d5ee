// Curves from the points of LAMMPS: what our own engine records, and what went wrong said as with it.
#include <gtest/gtest.h>

#include "common/core/error.h"
#include "macrosim/lammps_run/lammps_curve.h"
#include "macrosim/test_protocol.h"
#include "tests/support/lammps_files.h"

namespace softgrain {
namespace {

using lammps::Point;
using lammps::PointRow;
using test::point_row;
using test::staged_spec;
using test::with;

class Curves : public ::testing::Test {
 protected:
  Curves() {
    spec_.steps = 2;
    spec_.strain_end = 0.2;
    curve_.engine = "law";
    curve_.bodies = 4;
    curve_.soft = 2;
  }
  MacroSpec spec_;
  MacroCurve curve_;
};

TEST_F(Curves, RowsBecomeWhatOurOwnEngineRecords) {
  lammps::add_points({point_row(0, 0.0), point_row(1, 0.1), point_row(2, 0.2)}, spec_, curve_);
  ASSERT_EQ(curve_.strain.size(), 3U);
  EXPECT_EQ(curve_.strain, (std::vector<double>{0.0, 0.1, 0.2}));
  EXPECT_EQ(curve_.stress_x[1], 10.5);
  EXPECT_EQ(curve_.stress_y[1], 12.5);
  EXPECT_EQ(curve_.stress_axial[1], 14.5);
  EXPECT_EQ(curve_.stress_lateral[1], 11.5);
  EXPECT_EQ(curve_.stress_deviator[1], 4.0);
  EXPECT_EQ(curve_.stress_axial_contacts[1], 15.0);
  EXPECT_EQ(curve_.coordination[1], 2.0);
  EXPECT_EQ(curve_.coordination_bodies[1], 1.5);
  EXPECT_EQ(curve_.law_evaluations[1], 3.0);
  EXPECT_EQ(curve_.cost.loop_passes, 300);
  EXPECT_EQ(curve_.cost.contact_evaluations, 3702);
  EXPECT_TRUE(curve_.usable);
  EXPECT_EQ(curve_.note, "");
}

TEST_F(Curves, WhatWentWrongIsSaidAsWithOurOwnEngine) {
  // The point itself came to rest, the first of the two increments before it did not.
  const PointRow capped = with(with(point_row(1, 0.1), Point::unrest_end, 2.0), Point::unrest, 0.4);
  lammps::add_points({point_row(0, 0.0), capped, point_row(2, 0.2)}, spec_, curve_);
  EXPECT_FALSE(curve_.usable);
  EXPECT_EQ(curve_.note,
            "relaxation capped at strain 0.100000, increment 1 of the 2 before it (residual 0.400000 of the mean "
            "contact force, wanted 0.010000)");
  EXPECT_EQ(curve_.residual[1], 0.003);
  EXPECT_EQ(curve_.residual_largest, (std::vector<double>{0.003, 0.4, 0.003}));
}

/// The script keeps the increment that ended farthest from rest, of short forms and of stages.
TEST_F(Curves, ARefusedLawEndsTheTest) {
  PointRow last = with(point_row(1, 0.1), Point::law_refused, 1.0);
  last = with(with(last, Point::law_beyond, 1.0), Point::law_largest, 1.5);
  EXPECT_TRUE(lammps::ended_early(last));
  lammps::add_points({point_row(0, 0.0), last}, spec_, curve_);
  EXPECT_FALSE(curve_.usable);
  EXPECT_NE(curve_.note.find("which the law does not allow"), std::string::npos) << curve_.note;
}

/// Without walls the stress is that of the contacts; strains come from the box, and a stage whose stress was not
/// reached is said.
TEST_F(Curves, RowsOfStagesSayWhatTheBoxDid) {
  MacroSpec spec = staged_spec();
  spec.stages.resize(1);
  spec.stages[0].steps = 1;
  curve_.boundary = Boundary::periodic;
  const PointRow first = point_row(0, 0.0);
  curve_.start.size_x = first[Point::lx];
  curve_.start.size_y = first[Point::ly];
  curve_.start.size_z = first[Point::lz];
  PointRow second = with(with(point_row(1, 0.1), Point::lz, 0.9 * first[Point::lz]), Point::over, 1.0);
  second = with(with(second, Point::end, 2.0), Point::asked_z, 300.0);
  EXPECT_TRUE(lammps::ended_early(second));
  lammps::add_points({first, second}, spec, curve_);
  EXPECT_NEAR(curve_.strain_z[1], 0.1, 1e-12);
  EXPECT_EQ(curve_.strain, curve_.strain_z);
  EXPECT_EQ(curve_.strain_x[1], 0.0);
  const double volume = second[Point::lx] * second[Point::ly] * second[Point::lz];
  EXPECT_DOUBLE_EQ(curve_.stress_x[1], second[Point::branch_xx] / volume);
  EXPECT_FALSE(curve_.usable);
  EXPECT_NE(curve_.note.find("stage 'consolidation' ended at axial strain 0.1"), std::string::npos) << curve_.note;
  EXPECT_NE(curve_.note.find("z 300 Pa asked"), std::string::npos) << curve_.note;
}

/// Rows of a run that went on without the stress at which its stage began.
TEST_F(Curves, StressesThatDoNotFollowFromTheBeginAreRefused) {
  MacroSpec spec = staged_spec();
  spec.stages.resize(1);
  spec.stages[0].steps = 2;
  curve_.boundary = Boundary::periodic;
  const PointRow first = point_row(0, 0.0);
  const double volume = first[Point::lx] * first[Point::ly] * first[Point::lz];
  const double began = first[Point::branch_zz] / volume;
  const auto asking = [&](double x, double y, double z) {
    return with(with(with(point_row(1, 0.0), Point::asked_x, x), Point::asked_y, y), Point::asked_z, z);
  };
  const double half_x = 0.5 * (first[Point::branch_xx] / volume + 300.0);
  const double half_y = 0.5 * (first[Point::branch_yy] / volume + 300.0);
  MacroCurve good = curve_;
  EXPECT_NO_THROW(lammps::add_points({first, asking(half_x, half_y, 0.5 * (began + 300.0))}, spec, good));
  EXPECT_GT(began, 1.0);
  EXPECT_THROW(lammps::add_points({first, asking(half_x, half_y, 150.0)}, spec, curve_), IoError) << "as from 0";
}

TEST_F(Curves, AnotherTestIsRefused) {
  EXPECT_THROW(lammps::add_points({point_row(0, 0.0), point_row(1, 0.11)}, spec_, curve_), IoError);
}

}  // namespace
}  // namespace softgrain
