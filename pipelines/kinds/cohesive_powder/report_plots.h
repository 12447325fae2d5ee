// Plots of cohesive powders, and pictures of disks in a periodic rectangle with the forces between them.
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

enum class PowderLines {
  forces,   ///< stressed contacts as wide as their normal force
  stressed  ///< all contacts as thin lines: who carries force and who does not
};

/// The packing at the end of a sample as an svg: compressive forces red, tensile green, distant pairs blue (dashed);
/// with PowderLines::stressed unstressed contacts blue. Disks without a force above `zero` grey. Disks and lines that
/// cross the boundary are drawn on both sides and cut there.
std::string packing_view(const PowderSample& sample, PowderLines lines, double zero, const std::string& title);

/// What a line of kStrongLine a stands for: the normal force that one interaction in twenty exceeds; 0 without any.
double strong_force(const std::vector<ContactRecord<2>>& contacts);
inline constexpr double kStrongLine = 0.22;

/// Disks alone, small; `scale` [px per a] is the caller's, so that a row of pictures shows a cell that shrinks.
std::string snapshot_view(const Snapshot& snapshot, double scale, double width, const std::string& title);

}  // namespace softgrain::report
