#include "pipelines/kinds/hierarchy/scene.h"

#include <algorithm>

#include "calibrate/multi_contact_fit.h"
#include "microsim/filled_shell.h"

namespace softgrain {

namespace {

constexpr double kSmallestHole = 0.45;  ///< radius of the smallest hole that is filled, over the largest

/// Soft particles hold what is finer: their largest grain is as large as the smallest one beside them.
double inner_radius_of(const SoftParticleSpec& spec) {
  return spec.sizes ? spec.sizes->smallest() / spec.sizes->largest() : 1.0 / spec.polydispersity;
}

void read_levels(const SceneTable& t, HierarchySetup& out) {
  const SoftParticleSpec& spec = out.multi_contact.spec;
  out.levels = t.count("levels", 2, 100, out.levels);
  out.inner_radius = t.number("inner_radius", Unit::none, Range{0.01, 0.5, false, false},
                              std::clamp(inner_radius_of(spec), 0.01, 0.5));
  out.fill = t.choice<LevelFill>("fill", out.fill);
  if (out.fill == LevelFill::voids)
    out.inner_radius_min = t.number("inner_radius_min", Unit::none, Range{0.0, out.inner_radius, true, false},
                                    kSmallestHole * out.inner_radius);
  else if (t.has("inner_radius_min"))
    t.add_error("inner_radius_min", "goes with fill = \"voids\"");
  const Range volumes{0.0, 100.0, true, false};
  out.next_volume = spec.sizes
                        ? t.number("next_volume", Unit::none, volumes)
                        : t.number("next_volume", Unit::none, volumes, next_volume(spec.exponent, spec.polydispersity));
  out.replicates = t.count("replicates", 0, 1000, out.replicates);
  out.form = t.choice<LawForm>("form", out.form);
  out.unloading = t.flag("unloading", out.unloading);
  out.rolling = t.flag("rolling", out.rolling);
}

void read_fixed_point(const SceneTable& t, HierarchySetup& out) {
  out.iterations = t.count("iterations", out.levels, 1000, std::max(out.levels, std::int64_t{8}));
  out.tolerance = t.number("tolerance", Unit::none, Range{0.0, 1.0, true, true}, out.tolerance);
}

void read_check(const SceneTable& t, HierarchySetup& out) {
  const std::int64_t most = out.multi_contact.packings_min;
  out.check_packings = t.count("packings", 0, most, most);
  out.check_overlaps = t.numbers("overlaps", Unit::none, Range{0.0, 1.0, true, true}, {0.15, 0.2, 0.25});
  if (out.check_overlaps.empty() || std::adjacent_find(out.check_overlaps.begin(), out.check_overlaps.end(),
                                                       std::greater_equal<>()) != out.check_overlaps.end())
    t.add_error("overlaps", "must ascend");
  if (out.fill == LevelFill::voids)
    out.check_inner = t.count("inner_count", 0, 1000000, 0);
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
    (void)root.choice("kind", {"hierarchy"});
    out.title = root.text("title", "");
    out.multi_contact = read_multi_contact_setup(root);
    read_levels(root.table("hierarchy"), out);
    out.iterations = out.levels;
    out.seeks_fixed_point = root.has("fixed_point");
    if (out.seeks_fixed_point) read_fixed_point(root.table("fixed_point"), out);
    if (root.has("check")) read_check(root.table("check"), out);
    for (const PartnerKind kind : {PartnerKind::plane, PartnerKind::solid, PartnerKind::soft})
      if (!has_one(out.multi_contact, kind))
        root.add_error("configuration", "a hierarchy needs a configuration \"one\" with a " + to_string(kind) +
                                            " partner: inner soft particles meet all three kinds");
    if (out.multi_contact.packings_max < MultiContactFitOptions{}.min_packings)
      root.table_or_empty("multi_contact").add_error("packings_max", "fewer than 4: there would be no fit");
    return out;
  });
}

}  // namespace softgrain
