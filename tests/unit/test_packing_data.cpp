// States for the 3D view of a report: folding, ends of contacts, and what gives way when the page would grow too large.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/data/snapshot_io.h"
#include "common/io/text_file.h"
#include "pipelines/report/packing_data.h"
#include "pipelines/report/report.h"
#include "tests/support/temporary_directory.h"

namespace softgrain {
namespace {

std::string encoded(const std::string& text) {
  return report::base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

SnapshotParticle grain(double x, double y, double z, double r) {
  SnapshotParticle p;
  p.position = {{x, y, z}};
  p.radius = r;
  return p;
}

SnapshotContact contact(std::int32_t i, std::int32_t j, const Vec3& to, double force) {
  SnapshotContact c;
  c.i = i;
  c.j = j;
  c.to = to;
  c.normal_force = force;
  return c;
}

/// Two grains that touch through the side of a cell of length 1, two that touch inside it, and a wall.
Snapshot cell_state() {
  Snapshot s;
  s.kind = SnapshotKind::twin;
  s.series = "shelled-0";
  s.label = "shelled twin, sample 0, strain 0.1";
  s.strain = 0.1;
  s.has_contacts = true;
  s.particles = {grain(-0.1, 0.5, 0.5, 0.1), grain(0.75, 0.5, 0.5, 0.1), grain(0.3, 0.5, 0.5, 0.1),
                 grain(0.48, 0.5, 0.5, 0.1)};
  s.cell_edges = {Vec3{{1, 0, 0}}, Vec3{{0, 1, 0}}, Vec3{{0, 0, 1}}};
  s.periodic = {true, true, false};
  SnapshotWall wall;
  wall.normal = {{0, 0, 1}};
  s.walls = {wall};
  s.contacts = {contact(0, 1, {{-0.25, 0.5, 0.5}}, 1.0), contact(2, 3, {{0.48, 0.5, 0.5}}, 3.0),
                contact(3, 4, {{0.48, 0.5, 0.4}}, -2.0)};
  return s;
}

/// `states` states of `grains` grains with three contacts each, of forces 1, 2, 3 ...
report::PackingSeries large_series(std::size_t grains, std::size_t states) {
  Snapshot s;
  s.series = s.label = "large";
  s.has_contacts = true;
  for (std::size_t k = 0; k < grains; ++k) s.particles.push_back(grain(static_cast<double>(k), 0, 0, 0.5));
  for (std::size_t c = 0; c < 3 * grains; ++c) {
    const auto j = static_cast<std::int32_t>((c + 1) % grains);
    s.contacts.push_back(contact(static_cast<std::int32_t>(c % grains), j,
                                 s.particles[static_cast<std::size_t>(j)].position, static_cast<double>(c + 1)));
  }
  report::PackingSeries out;
  out.label = "large";
  out.states.assign(states, report::packing_state(s));
  return out;
}

TEST(PackingData, Base64OfKnownTexts) {
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encoded("\xff\xfe\xfd"), "//79");
}

TEST(PackingData, GrainsAreFoldedAndLinesGoWithThem) {
  const report::PackingState s = report::packing_state(cell_state());
  ASSERT_EQ(s.grains(), 4u);
  EXPECT_FLOAT_EQ(s.spheres[0], 0.9F);
  EXPECT_FLOAT_EQ(s.spheres[4], 0.75F);
  EXPECT_EQ(s.pairs, (std::vector<std::int32_t>{0, 1, 2, 3, 3, 4}));
  // the first ends at the folded centre of its neighbour, the last on the wall
  EXPECT_EQ(s.bent, (std::vector<std::int32_t>{2}));
  ASSERT_EQ(s.ends.size(), 3u);
  EXPECT_FLOAT_EQ(s.ends[2], 0.4F);
  EXPECT_TRUE(s.ids.size() == 4u);  // all zero: not as they are numbered
  EXPECT_TRUE(s.role.empty());
  ASSERT_EQ(s.cell.size(), 3u);
  EXPECT_EQ(s.cell[2], Vec3{});
  EXPECT_EQ(s.label, "strain = 0.1");
}

TEST(PackingData, AnImageAcrossTheCellKeepsItsOwnEnd) {
  Snapshot s = cell_state();
  s.particles[0].position[0] = 0.05;
  s.particles[1].position[0] = 0.92;
  s.contacts = {contact(0, 1, {{-0.08, 0.5, 0.5}}, 1.0)};
  const report::PackingState state = report::packing_state(s);
  EXPECT_EQ(state.bent, (std::vector<std::int32_t>{0}));
  EXPECT_FLOAT_EQ(state.ends[0], -0.08F);
}

TEST(PackingData, StatesGiveWayFirstThenWeakContactsThenSeries) {
  const std::size_t one = large_series(500, 1).bytes();
  std::vector<report::PackingSeries> series{large_series(500, 4)};
  EXPECT_TRUE(report::fit_into(series, 5 * one).empty());
  EXPECT_EQ(report::fit_into(series, 2 * one + one / 2).size(), 1u);
  EXPECT_EQ(series[0].states.size(), 2u);

  series = {large_series(500, 4)};
  const auto said = report::fit_into(series, one / 2);
  ASSERT_EQ(series.size(), 1u);
  const report::PackingState& state = series[0].states.at(0);
  EXPECT_LE(series[0].bytes(), one / 2);
  EXPECT_EQ(state.grains(), 500u);
  EXPECT_GT(state.contacts(), 50u);
  EXPECT_EQ(state.forces.back(), 1500.0F);
  EXPECT_EQ(state.forces.front(), 1501.0F - static_cast<float>(state.contacts()));
  EXPECT_EQ(said.size(), 2u);

  series = {large_series(500, 1), large_series(10, 1)};
  EXPECT_NE(report::fit_into(series, one / 10).back().find("500 grains are too many"), std::string::npos);
  ASSERT_EQ(series.size(), 1u);
  EXPECT_EQ(series[0].states.at(0).grains(), 10u);
}

/// A page that lacks contacts still says of every grain how many it has, and what they carry.
TEST(PackingData, WhereContactsAreLeftOutGrainsKnowTheirOwn) {
  std::vector<report::PackingSeries> series{large_series(500, 1)};
  const report::PackingState all = series[0].states[0];
  EXPECT_TRUE(all.touching.empty());
  report::fit_into(series, 2 * all.bytes() / 3);
  const report::PackingState& state = series[0].states.at(0);
  ASSERT_LT(state.contacts(), all.contacts());
  ASSERT_EQ(state.touching, std::vector<std::uint16_t>(500, 6));
  EXPECT_EQ(state.load[1], 1.0F + 2.0F + 501.0F + 502.0F + 1001.0F + 1002.0F);
  EXPECT_LE(series[0].bytes(), 2 * all.bytes() / 3);
  const std::size_t kept = state.contacts();
  EXPECT_GT(kept, 100u);
  // Of equal forces as many stay as there is room for.
  series[0].states[0] = all;
  for (float& force : series[0].states[0].forces) force = 1.0F;
  report::fit_into(series, 2 * all.bytes() / 3);
  EXPECT_EQ(series[0].states.at(0).contacts(), kept);
}

TEST(PackingData, NothingInItEndsTheScript) {
  report::PackingSeries s = large_series(3, 1);
  s.label = "</script><b>";
  const std::string text = report::packing_json({s});
  EXPECT_EQ(text.find('<'), std::string::npos);
  const auto back = nlohmann::json::parse(text);
  EXPECT_EQ(back["series"][0]["label"], "</script><b>");
  EXPECT_EQ(back["series"][0]["states"][0]["grains"], 3);
}

TEST(PackingData, StatesAreSpreadAndThoseWithoutContactsGiveWay) {
  const test::TemporaryDirectory directory;
  std::vector<Snapshot> states;
  for (int k = 0; k < 9; ++k) {
    states.push_back(cell_state());
    states.back().frame = k;
    states.back().strain = 0.01 * k;
    states.back().has_contacts = k % 2 == 0;
    if (k % 2 == 1) states.back().contacts.clear();
  }
  save_snapshots(states, directory.file("states_macro.h5"), build_provenance());
  const auto series = report::packing_series_of(directory.path(), 3);
  ASSERT_EQ(series.size(), 1u);
  EXPECT_EQ(series[0].label, "shelled twin, sample 0");
  ASSERT_EQ(series[0].states.size(), 3u);
  EXPECT_EQ(series[0].states.back().label, "strain = 0.08");
  for (const auto& state : series[0].states) EXPECT_EQ(state.contacts(), 3u);
}

TEST(PackingData, ThePageHoldsThePackingOrSaysWhyNot) {
  const test::TemporaryDirectory directory;
  save_snapshots({cell_state()}, directory.file("states_macro.h5"), build_provenance());
  write_text_atomic(directory.file("summary.json"), R"({"status": "good"})");
  write_report(directory.path());
  const std::string html = read_text(directory.file("report.html"));
  const bool installed = std::filesystem::exists("/usr/share/javascript/three/three.min.js");
  EXPECT_NE(html.find("id=\"packing\""), std::string::npos);
  EXPECT_EQ(html.find("id=\"packing-data\"") != std::string::npos, installed);
  EXPECT_EQ(html.find("three.js is not installed") != std::string::npos, !installed);
}

}  // namespace
}  // namespace softgrain
