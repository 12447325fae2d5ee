#include "pipelines/run/run_summary.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <map>

#include "common/core/error.h"
#include "common/core/statistics.h"
#include "common/data/law_remarks.h"
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

}  // namespace

json packings_json(const Measurements& data) {
  const auto phi = over(data.packings, [](const PackingInfo& p) { return p.solid_fraction; });
  const auto b = over(data.packings, [](const PackingInfo& p) { return p.exponent; });
  const auto z = over(data.packings, [](const PackingInfo& p) { return p.contacts_per_grain; });
  const auto n = over(data.packings, [](const PackingInfo& p) { return static_cast<double>(p.grains); });
  return {{"count", data.packings.size()},
          {"solid_fraction", phi.mean},
          {"solid_fraction_deviation", phi.deviation_or_zero()},
          {"exponent", b.mean},
          {"exponent_deviation", b.deviation_or_zero()},
          {"contacts_per_grain", z.mean},
          {"grains", n.mean},
          {"grains_deviation", n.deviation_or_zero()}};
}

json measurement_json(const Measurements& data, const std::string& relaxation) {
  std::int64_t points = 0;
  Cost cost;
  for (const PackingRun& run : data.runs) {
    if (run.relaxation != relaxation) continue;
    points += static_cast<std::int64_t>(run.normal.size());
    for (const TangentialPoint& t : run.tangential) points += t.angle_deg != 0.0 ? 1 : 0;
    cost += run.normal_cost;
    cost += run.tangential_cost;
  }
  const double n = points > 0 ? static_cast<double>(points) : 1.0;
  return {{"relaxation", relaxation},
          {"points", points},
          {"loop_passes", cost.loop_passes},
          {"contact_evaluations", cost.contact_evaluations},
          {"seconds", cost.seconds},
          {"loop_passes_per_point", static_cast<double>(cost.loop_passes) / n},
          {"seconds_per_point", cost.seconds / n}};
}

json forces_json(const Measurements& data, const std::string& relaxation) {
  std::map<std::string, std::map<double, std::vector<double>>> forces;
  for (const PackingRun& run : data.runs) {
    if (run.relaxation != relaxation) continue;
    for (const NormalPoint& p : run.normal)
      if (p.converged) forces[to_string(run.kind)][p.delta].push_back(p.force);
  }
  json out = json::object();
  for (const auto& [kind, rows] : forces)
    for (const auto& [delta, values] : rows) {
      const MeanError m = mean_error(values);
      out[kind].push_back({{"delta", delta},
                           {"force", m.mean},
                           {"standard_error", m.error},
                           {"deviation", m.deviation},
                           {"packings", m.n}});
    }
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
    } catch (const BadInput& e) {  // what was measured is kept when not a point of it can be compared
      out[to_string(kind)] = {{"reason", e.what()}};
    }
  }
  return out;
}

json identity_json(const LawIdentity& law) {
  const auto known = [](const std::optional<double>& x) { return x ? json(*x) : json(nullptr); };
  return {{"form", law.form ? to_string(*law.form) : ""},
          {"solid_fraction", law.solid_fraction > 0.0 ? json(law.solid_fraction) : json(nullptr)},
          {"E", law.youngs_modulus},
          {"nu", known(law.poisson_ratio)},
          {"mu", known(law.friction)},
          {"hash", law.hash}};
}

json macro_json(const std::vector<MacroCurve>& curves, const std::string& engine) {
  Cost cost;
  std::int64_t bodies = 0;
  std::int64_t samples = 0;
  std::int64_t grains = 0;
  double share = 0.0;
  bool usable = true;
  LawIdentity law;  ///< the same for all samples
  for (const MacroCurve& c : curves) {
    if (c.engine != engine) continue;
    cost += c.cost;
    bodies = std::max(bodies, c.bodies);
    grains = std::max(grains, c.grains);
    share += c.soft_volume_share;
    usable = usable && c.usable;
    law = c.law;
    ++samples;
  }
  json out{{"samples", samples},
           {"bodies", bodies},
           {"grains_inside", grains},
           {"soft_volume_share", samples > 0 ? share / static_cast<double>(samples) : 0.0},
           {"loop_passes", cost.loop_passes},
           {"contact_evaluations", cost.contact_evaluations},
           {"seconds", cost.seconds},
           {"usable", usable && samples > 0}};
  if (law.form) out["law"] = identity_json(law);
  return out;
}

std::vector<std::string> measurement_remarks(const Measurements& data) {
  std::vector<std::string> out;
  for (const auto& [ignored, relaxation] : words<Relaxation>) {
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

std::vector<std::string> macro_remarks(const std::vector<MacroCurve>& curves) {
  std::vector<std::string> out;
  for (const MacroCurve& c : curves)
    if (lacks_stress(c))
      out.push_back(
          fmt::format("macro run '{}' of sample {} carries no stress at its end: what is relative to it is "
                      "undefined",
                      c.engine, c.sample));
  for (const MacroCurve& c : curves)
    if (!c.usable)
      out.push_back(fmt::format("macro run '{}' of sample {} is not usable: {}", c.engine, c.sample, c.note));
    else if (!c.note.empty())
      out.push_back(fmt::format("macro run '{}' of sample {}: {}", c.engine, c.sample, c.note));
  if (!use_pair_law(curves)) return out;
  out.emplace_back(
      "a solid grain of finite radius meets a soft particle by the law measured against a plane; mu of the grains "
      "stands in for the friction limit of soft contacts");
  out.push_back(pair_law_remark());
  return out;
}

json provenance_json(const Provenance& p) {
  return {{"version", p.version}, {"commit", p.commit},   {"compiler", p.compiler}, {"threads", p.threads},
          {"seed", p.seed},       {"command", p.command}, {"scene", p.scene}};
}

}  // namespace softgrain
