// Outside benchmarks, run by the built program from scene files alone.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include "common/io/hdf5_file.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

std::string scene(const std::string& name) {
  return std::string(SOFTGRAIN_REFERENCE_DIR) + "/scenes/" + name + ".toml";
}

/// Rows of numbers of a text file; other lines are left out.
std::vector<std::vector<double>> table(const std::string& file) {
  std::ifstream in(std::string(SOFTGRAIN_REFERENCE_DIR) + "/" + file);
  EXPECT_TRUE(in) << file;
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::vector<double> row;
    for (double x = 0.0; words >> x;) row.push_back(x);
    if (row.size() >= 2 && words.eof()) rows.push_back(row);
  }
  EXPECT_GT(rows.size(), 4U) << file;
  return rows;
}

struct Expected {
  double force, overlap, duration;
};

void expect_contact(const nlohmann::json& summary, const Expected& expected) {
  ASSERT_EQ(summary["contacts"].size(), 1U);
  const auto& contact = summary["contacts"][0];
  EXPECT_EQ(contact["count"], 1);
  EXPECT_NEAR(contact["max_force"].get<double>() / expected.force, 1.0, 1e-4);
  EXPECT_NEAR(contact["max_overlap"].get<double>() / expected.overlap, 1.0, 1e-4);
  EXPECT_NEAR(contact["duration"].get<double>() / expected.duration, 1.0, 1e-4);
  EXPECT_LE(summary["step"].get<double>(), expected.duration / 200.0 * 1.001)
      << "resolution that the scene is run with";
}

/// Force on particle 0 from the change of its velocity along `axis` between frames.
struct ForceCurve {
  std::vector<double> time, force;
  [[nodiscard]] double at(double t) const {
    for (std::size_t k = 1; k < time.size(); ++k)
      if (time[k] >= t) return force[k - 1] + (force[k] - force[k - 1]) * (t - time[k - 1]) / (time[k] - time[k - 1]);
    return 0.0;
  }
};

ForceCurve force_curve(const std::string& directory, std::size_t axis) {
  const h5::Group root = h5::open_file(directory + "/run.h5");
  const double mass = root.open("bodies").doubles("mass")[0];
  const auto time = root.open("trajectory").doubles("time");
  const auto velocity = root.open("trajectory").doubles("velocity");
  const std::size_t width = velocity.size() / time.size();
  ForceCurve out;
  for (std::size_t k = 1; k < time.size(); ++k) {
    out.time.push_back(0.5 * (time[k] + time[k - 1]));
    out.force.push_back(mass * std::abs(velocity[k * width + axis] - velocity[(k - 1) * width + axis]) /
                        (time[k] - time[k - 1]));
  }
  return out;
}

/// Against a curve read off a figure [us, kN]; the contact begins at `start`.
void expect_curve(const ForceCurve& curve, const std::string& file, double start, double largest) {
  for (const auto& row : table(file)) {
    EXPECT_NEAR(curve.at(start + row[0] * 1e-6), row[1] * 1e3, 0.03 * largest) << file << " at " << row[0] << " us";
  }
}

TEST(ImpactBenchmarks, TwoIdenticalSpheres) {
  const TemporaryDirectory directory;
  const auto summary = run_scene(scene("two_spheres"), directory.path());
  expect_contact(summary, {10696.889, 274.1127e-6, 40.33946e-6});
  EXPECT_NEAR(summary["particles"][0]["velocity"][0].get<double>(), -10.0, 1e-4);
  EXPECT_NEAR(summary["particles"][1]["velocity"][0].get<double>(), 10.0, 1e-4);
  expect_curve(force_curve(directory.path(), 0), "chung_ooi/chung_ooi_test1_F_vs_t.dat", 1e-3 / 20.0, 10696.889);
}

