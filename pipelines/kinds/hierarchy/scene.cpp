// Reads scenes of kind "hierarchy", and says what follows from them: softgrain check.
#include "pipelines/kinds/hierarchy/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibrate/multi_contact_fit.h"
#include "microsim/filled_shell.h"
#include "pipelines/kinds/law_table/multi_contact_summary.h"

namespace softgrain {

namespace {

constexpr double kSmallestHole = 0.45;  ///< radius of the smallest hole that is filled, over the largest

/// Soft particles hold what is finer: their largest grain is as large as the smallest one beside them.
double inner_radius_of(const SoftParticleSpec& spec) {
  return spec.sizes ? spec.sizes->smallest() / spec.sizes->largest() : 1.0 / spec.polydispersity;
}

void read_levels(const SceneTable& t, HierarchySetup& out) {
  const SoftParticleSpec& spec = out.multi_contact.spec;
  out.levels = t.count({"levels", "number of decades"}, 2, 100, out.levels);
  out.inner_radius =
      t.number({"inner_radius", "radius of the inner soft particles over Rs; `\"voids\"`: of the largest one",
                "smallest over largest grain radius; inner grains then end where the grains beside them begin"},
               Unit::none, Range{0.01, 0.5, false, false}, std::clamp(inner_radius_of(spec), 0.01, 0.5));
  out.fill = t.choice<LevelFill>(
      {"fill",
       "placement of the inner soft particles; `\"voids\"`: in the voids of the packing of grains, largest hole first; "
       "`\"masses\"`: drawn together with the grains, in the share that `next_volume` gives"},
      out.fill);
  if (out.fill == LevelFill::voids)
    out.inner_radius_min = t.number(
        {"inner_radius_min", "`\"voids\"`: holes with a smaller radius over Rs stay empty", "0.45 of `inner_radius`"},
        Unit::none, Range{0.0, out.inner_radius, true, false}, kSmallestHole * out.inner_radius);
  else
    t.refuse({"inner_radius_min"}, "goes with fill = \"voids\"");
  const Range volumes{0.0, 100.0, true, false};
  const Key volume{"next_volume", "volume of the grains of the next finer level, over that of a level's own grains",
                   "Pi^(b-4), Pi: `polydispersity`, b: `exponent`; must be given with `[packing.sizes]`"};
  out.next_volume = spec.sizes ? t.number(volume, Unit::none, volumes)
                               : t.number(volume, Unit::none, volumes, next_volume(spec.exponent, spec.polydispersity));
  out.replicates =
      t.count({"replicates", "refits to packings drawn with replacement; 0: no error bars"}, 0, 1000, out.replicates);
  out.form = t.choice<LawForm>({"form", "law of the inner soft particles"}, out.form);
  out.unloading =
      t.flag({"unloading", "true: the law of the inner soft particles uses its unloading branch"}, out.unloading);
  t.refuse({"unloading_ratio"}, "goes with macro scenes alone");
  out.rolling = t.flag(
      {"rolling", "true: the law of the inner soft particles uses its rolling resistance, if measured"}, out.rolling);
}

void read_fixed_point(const SceneTable& t, HierarchySetup& out) {
  out.iterations = t.count({"iterations", "largest number of levels", "8, or `levels` if larger"}, out.levels, 1000,
                           std::max(out.levels, std::int64_t{8}));
  out.tolerance = t.number({"tolerance",
                            "the law counts as constant if two levels differ by less than this, or by less than the "
                            "scatter of packings explains"},
                           Unit::none, Range{0.0, 1.0, true, true}, out.tolerance);
}

void read_check(const SceneTable& t, HierarchySetup& out) {
  const std::int64_t most = out.multi_contact.packings_min;
  out.check_packings =
      t.count({"packings", "number of packings in the check, at most `packings_min`; 0, or no `[check]`: no check",
               "`packings_min`"},
              0, most, most);
  out.check_overlaps = t.numbers({"overlaps", "overlaps h/Rs of the check, ascending"}, Unit::none,
                                 Range{0.0, 1.0, true, true}, {0.15, 0.2, 0.25});
  if (out.check_overlaps.empty() || std::adjacent_find(out.check_overlaps.begin(), out.check_overlaps.end(),
                                                       std::greater_equal<>()) != out.check_overlaps.end())
    t.add_error("overlaps", "must ascend");
  if (out.fill == LevelFill::voids)
    out.check_inner =
        t.count({"inner_count", "`\"voids\"`: number of the largest inner soft particles that are resolved; 0: all"}, 0,
                1000000, 0);
  else if (t.has("inner_count"))
    t.add_error("inner_count",
                "goes with fill = \"voids\": without some of its soft particles a level would have holes");
}

bool has_one(const MultiContactSetup& setup, PartnerKind kind) {
  return std::any_of(setup.configurations.begin(), setup.configurations.end(),
                     [kind](const MultiContactConfiguration& c) {
                       return c.partners.size() == 1 && c.partners[0].kind == kind && !c.held_out;
                     });
}

}  // namespace

HierarchySetup read_hierarchy_setup(const Scene& scene) {
  return scene.read([](const SceneTable& root) {
    HierarchySetup out;
    (void)root.choice(kKindKey, {"hierarchy"});
    out.title = root.title();
    out.multi_contact = read_multi_contact_setup(root);
    read_levels(
        root.table({"hierarchy",
                    "levels of soft particles inside soft particles: their number, what they hold, and by which law"}),
        out);
    out.iterations = out.levels;
    out.seeks_fixed_point = root.has("fixed_point");
    if (out.seeks_fixed_point)
      read_fixed_point(root.table({"fixed_point",
                                   "with this table, levels are added until the law no longer changes. If it still "
                                   "changes at the last level, the exit status is 3"}),
                       out);
    if (root.has("check"))
      read_check(
          root.table(
              {"check", "compares the law with soft particles under one plane, with two decades of grains resolved"}),
          out);
    for (const PartnerKind kind : {PartnerKind::plane, PartnerKind::solid, PartnerKind::soft})
      if (!has_one(out.multi_contact, kind))
        root.add_error("configuration", "a hierarchy needs a configuration \"one\" with a " + to_string(kind) +
                                            " partner: inner soft particles meet all three kinds");
    const auto rolls = [](const MultiContactConfiguration& c) {
      return std::any_of(c.stages.begin(), c.stages.end(),
                         [](const auto& stage) { return stage.move == MultiContactMove::roll; });
    };
    const auto& configurations = out.multi_contact.configurations;
    if (std::none_of(configurations.begin(), configurations.end(), rolls))
      root.table("hierarchy").refuse({"rolling"}, "no [[configuration]] rolls: there is no rolling resistance");
    if (out.multi_contact.packings_max < MultiContactFitOptions{}.min_packings)
      root.table_or_empty("multi_contact").add_error("packings_max", "fewer than 4: there would be no fit");
    return out;
  });
}

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
