// Files of spheres: numbers as other programs write them.
#include "microsim/particles/scene_bodies.h"

#include <gtest/gtest.h>

#include "common/core/error.h"
#include "common/io/text_file.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;

TEST(XyzrFile, PlusSignsAreRead) {
  const test::TemporaryDirectory directory;
  const std::string path = directory.file("a.xyzr");
  write_text_atomic(path, "+2 +1 1.0 1\r\n+0.01 -0.02 +.3 +1e-3\r\n1 2 3 4\r\n");
  const XyzrFile file = read_xyzr(path);
  ASSERT_EQ(file.radius.size(), 2U);
  EXPECT_EQ(file.position[0], (Vec3{{0.01, -0.02, 0.3}}));
  EXPECT_EQ(file.radius[0], 1e-3);
  for (const char* wrong : {"+-0.01", "++1", "+"}) {
    write_text_atomic(path, std::string("1 1 1 1\n") + wrong + " 0 0 1\n");
    EXPECT_THROW((void)read_xyzr(path), InputError) << wrong;
  }
}

/// Columns of a fixed width that have grown together would give other numbers.
TEST(XyzrFile, NumbersWithoutABlankBetweenThemAreRefused) {
  const test::TemporaryDirectory directory;
  const std::string path = directory.file("a.xyzr");
  for (const char* wrong : {"1.25001.5000 2.0 0.25", "1.0-2.0 3.0 0.25", "1.0,2.0 3.0 0.25", "1.0 2.0 3.0 0.25x"}) {
    write_text_atomic(path, std::string("1 1 1 1\n") + wrong + "\n");
    try {
      (void)read_xyzr(path);
      ADD_FAILURE() << wrong;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find(":2: must be four numbers with blanks"), std::string::npos) << e.what();
    }
  }
}

}  // namespace
