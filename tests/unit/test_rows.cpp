// Members of records side by side in a data set: the order of the columns, one form for whole numbers and one for
// others, and what does not fit is refused.
#include "common/data/rows.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "common/core/vec.h"
#include "tests/support/temporary_directory.h"

namespace softgrain::rows_test {

enum class Side : std::int32_t { left, right };

struct Thing {
  Vec3 place{};
  double size = 0.0;
  bool open = false;
  Side side = Side::left;
  std::array<std::int32_t, 2> key{};

  bool operator==(const Thing&) const = default;
};

constexpr auto kNumbers = [](auto&& visit, auto& t) {
  visit(t.place);
  visit(t.size);
};
constexpr auto kMarks = [](auto&& visit, auto& t) {
  visit(t.open);
  visit(t.side);
  visit(t.key);
};
constexpr auto kSize = [](auto&& visit, auto& t) { visit(t.size); };

const std::vector<Thing> kThings{{{{1.0, 2.0, 3.0}}, 4.0, true, Side::right, {5, -6}},
                                 {{{0.1, 0.2, 0.3}}, 0.4, false, Side::left, {7, 8}}};

class Rows : public testing::Test {
 protected:
  [[nodiscard]] h5::Group written() const {
    h5::AtomicFile file(directory_.file("rows.h5"));
    const h5::Group root = file.root();
    write_rows(root, "numbers", kThings, kNumbers);
    write_rows(root, "marks", kThings, kMarks);
    write_rows(root, "size", kThings, kSize);
    write_row(root, "one", kThings.front(), kNumbers);
    file.commit();
    return h5::open_file(directory_.file("rows.h5"));
  }

  test::TemporaryDirectory directory_;
};

TEST_F(Rows, StandInTheOrderOfTheList) {
  const h5::Group root = written();
  EXPECT_EQ(root.doubles("numbers"), (std::vector<double>{1.0, 2.0, 3.0, 4.0, 0.1, 0.2, 0.3, 0.4}));
  EXPECT_EQ(root.integers("marks"), (std::vector<std::int64_t>{1, 1, 5, -6, 0, 0, 7, 8}));
  EXPECT_EQ(root.shape("numbers"), (h5::Shape{2, 4}));
  EXPECT_EQ(root.shape("size"), (h5::Shape{2}));
  EXPECT_EQ(root.shape("one"), (h5::Shape{4}));
}

TEST_F(Rows, AreReadBack) {
  const h5::Group root = written();
  auto things = records_in_rows<Thing>(root, "marks", kMarks);
  EXPECT_NE(things, kThings);
  read_rows(root, "numbers", things, kNumbers);
  EXPECT_EQ(things, kThings);
  Thing one;
  read_row(root, "one", one, kNumbers);
  EXPECT_EQ(one.place, kThings.front().place);
  EXPECT_EQ(one.size, 4.0);
}

std::string complaint(const std::function<void()>& read) {
  try {
    read();
  } catch (const IoError& e) {
    return e.what();
  }
  return "";
}

TEST_F(Rows, OfAnotherLengthAreRefused) {
  const h5::Group root = written();
  std::vector<Thing> three(3);
  EXPECT_EQ(complaint([&] { read_rows(root, "numbers", three, kNumbers); }), "'numbers' has a wrong length");
  EXPECT_EQ(complaint([&] {
              (void)records_in_rows<Thing>(root, "marks", [](auto&& visit, auto& t) {
                visit(t.key);
                visit(t.open);
              });
            }),
            "'marks' has a wrong length");
}

TEST(RowsOfNumbers, ThatAMemberCannotHoldAreRefused) {
  std::vector<Thing> one(1);
  const std::vector<std::int64_t> marks{1, 0, std::int64_t{1} << 32, 0};
  EXPECT_EQ(complaint([&] { take_rows(marks, one, kMarks, "marks"); }), "'marks' holds a number out of range");
}

/// Whole members beside others stand in a file as numbers with a fraction.
TEST(RowsOfNumbers, ThatAWholeMemberCannotHoldAreRefusedInMixedRowsToo) {
  constexpr auto kMixed = [](auto&& visit, auto& t) {
    visit(t.size);
    visit(t.side);
    visit(t.key);
  };
  std::vector<Thing> one(1);
  take_rows(std::vector<double>{0.5, 1.0, -2147483648.0, 2147483647.0}, one, kMixed, "mixed");
  EXPECT_EQ(one.front().key, (std::array<std::int32_t, 2>{-2147483647 - 1, 2147483647}));
  for (const double bad : {2147483648.0, -2147483649.0, 1e300, std::nan("")})
    EXPECT_EQ(complaint([&] {
                take_rows(std::vector<double>{0.5, 1.0, bad, 0.0}, one, kMixed, "mixed");
              }),
              "'mixed' holds a number out of range")
        << bad;
}

}  // namespace softgrain::rows_test
