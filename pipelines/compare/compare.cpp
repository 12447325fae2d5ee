#include "pipelines/compare/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/data/macro_band.h"
#include "pipelines/compare/stage_match.h"
#include "pipelines/compare/stage_results.h"

namespace softgrain {
namespace {

using PointKey = std::pair<MacroTest, std::int64_t>;

void require_curve(const std::vector<double>& x, const std::vector<double>& y, const char* side) {
  if (x.size() != y.size())
    throw InputError(fmt::format("compare: {} has {} abscissae and {} values", side, x.size(), y.size()));
  if (x.size() < 2) throw InputError(fmt::format("compare: {} has fewer than two points", side));
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i]))
      throw InputError(fmt::format("compare: {} holds a value that is not finite at point {}", side, i));
    if (i > 0 && !(x[i] > x[i - 1]))
      throw InputError(fmt::format("compare: {} does not increase at point {}", side, i));
  }
}

std::pair<double, double> common_range(const std::vector<double>& a, const std::vector<double>& b) {
  const double low = std::max(a.front(), b.front());
  const double high = std::min(a.back(), b.back());
  if (low < high) return {low, high};
  throw InputError(fmt::format("compare: no common range: candidate {} .. {}, reference {} .. {}", a.front(), a.back(),
                               b.front(), b.back()));
}

std::vector<double> union_grid(const std::vector<double>& a, const std::vector<double>& b, double low, double high) {
  std::vector<double> grid{low, high};
  for (const auto* x : {&a, &b}) {
    std::copy_if(x->begin(), x->end(), std::back_inserter(grid), [&](double v) { return v > low && v < high; });
  }
  std::sort(grid.begin(), grid.end());
  grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
  return grid;
}

/// Integral of the square of a function that is linear between `left` and `right`.
double square_integral(double width, double left, double right) {
  return width * (left * left + left * right + right * right) / 3.0;
}

/// NaN in place of an error: the lateral stress is not recorded by every test.
template <class Difference>
double value_or_nan(const Difference& difference) {
  try {
    return difference();
  } catch (const InputError&) {
    return kNaN;
  }
}

double ratio_or_nan(double a, double b) { return b == 0.0 ? kNaN : a / b; }

/// Stresses of both at the end of what they have in common.
struct EndStresses {
  double axial_candidate = kNaN;
  double axial_reference = kNaN;
  double lateral_candidate = kNaN;
  double lateral_reference = kNaN;
};

void add_ends(const EndStresses& end, SampleComparison& s) {
  s.axial_end_ratio = ratio_or_nan(end.axial_candidate, end.axial_reference);
  s.lateral_end_ratio = ratio_or_nan(end.lateral_candidate, end.lateral_reference);
  s.lateral_stress_ratio_candidate = ratio_or_nan(end.lateral_candidate, end.axial_candidate);
  s.lateral_stress_ratio_reference = ratio_or_nan(end.lateral_reference, end.axial_reference);
}

/// Tests whose strain goes one way: over their strain.
void compare_strained(const MacroCurve& c, const MacroCurve& r, SampleComparison& s) {
  s.axial_difference = relative_difference(c.strain, c.stress_axial, r.strain, r.stress_axial);
  s.lateral_difference =
      value_or_nan([&] { return relative_difference(c.strain, c.stress_lateral, r.strain, r.stress_lateral); });
  const auto [low, high] = common_range(c.strain, r.strain);
  s.strain_low = low;
  s.strain_high = high;
  const auto at_end = [at = high](const MacroCurve& of, const std::vector<double>& y) {
    return y.size() == of.strain.size() && !y.empty() ? interpolate_linear(of.strain, y, at) : kNaN;
  };
  add_ends(
      {at_end(c, c.stress_axial), at_end(r, r.stress_axial), at_end(c, c.stress_lateral), at_end(r, r.stress_lateral)},
      s);
}

/// Over the stages that slide: from the least to the largest shear strain of what both have in common.
void add_shear_range(const std::vector<MatchedStage>& stages, const MacroCurve& c, SampleComparison& s) {
  if (c.shear_strain.size() != c.strain.size()) return;
  for (const MatchedStage& stage : stages) {
    if (!slides(stage.record.way)) continue;
    for (const double at : common_part(stage)) {
      const double shear = value_at(stage.candidate, c.shear_strain, at);
      s.shear_low = std::fmin(s.shear_low, shear);  // NaN: the first
      s.shear_high = std::fmax(s.shear_high, shear);
    }
  }
}

