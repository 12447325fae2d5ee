// Tables as text: encodings, line ends and additions of spreadsheets, and comments that name a value.
#include "common/io/csv_file.h"

#include <gtest/gtest.h>

#include "common/core/error.h"
#include "common/io/text_file.h"

namespace {

using namespace softgrain;

/// In UTF-16, with or without its mark.
std::string utf16(const std::string& ascii, bool low_first, bool mark) {
  std::string out = !mark ? "" : low_first ? "\xff\xfe" : "\xfe\xff";
  for (const char c : ascii) out += low_first ? std::string{c, '\0'} : std::string{'\0', c};
  return out;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

constexpr const char* kTable = "# Rs = 16 mm\nhn [mm];Fn [N]\n0,5;1\n1,5;2\n";

void expect_table(const std::string& bytes, const std::string& what) {
  const CsvFile csv = CsvFile::parse(bytes, "t.csv");
  ASSERT_EQ(csv.columns().size(), 2U) << what;
  ASSERT_EQ(csv.rows().size(), 2U) << what;
  EXPECT_EQ(csv.number(csv.rows()[1], 0, Unit::length), 0.0015) << what;
  EXPECT_EQ(csv.number(csv.rows()[1], 1, Unit::force), 2.0) << what;
  EXPECT_EQ(csv.quantity({"rs"}, Unit::length, Range::positive()), 0.016) << what;
}

TEST(CsvFile, WhatSpreadsheetsWriteIsRead) {
  expect_table(kTable, "plain");
  expect_table(std::string("\xef\xbb\xbf") + kTable, "UTF-8 with a mark");
  for (const bool low : {true, false})
    for (const bool mark : {true, false}) expect_table(utf16(kTable, low, mark), "UTF-16");
  expect_table(utf16(replaced(kTable, "\n", "\r\n"), true, true), "UTF-16 with CR LF");
  expect_table(replaced(kTable, "\n", "\r"), "CR alone");
  expect_table(replaced(kTable, "\n", "\r\n"), "CR LF");
  expect_table(std::string("sep=;\n") + kTable, "sep=");
  expect_table(std::string("\"sep=;\"\r\n") + kTable, "sep= in quotes");
  expect_table(replaced(kTable, "\n", ";;\n"), "filled up");
  expect_table(std::string(kTable) + ";;;\n;\n", "empty rows");
  expect_table(replaced(kTable, "# Rs = 16 mm", "\"# Rs = 16 mm\";"), "quoted comment");
  expect_table(replaced(kTable, "# Rs = 16 mm", "# Rs = 16,0 mm"), "decimal comma in a comment");
  expect_table(replaced(kTable, "0,5;1", "0,5 mm;1N"), "units in cells");
  expect_table(replaced(kTable, "0,5;1", "\u22120,5;\u00a01"), "signs of a spreadsheet");
  EXPECT_EQ(CsvFile::parse("sep=\t\na\tb\n1\t2\n", "t").columns().size(), 2U);
  EXPECT_EQ(CsvFile::parse("h [\xb5m],F [N]\n1,2\n", "t").columns()[0].unit, "µm") << "Windows-1252";
}

std::string refusal_of_number(const std::string& bytes, std::size_t row) {
  const CsvFile csv = CsvFile::parse(bytes, "t.csv");
  try {
    (void)csv.number(csv.rows()[row], 1, Unit::force);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

/// Tabs tell no country: a factor of a thousand is not guessed. Semicolons and another cell tell it.
TEST(CsvFile, CommasOfThousandsOrDecimalsAreRefusedInTablesWithTabs) {
  const std::string both = "hn [mm]\tFn [N]\n1\t1,016\n2\t-2,032\n";
  EXPECT_EQ(refusal_of_number(both, 0),
            "t.csv:2: column \"Fn [N]\": \"1,016\" may be 1.016 or 1016: write it without the comma");
  EXPECT_NE(refusal_of_number(both, 1).find("\"-2,032\" may be -2.032 or -2032"), std::string::npos);
  EXPECT_EQ(refusal_of_number(both + "0,5\t3\n", 0), "");
  EXPECT_EQ(refusal_of_number(replaced(both, "\t", ";"), 0), "");
  EXPECT_EQ(refusal_of_number(replaced(both, "1,016", "1,016E+03"), 0), "") << "no thousands have an exponent";
}

/// Forces of 800 N and 1500 N were 800 and 1.5: only another column told that commas are the decimal marks.
TEST(CsvFile, PointsOfThousandsAreRefusedWhereAnotherColumnHasDecimalCommas) {
  for (const std::string mark : {";", "\t"}) {
    const std::string table = "hn [mm]" + mark + "Fn [N]\n0,5" + mark + "800\n1,0" + mark + "1.500\n";
    EXPECT_EQ(refusal_of_number(table, 0), "");
    EXPECT_NE(refusal_of_number(table, 1).find("\"1.500\" may have a sign between thousands"), std::string::npos);
    EXPECT_EQ(refusal_of_number(replaced(table, "800", "0.800"), 1), "") << "the column has decimal points";
  }
}

/// A row does not become a comment because its first cell could not be computed.
TEST(CsvFile, ErrorsOfASpreadsheetAreMissingCells) {
  const CsvFile csv = CsvFile::parse("# free text\na [m];b\n#N/A;1\n#DIV/0!;2\n3;#WERT!\n# 4;5\n1;#VALUE!\n", "t");
  ASSERT_EQ(csv.rows().size(), 4U);
  EXPECT_FALSE(csv.number(csv.rows()[0], 0, Unit::length));
  EXPECT_FALSE(csv.number(csv.rows()[1], 0, Unit::length));
  EXPECT_FALSE(csv.number(csv.rows()[3], 1, Unit::none));
  EXPECT_THROW((void)csv.number(csv.rows()[2], 1, Unit::none), InputError);
}

/// A workbook, an archive or HDF5 under the name of a table was told of cells in line 4.
TEST(CsvFile, BinaryFilesAreSaidToBeSuch) {
  for (const std::string& bytes :
       {std::string("\x89HDF\r\n\x1a\n\0\0\0\0a,b\n1,2\n", 20), std::string("PK\3\4\24\0\0\0\10\0", 10)})
    try {
      (void)CsvFile::parse(bytes, "t.csv");
      ADD_FAILURE() << "accepted";
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find("t.csv: is a binary file, not a table"), std::string::npos) << e.what();
    }
}

TEST(CsvFile, PercentsAreHundredths) {
  const CsvFile csv = CsvFile::parse("a [%],b,c\n60,60%,0.6\n100.0 ,100 %,1\n", "t");
  for (std::size_t k = 0; k < 3; ++k) {
    csv.require_unit(k, Unit::none, "a");
    EXPECT_EQ(csv.number(csv.rows()[0], k, Unit::none), 0.6) << k;
    EXPECT_EQ(csv.number(csv.rows()[1], k, Unit::none), 1.0) << k;
  }
}

TEST(CsvFile, CommentsAreReadInEverySpelling) {
  for (const char* comment :
       {"# Rs = 16 mm", "# Rs: 16 mm", "#Rs=16mm", "# Rs [mm] = 16", "# Rs(mm): 16", "# Rs[cm] = 1.6",
        "# RS [m] = 0.016", "# shell_radius = \"16 mm\"", "# Shell radius (µm) = 16000", "## Rs [mm] = 16 mm",
        "# geometry: Rs = 16 mm", "# E = 1 MPa, Rs = 16 mm", "# Rs: 16 mm; E [MPa] = 1", "# Rs = 0.016", "# Rs 16 mm",
        "# Rs [mm] 16", "# Rs(mm) 16.0"}) {
    const CsvFile csv = CsvFile::parse(std::string(comment) + "\na [m]\n1\n", "t");
    EXPECT_EQ(csv.quantity({"rs", "shell radius"}, Unit::length, Range::positive()), 0.016) << comment;
  }
  for (const char* comment : {"# box [mm] = 0 0 0 80 20 40", "# box [cm] = 0,0,0,8,2,4",
                              "# box[m]: 0 0 0 0.08 0.02 0.04", "# Box (mm) = (0, 0, 0) (80, 20, 40)",
                              "# box [mm] 0 0 0 80 20 40", "# box 0 0 0 0.08 0.02 0.04", "# box = 0 0 0 80 20 40 mm"}) {
    const auto box = CsvFile::parse(std::string(comment) + "\na [m]\n1\n", "t").quantities({"box"}, Unit::length, 6);
    ASSERT_TRUE(box) << comment;
    EXPECT_EQ(*box, (std::vector<double>{0, 0, 0, 0.08, 0.02, 0.04})) << comment;
  }
  const auto named = [](const std::string& comment, const CsvNames& names) {
    return CsvFile::parse(comment + "\na\n1\n", "t").quantity(names, Unit::none, Range::any());
  };
  EXPECT_EQ(named("# Poisson's ratio = 0.3", {"poissons ratio"}), 0.3);
  EXPECT_EQ(named("# \u03bd = 0.3", {"nu"}), 0.3);
  EXPECT_EQ(named("# μ = 0.3", {"mu"}), 0.3);
  EXPECT_EQ(named("# mu [%] = 30", {"mu"}), 0.3);
}

std::string refusal(const std::string& text) {
  try {
    const CsvFile csv = CsvFile::parse(text, "t.csv");
    csv.require_known_comments({{"rs", "radius"}, {"density", "rho"}, {"kind"}}, "a test");
    (void)csv.quantity({"rs", "radius"}, Unit::length, Range::positive());
    (void)csv.quantity({"density", "rho"}, Unit::density, Range::positive());
    (void)csv.word({"kind"});
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(CsvFile, CommentsThatCountForNothingAreRefused) {
  const std::string rows = "\na [m]\n1\n";
  for (const auto& [comment, words] : std::vector<std::pair<std::string, std::string>>{
           {"# radiu [mm] = 16", "t.csv:1: comment \"radiu [mm] = 16\" is not understood; nearest is \"radius\""},
           {"# Radius_mm = 16", "nearest is \"radius\""},
           {"# temperature [C] = 23", "may say rs, density, kind"},
           {"# speed = 1 mm/min", "is not understood"},
           {"# bulk density: 2500 kg/m^3", "nearest is \"density\""},
           {"# Rss [mm] = 16", "nearest is \"rs\""},
           {"# knid = soft-solid", "nearest is \"kind\""},
           {"# radiu [mm] 16", "comment \"radiu [mm] 16\" is not understood; nearest is \"radius\""},
           {"# density, kg/m^3 = 1234", "comment \"density, kg/m^3 = 1234\" is not understood"},
           {"# density of all the grains = 1234", "comment \"density of all the grains = 1234\" is not understood"},
           {"# density := 1234", "nearest is \"density\""},
           {"# E* = 5 MPa", "comment \"E* = 5 MPa\" is not understood"},
           {"# nu, mu = 0.1, 0.9", "comment \"nu, mu = 0.1, 0.9\" is not understood"},
           {"# Rs = 16 mm\n# radius [mm] = 17", "t.csv:2: radius [mm] = 17: contradicts line 1, Rs = 16 mm"},
           {"# kind = a\n# kind = b", "t.csv:2: kind = b: line 1 says a"},
           {"# Rs [m] = 16 mm", "the name says the unit m, the value mm"},
           {"# Rs = 16 Pa", "unknown unit 'Pa'"},
           {"# Rs = 16 17 mm", "must be a number"},
           {"# Rs = -16 mm", "must be above 0"},
           {"# Rs = sixteen", "must be a number"}})
    EXPECT_NE(refusal(comment + rows).find(words), std::string::npos) << comment << "\n" << refusal(comment + rows);
}

TEST(CsvFile, OtherCommentsAreFreeText) {
  const std::string rows = "\na [m]\n1\n";
  for (const char* comment : {"# Date: 2024-03-05", "# date = 5.3.2024", "# Time: 10:32", "# operator = Jane Doe",
                              "# Temperature: 23 C", "# Three particles were pressed: an example, not a measurement",
                              "# note (see page 3): slow", "# a = b = c", "# test 3", "# Rs 16 mm was measured twice",
                              "# pressed at 5 mm/min", "# The force that was read at the end of the test was 3 N",
                              "# Rs = 16 mm\n# radius [cm] = 1.6", "#", "# =", "# :"})
    EXPECT_EQ(refusal(comment + rows), "") << comment;
}

TEST(CsvFile, ColumnsThatCountForNothingAreRefused) {
  const CsvFile csv = CsvFile::parse("id,radius [mm],coutn,comment\n1,2,3,x\n", "t.csv");
  try {
    csv.require_known_columns({"radius", "count"}, "a list of sizes");
    FAIL() << "nothing was refused";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("t.csv:1: column \"coutn\" is not understood; nearest is \"count\""),
              std::string::npos)
        << e.what();
  }
  EXPECT_NO_THROW(csv.require_known_columns({"radius", "coutn"}, "a list of sizes"));
}

TEST(TextEncoding, EveryByteBecomesUtf8) {
  EXPECT_EQ(utf8_of(std::string("\xff\xfe\xe4\x00\x3d\xd8\x00\xde", 8)), "ä\U0001F600");
  EXPECT_EQ(utf8_of("\x80\xe9"), "€é");
  EXPECT_TRUE(is_utf8("ä\U0001F600€"));
  for (const char* wrong : {"\xe4", "\xc0\x80", "\xed\xa0\x80", "\xf5\x80\x80\x80", "\xe2\x82"}) {
    EXPECT_FALSE(is_utf8(wrong));
    EXPECT_TRUE(is_utf8(replaced_utf8(wrong)));
  }
  EXPECT_EQ(replaced_utf8("a\xe4 b"), "a\ufffd b");
}

}  // namespace
