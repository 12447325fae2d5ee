// How a measurement comes to rest: the published protocol (the reference) and faster ones, behind one small interface.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/data/measurements.h"
#include "common/dynamics/slow_dynamics.h"
#include "microsim/soft_experiment.h"

namespace softgrain {

/// The names a scene may give as `relaxation`, and under which series are recorded. Slow dynamics is the least-work
/// protocol without a single increment by least work (increment_passes = 0), which no result may pass off as that.
enum class Relaxation { least_work, slow_dynamics, damped, published };

template <>
inline constexpr auto enum_names<Relaxation> = enum_name_list<Relaxation>({{Relaxation::least_work, "least-work"},
                                                                           {Relaxation::slow_dynamics, "slow-dynamics"},
                                                                           {Relaxation::damped, "damped"},
                                                                           {Relaxation::published, "published"}});

struct PublishedOptions {
  double approach_speed = 0.0;  ///< [m/s]; 0: 0.002 m/s at the published Rs, rho, E, scaled with sqrt(E/rho) otherwise
  double stop_interval = 0.0;   ///< [s]; 0: 0.3 s at the published Rs, rho, E, scaled with Rs sqrt(rho/E) otherwise
  int stops = 6;                ///< stops of all motion, each after one interval; one more interval follows
  double step_fraction = kPublishedStep;              ///< dt over sqrt(m_min/k), k at 5 % overlap of the smallest grain
  double crowded_fraction = kMultiContactedFraction;  ///< largest dt over sqrt(m/K), K the sum of all
                                                      ///< contact stiffnesses of a grain
  double tolerance = 1e-2;  ///< a point is called converged below this (largest net force over mean contact force)
};

struct DampedProtocolOptions {
  double increment = 0.005;         ///< largest change of Delta between two relaxations
  double tolerance = 1e-3;          ///< tolerance at a recorded point
  double tolerance_between = 0.3;   ///< tolerance at increments between recorded points
  double tolerance_rotated = 1e-4;  ///< tolerance at recorded points after a rotation
  std::int64_t max_passes = 20000;  ///< largest number of passes per relaxation
};

/// Settling and rearranging under the least-work protocol happen in real time, measured in natural times Rs
/// sqrt(rho/E).
struct LeastWorkProtocolOptions {
  double increment = 0.0025;           ///< largest change of Delta between two equilibria
  double tolerance_between = 0.1;      ///< tolerance at increments between recorded points
  double tolerance = 1e-2;             ///< tolerance at a recorded point
  std::int64_t increment_passes = 80;  ///< passes of an increment before it is left to dynamics; 0: all are
  double approach_speed = 0.0;  ///< speed of approach of such an increment [m/s]; 0: as for the published protocol
  double step_factor = 4.0;     ///< time step of dynamics over that of the published protocol (masses raised to match)
  double settle_time = 120.0;   ///< time of dynamics before a normal force is recorded; 0: none
  double path_settle_time = 120.0;    ///< part of settle_time after which rotations and further increments start
  double settle_time_rotated = 24.0;  ///< time of dynamics after a rotation
  double step_factor_rotated = 2.0;
  std::int64_t max_passes = 20000;  ///< largest number of passes of the last relaxation of a recorded point
};

/// Time step of a slow turn over that of the published protocol; against 2 no secant moves by more than 1 %.
inline constexpr double kTurnStepFactor = 4.0;

/// Residuals count forces from this floor up: 1e-7 E Rs^2 [SP 1.4].
double force_floor(const SoftParticleSpec& spec);

/// The speed of approach, and of the rim of a shell that turns, under the published protocol at these Rs, rho and E
/// [m/s].
double published_speed(const SoftParticleSpec& spec);

/// Time between two stops of the published protocol at these Rs, rho and E [s].
double published_interval(const SoftParticleSpec& spec);

struct SettleResult {
  Vec3 force{};  ///< force on the second body, x along the normal [N]
  double residual = 0.0;
  double max_overlap = 0.0;
  bool converged = false;
};

/// Is shown a recorded state, for pictures; changes nothing.
using RecordedState = std::function<void(const SoftExperiment&)>;

/// A way of bringing an experiment to a given overlap and to rest.
class Protocol {
 public:
  virtual ~Protocol() = default;
  [[nodiscard]] virtual std::string name() const = 0;
  /// Whether contacts carry physical dashpots under this protocol.
  [[nodiscard]] virtual bool damped_contacts() const = 0;
  /// Moves the second body until the overlap is `overlap` [m], at the protocol's own pace.
  virtual void approach(SoftExperiment& experiment, double overlap) const = 0;
  /// Molecular dynamics for a time [s], with what the drive gives superposed on the motion of the grains. Masses are
  /// raised for steps of kTurnStepFactor, unless a protocol has real ones.
  virtual void run(SoftExperiment& experiment, const Drive& drive, double duration) const;
  /// Relaxes a state that is to be recorded; `rotated` says that it follows a rotation. What is recorded may be a copy
  /// that rested longer than the state from which the experiment goes on; `look`, when given, is shown what is
  /// recorded.
  virtual SettleResult settle(SoftExperiment& experiment, bool rotated, const RecordedState& look) const = 0;
  SettleResult settle(SoftExperiment& experiment, bool rotated) const { return settle(experiment, rotated, {}); }
};

/// Six times { molecular dynamics for an interval; all velocities to zero }, one more interval [SP 1.4]. Name
/// "published".
std::unique_ptr<Protocol> make_published_protocol(const PublishedOptions& options);
/// Increments of overlap, each relaxed by mass-scaled dynamics with adaptive damping. Name "damped".
std::unique_ptr<Protocol> make_damped_protocol(const DampedProtocolOptions& options);

/// Increments by least work where the pack has an equilibrium nearby, slow mass-scaled dynamics where it rearranges,
/// and a short dynamic settling of what is recorded. Name "least-work".
std::unique_ptr<Protocol> make_least_work_protocol(const LeastWorkProtocolOptions& options);

}  // namespace softgrain
