// Files that earlier versions wrote stay readable and say the same numbers: tests/reference/earlier has run directories
// of the tiny scene of several kinds, and in numbers.json what `softgrain compare` of the version that wrote them said.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/io/text_file.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"

namespace softgrain::test {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> earlier_runs() {
  std::vector<std::string> out;
  for (const auto& version : fs::directory_iterator(std::string(SOFTGRAIN_REFERENCE_DIR) + "/earlier"))
    for (const auto& run : fs::directory_iterator(version.path())) out.push_back(run.path().string());
  std::sort(out.begin(), out.end());
  return out;
}

class EarlierFiles : public testing::TestWithParam<std::string> {
 protected:
  /// A copy that reports may be written into.
  EarlierFiles() { fs::copy(GetParam(), run(), fs::copy_options::recursive); }
  [[nodiscard]] std::string run() const { return directory_.file("run"); }
  [[nodiscard]] std::string file(const std::string& name) const { return directory_.file(name); }

 private:
  TemporaryDirectory directory_;
};

TEST_P(EarlierFiles, SayTheSameNumbers) {
  const ProgramOutcome outcome =
      run_the_program("compare '" + run() + "' '" + run() + "' --json --quiet --out '" + file("comparison") + "'");
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  const auto said = nlohmann::json::parse(outcome.output.substr(outcome.output.find('{')));
  const auto numbers = nlohmann::json::parse(read_text(run() + "/numbers.json"));
  EXPECT_GE(numbers.size(), 3u);
  for (const auto& [place, number] : numbers.items()) {
    const nlohmann::json::json_pointer at(place);
    ASSERT_TRUE(said.contains(at)) << place;
    EXPECT_NEAR(said[at].get<double>(), number.get<double>(), 1e-12 * std::abs(number.get<double>())) << place;
  }
}

TEST_P(EarlierFiles, AreCheckedAndReported) {
  const ProgramOutcome reported = run_the_program("report '" + run() + "'");
  EXPECT_EQ(reported.status, 0) << reported.output;
  EXPECT_NE(read_text(run() + "/report.html").find("<svg"), std::string::npos);
  for (const auto& entry : fs::directory_iterator(GetParam())) {
    const std::string kind = entry.path().extension();
    if (kind != ".h5" && kind != ".toml") continue;
    const ProgramOutcome checked = run_the_program("check '" + entry.path().string() + "'");
    EXPECT_EQ(checked.status, 0) << entry.path() << checked.output;
  }
}

INSTANTIATE_TEST_SUITE_P(Runs, EarlierFiles, testing::ValuesIn(earlier_runs()), [](const auto& named) {
  std::string name = fs::path(named.param).filename().string();
  for (char& c : name)
    if (c == '-') c = '_';
  return name;
});

}  // namespace
}  // namespace softgrain::test