/// Stage by stage, and of each what it does not impose.
void compare_staged(const MacroCurve& c, const MacroCurve& r, SampleComparison& s) {
  const std::vector<MatchedStage> stages = match_stages(c, r);
  s.axial_difference = staged_difference(stages, c.stress_axial, r.stress_axial, ComparedStress::axial);
  s.lateral_difference = value_or_nan(
      [&] { return staged_difference(stages, c.stress_lateral, r.stress_lateral, ComparedStress::lateral); });
  s.deviator_difference =
      value_or_nan([&] { return staged_difference(stages, deviators(c), deviators(r), ComparedStress::deviator); });
  s.strain_difference = value_or_nan([&] { return strain_difference(stages, c, r); });
  s.unloading_ratio = unloading_ratio(c, r);
  for (const MatchedStage& stage : stages)
    s.axial_imposed = s.axial_imposed || imposed(stage.record, ComparedStress::axial);
  const MatchedStage& last = stages.back();
  const double end = common_part(last)[1];
  s.strain_low = c.strain[stages.front().candidate.point.front()];
  s.strain_high = value_at(last.candidate, c.strain, end);
  add_shear_range(stages, c, s);
  const auto at_end = [&](const MacroCurve& of, const StageSide& side, const std::vector<double>& y) {
    return y.size() == of.strain.size() ? value_at(side, y, end) : kNaN;
  };
  add_ends({at_end(c, last.candidate, c.stress_axial), at_end(r, last.reference, r.stress_axial),
            at_end(c, last.candidate, c.stress_lateral), at_end(r, last.reference, r.stress_lateral)},
           s);
  s.end_imposed = imposed(last.record, ComparedStress::axial);
  if (s.end_imposed) s.axial_end_ratio = kNaN;
}

SampleComparison compare_sample(const MacroCurve& candidate, const MacroCurve& reference) {
  SampleComparison s;
  s.sample = candidate.sample;
  s.test = candidate.test;
  if (by_stages(candidate.test))
    compare_staged(candidate, reference, s);
  else
    compare_strained(candidate, reference, s);
  s.in_band = share_in_band(candidate, reference, false);
  s.end_in_band = share_in_band(candidate, reference, true);
  s.band_width = end_band_width(candidate);
  s.candidate_cost = candidate.cost;
  s.reference_cost = reference.cost;
  return s;
}

std::map<PointKey, const MacroCurve*> by_key(const std::vector<MacroCurve>& curves, const char* side) {
  std::map<PointKey, const MacroCurve*> result;
  for (const MacroCurve& c : curves) {
    if (result.emplace(PointKey{c.test, c.sample}, &c).second) continue;
    throw InputError(fmt::format("compare: the {} holds test \"{}\", sample {} twice; choose one engine", side,
                                 to_string(c.test), c.sample));
  }
  return result;
}

/// Why a pair cannot be compared; empty when it can.
std::string obstacle(const MacroCurve& candidate, const MacroCurve* reference) {
  const std::string name = fmt::format("{} sample {}: ", to_string(candidate.test), candidate.sample);
  if (reference == nullptr) return name + "the reference has no such sample";
  if (!candidate.usable) return name + "the candidate is marked unusable (" + candidate.note + ")";
  if (!reference->usable) return name + "the reference is marked unusable (" + reference->note + ")";
  return "";
}

void note_undefined(const SampleComparison& s, Comparison& result) {
  if (s.end_imposed) return;
  const auto note = [&](double ratio, const char* side) {
    if (!std::isfinite(ratio))
      result.undefined.push_back(
          fmt::format("{} sample {}: the {} carries no axial stress at strain {:.4g}: ratios to it are undefined",
                      to_string(s.test), s.sample, side, s.strain_high));
  };
  note(s.axial_end_ratio, "reference");
  if (std::isfinite(s.axial_end_ratio) && s.axial_end_ratio == 0.0) note(kNaN, "candidate");
}

