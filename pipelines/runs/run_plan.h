// Which runs a sweep is made of: every choice of values of some keys of the scene, with every seed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipelines/results/set_summary.h"

namespace softgrain {

struct PlannedRun {
  std::string name;                 ///< name of its directory: "bodies=40_seed=2"
  std::vector<std::string> values;  ///< one per key
  std::optional<std::uint64_t> seed;
};

struct RunPlan {
  std::vector<SweptKey> over;
  std::vector<std::uint64_t> seeds;  ///< empty: that of the scene
  std::vector<PlannedRun> runs;      ///< the first key varies slowest, seeds fastest

  /// What --set would say for this run.
  [[nodiscard]] std::vector<std::string> overrides(const PlannedRun& run) const;
};

/// `over`: texts "key=a,b,c" of --over, each a list as --set takes its values, commas within brackets and quotes left
/// alone, or whole numbers "1..8"; `seeds`: "1..8", "1,3,7"; `set`: texts of --set, whose keys are not swept as well.
/// Throws InputError with everything that is wrong, one a line: no key or value, a key or value twice, more than 10000
/// runs.
RunPlan make_plan(const std::vector<std::string>& over, const std::string& seeds, const std::vector<std::string>& set);

}  // namespace softgrain
