// softgrain law on the committed laws: the text for people to the letter, and the program from outside.
// After a change that is meant: LC_ALL=C softgrain law show results/published/law.toml > tests/reference/law/card.txt,
// from the root of the tree; likewise table.txt (results/law_table/law_table.toml) and difference.txt (both).
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/data/multi_contact_replicates.h"
#include "common/io/text_file.h"
#include "pipelines/law/fitted_law.h"
#include "pipelines/law/law_difference.h"
#include "pipelines/law/named_laws.h"
#include "pipelines/law/terminal_plot.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"

namespace softgrain {
namespace {

using test::run_the_program;

const std::string kRoot = SOFTGRAIN_SOURCE_DIR;
const std::string kCard = "results/published/law.toml";
const std::string kTable = "results/law_table/law_table.toml";

FittedLaw committed(const std::string& path) {
  FittedLaw file = load_law(kRoot + "/" + path);
  read_refits(file);
  file.path = path;
  return file;
}

std::string reference(const std::string& name) {
  return read_text(std::string(SOFTGRAIN_REFERENCE_DIR) + "/law/" + name);
}

void expect_narrow(const std::string& text) {
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) EXPECT_LE(law::columns_of(line), 80u) << line;
}

TEST(LawCommand, ShowsTheCommittedLawsAsBefore) {
  EXPECT_EQ(law::law_text(committed(kCard), false), reference("card.txt"));
  EXPECT_EQ(law::law_text(committed(kTable), false), reference("table.txt"));
  const FittedLaw a = committed(kCard);
  const FittedLaw b = committed(kTable);
  EXPECT_EQ(law::differences_text(a, b, law::law_differences(a, b), false), reference("difference.txt"));
}

/// An answer from the library does not take the place of the table of own packings that corrects it.
TEST(LawCommand, GetLeavesWhatItIsMadeFromAlone) {
  const test::TemporaryDirectory directory;
  const std::string own = directory.file("law_table.toml");
  const std::string text = read_text(kRoot + "/" + kTable);
  write_text_atomic(own, text);
  const std::string material = "law get --mu 0.3 --exponent 3.5 --ratio 10 --solid-fraction 0.7 ";
  for (const std::string& named : {own, std::filesystem::path(own).parent_path().string()}) {
    const test::ProgramOutcome outcome = run_the_program(material + "--own '" + named + "' --out '" + own + "'");
    EXPECT_EQ(outcome.status, 2) << outcome.output;
    EXPECT_NE(outcome.output.find("would be overwritten"), std::string::npos) << outcome.output;
    EXPECT_EQ(read_text(own), text);
  }
}

/// `--out` takes the place of what the same command wrote and of nothing else.
TEST(LawCommand, OutLeavesOtherFilesAlone) {
  const test::TemporaryDirectory directory;
  const auto expect = [](const std::string& arguments, int status, const std::string& words) {
    const test::ProgramOutcome outcome = run_the_program(arguments);
    EXPECT_EQ(outcome.status, status) << outcome.output;
    EXPECT_NE(outcome.output.find(words), std::string::npos) << outcome.output;
  };
  const std::string get = "law get --mu 0.3 --exponent 3.5 --ratio 10 --solid-fraction 0.7 --out '";
  const std::string notes = directory.file("notes.toml");
  write_text_atomic(notes, "title = \"mine\"\n");
  expect(get + notes + "'", 2, "notes.toml is there already, is no table that law get wrote");
  EXPECT_EQ(read_text(notes), "title = \"mine\"\n");
  const std::string measured = directory.file("measured.toml");
  write_text_atomic(measured, read_text(kRoot + "/" + kTable));
  expect(get + measured + "'", 2, "would be overwritten");
  EXPECT_EQ(read_text(measured), read_text(kRoot + "/" + kTable));
  write_text_atomic(directory.file("run.h5"), "results");
  expect(get + directory.file("run.toml") + "'", 2, "run.h5 is there already");
  EXPECT_EQ(read_text(directory.file("run.h5")), "results");
  for (int k = 0; k < 2; ++k) expect(get + directory.file("law.toml") + "'", 0, "written: ");
  expect(get + directory.file("law.toml") + "'", 0, "the table is for E = 0.5 MPa");
  const std::string card = "law export '" + kRoot + "/" + kCard + "' --to ";
  expect(card + "csv --out '" + notes + "'", 2, "notes.toml: is there already, is no csv export");
  for (const char* format : {"lammps-table", "csv", "json"})
    for (int k = 0; k < 2; ++k)
      expect(card + format + " --out '" + directory.file(std::string("law.") + format) + "'", 0, "written: ");
}

TEST(FittedLaw, OfARunDirectoryIsToldByItsContent) {
  const FittedLaw card = load_law(kRoot + "/results/published");
  FittedLaw table = load_law(kRoot + "/results/law_table");
  EXPECT_NE(card.card(), nullptr);
  EXPECT_EQ(kind_text(card), "law card");
  ASSERT_NE(table.table(), nullptr);
  EXPECT_EQ(kind_text(table), "law table");
  EXPECT_EQ(table.path, kRoot + "/results/law_table/law_table.toml");
  read_refits(table);
  const std::size_t refits = replicate_count(*table.table(), LawForm::isotropic);
  EXPECT_GT(refits, 0u);
  read_refits(table);  // has them already
  EXPECT_EQ(replicate_count(*table.table(), LawForm::isotropic), refits);
}

TEST(FittedLaw, ACardServesThePairLawAndATableAllElse) {
  LawSources sources;
  sources.laws = {load_law(kRoot + "/" + kCard), load_law(kRoot + "/" + kTable)};
  EXPECT_NE(sources.serving(LawForm::pair).card(), nullptr);
  EXPECT_NE(sources.serving(LawForm::directional).table(), nullptr);
  EXPECT_NE(sources.serving({}).table(), nullptr);
  sources.laws.pop_back();
  EXPECT_NE(sources.serving(LawForm::directional).card(), nullptr);
}

/// By this number runs, reports and comparisons of all versions tell whether two laws are the same.
TEST(LawCommand, TheNumberOfALawStays) {
  LawSources sources;
  sources.laws = {load_law(kRoot + "/" + kTable)};
  sources.forms = {LawForm::isotropic};
  MacroSpec spec;
  spec.poisson_ratio = measured_spec(sources).poisson_ratio;
  spec.friction = measured_spec(sources).friction;
  EXPECT_EQ(scene_law(sources, spec, 0.0, "law").identity.hash, "d708eed99b3e9fe7");
}

TEST(LawCommand, NothingIsWiderThan80Columns) {
  for (const bool utf8 : {true, false}) {
    expect_narrow(law::law_text(committed(kCard), utf8));
    expect_narrow(law::law_text(committed(kTable), utf8));
  }
  for (const std::string& file : {kCard, kTable})
    for (const char* more : {"", " --E 1e9 --radius 1e-6", " --to 1.3 --steps 5"})
      expect_narrow(run_the_program("law eval '" + kRoot + "/" + file + "'" + more).output);
}

TEST(LawCommand, OverlapsWithoutContactAskForNoIntervals) {
  const std::string said = run_the_program("law eval '" + kRoot + "/" + kCard + "' --delta 0.01 0.02").output;
  EXPECT_NE(said.find("no contact"), std::string::npos) << said;
  EXPECT_EQ(said.find("intervals"), std::string::npos) << said;
}

nlohmann::json json_of(const std::string& arguments, int status = 0) {
  const test::ProgramOutcome outcome = run_the_program(arguments);
  EXPECT_EQ(outcome.status, status) << outcome.output;
  return nlohmann::json::parse(outcome.output);
}

TEST(LawCommand, EveryActionSpeaksJson) {
  const std::string card = "'" + kRoot + "/" + kCard + "' ";
  const std::string table = "'" + kRoot + "/" + kTable + "' ";
  const nlohmann::json shown = json_of("law show --json " + card);
  EXPECT_EQ(shown["kind"], "law card");
  EXPECT_NEAR(shown["parameters"]["soft-solid"]["dimensionless"]["normal"]["a"].get<double>(), 0.82941, 1e-5);
  EXPECT_EQ(json_of("law show --json " + table)["parameters"]["entries"].size(), 2u);
  EXPECT_GT(json_of("law show --json " + card + table)["differences"].size(), 2u);
  const nlohmann::json values = json_of("law eval --json " + card + "--delta 0.2 --kind soft-solid --radius '16 mm'");
  EXPECT_NEAR(values["laws"][0]["values"][0]["force"].get<double>(), 128.0 * 0.0049371, 1e-4);
  EXPECT_EQ(values["units"]["force"], "N");
  const nlohmann::json multi_contact = json_of("law eval --json " + table + "--arrangement cube --delta 0.15");
  EXPECT_EQ(multi_contact["laws"][0]["values"][0]["forces"].size(), 6u);
  EXPECT_EQ(multi_contact["laws"][0]["intervals"],
            "95 %, bootstrap over packings");  // from the refits in the committed .h5
  const nlohmann::json refused = json_of("law eval --json " + card + "--beyond error --to 0.5 --kind soft-solid", 3);
  EXPECT_EQ(refused["status"], "not usable");
  EXPECT_TRUE(refused["laws"][0]["values"].back()["force"].is_null());
}

TEST(LawCommand, ExportsToAFileOrToStandardOutput) {
  const test::TemporaryDirectory directory;
  const std::string card = "'" + kRoot + "/" + kCard + "' ";
  for (const char* format : {"lammps-table", "csv", "json"}) {
    const std::string path = directory.file(format);
    const nlohmann::json said = json_of("law export " + card + "--json --to " + format + " --out '" + path + "'");
    EXPECT_EQ(said["written"], path);
    EXPECT_EQ(read_text(path), run_the_program("law export " + card + "--to " + format).output);
  }
  const nlohmann::json law = nlohmann::json::parse(read_text(directory.file("json")));
  EXPECT_EQ(law["laws"][0]["values"].size(), 101u);
  EXPECT_TRUE(law["parameters"].contains("soft-soft"));
  EXPECT_TRUE(read_text(directory.file("csv")).starts_with("law,delta,overlap [R],force [E R^2],"));
}

}  // namespace
}  // namespace softgrain
