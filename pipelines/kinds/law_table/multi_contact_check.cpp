#include "pipelines/kinds/law_table/multi_contact_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/core/text.h"
#include "microsim/multi_contact_experiment.h"
#include "microsim/particles/scene_memory.h"
#include "pipelines/kinds/soft_particle/check.h"

namespace softgrain {

namespace {

/// Loop passes of a damped relaxation per increment, recorded states included.
constexpr double kDampedPasses = 150.0;

double softs_of(const MultiContactConfiguration& c) {
  return static_cast<double>(std::count_if(c.partners.begin(), c.partners.end(),
                                           [](const MultiContactPartner& p) { return p.kind == PartnerKind::soft; }));
}

std::int64_t increments_of(const MultiContactConfiguration& c, const MultiContactOptions& options) {
  return count_increments(c, MultiContactPlan(c.stages.size(), {1.0}), options);
}

bool has_stage(const MultiContactConfiguration& c, MultiContactMove move) {
  return std::any_of(c.stages.begin(), c.stages.end(), [&](const MultiContactStage& s) { return s.move == move; });
}

/// What the fit will miss.
void warn_of_configurations(const MultiContactSetup& setup, Findings& out) {
  const auto any = [&](const auto& holds) {
    return std::any_of(setup.configurations.begin(), setup.configurations.end(), holds);
  };
  const auto partner = [](PartnerKind kind) {
    return [kind](const MultiContactConfiguration& c) { return c.partners.front().kind == kind; };
  };
  if (!any([](const MultiContactConfiguration& c) {
        return c.partners.size() == 1 && c.partners.front().kind == PartnerKind::plane && !c.held_out;
      }))
    out.warn("no configuration with one plane: nothing fixes the pressure, and there will be no law");
  if (!any([](const MultiContactConfiguration& c) {
        return c.touching() > 2 && c.partners.front().kind == PartnerKind::plane && !c.held_out;
      }))
    out.warn("no configuration with three planes or more: the coupling of neighbours is not determined");
  if (!any(partner(PartnerKind::solid))) out.warn("no solid neighbours: macro scenes cannot use such a table");
  if (!any(partner(PartnerKind::soft))) out.warn("no soft neighbours: macro scenes cannot use such a table");
  if (!any([](const MultiContactConfiguration& c) { return has_stage(c, MultiContactMove::slide); }))
    out.warn("no path slides: friction limit and tangential stiffness will not be measured");
  if (!any([](const MultiContactConfiguration& c) { return has_stage(c, MultiContactMove::roll); }))
    out.warn("no path rolls: soft particles will roll freely, and resist shear less than they do");
  if (!any([](const MultiContactConfiguration& c) { return has_stage(c, MultiContactMove::unload); }))
    out.warn("no path unloads: the unloading branch will not be measured");
  if (!any([](const MultiContactConfiguration& c) { return c.held_out; }))
    out.warn("nothing is held out: how well the law predicts is known from leaving one out alone");
  constexpr std::int64_t kFew = 6;
  if (setup.packings_min < kFew)
    out.warn(fmt::format("only {} at least; single loadings differ by 10 % and more between packings",
                         counted(setup.packings_min, "packing")));
}

void add_overlaps(const MultiContactSetup& setup, Findings& out) {
  double deepest = 0.0;
  for (const MultiContactConfiguration& c : setup.configurations)
    if (c.partners.front().kind == PartnerKind::plane)
      for (const MultiContactStage& s : c.stages)
        deepest = std::max(deepest, *std::max_element(s.overlap.begin(), s.overlap.end()));
  if (!(deepest > 0.0)) return;
  const double overlap = expected_grain_overlap(PairKind::soft_solid, deepest);
  out.add(
      "grain_overlap", overlap,
      fmt::format("grains overlap by about {:.2g} of the smaller radius at the largest overlap with a plane, {} Rs; "
                  "more with several neighbours",
                  overlap, deepest));
  constexpr double kLarge = 1.0;
  if (overlap > kLarge)
    out.warn(
        fmt::format("planes press in by {} Rs: grains overlap by about {:.2g} of the smaller radius, and Hertz' law is "
                    "one of small overlaps",
                    deepest, overlap));
}

/// Core seconds of a loop pass over one soft particle, squeezed, and of its packing.
MeasureTrial try_one(const MultiContactSetup& setup, Findings& out) {
  constexpr double kBudget = 0.3;
  MeasureTrial t = try_soft_particle(setup.spec, setup.seed, kBudget);
  out.add("grains", t.packing.radius.size(),
          fmt::format("grains in the first packing: {}, solid fraction {:.3f}", t.packing.radius.size(),
                      t.packing.solid_fraction()));
  out.facts["solid_fraction"] = t.packing.solid_fraction();
  return t;
}

/// Loop passes of one packing in one configuration, as the relaxation has it. Of dynamics they are the time it takes
/// over its step: the smallest grain sets that, and 4.9 steps of factor 4 are Rs sqrt(rho/E) where it is 0.05 Rs.
double passes_of(const MultiContactConfiguration& c, const MultiContactSetup& setup) {
  const MultiContactOptions& o = setup.options;
  const double way = static_cast<double>(increments_of(c, o));
  if (o.relaxation == Relaxation::damped) return way * kDampedPasses;
  constexpr double kPolish = 250.0;  ///< relaxation of a recorded state
  const bool real = o.relaxation == Relaxation::published;
  const double smallest = setup.spec.rmax_over_shell / setup.spec.polydispersity;
  const double per_time = (real ? 26.5 : 19.6 / o.step_factor) * 0.05 / smallest;
  const double natural = natural_time(setup.spec);
  const double speed = o.approach_speed > 0.0 ? o.approach_speed : published_speed(setup.spec);
  const double moving = way * o.increment * setup.spec.shell_radius / (speed * natural);
  const double rest = real ? 7.0 * published_interval(setup.spec) / natural : o.settle_time;
  const double points = static_cast<double>(c.stages.size()) * static_cast<double>(setup.points);
  return per_time * (moving + points * rest) + points * kPolish;
}

/// Packings that a configuration takes in the mean until its target is met, those of the pilot included: forces at
/// the largest overlap scatter by about a fifth between packings.
double expected_packings(const MultiContactSetup& setup, const MultiContactConfiguration& c) {
  constexpr double kScatter = 0.2;
  const double needed = std::pow(kScatter / setup.target, 2);
  return std::clamp(needed, static_cast<double>(setup.least_packings(c)), static_cast<double>(setup.most_packings(c)));
}

/// Core seconds of what the plan asks for beyond that, in one orientation.
double planned_seconds(const MultiContactSetup& setup, double pass_seconds) {
  double seconds = 0.0;
  for (const PlannedPackings& p : setup.plan)
    for (const MultiContactConfiguration& c : setup.configurations)
      if (c.name == p.configuration)
        seconds += std::max(static_cast<double>(p.packings) - expected_packings(setup, c), 0.0) *
                   seconds_per_packing(cut_short(c, p.depth), setup, pass_seconds);
  return seconds;
}

}  // namespace

void check_configurations(const MultiContactSetup& setup, Findings& out) {
  const auto configurations = static_cast<std::int64_t>(setup.configurations.size());
  std::int64_t increments = 0;
  std::int64_t stages = 0;
  std::int64_t least = 0;
  std::int64_t most = 0;
  for (const MultiContactConfiguration& c : setup.configurations) {
    least += setup.orientations * setup.least_packings(c);
    most += setup.orientations * setup.most_packings(c);
    increments += increments_of(c, setup.options);
    stages += static_cast<std::int64_t>(c.stages.size());
  }
  out.facts["configurations"] = configurations;
  out.facts["runs_min"] = least;
  out.facts["runs_max"] = most;
  out.facts["points_per_packing"] = stages * setup.points;
  out.facts["relaxations_per_packing"] = increments;
  const std::string own =
      (setup.packings.empty() ? "" : fmt::format(" ({} on as many as they say)", setup.packings.size())) +
      (setup.orientations > 1 ? fmt::format(" in {} orientations each", setup.orientations) : "") +
      (setup.plan.empty() ? "" : fmt::format(" and {} as planned", setup.plan.size()));
  const auto range = [](std::int64_t low, std::int64_t high) {
    return low == high ? fmt::format("{}", low) : fmt::format("{} to {}", low, high);
  };
  out.lines += fmt::format("  {} configurations on {} packings{}: {} runs\n", configurations,
                           range(setup.packings_min, setup.packings_max), own, range(least, most));
  out.lines +=
      fmt::format("  per packing: up to {} recorded states, about {} relaxations\n", stages * setup.points, increments);
  add_overlaps(setup, out);
  warn_of_configurations(setup, out);
}

MeasureTrial check_multi_contact(const MultiContactSetup& setup, Findings& out) {
  check_configurations(setup, out);
  const MeasureTrial trial = try_one(setup, out);
  double softs = 0.0;
  for (const MultiContactConfiguration& c : setup.configurations) softs = std::max(softs, softs_of(c));
  const double bodies = static_cast<double>(trial.packing.radius.size()) * (1.0 + softs);
  const double memory = estimated_memory(static_cast<std::int64_t>(bodies), kPairsPerGrain * bodies);
  out.add("bytes", memory, "memory: about " + bytes_text(memory) + " for the largest measurement under way");
  warn_of_soft_particle(setup.spec, out);
  return trial;
}

double seconds_per_packing(const MultiContactConfiguration& configuration, const MultiContactSetup& setup,
                           double pass_seconds) {
  return (1.0 + softs_of(configuration)) * passes_of(configuration, setup) * pass_seconds;
}

void spend_on_packings(const MultiContactSetup& setup, const MeasureTrial& trial, double times, Findings& out) {
  out.spend("packings", times * trial.packing_seconds * static_cast<double>(setup.pool()));
}

void spend_on_multi_contact(const MultiContactSetup& setup, const MeasureTrial& trial, double times,
                            const std::string& part, Findings& out) {
  double seconds = 0.0;
  for (const MultiContactConfiguration& c : setup.configurations)
    seconds += expected_packings(setup, c) * seconds_per_packing(c, setup, trial.pass_seconds);
  seconds += planned_seconds(setup, trial.pass_seconds);
  out.spend(part, times * static_cast<double>(setup.orientations) * seconds);
}

}  // namespace softgrain
