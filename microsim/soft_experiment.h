// The arrangement of a measurement: a soft particle against a plane, or against an equal soft particle [SP 1.4].
#pragma once

#include <vector>

#include "common/data/measurements.h"
#include "common/data/snapshot.h"
#include "common/dynamics/slow_dynamics.h"
#include "common/system.h"

namespace softgrain {

/// Body 1 sits at the origin; the second body comes from +x. Slots: grains of body 1, grains of body 2, shells, plane.
struct SoftExperiment {
  PairKind kind = PairKind::soft_solid;
  SoftParticleSpec spec;
  System3 system;
  Slot first_grains = 0;        ///< grains [0, first_grains) belong to body 1
  double normal_overlap = 0.0;  ///< hn [m]

  /// Gives all contacts Tsuji damping with the spec's restitution, or takes it away. The list of neighbours is made
  /// anew.
  void set_damping(bool damped);

  /// Net force on the second body from the first, of the state as it is; x is along the normal (compression positive)
  /// [N].
  [[nodiscard]] Vec3 force_on_second() const;

  /// The displacement of every body when the second one moves rigidly by `distance` towards the first.
  [[nodiscard]] std::vector<Vec3> second_moves(double distance) const;

  /// Moves the second body rigidly by `distance` towards the first (shell and grains, or plane) in one stroke;
  /// tangential springs follow. Contacts must be without dashpots.
  void push(double distance);

  /// The velocities and spins with which all grains of body 1 turn about the z axis through its centre at `rate`
  /// [rad/s], in the directions of the state as it is. They are added to the motion that grains have of their own, so
  /// that the pack rearranges while it turns. A positive rate drags the second body towards +y. A shell that does not
  /// turn holds its grains back by friction, which this drive does not overcome: they hardly turn then.
  [[nodiscard]] Drive turning(double rate, bool shell_turns) const;
};

/// Rs sqrt(rho/E), the unit in which all times of a measurement scale [s].
double natural_time(const SoftParticleSpec& spec);

/// Tsuji damping with the spec's restitution when `damped_contacts`, none otherwise (for relaxations with damping of
/// their own).
SoftExperiment make_soft_solid(const SoftParticleSpec& spec, const ShellPacking& packing, bool damped_contacts);
SoftExperiment make_soft_soft(const SoftParticleSpec& spec, const ShellPacking& first, const ShellPacking& second,
                              bool damped_contacts);

/// Grains with the soft particle they are inside (body 0, and 1 of a pair), shells as walls with their body, the plane
/// with none. Label, series and frame are for the caller. Changes nothing.
Snapshot soft_snapshot(const SoftExperiment& experiment);

}  // namespace softgrain
