// What macro.h5 must hold to be read.
#include <gtest/gtest.h>

#include <string>

#include "common/core/error.h"
#include "common/data/macro_result.h"
#include "tests/support/hdf5_edit.h"
#include "tests/support/stage_curves.h"
#include "tests/support/temporary_directory.h"

namespace softgrain {
namespace {

/// The report of a material without the stress along y ended in a segmentation fault.
TEST(StageResults, CurvesWithoutTheColumnsOfStagesAreRefused) {
  const test::TemporaryDirectory directory;
  const std::string path = directory.file("macro.h5");
  const auto refusal = [&](const auto& edit) -> std::string {
    save_macro({test::pressed_and_slid().curve}, path);
    {
      test::Hdf5Edit file(path);
      edit(file);
    }
    try {
      (void)load_macro(path);
    } catch (const IoError& e) {
      return e.what();
    }
    return "";
  };
  const std::string curve = "curves/curve_000000/";
  EXPECT_EQ(refusal([](test::Hdf5Edit&) {}), "");
  for (const std::string name : {"stage", "strain_x", "strain_y", "strain_z", "stress_x", "stress_y"})
    EXPECT_NE(refusal([&](test::Hdf5Edit& f) {
                f.remove(curve + name);
              }).find("macro.h5: curve_000000: data set '" + name + "' is missing"),
              std::string::npos)
        << name;
  for (const double beyond : {2.0, 7.0})
    EXPECT_NE(refusal([&](test::Hdf5Edit& f) { f.set(curve + "stage", 2, beyond); }).find("there are 2 stages"),
              std::string::npos)
        << beyond;
}

}  // namespace
}  // namespace softgrain
