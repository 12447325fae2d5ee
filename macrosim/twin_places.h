// Laws at the places of a resolved twin: what they say where the twin has its bodies, apart from where a run of their
// own would have taken them. A law that is right pushes there as hard as the twin does.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/data/macro_result.h"
#include "macrosim/macro_spec.h"
#include "macrosim/macro_system.h"

namespace softgrain {

/// Sums of the normal forces on soft particles [N], by who pushes.
struct SoftForces {
  double solid = 0.0;
  double wall = 0.0;
  double soft = 0.0;
};

/// Normal forces on the soft particles of a law run or of a twin, between whole bodies.
SoftForces soft_forces(const MacroSystem& macro, const MacroPacking& packing);

/// The packing with every body where the shelled twin has it, in the twin's box.
MacroPacking packing_of_twin(const MacroSystem& twin, const MacroPacking& packing);

/// A law and the name of the engine that runs with it.
struct PlacedLaw {
  std::string name;
  SoftLaws laws;
};

/// Adds a point to the columns places_NAME_{solid,wall,soft} of the curve of a shelled twin (NAME: its engine), and
/// where its bodies are to `places`.
void record_places(const MacroSystem& twin, const MacroPacking& packing, MacroCurve& curve);

/// The columns of every law (NAME: its name), at the places that the curve of a twin keeps: no springs, no friction,
/// forces of one instant.
void place_laws(const MacroSpec& spec, const MacroPacking& packing, double inner_solid_fraction,
                const std::vector<PlacedLaw>& laws, MacroCurve& curve);

/// Name of such a column.
std::string places_column(const std::string& engine, const char* partner);
inline constexpr std::array kPlacesPartners{"solid", "wall", "soft"};

// How a resolved twin is strained in motion.

/// Strains the box by the factors 1 - strain and lets a periodic cell slide by `shear`, at the twin's speed, bodies
/// carried along as a whole at first, and lets all move on for the settling time; then nothing moves. It is left near
/// its rest: a relaxation follows. The twin must have dashpots. Throws UnusableResult (a grain is lost) and
/// Interrupted.
void strain_in_motion(MacroSystem& macro, const MacroSpec& spec, const Vec3& strain, double shear = 0.0);

/// Rate of shear (shear_rate()) of the motion of such an increment [1/s]; 0 where nothing goes by strain.
double straining_rate(const MacroSystem& macro, const MacroSpec& spec, const Vec3& strain, double shear = 0.0);

}  // namespace softgrain
