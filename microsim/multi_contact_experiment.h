// One soft particle with several neighbours at once [SP 1.7, 1.7.1]: planes, solid spheres or other soft particles that
// are pressed in along a given path while the grains relax.
#pragma once

#include <string>
#include <vector>

#include "common/contact/law_set.h"
#include "common/data/measurements.h"
#include "common/data/multi_contact_measurements.h"
#include "common/state/run_control.h"
#include "common/system.h"
#include "microsim/filled_shell.h"
#include "microsim/protocol.h"

namespace softgrain {

/// How soft particles inside soft particles interact. Laws must be without damping.
struct InnerLaws {
  AnyLaw soft_plane;  ///< body i is the soft one: against planes and the insides of shells
  AnyLaw soft_solid;  ///< body i is the soft one: against grains and solid spheres
  AnyLaw solid_soft;  ///< the law soft_solid with body j as the soft one
  AnyLaw soft_soft;   ///< two soft particles, also of different parents
  /// Solid fraction of an inner soft particle, for its mass (no effect on states of rest).
  double solid_fraction = 1.0;
};

/// How neighbours move and states are relaxed.
struct MultiContactOptions {
  /// slow_dynamics: molecular dynamics all along the way, masses of the quickest grains raised (the means of the
  /// published protocol within their errors, see results/relaxation). damped: increments, each relaxed without inertia
  /// (stiff by 10 to 60 % near a threshold). published: real masses, six stops; the reference. Never least_work.
  Relaxation relaxation = Relaxation::slow_dynamics;
  double increment = 0.005;  ///< largest change of an overlap (or slide) between two relaxations [Rs]; of dynamics:
                             ///< between two points at which a run can be left and taken up again
  double tolerance = 1e-2;   ///< largest net force over mean contact force in a recorded state
  double tolerance_between = 0.3;   ///< damped: tolerance of all states between
  std::int64_t max_passes = 20000;  ///< largest number of passes per relaxation
  /// Smallest stiffness in a damped relaxation: no body counts as softer than this times E times its radius. It is
  /// about the stiffness of a contact at an overlap of 0.4 % of the radius. Without it loose grains keep hitting each
  /// other near the onset, where hardly any grains touch, and a relaxation takes 2 to 5 times as many passes to the
  /// same mean force.
  double least_stiffness = 0.05;
  double approach_speed = 0.0;  ///< speed of approach in dynamics [m/s]; 0: as in the published protocol
  double step_factor = 4.0;     ///< slow_dynamics: time step over that of the published protocol
  double settle_time = 240.0;   ///< slow_dynamics: time before a state is recorded [Rs sqrt(rho/E)]
};

/// How, in one line for files and tables.
std::string relaxation_text(const MultiContactOptions& options);

/// Where states are recorded: per stage, ascending shares of the stage in (0, 1]; the end of a stage is recorded only
/// when 1 is among them.
using MultiContactPlan = std::vector<std::vector<double>>;

/// Prescribed position: overlaps, slide and roll of the first neighbour [Rs].
struct MultiContactTarget {
  std::vector<double> overlap;
  double slide = 0.0;
  double roll = 0.0;
};

/// Slots: grains and inner soft particles of the centre, then those of soft neighbours, solid spheres, shells (centre
/// first), planes. Materials: see microsim/multi_contact_build.cpp.
struct MultiContactExperiment {
  /// The bodies that make up one neighbour: all of them move as one when it is moved.
  struct Neighbour {
    Slot begin = 0;  ///< grains of a soft neighbour are [begin, end)
    Slot end = 0;
    Slot body = 0;  ///< its shell, sphere or plane
  };

