// sweep --maximise NUMBER, --minimise NUMBER: which values of one or two keys give the largest or smallest result.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/core/text.h"
#include "pipelines/runs/run_set.h"

namespace softgrain {

struct SearchGoal {
  std::string number;  ///< name of a result, or a part of it
  bool maximise = true;
  std::size_t points = 0;  ///< points in all
};

/// Default number of points for so many keys.
inline constexpr std::size_t search_points(std::size_t keys) { return keys == 1 ? 9 : 18; }

/// The goal that the options ask for. Throws InputError for both directions, options that do not go with a search, keys
/// that are not one or two ranges, fewer points than the first round has.
SearchGoal search_goal(const CommonOptions& options);

/// The points of the first round, with every seed; keys with their ranges. Throws InputError.
RunPlan search_plan(const CommonOptions& options, const TakesWholeNumbers& takes_whole);

/// Rounds of a search from that plan on: see next_search_points. `seed`: of the bootstrap.
RunRounds search_rounds(const SearchGoal& goal, const TakesWholeNumbers& takes_whole, std::uint64_t seed);

/// The fitted curve of one key with its band: search.csv.
TextTable search_table(const OptimumSummary& search);

/// Optimum, interval and what to mind, a few lines; empty without a search.
std::string search_text(const SetSummary& summary);

}  // namespace softgrain
