// A macro packing as a system: with fitted laws, or with every soft particle resolved inside a moving shell.
#pragma once

#include <vector>

#include "common/contact/soft_contact.h"
#include "common/data/shell_packing.h"
#include "macrosim/box.h"
#include "macrosim/macro_packing.h"

namespace softgrain {

struct MacroSystem {
  System3 system;
  Box box;
  std::int64_t inner_grains = 0;  ///< resolved inside soft particles
};

/// The two laws of soft particles in a macro scene, frictions set; damping 0 for quasi-static loading.
struct SoftLaws {
  SoftContact soft_solid;
  SoftContact soft_soft;
};

/// Materials 0 solid grain, 1 soft particle, 2 wall. A soft particle has the mass of its content. Planes use the
/// soft-solid law.
MacroSystem make_law_system(const MacroSpec& spec, const MacroPacking& packing, const SoftLaws& laws,
                            double inner_solid_fraction);

/// The shelled twin: soft particle k holds packing k (cyclically), turned at random, scaled to its radius, in a rigid
/// shell that moves with the forces on it and has the mass of its content [SP 1.9]. Materials 0 grain, 1 wall.
MacroSystem make_shelled_system(const MacroSpec& spec, const MacroPacking& packing,
                                const std::vector<ShellPacking>& contents, std::uint64_t seed, std::uint64_t sample);

}  // namespace softgrain
