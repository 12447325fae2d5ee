// Files of tests/data/sieves, each in the manner of another laboratory: D10, D50 and D90 of what is read, or part of
// the message of what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <string>

#include "common/core/error.h"
#include "common/io/text_file.h"
#include "common/packing/grading_indices.h"
#include "common/packing/grading_scene.h"
#include "common/packing/sieve_size.h"
#include "common/packing/sieve_table.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;

struct SieveSample {
  const char* file;
  const char* keys;                 ///< beside form and file in the scene
  std::array<double, 3> diameters;  ///< D10, D50, D90 [mm]
  const char* refused;              ///< part of the message; empty: it is read
};

const std::string kSieveFolder = std::string(SOFTGRAIN_SOURCE_DIR) + "/tests/data/sieves/";

// The diameters were computed by hand from the numbers of the files: straight over the logarithm between sieves.
const std::vector<SieveSample> kSieveSamples{
    {"astm_percent_passing.csv", "", {0.203753235, 0.755210223, 2.59903971}, ""},
    {"astm_numbers_with_openings.csv", "", {0.203753235, 0.755210223, 2.59903971}, ""},
    {"astm_fractions_among_numbers.csv", "", {0.150104022, 1.00479719, 4.39078702}, ""},
    {"bad_size_behind_a_note.csv", "", {}, "\"2 mmm\" is no size of a sieve"},
    {"pan_without_value.csv", "", {}, "what is retained is missing"},
    {"pan_with_two_cells.csv", "", {}, "3 cells"},
    {"size_left_out.csv", "", {}, "the opening is missing"},
    {"astm_names_retained.csv", "", {0.257152843, 0.874403251, 3.62859122}, ""},
    {"astm_pan.csv", "", {}, "or give smallest = \"... mm\" in the table of sizes"},
    {"astm_pan.csv", "smallest = \"0.02 mm\"", {0.146762259, 0.488812957, 1.16864153}, ""},
    {"astm_pan.csv", "smallest = \"0.1 mm\"", {}, "must be below the finest sieve, 0.075 mm"},
    {"iso_passing_ascending.csv", "", {0.204665552, 0.646588557, 1.74523197}, ""},
    {"din_summe_rueckstand.csv", "", {0.20693832, 0.684414, 1.87987704}, ""},
    {"din_durchgang.csv", "", {0.910823223, 1.5576743, 2.77430704}, ""},
    {"din_einzelrueckstand.csv", "", {2.70839557, 4.40721949, 6.71370127}, ""},
    {"din_unter.csv", "", {}, "or give smallest ="},
    {"din_unter.csv", "smallest = \"50 um\"", {0.262461085, 0.628188002, 1.46973449}, ""},
    {"fr_tamisat.csv", "", {2.56392229, 3.55887704, 4.91632603}, ""},
    {"fr_refus_partiel.tsv", "", {0.169341073, 0.519629613, 1.2882139}, ""},
    {"fr_refus_cumule.csv", "", {4.49847448, 6.2226767, 8.65919283}, ""},
    {"excel_sep.csv", "", {0.352043878, 0.897492402, 1.71152326}, ""},
    {"utf16_le.txt", "", {0.428407689, 1.15198759, 2.76817454}, ""},
    {"utf16_be.txt", "", {0.428407689, 1.15198759, 2.76817454}, ""},
    {"phi_weight.csv", "", {0.364213712, 0.657945324, 1.21303902}, ""},
    {"micron_shares.csv", "", {0.0486630512, 0.0668912859, 0.0881120667}, ""},
    {"inch_decimal.csv", "", {2.82860343, 6.67549702, 10.8241378}, ""},
    {"inch_names.csv", "", {11.7982648, 23.4472934, 41.0274593}, ""},
    {"mesh_us.csv", "", {0.250697114, 0.445505199, 0.683555533}, ""},
    {"mesh_of_two_series.csv", "", {}, "Give unit = \"astm\""},
    {"mesh_of_two_series.csv", "unit = \"astm\"", {0.259288761, 0.691512286, 1.57690198}, ""},
    {"din_kornklassen.csv", "", {0.385552706, 0.922177827, 2.18924707}, ""},
    {"retained_sums_to_100.csv", "", {0.435275282, 1.11565792, 2.72158}, ""},
    {"retained_rises_to_100.csv", "", {0.426090198, 1.17012825, 2.87549339}, ""},
    {"retained_masses_rise.csv", "", {}, "give column = \"retained\" or column = \"cumulative retained\""},
    {"retained_masses_rise.csv", "column = \"retained\"", {0.294736982, 0.594603558, 1.79683078}, ""},
    {"retained_masses_rise.csv", "column = \"cumulative retained\"", {0.329876978, 0.905723664, 2.63901582}, ""},
    {"no_unit_iso.csv", "", {0.16759801, 0.540615978, 1.37502653}, ""},
    {"no_unit.csv", "", {}, "no unit: give unit = \"mm\""},
    {"no_unit.csv", "unit = \"mm\"", {1.37035098, 3.28968334, 6.69734712}, ""},
    {"repeats.csv", "", {}, "or give column = \"test 1, mass retained [g]\""},
    {"repeats.csv", "column = \"test 2, mass retained [g]\"", {0.601851587, 1.21272859, 2.6783728}, ""},
    {"thousands.csv", "", {0.445724633, 1.16717471, 2.59592644}, ""},
    {"thousands_blank.csv", "", {0.494853925, 1.19482015, 2.55525875}, ""},
    {"thousands_or_decimals.csv", "", {}, "may be 1.250 or 1250"},
    {"percent_in_cells.csv", "", {2.01184096, 3.12044732, 4.82216685}, ""},
    {"total_contradicts.csv", "", {}, "all sieves and the pan retain 350, not 500"},
    {"coarsest_retains.csv", "", {}, "or give largest = \"... mm\""},
    {"coarsest_retains.csv", "largest = \"8 mm\"", {1.13696291, 1.89990321, 3.73213197}, ""},
    {"wrong_number.csv", "", {}, "wrong_number.csv:3: column \"Sieve No.\": No. 15 is no sieve of ASTM E11"},
    {"row_of_another_size.csv", "", {}, "\"coarse\" is no size of a sieve"},
    {"astm_report.csv", "", {0.156982427, 0.676742119, 2.19343908}, ""},
    {"fractions.csv", "", {0.118757029, 0.215555729, 0.419223669}, ""},
    {"numbers_without_a_unit.csv", "", {}, "no unit: give unit = \"mm\" (or um, cm, in, phi, astm)"},
    {"numbers_without_a_unit.csv", "unit = \"astm\"", {0.133634808, 0.339330362, 0.701131505}, ""},
};

