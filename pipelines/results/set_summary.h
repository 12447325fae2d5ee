// Several runs side by side: summary.json of a sweep, of runs over seeds, of a comparison; the report reads it back.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipelines/results/kind_results.h"
#include "pipelines/results/summary.h"

namespace softgrain {

/// A key of the scene and the values that it takes in turn.
struct SweptKey {
  std::string key;
  std::vector<std::string> values;
};

void fields(auto&& visit, Of<SweptKey> auto& s) {
  visit("key", s.key);
  visit("values", s.values);
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

struct SetSummary {
  SummaryHead head;
  std::vector<SweptKey> over;
  std::vector<std::int64_t> seeds;
  std::vector<SweptKey> differences;  ///< differences of the compared scenes: a value per run, "-" where it has none
  std::vector<RunEntry> runs;
  std::vector<PointEntry> points;
  std::string reference;       ///< run that the norms refer to
  std::vector<RunNorm> norms;  ///< norms of every run but the reference
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
}

/// Every number that one of the runs has, once, in the order in which they first appear.
std::vector<RunValue> numbers_of(const std::vector<RunEntry>& runs);

/// "axial stress [Pa]"
std::string with_unit(const std::string& name, const std::string& unit);

/// "bodies = 40, mu = 0.3": keys by their last parts where these tell them apart; "all runs" without any.
std::string point_name(const std::vector<SweptKey>& over, const std::map<std::string, std::string>& values);

/// A key by its last part where no other of the keys ends with it.
std::string short_key(const std::vector<SweptKey>& over, const std::string& key);

/// Runs that share all values, and the mean, spread and standard error of every number over those that are good.
std::vector<PointEntry> points_of(const std::vector<SweptKey>& over, const std::vector<RunEntry>& runs);

}  // namespace softgrain
