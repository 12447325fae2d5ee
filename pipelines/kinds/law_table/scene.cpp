#include "pipelines/kinds/law_table/scene.h"

#include <algorithm>

#include "pipelines/kinds/soft_particle/scene.h"

namespace softgrain {

namespace {

constexpr std::int64_t kVariantPackings = 8;

LawTableVariant read_variant(const SceneTable& t, const CrowdSetup& base) {
  LawTableVariant v{base.spec, 0};
  v.spec.beta = t.number("beta", Unit::none, Range::positive(), v.spec.beta);
  v.spec.trials = t.count("trials", 1, 1000000000000, v.spec.trials);
  require_drawable(t, v.spec);
  v.packings = t.count("packings", 2, base.packings_max, std::min(base.packings_min, kVariantPackings));
  if (v.spec.beta == base.spec.beta && v.spec.trials == base.spec.trials)
    t.reject("beta", "a variant needs another beta or another number of trials than [packing]");
  return v;
}

}  // namespace

LawTableSetup read_law_table(const Scene& scene) {
  const SceneTable root = scene.root();
  (void)root.choice("kind", {"law-table"});
  LawTableSetup out{
      root.text("title", ""), read_crowd_setup(root), {}, read_crowd_fit(root.table_or_empty("calibrate"))};
  for (const SceneTable& t : root.tables("variant")) {
    out.variants.push_back(read_variant(t, out.crowd));
    if (out.variants.back().packings < out.fit.min_packings)
      t.reject("packings", "fewer than calibrate.min_packings: there would be no fit");
  }
  if (out.crowd.packings_max < out.fit.min_packings)
    root.table_or_empty("crowd").reject("packings_max", "below calibrate.min_packings: there would be no fit");
  const auto& all = out.crowd.configurations;
  if (std::none_of(all.begin(), all.end(), [](const CrowdConfiguration& c) {
        return c.partners.size() == 1 && c.partners[0].kind == PartnerKind::plane && !c.held_out && !c.centre_free;
      }))
    root.reject("configuration", "a law table needs one plane alone (arrangement \"one\", partner \"plane\")");
  root.finish();
  return out;
}

}  // namespace softgrain
