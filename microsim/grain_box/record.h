// What a run of a grain box leaves behind: one point per increment, failed tries, the pack; to and from HDF5.
#pragma once

#include <string>
#include <vector>

#include "common/io/hdf5_file.h"
#include "common/io/provenance.h"
#include "common/statics/grain_pack.h"
#include "microsim/grain_box/box_measure.h"
#include "microsim/grain_box/moduli.h"
#include "microsim/grain_box/spec.h"
#include "microsim/grain_box/stepper.h"

namespace softgrain {

/// Phases of a run in their order [QS 2.3].
enum class BoxPhase : std::int64_t {
  start = 0,       ///< nothing done yet
  compaction = 1,  ///< (a) frictionless, isotropic
  friction = 2,    ///< (b) friction on, uniaxial
  loading = 3,
  done = 4
};
std::string to_string(BoxPhase phase);

/// An equilibrium and the interval that led to it. NaN: not defined for this loading, or not probed.
struct BoxPoint {
  BoxPhase phase = BoxPhase::compaction;
  Vec3 strain{};  ///< strain from the length at which stress first appeared, compression positive
  Vec3 lengths{};
  Vec3 stress{};        ///< stress from the wall forces [Pa]
  double shear = 0.0;   ///< BoxStress::shear [Pa]
  double moment = 0.0;  ///< BoxStress::moment [Pa]
  double imbalance = 0.0;
  double pressure = 0.0;  ///< sigma_c = tr(sigma)/3 [Pa]
  double deviator = 0.0;  ///< sqrt(3 J2) [Pa]
  double bulk = 0.0;      ///< K of the interval [Pa]
  double shear_modulus = 0.0;
  double bulk_probe = 0.0;  ///< K of an elastic probe: no contact slides [Pa]
  double shear_probe = 0.0;
  double bulk_medium = 0.0;  ///< K of the effective medium [Pa]
  double shear_medium = 0.0;
  double sliding_share = 0.0;   ///< share of contacts with |Q| >= mu P in this state [QS 2.3]; NaN without friction
  double at_start_limit = 0.0;  ///< share_at_start_limit() of the interval
  double coordination = 0.0;
  double coordination_without = 0.0;  ///< coordination without rattlers
  double mean_force = 0.0;            ///< mean normal force [N]
  double solid_fraction = 0.0;
  std::int64_t rattlers = 0;
  std::int64_t fewest_contacts = 0;
  StepEffort effort;
};

struct BoxFailure {
  std::int64_t before_point = 0;  ///< it was tried on the way to this point
  FailedTry tried;
};

/// Everything a run needs to go on, bit for bit.
struct GrainBoxState {
  BoxPhase phase = BoxPhase::start;
  GrainPack pack;
  Vec3 stress_free_lengths{};
  std::int64_t pressures_met = 0;  ///< number of GrainBoxGeneration::pressures() that were reached
  std::int64_t growth_passes = 0;
  std::int64_t loose_passes = 0;  ///< loop passes of the dynamic relaxation before stress appeared
  std::vector<BoxPoint> points;
  std::vector<BoxFailure> failures;
  double seconds = 0.0;
};

/// A finished (or broken-off) run.
struct GrainBoxResult {
  GrainBoxSpec spec;
  GrainBoxState state;
  bool usable = false;
  std::string reason;

  [[nodiscard]] std::vector<const BoxPoint*> points_of(BoxPhase phase) const;
};

/// Growth exponents over sigma_c in the loading phase.
struct GrainBoxFits {
  PowerFit bulk_low;
  PowerFit bulk_high;
  PowerFit shear_low;
  PowerFit shear_high;
};

void fields(auto&& visit, Of<GrainBoxFits> auto& f) {
  visit("K_low", f.bulk_low, Means{"K in the lower range"});
  visit("K_high", f.bulk_high, Means{"K in the upper range"});
  visit("G_low", f.shear_low, Means{"G in the lower range"});
  visit("G_high", f.shear_high, Means{"G in the upper range"});
}

[[nodiscard]] GrainBoxFits fit_growth(const GrainBoxResult& result);

void write_state(const h5::Group& group, const GrainBoxState& state);
[[nodiscard]] GrainBoxState read_state(const h5::Group& group);

/// grain_box.h5: provenance and one group per pack. Atomic. Throws IoError.
void save_grain_boxes(const std::string& path, const std::vector<GrainBoxResult>& results,
                      const Provenance& provenance);
/// What a report needs: of the spec only what the file holds (name, friction, pressure, test, increments, fit ranges).
[[nodiscard]] std::vector<GrainBoxResult> load_grain_boxes(const std::string& path);

/// A pack between plain walls (no symmetry planes, no gravity), bit for bit.
void write_pack(const h5::Group& group, const GrainPack& pack);
/// Throws IoError when lengths or indices do not fit each other, or numbers are not finite.
[[nodiscard]] GrainPack read_pack(const h5::Group& group);

}  // namespace softgrain
