#include "pipelines/kinds/law_table/multi_contact_summary.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>

#include "common/core/limits.h"
#include "common/core/statistics.h"
#include "common/core/text.h"

namespace softgrain {

namespace {

/// Last stage of the loading at the beginning.
std::int64_t last_loading(const MultiContactConfiguration& c) {
  std::int64_t last = 0;
  while (last + 1 < static_cast<std::int64_t>(c.stages.size()) &&
         c.stages[static_cast<std::size_t>(last) + 1].move == MultiContactMove::load)
    ++last;
  return last;
}

/// Mean force over the neighbours of the centre.
double mean_force(const MultiContactConfiguration& c, const MultiContactPoint& p) {
  const auto end = p.normal.begin() + static_cast<std::ptrdiff_t>(std::min(c.touching(), p.normal.size()));
  return end == p.normal.begin() ? 0.0 : mean_error({p.normal.begin(), end}).mean;
}

/// Points up to the end of a stage.
std::size_t points_until(const MultiContactRun& run, std::int64_t stage) {
  return static_cast<std::size_t>(std::count_if(run.points.begin(), run.points.end(),
                                                [&](const MultiContactPoint& p) { return p.stage <= stage; }));
}

/// Forces at the end of the loading by packing, one per orientation; ways that were cut short have none.
std::map<std::int64_t, std::vector<double>> end_forces(const MultiContactConfiguration& c,
                                                       const std::vector<MultiContactRun>& runs) {
  const std::int64_t stage = last_loading(c);
  std::size_t whole = 1;
  for (const MultiContactRun& run : runs) whole = std::max(whole, points_until(run, stage));
  std::map<std::int64_t, std::vector<double>> out;
  for (const MultiContactRun& run : runs)
    if (points_until(run, stage) == whole && run.points[whole - 1].stage == stage)
      out[run.packing].push_back(mean_force(c, run.points[whole - 1]));
  return out;
}

MeanForce statistics(const std::vector<double>& values) {
  const MeanError m = mean_error(values);
  return {m.n > 0 ? m.mean : 0.0, m.n > 1 ? m.error : kInfinity, static_cast<std::int64_t>(m.n)};
}

/// Variance of single runs within a packing over all of it; NaN where packings have one orientation each, or too few.
double share_within(const MultiContactConfiguration& c, const std::vector<MultiContactRun>& runs) {
  Tally within;
  Tally orientations;
  std::vector<double> means;
  for (const auto& [packing, forces] : end_forces(c, runs)) {
    if (forces.size() < 2) continue;
    const MeanError m = mean_error(forces);
    within.add(m.deviation * m.deviation);
    orientations.add(static_cast<double>(forces.size()));
    means.push_back(m.mean);
  }
  if (means.size() < 2) return kNaN;
  const double of_means = std::pow(mean_error(means).deviation, 2);
  const double between = std::max(of_means - within.mean() / orientations.mean(), 0.0);
  return within.mean() / (within.mean() + between);
}

std::vector<MultiContactRun> runs_of(const MultiContactMeasurements& data, std::size_t configuration) {
  std::vector<MultiContactRun> out;
  for (const MultiContactRun& r : data.runs)
    if (r.configuration == static_cast<std::int64_t>(configuration)) out.push_back(r);
  return out;
}

/// Deepest overlap among the neighbours [Rs].
double deepest(const MultiContactPoint& p) {
  double h = 0.0;
  for (const double x : p.overlap) h = std::max(h, x);
  return h;
}

/// The first recorded overlap of the first stage where the mean force exceeds 1e-3 of that at its end.
double onset(const MultiContactConfiguration& c, const std::vector<MultiContactRun>& runs) {
  if (runs.empty()) return 0.0;
  std::vector<double> overlap;
  std::vector<double> force;
  for (std::size_t k = 0; k < runs[0].points.size() && runs[0].points[k].stage == 0; ++k) {
    overlap.push_back(deepest(runs[0].points[k]));
    force.push_back(0.0);
    for (const MultiContactRun& r : runs)
      if (k < r.points.size()) force.back() += mean_force(c, r.points[k]);
  }
  for (std::size_t k = 0; k < force.size(); ++k)
    if (force[k] > 1e-3 * force.back()) return overlap[k];
  return overlap.empty() ? 0.0 : overlap.back();
}

struct Convergence {
  std::int64_t points = 0;
  std::int64_t converged = 0;
};

Convergence convergence(const std::vector<MultiContactRun>& runs) {
  Convergence c;
  for (const MultiContactRun& r : runs)
    for (const MultiContactPoint& p : r.points) {
      ++c.points;
      c.converged += p.converged ? 1 : 0;
    }
  return c;
}

Cost cost_of(const std::vector<MultiContactRun>& runs) {
  Cost cost;
  for (const MultiContactRun& r : runs) cost += r.cost;
  return cost;
}

/// What further orientations of a packing are worth, over all configurations.
std::string orientations_text(const MultiContactMeasurements& data) {
  std::int64_t orientations = 1;
  for (const MultiContactRun& r : data.runs) orientations = std::max(orientations, r.orientation + 1);
  std::vector<double> shares;
  for (std::size_t k = 0; k < data.configurations.size(); ++k)
    if (const double share = share_within(data.configurations[k], runs_of(data, k)); std::isfinite(share))
      shares.push_back(share);
  if (shares.empty()) return "";
  const double same = 1.0 - mean_error(shares).mean;
  const auto n = static_cast<double>(orientations);
  return fmt::format(
      "{} orientations of every packing: {:.0f} % of the variance of end forces is between packings, the rest between "
      "orientations (mean of {}); so many count as {:.2f} packings of one orientation each\n",
      orientations, 100.0 * same, counted(shares.size(), "configuration"), n / (1.0 + (n - 1.0) * same));
}

ConfigurationSummary summary_of(const MultiContactConfiguration& c, const std::vector<MultiContactRun>& runs,
                                double target) {
  const MeanForce force = mean_end_force(c, runs);
  const Convergence points = convergence(runs);
  ConfigurationSummary out{.name = c.name,
                           .neighbours = c.touching(),
                           .held_out = c.held_out,
                           .packings = force.runs,
                           .force = force.mean,
                           .force_error = force.standard_error,
                           .target_met = met(force, target),
                           .onset = onset(c, runs),
                           .points = points.points,
                           .cost = cost_of(runs)};
  if (const double share = share_within(c, runs); std::isfinite(share)) out.within = share;
  if (points.points > 0)
    out.converged_share = static_cast<double>(points.converged) / static_cast<double>(points.points);
  return out;
}

}  // namespace

MeanForce mean_end_force(const MultiContactConfiguration& configuration, const std::vector<MultiContactRun>& runs) {
  std::vector<double> values;
  for (const auto& [packing, forces] : end_forces(configuration, runs)) values.push_back(mean_error(forces).mean);
  return statistics(values);
}

bool met(const MeanForce& force, double target) { return force.standard_error <= target * force.mean; }

MultiContactSummary summary_of(const MultiContactMeasurements& data, double target) {
  MultiContactSummary out{.relaxation = data.relaxation,
                          .runs = data.runs.size(),
                          .points = convergence(data.runs).points,
                          .cost = cost_of(data.runs)};
  for (std::size_t k = 0; k < data.configurations.size(); ++k)
    out.configurations.push_back(summary_of(data.configurations[k], runs_of(data, k), target));
  return out;
}

std::vector<std::string> multi_contact_remarks(const MultiContactMeasurements& data, double target) {
  constexpr std::size_t kNamed = 3;  // more than these are counted
  std::vector<std::string> remarks;
  std::vector<std::string> missed;
  for (std::size_t k = 0; k < data.configurations.size(); ++k) {
    const std::vector<MultiContactRun> runs = runs_of(data, k);
    const std::string& name = data.configurations[k].name;
    const MeanForce force = mean_end_force(data.configurations[k], runs);
    if (!met(force, target))
      missed.push_back(fmt::format("{}: standard error {:.1f} % of the mean force after {}, {:.1f} % was wanted", name,
                                   100.0 * force.standard_error / force.mean, counted(force.runs, "packing"),
                                   100.0 * target));
    const Convergence c = convergence(runs);
    if (c.converged < c.points)
      remarks.push_back(fmt::format("{}: {} of {} points did not converge", name, c.points - c.converged, c.points));
  }
  if (missed.size() > kNamed)
    missed = {
        fmt::format("{} of {} configurations are known less well than wanted ({:.1f} % of the mean force); see the "
                    "table",
                    missed.size(), data.configurations.size(), 100.0 * target)};
  remarks.insert(remarks.begin(), missed.begin(), missed.end());
  return remarks;
}

std::string multi_contact_text(const MultiContactMeasurements& data) {
  std::string text;
  for (std::size_t k = 0; k < data.configurations.size(); ++k) {
    const MultiContactConfiguration& c = data.configurations[k];
    const std::vector<MultiContactRun> runs = runs_of(data, k);
    const MeanForce f = mean_end_force(c, runs);
    text += fmt::format("  {:<28} {:>3} packings  onset {:.3f}  F/(E Rs^2) {:.5f} +- {:.5f}{}\n", c.name, f.runs,
                        onset(c, runs), f.mean, f.standard_error, c.held_out ? "  (held out)" : "");
  }
  return text + orientations_text(data);
}

}  // namespace softgrain
