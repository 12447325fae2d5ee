// The sections of a report that belong to no kind of scene, one file each, and what the section of several runs side by
// side is made of. A section without data is an empty string.
#pragma once

#include <string>
#include <vector>

#include "pipelines/report/run_data.h"
#include "pipelines/report/svg_plot.h"
#include "pipelines/results/kind_results.h"
#include "pipelines/results/set_summary.h"

namespace softgrain::report {

bool is_set(const RunData& run);                           ///< whether it is several runs side by side
std::string runs_section(const RunData& run);              ///< several runs side by side, where the summary is of a set
std::vector<HeadLine> set_lines(const RunData& run);       ///< head of the report of a set of runs
std::vector<HeadLine> law_lines(const RunData& run);       ///< head: form, solid fraction, material, hash of the laws
std::vector<HeadLine> material_lines(const RunData& run);  ///< head: material of the grains
std::string next_section(const RunData& run);              ///< what to do next, in two lines
std::string heading_section(const RunData& run);           ///< what was run and what came out
std::string warnings_section(const RunData& run);          ///< what may make the result wrong
std::string notes_section(const RunData& run);             ///< all other remarks, folded
std::string laws_section(const RunData& run);              ///< parameters, errors, intervals, units
std::string own_data_section(const RunData& run);          ///< curves of an experiment and the law fitted to them
std::string packing_section(const RunData& run);           ///< the packing in 3D, from the states that the run kept
std::string radii_section(const RunData& run);             ///< size distribution of the packed grains
std::string sizes_section(const RunData& run);             ///< passing over size, asked and obtained
std::string grading_section(const RunData& run);     ///< passing over size of all grains, where no sizes were asked for
std::string cost_section(const RunData& run);        ///< passes, contact evaluations, seconds, speed-ups
std::string provenance_section(const RunData& run);  ///< version, seeds, command, scene

// What the kinds say of a run directory, gathered.

/// Numbers by which a run is set beside others; those that are not finite left out.
std::vector<RunValue> values_of(const RunData& run);

/// Curves of a run directory. Throws IoError where it holds no results, or damaged ones.
std::vector<RunCurve> curves_of(const std::string& directory);

// Drawings of several runs side by side.

/// Style of the curve of run or choice of values number `index`; thin and without marks where many are drawn together.
SeriesStyle run_style(std::size_t index, bool one_of_many);

/// All curves of the runs whose directories are there, over seeds with their mean: a figure for each kind of curve.
std::vector<std::string> run_curve_figures(const RunData& run, const SetSummary& set);

/// The first of the numbers over every key whose values are numbers of one unit.
std::vector<std::string> dependence_figures(const SetSummary& set, const std::vector<RunValue>& numbers);

/// Differences of two runs with their errors; empty where the summary has none.
std::string differences_part(const SetSummary& set);

/// Optimum of a search with its curve; empty without one.
std::string search_part(const SetSummary& set);

/// How much each number depends on each key, with intervals; empty where nothing is determined.
std::string sensitivity_part(const SetSummary& set);

}  // namespace softgrain::report
