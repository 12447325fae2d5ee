// The content of one level of a hierarchy: the grains of a decade and soft particles that carry the mass of the next
// one [SP 1.8].
#pragma once

#include "common/data/measurements.h"
#include "microsim/soft_content.h"

namespace softgrain {

struct ShellFilling {
  double inner_radius = 0.1;      ///< radius of the soft particles over that of their shell
  double soft_over_grains = 0.0;  ///< volume of the soft particles over that of the grains
  double onset = 0.0;  ///< overlap with each neighbour, over inner_radius, at which soft particles begin to bear
};

/// Volume of the next finer range of radii over that of one whose largest radius is `ratio` times the smallest, for
/// P(r) ~ r^-exponent: ratio^(exponent - 4). 0.316 for a decade and r^-3.5.
double next_volume(double exponent, double ratio);

/// Grains of the distribution of `spec` and soft particles of one radius, in these shares of volume. Soft particles are
/// packed by what is left of them at their onset, so that they, too, are about to bear where grains touch: bodies that
/// were packed by their whole radii would be looser from level to level. Together they take up as much of the shell as
/// the grains of `published` do, the packing of grains alone of that number; where they jam before, all are that much
/// smaller. Then each grows to its nearest neighbour, as the published grains do.
SoftContent fill_shell(const SoftParticleSpec& spec, const ShellFilling& filling, const ShellPacking& published,
                       std::uint64_t seed);

}  // namespace softgrain
