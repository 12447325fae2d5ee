// Files that tests of law tables begin with, and runs of macro scenes on them.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/contact/make_laws.h"
#include "common/data/macro_result.h"
#include "common/io/text_file.h"
#include "tests/support/program.h"
#include "tests/support/synthetic_multi_contact.h"
#include "tests/support/synthetic_run.h"
#include "tests/support/temporary_directory.h"

namespace softgrain::test {

inline constexpr const char* kMacroOfATable = R"(kind = "macro"
title = "tiny"
law = "law_table.toml"
[macro]
bodies = 12
steps = 3
strain = 0.2
resolved = false
)";

/// A directory with a card, a table of one entry and a macro scene of the table.
class LawTableFiles : public ::testing::Test {
 protected:
  LawTableFiles() {
    save_card(synthetic::card(), file("law.toml"));
    save_law_table({1, {synthetic::law_entry(0.70)}}, file("law_table.toml"));
    write_text_atomic(file("scene.toml"), kMacroOfATable);
  }
  [[nodiscard]] std::string file(const std::string& name) const { return directory_.file(name); }
  [[nodiscard]] nlohmann::json summary(const std::string& name) const {
    return nlohmann::json::parse(read_text(file(name) + "/summary.json"));
  }
  /// macrosim of the scene with these top-level lines.
  ProgramOutcome macro(const std::string& name, const std::string& lines, const std::string& more = "") {
    std::string text = kMacroOfATable;
    text.insert(text.find("[macro]"), lines);
    write_text_atomic(file("scene.toml"), text);
    return run_the_program("macrosim '" + file("scene.toml") + "' --quiet --out '" + file(name) + "' " + more);
  }
  double end_stress(const std::string& name) { return load_macro(file(name) + "/macro.h5").at(0).stress_axial.back(); }

  static void expect(const ProgramOutcome& outcome, int status, const std::vector<std::string>& words) {
    EXPECT_EQ(outcome.status, status) << outcome.output;
    for (const std::string& word : words)
      EXPECT_NE(outcome.output.find(word), std::string::npos) << word << " not in " << outcome.output;
  }

  TemporaryDirectory directory_;
};

}  // namespace softgrain::test