TEST(ImpactBenchmarks, SphereOnARigidPlane) {
  const TemporaryDirectory directory;
  const auto summary = run_scene(scene("sphere_on_rigid_plane"), directory.path());
  expect_contact(summary, {11369.858, 49.7172e-6, 731.6566e-6});
  EXPECT_NEAR(summary["particles"][0]["velocity"][2].get<double>(), 0.2, 2e-6);
  expect_curve(force_curve(directory.path(), 2), "chung_ooi/chung_ooi_test2_F_vs_t.dat", 1e-4 / 0.2, 11369.858);
}

/// Moment at which the contact point stops, interpolated, and the speed of the ball then.
struct EndOfSliding {
  double time = -1.0;
  double speed = 0.0;
  double spin = 0.0;
};

EndOfSliding end_of_sliding(const std::string& directory, double radius) {
  const h5::Group frames = h5::open_file(directory + "/run.h5").open("trajectory");
  const auto time = frames.doubles("time");
  const auto v = frames.doubles("velocity");
  const auto w = frames.doubles("spin");
  const auto slip = [&](std::size_t k) { return v[3 * k] - radius * w[3 * k + 1]; };
  for (std::size_t k = 1; k < time.size(); ++k) {
    if (slip(k) > 0.0) continue;
    const double share = slip(k - 1) / (slip(k - 1) - slip(k));
    const auto between = [&](double a, double b) { return a + share * (b - a); };
    return {between(time[k - 1], time[k]), between(v[3 * k - 3], v[3 * k]), between(w[3 * k - 2], w[3 * k + 1])};
  }
  return {};
}

TEST(ImpactBenchmarks, SlidingBallStartsToRoll) {
  const double u0 = 0.1;
  const double g = 9.81;
  const double radius = 5e-4;
  const auto times = table("mfix_dem/DEM04_POST_TIME.dat");
  const auto speeds = table("mfix_dem/DEM04_POST_TVEL.dat");
  const auto spins = table("mfix_dem/DEM04_POST_AVEL.dat");
  ASSERT_EQ(times.size(), 9U);
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double mu = times[k][0];
    const TemporaryDirectory directory;
    const auto summary = run_scene(scene("sliding_ball"), directory.path(), "--set contact.0.mu=" + std::to_string(mu));
    const EndOfSliding end = end_of_sliding(directory.path(), radius);
    EXPECT_NEAR(end.time * mu * g / u0 / times[k][1], 1.0, 0.005) << "mu " << mu;
    EXPECT_NEAR(end.speed / u0 / speeds[k][1], 1.0, 2e-4) << "mu " << mu;
    EXPECT_NEAR(end.spin * radius / u0 / spins[k][1], 1.0, 2e-4) << "mu " << mu;
    // Later the tangential dashpot has stopped the rest of the motion on the spring: pure rolling.
    const auto& ball = summary["particles"][0];
    EXPECT_NEAR(ball["velocity"][0].get<double>(), 5.0 / 7.0 * u0, 2e-4 * u0);
    EXPECT_NEAR(ball["spin"][1].get<double>() * radius, 5.0 / 7.0 * u0, 2e-4 * u0);
  }
}

TEST(ImpactBenchmarks, ObliqueImpactBeyondThirtyDegrees) {
  for (const auto& row : table("chung_ooi/chung_ooi_test4_tangential_restitution.dat")) {
    if (row[0] < 30.0) continue;  // there the curve depends on the tangential law
    const TemporaryDirectory directory;
    const double angle = row[0] * std::numbers::pi / 180.0;
    const double vx = 3.9 * std::sin(angle);
    std::ostringstream set;
    set.precision(17);
    set << "--set 'particle.0.velocity=[" << vx << ", 0.0, " << -3.9 * std::cos(angle) << "]'";
    const auto summary = run_scene(scene("oblique_impact"), directory.path(), set.str() + " --set time.end='60 us'");
    ASSERT_EQ(summary["contacts"].size(), 1U);
    EXPECT_NEAR(summary["particles"][0]["velocity"][0].get<double>() / vx, row[1], 0.016 * row[1])
        << row[0] << " degrees";
  }
}

}  // namespace
