#include "pipelines/compare/measured_stiffness.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "calibrate/curve_samples.h"

namespace softgrain {
namespace {

constexpr double kKeysPerUnit = 1e6;

/// Extracts one number from the rotations at each overlap of each run; overlaps where it cannot be had are left out.
template <class Extract>
ValuesByDelta by_overlap(const std::vector<const PackingRun*>& runs, Extract&& extract) {
  ValuesByDelta result;
  for (const PackingRun* run : runs) {
    std::map<long long, std::vector<TangentialPoint>> rotations;
    for (const TangentialPoint& p : run->tangential) rotations[delta_key(p.delta)].push_back(p);
    for (const auto& [key, points] : rotations) {
      if (const std::optional<double> value = extract(points)) result[key][run->packing] = *value;
    }
  }
  return result;
}

}  // namespace

double per_degree_to_per_metre(double shell_radius) { return 180.0 / (std::numbers::pi * shell_radius); }

long long delta_key(double delta) { return std::llround(delta * kKeysPerUnit); }
double key_delta(long long key) { return static_cast<double>(key) / kKeysPerUnit; }

std::vector<const PackingRun*> runs_of(const Measurements& data, PairKind kind, const std::string& relaxation) {
  std::vector<const PackingRun*> result;
  for (const PackingRun& run : data.runs) {
    if (run.kind == kind && run.relaxation == relaxation) result.push_back(&run);
  }
  return result;
}

std::vector<std::string> relaxations_of(const Measurements& data, PairKind kind) {
  std::vector<std::string> result;
  for (const PackingRun& run : data.runs) {
    if (run.kind == kind && std::find(result.begin(), result.end(), run.relaxation) == result.end())
      result.push_back(run.relaxation);
  }
  return result;
}

ValuesByDelta normal_forces(const std::vector<const PackingRun*>& runs) {
  ValuesByDelta result;
  for (const PackingRun* run : runs) {
    for (const NormalPoint& p : run->normal) {
      if (p.converged) result[delta_key(p.delta)][run->packing] = p.force;
    }
  }
  return result;
}

ValuesByDelta initial_stiffness(const std::vector<const PackingRun*>& runs, const StiffnessAngles& angles,
                                double shell_radius) {
  return by_overlap(runs, [&](const auto& points) { return initial_slope(points, angles.initial_deg, shell_radius); });
}

ValuesByDelta secant_stiffness(const std::vector<const PackingRun*>& runs, const StiffnessAngles& angles,
                               double shell_radius) {
  return by_overlap(runs, [&](const auto& points) { return secant(points, angles.secant_deg, shell_radius); });
}

}  // namespace softgrain
