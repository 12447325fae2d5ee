// How the engines of macro runs are called and drawn, everywhere alike.
#pragma once

#include <string>

#include "pipelines/report/svg_plot.h"

namespace softgrain::report {

/// "soft particles with the fitted law" for "law" ...; the name itself when it is not known.
std::string engine_name(const std::string& engine);

SeriesStyle engine_style(const std::string& engine);

}  // namespace softgrain::report
