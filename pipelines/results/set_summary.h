// Several runs side by side: summary.json of a sweep, of runs over seeds, of a comparison; the report reads it back.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/core/sensitivity.h"
#include "pipelines/results/kind_results.h"
#include "pipelines/results/search_summary.h"
#include "pipelines/results/summary.h"

namespace softgrain {

/// A key of the scene and the values that it takes in turn.
struct SweptKey {
  std::string key;
  std::vector<std::string> values;
  std::string range{};  ///< "0.1..0.8", "1e6..1e8:log" of a key that was sampled; its values are those of the points
};

void fields(auto&& visit, Of<SweptKey> auto& s) {
  visit("key", s.key);
  visit("values", s.values);
  visit("range", s.range, kLeftOut);
}

/// One run of the set.
struct RunEntry {
  std::string name{};
  std::string directory{};                      ///< directory of the run, within that of the set, or absolute
  std::map<std::string, std::string> values{};  ///< values of the keys that were swept, or in which the runs differ
  std::optional<std::int64_t> seed{};
  RunStatus status = RunStatus::not_run;
  std::string reason{};  ///< why it is not usable
  double seconds = kNaN;
  std::vector<RunValue> numbers{};
};

void fields(auto&& visit, Of<RunEntry> auto& s) {
  visit("name", s.name);
  visit("directory", s.directory);
  visit("values", s.values);
  visit("seed", s.seed, kLeftOut);
  visit("status", s.status);
  visit("reason", s.reason, kLeftOut);
  visit("seconds", s.seconds);
  visit("numbers", s.numbers);
}

/// One number over the usable runs that share all values.
struct NumberOverRuns {
  std::string name{};
  std::string unit{};
  double mean = kNaN;
  double spread = kNaN;  ///< standard deviation between runs (n - 1); NaN with one run
  double error = kNaN;   ///< standard error of the mean; with one run that of the run itself
  double least = kNaN;
  double largest = kNaN;
  std::size_t runs = 0;
};

void fields(auto&& visit, Of<NumberOverRuns> auto& s) {
  visit("name", s.name);
  visit("unit", s.unit);
  visit("mean", s.mean);
  visit("spread", s.spread);
  visit("standard_error", s.error);
  visit("least", s.least);
  visit("largest", s.largest);
  visit("runs", s.runs);
}

/// One choice of values, whatever the seeds.
struct PointEntry {
  std::string name{};
  std::map<std::string, std::string> values{};
  std::size_t runs = 0;  ///< number of runs asked for
  std::vector<NumberOverRuns> numbers{};
};

void fields(auto&& visit, Of<PointEntry> auto& s) {
  visit("name", s.name);
  visit("values", s.values);
  visit("runs", s.runs);
  visit("numbers", s.numbers);
}

/// How far one run is from the reference.
struct RunNorm {
  std::string run{};
  std::string of{};  ///< "axial stress, law against law"
  double percent = kNaN;
  double error = kNaN;   ///< standard error over samples
  std::string reason{};  ///< why there is none
};

void fields(auto&& visit, Of<RunNorm> auto& s) {
  visit("run", s.run);
  visit("of", s.of);
  visit("percent", s.percent);
  visit("standard_error", s.error);
  visit("reason", s.reason, kLeftOut);
}

/// How the points of a set were chosen in the ranges of its keys (--sample).
struct DesignEntry {
  std::string sample{};  ///< "lhs:20"
  std::int64_t seed = 0;
};

void fields(auto&& visit, Of<DesignEntry> auto& s) {
  visit("sample", s.sample);
  visit("seed", s.seed);
}

void fields(auto&& visit, Of<EffectSize> auto& s) {
  visit("value", s.value);
  range_field(visit, "interval_95", s.low, s.high);
}

/// How a number of the runs depends on a key; what is not determined is null.
struct KeyEffect {
  std::string number{};
  std::string key{};
  std::size_t points = 0;                   ///< points with this number, of runs that are good
  std::optional<EffectSize> rank{};         ///< Spearman's rank correlation
  std::optional<EffectSize> coefficient{};  ///< standardised coefficient of a regression on all keys with numbers
  double determination = kNaN;              ///< share of the variance that this regression explains
  std::optional<EffectSize> first{};        ///< Sobol index of first order
  std::optional<EffectSize> total{};        ///< total Sobol index
  std::string reason{};                     ///< why something is not determined
};

void fields(auto&& visit, Of<KeyEffect> auto& s) {
  visit("number", s.number);
  visit("key", s.key);
  visit("points", s.points);
  visit("rank_correlation", s.rank);
  visit("regression_coefficient", s.coefficient);
  visit("regression_determination", s.determination);
  visit("sobol_first", s.first);
  visit("sobol_total", s.total);
  visit("not_determined", s.reason, kLeftOut);
}

struct SetSummary {
  SummaryHead head;
  std::vector<SweptKey> over;
  std::vector<std::int64_t> seeds;
  std::vector<SweptKey> differences;  ///< differences of the compared scenes: a value per run, "-" where it has none
  std::vector<RunEntry> runs;
  std::vector<PointEntry> points;
  std::string reference;       ///< run that the norms refer to
  std::vector<RunNorm> norms;  ///< norms of every run but the reference
  std::optional<DesignEntry> design{};
  std::vector<KeyEffect> sensitivity{};
  std::optional<PairedSummary> paired{};  ///< differences of two runs of one kind
  std::optional<OptimumSummary> search{};
};

void fields(auto&& visit, Of<SetSummary> auto& s) {
  fields(visit, s.head);
  visit("over", s.over, kLeftOut);
  visit("seeds", s.seeds, kLeftOut);
  visit("scene_differences", s.differences, kLeftOut);
  visit("runs", s.runs);
  visit("points", s.points, kLeftOut);
  visit("reference", s.reference, kLeftOut);
  visit("norms", s.norms, kLeftOut);
  visit("design", s.design, kLeftOut);
  visit("sensitivity", s.sensitivity, kLeftOut);
  visit("paired_differences", s.paired, kLeftOut);
  visit("search", s.search, kLeftOut);
}

/// Every number that one of the runs has, once, in the order in which they first appear.
std::vector<RunValue> numbers_of(const std::vector<RunEntry>& runs);

/// "axial stress [Pa]"
std::string with_unit(const std::string& name, const std::string& unit);

/// "bodies = 40, mu = 0.3": keys by their last parts where these tell them apart; "all runs" without any.
std::string point_name(const std::vector<SweptKey>& over, const std::map<std::string, std::string>& values);

/// "20, 40, 60", or the range of a key that was sampled: "0.1 to 0.8", "1e6 to 1e8, logarithmic".
std::string values_text(const SweptKey& key);

/// "0.83 [0.70, 0.91]"; "not determined".
std::string effect_text(const std::optional<EffectSize>& effect);

/// A key by its last part where no other of the keys ends with it.
std::string short_key(const std::vector<SweptKey>& over, const std::string& key);

/// Runs that share all values, and the mean, spread and standard error of every number over those that are good.
std::vector<PointEntry> points_of(const std::vector<SweptKey>& over, const std::vector<RunEntry>& runs);

}  // namespace softgrain
