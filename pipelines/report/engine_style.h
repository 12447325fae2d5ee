// How the engines of macro runs are called and drawn, everywhere alike.
#pragma once

#include <string>
#include <vector>

#include "common/data/macro_result.h"
#include "pipelines/report/svg_plot.h"

namespace softgrain::report {

/// "soft particles with their law" for "law" ...; the name itself when it is not known.
std::string engine_name(const std::string& engine);

SeriesStyle engine_style(const std::string& engine);

/// One paragraph on the laws that the curves were made with; empty when they do not say.
std::string law_paragraph(const std::vector<MacroCurve>& curves);

/// A column of macro curves.
using Stress = std::vector<double> MacroCurve::*;

/// One line per curve that has the column, over strain in per cent, in units of `unit`; each engine once in the legend.
void add_curves(Plot& plot, const std::vector<MacroCurve>& curves, Stress member, double unit);

}  // namespace softgrain::report
