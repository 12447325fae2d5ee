// Fit of the equation of state to the committed mean curves of resolved materials.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "calibrate/equation_of_state_fit.h"
#include "common/io/csv_file.h"

namespace softgrain {
namespace {

/// Mean curves of oedometric tests in results/material/curves.csv, one per variant; points above a pressure p/E.
std::vector<StateCurve> committed_curves(const std::string& preparation, double lowest, double largest_span) {
  const CsvFile csv = CsvFile::read(SOFTGRAIN_SOURCE_DIR "/results/material/curves.csv");
  const auto column = [&](const std::string& title) {
    const auto found =
        std::find_if(csv.columns().begin(), csv.columns().end(), [&](const CsvColumn& c) { return c.title == title; });
    EXPECT_NE(found, csv.columns().end()) << title;
    return static_cast<std::size_t>(found - csv.columns().begin());
  };
  const std::size_t pressure = column("p/E");
  const std::size_t phi = column("solid_fraction");
  const std::string loading = "-oedometric";
  std::vector<StateCurve> out;
  for (const CsvRow& row : csv.rows()) {
    const std::string& name = row.cells[column("variant")];
    if (!name.starts_with(preparation) || !name.ends_with(loading)) continue;
    const std::string material = name.substr(0, name.size() - loading.size());
    const double span = std::stod(material.substr(material.rfind('-') + 1));
    const double p = *csv.number(row, pressure, Unit::none);
    if (span > largest_span || p <= lowest) continue;
    if (out.empty() || out.back().group != material) out.push_back({material, span, {}, {}, {}});
    out.back().phi.push_back(*csv.number(row, phi, Unit::none));
    out.back().pressure.push_back(p);
  }
  return out;
}

/// What results/material/README.md says of the samples; their means lean a little otherwise on K and n, within the
/// intervals there.
TEST(CommittedEquationOfState, IsWhatItsPageSays) {
  const std::vector<double> onsets{0.5827, 0.5953, 0.6159, 0.6414};
  const StateFit all = fit_equation_of_state(committed_curves("", 0.0, 30.0), {StateForm::porosity, 40, 1});
  ASSERT_TRUE(all.usable) << all.message;
  ASSERT_EQ(all.groups.size(), 15U);
  EXPECT_NEAR(all.modulus.value, 0.0524, 0.0524 - 0.0500);
  EXPECT_NEAR(all.exponent.value, 1.95, 0.02);
  std::vector<double> found;
  for (const StateGroup& g : all.groups)
    if (g.name.starts_with("fast") && g.span <= 6.0) found.push_back(g.onset.value);
  ASSERT_EQ(found.size(), onsets.size());
  for (std::size_t k = 0; k < onsets.size(); ++k) EXPECT_NEAR(found[k], onsets[k], 3e-4) << k;
  EXPECT_NEAR(all.modulus_scatter, 0.084, 0.005);
  const StateFit narrow = fit_equation_of_state(committed_curves("fast", 2e-4, 6.0), {StateForm::porosity, 40, 1});
  ASSERT_TRUE(narrow.usable) << narrow.message;
  EXPECT_GT(narrow.modulus.value, 0.0407);
  EXPECT_LT(narrow.modulus.value, 0.0544);
  EXPECT_NEAR(narrow.exponent.value, 1.85, 0.1);
  EXPECT_LT(narrow.modulus_scatter, 0.03);
  EXPECT_LT(narrow.pressure_deviation, 0.02);
}

}  // namespace
}  // namespace softgrain
