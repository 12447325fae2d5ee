// Structure of powders from the state of a run to its file, summary and report.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "common/core/error.h"
#include "common/io/text_file.h"
#include "common/state/system_io.h"
#include "microsim/powder/powder_assembly.h"
#include "microsim/powder/powder_start.h"
#include "microsim/powder/powder_state_io.h"
#include "pipelines/kinds/cohesive_powder/powder_data.h"
#include "pipelines/kinds/cohesive_powder/report_plots.h"
#include "pipelines/kinds/cohesive_powder/scene.h"
#include "pipelines/kinds/cohesive_powder/summary.h"
#include "pipelines/report/report.h"
#include "tests/support/hdf5_edit.h"
#include "tests/support/markup_check.h"
#include "tests/support/temporary_directory.h"

namespace softgrain {
namespace {

PowderSpec spec_of(std::int64_t disks) {
  PowderSpec spec;
  spec.disks = disks;
  return spec;
}

TEST(PowderStructure, AnEnsembleHasCommonBinsAndOneFit) {
  const System<2> a = make_powder(spec_of(300), 1, 0);
  const System<2> b = make_powder(spec_of(300), 1, 1);
  PowderStructureOptions options;
  options.mesh = 20.0;
  const PowderStructures both = powder_structures({&a, &b}, {true, true}, options);
  ASSERT_EQ(both.samples.size(), 2U);
  ASSERT_TRUE(both.mean_curve.has_value());
  EXPECT_EQ(both.fit.bins, 2 * both.samples[0].fit.bins);
  EXPECT_EQ(both.other_ranges.size(), 2U);
  EXPECT_LT(both.other_ranges[0].bins, both.other_ranges[1].bins);
  // Disks at random places are no fractal, and their void reaches around the cell.
  EXPECT_EQ(both.samples[0].holes->percolating, 1);
  PackSummary summary;
  add_structure(summary, both.samples[0]);
  const auto written = json_of(summary);
  EXPECT_TRUE(written["holes"]["mean_radius"].is_null());
  EXPECT_EQ(record_of<PackSummary>(written).holes->percolating, 1);
  EXPECT_EQ(record_of<PackSummary>(written).scattering->dimension.value, both.samples[0].fit.dimension.value);
  EXPECT_FALSE(structure_means_json(both, {true, true}).contains("R_w"));
  EXPECT_GE(structure_remarks(both).size(), 2U);
  const PowderStructures one = powder_structures({&a, &b}, {true, false}, options);
  EXPECT_EQ(one.fit.bins, both.samples[0].fit.bins);
}

TEST(PowderStructure, OptionsSwitchItsPartsOff) {
  const System<2> a = make_powder(spec_of(40), 1, 0);
  PowderStructureOptions options;
  options.mesh = 20.0;
  options.scattering = false;
  const PowderStructures holes = powder_structures({&a}, {true}, options);
  EXPECT_FALSE(holes.samples[0].curve.has_value());
  EXPECT_TRUE(holes.samples[0].holes.has_value());
  EXPECT_FALSE(holes.mean_curve.has_value());
  options.holes = false;
  EXPECT_TRUE(powder_structures({&a}, {true}, options).samples.empty());
}

TEST(PowderStructure, MeshAndRangeOfTheFitAreThoseAsked) {
  const System<2> a = make_powder(spec_of(60), 1, 0);
  PowderStructureOptions options;
  options.mesh = 10.0;
  const PowderStructures coarse = powder_structures({&a}, {true}, options);
  options.mesh = 20.0;
  options.fit_k_max = 6.0;
  const PowderStructures fine = powder_structures({&a}, {true}, options);
  EXPECT_GE(fine.samples[0].nx, 2 * coarse.samples[0].nx - 20);
  EXPECT_GT(fine.samples[0].fit.bins, coarse.samples[0].fit.bins);
  EXPECT_LE(fine.samples[0].fit.k_high, 6.0);
}

TEST(PowderStructure, TableAnalysisIsReadAndChecked) {
  const std::string head = "kind = \"cohesive-powder\"\n[analysis]\n";
  const auto read = [&](const std::string& keys) { return read_powder(Scene::parse(head + keys, "s.toml")).structure; };
  const PowderStructureOptions none = read("scattering = false\nholes = false\n");
  EXPECT_FALSE(none.scattering);
  EXPECT_FALSE(none.holes);
  const PowderStructureOptions o = read("holes = false\nmesh = 50\nfit_k_max = 2.5\n");
  EXPECT_EQ(o.mesh, 50.0);
  EXPECT_EQ(o.fit_k_max, 2.5);
  for (const char* idle : {"scattering = false\nfit_k_max = 2.5\n", "scattering = false\nholes = false\nmesh = 50\n"})
    EXPECT_THROW((void)read(idle), InputError) << idle;
  EXPECT_THROW((void)read("mesh = 2\n"), InputError);
  EXPECT_THROW((void)read("meshes = 50\n"), InputError);
}

TEST(PowderSpecIo, EveryMemberComesBack) {
  const PowderSpec spec{7, 0.6, 0.3, 2e4, 0.7, 0.15, 0.5, false, 2e-3, true, 3e-4, 4e-2, 0.02, 9.48, {}};
  const test::TemporaryDirectory directory;
  {
    h5::AtomicFile file(directory.file("s.h5"));
    write_powder_spec(file.root().create("spec"), spec);
    file.commit();
  }
  EXPECT_EQ(read_powder_spec(h5::open_file(directory.file("s.h5")).open("spec")), spec);
}

/// Files of version 0.2.0 and earlier say V0 of |v|.
TEST(PowderSpecIo, AnOldSpeedIsThatOfBothComponents) {
  PowderSpec spec = spec_of(7);
  spec.start_speed = 9.48;
  const test::TemporaryDirectory directory;
  {
    h5::AtomicFile file(directory.file("s.h5"));
    write_powder_spec(file.root().create("spec"), spec);
    file.commit();
  }
  {
    test::Hdf5Edit edit(directory.file("s.h5"));
    edit.remove_attribute("spec", "start_speed_per_component");
    edit.set_attribute("spec", "start_speed", 9.48);
  }
  const PowderSpec old = read_powder_spec(h5::open_file(directory.file("s.h5")).open("spec"));
  EXPECT_NEAR(old.start_speed, 9.48 / std::numbers::sqrt2, 1e-12);
  EXPECT_FALSE(old == spec);
}

TEST(PowderSnapshots, ComeBackAsTheyWere) {
  const test::TemporaryDirectory directory;
  PowderState state = start_powder(spec_of(12), 2, 0);
  System<2>& s = state.system;
  const Vec<2> lengths{{s.cell.edges[0][0], s.cell.edges[1][1]}};
  record_snapshot(state.snapshots, s);
  s.time = 7.5;
  s.particles.sphere[3].x = {{-4.0, 99.0}};
  s.cell.edges[1][1] = 25.0;
  record_snapshot(state.snapshots, s);
  {
    h5::AtomicFile file(directory.file("s.h5"));
    write_powder_state(file.root(), state);
    file.commit();
  }
  const h5::Group root = h5::open_file(directory.file("s.h5"));
  EXPECT_EQ(root.open("trajectory").shape("position"), (h5::Shape{2, 12, 3}));
  EXPECT_EQ(root.open("trajectory").text_of("time", "unit"), "T0");
  const SnapshotSeries back = read_powder_series(root, snapshot_of(s, false));
  ASSERT_EQ(back.size(), 2U);
  EXPECT_EQ(back.at(1)->time, 7.5);
  EXPECT_EQ(back.at(1)->particles[3].position, (Vec3{{-4.0, 99.0, 0.0}}));
  EXPECT_EQ(back.at(1)->cell_edges[1], (Vec3{{0.0, 25.0, 0.0}}));
  EXPECT_EQ(back.at(0)->particles[11].radius, s.particles.sphere[11].r);
  EXPECT_EQ(back.at(0)->cell_edges[0][0], lengths[0]);
  EXPECT_EQ(back.at(0)->cell_edges[1][1], lengths[1]);
  EXPECT_FALSE(back.at(0)->has_contacts || back.at(0)->has_velocity);
  PowderState again = start_powder(spec_of(12), 2, 0);
  read_powder_state(root, again);
  EXPECT_EQ(again.snapshots.position, state.snapshots.position);
}

/// As files and checkpoints of version 0.2 have them.
TEST(PowderSnapshots, OfVersion02AreRead) {
  const test::TemporaryDirectory directory;
  {
    h5::AtomicFile file(directory.file("s.h5"));
    const h5::Group all = file.root().create("snapshots");
    for (const double time : {0.0, 2.5}) {
      const h5::Group one = all.create(time > 0.0 ? "1" : "0");
      one.attribute("time", time);
      one.write("positions", std::vector<double>{1.0, 2.0, 3.0, 4.0 + time}, {2, 2});
      one.write("radii", std::vector<double>{0.5, 0.25});
      one.write("cell", std::vector<double>{8.0, 9.0});
    }
    file.commit();
  }
  const Trajectory t = read_snapshots(h5::open_file(directory.file("s.h5")));
  EXPECT_EQ(t.time, (std::vector<double>{0.0, 2.5}));
  EXPECT_EQ(t.position, (std::vector<double>{1.0, 2.0, 0.0, 3.0, 4.0, 0.0, 1.0, 2.0, 0.0, 3.0, 6.5, 0.0}));
  EXPECT_EQ(t.cell_edges[13], 9.0);
  test::Hdf5Edit(directory.file("s.h5")).remove("snapshots/1/cell");
  EXPECT_THROW((void)read_snapshots(h5::open_file(directory.file("s.h5"))), IoError);
}

TEST(PowderPlots, AHistogramIsADensity) {
  const report::Series s = report::histogram({0.1, 0.1, 0.6, 2.0}, 0.0, 1.0, 4);
  ASSERT_EQ(s.x.size(), 8U);
  EXPECT_DOUBLE_EQ(s.y[0], 2.0);  // half of all values in a bin of a quarter
  EXPECT_DOUBLE_EQ(s.y[2], 0.0);
  EXPECT_DOUBLE_EQ(s.y[4], 1.0);
  EXPECT_DOUBLE_EQ(s.x[7], 1.0);
}

PowderSample pair_across_the_boundary(double overlap, double force) {
  PowderSample sample;
  sample.packing.cell_edges = {{{{4.0, 0.0, 0.0}}, {{0.0, 4.0, 0.0}}, {}}};
  for (const auto& [x, y, r] : {std::array{0.1, 2.0, 0.5}, {3.1, 2.0, 0.5}, {2.0, 0.7, 0.4}}) {
    SnapshotParticle disk;
    disk.position = {{x, y, 0.0}};
    disk.radius = r;
    sample.packing.particles.push_back(disk);
  }
  ContactRecord<2> c;
  c.i = 0;
  c.j = 1;
  c.overlap = overlap;
  c.normal = {{1.0, 0.0}};
  c.branch = {{1.0, 0.0}};
  c.normal_force = force;
  c.tangential_force = {{0.0, 0.5 * force}};
  sample.contacts.push_back(c);
  return sample;
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

/// Disks and lines across the boundary appear on both sides; colours tell pressed, pulled, distant and idle.
TEST(PowderView, DrawsBothSidesInTheColoursOfTheForces) {
  using report::PowderLines;
  const auto pressed = report::packing_view(pair_across_the_boundary(1e-4, 2.0), PowderLines::forces, 1e-4, "a");
  EXPECT_EQ(count_of(pressed, "<circle"), 2U + 1U + 1U + 1U);  // one disk twice, two once, one in the legend
  EXPECT_EQ(count_of(pressed, "#c8102e"), 2U);                 // a group of lines, and the legend
  EXPECT_EQ(count_of(pressed, "#00843d"), 1U);
  const std::string lines = pressed.substr(pressed.find("<path d=\"M"));
  EXPECT_EQ(count_of(lines.substr(0, lines.find("/>")), "M"), 2U);
  EXPECT_EQ(unbalanced_tags(pressed), "");
  const auto pulled = report::packing_view(pair_across_the_boundary(1e-4, -2.0), PowderLines::forces, 1e-4, "a");
  EXPECT_EQ(count_of(pulled, "#00843d"), 2U);
  const auto distant = report::packing_view(pair_across_the_boundary(-1e-4, -0.9), PowderLines::forces, 1e-4, "a");
  EXPECT_EQ(count_of(distant, "#1f5fd0"), 2U);
  const auto idle = report::packing_view(pair_across_the_boundary(1e-4, 1e-6), PowderLines::forces, 1e-4, "a");
  EXPECT_EQ(count_of(idle, "#1f5fd0"), 1U);
  const auto shown = report::packing_view(pair_across_the_boundary(1e-4, 1e-6), PowderLines::stressed, 1e-4, "a");
  EXPECT_EQ(count_of(shown, "#1f5fd0"), 3U);  // the line, and two entries of the legend
}

TEST(PowderPlots, ForcesAreSplitIntoNormalRatioAndAngle) {
  PowderRun run;
  run.samples = {pair_across_the_boundary(1e-4, -2.0), pair_across_the_boundary(-1e-4, -0.5),
                 pair_across_the_boundary(1e-4, 1e-6)};
  const report::PowderForces f = report::powder_forces(run);
  EXPECT_EQ(f.normal, (std::vector<double>{-2.0, -0.5}));
  ASSERT_EQ(f.ratio.size(), 1U);
  EXPECT_DOUBLE_EQ(f.ratio[0], 0.5);
  EXPECT_NEAR(f.angle[0], 180.0 - std::atan(0.5) * 180.0 / std::numbers::pi, 1e-12);
}

/// A short run, whose samples are not at rest: file, summary and report still fit together.
TEST(PowderReport, ShowsWhatARunWrote) {
  const test::TemporaryDirectory directory;
  write_text_atomic(directory.file("tiny.toml"), R"(kind = "cohesive-powder"
samples = 2
[disks]
count = 120
[contact]
kappa = 1e2
[assembly]
time_max = 120.0
record_every = 2.0
[analysis]
mesh = 20
)");
  CommonOptions options;
  options.out = directory.file("run");
  options.quiet = true;
  testing::internal::CaptureStdout();
  (void)cohesive_powder_kind().run(Scene::load(directory.file("tiny.toml")), options);
  (void)testing::internal::GetCapturedStdout();
  write_report(options.out);
  const std::string html = read_text(options.out + "/report.html");
  EXPECT_EQ(unbalanced_tags(html), "");
  for (const char* id : {"powder", "powder-course", "powder-forces", "powder-scattering", "powder-samples"})
    EXPECT_NE(html.find(std::string("<section id=\"") + id + "\""), std::string::npos) << id;
  for (const char* bad : {">nan", " nan", "\"nan", "inf "}) EXPECT_EQ(html.find(bad), std::string::npos) << bad;
  EXPECT_NE(html.find("not at rest"), std::string::npos);
}

}  // namespace
}  // namespace softgrain
