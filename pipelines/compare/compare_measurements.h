// Ratios of measured soft-particle forces and stiffnesses, with standard errors: one relaxation against another, one
// run against another.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/core/statistics.h"
#include "common/data/law_card.h"
#include "common/data/measurements.h"
#include "pipelines/compare/measured_stiffness.h"

namespace softgrain {

/// One overlap: means over packings on both sides and their ratio, candidate over reference.
struct RatioRow {
  double delta = 0.0;   ///< Delta = hn/Rs
  MeanError candidate;  ///< relaxations: N for forces, N/m for stiffnesses; two files: Fn/(E Rs^2) and kt/(E Rs)
  MeanError reference;
  RatioError ratio;
  /// Initial slopes of the same packings: how many jumped, on either side. A packing that rearranges between two angles
  /// shows as a slope that is no stiffness: negative, and larger in size than the median slope of its side. It stays in
  /// the means and in `ratio`.
  std::size_t jumps = 0;
  RatioError ratio_without_jumps = {};  ///< only where there are jumps
};

/// Cost of one recorded point (one overlap, or one angle), mean over the runs.
struct PointCost {
  std::int64_t points = 0;
  double loop_passes = 0.0;
  double contact_evaluations = 0.0;
  double seconds = 0.0;
};

/// Forces and stiffnesses of two sides, with what their points cost.
struct ForceComparison {
  PairKind kind = PairKind::soft_solid;
  std::vector<RatioRow> normal;
  std::vector<RatioRow> stiffness_initial;
  std::vector<RatioRow> stiffness_secant;
  PointCost reference_normal_cost;
  PointCost candidate_normal_cost;
  PointCost reference_tangential_cost;
  PointCost candidate_tangential_cost;
};

/// Two relaxations of the same packings: those in common only, errors by jackknife over packings.
struct RelaxationComparison : ForceComparison {
  std::string reference;
  std::string candidate;
};

/// Compares two relaxations of one file, packing by packing.
/// Throws InputError when a relaxation is absent for this kind (naming those present) or no packing and overlap is in
/// both.
RelaxationComparison compare_relaxations(const Measurements& data, const std::string& reference,
                                         const std::string& candidate, PairKind kind,
                                         const StiffnessAngles& angles = {});

/// Two files, one pair kind and relaxation each. Runs of the same packings are compared packing by packing, others
/// count as independent. Forces are compared as Fn/(E Rs^2) and stiffnesses as kt/(E Rs), so that runs with other E and
/// Rs can be set side by side.
struct MeasurementComparison : ForceComparison {
  std::string candidate_relaxation;
  std::string reference_relaxation;
  bool paired = false;  ///< the packings are the same
};

/// Throws InputError when a side has no such runs or no overlap is in both.
MeasurementComparison compare_measurements(const Measurements& candidate, const std::string& candidate_relaxation,
                                           const Measurements& reference, const std::string& reference_relaxation,
                                           PairKind kind, const StiffnessAngles& angles = {});

/// One parameter, or one value F(Delta), of two fitted laws.
struct LawRow {
  std::string what;              ///< "normal a", "F(0.20)"
  double candidate = 0.0;        ///< NaN of a law without numbers
  double candidate_error = 0.0;  ///< standard error, NaN when unknown
  double reference = 0.0;
  double reference_error = 0.0;
};

/// Parameters of the laws of one pair kind and normal forces over the common range of validity, dimensionless.
/// Throws InputError when a card has no law of this kind.
std::vector<LawRow> compare_laws(const LawCard& candidate, const LawCard& reference, PairKind kind);

}  // namespace softgrain
