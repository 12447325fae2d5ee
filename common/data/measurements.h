// Grains inside a shell, and what the particle-scale experiments recorded of them: the data that microsim writes and
// calibrate reads.
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/core/cost.h"
#include "common/core/vec.h"
#include "common/data/pair_kind.h"
#include "common/io/provenance.h"
#include "common/packing/grading.h"

namespace softgrain {

/// Grains inside a unit shell: what the packing generator makes, measurements start from and resolved twins are filled
/// with. Dimensionless: shell of radius 1 centred at the origin; grains largest first.
struct ShellPacking {
  std::uint64_t seed = 0;  ///< number of the packing in its run
  std::vector<Vec3> position;
  std::vector<double> radius;

  /// Volume of grains over volume of the shell.
  [[nodiscard]] double solid_fraction() const {
    double sum = 0.0;
    for (const double r : radius) sum += r * r * r;
    return sum;
  }
};

/// How grains are placed in a shell: the published trials, or the same law without the trials that must fail.
enum class Placement { trials, voids };

template <>
inline constexpr auto enum_names<Placement> = enum_name_list<Placement>({{Placement::trials, "trials"},
                                                                         {Placement::voids, "voids"}});

/// How the first soft particle was brought to an angle before its drag was recorded.
enum class TurnProtocol {
  frozen,  ///< all grains rigidly to the whole angle, nothing relaxing on the way: up to version 0.2.0
  slow     ///< slowly, with molecular dynamics going on, as published [SP 1.4]
};

template <>
inline constexpr auto enum_names<TurnProtocol> = enum_name_list<TurnProtocol>({{TurnProtocol::frozen, "frozen turn"},
                                                                               {TurnProtocol::slow, "slow turn"}});

/// The soft particle that was measured [SP 1.1-1.3]. SI units. Of an experiment only Rs and E are always known: numbers
/// that nobody gave are NaN, trials 0.
struct SoftParticleSpec {
  double shell_radius = 0.016;              ///< Rs [m]
  double youngs_modulus = 5.0e5;            ///< E [Pa]
  double poisson_ratio = 0.3;               ///< nu
  double friction = 0.3;                    ///< mu, Coulomb coefficient
  double density = 2500.0;                  ///< rho [kg/m^3]
  double restitution = 0.5;                 ///< e of the Tsuji damping (dynamic runs)
  std::optional<Grading> sizes;             ///< radii [m] of another law than P(r) ~ r^-b, whose exponent is NaN then
  double exponent = 3.5;                    ///< b of the size distribution P(r) ~ r^-b
  double polydispersity = 10.0;             ///< Pi = rmax/rmin
  double rmax_over_shell = 0.5;             ///< rmax/Rs
  double beta = 3.0;                        ///< volume of drawn grains over the volume of the shell
  std::int64_t trials = 10000;              ///< I, random positions tried per grain
  Placement placement = Placement::trials;  ///< placement of grains: the same law either way, other random numbers
};

/// Whether a number of a soft particle was given.
inline bool is_known(double value) { return !std::isnan(value); }

/// Whether it is known what is inside: law of sizes, how many grains, how they were placed.
inline bool packing_known(const SoftParticleSpec& s) {
  return (s.sizes || is_known(s.exponent)) && is_known(s.polydispersity) && is_known(s.rmax_over_shell) &&
         is_known(s.beta) && s.trials > 0;
}

/// Whether the radii of both follow the same law, in units of their shells.
inline bool same_sizes(const SoftParticleSpec& a, const SoftParticleSpec& b) {
  if (a.sizes && b.sizes) return a.sizes->same_shape(a.shell_radius, *b.sizes, b.shell_radius);
  return !a.sizes && !b.sizes && a.exponent == b.exponent && a.polydispersity == b.polydispersity &&
         a.rmax_over_shell == b.rmax_over_shell;
}

/// A soft particle of which Rs and E are all that is known.
SoftParticleSpec unknown_soft_particle(double shell_radius, double youngs_modulus);

/// One packing as generated.
struct PackingInfo {
  std::uint64_t seed = 0;  ///< index of the packing in the random stream of the run
  std::int64_t grains = 0;
  double solid_fraction = 0.0;      ///< volume of grains over volume of the shell
  double contacts_per_grain = 0.0;  ///< grain-grain and grain-shell contacts over grains, at the start
  double exponent = 0.0;            ///< maximum-likelihood exponent of the radii after growth
  double exponent_error = 0.0;      ///< its standard error
  std::vector<double> radii;        ///< [m], one per grain
};

/// Angle of the published secant of the tangential force [degree] [SP 1.4].
inline constexpr double kSecantAngle = 1.0;

/// One relaxed state of increasing normal overlap.
struct NormalPoint {
  double delta = 0.0;        ///< Delta = hn/Rs
  double force = 0.0;        ///< Fn on the second body, compression positive [N]
  double residual = 0.0;     ///< largest net force on a grain over the mean contact force (or floor)
  double max_overlap = 0.0;  ///< largest overlap over the smaller radius
  bool converged = false;    ///< the relaxation's own criterion was met
};

/// One relaxed state after rotating the first soft particle at fixed normal overlap.
struct TangentialPoint {
  double delta = 0.0;           ///< Delta of the normal state it starts from
  double angle_deg = 0.0;       ///< rotation [degree], either sign; 0 is the state before rotation (prestrain)
  double force_parallel = 0.0;  ///< force on the second body along the tangential displacement of positive angle [N]
  double force_perpendicular = 0.0;  ///< across it, in the contact plane [N]
  double residual = 0.0;
  bool converged = false;
};

/// All points of one packing (pair of packings for soft-soft) under one relaxation.
struct PackingRun {
  std::int64_t packing = 0;  ///< index into Measurements::packings (first body)
  PairKind kind = PairKind::soft_solid;
  std::string relaxation;  ///< "published", "damped", "slow-dynamics" or "least-work"
  std::vector<NormalPoint> normal;
  std::vector<TangentialPoint> tangential;
  Cost normal_cost;
  Cost tangential_cost;
};

struct Measurements {
  SoftParticleSpec spec;
  bool shell_turns = true;                 ///< whether the first shell turns with its grains in tangential runs
  double approach_speed = 0.0;             ///< [m/s], of the published relaxation
  TurnProtocol turn = TurnProtocol::slow;  ///< turn protocol of tangential points; files without it: frozen
  double turn_speed = 0.0;                 ///< [m/s], of the rim of the shell in a slow turn; 0: nothing was turned
  std::vector<PackingInfo> packings;
  std::vector<PackingRun> runs;
  std::map<std::string, std::string> settings{};  ///< of each relaxation, by its name; none in earlier files
};

/// Writes to an HDF5 file, atomically (temporary file, flush, rename). Throws IoError.
void save(const Measurements& data, const std::string& path, const Provenance& provenance = build_provenance());

/// Reads what save() wrote. Throws IoError naming the file and what is missing or damaged.
Measurements load_measurements(const std::string& path);

/// Joins packings and runs; indices of packings are shifted. `names` (one per part) stand for the parts in messages.
/// Throws InputError when there is nothing to merge, when a part was measured on another soft particle or by another
/// protocol (first differing quantity named, with both values; settings of a relaxation that a file does not say are
/// taken to be the same), or when the same packing was measured twice by the same
/// relaxation.
Measurements merge_measurements(const std::vector<Measurements>& parts, const std::vector<std::string>& names);

}  // namespace softgrain
