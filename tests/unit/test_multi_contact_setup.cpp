// Scenes of kind law-table: what is read, what is refused, where states are recorded, what names a kept run.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "common/core/error.h"
#include "common/io/text_file.h"
#include "pipelines/kinds/law_table/multi_contact_scene.h"
#include "pipelines/kinds/law_table/multi_contact_stage.h"
#include "tests/support/multi_contact.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/tiny_law_table.h"

namespace softgrain {
namespace {

using test::kTinyLawTable;

MultiContactSetup read_multi_contact(const std::string& text) {
  const Scene scene = Scene::parse(text, "scene.toml");
  (void)scene.root().text("kind");
  (void)scene.root().text("title");
  const MultiContactSetup setup = read_multi_contact_setup(scene.root());
  scene.root().finish();
  return setup;
}

/// Replaces the first `from` of the good scene.
std::string with(const std::string& from, const std::string& to) {
  std::string text = kTinyLawTable;
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

void expect_refused(const std::string& from, const std::string& to, const std::vector<std::string>& words) {
  try {
    (void)read_multi_contact(with(from, to));
    ADD_FAILURE() << to << " was accepted";
  } catch (const InputError& e) {
    for (const std::string& word : words)
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << word << " not in: " << e.what();
  }
}

TEST(MultiContactSetup, ReadsConfigurations) {
  const MultiContactSetup setup = read_multi_contact(kTinyLawTable);
  ASSERT_EQ(setup.configurations.size(), 3U);
  EXPECT_EQ(setup.configurations[0].name, "one-plane");
  EXPECT_EQ(setup.configurations[1].name, "opposite-plane-unload");
  EXPECT_EQ(setup.configurations[2].name, "one-soft-1");
  EXPECT_TRUE(setup.configurations[2].held_out);
  const auto& stages = setup.configurations[1].stages;
  ASSERT_EQ(stages.size(), 3U);
  EXPECT_EQ(stages[1].move, MultiContactMove::unload);
  EXPECT_EQ(stages[1].overlap, (std::vector<double>{0.0, 0.0}));
  EXPECT_EQ(stages[2].move, MultiContactMove::reload);
  EXPECT_EQ(stages[2].overlap, (std::vector<double>{0.2, 0.2}));
}

TEST(MultiContactSetup, PackingsOfOneConfiguration) {
  const MultiContactSetup setup = read_multi_contact(with("overlap = 0.3\n", "overlap = 0.3\npackings = 7\n"));
  EXPECT_EQ(setup.least_packings(setup.configurations[0]), 7);
  EXPECT_EQ(setup.most_packings(setup.configurations[0]), 7);
  EXPECT_EQ(setup.least_packings(setup.configurations[1]), 2);
  EXPECT_EQ(setup.most_packings(setup.configurations[1]), 3);
  EXPECT_EQ(setup.pool(), 7);
  expect_refused("overlap = 0.3\n", "overlap = 0.3\npackings = 1\n", {"packings", "2"});
}

TEST(MultiContactSetup, PathsAndDepths) {
  const MultiContactSetup s = read_multi_contact(with("path = \"unload\"", "path = \"sequential\""));
  ASSERT_EQ(s.configurations[1].stages.size(), 2U);
  EXPECT_EQ(s.configurations[1].stages[0].overlap, (std::vector<double>{0.2, 0.0}));
  EXPECT_EQ(s.configurations[1].stages[1].overlap, (std::vector<double>{0.2, 0.2}));
  const MultiContactSetup b =
      read_multi_contact(with("arrangement = \"one\"", "arrangement = \"beside-five\"\nshallow = 0.25"));
  EXPECT_EQ(b.configurations[0].stages[0].overlap, (std::vector<double>{0.075, 0.3, 0.3, 0.3, 0.3, 0.3}));
  const MultiContactSetup f =
      read_multi_contact(with("path = \"unload\"", "path = \"slide\"\nslide = 0.05\ncentre = \"free\""));
  EXPECT_EQ(f.configurations[1].stages[1].slide, 0.05);
  EXPECT_TRUE(f.configurations[1].centre_free);
  EXPECT_EQ(f.configurations[1].name, "opposite-plane-slide-free");
}

TEST(MultiContactSetup, PlanesAroundSoftNeighboursPressFromTheSidesWhereTheCentreIsNot) {
  const std::string opposite = "arrangement = \"opposite\"\npartner = \"plane\"";
  const std::string soft =
      "arrangement = \"opposite\"\npartner = \"soft\"\nratio = 2.0\npressed = 0.1\ncentre = \"free\"";
  const MultiContactConfiguration c = read_multi_contact(with(opposite, soft)).configurations[1];
  EXPECT_EQ(c.name, "opposite-soft-2-unload-free-pressed");
  ASSERT_EQ(c.partners.size(), 12U);
  EXPECT_EQ(c.touching(), 2U);
  EXPECT_TRUE(c.pressed(0) && c.pressed(1) && !c.pressed(2));
  for (std::size_t k = 0; k < 2; ++k) {
    Vec3 all = -c.partners[k].direction;
    for (std::size_t n = 2 + 5 * k; n < 7 + 5 * k; ++n) {
      EXPECT_EQ(c.partners[n].kind, PartnerKind::plane);
      EXPECT_EQ(c.partners[n].on, static_cast<std::int32_t>(k));
      EXPECT_GE(dot(c.partners[n].direction, c.partners[k].direction), -1e-12) << "on the side of the centre";
      EXPECT_EQ(c.stages[0].overlap[n], 0.2) << "over Rs of the centre";
      EXPECT_EQ(c.stages[1].overlap[n], 0.0);
      all += c.partners[n].direction;
    }
    EXPECT_LT(norm(all), 1e-12) << "with the centre they come from all sides";
  }
  expect_refused("overlap = 0.3", "overlap = 0.3\npressed = 0.1\ncentre = \"free\"",
                 {"pressed", "no neighbour is soft"});
  expect_refused("ratio = 1.0", "ratio = 1.0\npressed = 0.1", {"pressed", "centre = \"free\""});
  expect_refused("ratio = 1.0", "ratio = 1.0\npressed = 0.1\ncentre = \"free\"\npath = \"slide\"",
                 {"pressed", "leave it out"});
  expect_refused("ratio = 1.0", "ratio = 1.0\npressed = 1.0\ncentre = \"free\"", {"pressed", "below 1"});
}

TEST(MultiContactSetup, AShearPressesAlongTheFirstNeighbourAndLetsOffAcrossIt) {
  const MultiContactSetup s =
      read_multi_contact(with("arrangement = \"one\"", "arrangement = \"cube\"\npath = \"shear\"\nshear = 0.5"));
  const std::vector<MultiContactStage>& stages = s.configurations[0].stages;
  ASSERT_EQ(stages.size(), 2U);
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_EQ(stages[k / 6].move, MultiContactMove::load);
    EXPECT_DOUBLE_EQ(stages[0].overlap[k], 0.2);
    EXPECT_DOUBLE_EQ(stages[1].overlap[k], k < 2 ? 0.3 : 0.15);
  }
  EXPECT_EQ(s.configurations[0].name, "cube-plane-shear");
  expect_refused("overlap = 0.3", "overlap = 0.3\nshear = 0.5", {"scene.toml:19", "path = \"shear\""});
  expect_refused("overlap = 0.3", "overlap = 0.3\npath = \"shear\"\nshear = 1.5", {"scene.toml:20", "at most 1"});
}

TEST(MultiContactSetup, RefusesWhatMakesNoSense) {
  expect_refused("\"opposite\"", "\"oposite\"", {"scene.toml:20", "arrangement", "opposite"});
  expect_refused("partner = \"plane\"", "partner = \"wall\"", {"scene.toml:17", "partner"});
  expect_refused("overlap = 0.3", "overlap = 0.0", {"scene.toml:18", "overlap", "above 0"});
  expect_refused("overlap = 0.3", "overlap = 1.0", {"scene.toml:18", "overlap", "below 1"});
  expect_refused("overlap = 0.3", "", {"overlap"});
  expect_refused("overlap = 0.3", "overlap = 0.3\nratio = 1.0", {"scene.toml:19", "a plane has no radius"});
  expect_refused("overlap = 0.3", "overlap = 0.3\nslide = 0.1", {"scene.toml:19", "slide"});
  expect_refused("overlap = 0.3", "overlap = 0.3\nshallow = 0.1", {"scene.toml:19", "beside-five"});
  expect_refused("ratio = 1.0", "ratio = 0.0", {"scene.toml:27", "ratio", "above 0"});
  expect_refused("ratio = 1.0", "ratio = 0.4", {"overlap", "below the ratio"});
  expect_refused("path = \"unload\"", "path = \"sideways\"", {"scene.toml:23", "path"});
  expect_refused("path = \"unload\"", "name = \"one-plane\"", {"scene.toml:23", "already"});
  expect_refused("path = \"unload\"", "pathh = \"unload\"", {"scene.toml:23", "'path'"});
  expect_refused("packings_max = 3", "packings_max = 1", {"scene.toml:12", "packings_max"});
  expect_refused("packings_min = 2", "packings_min = 4", {"scene.toml:12", "packings_max", "at least packings_min"});
  expect_refused("target = 0.2", "target = 0.0", {"scene.toml:13", "target", "above 0"});
  expect_refused("arrangement = \"opposite\"\npartner = \"plane\"", "arrangement = \"cube\"\npartner = \"soft\"",
                 {"scene.toml:21", "6 soft neighbours", "packings_max", "7"});
}

TEST(MultiContactPlan, LoadingIsDenseAroundTheOnset) {
  const MultiContactConfiguration c = test::multi_contact_of(PartnerKind::plane, 0.0, {Vec3{{1.0, 0.0, 0.0}}}, 0.3);
  const MultiContactPlan plan = recording_plan(c, {0.25}, 12, 0.005);
  ASSERT_EQ(plan.size(), 1U);
  ASSERT_EQ(plan[0].size(), 12U);
  EXPECT_EQ(plan[0].back(), 1.0);
  int near = 0;
  for (std::size_t k = 0; k < plan[0].size(); ++k) {
    EXPECT_GE(plan[0][k] - (k > 0 ? plan[0][k - 1] : 0.0), 0.005 / 0.3 * (1.0 - 1e-9));
    if (plan[0][k] >= 0.125 && plan[0][k] <= 0.375 + 1e-12) ++near;
  }
  EXPECT_EQ(near, 6);
  // Points closer than the increment are dropped, never the end.
  EXPECT_EQ(recording_plan(c, {1.0}, 4, 0.2)[0], std::vector<double>{1.0});
}

TEST(MultiContactPlan, TheOnsetIsWhereTheMeanForceRises) {
  const MultiContactConfiguration c = test::multi_contact_of(PartnerKind::plane, 0.0, {Vec3{{1.0, 0.0, 0.0}}}, 0.3);
  MultiContactRun run;
  const MultiContactPlan coarse = coarse_plan(c);
  for (const double s : coarse[0]) {
    MultiContactPoint p;
    p.overlap = {0.3 * s};
    p.normal = {s > 0.3 ? (s - 0.3) : 0.0};
    p.tangential = {{}};
    run.points.push_back(p);
  }
  EXPECT_EQ(onset_shares(c, {run, run}), (std::vector<double>{5.0 / 16.0}));
  for (MultiContactPoint& p : run.points) p.normal = {0.0};
  EXPECT_EQ(onset_shares(c, {run}), (std::vector<double>{1.0}));
}

MultiContactRun sample_run() {
  MultiContactRun run;
  MultiContactPoint p;
  p.overlap = {0.1};
  p.normal = {1.0 / 3.0};
  p.tangential = {{{1e-5, 0.0, 2.0}}};
  run.points = {p, p};
  run.cost = {1, 2, 0.5};
  return run;
}

TEST(SharedResults, ARunIsFoundByWhatDeterminesIt) {
  const MultiContactConfiguration c = test::multi_contact_of(PartnerKind::plane, 0.0, {Vec3{{1.0, 0.0, 0.0}}}, 0.3);
  const MultiContactPlan plan{{0.5, 1.0}};
  const std::string key = multi_contact_run_key({}, c, plan, {}, "seed 1 packings 0");
  MultiContactConfiguration renamed = c;
  renamed.name = "other";
  renamed.held_out = true;
  EXPECT_EQ(multi_contact_run_key({}, renamed, plan, {}, "seed 1 packings 0"), key);
  EXPECT_NE(multi_contact_run_key({}, c, plan, {}, "seed 1 packings 1"), key);
  EXPECT_NE(multi_contact_run_key({}, c, {{0.4, 1.0}}, {}, "seed 1 packings 0"), key);
  MultiContactOptions finer;
  finer.increment = 0.004;
  EXPECT_NE(multi_contact_run_key({}, c, plan, finer, "seed 1 packings 0"), key);
  SoftParticleSpec rough;
  rough.friction = 0.4;
  EXPECT_NE(multi_contact_run_key(rough, c, plan, {}, "seed 1 packings 0"), key);
  MultiContactConfiguration free = c;
  free.centre_free = true;
  EXPECT_NE(multi_contact_run_key({}, free, plan, {}, "seed 1 packings 0"), key);
  EXPECT_EQ(multi_contact_run_name(""), "crowd-cbf29ce484222325");
  EXPECT_EQ(multi_contact_run_name("a"), "crowd-af63dc4c8601ec8c");  // published values of FNV-1a
}

TEST(SharedResults, SaysWhichFileItIgnores) {
  const test::TemporaryDirectory directory;
  std::string remarks;
  const SharedResults cache(directory.path(), [&](const std::string& remark) { remarks += remark; });
  KeptForm<MultiContactRun> two = kept_multi_contact_run();
  two.write = [](const h5::Group& group, const MultiContactRun& run) { write_multi_contact_runs(group, {run, run}); };
  cache.keep(two, "key", sample_run());
  EXPECT_FALSE(cache.find(kept_multi_contact_run(), "key"));
  EXPECT_NE(remarks.find(directory.file(multi_contact_run_name("key") + ".h5") + ": damaged: holds no single run"),
            std::string::npos)
      << remarks;
}

TEST(SharedResults, KeepsAndIgnoresDamage) {
  const test::TemporaryDirectory directory;
  std::string remarks;
  const SharedResults cache(directory.path(), [&](const std::string& remark) { remarks += remark + "\n"; });
  const KeptForm<MultiContactRun>& form = kept_multi_contact_run();
  EXPECT_FALSE(cache.find(form, "key"));
  cache.keep(form, "key", sample_run());
  const auto found = cache.find(form, "key");
  ASSERT_TRUE(found);
  test::expect_equal(found->points, sample_run().points);
  EXPECT_EQ(remarks, "");
  const std::string file = directory.file(multi_contact_run_name("key") + ".h5");
  std::filesystem::copy_file(file, directory.file(multi_contact_run_name("other") + ".h5"));
  EXPECT_FALSE(cache.find(form, "other"));
  EXPECT_NE(remarks.find("another result"), std::string::npos) << remarks;
  remarks.clear();
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  EXPECT_FALSE(cache.find(form, "key"));
  EXPECT_NE(remarks.find("measured again"), std::string::npos) << remarks;
  cache.keep(form, "key", sample_run());
  EXPECT_TRUE(cache.find(form, "key"));
  EXPECT_FALSE(SharedResults("", [](const std::string&) {}).find(form, "key"));
}

/// A folder under the name of a result was met when the result was there and could not be kept, and a pipe was waited
/// for.
TEST(SharedResults, WhatIsNoFileIsRefusedAtOnce) {
  const test::TemporaryDirectory directory;
  const SharedResults cache(directory.path(), [](const std::string&) {});
  const KeptForm<MultiContactRun>& form = kept_multi_contact_run();
  const std::string file = directory.file(multi_contact_run_name("key") + ".h5");
  std::filesystem::create_directory(file);
  EXPECT_THROW((void)cache.find(form, "key"), IoError);
  std::filesystem::remove(file);
  ASSERT_EQ(::mkfifo(file.c_str(), 0600), 0);
  EXPECT_THROW((void)cache.find(form, "key"), IoError);
  std::filesystem::remove(file);
  std::filesystem::create_symlink(std::filesystem::path(file).filename(), file);  // to itself
  EXPECT_FALSE(cache.find(form, "key"));
  cache.keep(form, "key", sample_run());
  EXPECT_TRUE(cache.find(form, "key"));
}

}  // namespace
}  // namespace softgrain
