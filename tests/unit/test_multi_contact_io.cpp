// Multi-contact measurements on disk: bitwise round trips, damage refused.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "common/core/error.h"
#include "common/data/multi_contact_measurements.h"
#include "tests/support/multi_contact.h"

namespace softgrain {
namespace {

namespace fs = std::filesystem;
using test::expect_equal;

std::string multi_contact_path(const std::string& name) {
  return (fs::temp_directory_path() / ("softgrain_" + std::to_string(::getpid()) + "_" + name)).string();
}

MultiContactPoint sample_point(std::size_t neighbours, int k) {
  MultiContactPoint p;
  p.stage = k == 0 || k == 2 ? 0 : 1;
  for (std::size_t n = 0; n < neighbours; ++n) {
    const double x = std::sqrt(static_cast<double>(n) + 0.1 * k);
    p.overlap.push_back(0.1 * x);
    p.normal.push_back(x / 3.0);
    p.tangential.push_back({{x, -x / 7.0, 1e-300}});
  }
  p.slide = 0.01 * k;
  p.centre = {{1e-3 / 3.0, 0.0, -k * 0.1}};
  p.residual = 1e-3 / (k + 1);
  p.max_overlap = 0.2;
  p.converged = k % 3 == 0;
  return p;
}

MultiContactMeasurements multi_contact_sample() {
  MultiContactMeasurements data;
  data.spec.shell_radius = 0.1 / 7.0;
  data.relaxation = "damped, increment 0.005";
  data.packings = {{7, 2, 0.71, 0.8, 3.4, 0.2, {1e-3, 2e-3 / 3.0}}, {8, 0, 0.0, 0.0, 1.0, 0.0, {}}};
  data.configurations = {
      {"one-plane",
       {{PartnerKind::plane, 0.0, {{1.0, 0.0, 0.0}}}},
       {{MultiContactMove::load, {0.3}, 0.0}, {MultiContactMove::slide, {0.3}, 0.1}},
       false,
       false},
      {"two-soft",
       {{PartnerKind::soft, 0.5, {{0.0, 1.0, 0.0}}}, {PartnerKind::solid, 2.0, {{0.6, 0.8, 0.0}}}},
       {{MultiContactMove::load, {0.2, 0.1 / 3.0}, 0.0}, {MultiContactMove::unload, {0.0, 0.0}, 0.0}},
       true,
       true}};
  data.runs = {{0, 1, {sample_point(1, 0), sample_point(1, 1)}, {1, 2, 0.3}},
               {1, 0, {}, {0, 0, 0.0}},
               {1, 1, {sample_point(2, 2), sample_point(2, 3), sample_point(2, 4)}, {4, 12345678901, 1.0 / 3.0}}};
  return data;
}

void expect_equal(const MultiContactConfiguration& a, const MultiContactConfiguration& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.centre_free, b.centre_free);
  EXPECT_EQ(a.held_out, b.held_out);
  ASSERT_EQ(a.partners.size(), b.partners.size());
  for (std::size_t k = 0; k < a.partners.size(); ++k) {
    EXPECT_EQ(a.partners[k].kind, b.partners[k].kind);
    EXPECT_EQ(a.partners[k].ratio, b.partners[k].ratio);
    EXPECT_EQ(a.partners[k].direction, b.partners[k].direction);
    EXPECT_EQ(a.partners[k].on, b.partners[k].on);
  }
  ASSERT_EQ(a.stages.size(), b.stages.size());
  for (std::size_t k = 0; k < a.stages.size(); ++k) {
    EXPECT_EQ(a.stages[k].move, b.stages[k].move);
    EXPECT_EQ(a.stages[k].overlap, b.stages[k].overlap);
    EXPECT_EQ(a.stages[k].slide, b.stages[k].slide);
  }
}

/// The soft neighbour has a plane behind it.
MultiContactMeasurements with_press(std::int32_t on) {
  MultiContactMeasurements data = multi_contact_sample();
  MultiContactConfiguration& c = data.configurations[1];
  c.partners.push_back({PartnerKind::plane, 0.0, {{0.0, 1.0, 0.0}}, false, on});
  for (MultiContactStage& s : c.stages) s.overlap.push_back(0.1);
  data.runs.resize(1);
  return data;
}

TEST(MultiContactIo, PlanesAroundSoftNeighboursComeBack) {
  const std::string path = multi_contact_path("pressed.h5");
  const MultiContactMeasurements out = with_press(0);
  save_multi_contact(out, path);
  expect_equal(load_multi_contact(path).configurations[1], out.configurations[1]);
  for (const std::int32_t wrong : {1, 2, 7}) {  // a solid one, itself, nothing
    save_multi_contact(with_press(wrong), path);
    EXPECT_THROW((void)load_multi_contact(path), IoError) << wrong;
  }
  fs::remove(path);
}

TEST(MultiContactIo, RoundTripIsExact) {
  const std::string path = multi_contact_path("multi_contact.h5");
  const MultiContactMeasurements out = multi_contact_sample();
  save_multi_contact(out, path);
  const MultiContactMeasurements in = load_multi_contact(path);
  fs::remove(path);
  EXPECT_EQ(in.spec.shell_radius, out.spec.shell_radius);
  EXPECT_EQ(in.relaxation, out.relaxation);
  ASSERT_EQ(in.packings.size(), out.packings.size());
  EXPECT_EQ(in.packings[0].radii, out.packings[0].radii);
  ASSERT_EQ(in.configurations.size(), out.configurations.size());
  for (std::size_t k = 0; k < in.configurations.size(); ++k) expect_equal(in.configurations[k], out.configurations[k]);
  ASSERT_EQ(in.runs.size(), out.runs.size());
  for (std::size_t k = 0; k < in.runs.size(); ++k) {
    EXPECT_EQ(in.runs[k].configuration, out.runs[k].configuration);
    EXPECT_EQ(in.runs[k].packing, out.runs[k].packing);
    EXPECT_EQ(in.runs[k].cost.seconds, out.runs[k].cost.seconds);
    EXPECT_EQ(in.runs[k].cost.loop_passes, out.runs[k].cost.loop_passes);
    EXPECT_EQ(in.runs[k].cost.contact_evaluations, out.runs[k].cost.contact_evaluations);
    expect_equal(in.runs[k].points, out.runs[k].points);
  }
}

TEST(MultiContactIo, EmptyDataAreData) {
  const std::string path = multi_contact_path("crowd_empty.h5");
  save_multi_contact(MultiContactMeasurements{}, path);
  EXPECT_TRUE(load_multi_contact(path).runs.empty());
  fs::remove(path);
}

TEST(MultiContactIo, OtherFilesAndDamageAreRefused) {
  const std::string path = multi_contact_path("crowd_refused.h5");
  EXPECT_THROW((void)load_multi_contact(path), IoError);
  save(Measurements{}, path);
  EXPECT_THROW((void)load_multi_contact(path), IoError);
  save_multi_contact(multi_contact_sample(), path);
  fs::resize_file(path, fs::file_size(path) * 2 / 3);
  EXPECT_THROW((void)load_multi_contact(path), IoError);
  MultiContactMeasurements bad = multi_contact_sample();
  bad.runs[0].packing = 17;  // points nowhere
  save_multi_contact(bad, path);
  EXPECT_THROW((void)load_multi_contact(path), IoError);
  bad = multi_contact_sample();
  bad.runs[2].configuration = 0;  // one neighbour there, points with two
  save_multi_contact(bad, path);
  EXPECT_THROW((void)load_multi_contact(path), IoError);
  bad = multi_contact_sample();
  bad.runs[0].points[0].stage = 2;
  save_multi_contact(bad, path);
  EXPECT_THROW((void)load_multi_contact(path), IoError);
  fs::remove(path);
  EXPECT_THROW(save_multi_contact(multi_contact_sample(), "/proc/softgrain/multi_contact.h5"), IoError);
}

}  // namespace
}  // namespace softgrain
