// The built program from outside.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "common/io/text_file.h"

namespace softgrain::test {

struct ProgramOutcome {
  int status = -1;
  std::string output;  ///< standard output and, unless it goes elsewhere, standard error
};

/// `errors`: where standard error goes.
inline ProgramOutcome run_the_program(const std::string& arguments, const std::string& errors = "&1") {
  const std::string line = std::string("'") + SOFTGRAIN_PROGRAM + "' " + arguments + " 2>" + errors + " </dev/null";
  ProgramOutcome outcome;
  FILE* pipe = ::popen(line.c_str(), "r");
  if (pipe == nullptr) return outcome;
  std::array<char, 4096> buffer{};
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe))
    outcome.output.append(buffer.data(), n);
  const int status = ::pclose(pipe);
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

/// summary.json of a run.
inline nlohmann::json summary_of(const std::string& directory) {
  return nlohmann::json::parse(read_text(directory + "/summary.json"));
}

/// Runs `microsim SCENE --out DIRECTORY more`; expects success and returns the summary.
inline nlohmann::json run_scene(const std::string& scene, const std::string& directory, const std::string& more = "") {
  const ProgramOutcome outcome =
      run_the_program("microsim '" + scene + "' --out '" + directory + "' --quiet --threads 1 " + more);
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  if (outcome.status != 0) return nlohmann::json::object();
  return summary_of(directory);
}

}  // namespace softgrain::test
