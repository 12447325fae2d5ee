// The example script runs as it stands, and what it says adds up.
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <vector>

#include "tests/lammps/run_ranks.h"
#include "tests/support/temporary_directory.h"

namespace softgrain::test {
namespace {

TEST(Example, SettlesAndIsPressed) {
  const TemporaryDirectory directory;
  for (const char* folder : {"macrosim", "results"})
    std::filesystem::create_directory_symlink(std::string(SOFTGRAIN_SOURCE_DIR "/") + folder,
                                              directory.path() + "/" + folder);
  ASSERT_EQ(run_ranks(1, directory.path(), "-in macrosim/lammps/example/press.in -var press 40000"), 0)
      << read_text(directory.path() + "/screen.txt");
  std::istringstream lines(read_text(directory.path() + "/press.txt"));
  std::string line;
  std::vector<double> force;
  double last_height = 1.0;
  while (std::getline(lines, line)) {
    if (line.rfind('#', 0) == 0) continue;
    std::istringstream words(line);
    double step = 0.0;
    double height = 0.0;
    words >> step >> height >> force.emplace_back();
    EXPECT_LT(height, last_height);
    last_height = height;
  }
  ASSERT_EQ(force.size(), 401U);
  EXPECT_EQ(force.front(), 0.0);  // the lid starts above
  EXPECT_GT(force.back(), 10.0);
  EXPECT_GT(force.back(), 3.0 * force[200]);  // it stiffens
}

}  // namespace
}  // namespace softgrain::test
