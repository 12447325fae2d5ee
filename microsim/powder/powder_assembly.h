// Bringing a powder together: phases of imposed pressure or fixed cell, each until the published equilibrium
// [CP 3.2, 3.3].
#pragma once

#include <string>
#include <vector>

#include "common/core/enum_names.h"
#include "common/dynamics/stress_cell.h"
#include "common/state/run_control.h"
#include "microsim/powder/powder_contacts.h"
#include "microsim/powder/powder_start.h"
#include "microsim/powder/powder_state_io.h"

namespace softgrain {

constexpr double kPowderForceLimit = 1e-4;    ///< limit of net force, moment and pressure error, in F1, F1 a and F1/a
constexpr double kPowderKineticLimit = 5e-8;  ///< limit of the kinetic energy per disk, in F1 a

/// How far a powder is from the published equilibrium [CP 3.2], each over its limit: equilibrium when all are below 1.
struct PowderResidual {
  double force = 0.0;     ///< largest net force over 1e-4 F1
  double moment = 0.0;    ///< largest net moment over 1e-4 F1 a
  double pressure = 0.0;  ///< largest |imposed - measured| over 1e-4 F1/a (a: largest diameter)
  double kinetic = 0.0;   ///< kinetic energy per body over 5e-8 F1 a, without bodies in free flight (rattlers)

