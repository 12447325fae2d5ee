#include "common/io/toml.h"

#include <gtest/gtest.h>

#include <string>

namespace {

using softgrain::line_of_long_key;

TEST(TomlKeys, PartsAreCountedPerKey) {
  EXPECT_EQ(line_of_long_key("a.b.c = 1\n", 3), 0u);
  EXPECT_EQ(line_of_long_key("a.b.c.d = 1\n", 3), 1u);
  EXPECT_EQ(line_of_long_key("[x]\n\n[a.b . c.d]\n", 3), 3u);
  EXPECT_EQ(line_of_long_key("y = 1\nx = { a.b.c.d = 1 }\n", 3), 2u);
  EXPECT_EQ(line_of_long_key("\"a\".'b'.\"c\".d = 1\n", 3), 1u);
}

TEST(TomlKeys, NumbersTextAndCommentsAreNoKeys) {
  EXPECT_EQ(line_of_long_key("x = [0.1, 0.2, 0.3, 0.4, 0.5]\n", 3), 0u);
  EXPECT_EQ(line_of_long_key("x = \"a.b.c.d.e\" # ......\n", 3), 0u);
  EXPECT_EQ(line_of_long_key("# don't ....\nx = 'it\\'\ny = 'a.b.c.d'\n", 3), 0u);
  EXPECT_EQ(line_of_long_key("x = \"\\\"a.b.c.d\"\n", 3), 0u);
  EXPECT_EQ(line_of_long_key("", 3), 0u);
}

TEST(TomlKeys, TextOfManyLinesEndsWithThreeMarks) {
  EXPECT_EQ(line_of_long_key("x = \"\"\"\na\"b.c.d.e\n\\\n\"\"\"\na.b.c.d = 1\n", 3), 5u);
  EXPECT_EQ(line_of_long_key("x = '''\n'a.b.c.d\n'''\n", 3), 0u);
  EXPECT_EQ(line_of_long_key("x = \"open\na.b.c.d = 1\n", 3), 2u);
}

}  // namespace
