#include "common/data/law_remarks.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "common/core/text.h"

namespace softgrain {

std::string slides_text(const LawTableEntry& entry) {
  std::string text;
  for (const auto& [name, slide] : {std::pair{"against planes", &entry.slide_plane},
                                    {"against solid spheres", &entry.slide_solid},
                                    {"among soft particles", &entry.slide_soft}}) {
    const std::string numbers = fmt::format("{:.2f}, {:.2f}", slide->friction.value, slide->kt_ratio.value);
    append_part(text, slide->measured ? numbers + " " + name
                                      : fmt::format("not measured {} ({} taken instead)", name, numbers));
  }
  text = "friction limit and kt/kn: " + text;
  if (!entry.rolls()) return text;
  std::string rolling;
  for (const auto& [name, slide] : {std::pair{"against planes", &entry.slide_plane},
                                    {"against solid spheres", &entry.slide_solid},
                                    {"among soft particles", &entry.slide_soft}})
    append_part(rolling, slide->rolls ? fmt::format("{:.3f} F R {}", slide->rolling_friction.value, name)
                                      : fmt::format("not measured {} (free)", name));
  return text + "; largest moment against rolling: " + rolling;
}

std::string kt_remark(const LawCard& card) {
  std::string text;
  if (has_frozen_kt(card))
    text =
        "kt of this card is from a frozen turn (version 0.2.0 or earlier): at 1 degree it is 0.3 to 0.5 of what a "
        "slow turn gives; measure again, or calibrate from new measurements";
  std::map<double, std::string> kinds;  // by the ratio that they share
  for (const PairLaw& law : card.pairs) {
    if (has_tangential(law) || !has_numbers(law.status)) continue;
    append_part(kinds[assumed_kt_ratio(card, law)], to_string(law.kind), " and ");
  }
  for (const auto& [ratio, names] : kinds)
    append_part(
        text, ratio > 0.0
                  ? fmt::format("tangential stiffness of {} contacts was not measured: kt = {:.3g} dFn/dh is "
                                "assumed (kt_ratio of the card, Mindlin's unless it was changed), up to mu Fn",
                                names, ratio)
                  : fmt::format("{} contacts have no tangential force, whatever mu: kt_ratio of the card is 0", names));
  return text;
}

std::string unloading_text(const LawTableEntry& entry) {
  if (!entry.unloading_measured) return "unloading was not measured";
  std::string text = fmt::format("unloading is {:.2f} times as steep as loading", entry.unloading.value);
  if (entry.slide_solid.has_unloading)
    text += fmt::format(", {:.2f} against solid spheres", entry.slide_solid.unloading.value);
  if (entry.slide_soft.has_unloading)
    text += fmt::format(", {:.2f} among soft particles", entry.slide_soft.unloading.value);
  return text;
}

std::string pair_law_remark() {
  return fmt::format(
      "the pair law was measured with one contact; with two to twelve neighbours around a soft particle forces were "
      "measured to be {:g} to {:g} times as large, among soft particles up to {:g} times",
      kPairLawMissesLeast, kPairLawMissesMost, kPairLawMissesAmongSoft);
}

bool use_pair_law(const std::vector<MacroCurve>& curves) {
  return std::ranges::any_of(curves, [](const MacroCurve& c) { return c.law.form == LawForm::pair; });
}

}  // namespace softgrain
