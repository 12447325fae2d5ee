// What a soft particle holds: in a hierarchy the grains of a decade and soft particles that carry the mass of the next
// one [SP 1.8].
#pragma once

#include <cstdint>
#include <vector>

#include "common/core/random.h"
#include "common/core/vec.h"
#include "common/data/measurements.h"

namespace softgrain {

/// A soft particle inside a soft particle.
struct InnerSoft {
  Vec3 x{};        ///< position from the centre of the shell that holds it, in units of that shell
  double r = 0.0;  ///< radius in the same units
};

struct SoftContent {
  ShellPacking grains;
  std::vector<InnerSoft> inner;              ///< soft particles of the next level, whose contacts follow a law
  std::vector<ShellPacking> inner_packings;  ///< unless their grains are here: inner soft particle k holds packing k,
                                             ///< turn by turn, in a shell that moves with the forces on it
};

/// The content turned as a whole about the centre of its shell: orientation 0 is as it is, every other one a rotation
/// drawn evenly from all of them, the same for the same seed, packing and orientation.
SoftContent turned(const SoftContent& content, std::uint64_t seed, std::int64_t packing, std::int64_t orientation);

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

// Spheres of given sizes in a rigid shell, denser than random trials place them: they grow while they push each other
// aside.

struct CompactedShell {
  ShellPacking packing;  ///< spheres in the order of the radii that were given; none overlaps another one or the shell
  double share = 1.0;    ///< share of the radii asked for that is reached; below 1 where the spheres jam before
};

/// Places spheres of these radii (over that of the shell, largest first) at random, small, and lets them grow by steps,
/// frictionless, each followed by a damped relaxation, until they have their radii or do not come free of overlap any
/// more. Depends on its arguments alone. Throws InputError when there is nothing to place or a radius is not below 1.
CompactedShell compact_in_shell(const std::vector<double>& radius, RandomStream& random);

}  // namespace softgrain
