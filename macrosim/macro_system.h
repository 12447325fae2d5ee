// A macro packing as a system: with fitted laws, or with every soft particle resolved inside a moving shell.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/contact/law_set.h"
#include "common/data/measurements.h"
#include "common/data/snapshot.h"
#include "common/dynamics/slow_dynamics.h"
#include "macrosim/box.h"
#include "macrosim/macro_packing.h"

namespace softgrain {

struct MacroSystem {
  System3 system;
  Box box;
  std::int64_t inner_grains = 0;  ///< number of grains resolved inside soft particles
  /// Number of the body in its packing, per slot. Grains inside a soft particle and its shell have the number of the
  /// soft particle; walls, where there are any, follow after the bodies, in the order of the box.
  std::vector<std::int32_t> body;
  std::int32_t bodies = 0;
  double largest_radius = 0.0;  ///< largest radius of the bodies [m]: scale of the force floor for all engines

  /// Laws of a twin that can move by dynamics: without the dashpots of contacts, while it rests, and with them.
  struct Dashpots {
    LawSet off;
    LawSet on;
  };
  std::optional<Dashpots> dashpots{};

  /// Gives contacts of a twin Tsuji damping, or takes it away.
  void set_damping(bool on) { take_laws(system, on ? dashpots->on : dashpots->off); }
};

/// The laws of soft particles in a macro scene, as the contact loop takes them: frictions set, without damping
/// (quasi-static loading). Any law of the loop will do.
struct SoftLaws {
  AnyLaw soft_solid;  ///< body i soft, j solid
  AnyLaw solid_soft;  ///< body i solid, j soft
  AnyLaw soft_wall;
  AnyLaw soft_soft;
};

/// The pair law: each contact by itself. The wall is a solid of friction `wall_friction`.
SoftLaws pair_soft_laws(const CardLaw& soft_solid, const CardLaw& soft_soft, double wall_friction);

/// Materials 0 solid grain, 1 soft particle, 2 wall; from 3 on the second and further MacroSpec::grain_materials. A
/// soft particle has the mass of its content.
MacroSystem make_law_system(const MacroSpec& spec, const MacroPacking& packing, const SoftLaws& laws,
                            double inner_solid_fraction);

/// The shelled twin: soft particle k holds packing k (cyclically), turned at random, scaled to its radius, in a rigid
/// shell that moves with the forces on it and has the mass of its content [SP 1.9]. Materials 0 grain, 1 wall.
MacroSystem make_shelled_system(const MacroSpec& spec, const MacroPacking& packing,
                                const std::vector<ShellPacking>& contents, std::uint64_t seed, std::uint64_t sample);

/// The free twin: the same grains at the same places, without any shell. Materials 0 grain, 1 wall.
MacroSystem make_free_system(const MacroSpec& spec, const MacroPacking& packing,
                             const std::vector<ShellPacking>& contents, std::uint64_t seed, std::uint64_t sample);

// A macro scene, with laws or resolved, as a picture of its state.

/// Solid grains, soft particles (of laws) or the grains inside them (of twins), each with the number of its body in the
/// packing; shells and planes as walls. Label, series, frame and strain are for the caller. Changes nothing.
Snapshot macro_snapshot(const MacroSystem& macro, const MacroPacking& packing);

}  // namespace softgrain
