// Which runs a sweep is made of (every choice of values of some keys of the scene, or a sample of their ranges, with
// every seed), and how they are run: one after another or several at once, in directories below that of the set.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pipelines/results/set_summary.h"
#include "pipelines/run/run_context.h"
#include "pipelines/runs/sample_design.h"

namespace softgrain {

struct PlannedRun {
  std::string name;                 ///< name of its directory: "bodies=40_seed=2", "sample_007"
  std::vector<std::string> values;  ///< one per key
  std::optional<std::uint64_t> seed;
};

struct RunPlan {
  std::vector<SweptKey> over;
  std::vector<std::uint64_t> seeds;  ///< empty: that of the scene
  std::vector<PlannedRun> runs;      ///< the first key varies slowest, seeds fastest
  std::optional<SampleDesign> design{};

  /// What --set would say for this run.
  [[nodiscard]] std::vector<std::string> overrides(const PlannedRun& run) const;
};

/// `over`: texts "key=a,b,c" of --over, each a list as --set takes its values, commas within brackets and quotes left
/// alone, or whole numbers "1..8"; `seeds`: "1..8", "1,3,7"; `set`: texts of --set, whose keys are not swept as well.
/// With a `design` keys are ranges (range_of) of which `takes_whole` says whether they take whole numbers, or lists,
/// whose values are equally likely; runs are called sample_001, sample_002, ...
/// Throws InputError with everything that is wrong, one a line: no key or value, a key or value twice, a range without
/// a design, more than 10000 runs, a seed said in two ways (`one_seed`: --seed is given).
RunPlan make_plan(
    const std::vector<std::string>& over, const std::string& seeds, const std::vector<std::string>& set,
    bool one_seed = false, const std::optional<SampleDesign>& design = {},
    const TakesWholeNumbers& takes_whole = [](const auto&, const auto&) { return false; });

/// Runs of these points (values by key), with every seed of the plan, and its keys with these values.
RunPlan plan_of_points(const RunPlan& keys, const std::vector<std::vector<std::string>>& points);

/// Rounds of a set whose next runs depend on what came out so far.
struct RunRounds {
  /// Runs that are added; none: the set is complete.
  std::function<RunPlan(const RunPlan& all, const std::vector<RunEntry>& entries)> next{};
  /// What is said of all of them.
  std::function<void(const RunPlan& all, SetSummary& summary)> conclude{};
};

/// The seed that the scene says.
std::uint64_t scene_seed(const Scene& scene);

/// Whether the reader of the scene takes whole numbers alone for a key.
TakesWholeNumbers takes_whole_numbers(const CommonOptions& options);

/// Runs the scene `options.inputs.front()` as the plan says, each run in OUT/NAME as its own kind runs it (the log, its
/// report and all); OUT is --out, else results/SCENE_`suffix`. With --resume runs that have ended are not repeated, and
/// one that was interrupted goes on where its kind can; runs that the plan has in addition are made. At the end writes
/// summary.json, table.csv and the report of the set. Status not_usable when a run failed or is not usable. With --jobs
/// several runs are made at once, with the same results; with --only one run of the plan alone is made, and with
/// --slurm none: a job array is written. `rounds` add runs until they have no more.
///
/// Throws InputError with all that is wrong with any of the scenes before anything is run; IoError and Interrupted
/// where a run ends so: those before it are kept.
ExitStatus run_set(const CommonOptions& options, const RunPlan& plan, const std::string& command,
                   const std::string& suffix, const RunRounds& rounds = {});

}  // namespace softgrain
