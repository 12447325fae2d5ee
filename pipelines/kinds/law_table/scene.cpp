#include "pipelines/kinds/law_table/scene.h"

#include <algorithm>

#include "pipelines/kinds/soft_particle/scene.h"

namespace softgrain {

namespace {

/// `sound`: so is the base.
LawTableVariant read_variant(const SceneTable& t, const CrowdSetup& base, bool sound) {
  LawTableVariant v{base.spec, {}};
  v.spec.beta = t.number("beta", Unit::none, Range::positive(), v.spec.beta);
  v.spec.trials = t.count("trials", 1, 1000000000000, v.spec.trials);
  if (sound) require_drawable(t, v.spec);
  if (t.has("packings")) v.packings = t.count("packings", 2, base.packings_max);
  if (sound && v.spec.beta == base.spec.beta && v.spec.trials == base.spec.trials)
    t.mistake("beta", "a variant needs another beta or another number of trials than [packing]");
  return v;
}

}  // namespace

CrowdSetup setup_of(const LawTableVariant& variant, const CrowdSetup& main) {
  CrowdSetup setup = main;
  setup.spec = variant.spec;
  if (!variant.packings) return setup;
  setup.packings_min = setup.packings_max = *variant.packings;
  setup.packings.clear();
  setup.plan.clear();
  std::erase_if(setup.configurations, [&](const CrowdConfiguration& c) {
    const auto softs = std::count_if(c.partners.begin(), c.partners.end(),
                                     [](const CrowdPartner& p) { return p.kind == PartnerKind::soft; });
    return c.held_out || softs >= setup.packings_max;
  });
  return setup;
}

LawTableSetup read_law_table(const Scene& scene) {
  return scene.read([](const SceneTable& root) {
    (void)root.choice("kind", {"law-table"});
    const SceneTable calibrate = root.table_or_empty("calibrate");
    LawTableSetup out{root.text("title", ""), read_crowd_setup(root), {}, read_crowd_fit(calibrate)};
    read_plan(root, out.crowd);
    const SceneTable crowd = root.table_or_empty("crowd");
    const bool sound = crowd.sound() && root.table_or_empty("packing").sound();
    for (const SceneTable& t : root.tables("variant")) {
      out.variants.push_back(read_variant(t, out.crowd, sound));
      if (calibrate.sound() && out.variants.back().packings.value_or(out.crowd.packings_max) < out.fit.min_packings)
        t.mistake("packings", "fewer than calibrate.min_packings: there would be no fit");
    }
    require_law_of_crowds(root, out.crowd, calibrate, out.fit);
    return out;
  });
}

}  // namespace softgrain
