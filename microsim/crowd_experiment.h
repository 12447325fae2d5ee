// One soft particle with several neighbours at once [SP 1.7, 1.7.1]: planes, solid spheres or other soft particles that
// are pressed in along a given path while the grains come to rest.
#pragma once

#include <vector>

#include "common/contact/law_set.h"
#include "common/data/crowd_measurements.h"
#include "common/data/shell_packing.h"
#include "common/data/slide_direction.h"
#include "common/state/run_control.h"
#include "common/system.h"

namespace softgrain {

/// A soft particle inside a soft particle.
struct InnerSoft {
  Vec3 x{};        ///< in units of the shell that holds it, from its centre
  double r = 0.0;  ///< likewise
};

/// What a soft particle holds.
struct SoftContent {
  ShellPacking grains;
  std::vector<InnerSoft> inner;              ///< of the next level; they act by law
  std::vector<ShellPacking> inner_packings;  ///< unless their grains are here: inner soft particle k holds packing k,
                                             ///< turn by turn, in a shell that moves with the forces on it
};

/// How soft particles inside soft particles interact. Laws must be without damping.
struct InnerLaws {
  AnyLaw soft_plane;            ///< body i is the soft one: against planes and the insides of shells
  AnyLaw soft_solid;            ///< body i is the soft one: against grains and solid spheres
  AnyLaw solid_soft;            ///< the same law with body j soft
  AnyLaw soft_soft;             ///< two soft particles, also of different parents
  double solid_fraction = 1.0;  ///< of an inner soft particle, for its mass (no effect on states of rest)
};

/// How states come to rest: mass-scaled relaxation with adaptive damping.
struct CrowdOptions {
  double increment = 0.005;         ///< largest change of an overlap (or slide) between two relaxations [Rs]
  double tolerance = 1e-2;          ///< of a recorded state: largest net force over mean contact force
  double tolerance_between = 0.3;   ///< of all states between
  std::int64_t max_passes = 20000;  ///< per relaxation
  /// Of the relaxation: no body counts as softer than this times E times its radius. About the stiffness of a contact
  /// at an overlap of 0.4 % of the radius: without it loose grains kick each other about near the onset, where hardly
  /// anything touches, and a relaxation takes 2 to 5 times as many passes to the same mean force.
  double least_stiffness = 0.05;
};

/// Where states are recorded: per stage, ascending shares of the stage in (0, 1]; the end of a stage is recorded only
/// when 1 is among them.
using CrowdPlan = std::vector<std::vector<double>>;

/// Slots: grains and inner soft particles of the centre, then those of soft neighbours, solid spheres, shells (centre
/// first), planes. Materials: see microsim/crowd_build.cpp.
struct CrowdExperiment {
  /// The bodies that make up one neighbour: all of them move as one when it is moved.
  struct Neighbour {
    Slot begin = 0;  ///< grains of a soft neighbour are [begin, end)
    Slot end = 0;
    Slot body = 0;  ///< its shell, sphere or plane
  };

  SoftParticleSpec spec;
  CrowdConfiguration configuration;
  System3 system;
  std::vector<Neighbour> neighbours;
  Slot centre_bodies = 0;       ///< bodies [0, centre_bodies) are the content of the centre
  Slot centre_shell = 0;        ///< slot
  std::vector<double> overlap;  ///< as prescribed, towards the shell where it was at first [Rs]
  double slide = 0.0;           ///< of the first neighbour [Rs]

  /// Direction from the first place of the shell to neighbour k; a sphere that slides goes round.
  [[nodiscard]] Vec3 direction(std::size_t k) const;

  /// Moves every neighbour to these overlaps and the first one to this slide, in one stroke; springs follow.
  void move_to(const std::vector<double>& overlaps, double slide_to);

  /// Forces, overlaps, residual of the state as it is; `stage` and `converged` are left to the caller.
  [[nodiscard]] CrowdPoint observe() const;
};

/// Where a neighbour sits for an overlap and a direction [m]; of planes a point of them.
Vec3 neighbour_place(const SoftParticleSpec& spec, const CrowdPartner& partner, const Vec3& direction, double overlap);

/// All neighbours touch and none overlaps. `others`: content of the soft neighbours in their order. `laws` are needed
/// when some content has inner soft particles. Neighbours never interact with each other.
/// Throws BadInput (directions that are no unit vectors, ratios, too few contents, no laws).
CrowdExperiment make_crowd(const SoftParticleSpec& spec, const CrowdConfiguration& configuration,
                           const SoftContent& centre, const std::vector<const SoftContent*>& others,
                           const InnerLaws* laws = nullptr);

/// Prescribed position: overlaps and slide [Rs].
struct CrowdTarget {
  std::vector<double> overlap;
  double slide = 0.0;
};

/// Where in its plan a run stands; with the experiment it is all that the run needs to go on.
struct CrowdPlace {
  CrowdRun run;                 ///< what was recorded so far
  std::size_t stage = 0;        ///< under way
  std::size_t leg = 0;          ///< of the stage: on the way to this record, or to the end after all of them
  std::int64_t increments = 0;  ///< of the leg that are done
  CrowdTarget stage_from;       ///< where the stage began
  CrowdTarget leg_from;         ///< where the leg began
};

/// What a run needs to go on: its place, and the experiment as it is there.
struct CrowdUnderWay {
  const CrowdPlace& place;
  const CrowdExperiment& experiment;
};

/// Goes through all stages from `start` on: straight lines in overlap, a relaxation after each increment. The state is
/// saved between increments; progress is told after each recorded point. Throws NotUsable (a grain is lost),
/// Interrupted and what the control throws. `configuration` and `packing` of the run are left to the caller.
CrowdRun run_crowd(CrowdExperiment& experiment, const CrowdPlan& plan, const CrowdOptions& options,
                   const RunControl<CrowdUnderWay>& control = {}, CrowdPlace start = {});

/// Number of relaxations of a path, for progress.
std::int64_t count_increments(const CrowdConfiguration& configuration, const CrowdPlan& plan,
                              const CrowdOptions& options);

}  // namespace softgrain
