// What runs of grain boxes leave behind, and what their report draws: series over strain and pressure, a slice.
#pragma once

#include <string>
#include <vector>

#include "microsim/grain_box/record.h"
#include "pipelines/report/svg_plot.h"
#include "pipelines/results/kind_results.h"

namespace softgrain {

KindResults grain_box_results();

/// grain_box.h5: the last state of every pack, one series each, whatever the choice. Throws IoError.
void visit_grain_boxes(const std::string& path, SnapshotChoice choice, const VisitSnapshot& visit);

namespace report {

std::string grain_box_section(const RunData& run);  ///< stresses, moduli, contacts

/// One value per point.
using PointValue = double (*)(const BoxPoint&);

/// Axis that was compressed most at the end.
int main_axis(const GrainBoxResult& result);

/// y over the strain along the main axis [%], from the start of friction on.
Series over_strain(const GrainBoxResult& result, PointValue y, double unit, const SeriesStyle& style);

/// Interval values of the loading phase over sigma_c [MPa], averaged over bins of equal width in its logarithm: single
/// intervals scatter, as contacts open and slide one by one.
Series binned_over_pressure(const GrainBoxResult& result, double BoxPoint::*y, double unit, const SeriesStyle& style);

/// Single values over sigma_c [MPa]; NaN leaves no mark.
Series over_pressure(const GrainBoxResult& result, double BoxPoint::*y, double unit, const SeriesStyle& style);

/// The fitted power law over its range.
Series fitted_line(const PowerFit& fit, const std::array<double, 2>& range, double unit, const std::string& label,
                   const SeriesStyle& style);

/// Grains and contact forces in a slice through the middle of the pack, as one svg element.
std::string pack_view(const GrainBoxResult& result);

}  // namespace report

}  // namespace softgrain
