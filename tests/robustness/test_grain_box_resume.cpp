// A run of grain boxes that is stopped at many moments and resumed ends with the same bits as one left alone.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>

#include "common/io/text_file.h"
#include "microsim/grain_box/record.h"
#include "tests/support/disturbed_run.h"
#include "tests/support/process.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

const char* const kScene = R"(kind = "grain-box"
seed = 5
[box]
grains = 100
[generation]
pressure = "10 MPa"
increment = 5e-4
window = 4
saturation = 0.1
[loading]
increment = 5e-4
end_strain = 0.03
probe_every = 4
[[variant]]
name = "a"
[[variant]]
name = "b"
mu = 0.6
pressure = "20 MPa"
)";

template <class T>
void expect_same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  ASSERT_EQ(a.size(), b.size());
  if (!a.empty()) {
    EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(T)), 0);
  }
}

void expect_same(const GrainBoxState& a, const GrainBoxState& b) {
  expect_same_bits(a.pack.position, b.pack.position);
  expect_same_bits(a.pack.radius, b.pack.radius);
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t k = 0; k < a.points.size(); ++k) {
    const BoxPoint& p = a.points[k];
    const BoxPoint& q = b.points[k];
    EXPECT_EQ(p.strain, q.strain) << k;
    EXPECT_EQ(p.stress, q.stress) << k;
    EXPECT_EQ(p.effort.iterations, q.effort.iterations) << k;
    EXPECT_EQ(p.effort.factorisations, q.effort.factorisations) << k;
    EXPECT_TRUE(p.bulk_probe == q.bulk_probe || (std::isnan(p.bulk_probe) && std::isnan(q.bulk_probe))) << k;
  }
  ASSERT_EQ(a.pack.contacts.size(), b.pack.contacts.size());
  for (std::size_t k = 0; k < a.pack.contacts.size(); ++k) {
    EXPECT_EQ(a.pack.contacts[k].tangential_force, b.pack.contacts[k].tangential_force);
    EXPECT_EQ(a.pack.contacts[k].torsion, b.pack.contacts[k].torsion);
  }
}

TEST(GrainBoxResume, InterruptedRunsEndInTheSameBits) {
  const TemporaryDirectory directory;
  const std::string scene = directory.file("scene.toml");
  write_text_atomic(scene, kScene);
  const double seconds = child_seconds_of([&] { (void)run_scene(scene, directory.file("whole")); });
  const auto whole = load_grain_boxes(directory.file("whole/grain_box.h5"));
  const std::string out = directory.file("stopped");
  const int stops = run_disturbed({SIGTERM, 12, 0.6 * seconds, 6}, out, 0, [&](int part) {
    std::vector<std::string> arguments{"microsim", scene, "--out", out, "--threads", "1", "--quiet"};
    if (part > 0) arguments.push_back("--resume");
    return start_program(arguments);
  });
  EXPECT_GE(stops, 2);
  const auto stopped = load_grain_boxes(out + "/grain_box.h5");
  ASSERT_EQ(stopped.size(), whole.size());
  for (std::size_t k = 0; k < whole.size(); ++k) expect_same(whole[k].state, stopped[k].state);
}

TEST(GrainBoxResume, ThreadsDoNotMatter) {
  const TemporaryDirectory directory;
  const std::string scene = directory.file("scene.toml");
  write_text_atomic(scene, kScene);
  (void)run_scene(scene, directory.file("one"));
  const std::string three_out = directory.file("three");
  EXPECT_EQ(run_the_program("microsim '" + scene + "' --quiet --threads 3 --out '" + three_out + "'").status, 0);
  const auto one = load_grain_boxes(directory.file("one/grain_box.h5"));
  const auto three = load_grain_boxes(three_out + "/grain_box.h5");
  ASSERT_EQ(one.size(), three.size());
  for (std::size_t k = 0; k < one.size(); ++k) expect_same(one[k].state, three[k].state);
}

}  // namespace
