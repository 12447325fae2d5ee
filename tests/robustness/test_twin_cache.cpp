// Resolved twins that are kept for later runs: the same bits, whatever law stands beside them.
#include <gtest/gtest.h>

#include <filesystem>

#include "common/data/macro_result.h"
#include "common/data/snapshot_io.h"
#include "common/io/text_file.h"
#include "macrosim/twin_places.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/unwrapped.h"

namespace softgrain {
namespace {

namespace fs = std::filesystem;
using test::run_the_program;
using test::TemporaryDirectory;

class TwinCache : public testing::Test {
 protected:
  void SetUp() override {
    write_text_atomic(directory_.file("scene.toml"), std::string(R"(kind = "macro"
law = ")") + SOFTGRAIN_SOURCE_DIR + R"(/results/law_table/law_table.toml"
contents = 2
seed = 1
[macro]
construction = "voids"
bodies = 8
soft_share = 0.25
soft_radius_max = "12 mm"
soft_polydispersity = 2.0
strain = 0.06
steps = 2
increments_per_step = 1
twin_relaxation = "damped"
tolerance = 0.1
)");
  }
  void run(const std::string& name, const std::string& more) const {
    const test::ProgramOutcome done =
        run_the_program("macrosim '" + directory_.file("scene.toml") + "' --quiet --threads 1 --out '" +
                        directory_.file(name) + "' " + more);
    ASSERT_EQ(done.status, 0) << done.output;
  }
  [[nodiscard]] MacroCurve twin(const std::string& name) const {
    for (const MacroCurve& c : load_macro(directory_.file(name) + "/macro.h5"))
      if (c.twin()) return c;
    ADD_FAILURE() << name << ": no twin";
    return {};
  }
  [[nodiscard]] std::int64_t kept() const {
    return std::distance(fs::directory_iterator(directory_.file("cache")), fs::directory_iterator());
  }

  TemporaryDirectory directory_;
};

TEST_F(TwinCache, ATwinThatIsKeptServesOtherLaws) {
  const std::string cache = "--twin-cache '" + directory_.file("cache") + "' ";
  run("isotropic", cache + "--set form=isotropic");
  EXPECT_EQ(kept(), 1);
  run("pair", cache + "--set form=pair");
  EXPECT_EQ(kept(), 1) << "the law is no part of the twin";
  run("alone", "--set form=pair");
  const MacroCurve taken = twin("pair");
  const MacroCurve anew = twin("alone");
  EXPECT_EQ(taken.cost.seconds, twin("isotropic").cost.seconds) << "run again";
  EXPECT_EQ(taken.cost.contact_evaluations, anew.cost.contact_evaluations);
  EXPECT_EQ(taken.stress_axial, anew.stress_axial);
  EXPECT_EQ(taken.places, anew.places);
  EXPECT_EQ(taken.more, anew.more) << "what the law says at the places of the twin";
  EXPECT_NE(taken.more, twin("isotropic").more);
  const auto states = [&](const std::string& name) {
    return read_snapshot_list(open_snapshots(directory_.file(name) + "/states_macro.h5"));
  };
  const auto pictures = states("pair");
  ASSERT_EQ(pictures.size(), states("alone").size());
  EXPECT_EQ(pictures.back().contacts.size(), states("alone").back().contacts.size()) << "of the twin";
  EXPECT_EQ(pictures.back().series, "shelled-0");
}

TEST_F(TwinCache, EverythingThatTheTwinHangsOnIsPartOfTheKey) {
  const std::string cache = "--twin-cache '" + directory_.file("cache") + "' ";
  run("first", cache);
  for (const char* change :
       {"--seed 2", "--set macro.strain=0.05", "--set macro.steps=1", "--set macro.increments_per_step=2",
        "--set macro.tolerance=0.2", "--set macro.wall_mu=0.1", "--set macro.test=isotropic",
        "--set macro.max_passes=30000", "--set macro.noise_samples=1", "--set macro.twin_relaxation=slow-dynamics",
        "--set output.snapshots=1"}) {
    const std::int64_t before = kept();
    run("other", cache + change);
    EXPECT_EQ(kept(), before + 1) << change;
  }
}

TEST_F(TwinCache, ADamagedFileIsRunAgain) {
  const std::string cache = "--twin-cache '" + directory_.file("cache") + "' ";
  run("first", cache);
  const fs::path file = fs::directory_iterator(directory_.file("cache"))->path();
  fs::resize_file(file, fs::file_size(file) / 2);
  run("second", cache);
  EXPECT_NE(test::log_of(directory_.file("second")).find("run again"), std::string::npos);
  EXPECT_EQ(twin("second").stress_axial, twin("first").stress_axial);
}

}  // namespace
}  // namespace softgrain
