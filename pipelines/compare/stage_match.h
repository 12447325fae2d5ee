// Tests in stages side by side: which points of two curves belong together, and what the test itself imposes.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "common/data/macro_result.h"

namespace softgrain {

/// What is compared of a curve.
enum class ComparedStress {
  axial,    ///< stress along z
  lateral,  ///< mean stress along x and y
  deviator  ///< stress along z less that along x; where a stage slides, twice the shear stress: deviators()
};

/// Axes that a stage holds or drives by stress: as recorded; of files of earlier versions what its kind says, which
/// leaves out z where that went to a stress.
std::array<bool, 3> stress_axes(const StageRecord& stage);

/// Whether a stage imposes the compared stress: every run has it there, and no law is right or wrong by it.
bool imposed(const StageRecord& stage, ComparedStress what);

/// Whether the compared stress is imposed at each recorded point of a curve, by the stage that ends at the point or
/// comes to it. False for curves that do not say their stages.
std::vector<bool> imposed_points(const MacroCurve& curve, ComparedStress what);

/// One side of a stage: its recorded points, with the one at which it begins, and how far it has come at each.
struct StageSide {
  std::vector<std::size_t> point;
  std::vector<double> at;  ///< increases; the reference goes from 0 to 1
};

/// A stage that both curves went through.
struct MatchedStage {
  StageRecord record;
  StageSide candidate;
  StageSide reference;
  bool first = false;  ///< whether it is the first stage of the test
};

/// Points belong together where the same has been driven as far: to the same strain since the stage began, of the axis
/// that is driven by strain; to the same stress where none is. A stage that drives nothing, or whose stress does not go
/// one way, goes by the share of its points. Numbers of points play no part: both may have any steps. Stages are paired
/// in their order, as far as both have them. Curves that do not say their stages are one stage, and need as many points
/// as each other. Throws InputError where that is not so, or where no stage has a common range.
std::vector<MatchedStage> match_stages(const MacroCurve& candidate, const MacroCurve& reference);

/// Part of `at` where both sides have values: from its begin to its end.
std::array<double, 2> common_part(const MatchedStage& stage);

/// Value of one side at `at`, between its points linearly.
double value_at(const StageSide& side, const std::vector<double>& column, double at);

/// Squares of a difference and of the reference, integrated over stages: each over its common part, by the number of
/// points that the reference recorded in it.
struct StageSquares {
  double difference = 0.0;
  double reference = 0.0;
  bool any = false;  ///< some stage was added

  void add(const MatchedStage& stage, const std::vector<double>& candidate, const std::vector<double>& reference);
  /// Relative L2 difference; NaN where no stage was added. Throws ZeroReference.
  [[nodiscard]] double relative() const;
};

/// Relative L2 difference over the stages that do not impose the compared stress.
double staged_difference(const std::vector<MatchedStage>& stages, const std::vector<double>& candidate,
                         const std::vector<double>& reference, ComparedStress what);

/// Relative L2 difference of the strains that stages do not impose: those of the axes that go by stress, from the start
/// of the test.
double strain_difference(const std::vector<MatchedStage>& stages, const MacroCurve& candidate,
                         const MacroCurve& reference);

/// Unloading modulus (secant, StageResult::modulus) of the candidate over that of the reference, mean over the stages
/// that unload; NaN without one.
double unloading_ratio(const MacroCurve& candidate, const MacroCurve& reference);

}  // namespace softgrain
