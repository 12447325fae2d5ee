// Reading force-displacement measurements from text: units, separators, comments, and what is said of wrong ones.
#include "common/data/force_curves.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <filesystem>

#include "common/core/error.h"
#include "common/io/csv_file.h"
#include "common/io/text_file.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using test::TemporaryDirectory;

constexpr const char* kGood = R"(# loading of one sample
# kind = soft-solid
# Rs: 16 mm
# E = "0.5 MPa"
# mu = 0.25
hn [mm], Fn [mN]
0.8, 0
1.6, 80
2.4, 300
3.2, 800
4.0, 1500
)";

class ForceCurveFile : public ::testing::Test {
 protected:
  std::string write(const std::string& text, const std::string& name = "data.csv") const {
    write_text_atomic(directory_.file(name), text);
    return directory_.file(name);
  }
  ForceCurves read(const std::string& text, const ForceCurveOptions& options = {}) const {
    return read_force_curves(write(text), options);
  }
  /// The message of InputError.
  std::string refused(const std::string& text, const ForceCurveOptions& options = {}) const {
    try {
      (void)read(text, options);
    } catch (const InputError& e) {
      return e.what();
    }
    return "nothing was refused";
  }
  void expect_refused(const std::string& text, const std::vector<std::string>& words,
                      const ForceCurveOptions& options = {}) const {
    const std::string message = refused(text, options);
    for (const std::string& word : words)
      EXPECT_NE(message.find(word), std::string::npos) << word << " in: " << message;
  }
  TemporaryDirectory directory_;
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST_F(ForceCurveFile, UnitsAndCommentsBecomeSiAndDelta) {
  const ForceCurves c = read(kGood);
  EXPECT_EQ(c.kind, PairKind::soft_solid);
  EXPECT_DOUBLE_EQ(c.spec.shell_radius, 0.016);
  EXPECT_DOUBLE_EQ(c.spec.youngs_modulus, 5e5);
  EXPECT_DOUBLE_EQ(c.spec.friction, 0.25);
  ASSERT_EQ(c.samples.size(), 1U);
  EXPECT_EQ(c.samples[0].name, "data");
  ASSERT_EQ(c.samples[0].normal.size(), 5U);
  EXPECT_NEAR(c.samples[0].normal[4].delta, 0.25, 1e-15);
  EXPECT_NEAR(c.samples[0].normal[4].force, 1.5, 1e-15);
  EXPECT_TRUE(c.remarks.empty());
}

/// Two laws became one where an option won over what the file says.
TEST_F(ForceCurveFile, OptionsThatContradictCommentsAreRefused) {
  ForceCurveOptions same;
  same.kind = PairKind::soft_solid;
  same.shell_radius = 0.016;
  same.youngs_modulus = 5e5;
  EXPECT_EQ(read(kGood, same).spec.shell_radius, 0.016);
  ForceCurveOptions kind = same, radius = same, modulus = same;
  kind.kind = PairKind::soft_soft;
  radius.shell_radius = 0.032;
  modulus.youngs_modulus = 1e6;
  expect_refused(kGood, {"data.csv:2", "kind = soft-solid", "--kind soft-soft"}, kind);
  expect_refused(kGood, {"data.csv:3", "Rs = 16 mm (0.016 m)", "--radius 0.032 m"}, radius);
  expect_refused(kGood, {"data.csv:4", "E = 0.5 MPa", "--modulus 1e+06 Pa"}, modulus);
}

TEST_F(ForceCurveFile, CommentsInOtherSpellingsCount) {
  std::string text =
      replaced(kGood, "# Rs: 16 mm", "# Rs [mm] = 16\n# density [kg/m^3] = 2600\n# Poisson ratio = 0.22");
  text = replaced(text, "# E = \"0.5 MPa\"", "# Young's modulus (MPa): 0.5\n# specimen: ring 7");
  const ForceCurves c = read(text);
  EXPECT_DOUBLE_EQ(c.spec.shell_radius, 0.016);
  EXPECT_DOUBLE_EQ(c.spec.youngs_modulus, 5e5);
  EXPECT_EQ(c.spec.density, 2600.0);
  EXPECT_EQ(c.spec.poisson_ratio, 0.22);
  EXPECT_EQ(c.samples[0].name, "ring 7");
}

TEST_F(ForceCurveFile, CommentsThatWouldBeLostAreRefused) {
  expect_refused(replaced(kGood, "# mu = 0.25", "# Rs = 17 mm"), {"data.csv:5", "contradicts line 3"});
  expect_refused(replaced(kGood, "# mu = 0.25", "# densty [kg/m^3] = 2600"), {"data.csv:5", "densty", "\"density\""});
  expect_refused(replaced(kGood, "# mu = 0.25", "# temperature [C] = 20"), {"temperature", "may say rs, e, kind, nu"});
}

/// Over the radius or over the diameter: the law differs by a power of two.
TEST_F(ForceCurveFile, AStrainIsAskedFor) {
  expect_refused(replaced(kGood, "hn [mm]", "strain"), {"data.csv:6", "strain", "hn [mm]", "Delta", "half"});
  expect_refused(replaced(kGood, "hn [mm]", "strain [%]"), {"strain", "Delta"});
  std::string percent = replaced(kGood, "hn [mm]", "Delta [%]");
  EXPECT_NEAR(read(percent).samples[0].normal[4].delta, 0.04, 1e-15);
}

TEST_F(ForceCurveFile, ReadingsBeforeTouchAreKept) {
  const ForceCurves c = read(replaced(kGood, "0.8, 0\n", "-0.2, 3\n-0.1, 5\n0.8, 0\n"));
  EXPECT_EQ(c.samples[0].before_touch, (std::vector<double>{0.003, 0.005}));
  EXPECT_EQ(c.samples[0].normal.size(), 5U);
}

/// It was a reading before touch, and its force moved the zero.
TEST_F(ForceCurveFile, AnOverlapOfTheWrongSignIsRefused) {
  expect_refused(replaced(kGood, "2.4, 300", "-2.4, 300"), {"data.csv:9", "Delta = -0.15 stands between 0.1 and 0.2"});
  const ForceCurves jitter = read(replaced(kGood, "0.8, 0\n", "0.08, 0\n-0.1, 1\n0.8, 0\n"));
  EXPECT_EQ(jitter.samples[0].before_touch, (std::vector<double>{0.001}));
  EXPECT_EQ(jitter.samples[0].normal.size(), 6U);
}

/// The deepest reading was left out as one before touch.
TEST_F(ForceCurveFile, TheDeepestOverlapOfTheWrongSignIsRefused) {
  expect_refused(replaced(kGood, "4.0, 1500", "4.0, 1500\n-4.8, 2200"),
                 {"data.csv:12", "Delta = -0.3 has a force of 2.2 N, more than 1.5 N at Delta = 0.25"});
  const ForceCurves away = read(replaced(kGood, "4.0, 1500", "4.0, 1500\n-4.8, 1"));
  EXPECT_EQ(away.samples[0].before_touch, (std::vector<double>{0.001}));
  EXPECT_EQ(away.samples[0].normal.size(), 5U);
}

/// Somebody who goes back to look for the zero of the force goes farther than the next overlap. What is met later does
/// not make that reading one of the loading.
TEST_F(ForceCurveFile, AWayBackBeyondTheNextOverlapIsBeforeTouch) {
  const ForceCurves back = read(replaced(kGood, "1.6, 80\n", "-2.0, 1\n1.6, 80\n"));
  EXPECT_EQ(back.samples[0].before_touch, (std::vector<double>{0.001}));
  EXPECT_EQ(back.samples[0].normal.size(), 5U);
}

TEST_F(ForceCurveFile, SemicolonsTabsAndDecimalCommas) {
  ForceCurveOptions o;
  o.kind = PairKind::soft_solid;
  o.shell_radius = 0.01;
  o.youngs_modulus = 1e6;
  const std::string rows = "0,5;0,1\n1,0;0,2\n1,5;0,4\n2,0;0,8\n2,5;1,6\n";
  const ForceCurves c = read("\xef\xbb\xbfhn (mm);Fn (N)\r\n" + rows, o);
  EXPECT_NEAR(c.samples[0].normal[4].delta, 0.25, 1e-15);
  EXPECT_NEAR(c.samples[0].normal[4].force, 1.6, 1e-15);
  std::string tabs = "Delta\tforce [N]\n";
  for (int k = 1; k <= 5; ++k) tabs += "0." + std::to_string(k) + "\t" + std::to_string(k) + "\n";
  EXPECT_NEAR(read(tabs, o).samples[0].normal[4].delta, 0.5, 1e-15);
}

TEST_F(ForceCurveFile, SamplesErrorsAndUnknownColumns) {
  std::string text = replaced(kGood, "hn [mm], Fn [mN]", "hn [mm], Fn [mN], se [mN], sample, temperature [C]");
  std::string rows;
  for (const char* s : {"A", "B"})
    for (int k = 1; k <= 5; ++k) rows += std::to_string(k) + ", " + std::to_string(10 * k * k) + ", 5, " + s + ", 20\n";
  const ForceCurves c = read(text.substr(0, text.find("0.8, 0")) + rows);
  ASSERT_EQ(c.samples.size(), 2U);
  EXPECT_EQ(c.samples[1].name, "B");
  EXPECT_NEAR(c.samples[1].normal[0].error, 0.005, 1e-15);
  EXPECT_TRUE(c.has_errors);
  ASSERT_EQ(c.remarks.size(), 1U);
  EXPECT_NE(c.remarks[0].find("temperature"), std::string::npos);
}

/// A wrong column that is taken for the sample gives one to every row.
TEST_F(ForceCurveFile, AsManySamplesAsRowsTakeNoLonger) {
  constexpr int kRows = 120000;
  const auto seconds = [&](bool alike, const std::vector<std::string>& words) {
    std::string text = "# kind = soft-solid\n# Rs = 16 mm\n# E = 1 MPa\nsample,hn [mm],Fn [N]\n";
    for (int k = 0; k < kRows; ++k)
      text += (alike ? "a" : "a reading at " + std::to_string(k) + " s") + "," + std::to_string(1e-4 * k) + ",1\n";
    const std::string path = write(text);
    const std::clock_t start = std::clock();  // processor time: other work on the machine does not count
    std::string message = "read";
    try {
      EXPECT_EQ(read_force_curves(path, {}).samples.size(), 1U);
    } catch (const InputError& e) {
      message = e.what();
    }
    for (const std::string& word : words) EXPECT_NE(message.find(word), std::string::npos) << message;
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  };
  const double one = seconds(true, {"read"});
  EXPECT_LT(seconds(false, {"too few points: 1 of the normal force in the longest sample"}), 10.0 * one);
}

TEST_F(ForceCurveFile, GermanTitlesOfTestingMachinesAreKnown) {
  const ForceCurves english = read(kGood);
  for (const char* titles : {"Weg [mm], Kraft [mN]", "Standardweg [mm], Standardkraft [mN]"}) {
    const ForceCurves german = read(replaced(kGood, "hn [mm], Fn [mN]", titles));
    ASSERT_EQ(german.samples.size(), english.samples.size());
    EXPECT_EQ(german.samples[0].normal.back().force, english.samples[0].normal.back().force) << titles;
  }
}

TEST_F(ForceCurveFile, WrongFilesAreNamedWithTheirLine) {
  expect_refused(replaced(kGood, "hn [mm]", "hn"), {"data.csv:6", "hn", "no unit", "hn [mm]"});
  expect_refused(replaced(kGood, "Fn [mN]", "Fn [mm]"), {"data.csv:6", "unknown unit 'mm'", "kN"});
  expect_refused(replaced(kGood, "hn [mm]", "overlapp [mm]"), {"data.csv:6", "overlapp", "\"overlap\" is near"});
  expect_refused(replaced(kGood, "1.6, 80", "1.6, "), {"data.csv:8", "Fn [mN]", "missing"});
  expect_refused(replaced(kGood, "1.6, 80", "1.6, eighty"), {"data.csv:8", "Fn [mN]", "eighty"});
  expect_refused(replaced(kGood, "1.6, 80", "1.6"), {"data.csv:8", "1 cell,", "2 columns"});
  expect_refused(replaced(kGood, "1.6, 80", "1,6, 80"), {"data.csv:8", "3 cells", "decimal commas", "; or tab"});
  expect_refused(replaced(kGood, "4.0, 1500", "4.0, \"1,500.5\""),
                 {"data.csv:11", "\"1,500.5\" has a comma and a point", "thousands"});
  // A point between thousands was a decimal point: 1.5 for 1500.
  std::string commas = kGood;
  std::ranges::replace(commas, ',', ';');
  const std::string excel = replaced(replaced(commas, "2.4; 300", "2,4; 300,5"), "4.0; 1500", "4,0; 1.500");
  expect_refused(excel, {"data.csv:11", "\"1.500\" may have a sign between thousands"});
  expect_refused(replaced(replaced(commas, "2.4; 300", "2.4; 300.5"), "1500", "1,500"), {"data.csv:11", "\"1,500\""});
  std::string german = replaced(commas, "2.4; 300", "2.400; 300.125");
  std::replace(german.begin() + static_cast<std::ptrdiff_t>(german.find("hn [mm]")), german.end(), '.', ',');
  EXPECT_EQ(read(german).samples.at(0).normal.at(2).force, 0.300125);
  expect_refused(replaced(kGood, "2.4, 300", "1.2, 300"), {"data.csv:9", "does not rise", "unloading=drop"});
  expect_refused(replaced(kGood, "4.0, 1500\n", ""), {"too few points", "4", "at least 5"});
  expect_refused(replaced(kGood, "4.0, 1500", "40, 1500"), {"data.csv:11", "2.5 Rs", "check unit and radius"});
  expect_refused(replaced(kGood, "# kind = soft-solid", ""), {"--kind"});
  expect_refused(replaced(kGood, "= soft-solid", "= hard"), {"data.csv:2", "hard", "soft-soft"});
  expect_refused(replaced(kGood, "# Rs: 16 mm", ""), {"--radius"});
  expect_refused(replaced(kGood, "16 mm", "16 s"), {"data.csv:3", "unknown unit 's'"});
  expect_refused(replaced(kGood, "16 mm", "-1 mm"), {"data.csv:3", "above 0"});
  expect_refused(replaced(kGood, "# E = \"0.5 MPa\"", ""), {"--modulus"});
  expect_refused(replaced(kGood, "hn [mm], Fn [mN]\n", ""), {"data.csv:6", "no header"});
  expect_refused("# nothing\n", {"no header"});
  expect_refused(replaced(kGood, "Fn [mN]", "hn [m]"), {"data.csv:6", "twice"});
  expect_refused(replaced(kGood, "Fn [mN]", "h [m]"), {"both name hn"});
}

/// As test benches and scripts write titles.
TEST_F(ForceCurveFile, UnitsBehindNamesWithoutBracketsCount) {
  const ForceCurves good = read(kGood);
  const auto same = [&](const std::string& header) {
    const ForceCurves curves = read(replaced(kGood, "hn [mm], Fn [mN]", header));
    ASSERT_EQ(curves.samples.size(), 1U) << header;
    ASSERT_EQ(curves.samples[0].normal.size(), good.samples[0].normal.size()) << header;
    for (std::size_t k = 0; k < good.samples[0].normal.size(); ++k) {
      EXPECT_EQ(curves.samples[0].normal[k].delta, good.samples[0].normal[k].delta) << header;
      EXPECT_EQ(curves.samples[0].normal[k].force, good.samples[0].normal[k].force) << header;
    }
  };
  for (const char* header :
       {"displacement_mm, force_mN", "Displacement (mm), Force (mN)", "Displacement mm, Load mN", "h/mm, F/mN",
        "overlap in mm, normal force in mN", "displacement_in_mm, Fn_1_mN", "Overlap [mm], F_N [mN]"})
    same(header);
  // A name that is known as it stands has no unit: F_N may be the normal force. N is no unit in small letters.
  expect_refused(replaced(kGood, "Fn [mN]", "F_N"), {"data.csv:6", "\"F_N\": no unit"});
  expect_refused(replaced(kGood, "Fn [mN]", "force_n"), {"data.csv:6", "\"force_n\" (write it as \"Fn [N]\")"});
  expect_refused(replaced(kGood, "Fn [mN]", "force_mm"), {"data.csv:6", "write it as \"Fn [N]\""});
}

TEST_F(ForceCurveFile, WithoutOptionsOnlyCommentsAreAskedFor) {
  ForceCurveOptions o;
  o.by_options = false;
  for (const char* comment : {"# kind = soft-solid", "# Rs: 16 mm", "# E = \"0.5 MPa\""}) {
    const std::string message = refused(replaced(kGood, comment, ""), o);
    EXPECT_EQ(message.find("--"), std::string::npos) << message;
    EXPECT_NE(message.find("write a comment \"# "), std::string::npos) << message;
  }
}

TEST_F(ForceCurveFile, UnloadingCanBeLeftOut) {
  ForceCurveOptions o;
  o.unloading = Unloading::drop;
  const ForceCurves c = read(std::string(kGood) + "3.5, 900\n3.0, 500\n4.5, 2000\n", o);
  EXPECT_EQ(c.samples[0].normal.size(), 6U);
  ASSERT_EQ(c.remarks.size(), 1U);
  EXPECT_NE(c.remarks[0].find("2 points of unloading"), std::string::npos);
}

TEST_F(ForceCurveFile, AFallingForceIsARemarkWithItsLine) {
  const ForceCurves c = read(replaced(kGood, "3.2, 800", "3.2, 100"));
  ASSERT_EQ(c.remarks.size(), 1U);
  EXPECT_NE(c.remarks[0].find("data.csv:10"), std::string::npos) << c.remarks[0];
}

TEST_F(ForceCurveFile, StiffnessColumnAndSweepsBecomeRotations) {
  std::string text = replaced(kGood, "hn [mm], Fn [mN]", "hn [mm], Fn [mN], kt [N/m]");
  for (const char* row : {"0.8, 0", "1.6, 80", "2.4, 300", "3.2, 800", "4.0, 1500"})
    text = replaced(text, std::string(row) + "\n", std::string(row) + ", 40\n");
  const auto kt = read(text).samples[0].tangential;
  ASSERT_EQ(kt.size(), 10U);
  EXPECT_NEAR((kt[1].force_parallel - kt[0].force_parallel) /
                  ((kt[1].angle_deg - kt[0].angle_deg) * 3.14159265358979 * 0.016 / 180.0),
              40.0, 1e-9);
  text = replaced(kGood, "hn [mm], Fn [mN]", "hn [mm], Fn [mN], ht [mm], Ft [mN]");
  for (const char* row : {"0.8, 0", "1.6, 80", "2.4, 300", "3.2, 800", "4.0, 1500"})
    text = replaced(text, std::string(row) + "\n", std::string(row) + ", , \n");
  const auto sweep = read(text + "4.0, , 0, 0\n4.0, , 0.5, 20\n").samples[0].tangential;
  ASSERT_EQ(sweep.size(), 3U);  // two as measured, one interpolated at 1 degree
  EXPECT_NEAR(sweep[2].angle_deg, 1.0, 1e-12);
  EXPECT_NEAR(sweep[2].force_parallel, 0.02 * 0.2792526803 / 0.5, 1e-9);
}

/// Tangential readings "ht, Ft" at 4 mm of overlap that jitters, after the reading of Fn there; those at an angle.
std::vector<TangentialPoint> readings_at(const ForceCurve& sample, double angle_deg) {
  std::vector<TangentialPoint> out;
  for (const TangentialPoint& p : sample.tangential)
    if (p.angle_deg == angle_deg) out.push_back(p);
  return out;
}

TEST_F(ForceCurveFile, RotationsThatJitterBelongToTheReadingBeforeThem) {
  std::string text = replaced(kGood, "hn [mm], Fn [mN]", "hn [mm], Fn [mN], ht [mm], Ft [mN]");
  for (const char* row : {"0.8, 0", "1.6, 80", "2.4, 300", "3.2, 800", "4.0, 1500"})
    text = replaced(text, std::string(row) + "\n", std::string(row) + ", , \n");
  // 0, 0.5, 1 and 1.5 degree: the chord from 0 to 1.5 is none of 1.
  const ForceCurve jitter =
      read(text + "4.0, , 0, 0\n4.0002, , 0.13963, 6\n4.0004, , 0.27925, 10\n4.0, , 0.41888, 13\n").samples[0];
  for (const TangentialPoint& p : jitter.tangential) EXPECT_EQ(p.delta, jitter.normal.back().delta);
  ASSERT_EQ(readings_at(jitter, 1.0).size(), 1U);
  EXPECT_NEAR(readings_at(jitter, 1.0)[0].force_parallel, 0.01, 1e-6);
  // Two turns with no reading between them stay two, however near they are.
  const ForceCurve two = read(text + "2.0, , 0, 0\n2.0, , 0.3, 10\n2.001, , 0, 0\n2.001, , 0.3, 20\n").samples[0];
  ASSERT_EQ(readings_at(two, 1.0).size(), 2U);
  EXPECT_NE(readings_at(two, 1.0)[0].delta, readings_at(two, 1.0)[1].delta);
}

/// 1 degree is 0.2792527 mm here.
TEST_F(ForceCurveFile, AnglesWrittenWithFewDigitsCount) {
  std::string text = replaced(kGood, "hn [mm], Fn [mN]", "hn [mm], Fn [mN], ht [mm], Ft [mN]");
  for (const char* row : {"0.8, 0", "1.6, 80", "2.4, 300", "3.2, 800", "4.0, 1500"})
    text = replaced(text, std::string(row) + "\n", std::string(row) + ", , \n");
  const ForceCurve rounded = read(text + "4.0, , -0.27925, -9\n4.0, , 0.00002, 1\n4.0, , 0.27925, 11\n").samples[0];
  ASSERT_EQ(readings_at(rounded, 1.0).size(), 1U);
  EXPECT_NEAR(readings_at(rounded, 1.0)[0].force_parallel, 0.011, 1e-12);
  EXPECT_EQ(readings_at(rounded, -1.0).size(), 1U);
  EXPECT_EQ(readings_at(rounded, 0.0).size(), 1U);
  const ForceCurve near = read(text + "4.0, , 0, 0\n4.0, , 0.278, 10\n").samples[0];
  EXPECT_TRUE(readings_at(near, 1.0).empty()) << "0.5 % off is another angle";
}

TEST_F(ForceCurveFile, FilesOfOneExperimentAreJoined) {
  const std::string a = write(kGood, "a.csv");
  const std::string b = write(kGood, "b.csv");
  const std::string c = write(replaced(kGood, "soft-solid", "soft-soft"), "c.csv");
  const auto joined = read_force_curve_files({c, a, b}, {});
  ASSERT_EQ(joined.size(), 2U);
  EXPECT_EQ(joined[0].kind, PairKind::soft_solid);
  EXPECT_EQ(joined[0].samples.size(), 2U);
  EXPECT_EQ(joined[0].samples[1].name, "b");
  const std::string other = write(replaced(kGood, "16 mm", "17 mm"), "d.csv");
  EXPECT_THROW(read_force_curve_files({a, other}, {}), InputError);
  EXPECT_THROW(read_force_curve_files({a, a}, {}), InputError);
  const std::filesystem::path path(a);
  EXPECT_THROW(read_force_curve_files({a, (path.parent_path() / "." / path.filename()).string()}, {}), InputError);
}

/// A file is named for what it says itself.
TEST_F(ForceCurveFile, FilesThatContradictEachOtherAreNamed) {
  const std::string a = write(kGood, "a.csv");
  const std::string b = write("# nu = 0.3\n" + std::string(kGood), "b.csv");
  const std::string c = write("# nu = 0.2\n" + std::string(kGood), "c.csv");
  try {
    (void)read_force_curve_files({a, b, c}, {});
    ADD_FAILURE();
  } catch (const InputError& e) {
    EXPECT_TRUE(std::string(e.what()).starts_with(b + " and " + c)) << e.what();
  }
}

TEST_F(ForceCurveFile, StandardErrorsOfSomeFilesAreSaidToBeOfNoUse) {
  const std::string head = "# Rs = 16 mm\n# E = 0.5 MPa\n# kind = soft-solid\n";
  const std::string with =
      write(head + "hn [mm],Fn [N],se [N]\n1,0.1,0.01\n2,0.3,0.01\n3,0.9,0.01\n4,1.8,0.01\n5,3,0.01\n", "with.csv");
  const std::string without = write(head + "hn [mm],Fn [N]\n1,0.1\n2,0.3\n3,0.9\n4,1.8\n5,3\n", "without.csv");
  for (const auto& files : {std::vector{with, without}, std::vector{without, with}}) {
    const auto joined = read_force_curve_files(files, {});
    ASSERT_EQ(joined.size(), 1U);
    EXPECT_FALSE(joined[0].has_errors);
    ASSERT_FALSE(joined[0].remarks.empty());
    EXPECT_EQ(joined[0].remarks.back(), "standard errors of " + with + " are not used: " + without + " gives none");
  }
}

}  // namespace
