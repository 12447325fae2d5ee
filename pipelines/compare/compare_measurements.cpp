#include "pipelines/compare/compare_measurements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/core/text.h"

namespace softgrain {
namespace {

std::vector<double> values_of(const std::map<std::int64_t, double>& by_packing, double unit) {
  std::vector<double> result;
  for (const auto& [packing, value] : by_packing) result.push_back(value / unit);
  return result;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// See RatioRow::jumps. Below the threshold, where the median is nothing, a slope of either sign is noise.
bool jumped(double slope, double median_slope) { return median_slope > 0.0 && slope < -median_slope; }

void leave_out_jumps(RatioRow& row, const std::vector<double>& a, const std::vector<double>& b) {
  const double median_a = median(a);
  const double median_b = median(b);
  std::vector<double> kept_a;
  std::vector<double> kept_b;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (jumped(a[k], median_a) || jumped(b[k], median_b)) continue;
    kept_a.push_back(a[k]);
    kept_b.push_back(b[k]);
  }
  row.jumps = a.size() - kept_a.size();
  if (row.jumps > 0) row.ratio_without_jumps = paired_ratio(kept_a, kept_b);
}

/// Rows over the overlaps of both sides; packings in common, paired, values divided by the unit of each side.
std::vector<RatioRow> paired_rows(const ValuesByDelta& candidate, const ValuesByDelta& reference,
                                  double candidate_unit = 1.0, double reference_unit = 1.0, bool find_jumps = false) {
  std::vector<RatioRow> rows;
  for (const auto& [key, reference_values] : reference) {
    const auto found = candidate.find(key);
    if (found == candidate.end()) continue;
    std::vector<double> a;
    std::vector<double> b;
    for (const auto& [packing, value] : reference_values) {
      const auto partner = found->second.find(packing);
      if (partner == found->second.end()) continue;
      a.push_back(partner->second / candidate_unit);
      b.push_back(value / reference_unit);
    }
    if (a.empty()) continue;
    rows.push_back({key_delta(key), mean_error(a), mean_error(b), paired_ratio(a, b)});
    if (find_jumps) leave_out_jumps(rows.back(), a, b);
  }
  return rows;
}

/// Whether packing k of one file is packing k of the other: the same grains, for all that both have (at least one).
bool same_packings(const Measurements& a, const Measurements& b) {
  const std::size_t n = std::min(a.packings.size(), b.packings.size());
  for (std::size_t k = 0; k < n; ++k) {
    const PackingInfo& p = a.packings[k];
    const PackingInfo& q = b.packings[k];
    if (p.grains != q.grains || p.solid_fraction != q.solid_fraction || p.contacts_per_grain != q.contacts_per_grain)
      return false;
  }
  return n > 0;
}

/// Rows over the overlaps of both sides; packings independent, values divided by the unit of each side.
std::vector<RatioRow> independent_rows(const ValuesByDelta& candidate, double candidate_unit,
                                       const ValuesByDelta& reference, double reference_unit) {
  std::vector<RatioRow> rows;
  for (const auto& [key, reference_values] : reference) {
    const auto found = candidate.find(key);
    if (found == candidate.end()) continue;
    const MeanError a = mean_error(values_of(found->second, candidate_unit));
    const MeanError b = mean_error(values_of(reference_values, reference_unit));
    rows.push_back({key_delta(key), a, b, independent_ratio(a, b)});
  }
  return rows;
}

std::vector<const PackingRun*> require_runs(const Measurements& data, PairKind kind, const std::string& relaxation,
                                            const char* side) {
  auto runs = runs_of(data, kind, relaxation);
  if (!runs.empty()) return runs;
  std::string present;
  for (const std::string& name : relaxations_of(data, kind)) append_part(present, name, ", ");
  throw InputError(std::string("compare: the ") + side + " has no " + to_string(kind) + " runs with relaxation \"" +
                   relaxation + "\"; present: " + (present.empty() ? "none" : present));
}

PointCost per_point(const Cost& total, std::int64_t points) {
  const double n = points > 0 ? static_cast<double>(points) : std::numeric_limits<double>::quiet_NaN();
  return {points, static_cast<double>(total.loop_passes) / n, static_cast<double>(total.contact_evaluations) / n,
          total.seconds / n};
}

PointCost normal_cost(const std::vector<const PackingRun*>& runs) {
  Cost total;
  std::int64_t points = 0;
  for (const PackingRun* run : runs) {
    total += run->normal_cost;
    points += static_cast<std::int64_t>(run->normal.size());
  }
  return per_point(total, points);
}

PointCost tangential_cost(const std::vector<const PackingRun*>& runs) {
  Cost total;
  std::int64_t points = 0;
  for (const PackingRun* run : runs) {
    total += run->tangential_cost;
    points += static_cast<std::int64_t>(run->tangential.size());
  }
  return per_point(total, points);
}

template <class Comparison>
void add_costs(Comparison& result, const std::vector<const PackingRun*>& candidate,
               const std::vector<const PackingRun*>& reference) {
  result.reference_normal_cost = normal_cost(reference);
  result.candidate_normal_cost = normal_cost(candidate);
  result.reference_tangential_cost = tangential_cost(reference);
  result.candidate_tangential_cost = tangential_cost(candidate);
}

const PairLaw& require_law(const LawCard& card, PairKind kind, const char* side) {
  const PairLaw* law = card.find(kind);
  if (law == nullptr) throw InputError(fmt::format("compare: the {} law card has no {} law", side, to_string(kind)));
  return *law;
}

LawRow parameter_row(const std::string& what, const Estimate& a, const Estimate& b) {
  return {what, a.value, a.standard_error, b.value, b.standard_error};
}

/// A law without numbers has zeros in their place, which are not known.
PairLaw with_unknown_numbers(PairLaw law) {
  if (has_numbers(law.status) && law.normal.b.value > 0.0) return law;
  constexpr Estimate kUnknown{kNaN, kNaN, kNaN, kNaN};
  law.normal = {kUnknown, kUnknown, kUnknown, kUnknown};
  law.has_tangential_initial = law.has_tangential_secant = false;
  return law;
}

void add_law(std::vector<LawRow>& rows, const std::string& name, const ThresholdPowerLaw& a,
             const ThresholdPowerLaw& b) {
  rows.push_back(parameter_row(name + " a", a.a, b.a));
  rows.push_back(parameter_row(name + " b", a.b, b.b));
  rows.push_back(parameter_row(name + " delta", a.delta, b.delta));
}

}  // namespace

RelaxationComparison compare_relaxations(const Measurements& data, const std::string& reference,
                                         const std::string& candidate, PairKind kind, const StiffnessAngles& angles) {
  const auto a = require_runs(data, kind, candidate, "file");
  const auto b = require_runs(data, kind, reference, "file");
  RelaxationComparison result;
  result.kind = kind;
  result.reference = reference;
  result.candidate = candidate;
  result.normal = paired_rows(normal_forces(a), normal_forces(b));
  if (result.normal.empty())
    throw InputError(fmt::format("compare: no packing and overlap is in both \"{}\" and \"{}\"", candidate, reference));
  const double shell_radius = data.spec.shell_radius;
  result.stiffness_initial = paired_rows(initial_stiffness(a, angles, shell_radius),
                                         initial_stiffness(b, angles, shell_radius), 1.0, 1.0, true);
  result.stiffness_secant =
      paired_rows(secant_stiffness(a, angles, shell_radius), secant_stiffness(b, angles, shell_radius));
  add_costs(result, a, b);
  return result;
}

MeasurementComparison compare_measurements(const Measurements& candidate, const std::string& candidate_relaxation,
                                           const Measurements& reference, const std::string& reference_relaxation,
                                           PairKind kind, const StiffnessAngles& angles) {
  const auto a = require_runs(candidate, kind, candidate_relaxation, "candidate");
  const auto b = require_runs(reference, kind, reference_relaxation, "reference");
  const auto force_unit = [](const SoftParticleSpec& s) { return s.youngs_modulus * s.shell_radius * s.shell_radius; };
  const double force_a = force_unit(candidate.spec);
  const double force_b = force_unit(reference.spec);
  const double stiffness_a = force_a / candidate.spec.shell_radius;
  const double stiffness_b = force_b / reference.spec.shell_radius;
  MeasurementComparison result;
  result.kind = kind;
  result.candidate_relaxation = candidate_relaxation;
  result.reference_relaxation = reference_relaxation;
  result.paired = same_packings(candidate, reference);
  const auto rows = [&](const ValuesByDelta& x, double x_unit, const ValuesByDelta& y, double y_unit,
                        bool find_jumps = false) {
    return result.paired ? paired_rows(x, y, x_unit, y_unit, find_jumps) : independent_rows(x, x_unit, y, y_unit);
  };
  result.normal = rows(normal_forces(a), force_a, normal_forces(b), force_b);
  if (result.normal.empty()) throw InputError("compare: the two measurements have no overlap Delta in common");
  result.stiffness_initial = rows(initial_stiffness(a, angles, candidate.spec.shell_radius), stiffness_a,
                                  initial_stiffness(b, angles, reference.spec.shell_radius), stiffness_b, true);
  result.stiffness_secant = rows(secant_stiffness(a, angles, candidate.spec.shell_radius), stiffness_a,
                                 secant_stiffness(b, angles, reference.spec.shell_radius), stiffness_b);
  add_costs(result, a, b);
  return result;
}

std::vector<LawRow> compare_laws(const LawCard& candidate, const LawCard& reference, PairKind kind) {
  const PairLaw a = with_unknown_numbers(require_law(candidate, kind, "candidate"));
  const PairLaw b = with_unknown_numbers(require_law(reference, kind, "reference"));
  std::vector<LawRow> rows;
  add_law(rows, "normal", a.normal, b.normal);
  if (a.has_tangential_initial && b.has_tangential_initial)
    add_law(rows, "tangential initial", a.tangential_initial, b.tangential_initial);
  if (a.has_tangential_secant && b.has_tangential_secant)
    add_law(rows, "tangential secant", a.tangential_secant, b.tangential_secant);
  const double high = std::min(a.delta_max, b.delta_max);
  for (int k = 1; k * 0.05 <= high + 1e-9; ++k) {
    const double delta = k * 0.05;
    rows.push_back({fmt::format("Fn/(E Rs^2) at Delta = {:.2f}", delta), a.normal.value(delta), kNaN,
                    b.normal.value(delta), kNaN});
  }
  return rows;
}

}  // namespace softgrain