/// A twin that never carries stress leaves the others to be compared.
void add_sample(const MacroCurve& candidate, const MacroCurve& reference, Comparison& result) {
  try {
    result.samples.push_back(compare_sample(candidate, reference));
    note_undefined(result.samples.back(), result);
  } catch (const ZeroReference& e) {
    result.undefined.push_back(fmt::format("{} sample {}: {}", to_string(candidate.test), candidate.sample, e.what()));
  }
}

void add_speedups(Comparison& result) {
  Cost candidate;
  Cost reference;
  for (const SampleComparison& s : result.samples) {
    candidate += s.candidate_cost;
    reference += s.reference_cost;
  }
  const auto ratio = [](double a, double b) { return a > 0.0 && b > 0.0 ? a / b : kNaN; };
  result.speedup_seconds = ratio(reference.seconds, candidate.seconds);
  result.speedup_contact_evaluations =
      ratio(static_cast<double>(reference.contact_evaluations), static_cast<double>(candidate.contact_evaluations));
}

void add_means(Comparison& result) {
  result.axial_difference = finite_mean(result.samples, &SampleComparison::axial_difference);
  result.lateral_difference = finite_mean(result.samples, &SampleComparison::lateral_difference);
  result.strain_difference = finite_mean(result.samples, &SampleComparison::strain_difference);
  result.deviator_difference = finite_mean(result.samples, &SampleComparison::deviator_difference);
  result.unloading_ratio = finite_mean(result.samples, &SampleComparison::unloading_ratio);
  result.axial_end_ratio = finite_mean(result.samples, &SampleComparison::axial_end_ratio);
  result.lateral_stress_ratio_candidate =
      finite_mean(result.samples, &SampleComparison::lateral_stress_ratio_candidate);
  result.lateral_stress_ratio_reference =
      finite_mean(result.samples, &SampleComparison::lateral_stress_ratio_reference);
  result.in_band = finite_mean(result.samples, &SampleComparison::in_band);
  result.end_in_band = finite_mean(result.samples, &SampleComparison::end_in_band);
  result.band_width = finite_mean(result.samples, &SampleComparison::band_width);
}

}  // namespace

std::vector<double> values_at_points(const MacroCurve& of, const std::vector<double>& column,
                                     const MacroCurve& points) {
  std::vector<double> out(points.strain.size(), kNaN);
  const auto take = [](const StageSide& there, const StageSide& here, const std::vector<double>& y, bool first,
                       std::vector<double>& values) {
    const double rounding = 1e-9 * (there.at.back() - there.at.front());
    for (std::size_t k = first ? 0 : 1; k < here.point.size(); ++k) {
      const double at = std::clamp(here.at[k], there.at.front(), there.at.back());
      if (std::abs(at - here.at[k]) <= rounding) values[here.point[k]] = value_at(there, y, at);
    }
  };
  if (by_stages(points.test)) {
    for (const MatchedStage& s : match_stages(of, points)) take(s.candidate, s.reference, column, s.first, out);
    return out;
  }
  StageSide there{{}, of.strain};
  StageSide here{{}, points.strain};
  for (StageSide* side : {&there, &here})
    for (std::size_t k = 0; k < side->at.size(); ++k) side->point.push_back(k);
  if (!there.at.empty()) take(there, here, column, true, out);
  return out;
}

double share_in_band(const MacroCurve& candidate, const MacroCurve& reference, bool end) {
  constexpr double kBears = 0.05;
  const auto band = band_of(candidate, BandOf::axial, BandPart::all);
  if (!band || reference.stress_axial.empty()) return kNaN;
  const double bears = kBears * *std::max_element(reference.stress_axial.begin(), reference.stress_axial.end());
  const std::vector<double> stress = values_at_points(reference, reference.stress_axial, candidate);
  const std::vector<bool> given = imposed_points(candidate, ComparedStress::axial);
  std::vector<double> inside;
  for (std::size_t k = 0; k < stress.size(); ++k) {
    if (given[k] || !(stress[k] >= bears)) continue;
    inside.push_back(stress[k] >= band->low[k] && stress[k] <= band->high[k] ? 1.0 : 0.0);
  }
  if (inside.empty()) return kNaN;
  return end ? inside.back() : mean_error(inside).mean;
}

