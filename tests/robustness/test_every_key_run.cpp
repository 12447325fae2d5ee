// Every key of every kind, in every place where it may stand: with another value the run is refused, or its results are
// others (summary, tables and HDF5 files without times and provenance). The same as EveryKey in tests/unit, which looks
// at what is read, seen from outside.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <set>
#include <thread>

#include "tests/support/changed_keys.h"
#include "tests/support/keyed_scenes.h"
#include "tests/support/program.h"
#include "tests/support/run_comparison.h"
#include "tests/support/what_is_run.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
namespace fs = std::filesystem;

const std::string kNarrow =
    "radii are too alike for a grain to bear more than the mean: MacroPreparation has a wide span";

/// Keys whose effect results cannot show, and where it is seen.
const std::map<std::string, std::string> kNotInResults{
    {"kind", "another kind is another scene, with keys of its own"},
    {"checkpoint.every_steps", "when a state is kept on the way: tests of restarts"},
    {"checkpoint.every_seconds", "when a state is kept on the way: tests of restarts"},
    {"time.warm_up_steps", "steps that the measured pace leaves out: a time"},
    {"recipe levels.ratio", "decides how many levels there are: here two at every ratio that is allowed"},
    {"recipe-stages levels.ratio", "decides how many levels there are: here two at every ratio that is allowed"},
    {"recipe-constituents shells.levels", "a bound: its grains span less than two decades"},
    {"recipe-constituents shells.ratio", "a bound: its grains span less than a decade"},
    {"disks material.powder.E",
     "describes the material; a remark says that no contact of it has a law that goes by it"},
    {"disks material.powder.nu",
     "describes the material; a remark says that no contact of it has a law that goes by it"},
    {"disks material.powder.rigid",
     "describes the material; a remark says that no contact of it has a law that goes by it"},
    {"pipeline macro.kt", "its scene measures the initial slope alone, which stands in for the secant"},
    {"macro-comparison macro.soft_polydispersity", "holes that small are not needed here to reach soft_share"},
    {"macro-comparison scene.0.soft_polydispersity", "holes that small are not needed here to reach soft_share"},
    {"law-table calibrate.min_packings", "a bound: a value above the number of packings is refused"},
    {"comparison-packing packing.shell_radius", "sizes are those of the file, and what is inside scales with them"},
    {"particles guards.escape.high", "a bound: nothing comes near it here"},
    {"particles-drawn guards.escape.high", "a bound: nothing comes near it here"},
    {"particles-drawn guards.escape.low", "a bound: nothing comes near it here"},
    {"particles-drawn contact.0.beyond", "a bound: the contact stays within the law"},
    {"particles-drawn contact.1.tangential", "its stones slide from the beginning: no spring is loaded as they part"},
    {"particles-drawn output.every", "longer than the run"},
    {"pipeline-crowd calibrate.multi_contact.min_packings", "a bound: there are more"},
    {"pipeline-crowd calibrate.multi_contact.largest_error", "a bound: errors are smaller"},
    {"powder assembly.settle_kinetic", "a bound: here the net forces meet theirs last"},
    {"powder-variants assembly.settle_kinetic", "a bound: here the net forces meet theirs last"},
    {"powder-variants variant.0.assembly.settle_kinetic", "a bound: here the net forces meet theirs last"},
    {"powder-variants variant.1.assembly.settle_kinetic", "a bound: here the net forces meet theirs last"},
    {"material-loadings equation.replicates", "its points are too few for a fit"},
    {"material-loadings equation.onset.0.span", "its points are too few for a fit"},
    {"material-loadings equation.onset.0.value", "its points are too few for a fit"},
    {"material-loadings equation.onset.0.standard_error", "its points are too few for a fit"},
    {"material-constituents equation.replicates", "its points are too few for a fit"},
    {"recipe-stages check.samples", "it has no check: grains = 0"},
    {"macro-table range", "a bound: no contact leaves the range of the law"},
    {"macro-table rolling", "its table has no rolling resistance"},
    {"material packing.balance", kNarrow},
    {"material-variants packing.balance", kNarrow},
    {"material-variants variant.0.balance", kNarrow},
    {"material-law packing.balance", kNarrow},
    {"material-law-memory packing.balance", kNarrow},
    {"recipe packing.balance", kNarrow},
    {"comparison-packing macro.balance", kNarrow},
    {"comparison-packing scene.0.balance", kNarrow},
    {"macro-cells macro.balance", kNarrow},
    {"macro-table macro.balance", kNarrow},
    {"models model.0.variants", "there is one variant"},
    {"models model.1.variants", "there is one variant"},
    {"models model.2.variants", "there is one variant"},
    {"models model.3.variants", "there is one variant"},
    {"disks contact.1.pair", "its order does not matter, and without one of the two a contact has no law"},
    {"particles-drawn contact.0.pair", "its order does not matter, and without one of the two a contact has no law"},
    {"particles-drawn particle.0.inside", "there is no sphere that they could be inside: \"none\" is all it takes"},
    {"particles-drawn particle.1.inside", "there is no sphere that they could be inside: \"none\" is all it takes"},
    {"particles-drawn particle.2.inside", "there is no sphere that they could be inside: \"none\" is all it takes"},
};

