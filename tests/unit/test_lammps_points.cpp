// The table of points that LAMMPS writes during a test, and where a run goes on after it.
#include <gtest/gtest.h>

#include <filesystem>

#include "common/core/error.h"
#include "common/io/text_file.h"
#include "macrosim/lammps_run/input_script.h"
#include "macrosim/lammps_run/lammps_curve.h"
#include "tests/support/lammps_files.h"
#include "tests/support/temporary_directory.h"

namespace softgrain {
namespace {

using lammps::Point;
using lammps::PointRow;
using test::overwrite;
using test::point_row;
using test::with;

class Tables : public ::testing::Test {
 protected:
  [[nodiscard]] std::string points() const { return directory_.file(lammps::kPointsFile); }
  [[nodiscard]] std::string copy() const { return directory_.file(lammps::kPointsCopy); }
  [[nodiscard]] std::vector<PointRow> read() const { return lammps::read_points(directory_.path(), "key"); }
  void write(std::size_t count) {
    std::vector<PointRow> rows;
    for (double k = 0.0; k < static_cast<double>(count); k += 1.0) rows.push_back(point_row(k, 0.1 * k));
    lammps::write_points(directory_.path(), "key", rows);
  }

  test::TemporaryDirectory directory_;
};

TEST_F(Tables, ReadBackWhatWasWritten) {
  EXPECT_TRUE(read().empty());
  write(3);
  const auto rows = read();
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[2].values, point_row(2.0, 0.2).values);
  EXPECT_EQ(lammps::count_points(directory_.path()), 3);
  EXPECT_THROW((void)lammps::read_points(directory_.path(), "another"), InputError);
}

TEST_F(Tables, ColumnsOfTheSceneComeAfterThoseOfEveryTest) {
  const std::vector<std::string> names{"rattlers", "coarse-coarse_0.5"};
  PointRow row = point_row(0.0, 0.0);
  row.more = {3.0, 1.0 / 3.0};
  lammps::write_points(directory_.path(), "key", {row}, names);
  const auto rows = lammps::read_points(directory_.path(), "key", names);
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].more, row.more);
  EXPECT_EQ(rows[0].values, row.values);
  EXPECT_THROW((void)read(), IoError);
}

/// Cut at any place, a table gives the rows before or is refused; it never gives others.
TEST_F(Tables, CutShortAnywhereIsNoticed) {
  write(3);
  const std::string whole = read_text(points());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    overwrite(points(), whole.substr(0, size));
    try {
      EXPECT_LE(read().size(), 2U) << size;
    } catch (const IoError&) {
    }
  }
}

TEST_F(Tables, AnyDamagedByteIsNoticed) {
  write(2);
  const std::string whole = read_text(points());
  const auto expected = read();
  for (const std::string& path : {points(), copy()})
    for (std::size_t k = 0; k < whole.size(); ++k) {
      std::string damaged = whole;
      damaged[k] = static_cast<char>(damaged[k] ^ 1);
      overwrite(path, damaged);
      try {
        const auto rows = read();
        // The last line may count as being written.
        ASSERT_LT(rows.size(), 2U) << k << " of " << path;
      } catch (const Error&) {
      }
      overwrite(path, whole);
    }
}

TEST_F(Tables, RowsThatComeAgainReplaceThoseBefore) {
  write(3);
  std::string text = read_text(points());
  const std::size_t row = text.find("\n1 ") + 1;
  text += text.substr(row, text.find('\n', row) + 1 - row);
  overwrite(points(), text);
  overwrite(copy(), text);
  EXPECT_EQ(read().size(), 2U);
}

TEST_F(Tables, GapsAndOtherWordsAreRefused) {
  const auto refused = [&](const std::string& from, const std::string& to) {
    write(3);
    std::string text = read_text(points());
    text.replace(text.find(from), from.size(), to);
    overwrite(points(), text);
    overwrite(copy(), text);
    EXPECT_THROW((void)read(), IoError) << to;
  };
  refused("\n1 ", "\n5 ");
  refused("\n1 ", "\nnan ");
  refused("\n1 ", "\none ");
  refused("\n1 0.1 ", "\n1 ");
  refused("# softgrain points 3", "# softgrain points 9");
}

