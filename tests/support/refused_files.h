// Files that the program must refuse: one line a mistake, the status that says whose fault it is, nothing written.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"

namespace softgrain::test {

/// A folder of its own, and a program that must refuse what is in it.
class RefusedFiles : public ::testing::Test {
 protected:
  void expect(const std::string& arguments, int status, const std::vector<std::string>& words,
              const std::string& name) {
    const ProgramOutcome outcome = run_the_program(arguments);
    EXPECT_EQ(outcome.status, status) << name << ": " << outcome.output;
    for (const std::string& word : words)
      EXPECT_NE(outcome.output.find(word), std::string::npos) << name << ": " << word << " not in: " << outcome.output;
    std::istringstream lines(outcome.output);
    int mistakes = 0;
    for (std::string line; std::getline(lines, line); ++mistakes)
      EXPECT_TRUE(line.starts_with("softgrain: ")) << name << ": " << outcome.output;
    EXPECT_GE(mistakes, 1) << name;
    EXPECT_LE(mistakes, status == 2 ? 21 : 1) << name << ": " << outcome.output;
    EXPECT_TRUE(!std::filesystem::exists(out()) || std::filesystem::is_empty(out())) << name;
    std::filesystem::remove_all(out());
  }
  [[nodiscard]] std::string out() const { return directory_.file("out"); }

  TemporaryDirectory directory_;
};

}  // namespace softgrain::test
