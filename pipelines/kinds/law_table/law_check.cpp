// softgrain check of law cards and law tables.
#include "pipelines/kinds/law_table/scene.h"

#include <fmt/format.h>

#include <cmath>

#include "common/data/card_text.h"
#include "common/data/law_band.h"
#include "common/data/law_words.h"
#include "common/io/scene.h"
#include "pipelines/kinds/law_table/multi_contact_law_fit.h"
#include "pipelines/law/fitted_law.h"
#include "pipelines/law/law_json.h"

namespace softgrain {

namespace {

using nlohmann::json;

void warn_of_card(const LawCard& card, Findings& out) {
  for (const PairLaw& law : card.pairs) {
    const std::string name = to_string(law.kind);
    if (law.status != LawStatus::good)
      out.warn(name + ": " + to_string(law.status) + (law.reason.empty() ? "" : " (" + law.reason + ")"));
    constexpr int kFew = 5;
    if (law.packings > 0 && law.packings < kFew)
      out.warn(fmt::format("{}: fitted on {} packings, which differ by 10 % and more", name, law.packings));
    constexpr double kLarge = 0.5;
    if (law.max_overlap > kLarge)
      out.warn(
          fmt::format("{}: grains overlap by up to {:.2g} of the smaller radius at the end of the range: Hertz' law is "
                      "one of small overlaps",
                      name, law.max_overlap));
  }
  if (const std::string remark = kt_remark(card); !remark.empty()) out.warn(remark);
}

void check_law(const LawCard& card, Findings& out) {
  out.add("kind", "law card", "law card, " + measured_text(card));
  if (!packing_known(card.spec))
    out.add("contents", "not known",
            "what is inside the soft particle is not known: no resolved twin can be made of it");
  for (const PairLaw& law : card.pairs)
    out.add(to_string(law.kind),
            {{"status", to_string(law.status)}, {"delta_min", law.delta_min}, {"delta_max", law.delta_max}},
            fmt::format("{}: {}, fitted for Delta from {:.3f} to {:.3f} on {} packings, largest grain overlap {:.2f} "
                        "of the smaller radius",
                        to_string(law.kind), to_string(law.status), law.delta_min, law.delta_max, law.packings,
                        law.max_overlap));
  warn_of_card(card, out);
  for (const std::string& note : card.notes) out.warn(note);
}

/// "0.712 to 0.745", or one number.
std::string fractions_text(const LawTable& table) {
  const double low = table.entries.front().solid_fraction;
  const double high = table.entries.back().solid_fraction;
  return low == high ? fmt::format("{:.3f}", low) : fmt::format("{:.3f} to {:.3f}", low, high);
}

std::string partners_text(const MultiContactLaw& law, PartnerKind kind) {
  const std::vector<PartnerRow> rows = law.rows(kind);
  if (rows.empty()) return fmt::format("no {} neighbours", to_string(kind));
  return fmt::format("{} neighbours of ratio {:.3g} to {:.3g}", to_string(kind), rows.front().ratio, rows.back().ratio);
}

void check_law(const LawTableEntry& entry, const MultiContactLaw& law, json& facts, std::string& lines) {
  facts["laws"].push_back(verdict_json(law));
  lines += fmt::format("    {}: {}{}, off by {:.1f} % on what it was fitted to, {}, {}; {}, {}\n",
                       form_label(entry, law), to_string(law.status), law.reason.empty() ? "" : " (" + law.reason + ")",
                       100.0 * law.error_fitted, held_out_text(law), cross_text(law),
                       partners_text(law, PartnerKind::solid), partners_text(law, PartnerKind::soft));
}

void check_entry(const LawTableEntry& e, Findings& out) {
  json facts = verdict_json(e);
  out.lines += fmt::format(
      "  solid fraction {:.4f} +- {:.4f}: {} packings, {} relaxation, grains of nu = {}, mu = {}\n"
      "    valid up to a lost volume of {:.3f} and an overlap of {:.3f} Rs with a plane, where grains overlap by "
      "{:.2f} of "
      "the smaller radius\n"
      "    {}; {}\n",
      e.solid_fraction, e.solid_fraction_error, e.packings, e.relaxation, e.spec.poisson_ratio, e.spec.friction,
      e.volume_max, e.overlap_max, e.grain_overlap_max, unloading_text(e), slides_text(e));
  for (const MultiContactLaw& law : e.laws) check_law(e, law, facts, out.lines);
  out.facts["entries"].push_back(facts);
}

void warn_of_entry(const LawTableEntry& e, Findings& out) {
  const MultiContactLaw* best = e.find(e.best);
  constexpr double kFar = 0.15;
  if (best->status != LawStatus::good)
    out.warn(fmt::format("solid fraction {:.3f}: the law {} is {}{}", e.solid_fraction, form_label(e, *best),
                         to_string(best->status), best->reason.empty() ? "" : " (" + best->reason + ")"));
  const double unseen = std::fmax(best->error_cross, best->error_held_out);  // either may be unknown
  if (unseen > kFar)
    out.warn(fmt::format("solid fraction {:.3f}: the law {} is off by {:.0f} % on loadings that it has not seen",
                         e.solid_fraction, form_label(e, *best), 100.0 * unseen));
  for (const PartnerRow& row : best->partners)
    if (row.error > 2.0 * kFar)
      out.warn(fmt::format("solid fraction {:.3f}: {} neighbours of ratio {:.3g} are given back only to {:.0f} %",
                           e.solid_fraction, to_string(row.kind), row.ratio, 100.0 * row.error));
}

void check_law(const LawTable& table, Findings& out) {
  out.add("kind", "law table",
          fmt::format("law table: {} entries, solid fraction {}", table.entries.size(), fractions_text(table)));
  for (const LawTableEntry& e : table.entries) {
    check_entry(e, out);
    warn_of_entry(e, out);
  }
  for (const std::string& note : table.notes) out.warn(note);
}

void check_law(const CellCard& card, Findings& out) {
  out.add("kind", "cell law",
          fmt::format("card of the cell law, {} form, for material without shells: K = {}, n = {}, E of its grains {}, "
                      "p/E from {:.3g} to {:.3g}, up to {:.3g} times as much fines as coarse grains",
                      to_string(card.form), interval_text(card.modulus), interval_text(card.exponent),
                      is_known(card.youngs_modulus) ? fmt::format("{:.4g} Pa", card.youngs_modulus) : "not said",
                      card.pressure_low, card.pressure_high, card.mixture_high));
  for (const PreparationFactor& p : card.preparations)
    out.add("void_ratio_factor_" + p.preparation, p.factor.value,
            fmt::format("void ratios of grains prepared '{}' over these, prepared '{}': {}", p.preparation,
                        card.preparation, interval_text(p.factor)));
  constexpr double kWide = 0.25;
  if (!interval_known(card.modulus.low, card.modulus.high))
    out.warn("the interval of K is not determined: two samples of each packing at least would tell it");
  else if (card.modulus.high - card.modulus.low > kWide * card.modulus.value)
    out.warn(fmt::format("the interval of K is {:.0f} % wide: more samples would narrow it",
                         100.0 * (card.modulus.high - card.modulus.low) / card.modulus.value));
}

/// The card of a whole material, as a recipe writes it.
void check_material_card(const Scene& file, Findings& out) {
  const SceneTable root = file.root();
  const SceneTable material = root.table("material");
  const Estimate onset = read_estimate_text(material.table("phi_J"), Range{0.0, 1.0, true, true});
  const Estimate modulus = read_estimate_text(material.table("K"), Range::positive());
  const Estimate exponent = read_estimate_text(material.table("n"), Range::positive());
  const auto levels = root.tables("level").size();
  out.add(
      "kind", "material",
      fmt::format(
          "card of a whole material of {} levels, {} form: begins to carry pressure at a solid fraction of {}, p/E = "
          "{:.4g} x^{:.4g}",
          levels, material.text("form"), interval_text(onset), modulus.value, exponent.value));
  constexpr double kWide = 0.05;
  if (!interval_known(onset.low, onset.high))
    out.warn(
        "the interval of the solid fraction is not determined: two samples of each packing at least would tell it");
  else if (onset.high - onset.low > kWide)
    out.warn(
        fmt::format("the interval of the solid fraction is {:.2g} wide: stresses are known to a factor, not to per "
                    "cent",
                    onset.high - onset.low));
}

}  // namespace

void check_laws(const std::string& path, Findings& out) {
  const Scene file = Scene::load(path);
  if (is_material_card(file)) return check_material_card(file, out);
  FittedLaw law = load_law(file);
  read_refits(law);  // of an edited table they are not used, which its notes say
  std::visit([&](const auto& content) { check_law(content, out); }, law.content);
}

}  // namespace softgrain