std::vector<ComparedQuantity> headline_of(const Comparison& c) {
  const bool staged = !c.samples.empty() && by_stages(c.samples.front().test);
  if (!staged) return {{"stress", c.axial_difference}};
  std::vector<ComparedQuantity> out{{"deviator", c.deviator_difference},
                                    {"strain along axes that go by stress", c.strain_difference},
                                    {"unloading modulus over that of the twin", c.unloading_ratio, true},
                                    {"axial stress where it is not given", c.axial_difference}};
  const bool any = std::ranges::any_of(c.samples, [](const auto& s) { return s.axial_imposed; });
  if (!any) out.back().what = "axial stress";
  std::erase_if(out, [](const ComparedQuantity& q) { return q.value.n == 0; });
  return out;
}

double end_band_width(const MacroCurve& c) {
  const auto band = band_of(c, BandOf::axial, BandPart::all);
  return band && c.stress_axial.back() != 0.0 ? 0.5 * (band->high.back() - band->low.back()) / c.stress_axial.back()
                                              : kNaN;
}

double interpolate_linear(const std::vector<double>& x, const std::vector<double>& y, double at) {
  const auto next = std::upper_bound(x.begin(), x.end(), at);
  if (next == x.begin()) return y.front();
  if (next == x.end()) return y.back();
  const auto i = static_cast<std::size_t>(next - x.begin());
  const double share = (at - x[i - 1]) / (x[i] - x[i - 1]);
  return y[i - 1] + share * (y[i] - y[i - 1]);
}

double relative_difference(const std::vector<double>& candidate_x, const std::vector<double>& candidate_y,
                           const std::vector<double>& reference_x, const std::vector<double>& reference_y) {
  require_curve(candidate_x, candidate_y, "the candidate");
  require_curve(reference_x, reference_y, "the reference");
  const auto [low, high] = common_range(candidate_x, reference_x);
  double squares = 0.0;
  double reference_squares = 0.0;
  double x0 = low;
  double a0 = interpolate_linear(candidate_x, candidate_y, low);
  double b0 = interpolate_linear(reference_x, reference_y, low);
  for (const double x1 : union_grid(candidate_x, reference_x, low, high)) {
    const double a1 = interpolate_linear(candidate_x, candidate_y, x1);
    const double b1 = interpolate_linear(reference_x, reference_y, x1);
    squares += square_integral(x1 - x0, a0 - b0, a1 - b1);
    reference_squares += square_integral(x1 - x0, b0, b1);
    x0 = x1;
    a0 = a1;
    b0 = b1;
  }
  if (!(reference_squares > 0.0))
    throw ZeroReference(
        "compare: the reference is zero over the whole common range: no difference relative to it is defined");
  return std::sqrt(squares / reference_squares);
}

Comparison compare_curves(const std::vector<MacroCurve>& candidate, const std::vector<MacroCurve>& reference) {
  if (candidate.empty() || reference.empty()) {
    throw InputError(fmt::format("compare: the {} holds no curve", candidate.empty() ? "candidate" : "reference"));
  }
  const auto candidates = by_key(candidate, "candidate");
  const auto references = by_key(reference, "reference");
  Comparison result;
  for (const auto& [key, curve] : candidates) {
    const auto partner = references.find(key);
    const MacroCurve* other = partner == references.end() ? nullptr : partner->second;
    const std::string problem = obstacle(*curve, other);
    if (problem.empty())
      add_sample(*curve, *other, result);
    else
      result.left_out.push_back(problem);
  }
  for (const auto& [key, curve] : references)
    if (!candidates.contains(key))
      result.left_out.push_back(
          fmt::format("{} sample {}: the candidate has no such sample", to_string(key.first), key.second));
  if (result.samples.empty() && !result.undefined.empty())
    throw ZeroReference("compare: no sample can be compared: " + result.undefined.front());
  if (result.samples.empty()) throw InputError("compare: no sample can be compared: " + result.left_out.front());
  add_means(result);
  add_speedups(result);
  return result;
}

std::vector<MacroCurve> curves_of(const std::vector<MacroCurve>& curves, const std::string& engine) {
  std::vector<MacroCurve> result;
  std::copy_if(curves.begin(), curves.end(), std::back_inserter(result),
               [&](const MacroCurve& c) { return c.engine == engine; });
  return result;
}

}  // namespace softgrain
