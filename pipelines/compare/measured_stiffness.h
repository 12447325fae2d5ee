// Tangential stiffness out of rotations, and points collected by overlap, for comparing and drawing measurements.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/data/measurements.h"

namespace softgrain {

/// Angles [degree] that define a stiffness: slope at the origin from |angle| <= initial, secant at |angle| = secant.
struct StiffnessAngles {
  double initial_deg = 0.05;
  double secant_deg = 1.0;
};

/// Displacement per degree turned round: kt [N/m] = kt [N/degree] * 180 / (pi Rs), from ht = pi Rs angle / 180.
double per_degree_to_per_metre(double shell_radius);

/// Overlap ratio as a key that forgives rounding: multiples of 1e-6.
long long delta_key(double delta);
double key_delta(long long key);

/// Values of one quantity by overlap and packing.
using ValuesByDelta = std::map<long long, std::map<std::int64_t, double>>;

/// Runs of one pair kind under one relaxation.
std::vector<const PackingRun*> runs_of(const Measurements& data, PairKind kind, const std::string& relaxation);

/// Relaxations present for a pair kind, in order of first appearance.
std::vector<std::string> relaxations_of(const Measurements& data, PairKind kind);

/// Normal force [N]. Here and below only converged points enter, as in the fits.
ValuesByDelta normal_forces(const std::vector<const PackingRun*>& runs);

/// Slope of the parallel force at ht = 0 [N/m] as the calibration extracts it. Overlaps without enough angles are left
/// out.
ValuesByDelta initial_stiffness(const std::vector<const PackingRun*>& runs, const StiffnessAngles& angles,
                                double shell_radius);

/// Secant at secant_deg [N/m], likewise.
ValuesByDelta secant_stiffness(const std::vector<const PackingRun*>& runs, const StiffnessAngles& angles,
                               double shell_radius);

}  // namespace softgrain
