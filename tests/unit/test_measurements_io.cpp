// Measurements and macro curves on disk: bitwise round trips, damage refused.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <numeric>

#include "common/core/error.h"
#include "common/data/fields.h"
#include "common/data/macro_result.h"
#include "common/data/measurements.h"
#include "tests/support/hdf5_edit.h"

namespace softgrain {
namespace {

namespace fs = std::filesystem;

std::string temporary(const std::string& name) {
  return (fs::temp_directory_path() / ("softgrain_" + std::to_string(::getpid()) + "_" + name)).string();
}

PackingRun sample_run(std::int64_t packing, PairKind kind, const std::string& relaxation, int normal, int tangential) {
  PackingRun run;
  run.packing = packing;
  run.kind = kind;
  run.relaxation = relaxation;
  for (int k = 0; k < normal; ++k)
    run.normal.push_back({0.05 * k, std::sqrt(k + 0.1), 1e-3 / (k + 1), 0.01 * k, k % 2 == 0});
  for (int k = 0; k < tangential; ++k)
    run.tangential.push_back({0.2, -1.0 + 0.7 * k, 0.1 / (k + 3), -0.01 * k, 1e-5, k % 3 == 0});
  run.normal_cost = {100 + packing, 12345678901, 0.1};
  run.tangential_cost = {7, 8, 1.0 / 3.0};
  return run;
}

Measurements sample() {
  Measurements data;
  data.spec.shell_radius = 0.1 / 7.0;
  data.spec.trials = 12345;
  data.shell_turns = false;
  data.approach_speed = 0.002;
  data.turn_speed = 0.001;
  data.settings = {{"published", "stops = 6"}};
  data.packings = {{7, 3, 0.71, 0.8, 3.4, 0.2, {1e-3, 2e-3 / 3.0, 5e-4}},
                   {8, 0, 0.0, 0.0, std::nan(""), 0.0, {}},
                   {std::uint64_t{1} << 63, 1, 0.6, 0.7, 3.6, 0.1, {4e-3}}};
  data.runs = {sample_run(0, PairKind::soft_solid, "damped", 5, 3),
               sample_run(2, PairKind::soft_soft, "published", 0, 0),
               sample_run(2, PairKind::soft_soft, "damped", 2, 1)};
  return data;
}

void expect_equal(const Cost& a, const Cost& b) {
  EXPECT_EQ(a.loop_passes, b.loop_passes);
  EXPECT_EQ(a.contact_evaluations, b.contact_evaluations);
  EXPECT_EQ(a.seconds, b.seconds);
}

void expect_equal(const PackingRun& a, const PackingRun& b) {
  EXPECT_EQ(a.packing, b.packing);
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.relaxation, b.relaxation);
  expect_equal(a.normal_cost, b.normal_cost);
  expect_equal(a.tangential_cost, b.tangential_cost);
  ASSERT_EQ(a.normal.size(), b.normal.size());
  for (std::size_t k = 0; k < a.normal.size(); ++k) {
    const NormalPoint& p = a.normal[k];
    const NormalPoint& q = b.normal[k];
    EXPECT_EQ((std::array{p.delta, p.force, p.residual, p.max_overlap}),
              (std::array{q.delta, q.force, q.residual, q.max_overlap}));
    EXPECT_EQ(p.converged, q.converged);
  }
  ASSERT_EQ(a.tangential.size(), b.tangential.size());
  for (std::size_t k = 0; k < a.tangential.size(); ++k) {
    const TangentialPoint& p = a.tangential[k];
    const TangentialPoint& q = b.tangential[k];
    EXPECT_EQ((std::array{p.delta, p.angle_deg, p.force_parallel, p.force_perpendicular, p.residual}),
              (std::array{q.delta, q.angle_deg, q.force_parallel, q.force_perpendicular, q.residual}));
    EXPECT_EQ(p.converged, q.converged);
  }
}

TEST(MeasurementsIo, RoundTripIsExact) {
  const std::string path = temporary("measurements.h5");
  const Measurements out = sample();
  save(out, path);
  const Measurements in = load_measurements(path);
  fs::remove(path);
  EXPECT_EQ(in.spec.shell_radius, out.spec.shell_radius);
  EXPECT_EQ(in.spec.youngs_modulus, out.spec.youngs_modulus);
  EXPECT_EQ(in.spec.beta, out.spec.beta);
  EXPECT_EQ(in.spec.trials, out.spec.trials);
  EXPECT_EQ(in.shell_turns, out.shell_turns);
  EXPECT_EQ(in.approach_speed, out.approach_speed);
  EXPECT_EQ(in.turn, TurnProtocol::slow);
  EXPECT_EQ(in.turn_speed, 0.001);
  EXPECT_EQ(in.settings, out.settings);
  ASSERT_EQ(in.packings.size(), out.packings.size());
  for (std::size_t k = 0; k < in.packings.size(); ++k) {
    EXPECT_EQ(in.packings[k].seed, out.packings[k].seed);
    EXPECT_EQ(in.packings[k].grains, out.packings[k].grains);
    EXPECT_EQ(in.packings[k].solid_fraction, out.packings[k].solid_fraction);
    EXPECT_EQ(in.packings[k].contacts_per_grain, out.packings[k].contacts_per_grain);
    EXPECT_EQ(in.packings[k].radii, out.packings[k].radii);
  }
  EXPECT_TRUE(std::isnan(in.packings[1].exponent));
  ASSERT_EQ(in.runs.size(), out.runs.size());
  for (std::size_t k = 0; k < in.runs.size(); ++k) expect_equal(in.runs[k], out.runs[k]);
}

/// Files of earlier versions do not say how soft particles were turned: all at once.
TEST(MeasurementsIo, OldFilesHaveFrozenTurns) {
  const std::string path = temporary("old_turn.h5");
  save(sample(), path);
  {
    test::Hdf5Edit file(path);
    for (const char* name : {"turn", "turn_speed", "turn_speed_unit"}) file.remove_attribute("/", name);
  }
  const Measurements in = load_measurements(path);
  fs::remove(path);
  EXPECT_EQ(in.turn, TurnProtocol::frozen);
  EXPECT_EQ(in.turn_speed, 0.0);
}

TEST(MeasurementsIo, EmptyDataAreData) {
  const std::string path = temporary("empty.h5");
  save(Measurements{}, path);
  const Measurements in = load_measurements(path);
  EXPECT_TRUE(in.packings.empty());
  EXPECT_TRUE(in.runs.empty());
  fs::remove(path);
}

TEST(MeasurementsIo, OtherFilesAndDamageAreRefused) {
  const std::string path = temporary("refused.h5");
  EXPECT_THROW((void)load_measurements(path), IoError);
  save_macro({}, path);
  EXPECT_THROW((void)load_measurements(path), IoError);
  save(sample(), path);
  fs::resize_file(path, fs::file_size(path) * 2 / 3);
  EXPECT_THROW((void)load_measurements(path), IoError);
  Measurements bad = sample();
  bad.runs[0].packing = 17;  // points nowhere
  save(bad, path);
  EXPECT_THROW((void)load_measurements(path), IoError);
  fs::remove(path);
  EXPECT_THROW(save(sample(), "/proc/softgrain/measurements.h5"), IoError);
}

TEST(MacroIo, RoundTripIsExactAndKeepsTheOrder) {
  std::vector<MacroCurve> out(12);
  for (std::size_t k = 0; k < out.size(); ++k) {
    MacroCurve& c = out[k];
    c.engine = k % 2 == 0 ? "law" : "shelled";
    c.test = MacroTest::oedometric;
    c.sample = static_cast<std::int64_t>(k);
    c.bodies = 100;
    c.soft = 20;
    c.grains = 4000;
    c.soft_volume_share = 1.0 / 3.0;
    c.solid_fraction = 0.6;
    c.strain = {0.0, 0.01 / 3.0};
    c.stress_axial = {0.0, 1234.5};
    c.stress_lateral = c.stress_axial_contacts = c.coordination = c.residual = {0.1, 0.2};
    c.usable = k != 3;
    c.note = k == 3 ? "did not settle" : "";
    c.cost = {1, 2, 0.3};
  }
  const std::string path = temporary("macro.h5");
  save_macro(out, path);
  const std::vector<MacroCurve> in = load_macro(path);
  fs::remove(path);
  ASSERT_EQ(in.size(), out.size());
  for (std::size_t k = 0; k < in.size(); ++k) {
    EXPECT_EQ(in[k].engine, out[k].engine);
    EXPECT_EQ(in[k].sample, out[k].sample);
    EXPECT_EQ(in[k].grains, out[k].grains);
    EXPECT_EQ(in[k].strain, out[k].strain);
    EXPECT_EQ(in[k].stress_axial, out[k].stress_axial);
    EXPECT_EQ(in[k].residual, out[k].residual);
    EXPECT_EQ(in[k].soft_volume_share, out[k].soft_volume_share);
    EXPECT_EQ(in[k].usable, out[k].usable);
    EXPECT_EQ(in[k].note, out[k].note);
    expect_equal(in[k].cost, out[k].cost);
  }
}

TEST(MacroIo, LaterColumnsAreKeptAndMayBeAbsent) {
  std::vector<MacroCurve> out(2);
  for (MacroCurve& c : out) {
    c.engine = "free";
    c.test = MacroTest::shear;
    c.strain = c.stress_axial = c.stress_lateral = c.stress_axial_contacts = c.coordination = c.residual = {0.0, 0.1};
  }
  MacroCurve& full = out[1];
  full.preload = 0.03;
  full.stress_x = {1.0, 2.0};
  full.stress_y = {3.0, 4.0};
  full.stress_deviator = {5.0, 6.0};
  full.fabric = {0.1, 0.2};
  full.fabric_bodies = {0.3, 0.4};
  full.stress_xz = {0.0, -5.0};
  full.shear_strain = {0.0, 0.01};
  full.inertial_number = {0.0, 1e-3};
  full.fabric_tensor[4] = {0.0, -0.02};
  full.coordination_bodies = {4.0, 5.0};
  full.body_forces = {7.0, 8.0, 9.0};
  const std::string path = temporary("later.h5");
  save_macro(out, path);
  const std::vector<MacroCurve> in = load_macro(path);
  ASSERT_EQ(in.size(), 2U);
  EXPECT_TRUE(in[0].stress_x.empty());
  EXPECT_TRUE(in[0].body_forces.empty());
  EXPECT_EQ(in[1].preload, 0.03);
  EXPECT_EQ(in[1].stress_x, full.stress_x);
  EXPECT_EQ(in[1].stress_y, full.stress_y);
  EXPECT_EQ(in[1].stress_deviator, full.stress_deviator);
  EXPECT_EQ(in[1].fabric, full.fabric);
  EXPECT_EQ(in[1].fabric_bodies, full.fabric_bodies);
  EXPECT_EQ(in[1].stress_xz, full.stress_xz);
  EXPECT_EQ(in[1].shear_strain, full.shear_strain);
  EXPECT_EQ(in[1].inertial_number, full.inertial_number);
  EXPECT_EQ(in[1].fabric_tensor, full.fabric_tensor);
  EXPECT_EQ(in[1].coordination_bodies, full.coordination_bodies);
  EXPECT_EQ(in[1].body_forces, full.body_forces);
  // Forces over their mean of 8 N, in bins of 0.1: 0.875, 1, 1.125.
  const std::vector<std::int64_t> counts =
      h5::open_file(path).open("curves").open("curve_000001").open("force_distribution").integers("counts");
  EXPECT_EQ(counts.size(), 100U);
  EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), std::int64_t{0}), 3);
  EXPECT_EQ(counts[8], 1);
  EXPECT_EQ(counts[11], 1);
  out[1].fabric.push_back(0.5);
  save_macro(out, path);
  EXPECT_THROW((void)load_macro(path), IoError);
}

