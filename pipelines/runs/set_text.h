// Several runs set beside each other: their numbers, in what their scenes differ, words and tables for the terminal and
// as CSV.
#pragma once

#include <string>
#include <vector>

#include "common/core/text.h"
#include "pipelines/results/set_summary.h"

namespace softgrain {

/// "sweep over macro.bodies, macro.mu; 4 seeds".
std::string varied_text(const SetSummary& summary);

/// Keys and values that were varied, or that differ.
std::string differences_text(const SetSummary& summary);

/// Every number of every run, or with several seeds its mean, spread and standard error.
std::string numbers_text(const SetSummary& summary);

/// How far runs are from the reference; empty without norms.
std::string norms_text(const SetSummary& summary);

/// What differs, the numbers, remarks.
std::string set_text(const SetSummary& summary);

/// The first curve of every run whose directory is there, and those that ask for it (RunCurve::in_terminal), in the
/// terminal, with the letters of the table; empty without. `base`: what directories of runs are relative to.
std::string curves_text(const SetSummary& summary, const std::string& base);

/// One row per run: keys, seed, status, and every number with its standard error.
TextTable table_of(const SetSummary& summary);

/// "12.3 +- 0.4"; "-" for what is not there.
std::string number_text(double value, double error);

// What is in the directory of a run, as far as it is set beside others.

/// Status (good where it has no summary), time and numbers of the run in `directory`, into its entry. Throws
/// IoError where it holds no results or damaged ones.
void read_numbers(const std::string& directory, RunEntry& entry);

// In what the scenes differ that several runs were made from.

/// Every key whose value is not the same for all runs, with its value in each ("-": has none), from the scenes, seeds
/// and laws that summaries (of directories) and HDF5 files say they were made from. Titles are left out. Runs that do
/// not say their scene are passed over in silence: their values are "?".
std::vector<SweptKey> scene_differences(const std::vector<std::string>& paths);

/// Every number over every swept key, from runs in the order of their plan. A point counts if all of its runs (seeds)
/// are good; its number is their mean. Rank correlation and regression take keys whose values are numbers, in SI (a
/// logarithmic range by its logarithm); of Saltelli's design they take its independent points, and Sobol indices take
/// all. Empty for a set without swept keys.
std::vector<KeyEffect> sensitivity_of(const SetSummary& summary);

/// The first few numbers of that for the terminal; one line where nothing is determined.
std::string sensitivity_text(const SetSummary& summary);

}  // namespace softgrain
