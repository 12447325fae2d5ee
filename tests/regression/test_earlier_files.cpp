// Files that earlier versions wrote stay readable and say the same numbers: tests/reference/earlier has run directories
// of the tiny scene of several kinds, and in numbers.json what `softgrain compare` of the version that wrote them said.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/data/cell_card.h"
#include "common/data/law_card.h"
#include "common/data/multi_contact_law.h"
#include "common/io/text_file.h"
#include "pipelines/snapshots/snapshots.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"

namespace softgrain::test {
namespace {

namespace fs = std::filesystem;

std::string earlier(const std::string& file) { return std::string(SOFTGRAIN_REFERENCE_DIR) + "/earlier/" + file; }

std::vector<std::string> earlier_runs() {
  std::vector<std::string> out;
  for (const auto& version : fs::directory_iterator(earlier("")))
    for (const auto& run : fs::directory_iterator(version.path())) out.push_back(run.path().string());
  std::sort(out.begin(), out.end());
  return out;
}

class EarlierFiles : public testing::TestWithParam<std::string> {
 protected:
  /// A copy that reports may be written into.
  EarlierFiles() { fs::copy(GetParam(), run(), fs::copy_options::recursive); }
  [[nodiscard]] std::string run() const { return directory_.file("run"); }
  [[nodiscard]] std::string file(const std::string& name) const { return directory_.file(name); }

