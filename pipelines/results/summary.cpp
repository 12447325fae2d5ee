#include "pipelines/results/summary.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <map>

#include "common/core/error.h"
#include "common/core/statistics.h"
#include "common/core/text.h"
#include "common/data/law_words.h"
#include "microsim/protocol.h"
#include "pipelines/compare/compare_measurements.h"

namespace softgrain {

namespace {

using nlohmann::json;

MeanError over(const std::vector<PackingInfo>& packings, const std::function<double(const PackingInfo&)>& value) {
  Tally sample;
  for (const PackingInfo& p : packings) sample.add(value(p));
  return sample.statistics();
}

json rows_json(const std::vector<RatioRow>& rows) {
  json out = json::array();
  for (const RatioRow& r : rows)
    out.push_back({{"delta", r.delta},
                   {"reference", r.reference.mean},
                   {"reference_error", r.reference.error},
                   {"candidate", r.candidate.mean},
                   {"candidate_error", r.candidate.error},
                   {"ratio", r.ratio.ratio},
                   {"ratio_error", r.ratio.error},
                   {"packings", r.reference.n}});
  return out;
}

json cost_json(const PointCost& c) {
  return {{"points", c.points},
          {"loop_passes_per_point", c.loop_passes},
          {"contact_evaluations_per_point", c.contact_evaluations},
          {"seconds_per_point", c.seconds}};
}

json to_json(const RelaxationComparison& c) {
  return {{"normal", rows_json(c.normal)},
          {"kt_initial", rows_json(c.stiffness_initial)},
          {"kt_secant", rows_json(c.stiffness_secant)},
          {"reference_cost", cost_json(c.reference_normal_cost)},
          {"candidate_cost", cost_json(c.candidate_normal_cost)},
          {"reference_tangential_cost", cost_json(c.reference_tangential_cost)},
          {"candidate_tangential_cost", cost_json(c.candidate_tangential_cost)}};
}

std::vector<ForceSummary> forces_of(const std::map<double, std::vector<double>>& rows) {
  std::vector<ForceSummary> out;
  for (const auto& [delta, values] : rows) {
    const MeanError m = mean_error(values);
    out.push_back({delta, m.mean, m.error, m.deviation, m.n});
  }
  return out;
}

/// Forces for each kind of contact and Delta.
std::map<std::string, std::vector<ForceSummary>> forces_of(const Measurements& data, const std::string& relaxation) {
  std::map<std::string, std::map<double, std::vector<double>>> forces;
  for (const PackingRun& run : data.runs) {
    if (run.relaxation != relaxation) continue;
    for (const NormalPoint& p : run.normal)
      if (p.converged) forces[to_string(run.kind)][p.delta].push_back(p.force);
  }
  std::map<std::string, std::vector<ForceSummary>> out;
  for (const auto& [kind, rows] : forces) out[kind] = forces_of(rows);
  return out;
}

MeasurementSummary cost_summary(const Measurements& data, const std::string& relaxation) {
  MeasurementSummary out;
  out.relaxation = relaxation;
  for (const PackingRun& run : data.runs) {
    if (run.relaxation != relaxation) continue;
    out.points += static_cast<std::int64_t>(run.normal.size());
    for (const TangentialPoint& t : run.tangential) out.points += t.angle_deg != 0.0 ? 1 : 0;
    out.cost += run.normal_cost;
    out.cost += run.tangential_cost;
  }
  const double n = out.points > 0 ? static_cast<double>(out.points) : 1.0;
  out.loop_passes_per_point = static_cast<double>(out.cost.loop_passes) / n;
  out.seconds_per_point = out.cost.seconds / n;
  return out;
}

json relaxations_json(const Measurements& data, const std::string& reference, const std::string& candidate) {
  json out = {{"reference", reference}, {"candidate", candidate}};
  for (const PairKind kind : kPairKinds) {
    bool both[2] = {false, false};
    for (const PackingRun& run : data.runs) {
      if (run.kind != kind) continue;
      both[0] = both[0] || run.relaxation == reference;
      both[1] = both[1] || run.relaxation == candidate;
    }
    if (!both[0] || !both[1]) continue;
    try {
      out[to_string(kind)] = to_json(compare_relaxations(data, reference, candidate, kind));
    } catch (const InputError& e) {  // what was measured is kept when not a point of it can be compared
      out[to_string(kind)] = {{"reason", e.what()}};
    }
  }
  return out;
}

}  // namespace

PackingsSummary summary_of(const std::vector<PackingInfo>& packings) {
  const auto phi = over(packings, [](const PackingInfo& p) { return p.solid_fraction; });
  const auto b = over(packings, [](const PackingInfo& p) { return p.exponent; });
  const auto z = over(packings, [](const PackingInfo& p) { return p.contacts_per_grain; });
  const auto n = over(packings, [](const PackingInfo& p) { return static_cast<double>(p.grains); });
  return {packings.size(), phi.mean, phi.deviation_or_zero(), b.mean, b.deviation_or_zero(),
          z.mean,          n.mean,   n.deviation_or_zero(),   {},     {}};
}

MeasuredSummary summary_of(const Measurements& data, const std::vector<std::string>& relaxations) {
  MeasuredSummary out;
  out.packings = summary_of(data.packings);
  out.measurement = cost_summary(data, relaxations.front());
  out.forces = forces_of(data, relaxations.front());
  if (relaxations.size() < 2) return out;
  out.reference_measurement = cost_summary(data, relaxations[1]);
  out.relaxations = relaxations_json(data, relaxations[1], relaxations[0]);
  return out;
}

EngineSummary summary_of(const std::vector<MacroCurve>& curves, const std::string& engine) {
  EngineSummary out;
  bool usable = true;
  for (const MacroCurve& c : curves) {
    if (c.engine != engine) continue;
    out.cost += c.cost;
    if (c.preparation.loop_passes > 0) {
      if (!out.preparation) out.preparation.emplace();
      *out.preparation += c.preparation;
    }
    out.bodies = std::max(out.bodies, c.bodies);
    out.grains_inside = std::max(out.grains_inside, c.grains);
    out.soft_volume_share += c.soft_volume_share;
    usable = usable && c.usable;
    if (c.law.form) out.law = c.law;  // the same for all samples
    ++out.samples;
  }
  out.usable = usable && out.samples > 0;
  if (out.samples > 0) out.soft_volume_share /= static_cast<double>(out.samples);
  out.density = density_of(curves, engine);
  out.stages = stage_means(curves, engine);
  return out;
}

std::optional<DensitySummary> density_of(const std::vector<MacroCurve>& curves, const std::string& engine) {
  std::optional<DensitySummary> out;
  for (const MacroCurve& c : curves) {
    if (c.engine != engine || !c.density) continue;
    if (!out) out = {c.density->target, c.density->tolerance, {}};
    out->samples.push_back(
        {c.sample, c.solid_fraction, c.solid_fraction - c.density->target, c.density->friction, c.density->tries});
  }
  return out;
}

std::string density_text(const DensitySummary& density) {
  const auto range = [&](auto member, const NumberForm& form) {
    const auto [low, high] = std::ranges::minmax(density.samples, {}, member);
    const std::string first = rounded_text(static_cast<double>(low.*member), form);
    const std::string last = rounded_text(static_cast<double>(high.*member), form);
    return first == last ? first : first + " to " + last;
  };
  const std::size_t n = density.samples.size();
  return fmt::format(
      "target solid fraction {:g} +- {:g}: {} of {} sample{}, with compaction_mu {}, found in {} "
      "preparations{}",
      density.target, density.tolerance, range(&DensitySample::solid_fraction, {5, true}), n, n == 1 ? "" : "s",
      range(&DensitySample::friction, {4}), range(&DensitySample::tries, {4}), n == 1 ? "" : " of each");
}

namespace {

std::optional<double> mean_if_any(const MeanError& m) { return m.n > 0 ? std::optional(m.mean) : std::nullopt; }

}  // namespace

ComparisonSummary summary_of(const Comparison& c) {
  ComparisonSummary out{c.axial_difference.mean,
                        c.axial_difference.error,
                        c.lateral_difference.mean,
                        mean_if_any(c.strain_difference),
                        mean_if_any(c.deviator_difference),
                        mean_if_any(c.unloading_ratio),
                        c.axial_end_ratio.mean,
                        c.lateral_stress_ratio_candidate.mean,
                        c.lateral_stress_ratio_reference.mean,
                        c.speedup_seconds,
                        c.speedup_contact_evaluations,
                        {},
                        c.left_out};
  for (const SampleComparison& s : c.samples)
    out.samples.push_back({s.sample, s.strain_high, s.axial_difference, s.axial_end_ratio});
  return out;
}

std::vector<std::string> measurement_remarks(const Measurements& data) {
  std::vector<std::string> out;
  for (const auto& [ignored, relaxation] : enum_names<Relaxation>) {
    std::int64_t bad = 0;
    std::int64_t all = 0;
    for (const PackingRun& run : data.runs) {
      if (run.relaxation != relaxation) continue;
      for (const NormalPoint& p : run.normal) bad += p.converged ? 0 : 1;
      for (const TangentialPoint& p : run.tangential) bad += p.converged ? 0 : 1;
      all += static_cast<std::int64_t>(run.normal.size() + run.tangential.size());
    }
    if (bad > 0)
      out.push_back(
          fmt::format("{} of {} points of the {} relaxation did not meet its criterion and are left out of the fit",
                      bad, all, relaxation));
  }
  return out;
}

namespace {

/// The free twin may be without stress for a while: its grains spread into the voids between bodies first.
bool lacks_stress(const MacroCurve& c) {
  return c.usable && c.twin() != Twin::free && !c.stress_axial.empty() && c.stress_axial.back() == 0.0;
}

}  // namespace

bool all_carry_stress(const std::vector<MacroCurve>& curves) {
  return std::none_of(curves.begin(), curves.end(), lacks_stress);
}

namespace {

/// One line for each engine: what the first of its usable curves says, and of how many others that say something.
std::vector<std::string> said_by_engine(const std::vector<MacroCurve>& curves, std::string MacroCurve::*text,
                                        const std::string& of) {
  std::vector<std::string> out;
  std::vector<std::string> seen;
  for (const MacroCurve& c : curves) {
    if (!c.usable || (c.*text).empty() || std::find(seen.begin(), seen.end(), c.engine) != seen.end()) continue;
    seen.push_back(c.engine);
    const std::vector<MacroCurve> all = curves_of(curves, c.engine);
    const auto others =
        std::count_if(all.begin(), all.end(), [&](const MacroCurve& o) { return o.usable && !(o.*text).empty(); }) - 1;
    const std::string more = others > 0 ? fmt::format(" (and of {} more)", others) : "";
    out.push_back(fmt::format("{}'{}' of sample {}{}: {}", of, c.engine, c.sample, more, c.*text));
  }
  return out;
}

}  // namespace

std::vector<std::string> run_warnings(const std::vector<MacroCurve>& curves, const std::string& of) {
  return said_by_engine(curves, &MacroCurve::warning, of);
}

std::vector<std::string> run_notes(const std::vector<MacroCurve>& curves, const std::string& of) {
  std::vector<std::string> out;
  for (const MacroCurve& c : curves)
    if (lacks_stress(c))
      out.push_back(fmt::format("{}'{}' of sample {} carries no stress at its end: what is relative to it is undefined",
                                of, c.engine, c.sample));
  for (const MacroCurve& c : curves)
    if (!c.usable) out.push_back(fmt::format("{}'{}' of sample {} is not usable: {}", of, c.engine, c.sample, c.note));
  for (std::string& one : said_by_engine(curves, &MacroCurve::note, of)) out.push_back(std::move(one));
  return out;
}

std::vector<std::string> macro_warnings(const std::vector<MacroCurve>& curves) {
  return run_warnings(curves, "macro run ");
}

std::vector<std::string> macro_remarks(const std::vector<MacroCurve>& curves) {
  std::vector<std::string> out = run_notes(curves, "macro run ");
  if (!curves.empty())
    if (const auto density = density_of(curves, curves.front().engine)) out.push_back(density_text(*density));
  if (!use_pair_law(curves)) return out;
  out.emplace_back(
      "a solid grain of finite radius meets a soft particle by the law measured against a plane; mu of the grains "
      "is taken as the friction limit of soft contacts");
  out.push_back(pair_law_remark());
  return out;
}

std::vector<std::string> warnings_of(const AnySummary& summary) {
  std::vector<std::string> out;
  if (parse_enum<RunStatus>(summary.status) == RunStatus::not_usable && summary.remarks) out = *summary.remarks;
  out.insert(out.end(), summary.warnings.begin(), summary.warnings.end());
  std::erase(out, "");
  return out;
}

std::vector<std::string> notes_of(const AnySummary& summary) {
  if (parse_enum<RunStatus>(summary.status) == RunStatus::not_usable || !summary.remarks) return {};
  std::vector<std::string> out = *summary.remarks;
  std::erase(out, "");
  return out;
}

}  // namespace softgrain