  SoftParticleSpec spec;
  MultiContactConfiguration configuration;
  System3 system;
  std::vector<Neighbour> neighbours;
  Slot centre_bodies = 0;       ///< bodies [0, centre_bodies) are the content of the centre
  Slot centre_shell = 0;        ///< slot of the shell of the centre
  std::vector<double> overlap;  ///< overlaps as prescribed, towards the shell where it was at first [Rs]
  double slide = 0.0;           ///< slide of the first neighbour [Rs]
  double roll = 0.0;            ///< way of the contact of the first neighbour over the surface of the centre [Rs]
  LawSet undamped;              ///< laws of system while it rests; no other ones while it is kept
  LawSet damped;                ///< laws of `undamped` with the dashpots of contacts between grains

  /// Direction from the first place of the shell to neighbour k; a sphere that slides goes round, and so does every
  /// first neighbour that rolls.
  [[nodiscard]] Vec3 direction(std::size_t k) const;

  /// Gives contacts between grains Tsuji damping with the spec's restitution, or takes it away. The list of neighbours
  /// is made anew.
  void set_damping(bool on);

  /// Where what neighbour k touches has its centre now: the shell of the middle, or that of a soft neighbour.
  [[nodiscard]] Slot touched_shell(std::size_t k) const;

  /// How every body has to move for this position [m]; from now on it is what is prescribed. A plane that rolls is put
  /// there at once: what it is made of stands still where it touches. Soft neighbours with planes around them go where
  /// those press them.
  [[nodiscard]] std::vector<Vec3> prescribe(const MultiContactTarget& to);

  /// Moves every neighbour there in one stroke; springs follow. Never while rolling.
  void move_to(const MultiContactTarget& to);

  [[nodiscard]] MultiContactTarget now() const { return {overlap, slide, roll}; }

  /// Forces, overlaps, residual of the state as it is; `stage` and `converged` are left to the caller.
  [[nodiscard]] MultiContactPoint observe() const;
};

/// Where a neighbour of the centre sits for an overlap and a direction [m]; of planes a point of them.
Vec3 neighbour_place(const SoftParticleSpec& spec, const MultiContactPartner& partner, const Vec3& direction,
                     double overlap);

/// All neighbours touch and none overlaps. `others`: content of the soft neighbours in their order. `laws` are needed
/// when some content has inner soft particles. Neighbours never interact with each other.
/// Throws InputError (directions that are no unit vectors, ratios, too few contents, no laws).
MultiContactExperiment make_multi_contact(const SoftParticleSpec& spec, const MultiContactConfiguration& configuration,
                                          const SoftContent& centre, const std::vector<const SoftContent*>& others,
                                          const InnerLaws* laws = nullptr);

/// Where in its plan a run stands; with the experiment it is all that the run needs to go on.
struct MultiContactPlace {
  MultiContactRun run;            ///< what was recorded so far
  std::size_t stage = 0;          ///< stage under way
  std::size_t leg = 0;            ///< leg of the stage: the way to this record, or to the end after all of them
  std::int64_t increments = 0;    ///< increments of the leg that are done
  MultiContactTarget stage_from;  ///< position where the stage began
  MultiContactTarget leg_from;    ///< position where the leg began
};

/// What a run needs to go on: its place, and the experiment as it is there.
struct MultiContactUnderWay {
  const MultiContactPlace& place;
  const MultiContactExperiment& experiment;
};

/// Goes through all stages from `start` on: straight lines in overlap, a relaxation after each increment. The state is
/// saved between increments; progress is told after each recorded point. Throws UnusableResult (a grain is lost),
/// Interrupted and what the control throws. `configuration` and `packing` of the run are left to the caller.
MultiContactRun run_multi_contact(MultiContactExperiment& experiment, const MultiContactPlan& plan,
                                  const MultiContactOptions& options,
                                  const RunControl<MultiContactUnderWay>& control = {}, MultiContactPlace start = {});

/// Number of relaxations of a path, for progress.
std::int64_t count_increments(const MultiContactConfiguration& configuration, const MultiContactPlan& plan,
                              const MultiContactOptions& options);

}  // namespace softgrain
