// Drawings of several runs side by side.
#pragma once

#include <string>
#include <vector>

#include "pipelines/report/run_data.h"
#include "pipelines/report/svg_plot.h"
#include "pipelines/results/set_summary.h"

namespace softgrain::report {

/// Style of the curve of run or choice of values number `index`; thin and without marks where many are drawn together.
SeriesStyle run_style(std::size_t index, bool one_of_many);

/// All curves of the runs whose directories are there, over seeds with their mean: a figure for each kind of curve.
std::vector<std::string> run_curve_figures(const RunData& run, const SetSummary& set);

/// The first of the numbers over every key whose values are numbers of one unit.
std::vector<std::string> dependence_figures(const SetSummary& set, const std::vector<RunValue>& numbers);

}  // namespace softgrain::report
