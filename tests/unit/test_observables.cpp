// Columns for calibration tools: means over the samples that came to a point.
#include <gtest/gtest.h>

#include "common/data/macro_result.h"
#include "common/io/text_file.h"
#include "pipelines/commands/commands.h"
#include "tests/support/synthetic_run.h"
#include "tests/support/temporary_directory.h"

namespace softgrain {
namespace {

/// One of three samples goes to the end: its stress there is the mean, not a third of it.
TEST(Observables, SamplesThatBrokeOffDoNotCountBeyondWhereTheyEnded) {
  const test::TemporaryDirectory directory;
  std::vector<MacroCurve> curves;
  for (int sample = 0; sample < 3; ++sample) {
    MacroCurve c = synthetic::macro_curve("law", sample, 1.0, 2);
    c.strain = {0.0, 0.1};
    c.stress_axial = {0.0, 750.0};
    c.stress_lateral = {10.0, 200.0};
    c.coordination = {4.0, 6.0};
    c.residual = {0.0, 0.0};
    c.stress_axial_contacts = c.stress_axial;
    for (auto* column : {&c.stress_x, &c.stress_y, &c.stress_deviator, &c.fabric, &c.fabric_bodies,
                         &c.coordination_bodies, &c.law_evaluations, &c.law_beyond, &c.law_largest, &c.stage,
                         &c.strain_x, &c.strain_y, &c.strain_z, &c.residual_largest})
      column->clear();
    c.more.clear();
    if (sample > 0) {
      for (auto* column :
           {&c.strain, &c.stress_axial, &c.stress_lateral, &c.coordination, &c.residual, &c.stress_axial_contacts})
        column->resize(1);
      c.usable = false;
      c.note = "broke off";
    }
    curves.push_back(c);
  }
  save_macro(curves, directory.file("macro.h5"));
  write_observables(directory.path(), {}, directory.file("p"));
  EXPECT_EQ(read_text(directory.file("p_sim.txt")),
            "# strain stress lateral_stress coordination\n0 0 10 4\n0.1 750 200 6\n");
}

}  // namespace
}  // namespace softgrain
