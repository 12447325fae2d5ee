// What a run came to in a few numbers and curves, by which runs are set side by side.
#pragma once

#include <string>
#include <vector>

#include "common/core/limits.h"
#include "common/io/json_record.h"

namespace softgrain {

/// One number that a run came to.
struct RunValue {
  std::string name;  ///< "axial stress at the end", with "(law)" behind it where several engines have one
  std::string unit;  ///< empty: a plain number
  double value = kNaN;
  double error = kNaN;  ///< standard error within the run, over its samples; NaN: it has one sample, or does not say
};

void fields(auto&& visit, Of<RunValue> auto& v) {
  visit("name", v.name);
  visit("unit", v.unit);
  visit("value", v.value);
  visit("standard_error", v.error);
}

/// One curve of a run. Runs share a plot where its title agrees, and a colour rule where the name does.
struct RunCurve {
  std::string plot;     ///< title
  std::string x_label;  ///< label of the x axis, with unit
  std::string y_label;  ///< label of the y axis, without unit
  std::string y_unit;   ///< SI, or empty
  std::string name;     ///< name of the curve in the run: an engine, a kind of contact; empty: there is one
  std::vector<double> x;
  std::vector<double> y;
};

}  // namespace softgrain