/// A run that an earlier version began is taken up as it is: its script is there too, and writes rows of its time.
TEST_F(Tables, OfAnEarlierVersionAreReadAndGoneOnWith) {
  PointRow row = with(with(point_row(0.0, 0.0), Point::residual, 0.004), Point::end, 2.0);
  row.earlier = true;
  lammps::write_points(directory_.path(), "key", {row, with(row, Point::number, 1.0)});
  const std::string text = read_text(points());
  EXPECT_TRUE(text.starts_with("# softgrain points 2, scene key\n"));
  EXPECT_EQ(text.find("unrest"), std::string::npos);
  const auto rows = read();
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_TRUE(rows[1].earlier);
  EXPECT_EQ(rows[1][Point::over], row[Point::over]);
  EXPECT_EQ(rows[1][Point::unrest], 0.004);
  EXPECT_EQ(rows[1][Point::unrest_end], 2.0);
}

/// Test of four points, with tables and restart files as a run leaves them.
class Resume : public Tables {
 protected:
  void touch(const std::string& name) const { overwrite(directory_.file(name), "x"); }
  [[nodiscard]] lammps::ResumePoint find() const { return lammps::find_resume_point(directory_.path(), "key", 4); }
  using Words = std::vector<std::string>;
};

TEST_F(Resume, GoesOnAfterTheLastPointThatHasARestartFile) {
  EXPECT_TRUE(find().settings.empty());
  write(3);
  EXPECT_TRUE(find().settings.empty()) << "no restart file";
  write(3);
  touch("restart.1");
  EXPECT_EQ(find().settings, (Words{"-var", "from", "1"}));
  EXPECT_EQ(read().size(), 2U);
  write(3);
  touch("restart.2");
  EXPECT_EQ(find().settings, (Words{"-var", "from", "2"}));
}

TEST_F(Resume, IsDoneWhenTheLastStateIsThere) {
  write(4);
  touch("restart.3");
  EXPECT_EQ(find().settings, (Words{"-var", "from", "3"}));
  touch(lammps::kEndFile);
  EXPECT_TRUE(find().done);
}

TEST_F(Resume, ATestThatEndedEarlyDoesNotGoBeyond) {
  lammps::write_points(directory_.path(), "key", {point_row(0, 0), with(point_row(1, 0.1), Point::law_refused, 2.0)});
  touch("restart.0");
  touch("restart.1");
  EXPECT_EQ(find().settings, (Words{"-var", "from", "0"}));
  lammps::write_points(directory_.path(), "key", {point_row(0, 0), with(point_row(1, 0.1), Point::law_refused, 2.0)});
  touch(lammps::kEndFile);
  EXPECT_TRUE(find().done);
}

TEST_F(Resume, GoesOnWithinTheCompaction) {
  overwrite(directory_.file(lammps::kCompactionFile), "# head\n1 128 2000 1 0 5 1\n2 89.6 0 1 0 5 1\n3 62.7 0 1");
  touch("restart.compaction.1");
  touch("restart.compaction.2");
  touch("restart.compaction.3");
  EXPECT_EQ(find().settings,
            (Words{"-var", "round_done", "2", "-var", "next_pressure", "89.6", "-var", "passes_under", "0"}));
  EXPECT_NEAR(lammps::compaction_share(directory_.path()), 0.7 - 0.3 * std::log(89.6) / std::log(128.0 / 0.7), 1e-12);
  touch(lammps::kTouchingFile);
  EXPECT_EQ(find().settings, (Words{"-var", "prepared", "1"}));
  EXPECT_EQ(lammps::compaction_share(directory_.path()), 1.0);
}

}  // namespace
}  // namespace softgrain
