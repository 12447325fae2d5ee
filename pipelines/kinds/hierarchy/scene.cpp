#include "pipelines/kinds/hierarchy/scene.h"

#include <algorithm>

#include "calibrate/crowd_fit.h"

namespace softgrain {

namespace {

constexpr std::int64_t kMany = 1000000;

void read_levels(const SceneTable& t, HierarchySetup& out) {
  out.levels = t.count("levels", 2, 100, out.levels);
  out.voids.r_max = t.number("inner_radius_max", Unit::none, Range{0.0, 1.0, true, true}, 0.1);
  out.voids.r_min =
      t.number("inner_radius_min", Unit::none, Range{0.0, out.voids.r_max, true, false}, 0.5 * out.voids.r_max);
  out.voids.count = t.count("inner_count", 1, kMany, kMany);
  out.form = t.choice<Crowd>("form", out.form);
  out.unloading = t.flag("unloading", out.unloading);
  out.rolling = t.flag("rolling", out.rolling);
}

void read_fixed_point(const SceneTable& t, HierarchySetup& out) {
  out.iterations = t.count("iterations", out.levels, 1000, std::max(out.levels, out.iterations));
  out.tolerance = t.number("tolerance", Unit::none, Range{0.0, 1.0, true, true}, out.tolerance);
}

void read_check(const SceneTable& t, HierarchySetup& out) {
  out.check_packings = t.count("packings", 0, out.crowd.packings_min, out.check_packings);
  out.check_overlaps = t.numbers("overlaps", Unit::none, Range{0.0, 1.0, true, true}, {0.15, 0.2, 0.25});
  if (out.check_overlaps.empty() || std::adjacent_find(out.check_overlaps.begin(), out.check_overlaps.end(),
                                                       std::greater_equal<>()) != out.check_overlaps.end())
    t.mistake("overlaps", "must ascend");
  out.check_inner = t.count("inner_count", 0, kMany, 0);
}

bool has_one(const CrowdSetup& setup, PartnerKind kind) {
  return std::any_of(setup.configurations.begin(), setup.configurations.end(), [kind](const CrowdConfiguration& c) {
    return c.partners.size() == 1 && c.partners[0].kind == kind && !c.held_out;
  });
}

}  // namespace

HierarchySetup read_hierarchy_setup(const Scene& scene) {
  return scene.read([](const SceneTable& root) {
    HierarchySetup out;
    (void)root.choice("kind", {"hierarchy"});
    out.title = root.text("title", "");
    out.crowd = read_crowd_setup(root);
    read_levels(root.table("hierarchy"), out);
    read_fixed_point(root.table_or_empty("fixed_point"), out);
    if (root.has("check")) read_check(root.table("check"), out);
    for (const PartnerKind kind : {PartnerKind::plane, PartnerKind::solid, PartnerKind::soft})
      if (!has_one(out.crowd, kind))
        root.mistake("configuration", "a hierarchy needs a configuration \"one\" with a " + to_string(kind) +
                                          " partner: inner soft particles meet all three kinds");
    if (out.crowd.packings_max < CrowdFitOptions{}.min_packings)
      root.table_or_empty("crowd").mistake("packings_max", "fewer than 4: there would be no fit");
    return out;
  });
}

}  // namespace softgrain
