// Series that several sections draw alike; how the engines of macro runs are called and drawn, everywhere alike; and
// error against cost.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/core/histogram.h"
#include "common/data/macro_result.h"
#include "pipelines/compare/measured_stiffness.h"
#include "pipelines/compare/stage_results.h"
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

/// "soft particles with their law" for "law" ...; the name itself when it is not known.
std::string engine_name(const std::string& engine);
/// Whether a curve was made by the law of cells.
bool is_of_cells(const MacroCurve& curve);
/// The same of a curve: "cells of fines" where its law is that of cells.
std::string engine_name(const MacroCurve& curve);

SeriesStyle engine_style(const std::string& engine);

/// One paragraph on the laws that the curves were made with; empty when they do not say.
std::string law_paragraph(const std::vector<MacroCurve>& curves);

/// Probability density of a histogram as the outline of its bins; normalised over all values, those outside included.
/// Empty bins have density 0.
Series outline(const Histogram& histogram);

/// A column of macro curves.
using Stress = std::vector<double> MacroCurve::*;

/// One line per curve that has the column, of this part over its strain in per cent, in units of `unit`; each engine
/// once in the legend.
void add_curves(Plot& plot, const std::vector<MacroCurve>& curves, Stress member, double unit, StrainPart part);

// Error against cost: what every cheaper way of a run was off by, and what it cost, both against its own reference.

/// One cheaper way against its reference.
struct ErrorCost {
  std::string name;        ///< legend entry
  std::string detail;      ///< under the pointer: of what, against what
  std::string engine;      ///< style, as engine_style(); empty: a relaxation
  double cost = 0.0;       ///< contact evaluations over those of the reference
  double error = 0.0;      ///< relative difference from the reference
  double deviation = 0.0;  ///< standard error of `error`; NaN when there is one sample only
};

/// Laws and free twins against the shelled twin (macro runs and every scene of a comparison; error of the axial
/// stress), and the relaxation of the fit against the published one (error: root mean square over Delta of the ratio of
/// the mean normal forces less one, where the force is above 2 % of its largest). What cannot be had is left out.
std::vector<ErrorCost> error_costs(const RunData& run);

/// All of them in one plot; empty without any.
std::string error_cost_figure(const RunData& run);

}  // namespace softgrain::report
