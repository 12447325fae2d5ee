// What a search came to: which values of one or two keys give the largest or smallest result.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/core/limits.h"
#include "common/data/fields.h"
#include "common/io/json_record.h"

namespace softgrain {

/// One key at the optimum.
struct SearchedKey {
  std::string key;
  std::string unit;  ///< unit of the range; empty: none
  double value = kNaN;
  double low = kNaN;   ///< 95 % interval
  double high = kNaN;  ///< 95 % interval
  double from = kNaN;  ///< range that was searched
  double to = kNaN;    ///< range that was searched
  bool logarithmic = false;
};

void fields(auto&& visit, Of<SearchedKey> auto& s) {
  visit("key", s.key);
  visit("unit", s.unit);
  visit("value", s.value);
  range_field(visit, "interval_95", s.low, s.high);
  range_field(visit, "range", s.from, s.to);
  visit("logarithmic", s.logarithmic);
}

/// The fitted surface along one key, with the band of its replicates.
struct SearchCurve {
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> low;
  std::vector<double> high;
};

void fields(auto&& visit, Of<SearchCurve> auto& s) {
  visit("x", s.x);
  visit("y", s.y);
  visit("low", s.low);
  visit("high", s.high);
}

struct OptimumSummary {
  std::string number;  ///< name of the result that was searched for its largest or smallest value
  std::string unit;
  bool maximise = true;
  bool usable = false;
  std::string reason;  ///< why it is not usable
  std::vector<SearchedKey> keys;
  double value = kNaN;  ///< of the fitted surface at the optimum
  double low = kNaN;    ///< 95 % interval
  double high = kNaN;   ///< 95 % interval
  double inside = 0.0;  ///< share of the replicates whose optimum is not at an end of the range
  bool over_seeds = false;
  std::int64_t points = 0;  ///< points that have the number
  std::int64_t fitted = 0;  ///< points that the surface is fitted to
  SearchCurve curve;        ///< of one key
};

void fields(auto&& visit, Of<OptimumSummary> auto& s) {
  visit("number", s.number);
  visit("unit", s.unit);
  visit("maximise", s.maximise);
  visit("usable", s.usable);
  visit("reason", s.reason, kLeftOut);
  visit("optimum", s.keys);
  visit("value", s.value);
  range_field(visit, "interval_95", s.low, s.high);
  visit("replicates_inside", s.inside);
  visit("over_seeds", s.over_seeds);
  visit("points", s.points);
  visit("fitted_points", s.fitted);
  visit("curve", s.curve);
}

}  // namespace softgrain
