// What softgrain check says of a scene or a file, as facts.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "common/io/text_file.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"

namespace softgrain::test {

class Check : public ::testing::Test {
 protected:
  nlohmann::json facts(const std::string& path, const std::string& more = "") {
    const ProgramOutcome outcome = run_the_program("check '" + path + "' --json " + more);
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    return outcome.status == 0 ? nlohmann::json::parse(outcome.output) : nlohmann::json::object();
  }
  nlohmann::json scene_facts(const std::string& text, const std::string& more = "") {
    write_text_atomic(directory_.file("scene.toml"), text);
    const nlohmann::json found = facts(directory_.file("scene.toml"), more);
    EXPECT_EQ(
        std::distance(std::filesystem::directory_iterator(directory_.path()), std::filesystem::directory_iterator()),
        1);
    return found;
  }
  static bool warned(const nlohmann::json& facts, const std::string& words) {
    const auto& all = facts["warnings"];
    return std::any_of(all.begin(), all.end(),
                       [&](const nlohmann::json& w) { return w.get<std::string>().find(words) != std::string::npos; });
  }
  static std::string macro(const std::string& law, const std::string& more) {
    return "kind = \"macro\"\n" + (law.empty() ? "" : "law = \"" + law + "\"\n") + "[macro]\nresolved = false\n" + more;
  }

  TemporaryDirectory directory_;
};

}  // namespace softgrain::test
