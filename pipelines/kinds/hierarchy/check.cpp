// softgrain check of hierarchies.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipelines/kinds/hierarchy/scene.h"
#include "pipelines/kinds/law_table/multi_contact_check.h"

namespace softgrain {

namespace {

/// Levels until the law no longer changes: four in the shipped scene.
double expected_levels(const HierarchySetup& setup) {
  constexpr std::int64_t kUsual = 4;
  return static_cast<double>(std::max(setup.levels, std::min(setup.iterations, kUsual)));
}

/// Counts and ratios of pipelines/four_decades.toml.
void spend_on_levels(const HierarchySetup& setup, const MeasureTrial& trial, Findings& out) {
  constexpr double kInside = 9.0;         // time of a level over that of the finest, which has nothing inside
  constexpr double kFillingPasses = 8e5;  // filling the voids of one packing takes as long as so many passes over it
  spend_on_packings(setup.multi_contact, trial, expected_levels(setup), out);
  spend_on_multi_contact(setup.multi_contact, trial, 1.0, "level 0", out);
  const double further = expected_levels(setup) - 1.0;
  if (further > 0.0) {
    spend_on_multi_contact(setup.multi_contact, trial, further * kInside, "further levels", out);
    out.spend("filling", kFillingPasses * trial.pass_seconds * static_cast<double>(setup.multi_contact.packings_max));
  }
}

/// Adds the time of the resolved check of two decades: every inner soft particle holds as many grains as its parent.
void spend_on_resolved(const HierarchySetup& setup, const MeasureTrial& trial, Findings& out) {
  if (setup.check_packings == 0 || setup.check_overlaps.empty()) return;
  constexpr double kHoles = 240.0;   // soft particles that the voids take
  constexpr double kFilled = 0.64;   // of the shell, where grains and soft particles jam
  constexpr double kGrains = 0.706;  // of grains alone
  const double soft = setup.next_volume / kGrains;
  const double holes = setup.check_inner > 0 ? static_cast<double>(setup.check_inner) : kHoles;
  const double inner =
      setup.fill == LevelFill::voids ? holes : kFilled * soft / (1.0 + soft) / std::pow(setup.inner_radius, 3);
  MultiContactConfiguration plane;
  plane.partners = {{PartnerKind::plane, 0.0, {{1.0, 0.0, 0.0}}}};
  plane.stages = {{MultiContactMove::load, {setup.check_overlaps.back()}}};
  // The grains of the smallest inner particles set the step.
  out.spend("resolved check", static_cast<double>(setup.check_packings) * (1.0 + inner) / setup.inner_radius *
                                  seconds_per_packing(plane, setup.multi_contact, trial.pass_seconds));
}

}  // namespace

void check_hierarchy(const HierarchySetup& setup, Findings& out) {
  const auto configurations = static_cast<std::int64_t>(setup.multi_contact.configurations.size());
  out.facts["levels"] = setup.levels;
  out.facts["levels_max"] = setup.iterations;
  out.facts["runs_per_level_min"] = configurations * setup.multi_contact.packings_min;
  out.lines += fmt::format("  {} levels, up to {} on the way to the fixed point, {} to {} runs each\n", setup.levels,
                           setup.iterations, configurations * setup.multi_contact.packings_min,
                           configurations * setup.multi_contact.packings_max);
  const MeasureTrial trial = check_multi_contact(setup.multi_contact, out);
  spend_on_levels(setup, trial, out);
  spend_on_resolved(setup, trial, out);
}

}  // namespace softgrain
