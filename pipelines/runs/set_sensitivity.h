// How the numbers of a set of runs depend on the keys that were swept.
#pragma once

#include <string>
#include <vector>

#include "pipelines/results/set_summary.h"

namespace softgrain {

/// Every number over every swept key, from runs in the order of their plan. A point counts if all of its runs (seeds)
/// are good; its number is their mean. Rank correlation and regression take keys whose values are numbers, in SI (a
/// logarithmic range by its logarithm); of Saltelli's design they take its independent points, and Sobol indices take
/// all. Empty for a set without swept keys.
std::vector<KeyEffect> sensitivity_of(const SetSummary& summary);

/// The first few numbers of that for the terminal; one line where nothing is determined.
std::string sensitivity_text(const SetSummary& summary);

}  // namespace softgrain
