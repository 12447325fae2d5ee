// softgrain check of law tables.
#include <fmt/format.h>

#include "pipelines/kinds/law_table/multi_contact_check.h"
#include "pipelines/kinds/law_table/scene.h"

namespace softgrain {

void check_law_table(const LawTableSetup& setup, Findings& out) {
  const MeasureTrial trial = check_multi_contact(setup.multi_contact, out);
  spend_on_packings(setup.multi_contact, trial, 1.0, out);
  spend_on_multi_contact(setup.multi_contact, trial, 1.0, "measuring", out);
  out.facts["variants"] = setup.variants.size();
  for (const LawTableVariant& v : setup.variants) {
    const MultiContactSetup of_variant = setup_of(v, setup.multi_contact);
    spend_on_packings(of_variant, trial, 1.0, out);
    spend_on_multi_contact(of_variant, trial, 1.0, "variants", out);
    out.lines += fmt::format("  the same on {} with beta = {}, {} trials per grain\n",
                             v.packings ? fmt::format("{} packings", *v.packings) : "as many packings", v.spec.beta,
                             v.spec.trials);
  }
  if (setup.variants.empty())
    out.warn(
        "one kind of packing: the table serves contents within 0.02 of its solid fraction; a [[variant]] widens it");
}

}  // namespace softgrain
