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
  visit("key", s.key, Means{"key of the scene"});
  visit("values", s.values, Means{"values that it takes in turn"});
  visit("range", s.range, kLeftOut, Means{"range that its values were sampled from"});
}

/// One run of the set.
struct RunEntry {
  std::string name{};
  std::string directory{};
  std::map<std::string, std::string> values{};
  std::optional<std::int64_t> seed{};
  RunStatus status = RunStatus::not_run;
  std::string reason{};
  double seconds = kNaN;
  std::vector<RunValue> numbers{};
};

void fields(auto&& visit, Of<RunEntry> auto& s) {
  visit("name", s.name, Means{"name of the run"});
  visit("directory", s.directory, Means{"its directory, within that of the set or absolute"});
  visit("values", s.values, Means{"values of the keys in which the runs differ"});
  visit("seed", s.seed, kLeftOut, Means{"seed of the run", "1"});
  visit("status", s.status, Means{"good, not usable, not run or written"});
  visit("reason", s.reason, kLeftOut, Means{"why it is not usable"});
  visit("seconds", s.seconds, Means{"duration of the run", "s"});
  visit("numbers", s.numbers, Means{"results of the run"});
}

/// One number over the usable runs that share all values.
struct NumberOverRuns {
  std::string name{};
  std::string unit{};
  double mean = kNaN;
  double spread = kNaN;
  double error = kNaN;
  double least = kNaN;
  double largest = kNaN;
  std::size_t runs = 0;
};

void fields(auto&& visit, Of<NumberOverRuns> auto& s) {
  visit("name", s.name, Means{"name of the result"});
  visit("unit", s.unit, Means{"unit of the result"});
  visit("mean", s.mean, Means{"mean over the usable runs", "as `unit` says"});
  visit("spread", s.spread, Means{"standard deviation between runs; null with one run", "as `unit` says"});
  visit("standard_error", s.error,
        Means{"standard error of the mean; with one run that of the run itself", "as `unit` says"});
  visit("least", s.least, Means{"smallest value", "as `unit` says"});
  visit("largest", s.largest, Means{"largest value", "as `unit` says"});
  visit("runs", s.runs, Means{"number of runs with the result", "1"});
}

/// One choice of values, whatever the seeds.
struct PointEntry {
  std::string name{};
  std::map<std::string, std::string> values{};
  std::size_t runs = 0;
  std::vector<NumberOverRuns> numbers{};
};

void fields(auto&& visit, Of<PointEntry> auto& s) {
  visit("name", s.name, Means{"name of the point"});
  visit("values", s.values, Means{"values of the swept keys"});
  visit("runs", s.runs, Means{"number of runs asked for", "1"});
  visit("numbers", s.numbers, Means{"results over the runs of the point"});
}

/// How far one run is from the reference.
struct RunNorm {
  std::string run{};
  std::string of{};  ///< "axial stress, law against law"
  double percent = kNaN;
  double error = kNaN;
  std::string reason{};
};

void fields(auto&& visit, Of<RunNorm> auto& s) {
  visit("run", s.run, Means{"name of the run"});
  visit("of", s.of, Means{"quantity and engines that are compared"});
  visit("percent", s.percent, Means{"relative L2 difference from the reference", "%"});
  visit("standard_error", s.error, Means{"standard error over samples", "%"});
  visit("reason", s.reason, kLeftOut, Means{"why there is none"});
}

/// How the points of a set were chosen in the ranges of its keys (--sample).
struct DesignEntry {
  std::string sample{};  ///< "lhs:20"
  std::int64_t seed = 0;
};

void fields(auto&& visit, Of<DesignEntry> auto& s) {
  visit("sample", s.sample, Means{"how points were chosen, as --sample said"});
  visit("seed", s.seed, Means{"seed of the design", "1"});
}

void fields(auto&& visit, Of<EffectSize> auto& s) {
  visit("value", s.value, Means{"size of the effect", "1"});
  range_field(visit, "interval_95", s.low, s.high, Means{"95 % interval", "1"});
}

/// How a number of the runs depends on a key; what is not determined is null.
struct KeyEffect {
  std::string number{};
  std::string key{};
  std::size_t points = 0;  ///< points with this number, of runs that are good
  std::optional<EffectSize> rank{};
  std::optional<EffectSize> coefficient{};
  double determination = kNaN;
  std::optional<EffectSize> first{};
  std::optional<EffectSize> total{};
  std::string reason{};
};

void fields(auto&& visit, Of<KeyEffect> auto& s) {
  visit("number", s.number, Means{"name of the result"});
  visit("key", s.key, Means{"key of the scene"});
  visit("points", s.points, Means{"usable points with this result", "1"});
  visit("rank_correlation", s.rank, Means{"Spearman's rank correlation"});
  visit("regression_coefficient", s.coefficient,
        Means{"standardised coefficient of a regression on all keys with numbers"});
  visit("regression_determination", s.determination, Means{"share of the variance that this regression explains", "1"});
  visit("sobol_first", s.first, Means{"Sobol index of first order"});
  visit("sobol_total", s.total, Means{"total Sobol index"});
  visit("not_determined", s.reason, kLeftOut, Means{"why something is not determined"});
}

struct SetSummary {
  SummaryHead head;
  std::vector<SweptKey> over;
  std::vector<std::int64_t> seeds;
  std::vector<SweptKey> differences;
  std::vector<RunEntry> runs;
  std::vector<PointEntry> points;
  std::string reference;
  std::vector<RunNorm> norms;
  std::optional<DesignEntry> design{};
  std::vector<KeyEffect> sensitivity{};
  std::optional<PairedSummary> paired{};
  std::optional<OptimumSummary> search{};
};

void fields(auto&& visit, Of<SetSummary> auto& s) {
  fields(visit, s.head);
  visit("over", s.over, kLeftOut, Means{"keys that were swept"});
  visit("seeds", s.seeds, kLeftOut, Means{"seeds of the runs", "1"});
  visit("scene_differences", s.differences, kLeftOut, Means{"differences of the compared scenes"});
  visit("runs", s.runs, Means{"the runs"});
  visit("points", s.points, kLeftOut, Means{"choices of values, over the seeds"});
  visit("reference", s.reference, kLeftOut, Means{"run that the norms refer to"});
  visit("norms", s.norms, kLeftOut, Means{"how far each run is from the reference"});
  visit("design", s.design, kLeftOut, Means{"how points were chosen"});
  visit("sensitivity", s.sensitivity, kLeftOut, Means{"how results depend on keys"});
  visit("paired_differences", s.paired, kLeftOut, Means{"differences of two runs of one kind"});
  visit("search", s.search, kLeftOut, Means{"the optimum that was searched"});
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
