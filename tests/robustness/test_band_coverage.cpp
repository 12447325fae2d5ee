// How much of resolved twins that no law has seen lies in the error bars of macro runs.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/data/macro_band.h"
#include "common/io/text_file.h"
#include "pipelines/compare/compare.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"

namespace softgrain {
namespace {

using test::run_the_program;
using test::TemporaryDirectory;

struct Coverage {
  int twins = 0;
  double ends = 0.0;           ///< share of twins whose last axial stress lies in the band
  double points = 0.0;         ///< share of points, mean over twins
  double law_over_twin = 0.0;  ///< of the last axial stress, geometric mean
};

/// Of a comparison of kind "macro-comparison" with resolved twins.
Coverage coverage_of(const std::string& run, LawForm form) {
  Coverage out;
  double logarithm = 0.0;
  const auto told = nlohmann::json::parse(read_text(run + "/comparison.json"));
  for (const auto& scene : told["scenes"]) {
    const auto curves = load_macro(run + "/macro_" + scene["name"].get<std::string>() + ".h5");
    for (const MacroCurve& twin : curves_of(curves, "shelled"))
      for (const MacroCurve& law : curves_of(curves, to_string(form)))
        if (law.sample == twin.sample) {
          out.ends += share_in_band(law, twin, true);
          out.points += share_in_band(law, twin, false);
          logarithm += std::log(law.stress_axial.back() / twin.stress_axial.back());
          ++out.twins;
        }
  }
  out.ends /= out.twins;
  out.points /= out.twins;
  out.law_over_twin = std::exp(logarithm / out.twins);
  return out;
}

std::string source(const std::string& path) { return std::string(SOFTGRAIN_SOURCE_DIR) + "/" + path; }

/// 40 twins of other seeds, sizes, shares and tests than those of results/macro_vs_resolved: what of them lies in the
/// error bars of the shipped table.
TEST(SlowCoverage, ErrorBarsHoldOverTwinsThatNoLawHasSeen) {
  const TemporaryDirectory directory;
  const std::string out = directory.file("coverage");
  const auto done =
      run_the_program("run '" + source("tests/robustness/coverage.toml") + "' --quiet --out '" + out + "'");
  ASSERT_EQ(done.status, 0) << done.output;
  for (const LawForm form : {LawForm::isotropic, LawForm::directional}) {
    const Coverage found = coverage_of(out, form);
    ASSERT_EQ(found.twins, 40);
    RecordProperty(to_string(form) + "_ends", std::to_string(found.ends));
    RecordProperty(to_string(form) + "_points", std::to_string(found.points));
    // Measured: bag, the form that the table takes, 98 % of points and of ends; directional 89 and 95 %
    // (results/macro_vs_resolved).
    const double least = form == LawForm::isotropic ? 0.92 : 0.85;
    EXPECT_GE(found.ends, least) << to_string(form);
    EXPECT_GE(found.points, least) << to_string(form);
  }
}

/// Ten twins of a material that is not in the library (mu = 0.5, r^-3, ratio 6, solid fraction 0.641) beside the law
/// that the library gives for it. Measured: law over twin 0.91, 91 % of the points and all ends in the band
/// (results/law_library).
TEST(SlowCoverage, TheLibraryServesAMaterialThatItHasNot) {
  const TemporaryDirectory directory;
  const std::string out = directory.file("coverage");
  const auto done = run_the_program("run '" + source("results/law_library/coverage.toml") +
                                    "' --set law.library.solid_fraction=0.641 --quiet --out '" + out + "'");
  ASSERT_EQ(done.status, 0) << done.output;
  const Coverage found = coverage_of(out, LawForm::isotropic);
  ASSERT_EQ(found.twins, 10);
  RecordProperty("law_over_twin", std::to_string(found.law_over_twin));
  RecordProperty("points", std::to_string(found.points));
  EXPECT_NEAR(found.law_over_twin, 1.0, 0.2);
  EXPECT_GE(found.points, 0.85);
  EXPECT_GE(found.ends, 0.9);
}

}  // namespace
}  // namespace softgrain
