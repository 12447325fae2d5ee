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
  std::string unit;
  double value = kNaN;
  double low = kNaN;   ///< 95 % interval
  double high = kNaN;  ///< 95 % interval
  double from = kNaN;  ///< range that was searched
  double to = kNaN;    ///< range that was searched
  bool logarithmic = false;
};

void fields(auto&& visit, Of<SearchedKey> auto& s) {
  visit("key", s.key, Means{"key of the scene"});
  visit("unit", s.unit, Means{"unit of the key; empty: none"});
  visit("value", s.value, Means{"value at the optimum", "as `unit` says"});
  range_field(visit, "interval_95", s.low, s.high, Means{"95 % interval of the optimum", "as `unit` says"});
  range_field(visit, "range", s.from, s.to, Means{"range that was searched", "as `unit` says"});
  visit("logarithmic", s.logarithmic, Means{"whether the range is logarithmic"});
}

/// The fitted surface along one key, with the band of its replicates.
struct SearchCurve {
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> low;
  std::vector<double> high;
};

void fields(auto&& visit, Of<SearchCurve> auto& s) {
  visit("x", s.x, Means{"values of the key", "as the key"});
  visit("y", s.y, Means{"fitted surface there", "as the result"});
  visit("low", s.low, Means{"lower end of its 95 % band", "as the result"});
  visit("high", s.high, Means{"upper end of its 95 % band", "as the result"});
}

struct OptimumSummary {
  std::string number;
  std::string unit;
  bool maximise = true;
  bool usable = false;
  std::string reason;
  std::vector<SearchedKey> keys;
  double value = kNaN;
  double low = kNaN;   ///< 95 % interval
  double high = kNaN;  ///< 95 % interval
  double inside = 0.0;
  bool over_seeds = false;
  std::int64_t points = 0;
  std::int64_t fitted = 0;
  SearchCurve curve;  ///< of one key
};

void fields(auto&& visit, Of<OptimumSummary> auto& s) {
  visit("number", s.number, Means{"result that was searched for its largest or smallest value"});
  visit("unit", s.unit, Means{"unit of the result"});
  visit("maximise", s.maximise, Means{"whether its largest value was searched"});
  visit("usable", s.usable, Means{"whether the optimum is determined"});
  visit("reason", s.reason, kLeftOut, Means{"why it is not"});
  visit("optimum", s.keys, Means{"the keys at the optimum"});
  visit("value", s.value, Means{"fitted surface at the optimum", "as `unit` says"});
  range_field(visit, "interval_95", s.low, s.high, Means{"95 % interval of it", "as `unit` says"});
  visit("replicates_inside", s.inside,
        Means{"share of the replicates whose optimum is not at an end of the range", "1"});
  visit("over_seeds", s.over_seeds, Means{"whether points are means over seeds"});
  visit("points", s.points, Means{"points that have the result", "1"});
  visit("fitted_points", s.fitted, Means{"points that the surface is fitted to", "1"});
  visit("curve", s.curve, Means{"the fitted surface along one key"});
}

}  // namespace softgrain