TEST(MacroIo, ColumnsOfUnequalLengthAreRefused) {
  std::vector<MacroCurve> curves(1);
  curves[0].strain = {0.0, 0.1};
  const std::string path = temporary("unequal.h5");
  save_macro(curves, path);
  EXPECT_THROW((void)load_macro(path), IoError);
  fs::remove(path);
}

TEST(RowsOfCheckpoints, HoldTheFieldsInTheirOrder) {
  const std::vector<TangentialPoint> points{{0.1, -0.5, 1.25, 0.3, 1e-3, true}, {0.2, 1.0, 2.0 / 3.0, 0.0, 0.5, false}};
  const std::vector<double> rows = rows_of(points);
  EXPECT_EQ(rows, (std::vector<double>{0.1, -0.5, 1.25, 0.3, 1e-3, 1.0, 0.2, 1.0, 2.0 / 3.0, 0.0, 0.5, 0.0}));
  const auto read = records_of<TangentialPoint>(rows);
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(rows_of(read), rows);
  EXPECT_TRUE(read[0].converged);
  EXPECT_FALSE(read[1].converged);
  EXPECT_EQ(rows_of(std::vector{Cost{3, 40, 0.5}}), (std::vector<double>{3.0, 40.0, 0.5}));
  EXPECT_TRUE(records_of<NormalPoint>({}).empty());
}

}  // namespace
}  // namespace softgrain
