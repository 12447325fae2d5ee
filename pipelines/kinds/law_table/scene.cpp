// Reads scenes of kind "law-table", and says what follows from them: softgrain check.
#include "pipelines/kinds/law_table/scene.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/core/text.h"
#include "common/data/soft_particle_schema.h"
#include "pipelines/kinds/law_table/multi_contact_summary.h"
#include "pipelines/kinds/soft_particle/scene.h"

namespace softgrain {

namespace {

/// `valid`: the base has no errors.
LawTableVariant read_variant(const SceneTable& t, const MultiContactSetup& base, bool valid) {
  LawTableVariant v{base.spec, {}};
  v.spec.beta = t.number({"beta",
                          "volume of the grains that are drawn, over the volume of the shell; this key or `trials` "
                          "must differ from `[packing]`",
                          "as `[packing]`"},
                         Unit::none, soft_particle_number(&SoftParticleSpec::beta).drawn, v.spec.beta);
  v.spec.trials =
      t.count({"trials", "random positions tried per grain", "as `[packing]`"}, 1, 1000000000000, v.spec.trials);
  if (valid) require_drawable(t, v.spec);
  if (t.has("packings"))
    v.packings = t.count({"packings",
                          "packings per configuration; only configurations that the fit uses are measured. Without "
                          "this key all are measured, with held-out ones and `[[plan]]`",
                          "as `[multi_contact]`"},
                         2, base.packings_max);
  if (valid && v.spec.beta == base.spec.beta && v.spec.trials == base.spec.trials)
    t.add_error("beta", "a variant needs another beta or another number of trials than [packing]");
  return v;
}

}  // namespace

MultiContactSetup setup_of(const LawTableVariant& variant, const MultiContactSetup& main) {
  MultiContactSetup setup = main;
  setup.spec = variant.spec;
  if (!variant.packings) return setup;
  setup.packings_min = setup.packings_max = *variant.packings;
  setup.packings.clear();
  setup.plan.clear();
  std::erase_if(setup.configurations, [&](const MultiContactConfiguration& c) {
    const auto softs = std::count_if(c.partners.begin(), c.partners.end(),
                                     [](const MultiContactPartner& p) { return p.kind == PartnerKind::soft; });
    return c.held_out || softs >= setup.packings_max;
  });
  return setup;
}

LawTableSetup read_law_table(const Scene& scene) {
  return scene.read([](const SceneTable& root) {
    (void)root.choice(kKindKey, {"law-table"});
    const SceneTable calibrate = root.table_or_empty({"calibrate", "fit of the laws to the measurements"});
    LawTableSetup out{root.title(), read_multi_contact_setup(root), {}, read_multi_contact_fit(calibrate), {}};
    read_plan(root, out.multi_contact);
    const SceneTable multi_contact = root.table_or_empty("multi_contact");
    const bool valid = !multi_contact.has_errors() && !root.table_or_empty("packing").has_errors();
    for (const SceneTable& t : root.tables(
             {"variant", "repeats the measurement on looser or denser packings, for a second solid fraction"})) {
      out.variants.push_back(read_variant(t, out.multi_contact, valid));
      if (!calibrate.has_errors() &&
          out.variants.back().packings.value_or(out.multi_contact.packings_max) < out.fit.min_packings)
        t.add_error("packings", "fewer than calibrate.min_packings: there would be no fit");
    }
    require_law_of_multi_contact(root, out.multi_contact, calibrate, out.fit);
    out.prior = read_law_prior(root, calibrate, out.fit);
    return out;
  });
}

void check_law_table(const LawTableSetup& setup, Findings& out) {
  const MeasureTrial trial = check_multi_contact(setup.multi_contact, out);
  spend_on_packings(setup.multi_contact, trial, 1.0, out);
  spend_on_multi_contact(setup.multi_contact, trial, 1.0, "measuring", out);
  check_law_prior(setup.prior, setup.multi_contact.spec, trial.packing.solid_fraction(), out);
  out.facts["variants"] = setup.variants.size();
  for (const LawTableVariant& v : setup.variants) {
    const MultiContactSetup of_variant = setup_of(v, setup.multi_contact);
    spend_on_packings(of_variant, trial, 1.0, out);
    spend_on_multi_contact(of_variant, trial, 1.0, "variants", out);
    out.lines +=
        fmt::format("  the same on {} with beta = {}, {} trials per grain\n",
                    v.packings ? counted(*v.packings, "packing") : "as many packings", v.spec.beta, v.spec.trials);
  }
  if (setup.variants.empty())
    out.warn(
        "one kind of packing: the table serves contents within 0.02 of its solid fraction; a [[variant]] widens it");
}

}  // namespace softgrain
