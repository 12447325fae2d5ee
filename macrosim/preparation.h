// How the bodies of a macro scene get into their box: random places, then compaction as hard grains.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/contact/law_set.h"
#include "common/core/cost.h"
#include "common/core/random.h"
#include "common/dynamics/contact_watch.h"
#include "common/dynamics/damped_relaxation.h"
#include "macrosim/box.h"
#include "macrosim/macro_packing.h"
#include "macrosim/macro_spec.h"

namespace softgrain {

inline constexpr RandomPurpose kMacroRadii{4};
inline constexpr RandomPurpose kMacroPositions{5};
inline constexpr RandomPurpose kMacroFines{9};

/// Inverse cumulative distribution of P(r) ~ r^-b on [rmax/polydispersity, rmax] at u in (0, 1).
double power_law_radius(double exponent, double rmax, double polydispersity, double u);

/// Places bodies at random in a cube that they fill to `fraction`, largest first, without overlap. In a periodic cell
/// they do not overlap across its faces either. Where so few bodies that walls are near find no place, the cube is
/// larger. Throws UnusableResult.
MacroPacking place_loosely(std::vector<MacroBody> bodies, std::uint64_t seed, std::uint64_t sample,
                           double fraction = 0.30, Boundary boundary = Boundary::walls);

/// Shortest period of a cell, in the radius of the largest body: its images stay two diameters apart, and neighbours
/// are looked for a little beyond.
inline constexpr double kShortestPeriod = 4.1;
/// Share of a cell that bodies are taken to fill when their room is judged before they are packed: more than most
/// preparations reach.
inline constexpr double kPackedShare = 0.75;

/// Images of a body must stay two diameters of the largest one apart. Throws InputError when the bodies of a periodic
/// cell are so few that they would not once they are packed.
void require_room_for_images(const std::vector<MacroBody>& bodies);

/// Friction while compacting of preparation "rodded": the solid fraction of equal spheres is then half-way between that
/// of mu = 0 and that of mu = 0.3 and more.
inline constexpr double kRoddedFriction = 0.1;

/// What the named preparations are. `friction`: of the test.
/// - frictionless: all bodies are relaxed together with the walls, without friction, under a pressure that begins high,
///   falls by three tenths whenever all is roughly at rest, and ends at the one asked for. A high pressure closes the
///   gaps in a few hundred passes and a well-connected packing comes to rest soon; under the last one alone the bodies
///   would creep through ever so many rearrangements.
/// - fast, slow: the box is shrunk at the rate of an inertial number by molecular dynamics, all bodies moving along at
///   first, until its walls bear the pressure; then all is relaxed under it. Both have the friction of the test (its
///   walls too, see preparation_wall_friction) and differ in the rate alone.
/// - dense: the largest bodies, up to coarse_share of the volume, jam by themselves; the others grow in the voids
///   between them, which stand still, until they have their size or jam; then all are freed and relaxed as in
///   frictionless.
/// - poured, rodded, vibrated: by friction while compacting, which sets the density of a packing (Agnolin and Roux
/// 2007,
///   Phys. Rev. E 76, 061302). poured is fast; rodded is fast with the friction of the test or kRoddedFriction, if that
///   is less; vibrated is frictionless.
PreparationProtocol protocol_of(Preparation preparation, double friction);

/// Friction of bodies with walls during a preparation: that of the test, or what the walls held would be lost when it
/// begins; 0 where the preparation has none, or no walls.
double preparation_wall_friction(const MacroSpec& spec);

/// What is said when a compaction ends without jamming.
std::string not_jammed_text(const MacroSpec& spec);

/// All bodies as hard grains without friction.
AnyLaw hard_law(const MacroSpec& spec);

/// Isotropic compaction of all bodies as hard grains by spec.protocol until the wall pressure is start_pressure * E.
/// What it took is added to packing.cost. Goes on from what watch.keeper kept, in the same bits; `coarse`: these are
/// the coarse bodies of "dense". Throws UnusableResult, saying what was reached, when it does not jam.
void bring_into_touch(const MacroSpec& spec, MacroPacking& packing, const PreparationWatch& watch = {},
                      bool coarse = false);

/// The whole of "dense": bodies are given largest first, without places. Throws UnusableResult.
MacroPacking pack_densely(const MacroSpec& spec, std::vector<MacroBody> bodies, std::uint64_t seed,
                          std::uint64_t sample, const PreparationWatch& watch = {});

/// Compaction in steps without friction, only up to a share of the box filled with bodies, below jamming. Throws
/// UnfitScene when they jam before.
void compact_to_fraction(const MacroSpec& spec, MacroPacking& packing, double fraction);

// How bodies are pressed into touch, by our own engine and in LAMMPS: bodies and box relax together under a pressure
// that begins high, falls whenever all is roughly at rest, and ends at the one asked for.

/// Tolerance of forces and stress before the last pressure, and how the pressure falls.
constexpr double kLoosePressing = 0.1;
constexpr double kPressureFall = 0.7;

/// Relative tolerance of the stress on the box. `last`: under the pressure asked for.
inline double pressing_stress_tolerance(const MacroSpec& spec, bool last) {
  return last ? spec.protocol.tolerance / 3.0 : kLoosePressing;
}

/// Relaxation of so many bodies of this mean radius [m] in a box whose faces bear `load` [N], its pressure times the
/// area of one.
DampedOptions pressing_options(const MacroSpec& spec, bool last, double load, double bodies, double mean_radius);

// All bodies of a macro packing as hard grains in their box: what preparations move and press. Materials 0 body, 1
// wall, or as many as MacroSpec::grain_materials and the wall behind them. With `friction` among bodies, of which pairs
// of materials that have less take what they have, walls have preparation_wall_friction().

struct HardBodies {
  System3 system;
  Box box;
  double seconds_before = 0.0;  ///< what it took before it was taken up from a file

  explicit HardBodies(const MacroSpec& spec, const MacroPacking& packing, double friction = 0.0,
                      double restitution = 1.0);

  static AnyLaw law(const MacroSpec& spec, double friction, double restitution);

  [[nodiscard]] Vec3 size() const { return box_high(system, box) - box_low(system, box); }
  [[nodiscard]] double pressure();        ///< mean stress of all axes in the last pass [Pa]
  [[nodiscard]] double fraction() const;  ///< share of the box that bodies fill
  [[nodiscard]] double seconds() const { return seconds_before + watch_.seconds(); }
  /// Copies the places of bodies, the springs and the box to the packing, and adds the cost.
  void take_over(MacroPacking& packing) const;

 private:
  [[nodiscard]] std::vector<BodySpring> springs() const;

  bool frictional_ = false;
  ContactVirial<3> virial_;
  Stopwatch watch_;
};

}  // namespace softgrain