  [[nodiscard]] bool equilibrium() const { return force < 1.0 && moment < 1.0 && pressure < 1.0 && kinetic < 1.0; }
};

/// F1 = max(F0, P a). From the forces of the last pass; velocities relative to the moving cell. `lengths_free`: whether
/// the pressure counts.
PowderResidual powder_residual(const System<2>& system, const Vec<2>& imposed, const Vec<2>& measured, double f1,
                               double largest_diameter, bool lengths_free);

/// A stretch of an assembly.
struct PowderPhase {
  std::string name;             ///< "compaction", "aggregation", "free" or "stiffening", "load"
  bool fixed_cell = false;      ///< the cell keeps its lengths; pressure is no criterion
  bool one_aggregate = false;   ///< whether to wait until all disks form one aggregate, too
  double pressure = 0.0;        ///< imposed, in the units of the sample
  double stiffness = 0.0;       ///< kappa of all contacts
  double stiffening = 0.0;      ///< T0 in which kappa goes there from where it was, evenly in its logarithm; 0: at once
  double edge_speed_cap = 0.0;  ///< largest |dL/dt| [a/T0]; 0: none
};

/// How a sample comes together.
struct PowderProtocol {
  int method = 1;
  /// Pressures one after the other, each until equilibrium [PRE 78, 031305]; empty: that of the sample.
  std::vector<double> pressures{};
  double edge_speed_cap = 0.0;     ///< largest |dL/dt| of the lengths of the cell [a/T0]; 0: none
  double aggregation_kappa = 0.0;  ///< method 2: stiffness while disks aggregate; 0: as always
  double stiffening_time = 200.0;  ///< T0 in which kappa goes to that of the sample, as the cell is freed
};

/// Method 1: at rest, the pressure at once. Method 2: the disks aggregate in a fixed cell, then the cell is freed at
/// P = 0, then the pressures. With aggregation_kappa (published as series B) contacts are soft at first, which allows
/// long steps, and stiffen at P = 0 before the pressure.
std::vector<PowderPhase> powder_phases(const PowderSpec& spec, const PowderProtocol& protocol);

struct PowderOptions {
  /// dt over sqrt(m_min/K_N). Above 0.147 the normal dashpots of the smallest disks, surrounded by such, are unstable
  /// in the predicted velocities (zeta 0.8): single contacts then chatter and a sample never rests.
  double step = 0.12;
  /// Mc of Mc d2(eps)/dt2 = Sigma_imposed - Sigma_measured over the sum of all masses, strain against the lengths with
  /// which a phase begins. Fitted, not derived: the publication says 0.3, "divided by a linear size L", and the eight
  /// published packs of method 1 come out with 1.5 to 3 (results/powder).
  double cell_inertia = 2.0;
  double time_max = 3000.0;       ///< per phase [T0]
  double record_every = 10.0;     ///< [T0]
  std::int64_t test_every = 200;  ///< steps between two looks at the criteria
  /// Once for `settle_after` T0 the lengths of the cell have kept to 1e-4, or the number of contacts has not changed,
  /// and the kinetic energy per disk is below `settle_kinetic` F1^2/K_N, with cohesion also below a tenth of what
  /// breaks a contact, F0 D0/2, the last vibrations are damped: `settle_drag` m v/T0 on disks, 20 times that on the
  /// cell. They rearrange next to nothing any more, but tangential and rolling springs without damping ring for
  /// hundreds of T0. 0: never.
  double settle_drag = 0.05;
  double settle_kinetic = 0.1;
  double settle_after = 10.0;
};

/// One recorded moment.
struct PowderPoint {
  std::int64_t phase = 0;
  double time = 0.0;      ///< [T0]
  double fraction = 0.0;  ///< Phi
  double coordination = 0.0;
  double kinetic = 0.0;  ///< energy per disk, relative to the moving cell, rattlers too
  Vec<2> stress{};
};

/// A pressure at which a sample came to rest.
struct PowderStage {
  std::int64_t phase = 0;
  double pressure = 0.0;  ///< imposed
  double time = 0.0;      ///< [T0]
  double fraction = 0.0;  ///< Phi
  double coordination = 0.0;
  double mean_repulsive = 0.0;
  double mean_tensile = 0.0;
  double bulk = 0.0;
  double shear = 0.0;
};

/// Without the phase, by the names of summaries.
void fields(auto&& visit, Of<PowderStage> auto& s) {
  visit("pressure", s.pressure, Means{"imposed pressure P*", "1"});
  visit("time", s.time, Means{"time at its end", "T0"});
  visit("Phi", s.fraction, Means{"solid fraction", "1"});
  visit("z", s.coordination, Means{"coordination number, distant pairs included", "1"});
  visit("mean_repulsive", s.mean_repulsive, Means{"mean of the forces that push", "F0, without cohesion P a"});
  visit("mean_tensile", s.mean_tensile, Means{"mean of the forces that pull, negative", "F0, without cohesion P a"});
  visit("bulk", s.bulk, Means{"bulk modulus; null: not defined", "F0/a, without cohesion P"});
  visit("shear", s.shear, Means{"shear modulus; null: not defined", "F0/a, without cohesion P"});
}

/// Everything a sample needs to go on.
struct PowderState {
  System<2> system;
  std::int64_t phase = 0;
  double phase_start = 0.0;      ///< time at which the phase began
  double stiffness = 0.0;        ///< kappa now
  double phase_stiffness = 0.0;  ///< kappa when the phase began
  Vec<2> phase_edge{};           ///< lengths of the cell then: the reference of the strain
  bool settling = false;         ///< under drag
  double still_since = 0.0;      ///< lengths have kept to `still_edge`, or contacts to `still_contacts`, since then
  Vec<2> still_edge{};
  std::int64_t still_contacts = 0;
  std::vector<PowderPoint> points;
  std::vector<PowderStage> stages;  ///< results of phases that imposed a pressure and are over
  /// States at the start, after each phase, and when Phi or z have changed visibly.
  Trajectory snapshots;
  double pictured = 0.0;  ///< z of the last snapshot
};

struct PowderResult {
  bool usable = false;
  std::string reason;  ///< criterion that was unmet when the time ran out
  double fraction = 0.0;
  Vec<2> stress{};
  PowderResidual residual;
};

PowderState start_powder(const PowderSpec& spec, std::uint64_t seed, std::uint64_t sample);

/// Whether contacts and attracting pairs join all disks into one.
bool one_aggregate(const System<2>& system);

/// Gives all contacts another stiffness (K_T and K_r follow); springs keep their force, not their length.
void set_stiffness(PowderState& state, const PowderSpec& spec, double kappa);

/// Goes through the phases from where the state stands (all done: only looks at it). Saved after each recorded point.
/// Nobody knows when a phase comes to rest: the share done takes what most take. Throws UnusableResult, Interrupted.
PowderResult run_powder(PowderState& state, const PowderSpec& spec, const std::vector<PowderPhase>& phases,
                        const PowderOptions& options, const RunControl<PowderState>& control = {});

}  // namespace softgrain
