// Plots of cohesive powders.
#pragma once

#include <string>
#include <vector>

#include "pipelines/kinds/cohesive_powder/powder_data.h"
#include "pipelines/report/svg_plot.h"

namespace softgrain::report {

/// Probability density of the values as an outline of `bins` equal bins over [low, high]; normalised over all values,
/// those outside included. Empty bins have density 0.
Series histogram(const std::vector<double>& values, double low, double high, int bins);

/// What the histograms show of interactions that carry force, all samples together.
struct PowderForces {
  std::vector<double> normal;  ///< N/F0, distant pairs included
  std::vector<double> ratio;   ///< T/N of contacts, signed
  std::vector<double> angle;   ///< between n and the total force on the contact [degree], 0 pressed, 180 pulled
};
PowderForces powder_forces(const PowderRun& run);

/// Phi(t), z(t), E_k(t): a row of figures; empty without a course.
std::string course_figures(const PowderRun& run);
/// N/F0, T/N with marks at +-sqrt 3, angle: a row of figures; empty without forces.
std::string force_figures(const PowderRun& run);
/// I(k), its samples and its fit; empty without.
std::string scattering_figure(const PowderRun& run);

}  // namespace softgrain::report
