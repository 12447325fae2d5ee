// Series that several sections draw alike.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipelines/compare/measured_stiffness.h"
#include "pipelines/report/run_data.h"
#include "pipelines/report/svg_plot.h"

namespace softgrain::report {

/// "soft particle on a plane" or "two soft particles".
std::string describe(PairKind kind);

/// "packing 7 (seed 12)": how a curve is named under the pointer. `second` of a soft-soft pair is not recorded.
std::string packing_name(const Measurements& data, std::int64_t packing);

/// Mean over packings with standard error against Delta, times `unit`.
Series mean_series(const ValuesByDelta& values, double unit, const std::string& label, const SeriesStyle& style);

/// One thin grey line per packing, times `unit`. The first carries the legend label.
std::vector<Series> packing_series(const Measurements& data, const ValuesByDelta& values, double unit,
                                   const std::string& label);

/// A fitted law over (0, delta_max], times `unit`, with its 95 % band when there is one; dotted a little beyond its
/// range, as it is used there (not at all when that is an error).
void add_law(Plot& plot, const PairLaw& law, LawPart part, double unit, const std::string& label, const char* color);

/// The overlaps that a law was fitted in, to be shaded; nothing without such a law.
std::optional<ShadedRange> fitted_range(const PairLaw* law, LawPart part);

/// The axis of overlaps up to a little beyond the last measured one.
AxisOptions overlap_axis(double last);

/// Largest overlap of some values.
double last_delta(const ValuesByDelta& values);

}  // namespace softgrain::report
