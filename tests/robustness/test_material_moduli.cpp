// Materials with several E: what is said over E is over that of the variant.
#include <gtest/gtest.h>

#include "tests/support/every_kind.h"
#include "tests/support/program.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

/// The same packing of grains ten times as stiff bears ten times the stress: over its own E it is the same number.
TEST(MaterialModuli, StressesAreOverTheModulusOfTheirVariant) {
  const TemporaryDirectory directory;
  const std::string text = R"(kind = "material"
[grains]
count = 80
ratio = 1.5
[test]
steps = 2
strain = 0.02
[[variant]]
name = "soft"
E = "1 MPa"
[[variant]]
name = "hard"
E = "10 MPa"
)";
  write_text_atomic(directory.file("scene.toml"), text);
  const ProgramOutcome outcome =
      run_the_program("run '" + directory.file("scene.toml") + "' --threads 1 --out '" + directory.file("out") + "'");
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  std::vector<std::string> stresses;
  for (std::size_t at = outcome.output.find(": axial stress "); at != std::string::npos;
       at = outcome.output.find(": axial stress ", at + 1))
    stresses.push_back(outcome.output.substr(outcome.output.find('(', at),
                                             outcome.output.find('E', at) - outcome.output.find('(', at)));
  ASSERT_EQ(stresses.size(), 2U) << outcome.output;
  EXPECT_EQ(stresses[0], stresses[1]) << outcome.output;
  const nlohmann::json summary = summary_of(directory.file("out"));
  EXPECT_FALSE(summary.contains("E")) << "there is none of all";
  EXPECT_EQ(summary["variants"][0]["E"], 1e6);
  EXPECT_EQ(summary["variants"][1]["E"], 1e7);
}

}  // namespace