/// Bounds that only a run which meets them shows, by the end of the path; EveryKey sees that they are taken.
const std::set<std::string> kBounds{
    "max_passes", "preparation_passes", "max_iterations", "max_increments", "max_halvings",     "growth_passes",
    "time_max",   "increment_passes",   "sub_increments", "refresh",        "tolerance_between"};

/// Tables of which nothing comes in a scene, by the beginning of their keys.
const std::map<std::string, std::string> kNotReached{
    {"pipeline-crowd macro.", "its law is not usable, so no macro run follows; the scene pipeline has one"},
    {"recipe-materials macro.",
     "its mixtures determine no cell law, which level 1 is loaded with; the scene recipe has one"}};

bool is_reached(const std::string& of) {
  return std::none_of(kNotReached.begin(), kNotReached.end(),
                      [&](const auto& one) { return of.starts_with(one.first); });
}

bool is_bound(const std::string& path) { return kBounds.contains(path.substr(path.rfind('.') + 1)); }

class SlowEveryKey : public ::testing::TestWithParam<KindScene> {
 protected:
  static constexpr int kBroken = 2;
  static constexpr int kTimeout = 124;

  SlowEveryKey() {
    write_keyed_files(directory_);
    write_text_atomic(directory_.file("scene.toml"), GetParam().text);
  }
  [[nodiscard]] KeyedText scene() const { return {GetParam().text, directory_.file("scene.toml")}; }
  [[nodiscard]] std::string out(const std::string& name) const { return directory_.file(name); }

  [[nodiscard]] int run(const std::string& name, const std::string& change = "") const {
    const std::string line = "timeout 120 '" + std::string(SOFTGRAIN_PROGRAM) + "' " + GetParam().command + " '" +
                             directory_.file("scene.toml") + "' --quiet --threads 1 --out '" + out(name) + "' " +
                             (change.empty() ? "" : "--set '" + change + "' ") + ">/dev/null 2>&1 </dev/null";
    const int status = std::system(line.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  TemporaryDirectory directory_;
};

struct RunTally {
  std::size_t refused = 0;
  std::vector<std::string> too_long{};
  std::vector<std::string> without_effect{};
};

TEST_P(SlowEveryKey, ChangesResultsOrIsRefused) {
  const int base = run("base");
  ASSERT_TRUE(base == 0 || base == 3) << base;
  const Keys keys = asked_keys(scene(), [](const Scene& s) { (void)what_is_run(s); });
  const std::set<std::string> texts = texts_of(keys);
  std::vector<std::pair<std::string, AskedKey>> all;
  for (const auto& [path, key] : keys)
    if (!kNotInResults.contains(path) && !kNotInResults.contains(GetParam().name + " " + path) && !is_bound(path) &&
        is_reached(GetParam().name + " " + path) && stands_for_all(path, keys) && !given_in_a_part(path, keys) &&
        !other_values(key, texts).empty())
      all.emplace_back(path, key);
  RunTally tally;
  std::mutex guard;
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t k = next++; k < all.size(); k = next++) {
      const auto& [path, key] = all[k];
      const std::string name = "changed-" + std::to_string(k);
      // Of words that were not there it is not known which one they stand for; a limit shows once it is reached.
      constexpr std::size_t kTries = 10;
      const bool words = key.form == KeyForm::choice || key.form == KeyForm::flag;
      const std::size_t may_be_default = words && key.texts.empty() && key.numbers.empty() ? 1 : 0;
      std::vector<std::string> same;
      bool other = false;
      bool slow = false;
      for (const std::string& value : other_values(key, texts)) {
        if (means_the_same(path, value)) continue;
        const int status = run(name, path + "=" + value);
        if (status == kBroken) continue;
        slow = slow || status == kTimeout;
        other = other || status == kTimeout || status != base || !run_differences(out("base"), out(name)).empty();
        if (!other) same.push_back(value);
        fs::remove_all(out(name));
        if (other || same.size() == kTries) break;
      }
      const std::lock_guard lock(guard);
      if (slow) tally.too_long.push_back(path);
      if (!other && same.empty()) ++tally.refused;
      if (!other && same.size() > may_be_default) tally.without_effect.push_back(path + " = " + same.front());
    }
  };
  std::vector<std::thread> workers;
  for (unsigned k = 0; k < std::max(1U, std::thread::hardware_concurrency()); ++k) workers.emplace_back(work);
  for (std::thread& w : workers) w.join();
  std::printf("%s: %zu keys and places, %zu refused with every value, %zu stopped after two minutes\n",
              GetParam().name.c_str(), all.size(), tally.refused, tally.too_long.size());
  std::string idle;
  for (const std::string& w : tally.without_effect) idle += "  " + w + "\n";
  EXPECT_TRUE(idle.empty()) << "taken without effect on results:\n" << idle;
}

INSTANTIATE_TEST_SUITE_P(Kinds, SlowEveryKey, ::testing::ValuesIn(keyed_scenes()), name_of_kind);

}  // namespace