Grading grading_of(const SieveSample& s) {
  const Scene scene = Scene::parse(
      "form = \"sieve-curve\"\nfile = \"" + kSieveFolder + s.file + "\"\n" + std::string(s.keys) + "\n", "s.toml");
  Grading grading = read_grading(scene.root());
  scene.root().finish();
  return grading;
}

TEST(SieveFiles, AreReadOrRefusedAsTheTableSays) {
  constexpr std::array kShares{0.1, 0.5, 0.9};
  for (const SieveSample& s : kSieveSamples) {
    std::string complaint;
    try {
      const Grading grading = grading_of(s);
      for (std::size_t k = 0; k < kShares.size(); ++k)
        EXPECT_NEAR(1e3 * diameter_passing(grading, kShares[k]), s.diameters[k], 1e-6 * s.diameters[k])
            << s.file << " " << s.keys << " at " << kShares[k];
      EXPECT_EQ(stored_grading(grading.text()), grading) << s.file;
    } catch (const InputError& e) {
      complaint = e.what();
    }
    EXPECT_EQ(complaint.empty(), std::string(s.refused).empty()) << s.file << " " << s.keys << "\n" << complaint;
    EXPECT_NE(complaint.find(s.refused), std::string::npos) << s.file << " " << s.keys << "\n" << complaint;
  }
}

