// The built program run on the text of a scene, as a person would from a file.
#pragma once

#include <fstream>
#include <string>

#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"
#include "tests/verification/cases/outside_run.h"

namespace softgrain::verification {

/// Summary of `softgrain microsim` on this text.
inline nlohmann::json run_by_program(const std::string& text) {
  const test::TemporaryDirectory directory;
  const std::string file = directory.path() + "/scene.toml";
  std::ofstream(file) << text;
  return test::run_scene(file, directory.path() + "/run");
}

/// Summary of `softgrain microsim` on a file of tests/reference/scenes, with arguments such as --set.
inline nlohmann::json run_file_by_program(const std::string& name, const std::string& more = "") {
  const test::TemporaryDirectory directory;
  return test::run_scene(scene_file(name), directory.path(), more);
}

/// The cases run the library; the program must end in the same state, bit for bit.
inline void expect_same_end(const nlohmann::json& summary, const OutsideRun& run) {
  const auto& p = run.result.system.particles;
  ASSERT_EQ(summary["particles"].size(), static_cast<std::size_t>(p.grains));
  for (std::size_t i = 0; i < static_cast<std::size_t>(p.grains); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& there = summary["particles"][i];
      EXPECT_EQ(there["position"][k].get<double>(), p.sphere[i].x.v[k]) << "particle " << i;
      EXPECT_EQ(there["velocity"][k].get<double>(), p.velocity[i].v[k]) << "particle " << i;
      EXPECT_EQ(there["spin"][k].get<double>(), p.spin[i].v[k]) << "particle " << i;
    }
}

}  // namespace softgrain::verification
