#include "pipelines/compare/stage_match.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/core/error.h"
#include "common/core/limits.h"
#include "pipelines/compare/compare.h"
#include "pipelines/compare/stage_results.h"

namespace softgrain {

namespace {

/// Points of every stage, with the one at which it begins.
std::vector<std::vector<std::size_t>> points_of_stages(const MacroCurve& c) {
  std::vector<std::vector<std::size_t>> out(c.stages.size());
  std::size_t begin = 0;
  for (std::size_t k = 1; k < c.stage.size(); ++k) {
    const auto stage = static_cast<std::size_t>(c.stage[k]);
    if (stage >= out.size())
      throw InputError("compare: a recorded point belongs to a stage that the test does not have");
    if (out[stage].empty()) out[stage].push_back(begin);
    out[stage].push_back(k);
    begin = k;
  }
  return out;
}

bool says_its_stages(const MacroCurve& c) {
  const std::size_t n = c.strain.size();
  for (const auto* column : {&c.stage, &c.strain_x, &c.strain_y, &c.strain_z, &c.stress_x, &c.stress_y})
    if (column->size() != n) return false;
  return !c.stages.empty();
}

const std::vector<double>& strain_of(const MacroCurve& c, std::size_t axis) {
  return axis == 0 ? c.strain_x : axis == 1 ? c.strain_y : c.strain_z;
}

const std::vector<double>& stress_of(const MacroCurve& c, std::size_t axis) {
  return axis == 0 ? c.stress_x : axis == 1 ? c.stress_y : c.stress_axial;
}

/// What drives a stage; neither: nothing does.
struct Driver {
  std::optional<std::size_t> strain_of_axis;
  std::optional<std::size_t> stress_of_axis;
  bool slides = false;  ///< the shear strain drives it
};

/// Strain since the stage began.
double strained(const MacroCurve& c, std::size_t axis, std::size_t begin, std::size_t point) {
  const auto& strain = strain_of(c, axis);
  return 1.0 - (1.0 - strain[point]) / (1.0 - strain[begin]);
}

Driver driver_of(const StageRecord& record, const MacroCurve& c, const std::vector<std::size_t>& points) {
  constexpr double kStands = 1e-9;
  constexpr double kHeld = 0.02;  // of the largest stress: more than relaxations leave
  const std::array<bool, 3> held = stress_axes(record);
  Driver out;
  if (slides(record.way) && record.kind != StageKind::hold && c.shear_strain.size() == c.strain.size()) {
    out.slides = true;
    return out;
  }
  double farthest = kStands;
  for (const std::size_t k : {2U, 0U, 1U}) {
    const double way = std::abs(strained(c, k, points.front(), points.back()));
    if (held[k] || way <= farthest * (1.0 + 1e-9)) continue;
    farthest = way;
    out.strain_of_axis = k;
  }
  if (out.strain_of_axis) return out;
  double largest = 0.0;
  for (std::size_t k = 0; k < 3; ++k)
    for (const std::size_t p : {points.front(), points.back()})
      largest = std::max(largest, std::abs(stress_of(c, k)[p]));
  farthest = kHeld * largest;
  for (const std::size_t k : {2U, 0U, 1U}) {
    const double way = std::abs(stress_of(c, k)[points.back()] - stress_of(c, k)[points.front()]);
    if (!held[k] || way <= farthest) continue;
    farthest = way;
    out.stress_of_axis = k;
  }
  return out;
}

std::vector<double> driven(const Driver& driver, const MacroCurve& c, const std::vector<std::size_t>& points) {
  std::vector<double> out;
  for (const std::size_t p : points) {
    if (driver.slides) {
      out.push_back(c.shear_strain[p]);
      continue;
    }
    out.push_back(driver.strain_of_axis ? strained(c, *driver.strain_of_axis, points.front(), p)
                                        : stress_of(c, *driver.stress_of_axis)[p]);
  }
  return out;
}

bool increases(const std::vector<double>& x) {
  for (std::size_t k = 1; k < x.size(); ++k)
    if (!(x[k] > x[k - 1])) return false;
  return true;
}

std::vector<double> shares(std::size_t points) {
  std::vector<double> out;
  for (std::size_t k = 0; k < points; ++k) out.push_back(static_cast<double>(k) / static_cast<double>(points - 1));
  return out;
}

/// False: nothing is driven, or not one way, or the two go different ways.
bool match_by_driver(const MacroCurve& candidate, const MacroCurve& reference, MatchedStage& stage) {
  const Driver driver = driver_of(stage.record, reference, stage.reference.point);
  if (!driver.strain_of_axis && !driver.stress_of_axis && !driver.slides) return false;
  if (driver.slides && candidate.shear_strain.size() != candidate.strain.size()) return false;
  stage.candidate.at = driven(driver, candidate, stage.candidate.point);
  stage.reference.at = driven(driver, reference, stage.reference.point);
  const double from = stage.reference.at.front();
  const double way = stage.reference.at.back() - from;
  for (StageSide* side : {&stage.candidate, &stage.reference})
    for (double& at : side->at) at = (at - from) / way;
  return increases(stage.candidate.at) && increases(stage.reference.at);
}

std::vector<MatchedStage> match_whole(const MacroCurve& candidate, const MacroCurve& reference) {
  const std::size_t n = reference.strain.size();
  if (candidate.strain.size() != n || n < 2)
    throw InputError(fmt::format(
        "compare: at least one of the curves does not say which stage its points belong to, and they have {} and {} "
        "points",
        candidate.strain.size(), n));
  MatchedStage stage;
  stage.first = true;
  for (StageSide* side : {&stage.candidate, &stage.reference}) {
    for (std::size_t k = 0; k < n; ++k) side->point.push_back(k);
    side->at = shares(n);
  }
  return {stage};
}

/// Integral of the square of a function that is linear between `left` and `right`.
double integral_of_square(double width, double left, double right) {
  return width * (left * left + left * right + right * right) / 3.0;
}

/// All places where one side has a point, within the common part.
std::vector<double> grid_of(const MatchedStage& stage) {
  const auto [low, high] = common_part(stage);
  std::vector<double> grid{low, high};
  for (const StageSide* side : {&stage.candidate, &stage.reference})
    for (const double at : side->at)
      if (at > low && at < high) grid.push_back(at);
  std::sort(grid.begin(), grid.end());
  grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
  return grid;
}

void require_values(const std::vector<double>& column, std::size_t points) {
  if (column.size() != points) throw InputError("compare: a column has another number of points than its curve");
  for (const double x : column)
    if (!std::isfinite(x)) throw InputError("compare: a curve holds a value that is not finite");
}

}  // namespace

std::array<bool, 3> stress_axes(const StageRecord& stage) {
  if (stage.by_stress) return *stage.by_stress;
  if (stage.way == StageKind::triaxial) return {true, true, false};
  const bool all = stage.way == StageKind::consolidation;
  return {all, all, all};
}

bool imposed(const StageRecord& stage, ComparedStress what) {
  const auto [x, y, z] = stress_axes(stage);
  switch (what) {
    case ComparedStress::axial:
      return z;
    case ComparedStress::lateral:
      return x && y;
    default:
      return x && z && !slides(stage.way);
  }
}

std::vector<bool> imposed_points(const MacroCurve& c, ComparedStress what) {
  std::vector<bool> out(c.strain.size(), false);
  if (!by_stages(c.test) || c.stage.size() != out.size()) return out;
  for (std::size_t k = 0; k < out.size(); ++k)
    if (const auto stage = static_cast<std::size_t>(c.stage[k]); stage < c.stages.size())
      out[k] = imposed(c.stages[stage], what);
  return out;
}

std::vector<MatchedStage> match_stages(const MacroCurve& candidate, const MacroCurve& reference) {
  if (!says_its_stages(candidate) || !says_its_stages(reference)) return match_whole(candidate, reference);
  const auto mine = points_of_stages(candidate);
  const auto theirs = points_of_stages(reference);
  std::vector<MatchedStage> out;
  for (std::size_t k = 0; k < std::min(mine.size(), theirs.size()); ++k) {
    if (mine[k].size() < 2 || theirs[k].size() < 2) continue;
    MatchedStage stage{candidate.stages[k], {mine[k], {}}, {theirs[k], {}}, k == 0};
    if (!stage.record.by_stress) stage.record.by_stress = reference.stages[k].by_stress;
    if (!match_by_driver(candidate, reference, stage)) {
      stage.candidate.at = shares(mine[k].size());
      stage.reference.at = shares(theirs[k].size());
    }
    const auto [low, high] = common_part(stage);
    if (low < high) out.push_back(std::move(stage));
  }
  if (out.empty()) throw InputError("compare: no stage has a common range of strain or stress");
  return out;
}

std::array<double, 2> common_part(const MatchedStage& s) {
  return {std::max(s.candidate.at.front(), s.reference.at.front()),
          std::min(s.candidate.at.back(), s.reference.at.back())};
}

double value_at(const StageSide& side, const std::vector<double>& column, double at) {
  std::vector<double> values;
  for (const std::size_t p : side.point) values.push_back(column[p]);
  return interpolate_linear(side.at, values, at);
}

void StageSquares::add(const MatchedStage& stage, const std::vector<double>& candidate,
                       const std::vector<double>& reference_column) {
  const auto weight = static_cast<double>(stage.reference.point.size() - 1);
  const std::vector<double> grid = grid_of(stage);
  for (std::size_t k = 1; k < grid.size(); ++k) {
    const double width = weight * (grid[k] - grid[k - 1]);
    const double b0 = value_at(stage.reference, reference_column, grid[k - 1]);
    const double b1 = value_at(stage.reference, reference_column, grid[k]);
    const double a0 = value_at(stage.candidate, candidate, grid[k - 1]);
    const double a1 = value_at(stage.candidate, candidate, grid[k]);
    difference += integral_of_square(width, a0 - b0, a1 - b1);
    reference += integral_of_square(width, b0, b1);
  }
  any = true;
}

double StageSquares::relative() const {
  if (!any) return kNaN;
  if (!(reference > 0.0))
    throw ZeroReference(
        "compare: the reference is zero over the whole common range: no difference relative to it is defined");
  return std::sqrt(difference / reference);
}

double staged_difference(const std::vector<MatchedStage>& stages, const std::vector<double>& candidate,
                         const std::vector<double>& reference, ComparedStress what) {
  for (const MatchedStage& stage : stages) {
    if (stage.candidate.point.back() >= candidate.size() || stage.reference.point.back() >= reference.size())
      throw InputError("compare: a column has fewer points than its curve");
  }
  require_values(candidate, candidate.size());
  require_values(reference, reference.size());
  StageSquares squares;
  for (const MatchedStage& stage : stages)
    if (!imposed(stage.record, what)) squares.add(stage, candidate, reference);
  return squares.relative();
}

double strain_difference(const std::vector<MatchedStage>& stages, const MacroCurve& candidate,
                         const MacroCurve& reference) {
  StageSquares squares;
  if (!says_its_stages(candidate) || !says_its_stages(reference)) {
    require_values(candidate.strain, candidate.strain.size());
    require_values(reference.strain, reference.strain.size());
    for (const MatchedStage& stage : stages) squares.add(stage, candidate.strain, reference.strain);
    return squares.relative();
  }
  for (std::size_t k = 0; k < 3; ++k) {
    require_values(strain_of(candidate, k), candidate.strain.size());
    require_values(strain_of(reference, k), reference.strain.size());
    for (const MatchedStage& stage : stages)
      if (stress_axes(stage.record)[k]) squares.add(stage, strain_of(candidate, k), strain_of(reference, k));
  }
  return squares.relative();
}

double unloading_ratio(const MacroCurve& candidate, const MacroCurve& reference) {
  const std::vector<StageResult> mine = stage_results(candidate);
  const std::vector<StageResult> theirs = stage_results(reference);
  double sum = 0.0;
  double stages = 0.0;
  for (std::size_t k = 0; k < std::min(mine.size(), theirs.size()); ++k) {
    if (mine[k].record.kind != StageKind::unload || theirs[k].record.kind != StageKind::unload) continue;
    // The secant: a tangent at the first point depends on how far the second one is.
    const double ratio = mine[k].modulus / theirs[k].modulus;
    if (!std::isfinite(ratio)) continue;
    sum += ratio;
    stages += 1.0;
  }
  return stages > 0.0 ? sum / stages : kNaN;
}

}  // namespace softgrain