std::string complaint_of(const std::string& text) {
  const test::TemporaryDirectory directory;
  write_text_atomic(directory.file("s.csv"), text);
  try {
    (void)read_sieve_file(directory.file("s.csv"), {}, 3);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(SieveFiles, WithoutAHeaderAreToldOneOfTheirOwn) {
  for (const char* text : {"", "4.0;100\n2.0;50\n"})
    EXPECT_NE(complaint_of(text).find("e.g. opening [mm], passing [%]"), std::string::npos) << complaint_of(text);
}

/// They were taken for titles of the laboratory, and the curve had lost a sieve.
TEST(SieveFiles, RowsAboveTheHeaderAreRefused) {
  const std::string table = "opening [mm];passing [%]\n4;100\n2;50\n1;0\n";
  for (const char* row : {"8;100", "-3;100", "8;100 %", "3/8\";100", "3/8 in.;100", "No. 4;100", "No. 4;4,75 mm;100",
                          "4,75 mm;150 g", "0.5 - 1 mm;12"})
    EXPECT_NE(complaint_of(row + ("\n" + table)).find("s.csv:1: a row of the table above the header (line 2)"),
              std::string::npos)
        << row;
  for (const char* title : {"Sample;12", "30.11.2026;12", "2026-11-30;12", "11/2026;12", "Test No. 3;12", "EN 933;2012",
                            "ASTM E11;2022", "No.;12", "No. 4;30.11.2026", "Mass;150 g", "3/8 in. gravel;12", "No. 4"})
    EXPECT_EQ(complaint_of(title + ("\n" + table)), "") << title;
}

/// The openings show the mark of the masses.
TEST(SieveFiles, OneDecimalCommaTellsTheOthersOfATableWithTabs) {
  const std::string table = "opening [mm]\tmass retained [kg]\n4\t0\n2\t1,250\n1\t2,500\n";
  EXPECT_NE(complaint_of(table).find("may be 1.250 or 1250"), std::string::npos);
  EXPECT_EQ(complaint_of(table + "0,5\t1,125\n"), "");
}

/// 1.250 g were 1.25 g, as the column of the masses showed no decimal comma. Openings in mm, percents and shares are
/// below a thousand.
TEST(SieveFiles, PointsOfATableWithDecimalCommasSeparateThousands) {
  const test::TemporaryDirectory directory;
  const auto read = [&](const std::string& table) {
    write_text_atomic(directory.file("s.csv"), table);
    return read_sieve_file(directory.file("s.csv"), {}, 3).grading;
  };
  const std::string masses = "opening [mm];mass retained [g]\n";
  const auto of_mass = [&](const std::string& mass) { return read(masses + "4;0\n2;" + mass + "\n0,5;800\n"); };
  EXPECT_EQ(of_mass("1.250"), of_mass("1250"));
  EXPECT_EQ(read(masses + "4.000;0\n2.000;10,5\n1.000;5,2\n"), read(masses + "4;0\n2;10,5\n1;5,2\n"));
  EXPECT_EQ(read("opening [um];mass retained [g]\n4.000;0\n2.000;10,5\n1.000;5,2\n"),
            read(masses + "4;0\n2;10,5\n1;5,2\n"));
  EXPECT_EQ(read("opening [mm];passing [-]\n4;1.000\n0,5;0\n"), read("opening [mm];passing [%]\n4;100\n0,5;0\n"));
}

TEST(SieveFiles, EveryFileIsInTheTable) {
  std::set<std::string> known;
  for (const SieveSample& s : kSieveSamples) known.insert(s.file);
  std::set<std::string> there;
  for (const auto& entry : std::filesystem::directory_iterator(kSieveFolder))
    if (entry.path().extension() != ".md") there.insert(entry.path().filename().string());
  EXPECT_EQ(known, there);
}

TEST(SieveFiles, KeysWithoutEffectAreRefused) {
  for (const char* keys : {"smallest = \"0.01 mm\"", "largest = \"20 mm\"", "unit = \"mm\"", "column = \"weight\""})
    EXPECT_THROW((void)grading_of({"iso_passing_ascending.csv", keys, {}, ""}), InputError) << keys;
  EXPECT_THROW((void)grading_of({"mesh_us.csv", "unit = \"mm\"", {}, ""}), InputError);
  EXPECT_THROW((void)grading_of({"astm_pan.csv", "unit = \"mm\"\nsmallest = \"0.02 mm\"", {}, ""}), InputError);
}

TEST(SieveFiles, TheBestFullerCurveOfAFullerCurveIsItself) {
  for (const double q : {0.3, 0.5, 0.8}) {
    const GradingIndices i = grading_indices(Grading::fuller(q, 1e-4, 4e-3));
    EXPECT_NEAR(i.fuller, q, 1e-6);
    EXPECT_LT(i.fuller_difference, 1e-6);
    EXPECT_NEAR(i.cu, i.d60 / i.d10, 1e-12);
    EXPECT_NEAR(i.cc, i.d30 * i.d30 / (i.d60 * i.d10), 1e-12);
  }
}

/// Numbers without a unit are told by their openings: those of ISO 565 that are rounded in their own way, and the names
/// of EN 12620 (32 for 31.5 mm), are openings too.
TEST(SieveFiles, OpeningsOfStandardsTellTheUnit) {
  using Numbers = std::vector<std::string>;
  for (const Numbers& numbers :
       {Numbers{"0.063", "2", "5.6", "11.2", "22.4", "31.5"}, Numbers{"0.063", "2", "11", "22", "32"},
        Numbers{"0.032", "0.5", "12"}, Numbers{"0.022", "0.036", "13.2", "26.5"}})
    EXPECT_EQ(unit_of_numbers(numbers), "mm") << numbers.front() << ", " << numbers.back();
  EXPECT_EQ(unit_of_numbers({"22", "32", "36", "63", "500"}), "um");
  // Up to 125 it may be either: sieves of 22 to 125 mm are as usual as those of 22 to 125 um.
  EXPECT_FALSE(unit_of_numbers({"22", "36", "63", "125"}));
  EXPECT_EQ(unit_of_numbers({"22", "36", "63", "140"}), "um");
  for (const Numbers& numbers : {Numbers{"0.063", "3.2"}, Numbers{"0.063", "0.132"}, Numbers{"0.063", "34"}})
    EXPECT_FALSE(unit_of_numbers(numbers)) << numbers.back();
}

}  // namespace