 private:
  TemporaryDirectory directory_;
};

TEST_P(EarlierFiles, SayTheSameNumbers) {
  const ProgramOutcome outcome =
      run_the_program("compare '" + run() + "' '" + run() + "' --json --quiet --out '" + file("comparison") + "'");
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  const auto said = nlohmann::json::parse(outcome.output.substr(outcome.output.find('{')));
  const auto numbers = nlohmann::json::parse(read_text(run() + "/numbers.json"));
  EXPECT_GE(numbers.size(), 3u);
  for (const auto& [place, number] : numbers.items()) {
    const nlohmann::json::json_pointer at(place);
    ASSERT_TRUE(said.contains(at)) << place;
    EXPECT_NEAR(said[at].get<double>(), number.get<double>(), 1e-12 * std::abs(number.get<double>())) << place;
  }
}

TEST_P(EarlierFiles, AreCheckedAndReported) {
  const ProgramOutcome reported = run_the_program("report '" + run() + "'");
  EXPECT_EQ(reported.status, 0) << reported.output;
  EXPECT_NE(read_text(run() + "/report.html").find("<svg"), std::string::npos);
  for (const auto& entry : fs::directory_iterator(GetParam())) {
    const std::string kind = entry.path().extension();
    if (kind != ".h5" && kind != ".toml") continue;
    const ProgramOutcome checked = run_the_program("check '" + entry.path().string() + "'");
    EXPECT_EQ(checked.status, 0) << entry.path() << checked.output;
  }
}

INSTANTIATE_TEST_SUITE_P(Runs, EarlierFiles, testing::ValuesIn(earlier_runs()), [](const auto& named) {
  const fs::path run = named.param;
  std::string name = run.parent_path().filename().string() + "_" + run.filename().string();
  for (char& c : name)
    if (c == '-') c = '_';
  return name;
});

/// What `export` of the version before the snapshots of powders became a trajectory said: states, particles in all of
/// them, the sum of their coordinates, and contacts.
TEST(EarlierStates, AreTheSame) {
  struct Known {
    const char* run;
    std::size_t states, particles;
    double coordinates;
    std::size_t contacts;
  };
  for (const Known& known : {Known{"before_frames/powder", 17, 1020, 8418.029410925485, 200},
                             Known{"before_names/powder", 18, 1080, 8957.620213266815, 197},
                             Known{"before_names/disks", 21, 756, -1186.4579558359471, 915},
                             Known{"before_0_3/particles", 5, 60, -3.3859919191369374, 19}}) {
    std::size_t particles = 0;
    std::size_t contacts = 0;
    double coordinates = 0.0;
    const std::vector<Snapshot> states = read_snapshots(earlier(known.run));
    for (const Snapshot& s : states) {
      particles += s.particles.size();
      contacts += s.contacts.size();
      for (const SnapshotParticle& p : s.particles) coordinates += p.position[0] + p.position[1] + p.position[2];
    }
    EXPECT_EQ(states.size(), known.states) << known.run;
    EXPECT_EQ(particles, known.particles) << known.run;
    EXPECT_NEAR(coordinates, known.coordinates, 1e-9 * std::abs(known.coordinates)) << known.run;
    EXPECT_EQ(contacts, known.contacts) << known.run;
  }
}

/// A file that two sections read in two forms: of a box that is not periodic there are energies, no stresses.
TEST(EarlierStates, EnergiesAreNotDrawnAsStresses) {
  const TemporaryDirectory directory;
  fs::copy(earlier("before_0_3/particles"), directory.file("run"), fs::copy_options::recursive);
  ASSERT_EQ(run_the_program("report '" + directory.file("run") + "'").status, 0);
  const std::string report = read_text(directory.file("run") + "/report.html");
  EXPECT_NE(report.find("Energy over time"), std::string::npos);
  EXPECT_EQ(report.find("Stress over time"), std::string::npos);
}

/// Numbers as they stand in the files; of "bag" the word as well.
TEST(EarlierCards, LawTablesOfBothVocabularies) {
  const LawTable old = load_law_table(earlier("before_names/law-table/law_table.toml"));
  ASSERT_EQ(old.entries.size(), 1u);
  EXPECT_EQ(old.entries[0].solid_fraction, 0.5607917924457946);
  EXPECT_EQ(old.entries[0].packings, 3);
  EXPECT_EQ(old.entries[0].best, LawForm::isotropic);
  EXPECT_EQ(old.entries[0].unloading.value, 1.5);
  EXPECT_EQ(old.entries[0].grains, 0.0) << "it did not say so";

  const LawTable later = load_law_table(earlier("before_0_3/hierarchy/law_table.toml"));
  ASSERT_EQ(later.entries.size(), 1u);
  EXPECT_EQ(later.entries[0].solid_fraction, 0.33241400476177474);
  EXPECT_EQ(later.entries[0].best, LawForm::pair);
  EXPECT_EQ(later.entries[0].unloading.value, 1.0);
  EXPECT_FALSE(later.entries[0].unloading_measured);
  EXPECT_EQ(later.entries[0].grains, 187.0);
}

TEST(EarlierCards, CellLawsWithoutAndWithCorrelations) {
  const CellCard old = read_cell_card(earlier("before_names/recipe/cell_law.toml"));
  EXPECT_EQ(old.form, StateForm::porosity);
  EXPECT_EQ(old.modulus.value, 0.4840006638483921);
  EXPECT_EQ(old.modulus.low, 0.009104176243138265);
  EXPECT_EQ(old.exponent.value, 3.371993614958187);
  EXPECT_FALSE(old.memory.has_value());
  EXPECT_TRUE(old.correlation.numbers.empty());

  const CellCard later = read_cell_card(earlier("before_0_3/recipe/cell_law.toml"));
  EXPECT_EQ(later.modulus.value, old.modulus.value);
  ASSERT_EQ(later.correlation.numbers.size(), 8u);
  EXPECT_EQ(later.correlation.numbers[5], "xi");
  ASSERT_EQ(later.correlation.matrix.size(), 64u);
  EXPECT_EQ(later.correlation.matrix[1], 0.928810806006253);
}

TEST(EarlierCards, LawCards) {
  const LawCard card = load_card(earlier("before_names/pipeline/law.toml"));
  ASSERT_EQ(card.pairs.size(), 2u);
  EXPECT_EQ(card.pairs[0].kind, PairKind::soft_solid);
  EXPECT_EQ(card.pairs[0].status, LawStatus::underdetermined);
  EXPECT_EQ(card.pairs[0].packings, 4);
  EXPECT_EQ(card.pairs[0].points, 36);
  EXPECT_EQ(card.pairs[0].chi2_per_dof, 0.061442763464047916);
}

}  // namespace
}  // namespace softgrain::test
