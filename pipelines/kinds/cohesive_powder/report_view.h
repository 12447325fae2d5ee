// Pictures of disks in a periodic rectangle, with the forces between them.
#pragma once

#include <string>
#include <vector>

#include "pipelines/kinds/cohesive_powder/powder_data.h"

namespace softgrain::report {

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
std::string snapshot_view(const PowderSnapshot& snapshot, double scale, double width, const std::string& title);

}  // namespace softgrain::report
