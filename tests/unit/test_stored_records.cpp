// Records as data sets and attributes of HDF5 files and back, by one list of their members.
#include <gtest/gtest.h>

#include <cmath>

#include "common/data/attributes.h"
#include "tests/support/hdf5_edit.h"
#include "tests/support/temporary_directory.h"

namespace softgrain::stored_records_test {

enum class Phase { loose, dense };

struct Row {
  Phase phase = Phase::loose;
  Vec3 place{};
  Vec3 pull{};
  double open = 0.0;
  std::int32_t count = 0;
  double added = 0.25;  ///< as files without it have it
};

void fields(auto&& visit, Of<Row> auto& r, const std::string& length) {
  visit("phase", r.phase, "1", UpTo{Phase::dense, "an unknown phase"});
  visit("place", r.place, length, kAsRows);
  visit("pull", r.pull, "N");
  visit("open", r.open, "1", Limits::anything());
  visit("count", r.count, "1", Limits{0.0, 9.0});
  visit("added", r.added, "1", kLater);
}

struct Head {
  std::string title;
  std::string remark;
  double known = NAN;
  double unknown = NAN;
  bool flag = false;
  std::int32_t whole = 0;
  std::optional<double> maybe;
  double added = 0.25;
};

void fields(auto&& visit, Of<Head> auto& h) {
  visit("title", h.title);
  visit("remark", h.remark, kIfAny);
  visit("known", h.known, kIfAny, Limits{});
  visit("unknown", h.unknown, kIfAny);
  visit("flag", h.flag);
  visit("whole", h.whole, Limits{0.0, 9.0});
  visit("maybe", h.maybe);
  visit("added", h.added, kLater);
}

class StoredRecords : public testing::Test {
 protected:
  void write(const std::vector<Row>& rows, const Head& head) {
    h5::AtomicFile file(path_);
    write_records(file.root(), rows, std::string("mm"));
    write_attributes(file.root(), head);
    file.commit();
  }
  [[nodiscard]] std::vector<Row> rows(std::size_t count) const {
    std::vector<Row> out(count);
    read_records(h5::open_file(path_), out, std::string("mm"));
    return out;
  }
  [[nodiscard]] Head head() const {
    Head out;
    read_attributes(h5::open_file(path_), out);
    return out;
  }
  void expect_refused(const std::string& part) const {
    try {
      (void)rows(2);
      ADD_FAILURE() << part;
    } catch (const IoError& e) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
  }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  test::TemporaryDirectory directory_;
  std::string path_ = directory_.file("r.h5");
};

const std::vector<Row> kRows{{Phase::dense, {{1.0, 2.0, 3.0}}, {{4.0, 5.0, 6.0}}, NAN, 7, 8.0},
                             {Phase::loose, {{9.0, 8.0, 7.0}}, {{6.0, 5.0, 4.0}}, 3.0, 2, 1.0}};

TEST_F(StoredRecords, EveryMemberComesBack) {
  write(kRows, {"a title", "", 0.5, NAN, true, 7, 0.125, 2.0});
  const h5::Group root = h5::open_file(path());
  EXPECT_EQ(root.shape("place"), (h5::Shape{2, 3}));
  EXPECT_EQ(root.text_of("place", "unit"), "mm");
  EXPECT_EQ(root.doubles("pull_y"), (std::vector<double>{5.0, 5.0}));
  const std::vector<Row> back = rows(2);
  EXPECT_EQ(back[0].phase, Phase::dense);
  EXPECT_EQ(back[1].place, kRows[1].place);
  EXPECT_EQ(back[0].pull, kRows[0].pull);
  EXPECT_TRUE(std::isnan(back[0].open));
  EXPECT_EQ(back[1].count, 2);
  EXPECT_EQ(back[0].added, 8.0);
  EXPECT_FALSE(root.has_attribute("remark") || root.has_attribute("unknown"));
  const Head h = head();
  EXPECT_EQ(h.title, "a title");
  EXPECT_EQ(h.known, 0.5);
  EXPECT_TRUE(std::isnan(h.unknown) && h.flag);
  EXPECT_EQ(h.whole, 7);
  EXPECT_EQ(h.maybe, 0.125);
  EXPECT_EQ(h.added, 2.0);
}

TEST_F(StoredRecords, WhatEarlierFilesLackKeepsItsDefault) {
  write(kRows, {"a title", "said", NAN, NAN, false, 0, std::nullopt, 2.0});
  {
    test::Hdf5Edit edit(path());
    edit.remove("added");
    edit.remove_attribute("/", "added");
  }
  EXPECT_EQ(rows(2)[1].added, 0.25);
  EXPECT_EQ(head().added, 0.25);
  EXPECT_EQ(head().remark, "said");
  EXPECT_FALSE(head().maybe.has_value());
  test::Hdf5Edit(path()).remove_attribute("/", "title");
  EXPECT_THROW((void)head(), IoError);
}

TEST_F(StoredRecords, DamageIsFound) {
  write(kRows, {});
  EXPECT_THROW((void)rows(3), IoError);
  test::Hdf5Edit(path()).set("count", 1, 10);
  expect_refused("'count' holds 10 in row 1");
  test::Hdf5Edit(path()).set("phase", 0, 2);
  expect_refused("an unknown phase");
  write(kRows, {});
  test::Hdf5Edit(path()).set("place", 4, NAN);
  expect_refused("'place' holds a number that is not finite, in row 1");
  test::Hdf5Edit(path()).set_attribute("/", "whole", 10LL);
  EXPECT_THROW((void)head(), IoError);
}

}  // namespace softgrain::stored_records_test
