// What a macro scene asks for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/data/macro_result.h"
#include "common/data/measurements.h"

namespace softgrain {

enum class Construction {
  mixed,  ///< solid grains and soft particles are drawn, placed and compacted together
  voids   ///< solid grains first, then soft particles fill the voids between them, largest hole first
};

template <>
inline constexpr auto words<Construction> = word_list<Construction>({{Construction::mixed, "mixed"},
                                                                     {Construction::voids, "voids"}});

/// Who makes a starting state, who runs a test.
enum class MacroEngine { softgrain, lammps };

template <>
inline constexpr auto words<MacroEngine> = word_list<MacroEngine>({{MacroEngine::softgrain, "softgrain"},
                                                                   {MacroEngine::lammps, "lammps"}});

/// Solid grains and soft particles of any sizes in a box of six planes, compressed [SP 1.9]. SI units.
struct MacroSpec {
  Construction construction = Construction::mixed;
  std::int64_t bodies = 200;                         ///< mixed: solid grains + soft particles; voids: solid grains
  MacroEngine preparation = MacroEngine::softgrain;  ///< lammps: we place bodies loosely, and LAMMPS compacts them
  double soft_share = 0.45;                          ///< of the volume of all bodies, soft ones by their shell
  double exponent = 3.5;                             ///< b of the radii of both kinds
  double solid_radius_max = 0.016;                   ///< [m]
  double solid_polydispersity = 2.0;                 ///< rmax/rmin of the solid grains
  double soft_radius_max = 0.016;                    ///< [m]
  double soft_polydispersity = 1.5;                  ///< of the shells; voids: smaller holes stay empty
  std::optional<Grading> solid_sizes;  ///< radii of another law, whose ends stand in the two numbers above
  std::optional<Grading> soft_sizes;
  double solid_fill = 0.0;  ///< voids: share of the box that solid grains fill before soft ones come; 0: by soft_share
  double youngs_modulus = 5.0e5;  ///< E of solid grains, walls and of what is inside the soft particles [Pa]
  double poisson_ratio = 0.3;
  double friction = 0.3;  ///< mu of solid contacts; stands in for mu_soft
  double wall_friction = 0.0;
  double density = 2500.0;
  double start_pressure = 1.0e-5;  ///< of the frictionless preparation, over E
  MacroTest test = MacroTest::oedometric;
  double strain_end = 0.15;              ///< nominal; of shear: logarithmic
  double preload = 0.0;                  ///< shear: isotropic nominal strain before
  std::int64_t preload_steps = 4;        ///< recorded points of it
  std::int64_t steps = 30;               ///< recorded points
  std::int64_t increments_per_step = 2;  ///< relaxed strain increments per recorded point
  double tolerance = 1e-2;               ///< largest net force over mean contact force at recorded points
  double force_floor = 1.0e-4;  ///< the mean contact force never counts for less than this, over E R^2 (R the largest
                                ///< radius): else loose states before the first stress would be relaxed for ever
  std::int64_t max_passes = 20000;  ///< per relaxation
  bool kt_secant = false;           ///< tangential law: secant at 1 degree instead of the initial slope
};

}  // namespace softgrain
